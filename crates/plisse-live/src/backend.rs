//! The two ways to run the stages behind one trait: on the processor here, on the GPU in
//! `plisse-gpu`.

use std::time::Instant;

use plisse::Result;

use crate::camera::Camera;
use crate::draw::{Look, Picture, draw};
use crate::gather::gather;
use crate::live::{Frame, LiveState};
use crate::live_model::LiveModel;
use crate::skin::{Pose, skin};
use crate::stage::{Stage, StageTimes};

/// The stages of one model, run frame by frame.
pub trait Backend {
    /// The name of the adapter, or of the processor.
    fn name(&self) -> String;

    /// Advances to the next frame, which stands in `pose`.
    ///
    /// # Errors
    /// [`plisse::Error::Numeric`] if the device fails.
    fn step(&mut self, pose: &Pose) -> Result<()>;

    /// The waves of this frame.
    ///
    /// # Errors
    /// [`plisse::Error::Numeric`] if the device fails.
    fn state(&self) -> Result<LiveState>;

    /// A picture of this frame, which stands in `pose`.
    ///
    /// # Errors
    /// [`plisse::Error::Numeric`] if the device fails.
    fn draw(&mut self, pose: &Pose, camera: &Camera, look: &Look<'_>) -> Result<Picture>;

    /// Milliseconds of this frame's stages; `is_drawn` if [`Backend::draw`] was called.
    ///
    /// # Errors
    /// [`plisse::Error::Numeric`] if the device fails.
    fn times_ms(&self, is_drawn: bool) -> Result<StageTimes>;
}

/// The CPU reference of all stages.
#[derive(Clone, Debug)]
pub struct CpuBackend<'a> {
    live: &'a LiveModel,
    /// Width and height of the pictures (pixels).
    size: [usize; 2],
    state: LiveState,
    times: StageTimes,
}

impl<'a> CpuBackend<'a> {
    /// A backend before the first frame of `live`, for pictures of `size` (width, height) pixels.
    pub fn new(live: &'a LiveModel, size: [usize; 2]) -> Self {
        Self { live, size, state: LiveState::default(), times: StageTimes::default() }
    }
}

impl Backend for CpuBackend<'_> {
    fn name(&self) -> String {
        format!("processor ({} threads)", rayon::current_num_threads())
    }

    fn step(&mut self, pose: &Pose) -> Result<()> {
        let mut times = StageTimes::default();
        let mut begun = Instant::now();
        self.state.step_watched(&self.live.welded, pose, &self.live.options, |stage| {
            times[stage] = Some(milliseconds(begun));
            begun = Instant::now();
        });
        self.times = times;
        Ok(())
    }

    fn state(&self) -> Result<LiveState> {
        Ok(self.state.clone())
    }

    fn draw(&mut self, pose: &Pose, camera: &Camera, look: &Look<'_>) -> Result<Picture> {
        let begun = Instant::now();
        let drawn = skin(&self.live.model.draw, pose);
        let frame = Frame { state: &self.state, drawn: &drawn };
        let faces = gather(&self.live.model, &self.live.welded, &frame);
        self.times[Stage::Gather] = Some(milliseconds(begun));
        let begun = Instant::now();
        let picture = draw(&faces, look, camera, self.size);
        self.times[Stage::Render] = Some(milliseconds(begun));
        Ok(picture)
    }

    fn times_ms(&self, _: bool) -> Result<StageTimes> {
        Ok(self.times)
    }
}

fn milliseconds(begun: Instant) -> f64 {
    begun.elapsed().as_secs_f64() * 1e3
}
