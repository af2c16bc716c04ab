//! Numbers taken from a solved field, to be held against published ones.
//!
//! Waves along a line are counted from the frequency, not the rounded phase: they are real numbers. Only the wrinkled part of
//! a line counts, and what lies outside the panel counts nothing.

use super::build::Built;
use crate::field::{FieldReport, WrinkleField};
use crate::mesh::Vec2;

/// Distance (relative to the panel's size) within which a line that touches a face counts as in it.
const TOUCH: f64 = 1e-10;

/// A number that a scene asks for, ready to be taken from a field.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Name of the number.
    pub name: String,
    /// What it is.
    pub quantity: Quantity,
    /// The published number, in the unit of the quantity.
    pub published: Option<f64>,
    /// Where it was published.
    pub source: Option<String>,
}

/// What a [`Probe`] takes.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// Whole turns around the loop that has most of them (waves); 0 without loops.
    LargestPeriod,
    /// Largest amplitude (m).
    PeakAmplitude,
    /// Waves that a line crosses.
    WavesAlong {
        /// Pieces of the line, in order.
        pieces: Vec<Piece>,
    },
}

/// A piece of a line: the faces it runs in (two along an edge that they share, else one), each with the piece as a vector (m)
/// in the face's orthonormal rest frame.
pub type Piece = Vec<(usize, Vec2)>;

/// A number taken from a field.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Measured {
    /// Name of the number.
    pub name: String,
    /// The number, in [`Measured::unit`].
    pub value: f64,
    /// "waves" or "m".
    pub unit: &'static str,
    /// The published number, in the same unit.
    pub published: Option<f64>,
    /// Where it was published.
    pub source: Option<String>,
}

/// What the scene asks to measure on `field`, in the scene's order. `field` and `report` must come from `built`.
pub fn measure(built: &Built, field: &WrinkleField, report: &FieldReport) -> Vec<Measured> {
    let take = |probe: &Probe| {
        let (value, unit) = match &probe.quantity {
            Quantity::LargestPeriod => (report.periods.iter().map(|p| p.turns).max().unwrap_or(0) as f64, "waves"),
            Quantity::PeakAmplitude => (field.amplitude_m.iter().copied().fold(0.0, f64::max), "m"),
            Quantity::WavesAlong { pieces } => (waves_along(built, field, pieces), "waves"),
        };
        Measured { name: probe.name.clone(), value, unit, published: probe.published, source: probe.source.clone() }
    };
    built.probes.iter().map(take).collect()
}

fn waves_along(built: &Built, field: &WrinkleField, pieces: &[Piece]) -> f64 {
    let turns = |piece: &Piece| {
        // Along a common edge both faces say the same, if both are wrinkled.
        let wrinkled: Vec<f64> = piece
            .iter()
            .filter(|(f, _)| !field.wrinkle_free[*f])
            .map(|(f, along)| field.frequency(&built.topology, &built.rest, *f).dot(along).abs())
            .collect();
        if wrinkled.is_empty() { 0.0 } else { wrinkled.iter().sum::<f64>() / wrinkled.len() as f64 }
    };
    pieces.iter().map(turns).sum::<f64>() / std::f64::consts::TAU
}

/// The line from `from` to `to` (m, panel coordinates) cut at the borders of those of `faces` that it runs in. `corners` gives
/// a face's rest corners (m).
pub(super) fn cut(from: Vec2, to: Vec2, faces: std::ops::Range<usize>, corners: impl Fn(usize) -> [Vec2; 3]) -> Vec<Piece> {
    let along = to - from;
    // The size of coordinates decides how well they are known.
    let size = faces.clone().flat_map(&corners).fold(along.norm(), |size, p| size.max(p.norm()));
    let touch = TOUCH * size;
    let least = touch / along.norm();
    let spans: Vec<(usize, [f64; 2])> = faces
        .filter_map(|f| clip(from, along, corners(f), touch).map(|span| (f, span)))
        .filter(|(_, [enter, leave])| leave - enter > 2.0 * least)
        .collect();
    let mut stops: Vec<f64> = spans.iter().flat_map(|(_, span)| *span).collect();
    stops.sort_unstable_by(f64::total_cmp);
    stops.dedup_by(|a, b| *a == *b);
    let mut pieces = Vec::new();
    for pair in stops.windows(2) {
        let middle = 0.5 * (pair[0] + pair[1]);
        let piece: Piece = spans
            .iter()
            .filter(|(_, [enter, leave])| *enter < middle && middle < *leave)
            .map(|&(f, _)| (f, in_face(along * (pair[1] - pair[0]), corners(f))))
            .collect();
        if !piece.is_empty() {
            pieces.push(piece);
        }
    }
    pieces
}

/// The range of t in 0..1 for which `from + t·along` is in the triangle, or within `touch` of it.
fn clip(from: Vec2, along: Vec2, corners: [Vec2; 3], touch: f64) -> Option<[f64; 2]> {
    let [a, b, c] = corners;
    let turn = (b - a).perp(&(c - a)).signum();
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let side = (q - p).normalize() * turn;
        // Distance to the inner side of this edge, and its change with t.
        let (start, change) = (side.perp(&(from - p)), side.perp(&along));
        if change.abs() <= touch {
            if start.max(start + change) < -touch {
                return None;
            }
        } else if change > 0.0 {
            enter = enter.max(-start / change);
        } else {
            leave = leave.min(-start / change);
        }
    }
    (enter < leave).then_some([enter, leave])
}

/// A vector of the panel's plane in the orthonormal rest frame of the face with these corners: its first axis runs from corner
/// 0 to 1, corner 2 is on the positive side of it.
fn in_face(vector: Vec2, corners: [Vec2; 3]) -> Vec2 {
    let [a, b, c] = corners;
    let first = (b - a).normalize();
    let turn = first.perp(&(c - a)).signum();
    Vec2::new(first.dot(&vector), turn * first.perp(&vector))
}
