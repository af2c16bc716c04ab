//! The stages in a row, frame by frame: what changes, apart from the model that does not.

use crate::Vec3;
use crate::crush::{CrushInput, Crushed, crush};
use crate::relax::{VISIBLE, random_phases, relax_rounds, spread};
use crate::skin::{Pose, Skinned, skin};
use crate::unify::Unified;

/// How wrinkles are made.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveOptions {
    /// One wavelength for all vertices, or `[U]` of them (m, rest).
    pub wavelength_m: Vec<f32>,
    /// `[U]` painted bias, or empty; see [`CrushInput::bias`].
    pub bias: Vec<Vec3>,
    /// Rounds of relaxation a frame.
    pub rounds: usize,
    /// Step of each round, see [`crate::relax::relax`]; `rate` × `rounds` ≤ ¼ never jumps more than
    /// π/4 a frame.
    pub rate: f32,
    /// Rounds before the first frame.
    pub first_rounds: usize,
    /// Crush and Relax run every n-th frame only.
    pub every: usize,
    /// Whether wrinkles that nobody saw in the last frame take their phases by [`spread`] instead
    /// of by Relax alone. It walks the mesh in one thread, which is what takes the time on large
    /// meshes; without, new wrinkles stay in more bifurcations.
    pub spread_new: bool,
    /// Seed of the phases that the first frame starts from.
    pub seed: u64,
}

impl LiveOptions {
    /// Usual options for one wavelength (m).
    pub fn new(wavelength_m: f32) -> Self {
        Self {
            wavelength_m: vec![wavelength_m],
            bias: Vec::new(),
            rounds: 1,
            rate: 0.25,
            first_rounds: 100,
            every: 1,
            spread_new: true,
            seed: 1,
        }
    }
}

/// The changing state of one model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LiveState {
    /// Frames done.
    pub frame: usize,
    /// The unified vertices in this frame's pose.
    pub posed: Skinned,
    /// The waves. Up to `every` − 1 frames old.
    pub crushed: Crushed,
    /// `[U]` phases φ (rad), in [−π, π).
    pub phase: Vec<f32>,
}

impl LiveState {
    /// Advances to the next frame, which stands in `pose`.
    pub fn step(&mut self, unified: &Unified, pose: &Pose, options: &LiveOptions) {
        self.step_watched(unified, pose, options, |_| {});
    }

    /// As [`LiveState::step`]; calls `done` with the name of each stage after it.
    pub fn step_watched(
        &mut self,
        unified: &Unified,
        pose: &Pose,
        options: &LiveOptions,
        mut done: impl FnMut(&'static str),
    ) {
        self.posed = skin(&unified.vertices, pose);
        done("skin");
        if self.frame.is_multiple_of(options.every.max(1)) {
            let last_direction = std::mem::take(&mut self.crushed.direction);
            let input = CrushInput {
                wavelength_m: &options.wavelength_m,
                bias: &options.bias,
                last_direction: &last_direction,
            };
            let seen: Vec<bool> = self.crushed.strength.iter().map(|&s| s >= VISIBLE).collect();
            self.crushed = crush(unified, &self.posed, &input);
            done("crush");
            let positions = &self.posed.positions;
            let (mut rate, mut rounds) = (options.rate, options.rounds);
            if self.frame == 0 {
                self.phase = random_phases(unified.count(), options.seed);
                if options.spread_new {
                    self.phase = spread(unified, positions, &self.crushed, &self.phase, &[]);
                }
                (rate, rounds) = (0.5, options.first_rounds);
            } else if options.spread_new {
                self.phase = spread(unified, positions, &self.crushed, &self.phase, &seen);
            }
            relax_rounds(unified, positions, &self.crushed, rate, rounds, &mut self.phase);
            done("relax");
        }
        self.frame += 1;
    }
}
