//! Wrinkle-free faces: those under pure tension.

use crate::mesh::Topology;
use crate::strain::FaceStrain;

/// Rule by which wrinkle-free faces are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WrinkleFreeRule {
    /// Section 5.1 of [Chen 2021]: the lower principal strain, averaged with the neighbours', is
    /// positive; then lonely faces leave and lonely holes are filled.
    #[default]
    Paper,
    /// The rule of the published code: the lower principal strain is not negative, and every face
    /// all of whose vertices touch such a face.
    Published,
}

/// Compression below this is rounding, not strain: an undeformed pose has no wrinkles.
const ROUNDING: f64 = 1e-10;

/// `[F]` true for wrinkle-free faces.
pub fn wrinkle_free_faces(
    topology: &Topology,
    strain: &[FaceStrain],
    rule: WrinkleFreeRule,
) -> Vec<bool> {
    match rule {
        WrinkleFreeRule::Paper => by_paper(topology, strain),
        WrinkleFreeRule::Published => by_published_code(topology, strain),
    }
}

/// `[V]` true for vertices of a wrinkle-free face: the amplitude is zero there.
pub fn wrinkle_free_vertices(topology: &Topology, wrinkle_free: &[bool]) -> Vec<bool> {
    let mut touched = vec![false; topology.vertex_count];
    for (face, _) in topology.faces.iter().zip(wrinkle_free).filter(|(_, free)| **free) {
        for &v in face {
            touched[v] = true;
        }
    }
    touched
}

fn by_paper(topology: &Topology, strain: &[FaceStrain]) -> Vec<bool> {
    let neighbours = |f: usize| (0..3).filter_map(move |k| topology.neighbour(f, k));
    let averaged: Vec<bool> = (0..topology.face_count())
        .map(|f| {
            let (mut sum, mut count) = (strain[f].principal[0], 1.0);
            for g in neighbours(f) {
                sum += strain[g].principal[0];
                count += 1.0;
            }
            sum / count > -ROUNDING
        })
        .collect();
    (0..topology.face_count())
        .map(|f| {
            let (inside, all) = neighbours(f)
                .fold((0, 0), |(inside, all), g| (inside + usize::from(averaged[g]), all + 1));
            if averaged[f] { inside > 0 || all == 0 } else { all == 3 && inside == 3 }
        })
        .collect()
}

fn by_published_code(topology: &Topology, strain: &[FaceStrain]) -> Vec<bool> {
    let seed: Vec<bool> = strain.iter().map(|s| s.principal[0] >= -ROUNDING).collect();
    let touched = wrinkle_free_vertices(topology, &seed);
    topology
        .faces
        .iter()
        .zip(&seed)
        .map(|(face, &free)| free || face.iter().all(|&v| touched[v]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mat3x2;

    fn state(low: f64) -> FaceStrain {
        FaceStrain::new(Mat3x2::new((1.0 + low).sqrt(), 0.0, 0.0, 1.2, 0.0, 0.0))
    }

    /// A strip of `n` triangles.
    fn strip(n: usize) -> Topology {
        let faces = (0..n)
            .map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] })
            .collect();
        Topology::new(n + 2, faces).unwrap()
    }

    #[test]
    fn the_papers_rule_smooths_and_drops_lonely_faces() {
        let t = strip(9);
        // One tense face among pressed ones leaves; one weakly pressed face among tense ones joins.
        let lonely: Vec<_> = (0..9).map(|f| state(if f == 4 { 0.01 } else { -0.1 })).collect();
        assert!(wrinkle_free_faces(&t, &lonely, WrinkleFreeRule::Paper).iter().all(|f| !f));
        let dent: Vec<_> = (0..9).map(|f| state(if f == 4 { -0.01 } else { 0.1 })).collect();
        assert!(wrinkle_free_faces(&t, &dent, WrinkleFreeRule::Paper).iter().all(|f| *f));
    }

    #[test]
    fn an_undeformed_sheet_has_no_wrinkles() {
        let t = strip(9);
        let strains: Vec<_> =
            (0..9).map(|f| state(if f % 2 == 0 { 1e-15 } else { -1e-15 })).collect();
        for rule in [WrinkleFreeRule::Paper, WrinkleFreeRule::Published] {
            assert!(wrinkle_free_faces(&t, &strains, rule).iter().all(|f| *f));
        }
    }

    #[test]
    fn the_published_rule_adds_faces_that_touch_all_round() {
        let t = strip(9);
        let strains: Vec<_> =
            (0..9).map(|f| state(if f == 2 || f == 5 { 0.01 } else { -0.1 })).collect();
        let free = wrinkle_free_faces(&t, &strains, WrinkleFreeRule::Published);
        // Face 2 has vertices 2..=4 and face 5 has 5..=7, so faces 3 (3, 4, 5) and 4 (4, 5, 6) are
        // surrounded.
        assert_eq!(free, [false, false, true, true, true, true, false, false, false]);
    }
}
