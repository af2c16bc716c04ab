//! Numbers taken from a shell that resolves its wrinkles, to be held against published ones and
//! against the field's.
//!
//! Waves along a line are counted as one counts them by eye: ups and downs of the shell's height
//! over the base surface. A change counts if it is at least a fifth of the largest height
//! difference along the line and a hundredth of the thickness.

use super::build::BuiltScene;
use super::measure::Measured;
use super::probe::{Crossing, Probe, Quantity};
use crate::mesh::Vec3;
use crate::mesh::normals::vertex_normals;

/// Part of the largest height difference from which an up or down is a wrinkle.
const VISIBLE: f64 = 0.2;
/// Part of the thickness below which nothing is a wrinkle.
const LEAST: f64 = 0.01;

/// `[V]` height (m) of the shell pose `shell` (`[V]`, m) over the base surface `base` (`[V]`, m),
/// along the base surface's normals.
pub fn heights_m(built: &BuiltScene, base: &[Vec3], shell: &[Vec3]) -> Vec<f64> {
    let normals = vertex_normals(&built.sheet.topology, base);
    (0..base.len()).map(|v| (shell[v] - base[v]).dot(&normals[v])).collect()
}

/// Those of the scene's measures that make sense for the shell pose `shell` (`[V]`, m) over the
/// base surface `base` (`[V]`, m).
pub fn measure_shell(built: &BuiltScene, base: &[Vec3], shell: &[Vec3]) -> Vec<Measured> {
    let height = heights_m(built, base, shell);
    let take = |probe: &Probe| {
        let (value, unit) = match &probe.quantity {
            Quantity::LargestPeriod => return None,
            Quantity::PeakAmplitude => {
                let (low, high) = height
                    .iter()
                    .fold((0.0_f64, 0.0_f64), |(low, high), &h| (low.min(h), high.max(h)));
                (0.5 * (high - low), "m")
            }
            Quantity::WavesAlong { crossings, .. } => {
                let corners = |f: usize| built.sheet.topology.faces[f];
                let at = |(f, w): &Crossing| (0..3).map(|k| w[k] * height[corners(*f)[k]]).sum();
                let place = |(f, w): &Crossing| (0..3).map(|k| base[corners(*f)[k]] * w[k]).sum();
                (
                    waves(
                        built,
                        crossings.iter().map(at).collect(),
                        crossings.iter().map(place).collect(),
                    ),
                    "waves",
                )
            }
            Quantity::WavesAround { chain } => (
                waves(
                    built,
                    chain.iter().map(|&v| height[v]).collect(),
                    chain.iter().map(|&v| base[v]).collect(),
                ),
                "waves",
            ),
        };
        Some(Measured {
            name: probe.name.clone(),
            value,
            unit,
            published: probe.published,
            source: probe.source.clone(),
        })
    };
    built.probes.iter().filter_map(take).collect()
}

/// Waves of the heights `line` (m) at the points `places` (m) of a line.
fn waves(built: &BuiltScene, mut line: Vec<f64>, places: Vec<Vec3>) -> f64 {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return 0.0 };
    let length: f64 = places.windows(2).map(|pair| (pair[0] - pair[1]).norm()).sum();
    let closed = (first - last).norm() < 1e-6 * length;
    if closed {
        // Start at the lowest point, so that no wave is cut in two.
        line.pop();
        let lowest = (0..line.len()).min_by(|&i, &j| line[i].total_cmp(&line[j])).unwrap_or(0);
        line.rotate_left(lowest);
        line.push(line[0]);
    }
    let (low, high) = line
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &h| (low.min(h), high.max(h)));
    count_waves(&line, (VISIBLE * (high - low)).max(LEAST * built.sheet.material.thickness_m))
}

/// Half the number of ups and downs by at least `least` along `heights`.
fn count_waves(heights: &[f64], least: f64) -> f64 {
    let Some(&first) = heights.first() else { return 0.0 };
    // The extremes since the last turn, and whether the line rises since then.
    let (mut low, mut high, mut rising, mut swings) = (first, first, None, 0);
    for &h in heights {
        (low, high) = (low.min(h), high.max(h));
        if rising != Some(true) && h - low >= least {
            (rising, high, swings) = (Some(true), h, swings + 1);
        } else if rising != Some(false) && high - h >= least {
            (rising, low, swings) = (Some(false), h, swings + 1);
        }
    }
    0.5 * f64::from(swings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{build, parse};

    #[test]
    fn waves_are_counted_as_by_eye() {
        let wave = |n: f64, phase: f64| -> Vec<f64> {
            (0..=1000)
                .map(|i| (i as f64 / 1000.0 * n * std::f64::consts::TAU + phase).sin())
                .collect()
        };
        // Whole waves from trough to trough; ripples of a tenth do not count.
        assert_eq!(count_waves(&wave(7.0, -std::f64::consts::FRAC_PI_2), 0.4), 7.0);
        let rippled: Vec<f64> = wave(7.0, -std::f64::consts::FRAC_PI_2)
            .iter()
            .zip(wave(83.0, 0.3))
            .map(|(a, b)| a + 0.1 * b)
            .collect();
        assert_eq!(count_waves(&rippled, 0.4), 7.0);
        assert!((count_waves(&wave(7.0, 1.0), 0.4) - 7.0).abs() <= 0.5);
        assert_eq!(count_waves(&[3.0; 10], 0.4), 0.0);
        assert_eq!(count_waves(&[], 0.4), 0.0);
    }

    #[test]
    fn a_wavy_cylinder_has_its_waves() {
        let text = concat!(
            r#"
            title = "cuff"
            material = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }
            panel = [{ name = "p", shape = "rectangle", width_m = 6.283185307179586, "#,
            r#"height_m = 1.0, edge_length_m = 0.08,
                       place = { kind = "rolled", radius_m = 1.0 } }]
            seam = [{ a = "p.left", b = "p.right", reversed = true }]
            clamp = [{ side = "p.bottom" }]
            measure = [{ name = "n", kind = "waves_along", panel = "p", from_m = [0.0, 0.5], "#,
            r#"to_m = [6.283185307179586, 0.5] },
                       { name = "a", kind = "peak_amplitude" }, { name = "l", "#,
            r#"kind = "largest_period" }]"#
        );
        let built = build(&parse("cuff.toml", text).unwrap()).unwrap();
        let wavy: Vec<Vec3> = built
            .start
            .iter()
            .map(|p| {
                let r = 1.0 + 0.01 * (9.0 * p.y.atan2(p.x)).cos();
                Vec3::new(p.x * r, p.y * r, p.z)
            })
            .collect();
        let measured = measure_shell(&built, &built.start, &wavy);
        assert_eq!(measured.len(), 2);
        assert_eq!(measured[0].value, 9.0);
        assert!((measured[1].value - 0.01).abs() < 3e-4, "{}", measured[1].value);
    }
}
