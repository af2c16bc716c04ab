//! The renderer: draws faces on the GPU, or by the CPU reference where there is no GPU or it was
//! lost. No work is lost with it: everything that is drawn comes from the processor's memory.

use plisse::picture::Image;
use plisse_gpu::{Average, Faces, Gpu, Painter, wgpu};
use plisse_live::camera::Camera;
use plisse_live::draw::{self, Look, SAMPLES};
use plisse_live::render::Corner;
use plisse_live::texture::Texture;

use super::colours::Scale;

/// Name of the CPU reference where a device's name stands.
pub const CPU_NAME: &str = "no GPU: drawn by the processor";

/// Shows a texture of the window's adapter in the window, in place of the one that was shown there
/// before.
pub type ShowTexture = std::sync::Arc<
    dyn Fn(&wgpu::TextureView, Option<egui::TextureId>) -> egui::TextureId + Send + Sync,
>;

/// The device that may draw.
pub enum Graphics {
    /// The processor alone.
    Processor,
    /// An adapter of the renderer's own, if there is one; pictures come back into memory.
    Own,
    /// The window's adapter; pictures stay on it. Browsers need this: a page cannot wait for
    /// pixels.
    Window(Gpu, ShowTexture),
}

impl Graphics {
    /// An adapter of the renderer's own if `gpu`.
    pub fn own(gpu: bool) -> Self {
        if gpu { Self::Own } else { Self::Processor }
    }
}

/// A picture: in memory, or in a texture of the window.
pub struct Drawn {
    /// Its size, and its pixels if they are in memory.
    pub image: Image,
    /// The texture.
    pub texture: Option<egui::TextureId>,
}

/// Draws faces.
pub struct Renderer {
    device: Option<Device>,
    textures: Vec<Texture>,
    /// A message about what went wrong, until it is taken.
    message: Option<String>,
}

/// The GPU device and what is kept on it.
struct Device {
    gpu: Gpu,
    faces: Option<Faces>,
    /// Painters for the last two sizes of pictures.
    painters: Vec<SizedPainter>,
    /// The window's textures, where pictures stay on the window's adapter.
    window: Option<WindowTexture>,
}

/// A painter for pictures of one size (pixels).
struct SizedPainter {
    size: [usize; 2],
    painter: Painter,
    /// Averages the samples of pictures that stay on the adapter.
    average: Option<Average>,
}

/// The texture of the window that holds the picture.
struct WindowTexture {
    show: ShowTexture,
    id: Option<egui::TextureId>,
}

impl Renderer {
    /// A renderer on `graphics`, else on the processor.
    pub fn new(graphics: Graphics) -> Self {
        let device = |gpu, window| Device { gpu, faces: None, painters: Vec::new(), window };
        let (device, message) = match graphics {
            Graphics::Processor => (None, None),
            Graphics::Own => match Gpu::new() {
                Ok(gpu) => (Some(device(gpu, None)), None),
                Err(error) => (None, Some(format!("{error}; drawn by the processor"))),
            },
            Graphics::Window(gpu, show) => {
                (Some(device(gpu, Some(WindowTexture { show, id: None }))), None)
            }
        };
        let mut renderer = Self { device, textures: Vec::new(), message };
        renderer.set_base(&Texture::checked());
        renderer
    }

    /// Name of the adapter, or [`CPU_NAME`].
    pub fn name(&self) -> &str {
        self.device.as_ref().map_or(CPU_NAME, |d| &d.gpu.adapter)
    }

    /// Replaces the model's own colours.
    pub fn set_base(&mut self, base: &Texture) {
        self.textures = Scale::ALL.map(|scale| scale.texture(base)).into();
        if let Some(device) = &mut self.device {
            device.painters.clear();
        }
    }

    /// The message about what went wrong since the last call.
    pub fn take_message(&mut self) -> Option<String> {
        self.message.take()
    }

    /// Destroys the GPU device, as if it had been lost; for tests.
    pub fn destroy_device(&mut self) {
        if let Some(device) = &self.device {
            device.gpu.destroy();
        }
    }

    /// Draws `faces` with the colours of `scale` on a target.
    pub fn draw(
        &mut self,
        faces: &[[Corner; 3]],
        scale: Scale,
        appearance: &Appearance<'_>,
        target: &RenderTarget<'_>,
    ) -> Drawn {
        let texture = Scale::ALL.iter().position(|s| *s == scale).unwrap_or(0);
        let plain = scale != Scale::Base;
        let parallax = appearance.parallax && !plain;
        // As bright as the legend, in the light that falls on it.
        let colour = if plain { plisse_live::Vec3::repeat(1.2) } else { appearance.colour };
        let look = Look {
            profile: appearance.profile,
            texture: &self.textures[texture],
            colour,
            parallax,
        };
        // What stays on the adapter cannot be read back at once: the CPU reference draws it too.
        let device = self.device.as_mut().filter(|d| !target.to_memory || d.window.is_none());
        if let Some(device) = device {
            let drawn = device
                .prepare(&self.textures, faces, target.size)
                .and_then(|()| device.draw(texture, &look, target));
            match drawn {
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
        let look = Look { texture, ..look };
        Drawn { image: draw::draw(faces, &look, target.camera, target.size).image, texture: None }
    }
}

/// The appearance of the wrinkled surface.
#[derive(Clone, Copy)]
pub struct Appearance<'a> {
    /// The wrinkles' profile.
    pub profile: &'a plisse_live::profile::Profile,
    /// True if the texture shifts with the wrinkles.
    pub parallax: bool,
    /// Linear colour that the texture is multiplied with.
    pub colour: plisse_live::Vec3,
}

/// The camera and the size of a picture.
#[derive(Clone, Copy)]
pub struct RenderTarget<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Width and height (pixels).
    pub size: [usize; 2],
    /// True if the pixels must come back into memory.
    pub to_memory: bool,
}

impl Device {
    /// Brings the faces, and a painter for pictures of this size, onto the device.
    fn prepare(
        &mut self,
        textures: &[Texture],
        faces: &[[Corner; 3]],
        size: [usize; 2],
    ) -> plisse::Result<()> {
        match &mut self.faces {
            Some(there) => there.set(&self.gpu, faces)?,
            None => self.faces = Some(Faces::new(&self.gpu, faces)?),
        }
        if !self.painters.iter().any(|p| p.size == size) {
            let textures: Vec<&Texture> = textures.iter().collect();
            // A software adapter in a page holds up the page: it takes one sample a pixel.
            let samples = if self.window.is_some() && self.gpu.is_software() { 1 } else { SAMPLES };
            let painter = Painter::new(&self.gpu, size, samples, &textures)?;
            self.painters.truncate(1);
            let average = self.window.is_some().then(|| Average::new(&self.gpu, &painter));
            self.painters.insert(0, SizedPainter { size, painter, average });
        }
        Ok(())
    }

    /// Draws the prepared faces with texture number `texture`.
    fn draw(
        &mut self,
        texture: usize,
        look: &Look<'_>,
        target: &RenderTarget<'_>,
    ) -> plisse::Result<Drawn> {
        let size = target.size;
        let Some(SizedPainter { painter, average, .. }) =
            self.painters.iter().find(|p| p.size == size)
        else {
            return Err(lost());
        };
        let Some(faces) = &self.faces else { return Err(lost()) };
        painter.draw_faces(&self.gpu, faces, texture, target.camera, look)?;
        if let (Some(average), Some(window)) = (average, &mut self.window) {
            window.id = Some((window.show)(average.picture(&self.gpu), window.id));
            return Ok(Drawn {
                image: Image { width: size[0], height: size[1], pixels: Vec::new() },
                texture: window.id,
            });
        }
        Ok(Drawn { image: painter.read(&self.gpu)?.image, texture: None })
    }
}

fn lost() -> plisse::Error {
    plisse::Error::numeric("GPU", "the device was lost; close other programs that use it")
}
