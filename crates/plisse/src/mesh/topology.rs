//! Connectivity of a triangle mesh: edges, and who touches whom. Positions live elsewhere, because
//! the same connectivity carries a rest shape, a pose and fields.

use crate::Result;
use crate::adjacency::{Csr, NONE};
use crate::error::MeshError;

/// Connectivity of an orientable manifold triangle mesh (with or without boundary). Never changes
/// after it is built.
///
/// Vertices, edges and faces are counted from 0. Edges are sorted, so their numbers do not depend
/// on the order of the faces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topology {
    /// Number of vertices, `V`.
    pub vertex_count: usize,
    /// `[F][3]` vertices of each face, counter-clockwise seen from outside.
    pub faces: Vec<[usize; 3]>,
    /// `[E][2]` end vertices of each edge, lower first; sorted lexicographically.
    pub edges: Vec<[usize; 2]>,
    /// `[F][3]` edge from corner `k` to corner `(k+1)%3` of each face.
    pub face_edges: Vec<[usize; 3]>,
    /// `[E][2]` faces on each edge; the second is [`NONE`] on the boundary. The lower face comes
    /// first.
    pub edge_faces: Vec<[usize; 2]>,
}

impl Topology {
    /// Connectivity of `faces` (`[F][3]`) over `vertex_count` vertices.
    ///
    /// # Errors
    /// [`MeshError`]: no face, an index out of range, a face with a repeated vertex, an isolated
    /// vertex, an edge on three or more faces, two faces that run along their common edge in the
    /// same direction.
    pub fn new(vertex_count: usize, faces: Vec<[usize; 3]>) -> Result<Self> {
        let mut half_edges = half_edges(vertex_count, &faces)?;
        half_edges.sort_unstable();
        let mut edges: Vec<[usize; 2]> = Vec::with_capacity(half_edges.len() / 2 + 1);
        let mut edge_faces: Vec<[usize; 2]> = Vec::with_capacity(half_edges.len() / 2 + 1);
        let mut face_edges = vec![[NONE; 3]; faces.len()];
        for same in half_edges.chunk_by(|a, b| a.0 == b.0) {
            let (edge, f, _, forward) = same[0];
            let second = match same {
                [_] => NONE,
                [_, (_, g, _, other_forward)] if forward != *other_forward => *g,
                [_, (_, g, ..)] => {
                    return Err(MeshError::InconsistentOrientation { faces: [f, *g], edge }.into());
                }
                _ => {
                    let faces = same.iter().map(|half_edge| half_edge.1).collect();
                    return Err(MeshError::NonManifoldEdge { edge, faces }.into());
                }
            };
            for &(_, f, k, _) in same {
                face_edges[f][k] = edges.len();
            }
            edges.push(edge);
            edge_faces.push([f, second]);
        }
        Ok(Self { vertex_count, faces, edges, face_edges, edge_faces })
    }

    /// Number of faces, `F`.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Number of edges, `E`.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// True if only one face touches edge `e`.
    pub fn is_boundary_edge(&self, e: usize) -> bool {
        self.edge_faces[e][1] == NONE
    }

    /// `[V]` true if each vertex lies on the boundary.
    pub fn boundary_vertices(&self) -> Vec<bool> {
        let mut on_boundary = vec![false; self.vertex_count];
        for e in 0..self.edge_count() {
            if self.is_boundary_edge(e) {
                on_boundary[self.edges[e][0]] = true;
                on_boundary[self.edges[e][1]] = true;
            }
        }
        on_boundary
    }

    /// `+1` if face `f` runs from corner `k` to `k+1` from the lower to the higher vertex, else
    /// `-1`: the sign with which a one-form on [`Topology::edges`] enters face `f` along its side
    /// `k`.
    pub fn side_sign(&self, f: usize, k: usize) -> f64 {
        if self.faces[f][k] < self.faces[f][(k + 1) % 3] { 1.0 } else { -1.0 }
    }

    /// The face across side `k` of face `f`, if there is one.
    pub fn neighbour(&self, f: usize, k: usize) -> Option<usize> {
        let [a, b] = self.edge_faces[self.face_edges[f][k]];
        let other = if a == f { b } else { a };
        (other != NONE).then_some(other)
    }

    /// The corner (0..3) of face `f` that is vertex `v`.
    ///
    /// # Panics
    /// If `v` is no corner of `f`.
    pub fn corner_of(&self, f: usize, v: usize) -> usize {
        self.faces[f].iter().position(|&u| u == v).expect("the vertex is a corner of the face")
    }

    /// `[V]` neighbouring vertices of each vertex, ascending.
    pub fn vertex_neighbours(&self) -> Csr {
        let both = self.edges.iter().flat_map(|&[i, j]| [(i, j), (j, i)]);
        let mut neighbours = Csr::from_pairs(self.vertex_count, both);
        neighbours.rows_mut().for_each(<[usize]>::sort_unstable);
        neighbours
    }

    /// `[V]` edges at each vertex, ascending.
    pub fn vertex_edges(&self) -> Csr {
        let ends = self.edges.iter().enumerate().flat_map(|(e, &[i, j])| [(i, e), (j, e)]);
        Csr::from_pairs(self.vertex_count, ends)
    }

    /// `[V]` faces around each vertex, ascending.
    pub fn vertex_faces(&self) -> Csr {
        faces_around(self.vertex_count, &self.faces)
    }
}

/// `[V]` faces around each vertex, ascending, of any `faces` (`[F][3]`).
///
/// # Panics
/// If a face names a vertex that does not exist.
pub(super) fn faces_around(vertex_count: usize, faces: &[[usize; 3]]) -> Csr {
    let corners = faces.iter().enumerate().flat_map(|(f, face)| face.map(|v| (v, f)));
    Csr::from_pairs(vertex_count, corners)
}

/// One side of a face: its edge with the lower vertex first, the face, the corner at which the side
/// begins, and true if it runs from the lower to the higher vertex.
type HalfEdge = ([usize; 2], usize, usize, bool);

/// The sides of all faces, which together must use every vertex.
fn half_edges(vertex_count: usize, faces: &[[usize; 3]]) -> Result<Vec<HalfEdge>> {
    if faces.is_empty() {
        return Err(MeshError::NoFaces.into());
    }
    let mut used = vec![false; vertex_count];
    let mut half_edges = Vec::with_capacity(3 * faces.len());
    for (f, face) in faces.iter().enumerate() {
        for k in 0..3 {
            let (i, j) = (face[k], face[(k + 1) % 3]);
            if i >= vertex_count {
                return Err(MeshError::IndexOutOfRange { face: f, vertex: i, vertex_count }.into());
            }
            if i == j {
                return Err(MeshError::RepeatedVertex { face: f, vertex: i }.into());
            }
            used[i] = true;
            half_edges.push(([i.min(j), i.max(j)], f, k, i < j));
        }
    }
    match used.iter().position(|used| !used) {
        Some(vertex) => Err(MeshError::IsolatedVertex { vertex }.into()),
        None => Ok(half_edges),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{At, Error};

    #[test]
    fn two_triangles_share_one_edge() {
        let t = Topology::new(4, vec![[0, 1, 2], [2, 1, 3]]).unwrap();
        assert_eq!(t.edges, [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(t.face_edges, [[0, 2, 1], [2, 3, 4]]);
        assert_eq!(t.edge_faces[2], [0, 1]);
        assert_eq!(t.neighbour(0, 1), Some(1));
        assert_eq!(t.neighbour(0, 0), None);
        assert_eq!((t.side_sign(0, 0), t.side_sign(1, 0)), (1.0, -1.0));
        assert!(t.boundary_vertices().iter().all(|&b| b));
    }

    /// A mesh that is refused: number of vertices, faces, the fault, and its sentence.
    type Refused = (usize, Vec<[usize; 3]>, MeshError, &'static str);

    fn refused() -> Vec<Refused> {
        vec![
            (3, vec![], MeshError::NoFaces, "the mesh has no faces; give a triangle mesh"),
            (
                3,
                vec![[0, 1, 7]],
                MeshError::IndexOutOfRange { face: 0, vertex: 7, vertex_count: 3 },
                "face 0 names vertex 7, but there are only 3 vertices; correct the index",
            ),
            (
                3,
                vec![[0, 1, 2], [0, 1, 1]],
                MeshError::RepeatedVertex { face: 1, vertex: 1 },
                "face 1 names vertex 1 twice; remove the face",
            ),
            (
                4,
                vec![[0, 1, 2]],
                MeshError::IsolatedVertex { vertex: 3 },
                "vertex 3 belongs to no face; remove the isolated vertex",
            ),
            (
                5,
                vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
                MeshError::NonManifoldEdge { edge: [0, 1], faces: vec![0, 1, 2] },
                "edge 0-1 is shared by 3 faces (among them 0 and 1); split the mesh there so that \
                 at most two meet",
            ),
            (
                4,
                vec![[0, 1, 2], [0, 1, 3]],
                MeshError::InconsistentOrientation { faces: [0, 1], edge: [0, 1] },
                "faces 0 and 1 disagree about which side is outside (edge 0-1); flip one of them",
            ),
        ]
    }

    #[test]
    fn each_refusal_is_a_variant_with_its_fields_and_a_sentence() {
        for (vertex_count, faces, expected, sentence) in refused() {
            let error = Topology::new(vertex_count, faces).at("m.obj").unwrap_err();
            assert_eq!(error.to_string(), format!("m.obj: {sentence}"));
            let Error::Mesh { place, problem } = error else { panic!("{error}") };
            assert_eq!((&*place, problem), ("m.obj", expected));
        }
    }
}
