//! Number of subdivisions with which the wrinkles of a base surface show.

use crate::mesh::Topology;
use crate::sheet::Sheet;

/// Most subdivisions of a wrinkled surface.
pub const MOST_LEVELS: usize = 8;

/// Most faces of a wrinkled surface.
pub const MOST_FACES: usize = 20_000_000;

/// Most fine faces that [`suggest_levels`] allows.
const SUGGESTED_FACES: usize = 1_500_000;

/// Levels after which the median wavelength spans at least eight fine edges, as far as 1.5 million
/// faces allow; at least 2, but no more than make [`MOST_FACES`].
pub fn suggest_levels(sheet: &Sheet, median_wavelength_m: Option<f64>) -> usize {
    let Sheet { topology, rest, .. } = sheet;
    let edge = (rest.area_m2() / topology.face_count() as f64 * 4.0 / 3.0_f64.sqrt()).sqrt();
    let mut levels = 2;
    while topology.face_count() * 4_usize.pow(levels as u32 + 1) <= SUGGESTED_FACES
        && median_wavelength_m
            .is_some_and(|wavelength| edge / f64::from(1 << levels) > wavelength / 8.0)
    {
        levels += 1;
    }
    levels.min(levels_within(topology, MOST_FACES))
}

/// Number of times that `topology` can be subdivided before it has more than `most_faces` faces, at
/// most [`MOST_LEVELS`].
pub fn levels_within(topology: &Topology, most_faces: usize) -> usize {
    let faces = |levels: usize| topology.face_count().saturating_mul(4_usize.pow(levels as u32));
    (1..=MOST_LEVELS).take_while(|&levels| faces(levels) <= most_faces).last().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::mesh::Vec3;
    use crate::mesh::grid::{Diagonal, grid};

    #[test]
    fn levels_follow_the_wavelength_as_far_as_faces_allow() {
        let panel = grid([1.0, 1.0], 0.25, [None, None], Diagonal::Rising).unwrap();
        let positions: Vec<Vec3> =
            panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let material = Material::new(1e6, 0.3, 1e-4).unwrap();
        let sheet = Sheet::from_rest(positions, panel.faces, material).unwrap();
        let levels = |wavelength| suggest_levels(&sheet, wavelength);
        assert_eq!((levels(None), levels(Some(4.0))), (2, 2));
        assert_eq!((levels(Some(0.2)), levels(Some(0.1)), levels(Some(1e-9))), (4, 5, 7));
        assert_eq!(
            [31, 32, 128, usize::MAX].map(|most| levels_within(&sheet.topology, most)),
            [0, 0, 1, MOST_LEVELS]
        );
    }
}
