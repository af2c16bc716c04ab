//! The weights of Loop subdivision: smooth values on a fine mesh are weighted means of those on the
//! coarse one. They are kept as a sparse matrix, so one set of weights serves positions, poses of
//! many frames and scalar fields.
//!
//! Weights of [Loop 1987, *Smooth Subdivision Surfaces Based on Triangles*] with Loop's own β for
//! even vertices, and the cubic B-spline masks 1/8 3/4 1/8 and 1/2 1/2 along boundaries and
//! creases.

use std::f64::consts::TAU;
use std::ops::{Add, Mul};

use rayon::prelude::*;

use super::{NONE, Topology};
use crate::adjacency::Csr;

/// Weights of the fine vertices of a [`super::subdivide::Subdivision`].
#[derive(Clone, Debug, PartialEq)]
pub struct Masks {
    /// `[fine V + 1]` position of each fine vertex's first entry in `columns`, `edges` and
    /// `weights`.
    starts: Vec<usize>,
    /// Coarse vertices that a fine vertex depends on; the first is the one it comes from: itself,
    /// or the lower end of its edge.
    columns: Vec<usize>,
    /// Coarse edge from the first vertex to each; [`NONE`] for the first itself.
    edges: Vec<usize>,
    /// Weight of each; they sum to 1 per fine vertex.
    weights: Vec<f64>,
}

/// Coarse vertices that a fine vertex depends on, with their weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// Coarse vertices; the first is the one it comes from: itself, or the lower end of its edge.
    pub vertices: &'a [usize],
    /// Coarse edge from the first vertex to each; [`NONE`] for the first itself.
    pub edges: &'a [usize],
    /// Weight of each; they sum to 1.
    pub weights: &'a [f64],
}

impl Masks {
    /// As [`super::subdivide::Subdivision::masks`] says; `around` are the edges of `coarse`.
    pub(super) fn new(coarse: &Topology, around: &Csr, crease: &[bool], corner: &[bool]) -> Self {
        assert!(
            crease.is_empty() || crease.len() == coarse.edge_count(),
            "a crease flag for each edge, or none"
        );
        let sharp = |e: usize| coarse.is_boundary_edge(e) || (!crease.is_empty() && crease[e]);
        let (rows, entries) = (
            coarse.vertex_count + coarse.edge_count(),
            coarse.vertex_count + 6 * coarse.edge_count(),
        );
        let mut masks = Self {
            starts: Vec::with_capacity(rows + 1),
            columns: Vec::with_capacity(entries),
            edges: Vec::with_capacity(entries),
            weights: Vec::with_capacity(entries),
        };
        masks.starts.push(0);
        for v in 0..coarse.vertex_count {
            let edges = &around[v];
            let across = |e: usize| coarse.edges[e][0] + coarse.edges[e][1] - v;
            let fixed = corner.get(v).copied().unwrap_or(false);
            match edges.iter().filter(|&&e| sharp(e)).count() {
                _ if fixed => masks.push(v, NONE, 1.0),
                0 | 1 => {
                    let beta = loop_beta(edges.len());
                    masks.push(v, NONE, 1.0 - edges.len() as f64 * beta);
                    edges.iter().for_each(|&e| masks.push(across(e), e, beta));
                }
                2 => {
                    masks.push(v, NONE, 0.75);
                    edges
                        .iter()
                        .filter(|&&e| sharp(e))
                        .for_each(|&e| masks.push(across(e), e, 0.125));
                }
                _ => masks.push(v, NONE, 1.0),
            }
            masks.close();
        }
        for (e, &[i, j]) in coarse.edges.iter().enumerate() {
            if sharp(e) {
                masks.push(i, NONE, 0.5);
                masks.push(j, e, 0.5);
            } else {
                masks.push(i, NONE, 0.375);
                masks.push(j, e, 0.375);
                for f in coarse.edge_faces[e] {
                    let (face, sides) = (coarse.faces[f], coarse.face_edges[f]);
                    let k = coarse.corner_of(f, i);
                    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                    let (opposite, side) = if sides[k] == e {
                        (face[last], sides[last])
                    } else {
                        (face[next], sides[k])
                    };
                    masks.push(opposite, side, 0.125);
                }
            }
            masks.close();
        }
        masks
    }

    /// `[fine V]` values at fine vertices from `coarse` (`[V]`), for scalars or vectors: smoothed
    /// means of their neighbourhood.
    ///
    /// # Panics
    /// If `coarse` has fewer values than the coarse mesh has vertices.
    pub fn apply<T: Copy + Add<Output = T> + Mul<f64, Output = T> + Send + Sync>(
        &self,
        coarse: &[T],
    ) -> Vec<T> {
        let mean = |fine_vertex: usize| {
            let Row { vertices, weights, .. } = self.row(fine_vertex);
            let first = coarse[vertices[0]] * weights[0];
            vertices[1..].iter().zip(&weights[1..]).fold(first, |sum, (&v, &w)| sum + coarse[v] * w)
        };
        (0..self.starts.len() - 1).into_par_iter().with_min_len(LEAST_ROWS).map(mean).collect()
    }

    /// Coarse vertices that fine vertex `v` depends on, with their weights.
    pub fn row(&self, v: usize) -> Row<'_> {
        let entries = self.starts[v]..self.starts[v + 1];
        Row {
            vertices: &self.columns[entries.clone()],
            edges: &self.edges[entries.clone()],
            weights: &self.weights[entries],
        }
    }

    fn push(&mut self, column: usize, edge: usize, weight: f64) {
        self.columns.push(column);
        self.edges.push(edge);
        self.weights.push(weight);
    }

    fn close(&mut self) {
        self.starts.push(self.columns.len());
    }
}

/// Rows that a thread takes at least.
const LEAST_ROWS: usize = 1024;

/// Loop's weight of each of the `n` neighbours of a vertex.
fn loop_beta(n: usize) -> f64 {
    let n = n as f64;
    let c = 0.375 + 0.25 * (TAU / n).cos();
    (0.625 - c * c) / n
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loop_weights_are_those_of_the_thesis() {
        assert!((loop_beta(6) - 1.0 / 16.0).abs() < 1e-15);
        assert!((loop_beta(3) - 3.0 / 16.0).abs() < 1e-15);
        assert!((4.0 * loop_beta(4) - 31.0 / 64.0).abs() < 1e-15);
    }

    #[test]
    fn edges_lead_to_the_vertices_of_a_row() {
        let mesh = Topology::new(5, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [4, 1, 0]]).unwrap();
        let masks = crate::mesh::subdivide::Subdivision::new(&mesh).masks(&[], &[]);
        for v in 0..mesh.vertex_count + mesh.edge_count() {
            let row = masks.row(v);
            assert_eq!(row.edges[0], NONE);
            for (&to, &e) in row.vertices.iter().zip(row.edges).skip(1) {
                let from = row.vertices[0];
                assert_eq!(mesh.edges[e], [from.min(to), from.max(to)], "of fine vertex {v}");
            }
        }
    }
}
