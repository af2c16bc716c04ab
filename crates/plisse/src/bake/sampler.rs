//! Height and gradient of a wrinkle field.

use super::maps::Sample;
use crate::field::WrinkleField;
use crate::mesh::{Topology, Vec3};

/// Samples for [`super::bake`] of `field` over the posed surface `positions` (`[V]`, m): h =
/// a·cos φ and ∇h = cos φ·∇a − a·sin φ·∇φ, amplitude a and phase φ being linear over each face.
/// Wrinkle-free faces are flat.
pub fn field_sampler<'a>(
    topology: &'a Topology,
    positions: &[Vec3],
    field: &'a WrinkleField,
) -> impl Fn(usize, [f64; 3]) -> Sample + Sync + 'a {
    let gradients: Vec<[Vec3; 2]> = (0..topology.face_count())
        .map(|f| {
            let face = topology.faces[f];
            let corners = face.map(|v| positions[v]);
            [
                gradient(&corners, &face.map(|v| field.amplitude_m[v])),
                gradient(&corners, &field.phase[f]),
            ]
        })
        .collect();
    move |f, weights| {
        if field.wrinkle_free[f] {
            return Sample::default();
        }
        let blend = |values: [f64; 3]| {
            values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
        };
        let amplitude_m = blend(topology.faces[f].map(|v| field.amplitude_m[v]));
        let (sin, cos) = blend(field.phase[f]).sin_cos();
        let [of_amplitude, of_phase] = gradients[f];
        Sample {
            height_m: amplitude_m * cos,
            gradient: of_amplitude * cos - of_phase * (amplitude_m * sin),
        }
    }
}

/// Gradient (1/m) of the linear function with these values at the corners; zero on faces without an
/// area.
fn gradient(corners: &[Vec3; 3], values: &[f64; 3]) -> Vec3 {
    let (side_b, side_c) = (corners[1] - corners[0], corners[2] - corners[0]);
    let twice = side_b.cross(&side_c);
    let Some(n) = twice.try_normalize(0.0) else { return Vec3::zeros() };
    let sum =
        side_c.cross(&n) * (values[1] - values[0]) + n.cross(&side_b) * (values[2] - values[0]);
    let gradient = sum / twice.norm();
    if gradient.iter().all(|x| x.is_finite()) { gradient } else { Vec3::zeros() }
}
