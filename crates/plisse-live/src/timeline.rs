//! The times at which a clip is stepped through and shown.
//!
//! Waves follow their surface from frame to frame and would jump if it moved far at once, so the
//! stages step at least sixty times a second, however few frames are shown.

use plisse::{Error, Result};

use crate::Vec3;
use crate::camera::Camera;
use crate::live_model::LiveModel;
use crate::model::Clip;
use crate::skin::{pose, skin};

/// Longest step of the waves (s).
const LONGEST_STEP_S: f64 = 1.0 / 60.0;
/// Largest number of frames unless more are asked for.
const MOST_FRAMES: u32 = 240;
/// Number of poses that the camera is fitted to.
const FITTED: usize = 24;

/// One step of the stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimelineStep {
    /// Time within the clip (s).
    pub time_s: f64,
    /// True if a frame is shown then.
    pub is_shown: bool,
}

/// The steps of a clip, or of a model that stands still.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline<'a> {
    /// The clip that is played.
    pub clip: Option<&'a Clip>,
    /// The steps in order.
    pub steps: Vec<TimelineStep>,
    /// Number of frames that are shown.
    pub frames: usize,
}

/// Place of the viewer and shape of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Degrees to the right of the model's front (+z).
    pub yaw_deg: f64,
    /// Degrees above the horizon.
    pub pitch_deg: f64,
    /// Width and height of the pictures (pixels).
    pub size: [usize; 2],
}

impl<'a> Timeline<'a> {
    /// Frames of `clip` from `start_s` on, `fps` a second: as many as asked for, or up to the end
    /// of the clip, 240 at most. The time before `start_s` is run through.
    ///
    /// # Errors
    /// [`Error::Value`] for `fps` outside 0.1 to 10000 and `start_s` outside 0 to 3600.
    pub fn new(
        clip: Option<&'a Clip>,
        start_s: f64,
        fps: f64,
        frames: Option<usize>,
    ) -> Result<Self> {
        if !(0.1..=10_000.0).contains(&fps) {
            return Err(Error::value(
                "fps",
                format!("{fps} frames a second cannot be made; give 0.1 to 10000"),
            ));
        }
        if !(0.0..=3600.0).contains(&start_s) {
            return Err(Error::value(
                "start",
                format!("{start_s} s cannot be played to; give 0 to 3600"),
            ));
        }
        let length_s = |clip: &Clip| (f64::from(clip.duration_s()) - start_s).max(0.0);
        let whole = clip.map_or(0.0, |clip| length_s(clip) * fps).floor() as u32 + 1;
        let frames = frames.unwrap_or(whole.min(MOST_FRAMES) as usize);
        let mut steps = Vec::new();
        let mut push = |time_s, is_shown| steps.push(TimelineStep { time_s, is_shown });
        let before = (start_s / LONGEST_STEP_S).ceil();
        (0..before as usize).for_each(|k| push(start_s * k as f64 / before, false));
        let parts = (1.0 / (fps * LONGEST_STEP_S) - 1e-9).ceil().max(1.0) as usize;
        for frame in 0..frames {
            let shown = start_s + frame as f64 / fps;
            if frame > 0 {
                let part = |p: usize| shown - (parts - p) as f64 / (fps * parts as f64);
                (1..parts).for_each(|p| push(part(p), false));
            }
            push(shown, true);
        }
        Ok(Self { clip, steps, frames })
    }

    /// A camera that holds `live` in all its frames.
    pub fn camera(&self, live: &LiveModel, view: &View) -> Camera {
        let shown: Vec<f64> = self.steps.iter().filter(|s| s.is_shown).map(|s| s.time_s).collect();
        let few = (0..FITTED.min(shown.len()))
            .map(|k| shown[k * (shown.len() - 1) / (FITTED.min(shown.len()) - 1).max(1)]);
        let posed = |time_s: f64| {
            skin(&live.welded.vertices, &pose(&live.model, self.clip, time_s as f32)).positions
        };
        let places: Vec<Vec3> = few.flat_map(posed).collect();
        let angle_rad = |deg: f64| if deg.is_finite() { deg.to_radians() as f32 } else { 0.0 };
        Camera::fit(
            places.iter(),
            angle_rad(view.yaw_deg),
            angle_rad(view.pitch_deg),
            view.size[0] as f32 / view.size[1] as f32,
        )
    }
}
