//! Loop subdivision: each face becomes four, and smooth positions of the fine vertices are weighted
//! means of coarse ones ([`Masks`]).
//!
//! Rest panels are refined linearly ([`refine_rest`]), so that fine rest vertices stay in their
//! flat panels and seams stay cut. All of it takes linear time.

use std::ops::{Add, Mul};

use super::masks::Masks;
use super::{NONE, Topology};
use crate::adjacency::Csr;

/// One step of Loop subdivision of a mesh: its fine connectivity, and weights for what is smooth
/// everywhere or has creases. Fine vertices are the `V` coarse ones under their old numbers, then
/// `V + e` on each coarse edge `e`. Coarse face `f` becomes fine faces `4f + k`, k = 0, 1, 2:
/// (corner k, middle of side k, middle of side k+2), and `4f + 3`: (middles of sides 0, 1, 2), all
/// with the orientation of `f`.
pub struct Subdivision<'a> {
    coarse: &'a Topology,
    around: Csr,
}

impl<'a> Subdivision<'a> {
    /// One step of subdivision of `coarse`.
    pub fn new(coarse: &'a Topology) -> Self {
        Self { coarse, around: coarse.vertex_edges() }
    }

    /// Connectivity of the fine mesh.
    pub fn fine(&self) -> Topology {
        refine_topology(self.coarse, &self.around)
    }

    /// Weights of the fine vertices. Edges with a true `crease` (`[E]`, or empty for none) are
    /// smoothed like boundary edges, only along themselves. Vertices with two crease or boundary
    /// edges move along these, with more they stay fixed, and with one (where a crease ends) they
    /// are smoothed as if there were none. Vertices with a true `corner` (`[V]` or fewer, or empty
    /// for none; missing ones are not) stay fixed too.
    ///
    /// # Panics
    /// If `crease` is neither empty nor of length E.
    pub fn masks(&self, crease: &[bool], corner: &[bool]) -> Masks {
        Masks::new(self.coarse, &self.around, crease, corner)
    }
}

/// Rest vertices and faces refined linearly: coarse rest vertices, then the middle of each rest
/// edge (sorted, lower vertex first); faces four for each in the order of [`Subdivision`], so that
/// they match its fine faces one to one, corner by corner. `positions` are `[R]` points in panels
/// or in space (m), `faces` `[F][3]` rest vertices.
///
/// # Panics
/// If a face names a rest vertex that does not exist.
pub fn refine_rest<T>(positions: &[T], faces: &[[usize; 3]]) -> (Vec<T>, Vec<[usize; 3]>)
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let (edges, face_edges) = rest_edges(positions.len(), faces);
    let mut fine_positions = Vec::with_capacity(positions.len() + edges.len());
    fine_positions.extend_from_slice(positions);
    fine_positions.extend(edges.iter().map(|&[i, j]| (positions[i] + positions[j]) * 0.5));
    (fine_positions, split_faces(positions.len(), faces, &face_edges))
}

/// The four parts of each face.
fn split_faces(
    vertex_count: usize,
    faces: &[[usize; 3]],
    face_edges: &[[usize; 3]],
) -> Vec<[usize; 3]> {
    let mut fine = Vec::with_capacity(4 * faces.len());
    for (&[a, b, c], sides) in faces.iter().zip(face_edges) {
        let [ab, bc, ca] = sides.map(|e| vertex_count + e);
        fine.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    fine
}

/// The fine connectivity, equal to `Topology::new` of its faces but without sorting all of them:
/// halves of coarse edges sort by (coarse vertex, coarse edge) and so lie in the order of `around`;
/// edges within coarse faces sort by their two coarse edges. (Only where two coarse faces share all
/// three vertices, fine edges may have both ends in common.)
fn refine_topology(coarse: &Topology, around: &Csr) -> Topology {
    let (vertex_count, edge_count) = (coarse.vertex_count, coarse.edge_count());
    let fine_faces = split_faces(vertex_count, &coarse.faces, &coarse.face_edges);
    let fine_edge_count = 2 * edge_count + 3 * coarse.face_count();
    let mut edges = Vec::with_capacity(fine_edge_count);
    let mut edge_faces = Vec::with_capacity(fine_edge_count);
    // Fine edges of each coarse edge: its half at the lower and at the higher vertex.
    let mut halves = vec![[NONE; 2]; edge_count];
    for v in 0..vertex_count {
        for &e in &around[v] {
            halves[e][usize::from(v == coarse.edges[e][1])] = edges.len();
            edges.push([v, vertex_count + e]);
            edge_faces.push(
                coarse.edge_faces[e]
                    .map(|f| if f == NONE { NONE } else { 4 * f + coarse.corner_of(f, v) }),
            );
        }
    }
    let cut_edges = cut_corners(coarse, &mut edges, &mut edge_faces);
    let mut face_edges = Vec::with_capacity(fine_faces.len());
    for (f, face) in coarse.faces.iter().enumerate() {
        let half = |side: usize, v: usize| {
            let e = coarse.face_edges[f][side];
            halves[e][usize::from(v == coarse.edges[e][1])]
        };
        let cut = cut_edges[f];
        face_edges
            .extend([0, 1, 2].map(|k| [half(k, face[k]), cut[k], half((k + 2) % 3, face[k])]));
        face_edges.push([cut[1], cut[2], cut[0]]);
    }
    Topology {
        vertex_count: vertex_count + edge_count,
        faces: fine_faces,
        edges,
        face_edges,
        edge_faces,
    }
}

/// Appends the edges inside coarse faces, which cut off their corners, sorted by the two coarse
/// edges that meet there; returns `[F][3]` the fine edge that cuts off each corner.
fn cut_corners(
    coarse: &Topology,
    edges: &mut Vec<[usize; 2]>,
    edge_faces: &mut Vec<[usize; 2]>,
) -> Vec<[usize; 3]> {
    let corners = (0..coarse.face_count()).flat_map(|f| {
        let sides = coarse.face_edges[f];
        [0, 1, 2].map(|k| {
            let (a, b) = (sides[k], sides[(k + 2) % 3]);
            (a.min(b), (a.max(b), f, k))
        })
    });
    let mut by_lower_edge = Csr::from_pairs(coarse.edge_count(), corners);
    let mut cut_edges = vec![[NONE; 3]; coarse.face_count()];
    for (low, row) in by_lower_edge.rows_mut().enumerate() {
        row.sort_unstable();
        for &(high, f, k) in &*row {
            cut_edges[f][k] = edges.len();
            edges.push([coarse.vertex_count + low, coarse.vertex_count + high]);
            edge_faces.push([4 * f + k, 4 * f + 3]);
        }
    }
    cut_edges
}

/// `[fine E]` true on the halves of coarse creases (`crease`, `[E]`); `fine` is
/// [`Subdivision::fine`] of a mesh of `coarse_vertex_count` vertices.
pub fn halve_creases(fine: &Topology, coarse_vertex_count: usize, crease: &[bool]) -> Vec<bool> {
    fine.edges
        .iter()
        .map(|&[v, mid]| v < coarse_vertex_count && crease[mid - coarse_vertex_count])
        .collect()
}

/// Edges of `faces` (lower vertex first, sorted) and `[F][3]` the edge from corner k to k+1: as in
/// [`Topology`], but any faces will do, since rest panels need not be one surface.
fn rest_edges(vertex_count: usize, faces: &[[usize; 3]]) -> (Vec<[usize; 2]>, Vec<[usize; 3]>) {
    let sides = || {
        faces.iter().enumerate().flat_map(|(f, face)| {
            [0, 1, 2].map(|k| {
                let (i, j) = (face[k], face[(k + 1) % 3]);
                (i.min(j), (i.max(j), f, k))
            })
        })
    };
    let mut by_lower = Csr::from_pairs(vertex_count, sides());
    let mut edges: Vec<[usize; 2]> = Vec::with_capacity(by_lower.items().len() / 2 + 1);
    let mut face_edges = vec![[NONE; 3]; faces.len()];
    for (low, row) in by_lower.rows_mut().enumerate() {
        row.sort_unstable();
        for &(high, f, k) in &*row {
            if edges.last() != Some(&[low, high]) {
                edges.push([low, high]);
            }
            face_edges[f][k] = edges.len() - 1;
        }
    }
    (edges, face_edges)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One step with everything at once; `fine_crease` are the creases halved, to go on refining
    /// with.
    #[derive(Debug, PartialEq)]
    struct Refinement {
        fine: Topology,
        fine_crease: Vec<bool>,
        masks: Masks,
    }

    fn refine(coarse: &Topology, crease: &[bool], corner: &[bool]) -> Refinement {
        let step = Subdivision::new(coarse);
        let fine = step.fine();
        let fine_crease = if crease.is_empty() {
            Vec::new()
        } else {
            halve_creases(&fine, coarse.vertex_count, crease)
        };
        Refinement { fine, fine_crease, masks: step.masks(crease, corner) }
    }

    use crate::mesh::{
        Vec2, Vec3,
        panel::{Outline, Panel},
        sew::{Seam, reversed, sew},
    };

    fn panel(outline: &Outline, length: f64) -> (Topology, Vec<Vec2>) {
        let panel = Panel::new(outline, length, 4).unwrap();
        (Topology::new(panel.positions.len(), panel.faces).unwrap(), panel.positions)
    }

    fn square() -> (Topology, Vec<Vec2>) {
        panel(&Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, 0.2)
    }

    /// An n x n grid of unit squares, all cut the same way.
    fn grid(n: usize) -> (Topology, Vec<Vec2>) {
        let at = |i: usize, j: usize| j * (n + 1) + i;
        let positions =
            (0..=n).flat_map(|j| (0..=n).map(move |i| Vec2::new(i as f64, j as f64))).collect();
        let cell = |i, j| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        };
        let faces = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect();
        (Topology::new((n + 1) * (n + 1), faces).unwrap(), positions)
    }

    /// The cube [-1, 1]³ with two faces a side, and its 12 true edges as creases.
    fn cube() -> (Topology, Vec<Vec3>, Vec<bool>) {
        let positions: Vec<Vec3> = (0..8)
            .map(|v| {
                Vec3::new((v & 1) as f64, (v >> 1 & 1) as f64, (v >> 2) as f64) * 2.0
                    - Vec3::repeat(1.0)
            })
            .collect();
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let t = Topology::new(8, faces).unwrap();
        let crease = t.edges.iter().map(|&[i, j]: &[usize; 2]| (i ^ j).count_ones() == 1).collect();
        (t, positions, crease)
    }

    /// Two panels sewn: coarse topology, and rest faces that differ from it along the seam.
    fn sewn() -> crate::mesh::sew::Sewn {
        let panels = [0, 1].map(|seed| {
            Panel::new(&Outline::Rectangle { width_m: 0.5, height_m: 1.0 }, 0.2, seed).unwrap()
        });
        let left = reversed(panels[1].side("left").unwrap());
        sew(&panels, &[Seam::new((0, panels[0].side("right").unwrap()), (1, &left))]).unwrap()
    }

    /// Coarse vertices that fine vertex `v` depends on, and their weights.
    fn row(r: &Refinement, v: usize) -> (&[usize], &[f64]) {
        (r.masks.row(v).vertices, r.masks.row(v).weights)
    }

    fn area(t: &Topology, x: &[Vec3]) -> f64 {
        t.faces.iter().map(|f| 0.5 * (x[f[1]] - x[f[0]]).cross(&(x[f[2]] - x[f[0]])).norm()).sum()
    }

    #[test]
    fn fine_connectivity_is_that_of_its_faces() {
        let (cube, _, crease) = cube();
        let (mut annulus, _) =
            panel(&Outline::Annulus { inner_radius_m: 0.5, outer_radius_m: 1.0 }, 0.2);
        // Faces in another order, whose numbers do not follow those of the vertices.
        annulus.faces.reverse();
        let annulus = Topology::new(annulus.vertex_count, annulus.faces).unwrap();
        for (coarse, crease) in [
            (square().0, vec![]),
            (grid(3).0, vec![]),
            (cube, crease),
            (annulus, vec![]),
            (sewn().topology, vec![]),
        ] {
            let once = refine(&coarse, &crease, &[]);
            let twice = refine(&once.fine, &once.fine_crease, &[]);
            for (r, c) in [(&once, &coarse), (&twice, &once.fine)] {
                assert_eq!(r.fine.vertex_count, c.vertex_count + c.edge_count());
                assert_eq!(r.fine.face_count(), 4 * c.face_count());
                assert_eq!(
                    r.fine,
                    Topology::new(r.fine.vertex_count, r.fine.faces.clone()).unwrap()
                );
            }
        }
    }

    #[test]
    fn fine_faces_lie_where_promised() {
        let (coarse, positions) = square();
        let fine = refine(&coarse, &[], &[]).fine;
        let middle = |f: usize, side: usize| coarse.vertex_count + coarse.face_edges[f][side];
        let mut all = positions.clone();
        all.extend(coarse.edges.iter().map(|&[i, j]| (positions[i] + positions[j]) * 0.5));
        let area = |[a, b, c]: [usize; 3], x: &[Vec2]| (x[b] - x[a]).perp(&(x[c] - x[a]));
        for (f, &face) in coarse.faces.iter().enumerate() {
            for k in 0..3 {
                assert_eq!(fine.faces[4 * f + k], [face[k], middle(f, k), middle(f, (k + 2) % 3)]);
            }
            assert_eq!(fine.faces[4 * f + 3], [middle(f, 0), middle(f, 1), middle(f, 2)]);
            for part in 4 * f..4 * f + 4 {
                assert!(
                    (area(fine.faces[part], &all) / area(face, &positions) - 0.25).abs() < 1e-9
                );
            }
        }
    }

    #[test]
    fn weights_sum_to_one_and_are_positive() {
        let (cube, _, crease) = cube();
        for r in
            [refine(&square().0, &[], &[]), refine(&cube, &[], &[]), refine(&cube, &crease, &[])]
        {
            assert!(
                r.masks
                    .apply(&vec![3.0; r.fine.vertex_count])
                    .iter()
                    .all(|x| (x - 3.0f64).abs() < 1e-14)
            );
            assert!(
                (0..r.fine.vertex_count).all(|v| r.masks.row(v).weights.iter().all(|&w| w > 0.0))
            );
        }
    }

    #[test]
    fn affine_fields_stay_affine() {
        let affine = |p: &Vec2| 3.0 - 2.0 * p.x + 0.7 * p.y;
        for (coarse, positions) in [square(), grid(4)] {
            let r = refine(&coarse, &[], &[]);
            let field = r.masks.apply(&positions.iter().map(affine).collect::<Vec<_>>());
            for (value, p) in field.iter().zip(r.masks.apply(&positions)) {
                assert!((value - affine(&p)).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn a_regular_grid_stays_where_it_is_inside() {
        let (coarse, positions) = grid(4);
        let fine = refine(&coarse, &[], &[]).masks.apply(&positions);
        let on_boundary = coarse.boundary_vertices();
        for v in (0..coarse.vertex_count).filter(|&v| !on_boundary[v]) {
            assert!((fine[v] - positions[v]).norm() < 1e-14);
        }
        for (e, &[i, j]) in coarse.edges.iter().enumerate() {
            assert!(
                (fine[coarse.vertex_count + e] - (positions[i] + positions[j]) * 0.5).norm()
                    < 1e-14
            );
        }
    }

    #[test]
    fn straight_boundaries_stay_straight_and_depend_on_nothing_inside() {
        let (coarse, positions) = square();
        let r = refine(&coarse, &[], &[]);
        let fine = r.masks.apply(&positions);
        let on_boundary = coarse.boundary_vertices();
        let corner = |p: Vec2| (p - Vec2::new(0.5, 0.5)).amin() == 0.5;
        for v in 0..r.fine.vertex_count {
            let from_boundary = r.masks.row(v).vertices.iter().all(|&c| on_boundary[c]);
            if r.fine.boundary_vertices()[v] {
                assert!(from_boundary);
                // Squares have rounded corners, since a boundary vertex has two boundary edges
                // there too.
                let near_corner = v < coarse.vertex_count && corner(positions[v]);
                assert_eq!(
                    (fine[v] - Vec2::new(0.5, 0.5)).amax() > 0.5 - 1e-15,
                    !near_corner,
                    "{v} at {}",
                    fine[v]
                );
            } else {
                assert!((fine[v] - Vec2::new(0.5, 0.5)).amax() < 0.5);
            }
        }
    }

    #[test]
    fn creases_keep_a_cube_sharp() {
        let (mut t, mut x, mut crease) = cube();
        for _ in 0..3 {
            let r = refine(&t, &crease, &[]);
            x = r.masks.apply(&x);
            (t, crease) = (r.fine, r.fine_crease);
        }
        // 12 edges of 8 pieces; their ends, where three creases meet, are fixed, so the cube stays
        // a cube.
        assert_eq!(crease.iter().filter(|&&c| c).count(), 96);
        assert!(x.iter().all(|p| (p.amax() - 1.0).abs() < 1e-14));
        assert!((area(&t, &x) - 24.0).abs() < 1e-12);
        for (e, _) in crease.iter().enumerate().filter(|(_, c)| **c) {
            assert!(
                t.edges[e].iter().all(|&v| x[v]
                    .iter()
                    .filter(|c| (c.abs() - 1.0).abs() < 1e-14)
                    .count()
                    >= 2)
            );
        }
    }

    #[test]
    fn a_crease_that_ends_is_smooth_at_its_end() {
        let (coarse, _) = grid(4);
        let mut crease = vec![false; coarse.edge_count()];
        let e = coarse.edges.iter().position(|&e| e == [12, 13]).unwrap();
        crease[e] = true;
        let (with, without) = (refine(&coarse, &crease, &[]), refine(&coarse, &[], &[]));
        for v in 0..with.fine.vertex_count {
            assert_eq!(with.masks.row(v) == without.masks.row(v), v != coarse.vertex_count + e);
        }
        assert_eq!(row(&with, coarse.vertex_count + e), (&[12, 13][..], &[0.5, 0.5][..]));
    }

    #[test]
    fn fans_that_touch_in_a_vertex_hold_it_fixed() {
        let bow_tie = Topology::new(5, vec![[0, 1, 2], [2, 3, 4]]).unwrap();
        let r = refine(&bow_tie, &[], &[]);
        assert_eq!(row(&r, 2), (&[2][..], &[1.0][..]));
        assert_eq!(row(&r, 0), (&[0, 1, 2][..], &[0.75, 0.125, 0.125][..]));
    }

    #[test]
    fn closed_surfaces_converge() {
        let (mut t, mut x, _) = cube();
        let mut areas = vec![area(&t, &x)];
        for _ in 0..6 {
            let r = refine(&t, &[], &[]);
            x = r.masks.apply(&x);
            t = r.fine;
            areas.push(area(&t, &x));
        }
        let steps: Vec<f64> = areas.windows(2).map(|a| (a[1] - a[0]).abs()).collect();
        assert!(steps.windows(2).all(|s| s[1] < 0.5 * s[0]), "{areas:?}");
        // Second order: the last step is a fourth of the one before.
        assert!((steps[4] / steps[5] - 4.0).abs() < 0.4, "{steps:?}");
    }

    #[test]
    fn rest_faces_match_fine_faces_and_seams_stay_cut() {
        let sewn = sewn();
        let (mut topology, mut rest, mut rest_faces) =
            (sewn.topology, sewn.rest_positions, sewn.rest_faces);
        let mut vertex_of_rest = sewn.vertex_of_rest;
        for _ in 0..2 {
            let before = (rest.len(), rest_faces.clone(), rest.clone());
            topology = refine(&topology, &[], &[]).fine;
            (rest, rest_faces) = refine_rest(&rest, &rest_faces);
            assert_eq!(
                (rest_faces.len(), &rest[..before.0]),
                (topology.face_count(), &before.2[..])
            );
            // Every corner leads to one vertex of the surface, and old ones as before.
            let mut vertex_of = vec![NONE; rest.len()];
            for (face, corners) in topology.faces.iter().zip(&rest_faces) {
                for k in 0..3 {
                    assert!(vertex_of[corners[k]] == NONE || vertex_of[corners[k]] == face[k]);
                    vertex_of[corners[k]] = face[k];
                }
            }
            assert_eq!(vertex_of[..before.0], vertex_of_rest);
            vertex_of_rest = vertex_of;
            // Linear: each part has a fourth of the area and the orientation.
            let area = |f: [usize; 3], x: &[Vec2]| (x[f[1]] - x[f[0]]).perp(&(x[f[2]] - x[f[0]]));
            for (f, &part) in rest_faces.iter().enumerate() {
                assert!((area(part, &rest) / area(before.1[f / 4], &before.2) - 0.25).abs() < 1e-9);
            }
        }
        // The seam, 5 pieces refined twice, is there once in the surface and twice at rest.
        assert_eq!(rest.len() - topology.vertex_count, 21);
    }

    #[test]
    fn the_same_mesh_gives_the_same_refinement() {
        let (coarse, _) = square();
        assert_eq!(refine(&coarse, &[], &[]), refine(&coarse.clone(), &[], &[]));
        let (e, first) = (coarse.edge_count(), refine(&coarse, &[], &[]));
        assert_ne!(first, refine(&coarse, &vec![true; e], &[]));
    }

    #[test]
    fn two_faces_back_to_back_are_refined() {
        let t = Topology::new(3, vec![[0, 1, 2], [0, 2, 1]]).unwrap();
        let twice = refine(&refine(&t, &[], &[]).fine, &[], &[]).fine;
        assert_eq!((twice.vertex_count + twice.face_count()) - twice.edge_count(), 2);
        assert!((0..twice.edge_count()).all(|e| !twice.is_boundary_edge(e)));
    }
}
