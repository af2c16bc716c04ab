//! Draws faces on the GPU, or by the twin where there is none or it was lost. The work is kept either way: everything that is drawn
//! comes from the processor's memory.

use plisse::picture::Image;
use plisse_gpu::{Faces, Gpu, Painter};
use plisse_live::camera::Camera;
use plisse_live::draw::{self, Look, SAMPLES};
use plisse_live::render::Corner;
use plisse_live::texture::Texture;

use super::colours::Scale;

/// What the twins are called where a device's name stands.
pub const TWINS: &str = "no GPU: drawn by the processor";

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
    /// For the last two sizes of pictures.
    painters: Vec<([usize; 2], Painter)>,
}

impl Pencil {
    /// On the GPU if `gpu` and there is one.
    pub fn new(gpu: bool) -> Self {
        let found = gpu.then(Gpu::new);
        let (device, message) = match found {
            Some(Ok(gpu)) => (Some(Device { gpu, faces: None, painters: Vec::new() }), None),
            Some(Err(error)) => (None, Some(format!("{error}; drawn by the processor"))),
            None => (None, None),
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

    /// Draws `faces` with the colours of `scale` on `size` (width, height) pixels.
    pub fn draw(&mut self, faces: &[[Corner; 3]], scale: Scale, look: &Looks<'_>, camera: &Camera, size: [usize; 2]) -> Image {
        let texture = Scale::ALL.iter().position(|s| *s == scale).unwrap_or(0);
        let plain = scale != Scale::Base;
        let parallax = look.parallax && !plain;
        // As bright as the legend, in the light that falls on it.
        let colour = if plain { plisse_live::Vec3::repeat(1.2) } else { look.colour };
        let look = Look { profile: look.profile, texture: &self.textures[texture], colour, parallax };
        if let Some(device) = &mut self.device {
            match device.draw(&self.textures, faces, texture, &look, camera, size) {
                Ok(image) => return image,
                Err(error) => {
                    self.message = Some(format!("{error}. The picture is drawn by the processor from now on; nothing of the work is lost"));
                    self.device = None;
                }
            }
        }
        let texture = &self.textures[texture];
        draw::draw(faces, &Look { texture, ..look }, camera, size).image
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
    ) -> plisse::Result<Image> {
        match &mut self.faces {
            Some(there) => there.set(&self.gpu, faces)?,
            None => self.faces = Some(Faces::new(&self.gpu, faces)?),
        }
        if !self.painters.iter().any(|(s, _)| *s == size) {
            let textures: Vec<&Texture> = textures.iter().collect();
            let painter = Painter::new(&self.gpu, size, SAMPLES, &textures)?;
            self.painters.truncate(1);
            self.painters.insert(0, (size, painter));
        }
        let Some((_, painter)) = self.painters.iter().find(|(s, _)| *s == size) else { return Err(lost()) };
        let Some(faces) = &self.faces else { return Err(lost()) };
        painter.draw_faces(&self.gpu, faces, texture, camera, look)?;
        Ok(painter.read(&self.gpu)?.image)
    }
}

fn lost() -> plisse::Error {
    plisse::Error::numeric("GPU", "the device was lost; close other programs that use it")
}
