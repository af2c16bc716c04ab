//! A surface while it is remeshed: faces, the faces around each vertex, and the ones that may be
//! changed.

use std::f64::consts::{PI, TAU};

use super::{IndexMaps, MidpointPlacement, SurfaceMesh, unfold};
use crate::mesh::Vec3;

/// Least cosine between the normals of a face before and after it is changed.
const LEAST_COSINE: f64 = 0.5;

/// The surface with its holes: numbers of faces and vertices never change here, new ones are
/// appended, dead ones are marked.
pub(super) struct Patch {
    pub(super) mesh: SurfaceMesh,
    /// `[V]` faces around each vertex, in no order; empty: the vertex is dead.
    pub(super) around: Vec<Vec<usize>>,
    /// `[F]` true for faces that may be changed.
    pub(super) active: Vec<bool>,
    /// `[F]` true for faces that were removed.
    pub(super) dead: Vec<bool>,
    /// `[F]` true for faces that were changed, or are new.
    pub(super) changed: Vec<bool>,
    /// Vertices that live.
    pub(super) living: usize,
    /// Placement of new vertices.
    pub(super) midpoints: MidpointPlacement,
}

/// The faces on an edge from `a` to `b`: `(face, corner at which the edge begins)` of the one that
/// runs along it, and of the one that runs against it.
pub(super) struct EdgeFaces {
    pub(super) forth: Option<(usize, usize)>,
    pub(super) back: Option<(usize, usize)>,
}

impl EdgeFaces {
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, usize)> {
        self.forth.into_iter().chain(self.back)
    }
}

/// The faces around a vertex in order.
pub(super) struct Fan {
    /// `(face, corner of the vertex)`, counter-clockwise.
    pub(super) faces: Vec<(usize, usize)>,
    /// True if the last face touches the first.
    pub(super) closed: bool,
}

impl Patch {
    pub(super) fn new(mesh: SurfaceMesh, active: &[bool]) -> Self {
        let mut around = vec![Vec::new(); mesh.positions.len()];
        for (f, face) in mesh.faces.iter().enumerate() {
            for &v in face {
                around[v].push(f);
            }
        }
        let n = mesh.faces.len();
        Self {
            living: around.len(),
            mesh,
            around,
            active: active.to_vec(),
            dead: vec![false; n],
            changed: vec![false; n],
            midpoints: MidpointPlacement::Flat,
        }
    }

    /// True if every vertex has a face, and the active faces and their neighbours are a manifold,
    /// all facing the same way.
    pub(super) fn is_sound(&self) -> bool {
        let proper = |f: usize| {
            let face = self.mesh.faces[f];
            let side = |k: usize| {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                let along = |x: usize, y: usize| {
                    let runs = |&&g: &&usize| {
                        (0..3).any(|l| {
                            self.mesh.faces[g][l] == x && self.mesh.faces[g][(l + 1) % 3] == y
                        })
                    };
                    self.around[a].iter().filter(runs).count()
                };
                a != b && along(a, b) == 1 && along(b, a) <= 1
            };
            (0..3).all(side)
        };
        self.around.iter().all(|faces| !faces.is_empty())
            && (0..self.active.len()).all(|f| !self.active[f] || proper(f))
    }

    /// The corner of face `f` that is vertex `v`, if it is one.
    pub(super) fn corner(&self, f: usize, v: usize) -> Option<usize> {
        self.mesh.faces[f].iter().position(|&u| u == v)
    }

    /// The faces on the edge from `a` to `b`.
    pub(super) fn edge_faces(&self, a: usize, b: usize) -> EdgeFaces {
        let mut faces = EdgeFaces { forth: None, back: None };
        for &f in &self.around[a] {
            let face = &self.mesh.faces[f];
            let k = self.corner(f, a).expect("faces around a vertex have it");
            if face[(k + 1) % 3] == b {
                faces.forth = Some((f, k));
            } else if face[(k + 2) % 3] == b {
                faces.back = Some((f, (k + 2) % 3));
            }
        }
        faces
    }

    /// True if an edge joins `a` and `b`.
    pub(super) fn joined(&self, a: usize, b: usize) -> bool {
        self.around[a].iter().any(|&f| self.corner(f, b).is_some())
    }

    /// All edges whose faces are all active, lower end first, sorted.
    pub(super) fn free_edges(&self) -> Vec<[usize; 2]> {
        let mut edges = Vec::new();
        for (f, face) in
            self.mesh.faces.iter().enumerate().filter(|&(f, _)| self.active[f] && !self.dead[f])
        {
            for k in 0..3 {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                let other = self.edge_faces(a, b).back;
                if other.is_none_or(|(g, _)| self.active[g] && g > f) {
                    edges.push([a.min(b), a.max(b)]);
                }
            }
        }
        edges.sort_unstable();
        edges
    }

    /// Rest length (m) of the edge on `faces`: the mean of both sides.
    pub(super) fn length(&self, faces: &EdgeFaces) -> f64 {
        let (sum, count) = faces.iter().fold((0.0, 0.0), |(sum, n), (f, k)| {
            (sum + unfold::side(&self.mesh.rest[f], k), n + 1.0)
        });
        sum / count
    }

    /// True if texture places, or rest lengths, differ across the edge: it is a seam.
    pub(super) fn is_seam(&self, faces: &EdgeFaces) -> bool {
        let (Some((f, k)), Some((g, l))) = (faces.forth, faces.back) else { return false };
        let uv_seam = self
            .mesh
            .uvs
            .as_ref()
            .is_some_and(|uv| uv[f][k] != uv[g][(l + 1) % 3] || uv[f][(k + 1) % 3] != uv[g][l]);
        uv_seam
            || !unfold::agree(
                unfold::side(&self.mesh.rest[f], k),
                unfold::side(&self.mesh.rest[g], l),
            )
    }

    /// The axes along which an edge is frozen as a whole. Not where it joins two places of the
    /// boundary through the inside.
    pub(super) fn frozen_line(&self, a: usize, b: usize, faces: &EdgeFaces) -> [bool; 3] {
        let (p, q) = (self.mesh.frozen[a], self.mesh.frozen[b]);
        let axes = [0, 1, 2].map(|k| p[k] && q[k]);
        if axes == [false; 3] {
            return axes;
        }
        let outer = faces.forth.is_none() || faces.back.is_none();
        // A frozen face beside it makes it part of a frozen region whatever lies at its ends.
        let beside = faces.iter().any(|(f, _)| {
            self.mesh.faces[f].iter().all(|&v| (0..3).all(|k| !axes[k] || self.mesh.frozen[v][k]))
                && !self.is_ear(f)
        });
        if outer || beside || !(self.on_boundary(a) && self.on_boundary(b)) {
            axes
        } else {
            [false; 3]
        }
    }

    /// True if a face with these corners would be frozen along some axis.
    pub(super) fn would_freeze(&self, corners: &[usize; 3]) -> bool {
        (0..3).any(|k| corners.iter().all(|&v| self.mesh.frozen[v][k]))
    }

    /// True if two sides of face `f` lie on the boundary.
    fn is_ear(&self, f: usize) -> bool {
        let face = self.mesh.faces[f];
        let alone = |k: usize| {
            let faces = self.edge_faces(face[k], face[(k + 1) % 3]);
            faces.forth.is_none() || faces.back.is_none()
        };
        (0..3).filter(|&k| alone(k)).count() >= 2
    }

    /// True if `v` lies on the boundary.
    pub(super) fn on_boundary(&self, v: usize) -> bool {
        self.fan(v).is_none_or(|fan| !fan.closed)
    }

    /// The faces around `v` in order; none where they are more than one fan.
    pub(super) fn fan(&self, v: usize) -> Option<Fan> {
        let around: Vec<(usize, usize)> = self.around[v]
            .iter()
            .map(|&f| (f, self.corner(f, v).expect("faces around a vertex have it")))
            .collect();
        let (first, last) = (
            |&(f, k): &(usize, usize)| self.mesh.faces[f][(k + 1) % 3],
            |&(f, k): &(usize, usize)| self.mesh.faces[f][(k + 2) % 3],
        );
        // The face no other leads to; in a closed fan, the one that begins at the lowest vertex.
        let opening =
            around.iter().find(|face| around.iter().all(|other| last(other) != first(face)));
        let begin = *opening.or_else(|| around.iter().min_by_key(|face| first(face)))?;
        let mut faces = vec![begin];
        while faces.len() <= around.len() {
            let end = last(faces.last()?);
            match around.iter().find(|face| first(face) == end) {
                Some(&next) if next != begin => faces.push(next),
                _ => break,
            }
        }
        (faces.len() == around.len()).then_some(Fan { faces, closed: opening.is_none() })
    }

    /// Unit normal at `v`: the faces' by area; zero where they cancel.
    pub(super) fn normal(&self, v: usize) -> Vec3 {
        self.normal_sum(v, &self.mesh.positions).try_normalize(0.0).unwrap_or_else(Vec3::zeros)
    }

    /// Sum of the normals (m², of twice the areas) of the faces around `v`, whose corners are at
    /// `places` (m).
    pub(super) fn normal_sum(&self, v: usize, places: &[Vec3]) -> Vec3 {
        self.around[v].iter().map(|&f| normal(self.mesh.faces[f].map(|u| places[u]))).sum()
    }

    /// True if no new face turns over, in space or at the start: every one of `new` keeps its side
    /// of the one of `old` with the same number, or of all of them if `all`, and of the surface
    /// around each of its corners (else many small turns would add up).
    pub(super) fn keeps_sides(&self, old: &[[usize; 3]], new: &[[usize; 3]], all: bool) -> bool {
        [&self.mesh.positions, &self.mesh.start].into_iter().all(|places| {
            let faces = |list: &[[usize; 3]]| -> Vec<Vec3> {
                list.iter().map(|face| normal(face.map(|v| places[v]))).collect()
            };
            let (was, is) = (faces(old), faces(new));
            let same_side = |n: &Vec3, m: &Vec3| n.dot(m) > LEAST_COSINE * n.norm() * m.norm();
            is.iter().enumerate().all(|(k, m)| {
                (if all { was.iter().all(|n| same_side(n, m)) } else { same_side(&was[k], m) })
                    && new[k].iter().all(|&v| self.normal_sum(v, places).dot(m) > 0.0)
            })
        })
    }

    /// Face `f` no longer touches `v`.
    pub(super) fn detach(&mut self, f: usize, v: usize) {
        self.around[v].retain(|&g| g != f);
    }

    /// Fills the holes of removed vertices and faces with the last ones; all others keep their
    /// numbers.
    pub(super) fn finish(
        mut self,
        old_vertices: usize,
        old_faces: usize,
    ) -> (SurfaceMesh, IndexMaps) {
        let vertex_alive: Vec<bool> = self.around.iter().map(|faces| !faces.is_empty()).collect();
        let face_alive: Vec<bool> = self.dead.iter().map(|dead| !dead).collect();
        let (to_vertex, to_face) = (compact_numbers(&vertex_alive), compact_numbers(&face_alive));
        let mesh = &mut self.mesh;
        renumber(&mut mesh.positions, &to_vertex);
        renumber(&mut mesh.start, &to_vertex);
        renumber(&mut mesh.frozen, &to_vertex);
        mesh.channels.iter_mut().for_each(|channel| renumber(channel, &to_vertex));
        renumber(&mut mesh.faces, &to_face);
        renumber(&mut mesh.rest, &to_face);
        renumber(&mut self.changed, &to_face);
        mesh.uvs.iter_mut().for_each(|uvs| renumber(uvs, &to_face));
        for v in mesh.faces.iter_mut().flatten() {
            *v = to_vertex[*v].expect("living faces have living corners");
        }
        let maps = IndexMaps {
            vertices: to_vertex[..old_vertices].to_vec(),
            faces: to_face[..old_faces].to_vec(),
            changed: self.changed,
        };
        (self.mesh, maps)
    }
}

/// New number of each: the last living ones take the places of dead ones, from the front.
fn compact_numbers(alive: &[bool]) -> Vec<Option<usize>> {
    let count = alive.iter().filter(|&&a| a).count();
    let mut holes = (0..count).filter(|&n| !alive[n]);
    let place = |n: usize| {
        alive[n].then(|| {
            if n < count { n } else { holes.next().expect("as many holes as are beyond the end") }
        })
    };
    (0..alive.len()).map(place).collect()
}

fn renumber<T: Clone>(list: &mut Vec<T>, to: &[Option<usize>]) {
    let count = to.iter().flatten().count();
    for (n, place) in to.iter().enumerate().skip(count) {
        if let Some(place) = place {
            list[*place] = list[n].clone();
        }
    }
    list.truncate(count);
}

/// Normal of a triangle, as long as twice its area (m²).
pub(super) fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

/// The angle (rad) around a flat vertex.
pub(super) fn flat_angle(closed: bool) -> f64 {
    if closed { TAU } else { PI }
}
