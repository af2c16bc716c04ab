//! A recording of a clip: from the steps of a timeline to pictures, fine meshes and measures.
//!
//! ```
//! use plisse_live::backend::CpuBackend;
//! use plisse_live::draw::Look;
//! use plisse_live::live_model::LiveModel;
//! use plisse_live::profile::Profile;
//! use plisse_live::recording::Recording;
//! use plisse_live::texture::Texture;
//! use plisse_live::timeline::{Timeline, View};
//! use plisse_live::{Vec3, models};
//!
//! let live = LiveModel::new(models::sleeve(), 0.04, Profile::sine());
//! let timeline = Timeline::new(live.model.clip(None), 0.5, 10.0, Some(2))?;
//! let view = View { yaw_deg: 20.0, pitch_deg: 10.0, size: [80, 60] };
//! let texture = Texture::checked();
//! let look = Look {
//!     profile: &live.profile,
//!     texture: &texture,
//!     colour: Vec3::repeat(1.0),
//!     parallax: true,
//! };
//! let mut backend = CpuBackend::new(&live, view.size);
//! let camera = timeline.camera(&live, &view);
//! let mut recording = Recording::new(&live, &timeline, camera, look, &mut backend);
//! for step in &timeline.steps {
//!     if let Some(frame) = recording.step(step)? {
//!         assert!(frame.picture.covered > 100);
//!     }
//! }
//! assert_eq!(recording.finish().pixels.len(), 2);
//! # Ok::<(), plisse::Error>(())
//! ```

use plisse::Result;

use crate::backend::Backend;
use crate::camera::Camera;
use crate::crush::{CrushInput, crush};
use crate::draw::{Look, Picture};
use crate::fine_mesh::{FineMesh, refine};
use crate::live::{Frame, LiveState};
use crate::live_model::LiveModel;
use crate::measures::Measures;
use crate::skin::{Pose, pose, skin};
use crate::timeline::{Timeline, TimelineStep};

/// A clip on its way through a [`Backend`].
pub struct Recording<'a> {
    live: &'a LiveModel,
    timeline: &'a Timeline<'a>,
    camera: Camera,
    look: Look<'a>,
    backend: &'a mut dyn Backend,
    last: Option<LiveState>,
    measures: Measures,
}

/// A frame that is shown.
#[derive(Debug)]
pub struct RecordedFrame<'a> {
    /// Its picture.
    pub picture: Picture,
    /// Its pose.
    pub pose: Pose,
    /// Its waves.
    pub state: &'a LiveState,
    live: &'a LiveModel,
}

impl RecordedFrame<'_> {
    /// The frame's geometry, with every face divided into `parts`².
    pub fn refine(&self, parts: usize) -> FineMesh {
        let drawn = skin(&self.live.model.draw, &self.pose);
        let frame = Frame { state: self.state, drawn: &drawn };
        refine(&self.live.model, &self.live.welded, &frame, &self.live.profile, parts)
    }
}

impl<'a> Recording<'a> {
    /// A recording of `live` before the first step of `timeline`; `backend` is new.
    pub fn new(
        live: &'a LiveModel,
        timeline: &'a Timeline<'a>,
        camera: Camera,
        look: Look<'a>,
        backend: &'a mut dyn Backend,
    ) -> Self {
        let measures = Measures::default();
        Self { live, timeline, camera, look, backend, last: None, measures }
    }

    /// Runs the stages for the next `step` of the timeline; the frame, if one is shown then.
    ///
    /// # Errors
    /// [`plisse::Error::Numeric`] if the device fails.
    pub fn step(&mut self, step: &TimelineStep) -> Result<Option<RecordedFrame<'_>>> {
        let pose = self.pose(step);
        self.backend.step(&pose)?;
        let state = self.backend.state()?;
        if let Some(last) = &self.last {
            self.measures.phase_jump_shares.push(f64::from(state.phase_jump_share(last)));
        }
        let mut picture = None;
        if step.is_shown {
            let error = state.mean_phase_error(&self.live.welded);
            self.measures.phase_errors.push(f64::from(error));
            let drawn = self.backend.draw(&pose, &self.camera, &self.look)?;
            self.measures.pixels.push(drawn.covered);
            picture = Some(drawn);
        }
        self.measures.push_times(&self.backend.times_ms(step.is_shown)?);
        let state: &LiveState = self.last.insert(state);
        Ok(picture.map(|picture| RecordedFrame { picture, pose, state, live: self.live }))
    }

    /// Number of frames shown so far.
    pub fn frames(&self) -> usize {
        self.measures.pixels.len()
    }

    /// The measures of all steps.
    pub fn finish(mut self) -> Measures {
        if let Some(first) = self.timeline.steps.first() {
            self.measures.singular_vertices = self.singular(&self.pose(first));
        }
        self.measures
    }

    fn pose(&self, step: &TimelineStep) -> Pose {
        pose(&self.live.model, self.timeline.clip, step.time_s as f32)
    }

    /// Number of vertices that can never wrinkle, because no direction can be told there.
    fn singular(&self, pose: &Pose) -> usize {
        let posed = skin(&self.live.welded.vertices, pose);
        let wavelength_m = &self.live.options.wavelength_m;
        let input = CrushInput { wavelength_m, bias: &[], last_direction: &[] };
        crush(&self.live.welded, &posed, &input).singular
    }
}
