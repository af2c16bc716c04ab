//! The GPU as a backend of a recording.

use plisse::Result;
use plisse_live::backend::Backend;
use plisse_live::camera::Camera;
use plisse_live::draw::{Look, Picture, SAMPLES};
use plisse_live::live::LiveState;
use plisse_live::live_model::LiveModel;
use plisse_live::skin::Pose;
use plisse_live::stage::StageTimes;
use plisse_live::texture::Texture;

use crate::arrays::Character;
use crate::device::Gpu;
use crate::live::Live;
use crate::painter::Painter;

/// One model on its own adapter.
pub struct GpuBackend<'a> {
    gpu: Gpu,
    live: Live,
    painter: Painter,
    model: &'a LiveModel,
    has_begun: bool,
}

impl<'a> GpuBackend<'a> {
    /// A backend before the first frame of `model`, for pictures of `size` (width, height) pixels
    /// with the base colour `texture`.
    ///
    /// # Errors
    /// [`plisse::Error::Numeric`] without an adapter, or if the model does not fit on it;
    /// [`plisse::Error::Value`] if the pictures do not.
    pub fn new(model: &'a LiveModel, size: [usize; 2], texture: &Texture) -> Result<Self> {
        let gpu = Gpu::new()?;
        let live = Live::new(&gpu, &[Character::of(model)])?;
        let painter = Painter::new(&gpu, size, SAMPLES, &[texture])?;
        Ok(Self { gpu, live, painter, model, has_begun: false })
    }
}

impl Backend for GpuBackend<'_> {
    fn name(&self) -> String {
        self.gpu.adapter.clone()
    }

    fn step(&mut self, pose: &Pose) -> Result<()> {
        let options = &self.model.options;
        if std::mem::replace(&mut self.has_begun, true) {
            self.live.step(&self.gpu, &[pose], options)
        } else {
            self.live.begin(&self.gpu, &[Character::of(self.model)], &[pose], options)
        }
    }

    fn state(&self) -> Result<LiveState> {
        self.live.read(&self.gpu)
    }

    fn draw(&mut self, _: &Pose, camera: &Camera, look: &Look<'_>) -> Result<Picture> {
        self.painter.draw(&self.gpu, &mut self.live, camera, look)?;
        self.painter.read(&self.gpu)
    }

    fn times_ms(&self, is_drawn: bool) -> Result<StageTimes> {
        self.live.times_ms(&self.gpu, is_drawn)
    }
}
