//! Draws faces on the GPU, or by the twin where there is none or it was lost. The work is kept
//! either way: everything that is drawn comes from the processor's memory.

use plisse::picture::Image;
use plisse_gpu::{Average, Faces, Gpu, Painter, wgpu};
use plisse_live::camera::Camera;
use plisse_live::draw::{self, Look, SAMPLES};
use plisse_live::render::Corner;
use plisse_live::texture::Texture;

use super::colours::Scale;

/// What the twins are called where a device's name stands.
pub const TWINS: &str = "no GPU: drawn by the processor";

/// Shows a texture of the window's adapter in the window, in place of the one that was shown there
/// before.
pub type Hang = std::sync::Arc<
    dyn Fn(&wgpu::TextureView, Option<egui::TextureId>) -> egui::TextureId + Send + Sync,
>;

/// What may draw.
pub enum Graphics {
    /// The processor alone.
    Processor,
    /// An adapter of the pencil's own, where there is one; pictures come back into memory.
    Own,
    /// The window's; pictures stay on it. So it is in browsers, which let nobody wait for a
    /// picture.
    Window(Gpu, Hang),
}

impl Graphics {
    /// An adapter of the pencil's own if `gpu`.
    pub fn own(gpu: bool) -> Self {
        if gpu { Self::Own } else { Self::Processor }
    }
}

/// A picture: in memory, or, without pixels, in a texture of the window.
pub struct Drawn {
    /// Its size, and its pixels if they are in memory.
    pub image: Image,
    /// The texture.
    pub texture: Option<egui::TextureId>,
}

/// What draws.
pub struct Pencil {
    device: Option<Device>,
    textures: Vec<Texture>,
    /// What went wrong since somebody asked.
    message: Option<String>,
}

/// The GPU's side.
struct Device {
    gpu: Gpu,
    faces: Option<Faces>,
    /// For the last two sizes of pictures, with what keeps them on the adapter.
    painters: Vec<([usize; 2], Painter, Option<Average>)>,
    /// Where pictures stay on the adapter: how they come into the window, and as which of its
    /// textures.
    window: Option<(Hang, Option<egui::TextureId>)>,
}

impl Pencil {
    /// By `graphics`, else by the processor.
    pub fn new(graphics: Graphics) -> Self {
        let device = |gpu, window| Device { gpu, faces: None, painters: Vec::new(), window };
        let (device, message) = match graphics {
            Graphics::Processor => (None, None),
            Graphics::Own => match Gpu::new() {
                Ok(gpu) => (Some(device(gpu, None)), None),
                Err(error) => (None, Some(format!("{error}; drawn by the processor"))),
            },
            Graphics::Window(gpu, hang) => (Some(device(gpu, Some((hang, None)))), None),
        };
        let mut pencil = Self { device, textures: Vec::new(), message };
        pencil.set_base(&Texture::checked());
        pencil
    }

    /// The name of what draws.
    pub fn name(&self) -> &str {
        self.device.as_ref().map_or(TWINS, |d| &d.gpu.adapter)
    }

    /// Replaces the model's own colours.
    pub fn set_base(&mut self, base: &Texture) {
        self.textures = Scale::ALL.map(|scale| scale.texture(base)).into();
        if let Some(device) = &mut self.device {
            device.painters.clear();
        }
    }

    /// What went wrong since the last call, once.
    pub fn take_message(&mut self) -> Option<String> {
        self.message.take()
    }

    /// Takes the GPU away, as if it had been lost; for tests.
    pub fn destroy_device(&mut self) {
        if let Some(device) = &self.device {
            device.gpu.destroy();
        }
    }

    /// Draws `faces` with the colours of `scale` on `size` (width, height) pixels; `to_memory`:
    /// whether the pixels have to come back.
    pub fn draw(
        &mut self,
        faces: &[[Corner; 3]],
        scale: Scale,
        look: &Looks<'_>,
        camera: &Camera,
        (size, to_memory): ([usize; 2], bool),
    ) -> Drawn {
        let texture = Scale::ALL.iter().position(|s| *s == scale).unwrap_or(0);
        let plain = scale != Scale::Base;
        let parallax = look.parallax && !plain;
        // As bright as the legend, in the light that falls on it.
        let colour = if plain { plisse_live::Vec3::repeat(1.2) } else { look.colour };
        let look =
            Look { profile: look.profile, texture: &self.textures[texture], colour, parallax };
        // What stays on the adapter cannot be had from there at once: the twin draws it too.
        if let Some(device) = self.device.as_mut().filter(|d| !to_memory || d.window.is_none()) {
            match device.draw(&self.textures, faces, texture, &look, camera, size) {
                Ok(drawn) => return drawn,
                Err(error) => {
                    self.message = Some(format!(
                        "{error}. The picture is drawn by the processor from now on; nothing of \
                         the work is lost"
                    ));
                    self.device = None;
                }
            }
        }
        let texture = &self.textures[texture];
        Drawn {
            image: draw::draw(faces, &Look { texture, ..look }, camera, size).image,
            texture: None,
        }
    }
}

/// How the wrinkled surface looks.
#[derive(Clone, Copy)]
pub struct Looks<'a> {
    /// The wrinkles' profile.
    pub profile: &'a plisse_live::profile::Profile,
    /// Whether the texture shifts with the wrinkles.
    pub parallax: bool,
    /// Linear colour that the texture is multiplied with.
    pub colour: plisse_live::Vec3,
}

impl Device {
    fn draw(
        &mut self,
        textures: &[Texture],
        faces: &[[Corner; 3]],
        texture: usize,
        look: &Look<'_>,
        camera: &Camera,
        size: [usize; 2],
    ) -> plisse::Result<Drawn> {
        match &mut self.faces {
            Some(there) => there.set(&self.gpu, faces)?,
            None => self.faces = Some(Faces::new(&self.gpu, faces)?),
        }
        if !self.painters.iter().any(|p| p.0 == size) {
            let textures: Vec<&Texture> = textures.iter().collect();
            // A page waits for what a processor draws.
            let samples = if self.window.is_some() && self.gpu.is_software() { 1 } else { SAMPLES };
            let painter = Painter::new(&self.gpu, size, samples, &textures)?;
            self.painters.truncate(1);
            let average = self.window.is_some().then(|| Average::new(&self.gpu, &painter));
            self.painters.insert(0, (size, painter, average));
        }
        let Some((_, painter, average)) = self.painters.iter().find(|p| p.0 == size) else {
            return Err(lost());
        };
        let Some(faces) = &self.faces else { return Err(lost()) };
        painter.draw_faces(&self.gpu, faces, texture, camera, look)?;
        if let (Some(average), Some((hang, texture))) = (average, &mut self.window) {
            *texture = Some(hang(average.picture(&self.gpu), *texture));
            return Ok(Drawn {
                image: Image { width: size[0], height: size[1], pixels: Vec::new() },
                texture: *texture,
            });
        }
        Ok(Drawn { image: painter.read(&self.gpu)?.image, texture: None })
    }
}

fn lost() -> plisse::Error {
    plisse::Error::numeric("GPU", "the device was lost; close other programs that use it")
}
