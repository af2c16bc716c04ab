//! Additive continuous collision detection (ACCD): conservative advancement on distances, which
//! lets nothing through, however thin (Li, Kaufman & Jiang 2021, *Codimensional Incremental
//! Potential Contact*, section 5).

use super::distance::PrimitivePair;
use crate::mesh::Vec3;

/// Share of its distance that a pair keeps in one step.
const MINIMUM_SHARE: f64 = 0.2;
/// Steps of advancement at most.
const MAX_ADVANCES: usize = 64;

/// Bound on a move of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepBound {
    /// Longest collision-free part (0 to 1) of the move.
    pub(crate) part: f64,
    /// Lower bound of the distance along it.
    pub(crate) least_distance: f64,
}

/// Collision-free part of the move of a pair from `x` by `moves`.
pub(crate) fn collision_free_part(
    pair: &PrimitivePair,
    x: [Vec3; 4],
    moves: [Vec3; 4],
) -> StepBound {
    // A common translation changes no distance.
    let mean = (moves[0] + moves[1] + moves[2] + moves[3]) * 0.25;
    let moves = moves.map(|m| m - mean);
    let size = moves.map(|m| m.norm());
    let speed = match pair {
        PrimitivePair::VertexFace(_) => size[0] + size[1].max(size[2]).max(size[3]),
        PrimitivePair::Edges(_) => size[0].max(size[1]) + size[2].max(size[3]),
    };
    let distance = pair.closest_points(x).distance;
    if distance > speed {
        return StepBound { part: 1.0, least_distance: distance - speed };
    }
    let kept = MINIMUM_SHARE * distance;
    let (mut part, mut clear) = (0.0, distance - kept);
    for _ in 0..MAX_ADVANCES {
        part += clear / speed;
        if part >= 1.0 {
            return StepBound { part: 1.0, least_distance: kept };
        }
        clear =
            pair.closest_points(std::array::from_fn(|k| x[k] + moves[k] * part)).distance - kept;
        if clear < 1e-2 * distance {
            break;
        }
    }
    StepBound { part, least_distance: kept }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::crossing::crossing_pairs;
    use crate::random::Random;

    #[test]
    fn a_vertex_stops_before_a_face_and_one_that_leaves_does_not() {
        let x = [Vec3::new(0.2, 0.2, 1.0), Vec3::zeros(), Vec3::x(), Vec3::y()];
        let pair = PrimitivePair::VertexFace([0, 1, 2, 3]);
        let by = |z: f64| [Vec3::new(0.0, 0.0, z), Vec3::zeros(), Vec3::zeros(), Vec3::zeros()];
        let found = collision_free_part(&pair, x, by(-10.0));
        assert!(found.part > 0.07 && found.part <= 0.08 + 1e-12, "{found:?}");
        assert_eq!(collision_free_part(&pair, x, by(10.0)).part, 1.0);
        assert_eq!(collision_free_part(&pair, x, [Vec3::new(5.0, -3.0, 2.0); 4]).part, 1.0);
        let near = collision_free_part(&pair, x, by(-0.5));
        assert!(near.part == 1.0 && near.least_distance <= 0.5);
    }

    /// Two random triangles, moved as far as all their pairs allow, never cross; with twice the
    /// move some do.
    #[test]
    fn no_triangles_get_through_each_other() {
        let mut random = Random(8);
        let mut place = |size: f64| {
            Vec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5) * size
        };
        let faces = [[0, 1, 2], [3, 4, 5]];
        let mut pairs = Vec::new();
        for k in 0..3 {
            pairs.push(PrimitivePair::VertexFace([k, 3, 4, 5]));
            pairs.push(PrimitivePair::VertexFace([3 + k, 0, 1, 2]));
            pairs.extend(
                (0..3).map(|l| PrimitivePair::Edges([k, (k + 1) % 3, 3 + l, 3 + (l + 1) % 3])),
            );
        }
        let (mut met, mut beyond) = (0, 0);
        for _ in 0..400 {
            let x: Vec<Vec3> = (0..6).map(|_| place(1.0)).collect();
            let moves: Vec<Vec3> = (0..6).map(|_| place(2.0)).collect();
            if !crossing_pairs(&faces, &x).is_empty() {
                continue;
            }
            let of = |pair: &PrimitivePair| {
                collision_free_part(
                    pair,
                    pair.vertices().map(|v| x[v]),
                    pair.vertices().map(|v| moves[v]),
                )
                .part
            };
            let part = pairs.iter().map(of).fold(1.0, f64::min);
            met += usize::from(part < 1.0);
            let at = |share: f64| -> Vec<Vec3> {
                x.iter().zip(&moves).map(|(p, m)| p + m * (part * share)).collect()
            };
            for n in 1..=20 {
                assert!(crossing_pairs(&faces, &at(f64::from(n) / 20.0)).is_empty());
            }
            beyond += usize::from(part < 1.0 && !crossing_pairs(&faces, &at(1.5)).is_empty());
        }
        assert!(met > 100 && beyond > 20, "{met} {beyond}");
    }
}
