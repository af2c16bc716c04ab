//! The stages Skin, Crush and Relax in a row, frame by frame: the state that changes, apart from
//! the model, which does not.

use crate::Vec3;
use crate::crush::{CrushInput, PlaneWaves, crush};
use crate::relax::{
    PhaseCoupling, VISIBLE, propagate_phases, random_phases, relax_rounds, visible,
};
use crate::skin::{Pose, PosedVertices, skin};
use crate::stage::Stage;
use crate::weld::WeldedMesh;

/// Step of each round of relaxation before the first frame. Nothing is seen to jump there, so it is
/// the largest that converges.
const FIRST_RATE: f32 = 0.5;

/// Settings of the wrinkles.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveOptions {
    /// One wavelength for all vertices, or `[U]` of them (m, rest).
    pub wavelength_m: Vec<f32>,
    /// `[U]` painted bias, or empty; see [`CrushInput::bias`].
    pub bias: Vec<Vec3>,
    /// Rounds of relaxation in each frame.
    pub rounds: usize,
    /// Step of each round, see [`crate::relax::relax`]; `rate` × `rounds` ≤ ¼ never jumps more than
    /// π/4 a frame.
    pub rate: f32,
    /// Rounds before the first frame.
    pub first_rounds: usize,
    /// Crush and Relax run in every n-th frame only.
    pub every: usize,
    /// True if wrinkles that were invisible in the last frame take their phases by
    /// [`propagate_phases`] instead of by Relax alone. It walks the mesh in one thread, which is
    /// most of the time on large meshes; without it, new wrinkles stay in more bifurcations.
    pub propagate_new: bool,
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
            propagate_new: true,
            seed: 1,
        }
    }
}

/// The changing state of one model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LiveState {
    /// Number of frames done.
    pub frame: usize,
    /// The welded vertices in this frame's pose.
    pub posed: PosedVertices,
    /// The plane waves, up to `every` − 1 frames old.
    pub waves: PlaneWaves,
    /// `[U]` phases φ (rad), in [−π, π).
    pub phase: Vec<f32>,
}

/// One frame of a model, ready to be drawn, baked or exported.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The waves and the welded vertices.
    pub state: &'a LiveState,
    /// `[V]` the draw vertices in the same pose.
    pub drawn: &'a PosedVertices,
}

impl LiveState {
    /// Advances to the next frame, which stands in `pose`.
    pub fn step(&mut self, welded: &WeldedMesh, pose: &Pose, options: &LiveOptions) {
        self.step_watched(welded, pose, options, |_| {});
    }

    /// As [`LiveState::step`]; calls `done` after each stage that ran.
    pub fn step_watched(
        &mut self,
        welded: &WeldedMesh,
        pose: &Pose,
        options: &LiveOptions,
        mut done: impl FnMut(Stage),
    ) {
        self.posed = skin(&welded.vertices, pose);
        done(Stage::Skin);
        if self.frame.is_multiple_of(options.every.max(1)) {
            let last_direction = std::mem::take(&mut self.waves.direction);
            let input = CrushInput {
                wavelength_m: &options.wavelength_m,
                bias: &options.bias,
                last_direction: &last_direction,
            };
            let visible = visible(&self.waves);
            self.waves = crush(welded, &self.posed, &input);
            done(Stage::Crush);
            self.relax(welded, options, &visible);
            done(Stage::Relax);
        }
        self.frame += 1;
    }

    /// Gives phases to new wrinkles and relaxes all; `visible` (`[U]`) are the old ones.
    fn relax(&mut self, welded: &WeldedMesh, options: &LiveOptions, visible: &[bool]) {
        let is_first = self.frame == 0;
        if is_first {
            self.phase = random_phases(welded.count(), options.seed);
        }
        let mut phase = std::mem::take(&mut self.phase);
        let coupling = self.coupling(welded);
        if options.propagate_new {
            let fixed = if is_first { &[] } else { visible };
            phase = propagate_phases(&coupling, &phase, fixed);
        }
        let (rate, rounds) = if is_first {
            (FIRST_RATE, options.first_rounds)
        } else {
            (options.rate, options.rounds)
        };
        relax_rounds(&coupling, rate, rounds, &mut phase);
        self.phase = phase;
    }

    /// The coupling of the phases on `mesh`, the model's welded mesh.
    pub fn coupling<'a>(&'a self, mesh: &'a WeldedMesh) -> PhaseCoupling<'a> {
        PhaseCoupling { mesh, positions: &self.posed.positions, waves: &self.waves }
    }

    /// Mean phase error (waves, 0 to ½) over the visible edges; see
    /// [`crate::relax::mean_phase_error`].
    pub fn mean_phase_error(&self, mesh: &WeldedMesh) -> f32 {
        crate::relax::mean_phase_error(&self.coupling(mesh), &self.phase)
    }

    /// Share of the visible vertices whose phase moved by more than π/4 since the frame `last`; see
    /// [`crate::crush::phase_jump_share`].
    pub fn phase_jump_share(&self, last: &Self) -> f32 {
        crate::crush::phase_jump_share(
            [&last.waves.strength, &self.waves.strength],
            [&last.phase, &self.phase],
            VISIBLE,
        )
    }
}
