//! Numbers taken from a solved field, to be held against published ones.
//!
//! Waves along a line are counted from the frequency, not the rounded phase: they are real numbers.
//! Only faces with a visible amplitude count, because where there is none the energy does not
//! depend on the frequency and leaves it arbitrary. What lies outside the panel counts nothing.

use super::build::BuiltScene;
use super::probe::{Piece, Probe, Quantity};
use crate::field::{FieldReport, WrinkleField};

/// A face counts as wrinkled if its largest amplitude is above this part both of the field's peak
/// and of the thickness.
const VISIBLE: f64 = 0.01;

/// A number taken from a field or a shell.
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
    /// Source of the published number.
    pub source: Option<String>,
}

/// The scene's measures of `field`, in the scene's order. `field` and `report` must come from
/// `built`.
pub fn measure(built: &BuiltScene, field: &WrinkleField, report: &FieldReport) -> Vec<Measured> {
    let take = |probe: &Probe| {
        let (value, unit) = match &probe.quantity {
            Quantity::LargestPeriod => {
                (report.periods.iter().map(|p| p.turns).max().unwrap_or(0) as f64, "waves")
            }
            Quantity::PeakAmplitude => (field.amplitude_m.iter().copied().fold(0.0, f64::max), "m"),
            Quantity::WavesAlong { pieces, .. } => (waves_along(built, field, pieces), "waves"),
            Quantity::WavesAround { chain } => (waves_around(built, field, chain), "waves"),
        };
        Measured {
            name: probe.name.clone(),
            value,
            unit,
            published: probe.published,
            source: probe.source.clone(),
        }
    };
    built.probes.iter().map(take).collect()
}

fn waves_along(built: &BuiltScene, field: &WrinkleField, pieces: &[Piece]) -> f64 {
    let amplitude_of = |f: usize| {
        built.sheet.topology.faces[f].iter().map(|&v| field.amplitude_m[v]).fold(0.0, f64::max)
    };
    let least = VISIBLE
        * field.amplitude_m.iter().copied().fold(built.sheet.material.thickness_m, f64::max);
    let turns = |piece: &Piece| {
        // Along a common edge both faces say the same, if both are wrinkled.
        let wrinkled: Vec<f64> = piece
            .iter()
            .filter(|(f, _)| !field.wrinkle_free[*f] && amplitude_of(*f) > least)
            .map(|(f, along)| field.frequency(&built.sheet, *f).dot(along).abs())
            .collect();
        if wrinkled.is_empty() { 0.0 } else { wrinkled.iter().sum::<f64>() / wrinkled.len() as f64 }
    };
    pieces.iter().map(turns).sum::<f64>() / std::f64::consts::TAU
}

fn waves_around(built: &BuiltScene, field: &WrinkleField, chain: &[usize]) -> f64 {
    let turn = |pair: &[usize]| {
        let edge = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        let along = built.sheet.topology.edges.binary_search(&edge).map_or(0.0, |e| field.omega[e]);
        if pair[0] < pair[1] { along } else { -along }
    };
    (chain.windows(2).map(turn).sum::<f64>() / std::f64::consts::TAU).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::EnergyTerms;
    use crate::field::Period;
    use crate::linalg::Ending;
    use crate::mesh::Vec2;
    use crate::scene::{build, parse};

    /// A balloon of two disks: the second panel is flipped. The line is replaced by each test.
    fn balloon(panel: &str, from: [f64; 2], to: [f64; 2]) -> BuiltScene {
        let line = format!("panel = \"{panel}\", from_m = {from:?}, to_m = {to:?}");
        let text = format!(
            r#"
            title = "balloon"
            material = {{ young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }}
            panel = [
                {{ name = "front", shape = "disk", radius_m = 1.0, edge_length_m = 0.23 }},
                {{ name = "back", shape = "disk", radius_m = 1.0, edge_length_m = 0.23, seed = 7 }},
            ]
            seam = [{{ a = "front.rim", b = "back.rim" }}]
            clamp = [{{ side = "front.rim" }}]
            measure = [
                {{ name = "waves", kind = "waves_along", {line}, published = 3 }},
                {{ name = "peak", kind = "peak_amplitude" }},
                {{ name = "turns", kind = "largest_period", source = "nobody" }},
            ]"#
        );
        build(&parse("balloon.toml", &text).unwrap()).unwrap()
    }

    /// A field with phase k·(x, y) of the start pose, and amplitude 1 mm.
    fn plane_wave(built: &BuiltScene, k: Vec2) -> WrinkleField {
        let phase = |v: usize| k.x * built.start[v].x + k.y * built.start[v].y;
        WrinkleField {
            amplitude_m: vec![1e-3; built.sheet.topology.vertex_count],
            omega: built.sheet.topology.edges.iter().map(|&[i, j]| phase(j) - phase(i)).collect(),
            phase: built.sheet.topology.faces.iter().map(|face| face.map(phase)).collect(),
            wrinkle_free: vec![false; built.sheet.topology.face_count()],
        }
    }

    fn report(turns: &[i64]) -> FieldReport {
        FieldReport {
            iterations: 0,
            ending: Ending::Converged,
            energy_joule: 0.0,
            energy_terms: EnergyTerms::default(),
            wrinkle_free_energy_joule: 0.0,
            projected_gradient: 0.0,
            periods: turns
                .iter()
                .map(|&turns| Period { turns, before_rounding: 0.0, loop_edges: 3 })
                .collect(),
            rounding_exact: true,
            field_seconds: 0.0,
            phase_seconds: 0.0,
        }
    }

    fn waves(built: &BuiltScene, field: &WrinkleField) -> f64 {
        measure(built, field, &report(&[]))[0].value
    }

    #[test]
    fn a_plane_wave_is_counted_along_any_line() {
        let k = Vec2::new(31.0, -17.0);
        for panel in ["front", "back"] {
            for n in 0..12 {
                let (s, c) = (0.6 * f64::from(n)).sin_cos();
                let (from, to) = ([0.9 * c, 0.9 * s], [-0.7 * s, 0.3 - 0.5 * c]);
                let built = balloon(panel, from, to);
                let expected =
                    k.dot(&(Vec2::from(to) - Vec2::from(from))).abs() / std::f64::consts::TAU;
                let found = waves(&built, &plane_wave(&built, k));
                assert!(
                    (found - expected).abs() < 1e-7 * (1.0 + expected),
                    "{panel} {n}: {found} for {expected}"
                );
            }
        }
    }

    #[test]
    fn edges_that_two_faces_share_count_once_and_outside_counts_nothing() {
        let k = Vec2::new(5.0, 40.0);
        let any = balloon("front", [0.0, 0.0], [0.1, 0.0]);
        let mut tried = 0;
        for (e, &[i, j]) in any
            .sheet
            .topology
            .edges
            .iter()
            .enumerate()
            .filter(|(e, _)| any.sheet.topology.edge_faces[*e][1] < any.panels[0].faces.end)
        {
            // Vertices of the first panel are their own rest vertices.
            let (from, to) =
                (any.sheet.rest_shape.positions[i].xy(), any.sheet.rest_shape.positions[j].xy());
            let built = balloon("front", from.into(), to.into());
            let Quantity::WavesAlong { pieces, .. } = &built.probes[0].quantity else {
                panic!("not a line")
            };
            assert_eq!(
                pieces.iter().map(Vec::len).max(),
                Some(2),
                "edge {e} is shared by two faces"
            );
            let expected = k.dot(&(to - from)).abs() / std::f64::consts::TAU;
            let found = waves(&built, &plane_wave(&built, k));
            assert!((found - expected).abs() < 1e-7, "edge {e}: {found} for {expected}");
            tried += 1;
        }
        assert!(tried > 30);
        // From far outside through the whole panel: a diameter's worth.
        let built = balloon("front", [-5.0, 0.0], [5.0, 0.0]);
        let found = waves(&built, &plane_wave(&built, k));
        let expected = 5.0
            * (any.sheet.rest_shape.positions[0].x - any.sheet.rest_shape.positions[14].x).abs()
            / std::f64::consts::TAU;
        assert!((found - expected).abs() < 0.02 * expected, "{found} for {expected}");
    }

    #[test]
    fn only_visible_wrinkles_count() {
        let built = balloon("front", [-0.8, 0.1], [0.8, 0.1]);
        let mut field = plane_wave(&built, Vec2::new(20.0, 0.0));
        let all = waves(&built, &field);
        for (f, face) in built.sheet.topology.faces.iter().enumerate() {
            field.wrinkle_free[f] = face.iter().all(|&v| built.start[v].x < 0.1);
        }
        let part = waves(&built, &field);
        assert!(part < 0.6 * all && part > 0.3 * all, "{part} of {all}");
        field.wrinkle_free.fill(false);
        for (amplitude, start) in field.amplitude_m.iter_mut().zip(&built.start) {
            *amplitude = if start.x < 0.1 { 0.9e-5 } else { 1e-3 };
        }
        let visible = waves(&built, &field);
        assert!((visible - part).abs() < 1e-12, "{visible} and {part}");
        // Amplitudes below 1 % of the thickness are no wrinkles at all.
        field.amplitude_m.fill(0.9e-6);
        assert_eq!(waves(&built, &field), 0.0);
    }

    #[test]
    fn turns_around_a_side_are_counted_whichever_way_edges_run() {
        let mut built = balloon("front", [-0.5, 0.0], [0.5, 0.0]);
        let mut chain: Vec<usize> =
            (0..built.start.len()).filter(|&v| built.start[v].norm() > 0.999).collect();
        let angle = |v: usize| built.start[v].y.atan2(built.start[v].x);
        chain.sort_by(|&u, &v| angle(u).total_cmp(&angle(v)));
        chain.push(chain[0]);
        // Seven turns of the phase around the middle.
        let turn = |i: usize, j: usize| {
            let step = angle(j) - angle(i);
            7.0 * (step - std::f64::consts::TAU * (step / std::f64::consts::TAU).round())
        };
        let mut field = plane_wave(&built, Vec2::zeros());
        field.omega = built.sheet.topology.edges.iter().map(|&[i, j]| turn(i, j)).collect();
        for reversed in [false, true] {
            if reversed {
                chain.reverse();
            }
            built.probes[0].quantity = Quantity::WavesAround { chain: chain.clone() };
            let turns = measure(&built, &field, &report(&[]))[0].value;
            assert!((turns - 7.0).abs() < 1e-9, "{turns}");
        }
        // Along half of the rim it is half of them.
        built.probes[0].quantity =
            Quantity::WavesAround { chain: chain[..=chain.len() / 2].to_vec() };
        let half = measure(&built, &field, &report(&[]))[0].value;
        assert!((half - 3.5).abs() < 0.3, "{half}");
    }

    #[test]
    fn peaks_and_turns_come_with_unit_and_source() {
        let built = balloon("front", [0.0, 0.0], [0.1, 0.0]);
        let mut field = plane_wave(&built, Vec2::x());
        field.amplitude_m[5] = 2e-3;
        let measured = measure(&built, &field, &report(&[7, 3]));
        let short: Vec<_> = measured
            .iter()
            .map(|m| (m.name.as_str(), m.unit, m.published, m.source.as_deref()))
            .collect();
        assert_eq!(
            short,
            [
                ("waves", "waves", Some(3.0), None),
                ("peak", "m", None, None),
                ("turns", "waves", None, Some("nobody"))
            ]
        );
        assert_eq!((measured[1].value, measured[2].value), (2e-3, 7.0));
        assert_eq!(measure(&built, &field, &report(&[]))[2].value, 0.0);
    }
}
