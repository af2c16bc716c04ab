//! A clip played up to a time. Waves depend on the frames before, so those are run through.

use plisse::{Error, Result};

use crate::live::{LiveOptions, LiveState};
use crate::model::{Clip, Model};
use crate::skin::{PosedVertices, pose, skin};
use crate::weld::WeldedMesh;

/// Number of frames a second at which clips are run through.
pub const RATE: f32 = 60.0;

/// The clip of `model` called `name`, or its first one without a name; `None` for a model that has
/// none.
///
/// # Errors
/// [`Error::Value`] for a name that no clip has.
pub fn clip<'a>(model: &'a Model, name: Option<&str>) -> Result<Option<&'a Clip>> {
    let found = model.clip(name);
    if let (Some(name), None) = (name, found) {
        let known: Vec<&str> = model.clips.iter().map(|c| c.name.as_str()).collect();
        let known = if known.is_empty() {
            "it has none; leave the flag out".to_owned()
        } else {
            format!("give one of {}", known.join(", "))
        };
        return Err(Error::value(
            "clip",
            format!("{} has no clip \"{name}\"; {known}", model.name),
        ));
    }
    Ok(found)
}

/// A model on its way through a clip.
#[derive(Clone, Debug)]
pub struct Player<'a> {
    model: &'a Model,
    welded: &'a WeldedMesh,
    options: &'a LiveOptions,
    clip: Option<&'a Clip>,
    time_s: f32,
    /// The waves at the time that was played to last.
    pub state: LiveState,
}

impl<'a> Player<'a> {
    /// A player before the first frame of the clip that [`clip`] finds.
    ///
    /// # Errors
    /// As [`clip`].
    pub fn new(
        model: &'a Model,
        welded: &'a WeldedMesh,
        options: &'a LiveOptions,
        clip: Option<&str>,
    ) -> Result<Self> {
        let found = self::clip(model, clip)?;
        Ok(Self { model, welded, options, clip: found, time_s: 0.0, state: LiveState::default() })
    }

    /// The clip that is played.
    pub fn clip(&self) -> Option<&'a Clip> {
        self.clip
    }

    /// Plays on to `time_s` (s, not before the last one) in steps of at most 1/60 s; the draw
    /// vertices, posed.
    pub fn play_to(&mut self, time_s: f32) -> PosedVertices {
        if self.state.frame == 0 {
            self.state.step(self.welded, &pose(self.model, self.clip, 0.0), self.options);
        }
        let (from, whole) = (self.time_s, (time_s - self.time_s).max(0.0));
        let steps = (whole * RATE - 1e-3).ceil().max(0.0) as usize;
        for step in 1..=steps {
            let at = from + whole * step as f32 / steps as f32;
            self.state.step(self.welded, &pose(self.model, self.clip, at), self.options);
        }
        self.time_s = from + whole;
        skin(&self.model.draw, &pose(self.model, self.clip, self.time_s))
    }
}
