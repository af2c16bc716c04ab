//! Connectivity of a triangle mesh: edges, and who touches whom. Positions live elsewhere, because
//! the same connectivity carries a rest shape, a pose and fields.

use crate::{Error, Result};

/// "No such face": the second entry of [`Topology::edge_faces`] on a boundary edge.
pub const NONE: usize = usize::MAX;

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
    /// [`Error::Mesh`] naming face or edge for: an index out of range, a face with a repeated vertex, an edge on three or more
    /// faces, two faces that run along their common edge in the same direction (inconsistent
    /// orientation), an isolated vertex.
    pub fn new(place: &str, vertex_count: usize, faces: Vec<[usize; 3]>) -> Result<Self> {
        if faces.is_empty() {
            return Err(Error::mesh(place, "the mesh has no faces; give a triangle mesh"));
        }
        let mut used = vec![false; vertex_count];
        let mut half_edges = Vec::with_capacity(3 * faces.len());
        for (f, &face) in faces.iter().enumerate() {
            for k in 0..3 {
                let (i, j) = (face[k], face[(k + 1) % 3]);
                if i >= vertex_count {
                    return Err(Error::mesh(
                        place,
                        format!(
                            "face {f} names vertex {i}, but there are only {vertex_count} \
                             vertices; correct the index"
                        ),
                    ));
                }
                if i == j {
                    return Err(Error::mesh(
                        place,
                        format!("face {f} names vertex {i} twice; remove the face"),
                    ));
                }
                used[i] = true;
                half_edges.push(([i.min(j), i.max(j)], f, k, i < j));
            }
        }
        if let Some(v) = used.iter().position(|u| !u) {
            return Err(Error::mesh(
                place,
                format!("vertex {v} belongs to no face; remove the isolated vertex"),
            ));
        }
        half_edges.sort_unstable();
        let mut edges: Vec<[usize; 2]> = Vec::with_capacity(half_edges.len() / 2 + 1);
        let mut edge_faces: Vec<[usize; 2]> = Vec::with_capacity(half_edges.len() / 2 + 1);
        let mut face_edges = vec![[NONE; 3]; faces.len()];
        let mut rest = &half_edges[..];
        while let Some(&(edge, f, k, forward)) = rest.first() {
            let count = rest.iter().take_while(|h| h.0 == edge).count();
            let e = edges.len();
            face_edges[f][k] = e;
            let mut pair = [f, NONE];
            if count > 2 {
                return Err(Error::mesh(
                    place,
                    format!(
                        "edge {}-{} is shared by {count} faces (among them {f} and {}); split the \
                         mesh there so that at most two meet",
                        edge[0], edge[1], rest[1].1
                    ),
                ));
            }
            if count == 2 {
                let (_, g, l, other_forward) = rest[1];
                if forward == other_forward {
                    return Err(Error::mesh(
                        place,
                        format!(
                            "faces {f} and {g} disagree about which side is outside (edge {}-{}); \
                             flip one of them",
                            edge[0], edge[1]
                        ),
                    ));
                }
                face_edges[g][l] = e;
                pair[1] = g;
            }
            edges.push(edge);
            edge_faces.push(pair);
            rest = &rest[count..];
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

    /// Whether only one face touches edge `e`.
    pub fn is_boundary_edge(&self, e: usize) -> bool {
        self.edge_faces[e][1] == NONE
    }

    /// `[V]` whether each vertex lies on the boundary.
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
    pub fn vertex_neighbours(&self) -> Vec<Vec<usize>> {
        let mut neighbours = vec![Vec::new(); self.vertex_count];
        for &[i, j] in &self.edges {
            neighbours[i].push(j);
            neighbours[j].push(i);
        }
        for list in &mut neighbours {
            list.sort_unstable();
        }
        neighbours
    }

    /// `[V]` faces around each vertex, ascending.
    pub fn vertex_faces(&self) -> Vec<Vec<usize>> {
        let mut around = vec![Vec::new(); self.vertex_count];
        for (f, face) in self.faces.iter().enumerate() {
            for &v in face {
                around[v].push(f);
            }
        }
        around
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_share_one_edge() {
        let t = Topology::new("test", 4, vec![[0, 1, 2], [2, 1, 3]]).unwrap();
        assert_eq!(t.edges, [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(t.face_edges, [[0, 2, 1], [2, 3, 4]]);
        assert_eq!(t.edge_faces[2], [0, 1]);
        assert_eq!(t.neighbour(0, 1), Some(1));
        assert_eq!(t.neighbour(0, 0), None);
        assert_eq!((t.side_sign(0, 0), t.side_sign(1, 0)), (1.0, -1.0));
        assert!(t.boundary_vertices().iter().all(|&b| b));
    }

    #[test]
    fn bad_meshes_are_named() {
        let message = |n, faces| Topology::new("m.obj", n, faces).unwrap_err().to_string();
        assert!(message(3, vec![[0, 1, 7]]).contains("face 0 names vertex 7"));
        assert!(message(3, vec![[0, 1, 1]]).contains("twice"));
        assert!(message(4, vec![[0, 1, 2]]).contains("vertex 3 belongs to no face"));
        assert!(message(5, vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]).contains("shared by 3 faces"));
        assert!(message(4, vec![[0, 1, 2], [0, 1, 3]]).contains("disagree"));
        assert!(message(3, vec![]).contains("no faces"));
    }
}
