//! Texture coordinates of flat panels: side by side in the unit square.

use super::{Chart, RestShape, Vec2};

/// Space between islands, relative to the largest side of all of them.
const GAP: f64 = 0.02;

/// Texture coordinates from flat rest panels: their rest positions, side by side in the unit
/// square; `None` for rest shapes that are not flat.
pub fn panel_texture(rest: &RestShape) -> Option<Chart> {
    let first = *rest.positions.first()?;
    let (low, high) =
        rest.positions.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let size = (high - low).x.max((high - low).y);
    if (high - low).z > 1e-9 * size {
        return None;
    }
    let flat: Vec<Vec2> = rest.positions.iter().map(|p| p.xy()).collect();
    Some(Chart { points: side_by_side(&flat, &rest.faces), faces: rest.faces.clone() })
}

/// Scales the plane figures `positions` (`[T]`, m) into the unit square, all alike. Where the
/// bounding boxes of connected pieces of `faces` overlap, as those of panels do that all begin at
/// their own origin, pieces are first laid side by side, in rows.
pub fn side_by_side(positions: &[Vec2], faces: &[[usize; 3]]) -> Vec<Vec2> {
    let (piece, boxes) = pieces(positions, faces);
    let overlap =
        |a: &[Vec2; 2], b: &[Vec2; 2]| (0..2).all(|k| a[0][k] < b[1][k] && b[0][k] < a[1][k]);
    let any = (0..boxes.len()).any(|i| boxes[..i].iter().any(|other| overlap(&boxes[i], other)));
    let mut shifts = vec![Vec2::zeros(); boxes.len()];
    if any {
        let area: f64 = boxes.iter().map(|[low, high]| (high - low).x * (high - low).y).sum();
        let widest = boxes.iter().map(|[low, high]| (high - low).x).fold(0.0, f64::max);
        let (row, gap) = (widest.max(1.1 * area.sqrt()), GAP * widest.max(area.sqrt()));
        let (mut x, mut y, mut tall) = (0.0, 0.0, 0.0f64);
        for ([low, high], shift) in boxes.iter().zip(&mut shifts) {
            let size = high - low;
            if x > 0.0 && x + size.x > row {
                (x, y, tall) = (0.0, y + tall + gap, 0.0);
            }
            *shift = Vec2::new(x, y) - low;
            (x, tall) = (x + size.x + gap, tall.max(size.y));
        }
    }
    let laid: Vec<Vec2> = positions.iter().zip(&piece).map(|(p, &k)| p + shifts[k]).collect();
    let low = laid.iter().fold(Vec2::repeat(f64::INFINITY), |a, p| a.inf(p));
    let size = laid.iter().fold(0.0, |a: f64, p| a.max((p - low).max()));
    laid.iter().map(|p| if size > 0.0 { (p - low) / size } else { Vec2::zeros() }).collect()
}

/// `[T]` piece of each point, counted by first points, and `[pieces]` their lower and upper
/// corners.
fn pieces(positions: &[Vec2], faces: &[[usize; 3]]) -> (Vec<usize>, Vec<[Vec2; 2]>) {
    let mut parent: Vec<usize> = (0..positions.len()).collect();
    fn root(parent: &mut [usize], mut v: usize) -> usize {
        while parent[v] != v {
            parent[v] = parent[parent[v]];
            v = parent[v];
        }
        v
    }
    for face in faces {
        for k in 1..3 {
            let (a, b) = (root(&mut parent, face[0]), root(&mut parent, face[k]));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut number = vec![usize::MAX; positions.len()];
    let (mut piece, mut boxes) = (Vec::with_capacity(positions.len()), Vec::new());
    for (v, p) in positions.iter().enumerate() {
        let r = root(&mut parent, v);
        if number[r] == usize::MAX {
            number[r] = boxes.len();
            boxes.push([*p, *p]);
        }
        let corners: &mut [Vec2; 2] = &mut boxes[number[r]];
        *corners = [corners[0].inf(p), corners[1].sup(p)];
        piece.push(number[r]);
    }
    (piece, boxes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_at_one_place_are_laid_apart() {
        let triangle = [Vec2::new(0.0, 0.0), Vec2::new(2.0, 0.0), Vec2::new(0.0, 1.0)];
        let positions: Vec<Vec2> = (0..5).flat_map(|_| triangle).collect();
        let faces: Vec<[usize; 3]> = (0..5).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let laid = side_by_side(&positions, &faces);
        assert!(laid.iter().all(|p| p.min() >= 0.0 && p.max() <= 1.0));
        let (_, boxes) = pieces(&laid, &faces);
        assert_eq!(boxes.len(), 5);
        for i in 0..5 {
            for j in 0..i {
                let apart =
                    |k: usize| boxes[i][0][k] > boxes[j][1][k] || boxes[j][0][k] > boxes[i][1][k];
                assert!((0..2).any(apart), "{i} and {j} overlap");
            }
            // All with the same scale.
            assert!(((boxes[i][1] - boxes[i][0]) - (boxes[0][1] - boxes[0][0])).norm() < 1e-12);
        }
        // One alone is only scaled.
        assert_eq!(
            side_by_side(&triangle, &faces[..1]),
            [Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0), Vec2::new(0.0, 0.5)]
        );
    }
}
