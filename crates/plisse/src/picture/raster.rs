//! The face that is seen at each sample: a z-buffer that keeps face numbers, so that colour is
//! computed once per seen sample.
//!
//! Vertices are snapped to 1/256 sample and coverage is decided in integers, so neighbouring faces
//! share every sample of their common edge exactly once: no holes, no double cover. Threads own
//! bands of rows; within a band faces come in their order, and of two equally near ones the first
//! stays.

use super::camera::Frame;
use crate::adjacency::Csr;
use crate::mesh::Vec3;
use rayon::prelude::*;

/// Samples across a pixel and down a pixel.
pub(super) const SAMPLES: usize = 2;
/// "No face is seen here" in [`Seen::faces`].
pub(super) const NOTHING: u32 = u32::MAX;

/// Steps per sample of the snapped coordinates.
const SNAP: i64 = 256;
/// Rows of samples in a band.
const BAND: usize = 32;
/// Marks a vertex that cannot be drawn.
const AWAY: i32 = i32::MIN;

/// `[V]` vertices as the sampler sees them.
pub(super) struct Projected {
    /// Right and down from the view's corner (1/256 sample); [`AWAY`] if the vertex cannot be
    /// drawn.
    place: Vec<[i32; 2]>,
    /// Toward the viewer (pixels).
    nearness: Vec<f64>,
}

impl Projected {
    /// `positions` (m) in the samples of `frame`.
    pub(super) fn new(positions: &[Vec3], frame: &Frame) -> Self {
        let step = (SAMPLES as i64 * SNAP) as f64;
        let (place, nearness) = positions
            .par_iter()
            .map(|p| {
                let [x, y, z] = frame.pixel_from_world(p);
                // Far outside any picture the snapped coordinates would overflow.
                let drawable = x.abs() < 1e6 && y.abs() < 1e6 && z.is_finite();
                let snap = |c: f64| if drawable { (c * step).round() as i32 } else { AWAY };
                ([snap(x), snap(y)], z)
            })
            .unzip();
        Self { place, nearness }
    }

    /// The triangle of `face`; `None` if it is degenerate in the view or cannot be drawn.
    pub(super) fn triangle(&self, face: [usize; 3]) -> Option<Triangle> {
        if face.iter().any(|&v| v >= self.place.len() || self.place[v][0] == AWAY) {
            return None;
        }
        let corners = face.map(|v| self.place[v].map(i64::from));
        let [a, b, c] = corners;
        let doubled_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        (doubled_area != 0).then(|| Triangle {
            corners,
            doubled_area,
            per_area: 1.0 / doubled_area as f64,
        })
    }
}

/// A triangle in snapped coordinates (1/256 sample).
#[derive(Clone, Copy)]
pub(super) struct Triangle {
    corners: [[i64; 2]; 3],
    /// Twice the signed area; negative if the corners run counter-clockwise on the screen (where y
    /// points down).
    doubled_area: i64,
    /// One over it.
    per_area: f64,
}

impl Triangle {
    /// True if the corners run counter-clockwise for the viewer.
    pub(super) fn faces_viewer(&self) -> bool {
        self.doubled_area < 0
    }

    /// Barycentric coordinates of the middle of sample `x`, `y`.
    pub(super) fn weights(&self, x: usize, y: usize) -> [f64; 3] {
        let p = [x as i64 * SNAP + SNAP / 2, y as i64 * SNAP + SNAP / 2];
        let [b, c] = [1, 2].map(|k| {
            let (from, to) = (self.corners[(k + 1) % 3], self.corners[(k + 2) % 3]);
            cross(from, to, p) as f64 * self.per_area
        });
        [1.0 - b - c, b, c]
    }

    /// Gradient over samples (right, down) of what is linear inside the triangle with `values` at
    /// its corners.
    pub(super) fn gradient(&self, values: [f64; 3]) -> [f64; 2] {
        let [a, b, c] = self.corners;
        let (ab, ac) = (values[1] - values[0], values[2] - values[0]);
        let scale = SNAP as f64 * self.per_area;
        [
            (ab * (c[1] - a[1]) as f64 - ac * (b[1] - a[1]) as f64) * scale,
            (ac * (b[0] - a[0]) as f64 - ab * (c[0] - a[0]) as f64) * scale,
        ]
    }

    /// Height over the side from corner `k` to `k+1`, i.e. the distance of the opposite corner from
    /// it (samples).
    pub(super) fn height(&self, k: usize) -> f64 {
        let (from, to) = (self.corners[k], self.corners[(k + 1) % 3]);
        let length = ((to[0] - from[0]) as f64).hypot((to[1] - from[1]) as f64);
        self.doubled_area.abs() as f64 / length / SNAP as f64
    }

    /// First and one past the last sample whose middle can lie inside, along coordinate `axis`, cut
    /// to `0..limit`.
    fn range(&self, axis: usize, limit: usize) -> (usize, usize) {
        let [a, b, c] = self.corners.map(|p| p[axis]);
        let first = (a.min(b).min(c) + SNAP / 2 - 1).div_euclid(SNAP);
        let end = (a.max(b).max(c) + SNAP / 2).div_euclid(SNAP);
        (first.clamp(0, limit as i64) as usize, end.clamp(0, limit as i64) as usize)
    }
}

/// The visible surface: `[height][width]` samples.
pub(super) struct Seen {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Number of the nearest face at each sample, or [`NOTHING`].
    pub(super) faces: Vec<u32>,
}

/// The nearest of `faces` (`[F][3]`) at every sample of a view of `size` pixels (width, height).
pub(super) fn see(projected: &Projected, faces: &[[usize; 3]], size: (usize, usize)) -> Seen {
    let (width, height) = (size.0 * SAMPLES, size.1 * SAMPLES);
    let mut seen = Seen { width, height, faces: vec![NOTHING; width * height] };
    if width == 0 || height == 0 {
        return seen;
    }
    let bands = faces_of_bands(projected, faces, height);
    seen.faces.par_chunks_mut(width * BAND).enumerate().for_each(|(band, rows)| {
        let top = band * BAND;
        let mut nearest = vec![f32::NEG_INFINITY; rows.len()];
        for &f in &bands[band] {
            let face = faces[f as usize];
            if let Some(triangle) = projected.triangle(face) {
                fill(
                    &triangle,
                    face.map(|v| projected.nearness[v]),
                    f,
                    (width, top),
                    &mut nearest,
                    rows,
                );
            }
        }
    });
    seen
}

/// Faces that touch each band, ascending.
fn faces_of_bands(projected: &Projected, faces: &[[usize; 3]], height: usize) -> Csr<u32> {
    let touched: Vec<(u32, u32)> = faces
        .par_iter()
        .map(|&face| match projected.triangle(face).map(|t| t.range(1, height)) {
            Some((first, end)) if first < end => {
                ((first / BAND) as u32, ((end - 1) / BAND + 1) as u32)
            }
            _ => (0, 0),
        })
        .collect();
    let pairs = touched
        .iter()
        .enumerate()
        .flat_map(|(f, &(first, end))| (first..end).map(move |band| (band as usize, f as u32)));
    Csr::from_pairs(height.div_ceil(BAND), pairs)
}

/// Enters face `number` where it is the nearest so far, into rows of `width` samples that start at
/// row `top`.
fn fill(
    triangle: &Triangle,
    nearness: [f64; 3],
    number: u32,
    (width, top): (usize, usize),
    nearest: &mut [f32],
    rows: &mut [u32],
) {
    let sign = triangle.doubled_area.signum();
    // Side k runs from corner k+1 to k+2; its value is twice the area between it and the sample, in
    // integers.
    let side = [0, 1, 2].map(|k| {
        let (from, to) = (triangle.corners[(k + 1) % 3], triangle.corners[(k + 2) % 3]);
        let along = [sign * (to[0] - from[0]), sign * (to[1] - from[1])];
        // A sample exactly on a side belongs to one of the two faces there: to the one that runs
        // along it this way.
        let bias = if along[1] < 0 || (along[1] == 0 && along[0] > 0) { 0 } else { -1 };
        (from, along, bias)
    });
    let (left, right) = triangle.range(0, width);
    let (first, end) = triangle.range(1, top + rows.len() / width);
    let slope = triangle.gradient(nearness);
    let z0 = nearness[0];
    let origin = triangle.corners[0].map(|c| c as f64 / SNAP as f64 - 0.5);
    for y in first.max(top)..end {
        let py = y as i64 * SNAP + SNAP / 2;
        let px = left as i64 * SNAP + SNAP / 2;
        let mut value = side.map(|(from, along, bias)| {
            along[0] * (py - from[1]) - along[1] * (px - from[0]) + bias
        });
        let step = side.map(|(_, along, _)| -along[1] * SNAP);
        let (mut x, mut stop) = (left, right);
        if right - left > 8 {
            // A wide triangle: jump to the run of samples inside all three sides.
            for k in 0..3 {
                if step[k] > 0 && value[k] < 0 {
                    x = x.max(
                        left + (-value[k] + step[k] - 1)
                            .div_euclid(step[k])
                            .min((right - left) as i64) as usize,
                    );
                } else if step[k] < 0 {
                    let inside = if value[k] < 0 { 0 } else { value[k].div_euclid(-step[k]) + 1 };
                    stop = stop.min(left + inside.min((right - left) as i64) as usize);
                } else if step[k] == 0 && value[k] < 0 {
                    stop = left;
                }
            }
            for k in 0..3 {
                value[k] += step[k] * (x - left) as i64;
            }
        }
        let row = (y - top) * width;
        let z_row = z0 + slope[1] * (y as f64 - origin[1]);
        while x < stop {
            if (value[0] | value[1] | value[2]) >= 0 {
                let z = (z_row + slope[0] * (x as f64 - origin[0])) as f32;
                if z > nearest[row + x] {
                    nearest[row + x] = z;
                    rows[row + x] = number;
                }
            }
            for k in 0..3 {
                value[k] += step[k];
            }
            x += 1;
        }
    }
}

fn cross(from: [i64; 2], to: [i64; 2], p: [i64; 2]) -> i64 {
    (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices given in samples (right, down) and nearness.
    fn projected(vertices: &[[f64; 3]]) -> Projected {
        Projected {
            place: vertices
                .iter()
                .map(|v| [v[0], v[1]].map(|c| (c * SNAP as f64).round() as i32))
                .collect(),
            nearness: vertices.iter().map(|v| v[2]).collect(),
        }
    }

    fn count(seen: &Seen, face: u32) -> usize {
        seen.faces.iter().filter(|&&f| f == face).count()
    }

    #[test]
    fn a_triangle_covers_its_area() {
        for flip in [[0, 1, 2], [0, 2, 1]] {
            let p = projected(&[[10.3, 5.9, 0.0], [190.2, 40.6, 0.0], [60.5, 170.1, 0.0]]);
            let seen = see(&p, &[flip], (100, 100));
            let area = ((190.2 - 10.3) * (170.1 - 5.9) - (40.6 - 5.9) * (60.5 - 10.3)) / 2.0;
            assert!((count(&seen, 0) as f64 / area - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn a_fan_covers_every_sample_once() {
        // Rim vertices exactly on sample middles and slivers between them: no hole, and removal of
        // any face uncovers only its own.
        let mut vertices = vec![[50.5, 50.5, 0.0]];
        for k in 0..64 {
            let t = std::f64::consts::TAU * f64::from(k) / 64.0;
            vertices.push([
                (50.5 + 45.0 * t.cos()).floor() + 0.5,
                (50.5 + 45.0 * t.sin()).floor() + 0.5,
                0.0,
            ]);
        }
        let fan: Vec<_> = (0..64).map(|k| [0, 1 + k, 1 + (k + 1) % 64]).collect();
        let p = projected(&vertices);
        let all = see(&p, &fan, (64, 64));
        let covered = all.faces.iter().filter(|&&f| f != NOTHING).count();
        let alone: usize = fan.iter().map(|&face| count(&see(&p, &[face], (64, 64)), 0)).sum();
        assert_eq!(covered, alone);
        for y in 0..all.height {
            let row = &all.faces[y * all.width..(y + 1) * all.width];
            if let (Some(first), Some(last)) =
                (row.iter().position(|&f| f != NOTHING), row.iter().rposition(|&f| f != NOTHING))
            {
                assert!(row[first..=last].iter().all(|&f| f != NOTHING), "hole in row {y}");
            }
        }
    }

    #[test]
    fn wide_and_narrow_triangles_are_filled_alike() {
        // The same strip once as a wide triangle pair and once cut into columns narrower than the
        // jump.
        let wide =
            projected(&[[3.2, 4.1, 0.0], [90.7, 30.3, 0.0], [90.7, 34.9, 0.0], [3.2, 60.0, 0.0]]);
        let seen = see(&wide, &[[0, 1, 2], [0, 2, 3]], (50, 50));
        for y in 0..seen.height {
            for x in 0..seen.width {
                let inside = [[0, 1, 2], [0, 2, 3]]
                    .iter()
                    .any(|&f| wide.triangle(f).unwrap().weights(x, y).iter().all(|&w| w > 1e-9));
                let outside = [[0, 1, 2], [0, 2, 3]]
                    .iter()
                    .all(|&f| wide.triangle(f).unwrap().weights(x, y).iter().any(|&w| w < -1e-9));
                let hit = seen.faces[y * seen.width + x] != NOTHING;
                assert!(if hit { !outside } else { !inside }, "sample {x}, {y}");
            }
        }
    }

    #[test]
    fn the_nearest_face_is_seen_whatever_its_number() {
        let p = projected(&[
            [0.0, 0.0, 1.0],
            [40.0, 0.0, 1.0],
            [0.0, 40.0, 1.0],
            [0.0, 0.0, 2.0],
            [40.0, 0.0, 0.5],
            [0.0, 40.0, 2.0],
        ]);
        for (faces, near) in [([[0, 1, 2], [3, 4, 5]], 1), ([[3, 4, 5], [0, 1, 2]], 0)] {
            let seen = see(&p, &faces, (20, 20));
            assert_eq!(seen.faces[2 * 40 + 2], near);
            assert_eq!(
                seen.faces[2 * 40 + 36],
                1 - near,
                "the faces cross; right of the crossing the other one is near"
            );
        }
    }

    #[test]
    fn weights_and_gradient_reproduce_a_linear_function() {
        let p = projected(&[[3.0, 2.0, 0.0], [30.0, 9.0, 0.0], [12.0, 25.0, 0.0]]);
        let t = p.triangle([0, 1, 2]).unwrap();
        let f = |x: f64, y: f64| 2.0 * x - 3.0 * y + 1.0;
        let values = [f(3.0, 2.0), f(30.0, 9.0), f(12.0, 25.0)];
        let w = t.weights(14, 11);
        let interpolated: f64 = (0..3).map(|k| w[k] * values[k]).sum();
        assert!((interpolated - f(14.5, 11.5)).abs() < 1e-9);
        let g = t.gradient(values);
        assert!((g[0] - 2.0).abs() < 1e-9 && (g[1] + 3.0).abs() < 1e-9);
    }

    #[test]
    fn faces_that_cannot_be_drawn_are_left_out() {
        let p = Projected {
            place: vec![[0, 0], [5000, 0], [0, 5000], [AWAY, AWAY]],
            nearness: vec![0.0; 4],
        };
        let seen = see(&p, &[[0, 1, 3], [0, 1, 9], [0, 1, 1], [0, 1, 2]], (20, 20));
        assert!(count(&seen, 3) > 0);
        assert!(seen.faces.iter().all(|&f| f == 3 || f == NOTHING));
    }
}
