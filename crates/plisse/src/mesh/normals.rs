//! Unit normals of vertices: the sum of the normals of the faces around each, weighted by area.

use super::{Topology, Vec3};
use crate::Result;
use crate::error::MeshError;

/// `[V]` unit normals of the surface `positions` (`[V]`, m), faces weighted by area; zero where all
/// faces around are degenerate.
pub fn vertex_normals(topology: &Topology, positions: &[Vec3]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); topology.vertex_count];
    for &[i, j, k] in &topology.faces {
        let n = (positions[j] - positions[i]).cross(&(positions[k] - positions[i]));
        for v in [i, j, k] {
            normals[v] += n;
        }
    }
    for n in &mut normals {
        *n = n.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
    }
    normals
}

/// [`vertex_normals`] of a surface that must have one at every vertex.
///
/// # Errors
/// [`MeshError::NoNormal`] naming a vertex whose faces have no area, or cancel to below 1e-9 of
/// the sum of their areas.
pub fn try_vertex_normals(topology: &Topology, positions: &[Vec3]) -> Result<Vec<Vec3>> {
    let mut sums = vec![(Vec3::zeros(), 0.0); topology.vertex_count];
    for face in &topology.faces {
        let [a, b, c] = face.map(|v| positions[v]);
        let normal = (b - a).cross(&(c - a));
        for &v in face {
            sums[v].0 += normal;
            sums[v].1 += normal.norm();
        }
    }
    let unit = |(vertex, (sum, size)): (usize, &(Vec3, f64))| {
        sum.try_normalize(1e-9 * size)
            .filter(|normal| normal.iter().all(|x| x.is_finite()))
            .ok_or_else(|| MeshError::NoNormal { vertex }.into())
    };
    sums.iter().enumerate().map(unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    #[test]
    fn normals_are_means_weighted_by_area() {
        let topology = Topology::new(4, vec![[0, 1, 2], [0, 3, 1]]).unwrap();
        // In the plane z = 0, and, half as large, in the plane y = 0.
        let positions = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::new(0.0, 0.0, 0.5)];
        let normals = vertex_normals(&topology, &positions);
        let mean = Vec3::new(0.0, 0.5, 1.0).normalize();
        for (normal, expected) in normals.iter().zip([mean, mean, Vec3::z(), Vec3::y()]) {
            assert!((normal - expected).norm() < 1e-15);
        }
        assert_eq!(try_vertex_normals(&topology, &positions).unwrap(), normals);
    }

    #[test]
    fn faces_that_cancel_have_no_normal() {
        let topology = Topology::new(4, vec![[0, 1, 2], [0, 3, 1]]).unwrap();
        let folded_shut = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::y()];
        assert_eq!(vertex_normals(&topology, &folded_shut)[0], Vec3::zeros());
        let error = try_vertex_normals(&topology, &folded_shut).unwrap_err();
        assert!(matches!(error, Error::Mesh { problem: MeshError::NoNormal { vertex: 0 }, .. }));
    }
}
