//! Surfaces that no foundation, or little of it, holds to their start: the remaining share of the
//! foundation, and imperfections whose forces are in equilibrium.
//!
//! On a foundation, imperfections are offsets at which it is at rest. Without one they are offsets
//! w₀ at which *bending* is at rest: a plate that was never quite flat. Its energy ½|R(u − w₀N)|²
//! differs from that of a flat one by the dead forces RᵀR·w₀N, which have neither a sum nor a
//! moment, so that a free plate does not drift.

use super::film::bending_rows;
use crate::mesh::Vec3;
use crate::shell::Setup;

/// Share of the foundation where `hold` is 0 (no unit): too little to be seen, enough to fix place
/// and direction in space.
const LEAST: f64 = 1e-6;

/// Share of the foundation where `hold` asks for this one.
pub(super) fn share(hold: f64) -> f64 {
    hold.max(LEAST)
}

/// Share of the foundation that is missing.
pub(super) fn missing(hold: f64) -> f64 {
    (1.0 - hold).max(0.0)
}

/// Vertices and forces (N) of a film that would be at rest with the offsets `rest_offset_m` (`[V]`,
/// m); none if they are all 0. `thickness` is that of [`super::film::Film::new`].
pub(super) fn forces_newton(
    setup: &Setup<'_>,
    thickness: &[f64],
    rest_offset_m: &[Vec3],
) -> Vec<(usize, Vec3)> {
    if rest_offset_m.iter().all(|w| *w == Vec3::zeros()) {
        return Vec::new();
    }
    let mut forces = vec![Vec3::zeros(); rest_offset_m.len()];
    for row in &bending_rows(setup, thickness).rows {
        let bent: Vec3 = row.iter().map(|&(v, c)| rest_offset_m[v] * c).sum();
        row.iter().for_each(|&(v, c)| forces[v] += bent * (2.0 * c));
    }
    forces.into_iter().enumerate().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::mesh::Topology;
    use crate::mesh::grid::{Diagonal, grid};
    use crate::sheet::Sheet;
    use crate::shell::Clamps;

    #[test]
    fn imperfections_of_a_free_plate_push_and_turn_nothing() {
        let panel = grid([1.0, 0.7], 0.1, [None, None], Diagonal::Rising).unwrap();
        let start: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new(start.len(), panel.faces).unwrap();
        let material = Material::new(1e5, 0.0, 0.01).unwrap();
        let sheet = Sheet::from_rest(start.clone(), topology.faces.clone(), material).unwrap();
        let clamps = Clamps::none(start.len());
        let setup = Setup::new(&sheet, &clamps);
        let thickness = vec![1.0; topology.face_count()];
        let rough: Vec<Vec3> = start
            .iter()
            .map(|p| Vec3::z() * (0.01 * (9.0 * p.x).sin() * (7.0 * p.y).cos()))
            .collect();
        let forces = forces_newton(&setup, &thickness, &rough);
        let size: f64 = forces.iter().map(|(_, f)| f.norm()).sum();
        let sum: Vec3 = forces.iter().map(|(_, f)| *f).sum();
        let moment: Vec3 = forces.iter().map(|&(v, f)| start[v].cross(&f)).sum();
        assert!(
            size > 0.0 && sum.norm() < 1e-9 * size && moment.norm() < 1e-9 * size,
            "{size} {sum} {moment}"
        );
        assert!(forces_newton(&setup, &thickness, &vec![Vec3::zeros(); start.len()]).is_empty());
        assert_eq!((share(0.0), share(0.5), missing(0.25), missing(3.0)), (LEAST, 0.5, 0.75, 0.0));
    }
}
