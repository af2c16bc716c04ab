//! The wrinkle field: amplitude, frequency and phase over a base surface (sections 3–5 of [Chen
//! 2021]).
//!
//! [`solve`] makes one from a sheet and its pose. Its steps: [`domain`] leaves out the
//! [`wrinkle_free`] faces and spans all frequencies that can be integrated there
//! ([`closed_forms`]), [`curvature`] is fitted, [`initialise`] guesses amplitude and frequency
//! (after [`comb`]ing the directions), [`problem`] is minimised ([`density`] is its energy), and
//! [`closest_closed_form`] rounds periods to whole turns. [`json`] reads and writes fields.
//! [`mod@scaling_law`] makes a field without a solve, for comparison.

pub mod closed_forms;
pub mod closest_closed_form;
pub mod comb;
pub mod curvature;
pub mod density;
pub mod domain;
pub mod initialise;
pub mod json;
pub mod phase_unknowns;
pub mod problem;
pub mod scaling_law;
mod solve;
mod wavelengths;
pub mod wrinkle_free;

pub use density::{EnergyTerms, Terms};
pub use scaling_law::{ScalingLaw, scaling_law};
pub use solve::{FieldOptions, FieldReport, Period, Solved, energy, solve};
pub use wavelengths::Wavelengths;
pub use wrinkle_free::WrinkleFreeRule;

use crate::mesh::Vec2;
use crate::sheet::Sheet;

/// Wrinkles over a base surface, a·cos φ high along its normal: made by a solve, shown by
/// displacing or shading.
#[derive(Clone, Debug, PartialEq)]
pub struct WrinkleField {
    /// `[V]` amplitude (m), ≥ 0.
    pub amplitude_m: Vec<f64>,
    /// `[E]` frequency one-form (rad), from the lower to the higher vertex of each edge; 0 on edges
    /// of no wrinkled face.
    pub omega: Vec<f64>,
    /// `[F][3]` phase (rad) at each corner; at one vertex corners differ by whole multiples of 2π.
    /// 0 on wrinkle-free faces.
    pub phase: Vec<[f64; 3]>,
    /// `[F]` true for wrinkle-free faces.
    pub wrinkle_free: Vec<bool>,
}

impl WrinkleField {
    /// Frequency (rad/m) of face `f` in its orthonormal rest frame.
    pub fn frequency(&self, sheet: &Sheet, f: usize) -> Vec2 {
        let topology = &sheet.topology;
        let along_01 = topology.side_sign(f, 0) * self.omega[topology.face_edges[f][0]];
        let along_02 = -topology.side_sign(f, 2) * self.omega[topology.face_edges[f][2]];
        sheet.rest.faces[f].one_form(along_01, along_02)
    }
}
