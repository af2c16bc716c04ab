//! Relief of a folded surface: number of folds, direction and coherence of their crests, and the
//! share of the asked length that was realised.
//!
//! Offsets w (m) from the starting surface are read on a regular grid over a *chart* of it: two
//! lengths (m) for each vertex, the first along the direction of growth, the second along the
//! crests. A flat sheet is its own chart. So folds are counted by the spacing that is seen on the
//! starting surface, however far the grown surface is folded.

use std::f64::consts::TAU;

use crate::mesh::normals::try_vertex_normals;
use crate::mesh::{Mat2, Topology, Vec2, Vec3};
use crate::rest::RestMetric;
use crate::strain::principal_pair;
use crate::{At, Error, Result};

/// Step of wave numbers in the spectrum, in waves per window.
const WAVE_STEP: f64 = 0.1;

/// `[V]` offset (m) of `pose` from the surface `start` along its normals.
///
/// # Errors
/// [`Error::Mesh`] if the starting surface has no normal somewhere.
pub fn offsets_m(topology: &Topology, start: &[Vec3], pose: &[Vec3]) -> Result<Vec<f64>> {
    let normals = try_vertex_normals(topology, start).at("growth")?;
    Ok(normals.iter().zip(start.iter().zip(pose)).map(|(n, (p, q))| n.dot(&(q - p))).collect())
}

/// A rectangle of the chart (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Its lower corner.
    pub low: Vec2,
    /// Its upper corner.
    pub high: Vec2,
}

/// Offsets on a regular grid of a window.
#[derive(Clone, Debug)]
pub struct Relief {
    /// Number of points along the growth and along the crests.
    pub size: [usize; 2],
    /// Distance (m) of neighbouring points along both.
    pub spacing_m: [f64; 2],
    /// Offset (m) at each point, row by row: those along the growth are neighbours.
    pub offset_m: Vec<f64>,
    /// True if rows are periodic: they return to where they begin, one point after the last.
    pub around: bool,
    /// True if folds are counted by slopes, not by heights: for closed surfaces, which also shift
    /// and bend as a whole.
    pub steep: bool,
}

impl Relief {
    /// Reads `offset_m` (`[V]`) over `chart` (`[V]`, m) in `window` with `size` points, linearly
    /// inside faces.
    ///
    /// # Errors
    /// [`Error::Value`] if the window reaches beyond the surface or holds fewer than 8 × 2 points.
    pub fn new(
        topology: &Topology,
        chart: &[Vec2],
        offset_m: &[f64],
        window: &Window,
        size: [usize; 2],
    ) -> Result<Self> {
        Self::from_corners(
            topology.faces.iter().map(|face| (face.map(|v| chart[v]), face.map(|v| offset_m[v]))),
            window,
            size,
        )
    }

    /// As [`Relief::new`], from each face's corners in the chart (m) and their offsets (m): a chart
    /// may be cut, or repeat itself.
    ///
    /// # Errors
    /// As [`Relief::new`].
    pub fn from_corners(
        faces: impl Iterator<Item = ([Vec2; 3], [f64; 3])>,
        window: &Window,
        size: [usize; 2],
    ) -> Result<Self> {
        Self::sampled(faces, window, size, false)
    }

    /// As [`Relief::from_corners`], in a window that goes around something: its right rim is its
    /// left one.
    ///
    /// # Errors
    /// As [`Relief::new`].
    pub fn around(
        faces: impl Iterator<Item = ([Vec2; 3], [f64; 3])>,
        window: &Window,
        size: [usize; 2],
    ) -> Result<Self> {
        Self::sampled(faces, window, size, true)
    }

    fn sampled(
        faces: impl Iterator<Item = ([Vec2; 3], [f64; 3])>,
        window: &Window,
        size: [usize; 2],
        around: bool,
    ) -> Result<Self> {
        let extent = window.high - window.low;
        if size[0] < 8 || size[1] < 2 || extent.min() <= 0.0 {
            return Err(Error::value(
                "window",
                "it holds too few points to count folds; give 8 or more along the growth, 2 or \
                 more across",
            ));
        }
        let spacing_m =
            [extent.x / (size[0] - usize::from(!around)) as f64, extent.y / (size[1] - 1) as f64];
        let mut grid = vec![f64::NAN; size[0] * size[1]];
        for ([a, b, c], w) in faces {
            let double_area = (b - a).perp(&(c - a));
            if double_area == 0.0 {
                continue;
            }
            // Points in the face's bounding box.
            let range = |axis: usize| {
                let (low, high) =
                    (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
                let at = |x: f64| (x - window.low[axis]) / spacing_m[axis];
                let first = (at(low) - 1e-9).ceil().max(0.0) as usize;
                let last = (at(high) + 1e-9).floor();
                first..if last < 0.0 { 0 } else { (last as usize + 1).min(size[axis]) }
            };
            for j in range(1) {
                for i in range(0) {
                    let p =
                        window.low + Vec2::new(i as f64 * spacing_m[0], j as f64 * spacing_m[1]);
                    let u = (p - a).perp(&(c - a)) / double_area;
                    let v = (b - a).perp(&(p - a)) / double_area;
                    if u >= -1e-9 && v >= -1e-9 && u + v <= 1.0 + 1e-9 {
                        grid[j * size[0] + i] = w[0] + u * (w[1] - w[0]) + v * (w[2] - w[0]);
                    }
                }
            }
        }
        if grid.iter().any(|w| w.is_nan()) {
            return Err(Error::value("window", "it reaches beyond the surface; make it smaller"));
        }
        Ok(Self { size, spacing_m, offset_m: grid, around, steep: false })
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.offset_m[j * self.size[0] + i]
    }

    /// Root of the mean square offset from the mean (m).
    pub fn roughness_m(&self) -> f64 {
        let n = self.offset_m.len() as f64;
        let mean = self.offset_m.iter().sum::<f64>() / n;
        (self.offset_m.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / n).sqrt()
    }

    /// The mean power spectrum along the growth: wave numbers (waves per metre) and power (m², not
    /// normalised). Around something there are whole waves only, and no rim to be softened.
    pub fn spectrum(&self) -> (Vec<f64>, Vec<f64>) {
        let [m, n] = self.size;
        let (steps, fineness) = if self.around { (m, 1.0) } else { (m - 1, WAVE_STEP) };
        let length = self.spacing_m[0] * steps as f64;
        let count = (0.5 * steps as f64 / fineness) as usize;
        let waves: Vec<f64> = (1..=count).map(|k| k as f64 * fineness / length).collect();
        // Hann's window, so that folds cut at the rim do not smear.
        let soft = |i: usize| 0.5 - 0.5 * (TAU * i as f64 / (m - 1) as f64).cos();
        let window: Vec<f64> = (0..m).map(|i| if self.around { 1.0 } else { soft(i) }).collect();
        let weight: f64 = window.iter().sum();
        let rows: Vec<Vec<f64>> = (0..n)
            .map(|j| {
                let mean = (0..m).map(|i| window[i] * self.at(i, j)).sum::<f64>() / weight;
                (0..m).map(|i| window[i] * (self.at(i, j) - mean)).collect()
            })
            .collect();
        let power_of = |wave: &f64| {
            let turns: Vec<(f64, f64)> =
                (0..m).map(|i| (TAU * wave * self.spacing_m[0] * i as f64).sin_cos()).collect();
            let row_power = |row: &Vec<f64>| {
                let part = |of: fn(&(f64, f64)) -> f64| {
                    row.iter().zip(&turns).map(|(w, turn)| w * of(turn)).sum::<f64>()
                };
                part(|turn| turn.0).powi(2) + part(|turn| turn.1).powi(2)
            };
            rows.iter().map(row_power).sum()
        };
        let power = waves.iter().map(power_of).collect();
        (waves, power)
    }

    /// The folds along the growth, by the highest peak of the spectrum (of that of the slopes, if
    /// what is steep counts); `None` where there is no relief.
    pub fn folds(&self) -> Option<Folds> {
        let (waves, mut power) = self.spectrum();
        if self.steep {
            power.iter_mut().zip(&waves).for_each(|(power, wave)| *power *= wave * wave);
        }
        let peak = (0..power.len()).max_by(|&a, &b| power[a].total_cmp(&power[b]))?;
        if power[peak].is_nan() || power[peak] <= 0.0 {
            return None;
        }
        let half = 0.5 * power[peak];
        if self.around {
            let run = |list: &mut dyn Iterator<Item = usize>| {
                list.take_while(|&k| power[k] >= half).count()
            };
            let broad = run(&mut (0..peak).rev()) + run(&mut (peak..power.len()));
            return Some(Folds {
                wavelength_m: 1.0 / waves[peak],
                width: broad as f64 / (peak + 1) as f64,
            });
        }
        let below = (0..peak).rev().find(|&k| power[k] < half).unwrap_or(0);
        let above = (peak..power.len()).find(|&k| power[k] < half).unwrap_or(power.len() - 1);
        // The centre of the peak, between the points where it has half its height.
        let (mut sum, mut weight) = (0.0, 0.0);
        for k in below..=above {
            let excess = (power[k] - half).max(0.0);
            sum += excess * waves[k];
            weight += excess;
        }
        let wave = sum / weight;
        Some(Folds { wavelength_m: 1.0 / wave, width: (waves[above] - waves[below]) / wave })
    }

    /// Share of the window (0 to 1) where crests run within `within_rad` of perpendicular to the
    /// growth. The direction at a point is that of the mean dyad of slopes within `radius_m` around
    /// it; points without relief count as off.
    pub fn crests_within(&self, within_rad: f64, radius_m: f64) -> f64 {
        let [m, n] = self.size;
        let slope = |i: usize, j: usize| {
            let (j0, j1) = (j.saturating_sub(1), (j + 1).min(n - 1));
            let (i0, i1, steps) = if self.around {
                ((i + m - 1) % m, (i + 1) % m, 2)
            } else {
                (i.saturating_sub(1), (i + 1).min(m - 1), (i + 1).min(m - 1) - i.saturating_sub(1))
            };
            Vec2::new(
                (self.at(i1, j) - self.at(i0, j)) / (steps as f64 * self.spacing_m[0]),
                (self.at(i, j1) - self.at(i, j0)) / ((j1 - j0) as f64 * self.spacing_m[1]),
            )
        };
        let mut dyads: Vec<Mat2> =
            (0..m * n).map(|k| slope(k % m, k / m)).map(|g| g * g.transpose()).collect();
        let whole: f64 = dyads.iter().map(Mat2::trace).sum::<f64>() / (m * n) as f64;
        // A mean over a square, one way after the other.
        for (axis, count, lines, step, skip) in [(0, m, n, 1, m), (1, n, m, m, 1)] {
            let reach = (radius_m / self.spacing_m[axis]).round() as usize;
            for line in 0..lines {
                let values: Vec<Mat2> = (0..count).map(|k| dyads[line * skip + k * step]).collect();
                for k in 0..count {
                    let near = k.saturating_sub(reach)..(k + reach + 1).min(count);
                    dyads[line * skip + k * step] =
                        values[near.clone()].iter().sum::<Mat2>() / near.len() as f64;
                }
            }
        }
        let straight = |dyad: &Mat2| {
            let ([_, high], low) = principal_pair(dyad);
            // The steepest way should be the growth's; `low` is perpendicular to it.
            high > 1e-3 * whole && low.x.abs() <= within_rad.sin()
        };
        dyads.iter().filter(|dyad| straight(dyad)).count() as f64 / (m * n) as f64
    }

    /// Correlation length along the crests (m): where the correlation of offsets has fallen to one
    /// half. If it has not within half of the window, it is drawn on as a bell curve.
    pub fn correlation_m(&self) -> Option<f64> {
        let [m, n] = self.size;
        let correlation = |lag: usize| {
            let (mut product, mut square) = (0.0, 0.0);
            for j in 0..n - lag {
                for i in 0..m {
                    let (a, b) = (self.at(i, j), self.at(i, j + lag));
                    product += a * b;
                    square += 0.5 * (a * a + b * b);
                }
            }
            product / square
        };
        let mut before = correlation(0);
        if before.is_nan() {
            return None;
        }
        for lag in 1..=n / 2 {
            let here = correlation(lag);
            if here < 0.5 {
                return Some((lag as f64 - (0.5 - here) / (before - here)) * self.spacing_m[1]);
            }
            before = here;
        }
        let last = (n / 2) as f64 * self.spacing_m[1];
        Some(last * (2.0_f64.ln() / -before.min(1.0 - 1e-9).ln()).sqrt())
    }
}

/// Folds along the growth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Folds {
    /// Their spacing (m) on the starting surface.
    pub wavelength_m: f64,
    /// Width of the spectrum's peak at half its height, over its place. Around something, that of
    /// the whole waves that have half of it.
    pub width: f64,
}

/// Realised shares of the asked length and area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RealisedGrowth {
    /// Mean of length over asked length along the growth.
    pub length: f64,
    /// Area over asked area.
    pub area: f64,
}

/// Realised share of the metric `asked`. `along` gives the direction in space along which a face of
/// `start` (`[V]`, m) grows, or none for a face that does not count.
pub fn realised_growth(
    topology: &Topology,
    start: &[Vec3],
    asked: &RestMetric,
    pose: &[Vec3],
    along: impl Fn(usize) -> Option<Vec3>,
) -> RealisedGrowth {
    let (mut length, mut area, mut weight) = (0.0, 0.0, 0.0);
    for f in 0..topology.face_count() {
        let Some(along) = along(f) else { continue };
        let [a, b, c] = topology.faces[f].map(|v| start[v]);
        let (u, v) = (b - a, c - a);
        // Barycentric components of the direction within the face.
        let gram = Mat2::new(u.norm_squared(), u.dot(&v), u.dot(&v), v.norm_squared());
        let Some(inverse) = gram.try_inverse() else { continue };
        let part = inverse * Vec2::new(u.dot(&along), v.dot(&along));
        let [p, q, r] = topology.faces[f].map(|v| pose[v]);
        let [e, g] = asked.faces[f].edges();
        let share = asked.faces[f].area_m2;
        length +=
            share * ((q - p) * part.x + (r - p) * part.y).norm() / (e * part.x + g * part.y).norm();
        area += 0.5 * (q - p).cross(&(r - p)).norm();
        weight += share;
    }
    RealisedGrowth { length: length / weight, area: area / weight }
}

#[cfg(test)]
mod tests {
    use super::*;

    use std::f64::consts::PI;

    const CREST: f64 = 10.0 * PI / 180.0;

    /// A relief of 1 m × 1 m.
    fn relief(offset: impl Fn(f64, f64) -> f64) -> Relief {
        let size = [201, 101];
        let at = |k: usize| offset((k % size[0]) as f64 / 200.0, (k / size[0]) as f64 / 100.0);
        Relief {
            size,
            spacing_m: [1.0 / 200.0, 1.0 / 100.0],
            offset_m: (0..size[0] * size[1]).map(at).collect(),
            around: false,
            steep: false,
        }
    }

    #[test]
    fn waves_are_counted_whatever_their_phase_and_number() {
        for waves in [4.0, 5.0, 7.3, 10.0, 20.0] {
            for phase in [0.0, 1.0, 2.0] {
                let folds = relief(|x, _| 0.3 + (TAU * waves * x + phase).sin()).folds().unwrap();
                assert!(
                    (folds.wavelength_m * waves - 1.0).abs() < 0.02,
                    "{waves} {phase} {folds:?}"
                );
            }
        }
        // The count can be wrong, and is seen to be: half of the folds doubled; flat.
        let doubled =
            relief(|x, _| if x < 0.5 { (TAU * 5.0 * x).sin() } else { (TAU * 10.0 * x).sin() })
                .folds()
                .unwrap();
        let one = relief(|x, _| (TAU * 5.0 * x).sin()).folds().unwrap();
        assert!(doubled.width > 1.5 * one.width || (doubled.wavelength_m * 5.0 - 1.0).abs() > 0.15);
        assert_eq!(relief(|_, _| 0.0).folds(), None);
    }

    #[test]
    fn around_a_ring_folds_are_whole() {
        let chart = [Vec2::zeros(), Vec2::new(3.0, 0.0), Vec2::new(3.0, 1.0), Vec2::new(0.0, 1.0)];
        let faces = [[0, 1, 2], [0, 2, 3]].map(|f: [usize; 3]| (f.map(|v| chart[v]), [0.0; 3]));
        let window = Window { low: Vec2::zeros(), high: Vec2::new(3.0, 1.0) };
        let mut ring = Relief::around(faces.into_iter(), &window, [120, 3]).unwrap();
        assert!((ring.spacing_m[0] - 3.0 / 120.0).abs() < 1e-15 && ring.folds().is_none());
        for waves in [2.0, 3.0, 11.0] {
            ring.offset_m = (0..360)
                .map(|k| (TAU * waves * (k % 120) as f64 / 120.0 + (k / 120) as f64).cos())
                .collect();
            let folds = ring.folds().unwrap();
            assert!(
                (3.0 / folds.wavelength_m - waves).abs() < 1e-12
                    && (folds.width - 1.0 / waves).abs() < 1e-12,
                "{folds:?}"
            );
            // As a window with rims it is read less sharply.
            let open = Relief { around: false, spacing_m: [3.0 / 119.0, 0.5], ..ring.clone() };
            assert!(open.folds().unwrap().width > 1.3 * folds.width);
        }
    }

    #[test]
    fn crests_that_lean_are_told_from_straight_ones() {
        let leaning = |degrees: f64| {
            relief(move |x, y| (TAU * 6.0 * (x + y * (degrees * PI / 180.0).tan())).sin())
        };
        assert!(leaning(0.0).crests_within(CREST, 0.08) > 0.999);
        assert!(leaning(8.0).crests_within(CREST, 0.08) > 0.95);
        assert!(leaning(13.0).crests_within(CREST, 0.08) < 0.05);
        assert!(
            relief(|x, y| if y < 0.5 { (TAU * 6.0 * x).sin() } else { (TAU * 6.0 * y).sin() })
                .crests_within(CREST, 0.05)
                < 0.6
        );
        assert_eq!(relief(|_, _| 0.0).crests_within(CREST, 0.05), 0.0);
    }

    #[test]
    fn correlation_length_follows_how_far_crests_run() {
        // The phase drifts by 1 rad over the length ℓ: the correlation is cos(δ/ℓ), ½ at δ = π/3·ℓ.
        for length in [0.05, 0.1, 0.2] {
            let found = relief(|x, y| (TAU * 6.0 * x + y / length).sin()).correlation_m().unwrap();
            assert!((found / (length * PI / 3.0) - 1.0).abs() < 0.05, "{length} {found}");
        }
        assert!(relief(|x, _| (TAU * 6.0 * x).sin()).correlation_m().unwrap() > 100.0);
        assert_eq!(relief(|_, _| 0.0).correlation_m(), None);
    }

    #[test]
    fn length_and_area_are_held_against_what_was_asked() {
        let start = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::new(1.0, 1.0, 0.0)];
        let topology = Topology::new(4, vec![[0, 1, 2], [2, 1, 3]]).unwrap();
        let asked =
            RestMetric::from_shape(&start.map(|p| Vec3::new(2.0 * p.x, p.y, 0.0)), &topology.faces)
                .unwrap();
        let pose = start.map(|p| Vec3::new(1.5 * p.x, p.y, 0.0));
        let reached = realised_growth(&topology, &start, &asked, &pose, |_| Some(Vec3::x()));
        assert!((reached.length - 0.75).abs() < 1e-12 && (reached.area - 0.75).abs() < 1e-12);
    }

    #[test]
    fn a_mesh_is_read_linearly_and_only_where_it_is() {
        let chart = [Vec2::zeros(), Vec2::x(), Vec2::y(), Vec2::new(1.0, 1.0)];
        let topology = Topology::new(4, vec![[0, 1, 2], [2, 1, 3]]).unwrap();
        let offset: Vec<f64> = chart.iter().map(|p| 2.0 * p.x - p.y).collect();
        let window = Window { low: Vec2::zeros(), high: Vec2::new(1.0, 1.0) };
        let relief = Relief::new(&topology, &chart, &offset, &window, [9, 5]).unwrap();
        assert!((relief.at(3, 2) - (0.75 - 0.5)).abs() < 1e-12);
        let beyond = Window { high: Vec2::new(1.2, 1.0), ..window };
        assert!(
            Relief::new(&topology, &chart, &offset, &beyond, [9, 5])
                .unwrap_err()
                .to_string()
                .contains("beyond")
        );
    }
}
