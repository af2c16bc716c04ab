//! Sewing: flat panels become one surface. The panels keep their own flat rest vertices; along
//! seams, several of these stand for one vertex of the surface. Rest lengths therefore belong to
//! faces, and a seam needs no special case later.

use std::collections::VecDeque;

use super::{Topology, Vec2, panel::Panel};
use crate::Result;
use crate::error::MeshError;

/// Largest difference in length between the two sides of a seam, relative to the longer.
const LENGTH_TOLERANCE: f64 = 0.01;

/// Several panels sewn to one surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Sewn {
    /// Connectivity of the surface. Its vertices are numbered by the lowest rest vertex in each,
    /// without gaps.
    pub topology: Topology,
    /// `[R]` vertices of all panels, one panel after the other (m, each panel in its own plane).
    pub rest_positions: Vec<Vec2>,
    /// `[F][3]` rest vertices of each face of `topology`, corner by corner. Faces of a flipped
    /// panel run clockwise in its plane.
    pub rest_faces: Vec<[usize; 3]>,
    /// `[R]` vertex of the surface for each rest vertex.
    pub vertex_of_rest: Vec<usize>,
    /// `[panels]` true if the panel's faces were flipped so that all faces agree about the outside.
    /// Of the panels that hang together, the first is never flipped.
    pub flipped: Vec<bool>,
}

/// A chain of boundary vertices of a panel.
#[derive(Clone, Copy, Debug)]
pub struct Chain<'a> {
    /// The panel.
    pub panel: usize,
    /// Its vertices in order along its boundary: a [`Panel::side`], a part of one, or several in a
    /// row.
    pub vertices: &'a [usize],
}

/// Two chains of boundary vertices to be joined: the k-th of `a` to the k-th of `b`.
#[derive(Clone, Copy, Debug)]
pub struct Seam<'a> {
    /// One chain.
    pub a: Chain<'a>,
    /// The other, on another panel or the same, with as many vertices. Opposite sides of a
    /// rectangle run against each other, so one of them must be [`reversed`].
    pub b: Chain<'a>,
}

impl<'a> Seam<'a> {
    /// The seam between two chains, each given as its panel and vertices.
    pub fn new(a: (usize, &'a [usize]), b: (usize, &'a [usize])) -> Self {
        let [a, b] = [a, b].map(|(panel, vertices)| Chain { panel, vertices });
        Self { a, b }
    }
}

/// `chain` from its end to its start.
pub fn reversed(chain: &[usize]) -> Vec<usize> {
    chain.iter().rev().copied().collect()
}

/// The surface made of `panels`, joined along `seams`. Panels whose faces disagree with those they
/// are sewn to, like the two equal halves of a balloon, are flipped.
///
/// # Errors
/// [`MeshError`] that names the seam and its panels for: a panel that does not exist, vertices that
/// do not follow each other on the boundary, sides that differ in their number of vertices or by
/// over 1 % in length; that names panels for a one-sided surface (a Möbius strip); or what
/// [`Topology::new`] finds, such as three panels on one edge.
pub fn sew(panels: &[Panel], seams: &[Seam<'_>]) -> Result<Sewn> {
    let mut first_rest = vec![0];
    for panel in panels {
        first_rest.push(first_rest[first_rest.len() - 1] + panel.positions.len());
    }
    let rest_count = first_rest[panels.len()];
    let boundaries: Vec<Vec<[usize; 2]>> = panels.iter().map(boundary_edges).collect();

    let mut root: Vec<usize> = (0..rest_count).collect();
    for (s, seam) in seams.iter().enumerate() {
        check_seam(s, seam, panels, &boundaries)?;
        for (&i, &j) in seam.a.vertices.iter().zip(seam.b.vertices) {
            unite(&mut root, first_rest[seam.a.panel] + i, first_rest[seam.b.panel] + j);
        }
    }
    let mut vertex_of_rest = vec![0; rest_count];
    let mut vertex_count = 0;
    for r in 0..rest_count {
        let lowest = find(&mut root, r);
        if lowest == r {
            vertex_of_rest[r] = vertex_count;
            vertex_count += 1;
        } else {
            vertex_of_rest[r] = vertex_of_rest[lowest];
        }
    }

    let mut rest_faces: Vec<[usize; 3]> = Vec::new();
    let mut panel_of_face = Vec::new();
    for (p, panel) in panels.iter().enumerate() {
        rest_faces.extend(panel.faces.iter().map(|face| face.map(|v| first_rest[p] + v)));
        panel_of_face.resize(rest_faces.len(), p);
    }
    turn_doubled_ears(&mut rest_faces, &vertex_of_rest);
    let mut faces: Vec<[usize; 3]> =
        rest_faces.iter().map(|face| face.map(|r| vertex_of_rest[r])).collect();
    let flipped = panels_to_flip(panels.len(), &faces, &panel_of_face)?;
    for f in 0..faces.len() {
        if flipped[panel_of_face[f]] {
            faces[f].swap(1, 2);
            rest_faces[f].swap(1, 2);
        }
    }
    let topology = Topology::new(vertex_count, faces)?;
    let rest_positions = panels.iter().flat_map(|panel| panel.positions.iter().copied()).collect();
    Ok(Sewn { topology, rest_positions, rest_faces, vertex_of_rest, flipped })
}

/// Turns doubled ears: if both of two sewn panels cut the same corner off with one face, the two
/// faces would lie on each other and four would meet at one edge. There the edge of the second pair
/// is turned to the other diagonal.
fn turn_doubled_ears(rest_faces: &mut [[usize; 3]], vertex_of_rest: &[usize]) {
    let mut sides: Vec<([usize; 2], usize, usize)> = Vec::with_capacity(3 * rest_faces.len());
    for (f, face) in rest_faces.iter().enumerate() {
        for k in 0..3 {
            let (i, j) = (vertex_of_rest[face[k]], vertex_of_rest[face[(k + 1) % 3]]);
            sides.push(([i.min(j), i.max(j)], f, k));
        }
    }
    sides.sort_unstable();
    for same in sides.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 4) {
        // Faces are in the order of their panels, so the last two belong together.
        let [(_, f, k), (_, g, l)] = [same[2], same[3]];
        let [a, b, c] = [0, 1, 2].map(|n| rest_faces[f][(k + n) % 3]);
        let [d, e, opposite] = [0, 1, 2].map(|n| rest_faces[g][(l + n) % 3]);
        if (a, b) == (e, d) {
            rest_faces[f] = [c, a, opposite];
            rest_faces[g] = [c, opposite, b];
        }
    }
}

/// Edges of one face only, lower vertex first, sorted.
fn boundary_edges(panel: &Panel) -> Vec<[usize; 2]> {
    let sides = |face: &[usize; 3]| {
        [0, 1, 2].map(|k| [face[k].min(face[(k + 1) % 3]), face[k].max(face[(k + 1) % 3])])
    };
    let mut edges: Vec<[usize; 2]> = panel.faces.iter().flat_map(sides).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect()
}

fn check_seam(
    number: usize,
    seam: &Seam<'_>,
    panels: &[Panel],
    boundaries: &[Vec<[usize; 2]>],
) -> Result<()> {
    let joined = [seam.a.panel, seam.b.panel];
    let length = |chain: Chain<'_>| -> Result<f64> {
        let p = chain.panel;
        let Some(panel) = panels.get(p) else {
            let panel_count = panels.len();
            return Err(
                MeshError::UnknownPanel { seam: number, panels: joined, panel_count }.into()
            );
        };
        let mut length_m = 0.0;
        for pair in chain.vertices.windows(2) {
            let (i, j) = (pair[0].min(pair[1]), pair[0].max(pair[1]));
            if boundaries[p].binary_search(&[i, j]).is_err() {
                return Err(MeshError::SeamOffBoundary {
                    seam: number,
                    panels: joined,
                    panel: p,
                    vertices: [pair[0], pair[1]],
                }
                .into());
            }
            length_m += (panel.positions[i] - panel.positions[j]).norm();
        }
        Ok(length_m)
    };
    let (a, b) = (length(seam.a)?, length(seam.b)?);
    let (count_a, count_b) = (seam.a.vertices.len(), seam.b.vertices.len());
    if count_a != count_b || count_a < 2 || (a - b).abs() > LENGTH_TOLERANCE * a.max(b) {
        return Err(MeshError::UnequalSeam {
            seam: number,
            panels: joined,
            vertex_counts: [count_a, count_b],
            lengths_m: [a, b],
        }
        .into());
    }
    Ok(())
}

/// The lowest member of `r`'s set, shortening the path to it.
fn find(root: &mut [usize], mut r: usize) -> usize {
    while root[r] != r {
        root[r] = root[root[r]];
        r = root[r];
    }
    r
}

fn unite(root: &mut [usize], i: usize, j: usize) {
    let (i, j) = (find(root, i), find(root, j));
    root[i.max(j)] = i.min(j);
}

/// `[panels]` which panels to flip so that faces on a common edge run along it in opposite
/// directions.
fn panels_to_flip(
    panel_count: usize,
    faces: &[[usize; 3]],
    panel_of_face: &[usize],
) -> Result<Vec<bool>> {
    // [edge, whether the face runs upwards along it, panel]
    let mut half_edges: Vec<([usize; 2], bool, usize)> = Vec::with_capacity(3 * faces.len());
    for (face, &p) in faces.iter().zip(panel_of_face) {
        for k in 0..3 {
            let (i, j) = (face[k], face[(k + 1) % 3]);
            half_edges.push(([i.min(j), i.max(j)], i < j, p));
        }
    }
    half_edges.sort_unstable();
    // For each panel: the panels it is sewn to, and whether just one of the two must be flipped.
    let mut sewn_to: Vec<Vec<(usize, bool)>> = vec![Vec::new(); panel_count];
    for pair in half_edges.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 2) {
        let ((p, q), disagree) = ((pair[0].2, pair[1].2), pair[0].1 == pair[1].1);
        if p != q || disagree {
            sewn_to[p].push((q, disagree));
            sewn_to[q].push((p, disagree));
        }
    }
    let mut flip: Vec<Option<bool>> = vec![None; panel_count];
    for start in 0..panel_count {
        if flip[start].is_some() {
            continue;
        }
        flip[start] = Some(false);
        let mut queue = VecDeque::from([(start, false)]);
        while let Some((p, flip_p)) = queue.pop_front() {
            sewn_to[p].sort_unstable();
            sewn_to[p].dedup();
            for &(q, disagree) in &sewn_to[p] {
                let wanted = flip_p != disagree;
                match flip[q] {
                    None => {
                        flip[q] = Some(wanted);
                        queue.push_back((q, wanted));
                    }
                    Some(chosen) if chosen != wanted => {
                        return Err(MeshError::OneSided { panels: [p, q] }.into());
                    }
                    Some(_) => {}
                }
            }
        }
    }
    Ok(flip.into_iter().map(|f| f.unwrap_or(false)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_panels_that_cut_the_same_corners_make_a_pillow() {
        let panel =
            Panel::new(&Outline::Rectangle { width_m: 1.4, height_m: 0.74 }, 0.1, 1).unwrap();
        let panels = [panel.clone(), panel.clone()];
        let seams: Vec<Seam<'_>> =
            panel.sides.iter().map(|side| Seam::new((0, side), (1, side))).collect();
        let sewn = sew(&panels, &seams).unwrap();
        assert!(sewn.topology.edge_faces.iter().all(|faces| faces[1] != crate::mesh::NONE));
        let area = |f: &[usize; 3]| {
            let [a, b, c] = f.map(|r| sewn.rest_positions[r]);
            0.5 * (b - a).perp(&(c - a)).abs()
        };
        let total: f64 = sewn.rest_faces.iter().map(area).sum();
        assert!(
            (total - 2.0 * 1.4 * 0.74).abs() < 1e-12
                && sewn.rest_faces.iter().all(|f| area(f) > 1e-4)
        );
    }
    use crate::mesh::panel::Outline;

    fn rectangle(width_m: f64, height_m: f64) -> Panel {
        Panel::new(&Outline::Rectangle { width_m, height_m }, 0.1, 1).unwrap()
    }

    fn euler(t: &Topology) -> i64 {
        (t.vertex_count + t.face_count()) as i64 - t.edge_count() as i64
    }

    fn boundary_loops(t: &Topology) -> usize {
        let mut root: Vec<usize> = (0..t.vertex_count).collect();
        let boundary: Vec<usize> = (0..t.edge_count()).filter(|&e| t.is_boundary_edge(e)).collect();
        for &e in &boundary {
            unite(&mut root, t.edges[e][0], t.edges[e][1]);
        }
        let mut roots: Vec<usize> =
            boundary.iter().map(|&e| find(&mut root, t.edges[e][0])).collect();
        roots.sort_unstable();
        roots.dedup();
        roots.len()
    }

    #[test]
    fn a_rectangle_becomes_a_cylinder() {
        let panel = rectangle(1.0, 0.5);
        let right = reversed(panel.side("right").unwrap());
        let seam = Seam::new((0, panel.side("left").unwrap()), (0, &right));
        let sewn = sew(std::slice::from_ref(&panel), &[seam]).unwrap();
        assert_eq!((euler(&sewn.topology), boundary_loops(&sewn.topology)), (0, 2));
        assert_eq!(sewn.topology.vertex_count, panel.positions.len() - right.len());
        assert_eq!((&sewn.rest_faces, &sewn.rest_positions), (&panel.faces, &panel.positions));
        for (face, rest) in sewn.topology.faces.iter().zip(&sewn.rest_faces) {
            assert_eq!(*face, rest.map(|r| sewn.vertex_of_rest[r]));
        }
        for (&l, &r) in seam.a.vertices.iter().zip(seam.b.vertices) {
            assert_eq!(sewn.vertex_of_rest[l], sewn.vertex_of_rest[r]);
            assert_eq!(panel.positions[l].y, panel.positions[r].y);
        }
    }

    #[test]
    fn vertices_are_numbered_by_their_lowest_rest_vertex() {
        let panels = [rectangle(0.5, 0.5), rectangle(0.5, 0.5)];
        let left = reversed(panels[1].side("left").unwrap());
        let sewn =
            sew(&panels, &[Seam::new((0, panels[0].side("right").unwrap()), (1, &left))]).unwrap();
        assert_eq!(sewn.flipped, [false, false]);
        let mut next = 0;
        for &v in &sewn.vertex_of_rest {
            assert!(v <= next);
            next = next.max(v + 1);
        }
        assert_eq!((next, euler(&sewn.topology)), (sewn.topology.vertex_count, 1));
    }

    #[test]
    fn two_disks_become_a_sphere_and_one_is_flipped() {
        let disk = Panel::new(&Outline::Disk { radius_m: 1.0 }, 0.2, 1).unwrap();
        let back = Panel::new(&Outline::Disk { radius_m: 1.0 }, 0.2, 2).unwrap();
        let panels = [disk, back];
        let rim = panels[0].side("rim").unwrap();
        let sewn =
            sew(&panels, &[Seam::new((0, rim), (1, panels[1].side("rim").unwrap()))]).unwrap();
        assert_eq!((euler(&sewn.topology), boundary_loops(&sewn.topology)), (2, 0));
        assert_eq!(sewn.flipped, [false, true]);
        for (f, rest) in sewn.rest_faces.iter().enumerate() {
            let [a, b, c] = rest.map(|r| sewn.rest_positions[r]);
            assert_eq!((b - a).perp(&(c - a)) > 0.0, f < panels[0].faces.len());
            assert_eq!(sewn.topology.faces[f], rest.map(|r| sewn.vertex_of_rest[r]));
        }
    }

    #[test]
    fn one_sided_surfaces_are_refused() {
        let panel = rectangle(1.0, 0.5);
        let seam = Seam::new((0, panel.side("left").unwrap()), (0, panel.side("right").unwrap()));
        let message = sew(std::slice::from_ref(&panel), &[seam]).unwrap_err().to_string();
        assert!(message.contains("Möbius"), "{message}");
        // The same from two panels: one seam fits, the other is twisted.
        let panels = [panel.clone(), panel];
        let [left, right] = ["left", "right"].map(|s| panels[0].side(s).unwrap());
        let back = reversed(right);
        let twisted = [Seam::new((0, left), (1, &back)), Seam::new((0, right), (1, left))];
        assert!(sew(&panels, &twisted).unwrap_err().to_string().contains("panels 0 and 1"));
        let front = reversed(left);
        let straight = [Seam::new((0, left), (1, &back)), Seam::new((0, right), (1, &front))];
        assert_eq!(euler(&sew(&panels, &straight).unwrap().topology), 0);
    }

    #[test]
    fn unusable_seams_are_named() {
        let panels = [rectangle(1.0, 0.5), rectangle(1.0, 0.52), rectangle(1.0, 0.503)];
        let message = |a: (usize, &[usize]), b: (usize, &[usize])| {
            sew(&panels, &[Seam::new(a, b)]).unwrap_err().to_string()
        };
        let [bottom, right] = ["bottom", "right"].map(|s| panels[0].side(s).unwrap());
        let text = message((0, bottom), (1, right));
        assert!(
            text.contains(
                "seam 0 (panel 0 to panel 1) joins 11 vertices over 1.000000 m to 6 \
            vertices over 0.520000 m"
            ),
            "{text}"
        );
        assert!(message((0, right), (1, right)).contains("within 1 %"));
        assert!(message((0, right), (3, right)).contains("does not exist"));
        assert!(message((0, &[0, 2]), (1, &[0, 2])).contains("vertices 0 and 2 of panel 0"));
        assert!(message((0, &[0, 9999]), (1, &[0, 1])).contains("9999"));
        assert!(message((0, &[0]), (1, &[0])).contains("1 vertices"));
        assert!(sew(&panels, &[Seam::new((0, right), (2, right))]).is_ok());
        let text =
            sew(&panels, &[Seam::new((0, right), (0, right)), Seam::new((0, right), (2, right))]);
        assert!(text.is_ok(), "a side sewn to itself changes nothing");
        let thrice = [Seam::new((0, bottom), (1, bottom)), Seam::new((0, bottom), (2, bottom))];
        assert!(sew(&panels, &thrice).unwrap_err().to_string().contains("shared by 3 faces"));
    }
}
