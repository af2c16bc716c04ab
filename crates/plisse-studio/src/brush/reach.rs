//! The faces around vertices, and the vertices within a brush's reach.

use plisse::adjacency::Csr;
use plisse::mesh::{Vec3 as Wide, reach::Reach};
use plisse_live::Vec3;

use super::pick::Hit;

/// The faces of a mesh, and those around each vertex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VertexFaces {
    /// `[F]` faces.
    faces: Vec<[u32; 3]>,
    /// `[U]` faces around each vertex.
    around: Csr<u32>,
}

impl VertexFaces {
    /// The adjacency of `faces` over `count` vertices.
    pub fn new(faces: &[[u32; 3]], count: usize) -> Self {
        let corners = faces.iter().enumerate();
        let pairs = corners.flat_map(|(f, face)| face.iter().map(move |&v| (v as usize, f as u32)));
        Self { faces: faces.to_vec(), around: Csr::from_pairs(count, pairs) }
    }

    /// Faces around vertex `v`.
    pub fn around(&self, v: u32) -> &[u32] {
        &self.around[v as usize]
    }

    /// Vertices closer to `from` than `radius_m` along the surface in this pose, with their
    /// distances (m), the nearest first. `room` is reused from search to search.
    pub fn reach(
        &self,
        positions: &[Vec3],
        from: &Hit,
        radius_m: f32,
        room: &mut Reach,
    ) -> Vec<(u32, f32)> {
        let face = |f: u32| self.faces[f as usize].map(|v| v as usize);
        let around = |v: usize| self.around(v as u32).iter().map(|&f| face(f));
        let wide = |p: &Vec3| Wide::new(f64::from(p.x), f64::from(p.y), f64::from(p.z));
        let found = room.from(
            face(from.face as u32),
            &wide(&from.position),
            around,
            |v| wide(&positions[v]),
            f64::from(radius_m),
        );
        found.into_iter().map(|(v, distance_m)| (v as u32, distance_m as f32)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brush::pick::nearest;
    use plisse_live::models;
    use plisse_live::weld::WeldedMesh;

    #[test]
    fn on_a_flat_square_distances_are_straight() {
        let welded = WeldedMesh::new(&models::square().unwrap(), 1e-5);
        let (x, faces) = (&welded.vertices.positions, &welded.faces);
        let surface = VertexFaces::new(faces, welded.count());
        for place in [Vec3::new(0.31, 0.42, 0.0), Vec3::new(0.02, 0.97, 0.0), x[5]] {
            let from = nearest(x, faces, &place).unwrap();
            let found = surface.reach(x, &from, 0.4, &mut Reach::new(x.len()));
            let within =
                (0..x.len()).filter(|&v| (x[v] - from.position).norm() < 0.4 - 1e-3).count();
            assert!(found.len() >= within && within > 10, "{} of {within}", found.len());
            for (v, d) in found {
                let straight = (x[v as usize] - from.position).norm();
                assert!((d - straight).abs() < 1e-3, "{v}: {d} for {straight}");
            }
        }
    }

    #[test]
    fn around_a_sleeve_distances_follow_the_cloth_and_not_the_air() {
        let welded = WeldedMesh::new(&models::sleeve(), 1e-5);
        let (x, faces) = (&welded.vertices.positions, &welded.faces);
        let surface = VertexFaces::new(faces, welded.count());
        let from = nearest(x, faces, &Vec3::new(0.3, 0.06, 0.0)).unwrap();
        let found = surface.reach(x, &from, 0.3, &mut Reach::new(x.len()));
        // The far side lies π·6 cm away, 12 cm through the air; the mesh has 20 sides, which
        // shortens by 0.4 %.
        let far = found
            .iter()
            .filter(|(v, _)| (x[*v as usize] - Vec3::new(0.3, -0.06, 0.0)).norm() < 1e-3)
            .map(|f| f.1)
            .next()
            .unwrap();
        assert!((far - std::f32::consts::PI * 0.06).abs() < 0.03 * far, "{far}");
        // The texture seam at +y lies beside the start: both of its sides are found alike.
        let beside = |z: f32| {
            found
                .iter()
                .filter(|(v, _)| {
                    (x[*v as usize].x - 0.3).abs() < 1e-4 && x[*v as usize].z * z > 1e-3
                })
                .count()
        };
        assert_eq!(beside(1.0), beside(-1.0));
    }
}
