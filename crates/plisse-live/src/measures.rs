//! Measures of a recording: times of the stages, phase errors, phases that jumped.

use crate::stage::{PerStage, Stage, StageTimes};

/// Measures of a recording, step by step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measures {
    /// Milliseconds of each stage in the steps that ran it.
    pub stage_ms: PerStage<Vec<f64>>,
    /// Number of pixels that show the model, in each frame.
    pub pixels: Vec<usize>,
    /// Mean phase error (waves, 0 to ½) of each frame.
    pub phase_errors: Vec<f64>,
    /// Share of the wrinkled vertices whose phase moved by more than π/4, in each step but the
    /// first.
    pub phase_jump_shares: Vec<f64>,
    /// Number of vertices that can never wrinkle, because no direction can be told there.
    pub singular_vertices: usize,
}

/// Mean and largest value of a list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// The mean.
    pub mean: f64,
    /// The largest value.
    pub max: f64,
}

impl Summary {
    /// The summary of `list`; `None` if it is empty.
    pub fn of(list: &[f64]) -> Option<Self> {
        let max = list.iter().copied().reduce(f64::max)?;
        Some(Self { mean: list.iter().sum::<f64>() / list.len() as f64, max })
    }
}

/// The median of `list`, the upper one of two; `None` if it is empty.
pub fn median(list: &[f64]) -> Option<f64> {
    let mut sorted = list.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

impl Measures {
    /// Adds the times of one step.
    pub fn push_times(&mut self, times: &StageTimes) {
        times.iter().for_each(|(stage, &ms)| self.stage_ms[stage].extend(ms));
    }

    /// Median of a stage's milliseconds, which the preparations of the first frames do not move.
    pub fn stage_ms_median(&self, stage: Stage) -> Option<f64> {
        median(&self.stage_ms[stage])
    }

    /// Mean number of pixels that show the model; 0 without frames.
    pub fn pixels_mean(&self) -> f64 {
        self.pixels.iter().sum::<usize>() as f64 / self.pixels.len().max(1) as f64
    }
}
