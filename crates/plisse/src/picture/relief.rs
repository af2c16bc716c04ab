//! Makes shallow wrinkles visible by light alone: normals lean further from their blurred
//! neighbourhood, as in [Cignoni 2005] "A simple normal enhancement technique". Shape and
//! silhouette stay exact.
//!
//! The factor is one number per picture, measured: 1 where slopes already read well, eight at most,
//! so a surface without wrinkles stays plain. Strong slopes (folds, silhouettes, one part in front
//! of another) are left alone, which avoids halos.

use super::paint::{Normal, unit};
use super::raster::{NOTHING, Seen};

/// Samples in a cell, across and down.
const CELL: usize = 8;
/// Root mean square of the slope that reads well.
const WANTED_SLOPE: f64 = 0.35;
/// The largest factor.
const MOST: f64 = 8.0;
/// Lean from the neighbourhood from which on a normal is part of the shape, not of the relief.
const STRONG: f64 = 0.6;
/// Width of the neighbourhood, as a part of the subject's diagonal in the view.
const REACH: f64 = 0.07;

/// The blurred normals of a view, and the factor.
pub(super) struct Relief {
    /// By how much slopes are steepened, 1 to 8.
    pub(super) gain: f32,
    columns: usize,
    /// Mean normal around each cell; zero where nothing is near.
    smooth: Vec<Normal>,
}

impl Relief {
    /// Measures the relief of the first `own` faces where they are `seen`; `normal(face, x, y)` is
    /// the normal at a sample.
    pub(super) fn measure(
        seen: &Seen,
        own: usize,
        normal: impl Fn(usize, usize, usize) -> Normal,
    ) -> Self {
        let (columns, rows) = (seen.width.div_ceil(CELL), seen.height.div_ceil(CELL));
        let mut sums = vec![[0f64; 3]; columns * rows];
        let mut probes = Vec::new();
        for y in (CELL / 4..seen.height).step_by(CELL / 2) {
            for x in (CELL / 4..seen.width).step_by(CELL / 2) {
                let face = seen.faces[y * seen.width + x];
                if face != NOTHING && (face as usize) < own {
                    let n = normal(face as usize, x, y);
                    let cell = y / CELL * columns + x / CELL;
                    for k in 0..3 {
                        sums[cell][k] += f64::from(n[k]);
                    }
                    probes.push((x, y, n));
                }
            }
        }
        let span = |of: &dyn Fn(&(usize, usize, Normal)) -> usize| {
            let (low, high) =
                probes.iter().map(of).fold((usize::MAX, 0), |(l, h), c| (l.min(c), h.max(c)));
            high.saturating_sub(low) as f64 / CELL as f64
        };
        let radius = ((REACH * span(&|p| p.0).hypot(span(&|p| p.1))).round() as usize).max(1);
        for _ in 0..3 {
            blur(&mut sums, (columns, rows), (1, columns), radius);
            blur(&mut sums, (rows, columns), (columns, 1), radius);
        }
        let mut relief = Self { gain: 1.0, columns, smooth: sums.into_iter().map(unit).collect() };
        let (mut squares, mut count) = (0.0, 0.0);
        for &(x, y, n) in &probes {
            let lean = relief.lean(n, x, y);
            let square = lean.iter().map(|l| l * l).sum::<f64>();
            if square < STRONG * STRONG {
                squares += square;
                count += 1.0;
            }
        }
        if count > 0.0 {
            relief.gain =
                (WANTED_SLOPE / (squares / count).sqrt().max(1e-9)).clamp(1.0, MOST) as f32;
        }
        relief
    }

    /// The normal `n` of sample `x`, `y` as the light shall see it.
    pub(super) fn steepened(&self, n: Normal, x: usize, y: usize) -> Normal {
        if self.gain <= 1.0 {
            return n;
        }
        let lean = self.lean(n, x, y);
        let strength = lean.iter().map(|l| l * l).sum::<f64>() / (STRONG * STRONG);
        let more = (f64::from(self.gain) - 1.0) * (-strength).exp();
        let steep = [0, 1, 2].map(|k| f64::from(n[k]) + more * lean[k]);
        unit([steep[0], steep[1], steep[2].max(0.02)])
    }

    /// Lean of `n` from its neighbourhood's normal, interpolated between the cells around sample
    /// `x`, `y`.
    fn lean(&self, n: Normal, x: usize, y: usize) -> [f64; 3] {
        let place = |s: usize, cells: usize| {
            let c = ((s as f64 + 0.5) / CELL as f64 - 0.5).clamp(0.0, (cells - 1) as f64);
            let low = (c as usize).min(cells.saturating_sub(2));
            (low, (low + 1).min(cells - 1), c - low as f64)
        };
        let (left, right, u) = place(x, self.columns);
        let (top, bottom, v) = place(y, self.smooth.len() / self.columns);
        let mut mean = [0f64; 3];
        for (row, column, part) in [
            (top, left, (1.0 - u) * (1.0 - v)),
            (top, right, u * (1.0 - v)),
            (bottom, left, (1.0 - u) * v),
            (bottom, right, u * v),
        ] {
            for k in 0..3 {
                mean[k] += part * f64::from(self.smooth[row * self.columns + column][k]);
            }
        }
        let mean = unit(mean);
        if mean == [0.0; 3] {
            [0.0; 3]
        } else {
            [0, 1, 2].map(|k| f64::from(n[k]) - f64::from(mean[k]))
        }
    }
}

/// Replaces each cell of each of `lines` by the sum of the cells up to `radius` before and after it
/// in its line. `(length, lines)` is the grid, `(step, stride)` the way to the next cell in a line
/// and to the next line.
fn blur(
    grid: &mut [[f64; 3]],
    (length, lines): (usize, usize),
    (step, stride): (usize, usize),
    radius: usize,
) {
    let mut before = vec![[0f64; 3]; length + 1];
    for line in 0..lines {
        for i in 0..length {
            let cell = grid[line * stride + i * step];
            before[i + 1] = [0, 1, 2].map(|k| before[i][k] + cell[k]);
        }
        for i in 0..length {
            let (from, to) =
                (before[i.saturating_sub(radius)], before[(i + radius + 1).min(length)]);
            grid[line * stride + i * step] = [0, 1, 2].map(|k| to[k] - from[k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(slope: f64) -> Relief {
        let seen = Seen { width: 400, height: 200, faces: vec![0; 80_000] };
        Relief::measure(&seen, usize::MAX, |_, x, _| {
            unit([slope * (x as f64 * 0.3).cos(), 0.0, 1.0])
        })
    }

    #[test]
    fn the_gain_falls_as_slopes_grow() {
        let gains = [0.001, 0.08, 0.15, 0.55].map(|slope| measured(slope).gain);
        assert_eq!(gains[0], MOST as f32);
        assert!(gains[1] < 7.0 && gains[1] > gains[2] && gains[2] > 1.2, "{gains:?}");
        assert_eq!(gains[3], 1.0);
    }

    #[test]
    fn a_flat_surface_stays_flat_and_a_ripple_leans_the_same_way_further() {
        let flat = measured(0.0);
        let n = flat.steepened([0.0, 0.0, 1.0], 100, 100);
        assert!(n[0].abs() < 1e-6 && n[1].abs() < 1e-6);
        let ripple = measured(0.03);
        let before = unit([0.03, 0.0, 1.0]);
        let after = ripple.steepened(before, 200, 100);
        assert!(
            after[0] > 3.0 * before[0] && f64::from(after[0]) < (MOST + 0.5) * f64::from(before[0])
        );
    }

    #[test]
    fn nothing_seen_gives_gain_one() {
        let seen = Seen { width: 40, height: 20, faces: vec![NOTHING; 800] };
        assert_eq!(Relief::measure(&seen, usize::MAX, |_, _, _| [0.0; 3]).gain, 1.0);
        let empty = Seen { width: 0, height: 0, faces: vec![] };
        assert_eq!(Relief::measure(&empty, usize::MAX, |_, _, _| [0.0; 3]).gain, 1.0);
    }
}
