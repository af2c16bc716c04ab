//! Probes: the measures of a scene on its mesh. Lines are cut into the pieces that lie in each
//! face, sides become chains of vertices.

use super::placed::PlacedSurface;
use super::schema::{MeasureKind, Scene};
use crate::mesh::Vec2;
use crate::{Error, Result};

/// Distance (relative to the panel's size) within which a line that touches a face counts as in it.
const TOUCH: f64 = 1e-10;

/// A number that a scene asks for, ready to be taken from a field.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Name of the number.
    pub name: String,
    /// The quantity.
    pub quantity: Quantity,
    /// The published number, in the unit of the quantity.
    pub published: Option<f64>,
    /// Source of the published number.
    pub source: Option<String>,
}

/// The quantity of a [`Probe`].
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// Whole turns around the loop that has most of them (waves); 0 without loops.
    LargestPeriod,
    /// Largest amplitude (m).
    PeakAmplitude,
    /// Waves that a line crosses, on faces that are not wrinkle-free and whose amplitude is above 1
    /// % of the peak and of the thickness.
    WavesAlong {
        /// Pieces of the line, in order.
        pieces: Vec<Piece>,
        /// Points at which the line crosses from face to face, in order; between them everything
        /// linear in faces is linear.
        crossings: Vec<Crossing>,
    },
    /// Turns of the phase along a chain of edges; where a face at an edge is wrinkled.
    WavesAround {
        /// Vertices in order; the first again at the end if the chain is closed.
        chain: Vec<usize>,
    },
}

/// A piece of a line: the faces it runs in (two along an edge that they share, else one), each with
/// the piece as a vector (m) in the face's orthonormal rest frame.
pub type Piece = Vec<(usize, Vec2)>;

/// A point of a line: a face and the point's barycentric coordinates in it (no unit).
pub type Crossing = (usize, [f64; 3]);

/// The measures of the scene, in its order.
pub(super) fn probes(scene: &Scene, placed: &PlacedSurface) -> Result<Vec<Probe>> {
    let mut probes = Vec::new();
    for (i, table) in scene.measure.iter().enumerate() {
        let quantity = match table.kind {
            MeasureKind::LargestPeriod => Quantity::LargestPeriod,
            MeasureKind::PeakAmplitude => Quantity::PeakAmplitude,
            MeasureKind::WavesAlong => {
                let (Some(from), Some(to)) = (table.from_m, table.to_m) else {
                    return Err(Error::value(
                        format!("measure[{i}]"),
                        "waves_along needs panel, from_m and to_m; give them",
                    ));
                };
                let panel =
                    placed.panels.iter().find(|panel| table.panel.as_ref() == Some(&panel.name));
                let faces = panel.map_or(0..0, |panel| panel.faces.clone());
                let (pieces, crossings) =
                    cut(from.into(), to.into(), faces, |f| placed.panel_corners(f));
                if pieces.is_empty() {
                    let message =
                        "the line to to_m misses the panel; give points in panel coordinates (m)";
                    return Err(Error::value(format!("measure[{i}].from_m"), message));
                }
                Quantity::WavesAlong { pieces, crossings }
            }
            MeasureKind::WavesAround => {
                let side = placed.side(
                    scene,
                    &format!("measure[{i}].side"),
                    table.side.as_deref().unwrap_or_default(),
                )?;
                let mut chain: Vec<usize> =
                    side.rest_vertices.iter().map(|&r| placed.vertex_of_rest[r]).collect();
                if side.closed {
                    chain.push(chain[0]);
                }
                Quantity::WavesAround { chain }
            }
        };
        probes.push(Probe {
            name: table.name.clone(),
            quantity,
            published: table.published,
            source: table.source.clone(),
        });
    }
    Ok(probes)
}

/// The line from `from` to `to` (m, panel coordinates) cut at the borders of those of `faces` that
/// it runs in, and the points where it crosses them. `corners` gives a face's rest corners (m).
fn cut(
    from: Vec2,
    to: Vec2,
    faces: std::ops::Range<usize>,
    corners: impl Fn(usize) -> [Vec2; 3],
) -> (Vec<Piece>, Vec<Crossing>) {
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
    let crossing = |&stop: &f64| {
        let (f, _) = spans.iter().find(|(_, [enter, leave])| *enter <= stop && stop <= *leave)?;
        let ([a, b, c], p) = (corners(*f), from + along * stop);
        let area = (b - a).perp(&(c - a));
        let (v, w) = ((p - a).perp(&(c - a)) / area, (b - a).perp(&(p - a)) / area);
        Some((*f, [1.0 - v - w, v, w]))
    };
    let crossings = stops.iter().filter_map(crossing).collect();
    (pieces, crossings)
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

/// A vector of the panel's plane in the orthonormal rest frame of the face with these corners: its
/// first axis runs from corner 0 to 1, corner 2 is on the positive side of it.
fn in_face(vector: Vec2, corners: [Vec2; 3]) -> Vec2 {
    let [a, b, c] = corners;
    let first = (b - a).normalize();
    let turn = first.perp(&(c - a)).signum();
    Vec2::new(first.dot(&vector), turn * first.perp(&vector))
}
