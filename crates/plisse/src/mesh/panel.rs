//! Flat panels: an outline, its sides divided evenly, its inside triangulated at random.
//!
//! Deliberately irregular: on a structured mesh the edges prefer a few directions, and wrinkles
//! follow them instead of the physics ([`super::grid`] makes such meshes on purpose). The inside is
//! a maximal Poisson-disk sample, joined by a constrained Delaunay triangulation. Where sides are
//! longer than an edge length and meet at 60 degrees or more, all angles are about 30 degrees or
//! more; sharper corners, necks and sides narrower than an edge length give thinner triangles, for
//! nothing is graded.

use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::{Vec2, scatter::scatter};
use crate::{Error, Result};

/// Most vertices a panel may have, about.
pub(super) const MAX_VERTICES: f64 = 2e6;
/// Most edge-length squares that a panel's bounding box may hold (it bounds memory for panels that
/// fill little of their box).
const MAX_BOX: f64 = 2e7;
/// Least distance of two inner vertices, in edge lengths: a maximal sample's mean edge is longer
/// than its least one.
const SPACING: f64 = 0.755;
/// Least distance of an inner vertex from the outline, in edge lengths. The spacing from boundary
/// vertices keeps inner ones about as far off; this matters where a short side makes pieces longer
/// than asked.
const OFF_OUTLINE: f64 = 0.55;
/// Coordinates below this (in edge lengths) are taken as 0, because the triangulation refuses the
/// tiniest numbers.
const TINY: f64 = 1e-30;

/// Outline of a flat panel (m).
#[derive(Clone, Debug, PartialEq)]
pub enum Outline {
    /// Lower left corner at the origin; sides "bottom" (from the origin along x), "right", "top",
    /// "left", counter-clockwise.
    Rectangle {
        /// Extent along x (m).
        width_m: f64,
        /// Extent along y (m).
        height_m: f64,
    },
    /// Centred at the origin; one closed side "rim", counter-clockwise from the x axis.
    Disk {
        /// Radius (m).
        radius_m: f64,
    },
    /// Centred at the origin; closed sides "outer" and "inner", both counter-clockwise from the x
    /// axis.
    Annulus {
        /// Radius of the hole (m).
        inner_radius_m: f64,
        /// Radius of the outer rim (m).
        outer_radius_m: f64,
    },
    /// Side "0" runs from corner 0 to corner 1, and so on; the last returns to corner 0. Either
    /// sense of rotation will do.
    Polygon {
        /// `[corners][2]` corners in order (m).
        corners_m: Vec<[f64; 2]>,
        /// Corner at which each side begins, ascending, and the side's name. A side runs through
        /// the corners that are not listed to the next one that is; the last runs through corner 0
        /// to the first. With one entry, the side is closed. Empty: every corner begins a side that
        /// is called by its number.
        sides: Vec<(usize, String)>,
    },
}

impl Outline {
    /// Names of a rectangle's sides.
    pub const RECTANGLE_SIDES: [&'static str; 4] = ["bottom", "right", "top", "left"];
}

/// A flat triangulated panel. Its boundary vertices come first, in the order of the sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// `[V]` vertices (m).
    pub positions: Vec<Vec2>,
    /// `[F][3]` vertices of each face, counter-clockwise; sorted.
    pub faces: Vec<[usize; 3]>,
    /// `[sides]` vertices in order along each side: both ends of a straight side, each vertex once
    /// on a closed one.
    pub sides: Vec<Vec<usize>>,
    /// `[sides]` name of each side, see [`Outline`].
    pub side_names: Vec<String>,
}

impl Panel {
    /// The panel within `outline`, with edges `edge_length_m` long on average (m). Each side is
    /// divided evenly into round(length / edge length) pieces, but at least 1 (a circle: 6). The
    /// same `seed` gives the same panel.
    ///
    /// # Errors
    /// [`Error::Value`] naming the field for: a size that is not a positive number, an edge length
    /// that is longer than the panel is wide or asks for more than 2 million vertices, an annulus
    /// with inner ≥ outer radius, a polygon with fewer than 3 corners, a repeated corner, sides
    /// that touch or cross, named sides that begin at no corner, out of order or with a name that
    /// is taken.
    pub fn new(outline: &Outline, edge_length_m: f64, seed: u64) -> Result<Self> {
        check_sizes(outline, edge_length_m)?;
        let boundary = Boundary::new(outline, edge_length_m);
        let unit = |p: &Vec2| (p / edge_length_m).map(|x| if x.abs() < TINY { 0.0 } else { x });
        let mut points: Vec<Vec2> = boundary.positions.iter().map(unit).collect();
        let pieces: Vec<[Vec2; 2]> =
            boundary.pieces.iter().map(|&[i, j]| [points[i], points[j]]).collect();
        let mut inner = scatter(&pieces, SPACING, OFF_OUTLINE, seed);
        // Bottom to top, so that neighbours have near numbers.
        inner.sort_by(|a, b| {
            a.y.floor().total_cmp(&b.y.floor()).then(a.x.total_cmp(&b.x)).then(a.y.total_cmp(&b.y))
        });
        points.extend(&inner);
        let faces = triangulate(&points, boundary.pieces)
            .ok_or_else(|| touching("two sides touch each other"))?;
        let mut positions = boundary.positions;
        positions.extend(inner.iter().map(|p| p * edge_length_m));
        Ok(Self { positions, faces, sides: boundary.sides, side_names: boundary.side_names })
    }

    /// Vertices in order along the side called `name`, see [`Outline`] for the names.
    pub fn side(&self, name: &str) -> Option<&[usize]> {
        let s = self.side_names.iter().position(|n| n == name)?;
        Some(&self.sides[s])
    }
}

/// The divided outline.
struct Boundary {
    positions: Vec<Vec2>,
    /// `[pieces][2]` consecutive vertices; piece `i` starts at vertex `i`.
    pieces: Vec<[usize; 2]>,
    sides: Vec<Vec<usize>>,
    side_names: Vec<String>,
}

impl Boundary {
    fn new(outline: &Outline, edge_length_m: f64) -> Self {
        let mut boundary = Self {
            positions: Vec::new(),
            pieces: Vec::new(),
            sides: Vec::new(),
            side_names: Vec::new(),
        };
        match outline {
            &Outline::Rectangle { width_m: w, height_m: h } => {
                let corners =
                    [Vec2::new(0.0, 0.0), Vec2::new(w, 0.0), Vec2::new(w, h), Vec2::new(0.0, h)];
                boundary.add_polygon(&corners, edge_length_m);
                boundary.side_names = Outline::RECTANGLE_SIDES.map(String::from).to_vec();
            }
            &Outline::Disk { radius_m } => boundary.add_circle("rim", radius_m, edge_length_m),
            &Outline::Annulus { inner_radius_m, outer_radius_m } => {
                boundary.add_circle("outer", outer_radius_m, edge_length_m);
                boundary.add_circle("inner", inner_radius_m, edge_length_m);
            }
            Outline::Polygon { corners_m, sides } => {
                boundary.add_polygon(
                    &corners_m.iter().map(|&c| Vec2::from(c)).collect::<Vec<_>>(),
                    edge_length_m,
                );
                boundary.side_names = (0..corners_m.len()).map(|s| s.to_string()).collect();
                boundary.join_sides(sides);
            }
        }
        boundary
    }

    /// Joins the sides between corners to those that `named` lists, see [`Outline::Polygon`].
    fn join_sides(&mut self, named: &[(usize, String)]) {
        if named.is_empty() {
            return;
        }
        let straight = std::mem::take(&mut self.sides);
        self.side_names = named.iter().map(|(_, name)| name.clone()).collect();
        for (n, &(start, _)) in named.iter().enumerate() {
            let end =
                if n + 1 < named.len() { named[n + 1].0 } else { straight.len() + named[0].0 };
            let mut chain: Vec<usize> = (start..end)
                .flat_map(|s| straight[s % straight.len()].split_last().expect("sides have ends").1)
                .copied()
                .collect();
            if named.len() > 1 {
                chain.push(straight[end % straight.len()][0]);
            }
            self.sides.push(chain);
        }
    }

    fn add_polygon(&mut self, corners: &[Vec2], edge_length_m: f64) {
        for (s, &a) in corners.iter().enumerate() {
            let b = corners[(s + 1) % corners.len()];
            let count = (((b - a).norm() / edge_length_m).round() as usize).max(1);
            let first = self.positions.len();
            // Both ends weighted: opposite sides get the same coordinates to the bit, whichever way
            // they run.
            self.positions
                .extend((0..count).map(|k| (a * (count - k) as f64 + b * k as f64) / count as f64));
            let last = if s + 1 == corners.len() { 0 } else { first + count };
            self.sides.push((first..first + count).chain([last]).collect());
            self.pieces.extend(
                (first..first + count)
                    .map(|i| [i, if i + 1 == first + count { last } else { i + 1 }]),
            );
        }
    }

    fn add_circle(&mut self, name: &str, radius_m: f64, edge_length_m: f64) {
        let count = ((TAU * radius_m / edge_length_m).round() as usize).max(6);
        let first = self.positions.len();
        let angle = |k: usize| TAU * k as f64 / count as f64;
        self.positions
            .extend((0..count).map(|k| Vec2::new(angle(k).cos(), angle(k).sin()) * radius_m));
        self.pieces.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
        self.sides.push((first..first + count).collect());
        self.side_names.push(name.to_owned());
    }
}

/// Faces of the constrained Delaunay triangulation of `points` that lie inside the loops of
/// `pieces`, counter-clockwise, lowest vertex first, sorted. None if pieces cross or points
/// coincide.
fn triangulate(points: &[Vec2], pieces: Vec<[usize; 2]>) -> Option<Vec<[usize; 3]>> {
    let vertices = points.iter().map(|p| Point2::new(p.x, p.y)).collect();
    let mut conflict = false;
    let piece_count = pieces.len();
    let cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(
        vertices,
        pieces,
        |_| conflict = true,
    )
    .ok()?;
    if conflict || cdt.num_vertices() != points.len() || cdt.num_constraints() != piece_count {
        return None;
    }
    // Walk inwards from the outer face; each piece crossed changes sides.
    let mut inside: Vec<Option<bool>> = vec![None; cdt.num_all_faces()];
    let outer = cdt.outer_face().fix().index();
    inside[outer] = Some(false);
    let mut queue: VecDeque<_> = cdt
        .convex_hull()
        .map(|edge| if edge.face().is_outer() { edge } else { edge.rev() })
        .collect();
    while let Some(edge) = queue.pop_front() {
        let across = edge.rev().face();
        if inside[across.fix().index()].is_none() {
            let here =
                inside[edge.face().fix().index()].expect("walked edges leave from known faces");
            inside[across.fix().index()] = Some(here != edge.is_constraint_edge());
            let back = edge.rev();
            queue.extend([back.next(), back.prev()]);
        }
    }
    let mut faces: Vec<[usize; 3]> = cdt
        .inner_faces()
        .filter(|face| inside[face.fix().index()] == Some(true))
        .map(|face| {
            let [a, b, c] = face.vertices().map(|v| v.fix().index());
            if a < b && a < c {
                [a, b, c]
            } else if b < c {
                [b, c, a]
            } else {
                [c, a, b]
            }
        })
        .collect();
    faces.sort_unstable();
    Some(faces)
}

fn check_sizes(outline: &Outline, edge_length_m: f64) -> Result<()> {
    let positive = |field: &str, value: f64| {
        if value.is_finite() && value > 0.0 {
            Ok(())
        } else {
            Err(Error::value(
                field,
                format!("{value} is no length; give a positive number of metres"),
            ))
        }
    };
    positive("edge_length_m", edge_length_m)?;
    // The panel's narrowest extent, area and bounding box area.
    let (narrowest, area, box_area, perimeter) = match outline {
        &Outline::Rectangle { width_m: w, height_m: h } => {
            positive("width_m", w)?;
            positive("height_m", h)?;
            (w.min(h), w * h, w * h, 2.0 * (w + h))
        }
        &Outline::Disk { radius_m: r } => {
            positive("radius_m", r)?;
            (r, PI * r * r, 4.0 * r * r, TAU * r)
        }
        &Outline::Annulus { inner_radius_m: inner, outer_radius_m: outer } => {
            positive("inner_radius_m", inner)?;
            positive("outer_radius_m", outer)?;
            if inner >= outer {
                return Err(Error::value(
                    "inner_radius_m",
                    format!(
                        "{inner} m is not less than the outer radius {outer} m; make the hole \
                         smaller"
                    ),
                ));
            }
            (
                outer - inner,
                PI * (outer + inner) * (outer - inner),
                4.0 * outer * outer,
                TAU * (outer + inner),
            )
        }
        Outline::Polygon { corners_m, sides } => {
            check_sides(corners_m.len(), sides)?;
            check_polygon(corners_m)?
        }
    };
    let field = "edge_length_m";
    if edge_length_m > narrowest * (1.0 + 1e-9) {
        let message = format!(
            "{edge_length_m} m is longer than the panel is wide ({narrowest} m); give a shorter \
             edge length"
        );
        return Err(Error::value(field, message));
    }
    let count =
        area / (0.75f64.sqrt() * edge_length_m * edge_length_m) + perimeter / (2.0 * edge_length_m);
    // Written so that an overflow to infinity is refused, too.
    if !(count <= MAX_VERTICES && box_area <= MAX_BOX * edge_length_m * edge_length_m) {
        let message = format!(
            "{edge_length_m} m asks for about {count:.1e} vertices, more than 2 million or in too \
             large a box; give a longer one"
        );
        return Err(Error::value(field, message));
    }
    Ok(())
}

fn touching(what: &str) -> Error {
    Error::value(
        "corners_m",
        format!("{what}; give corners of a polygon whose sides do not touch or cross"),
    )
}

/// The sides that a polygon with `corner_count` corners may have.
fn check_sides(corner_count: usize, sides: &[(usize, String)]) -> Result<()> {
    for (n, (corner, name)) in sides.iter().enumerate() {
        if *corner >= corner_count {
            let message = format!(
                "there is no corner {corner}; the {corner_count} corners are counted from 0"
            );
            return Err(Error::value(format!("sides[{n}].corner"), message));
        }
        if n > 0 && *corner <= sides[n - 1].0 {
            let message = format!(
                "corner {corner} does not come after corner {}; list the sides in the order of \
                 their corners",
                sides[n - 1].0
            );
            return Err(Error::value(format!("sides[{n}].corner"), message));
        }
        if let Some(m) = sides[..n].iter().position(|(_, other)| other == name) {
            let message =
                format!("sides[{m}] is called \"{name}\", too; give each side a name of its own");
            return Err(Error::value(format!("sides[{n}].name"), message));
        }
    }
    Ok(())
}

/// Narrowest extent of the bounding box, area, bounding box area and perimeter of a valid polygon.
fn check_polygon(corners_m: &[[f64; 2]]) -> Result<(f64, f64, f64, f64)> {
    let field = "corners_m";
    let n = corners_m.len();
    if n < 3 {
        return Err(Error::value(
            field,
            format!("{n} corners do not enclose anything; give at least 3"),
        ));
    }
    if let Some(i) = corners_m.iter().position(|c| !(c[0].is_finite() && c[1].is_finite())) {
        return Err(Error::value(
            field,
            format!("corner {i} is not a finite point; give two numbers of metres"),
        ));
    }
    let corners: Vec<Vec2> = corners_m.iter().map(|&c| Vec2::from(c)).collect();
    let at = |i: usize| corners[i % n];
    if let Some(i) = (0..n).find(|&i| at(i) == at(i + 1)) {
        return Err(Error::value(
            field,
            format!("corners {i} and {} are the same point; remove one", (i + 1) % n),
        ));
    }
    if let Some(i) = (0..n).find(|&i| {
        cross(at(i), at(i + 1), at(i + 2)) == 0.0
            && (at(i + 1) - at(i)).dot(&(at(i + 2) - at(i + 1))) < 0.0
    }) {
        return Err(touching(&format!("sides {i} and {} run back over each other", (i + 1) % n)));
    }
    // Sides from left to right: only those that overlap in x can meet.
    let span = |s: usize| (at(s).x.min(at(s + 1).x), at(s).x.max(at(s + 1).x));
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&s, &t| span(s).0.total_cmp(&span(t).0).then(s.cmp(&t)));
    for (k, &s) in order.iter().enumerate() {
        for &t in order[k + 1..].iter().take_while(|&&t| span(t).0 <= span(s).1) {
            let adjacent = (s + 1) % n == t || (t + 1) % n == s;
            if !adjacent && segments_meet([at(s), at(s + 1)], [at(t), at(t + 1)]) {
                return Err(touching(&format!("sides {} and {} meet", s.min(t), s.max(t))));
            }
        }
    }
    let (lower, upper) = corners.iter().fold((at(0), at(0)), |(l, u), c| (l.inf(c), u.sup(c)));
    let extent = upper - lower;
    let area = 0.5 * (1..n - 1).map(|i| cross(at(0), at(i), at(i + 1))).sum::<f64>().abs();
    let perimeter = (0..n).map(|i| (at(i + 1) - at(i)).norm()).sum();
    Ok((extent.x.min(extent.y), area, extent.x * extent.y, perimeter))
}

/// Twice the signed area of triangle `a b c`.
fn cross(a: Vec2, b: Vec2, c: Vec2) -> f64 {
    (b - a).perp(&(c - a))
}

/// True if two closed segments have a point in common.
fn segments_meet([a, b]: [Vec2; 2], [c, d]: [Vec2; 2]) -> bool {
    let (ca, da, ac, bc) = (cross(a, b, c), cross(a, b, d), cross(c, d, a), cross(c, d, b));
    let within = |p: Vec2, q: Vec2, x: Vec2| {
        p.inf(&q) == p.inf(&q).inf(&x) && p.sup(&q) == p.sup(&q).sup(&x)
    };
    (ca * da < 0.0 && ac * bc < 0.0)
        || (ca == 0.0 && within(a, b, c))
        || (da == 0.0 && within(a, b, d))
        || (ac == 0.0 && within(c, d, a))
        || (bc == 0.0 && within(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::At;
    use crate::mesh::Topology;

    fn topology(panel: &Panel) -> Topology {
        Topology::new(panel.positions.len(), panel.faces.clone()).unwrap()
    }

    fn area(panel: &Panel) -> f64 {
        panel
            .faces
            .iter()
            .map(|f| {
                0.5 * cross(panel.positions[f[0]], panel.positions[f[1]], panel.positions[f[2]])
            })
            .sum()
    }

    fn smallest_angle_deg(panel: &Panel) -> f64 {
        let angle = |f: &[usize; 3], k: usize| {
            let p = |i: usize| panel.positions[f[(k + i) % 3]];
            (p(1) - p(0)).angle(&(p(2) - p(0))).to_degrees()
        };
        panel.faces.iter().flat_map(|f| (0..3).map(move |k| angle(f, k))).fold(180.0, f64::min)
    }

    fn edge_vectors(panel: &Panel, inner_only: bool) -> Vec<Vec2> {
        let t = topology(panel);
        let wanted = (0..t.edge_count()).filter(|&e| !(inner_only && t.is_boundary_edge(e)));
        wanted.map(|e| panel.positions[t.edges[e][1]] - panel.positions[t.edges[e][0]]).collect()
    }

    /// A polygon with a side from each corner.
    fn plain(corners_m: Vec<[f64; 2]>) -> Outline {
        Outline::Polygon { corners_m, sides: Vec::new() }
    }

    /// Outlines of several shapes with the edge lengths at which they are tried.
    fn samples() -> Vec<(Outline, f64)> {
        vec![
            (Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, 0.1),
            (Outline::Rectangle { width_m: 0.3, height_m: 0.1 }, 0.0123),
            (Outline::Rectangle { width_m: 2.0, height_m: 1.0 }, 0.031),
            (Outline::Disk { radius_m: 1.0 }, 0.11),
            (Outline::Disk { radius_m: 0.05 }, 0.0021),
            (Outline::Annulus { inner_radius_m: 0.5, outer_radius_m: 1.0 }, 0.07),
            (Outline::Annulus { inner_radius_m: 0.1, outer_radius_m: 1.0 }, 0.04),
        ]
    }

    #[test]
    fn triangles_are_well_shaped_and_of_the_asked_size() {
        for (outline, length) in samples() {
            for seed in 0..8 {
                let panel = Panel::new(&outline, length, seed).unwrap();
                let angle = smallest_angle_deg(&panel);
                assert!(angle >= 29.0, "{outline:?} seed {seed}: smallest angle {angle}");
                let edges = edge_vectors(&panel, false);
                let mean = edges.iter().map(|e| e.norm()).sum::<f64>() / edges.len() as f64;
                assert!(
                    (mean / length - 1.0).abs() < 0.05,
                    "{outline:?} seed {seed}: mean edge {mean} for {length}"
                );
            }
        }
    }

    #[test]
    fn edges_run_in_all_directions_and_valences_differ() {
        for (outline, length) in samples() {
            let panel = Panel::new(&outline, length, 5).unwrap();
            let mut bins = [0usize; 12];
            let edges = edge_vectors(&panel, true);
            for e in &edges {
                bins[(e.y.atan2(e.x).rem_euclid(PI) / PI * 12.0) as usize % 12] += 1;
            }
            let mean = edges.len() as f64 / 12.0;
            assert!(
                bins.iter().all(|&b| (b as f64) < 2.2 * mean && b as f64 > 0.3 * mean),
                "{outline:?}: {bins:?}"
            );
            let t = topology(&panel);
            let on_boundary = t.boundary_vertices();
            let neighbours = t.vertex_neighbours();
            let inner: Vec<usize> = (0..t.vertex_count)
                .filter(|&v| !on_boundary[v])
                .map(|v| neighbours[v].len())
                .collect();
            let six = inner.iter().filter(|&&n| n == 6).count();
            assert!(
                six as f64 <= 0.8 * inner.len() as f64,
                "{outline:?}: {six} of {} vertices are regular",
                inner.len()
            );
        }
    }

    #[test]
    fn panels_fill_their_outline_and_have_its_boundary() {
        for (outline, length) in samples() {
            let panel = Panel::new(&outline, length, 2).unwrap();
            let t = topology(&panel);
            let (expected, loops) = match outline {
                Outline::Rectangle { width_m, height_m } => (width_m * height_m, 1),
                Outline::Disk { .. } => (polygon_area(&panel, 0), 1),
                Outline::Annulus { .. } => (polygon_area(&panel, 0) - polygon_area(&panel, 1), 2),
                Outline::Polygon { .. } => unreachable!(),
            };
            assert!((area(&panel) / expected - 1.0).abs() < 1e-12, "{outline:?}");
            let euler = (t.vertex_count + t.face_count()) as i64 - t.edge_count() as i64;
            assert_eq!(euler, 2 - loops, "{outline:?}");
            // Counter-clockwise, and no vertex on the outline beside those of the sides.
            assert!(panel.faces.iter().all(|f| cross(
                panel.positions[f[0]],
                panel.positions[f[1]],
                panel.positions[f[2]]
            ) > 0.0));
            let boundary = t.boundary_vertices();
            let mut of_sides: Vec<usize> = panel.sides.concat();
            of_sides.sort_unstable();
            of_sides.dedup();
            assert_eq!(of_sides, (0..t.vertex_count).filter(|&v| boundary[v]).collect::<Vec<_>>());
        }
    }

    fn polygon_area(panel: &Panel, side: usize) -> f64 {
        let p: Vec<Vec2> = panel.sides[side].iter().map(|&v| panel.positions[v]).collect();
        0.5 * (0..p.len()).map(|i| p[i].perp(&p[(i + 1) % p.len()])).sum::<f64>()
    }

    #[test]
    fn sides_of_a_rectangle_are_named_and_divided_evenly() {
        let panel =
            Panel::new(&Outline::Rectangle { width_m: 1.0, height_m: 0.5 }, 0.09, 0).unwrap();
        let side = |name| {
            panel.side(name).unwrap().iter().map(|&v| panel.positions[v]).collect::<Vec<_>>()
        };
        let (bottom, top, right, left) = (side("bottom"), side("top"), side("right"), side("left"));
        assert_eq!((bottom.len(), top.len(), right.len(), left.len()), (12, 12, 7, 7));
        assert!(
            bottom
                .iter()
                .zip(top.iter().rev())
                .all(|(b, t)| b.x == t.x && b.y == 0.0 && t.y == 0.5)
        );
        assert!(
            right
                .iter()
                .zip(left.iter().rev())
                .all(|(r, l)| r.y == l.y && r.x == 1.0 && l.x == 0.0)
        );
        assert!(bottom.windows(2).all(|w| (w[1].x - w[0].x - 1.0 / 11.0).abs() < 1e-12));
        assert_eq!(
            (bottom[11], right[6], top[11], left[6]),
            (right[0], top[0], left[0], bottom[0])
        );
        assert!(panel.side("rim").is_none());
    }

    #[test]
    fn polygons_of_either_sense_and_with_dents_are_filled() {
        let mut corners_m =
            vec![[0.0, 0.0], [2.0, 0.1], [2.0, 1.1], [1.0, 1.0], [0.9, 2.1], [-0.1, 2.0]];
        for _ in 0..2 {
            let panel = Panel::new(&plain(corners_m.clone()), 0.1, 1).unwrap();
            let c = |i: usize| Vec2::from(corners_m[i % 6]);
            let expected = 0.5 * (0..6).map(|i| c(i).perp(&c(i + 1))).sum::<f64>().abs();
            assert!((area(&panel) / expected - 1.0).abs() < 1e-12);
            assert!(smallest_angle_deg(&panel) > 20.0);
            topology(&panel);
            for s in 0..6 {
                let side = panel.side(&s.to_string()).unwrap();
                assert_eq!(
                    (panel.positions[side[0]], panel.positions[*side.last().unwrap()]),
                    (c(s), c(s + 1))
                );
            }
            corners_m.reverse();
        }
    }

    #[test]
    fn named_sides_run_through_corners_that_are_not_listed() {
        let corners_m =
            vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.1], [2.0, 1.1], [1.0, 1.0], [0.0, 1.0]];
        let named = |list: &[(usize, &str)]| {
            let sides = list.iter().map(|&(corner, name)| (corner, name.to_owned())).collect();
            Panel::new(&Outline::Polygon { corners_m: corners_m.clone(), sides }, 0.1, 1)
        };
        let every = Panel::new(&plain(corners_m.clone()), 0.1, 1).unwrap();
        let joined = |sides: &[usize]| {
            let mut chain = every.sides[sides[0]].clone();
            sides[1..].iter().for_each(|&s| chain.extend(&every.sides[s][1..]));
            chain
        };
        let panel = named(&[(1, "hem"), (3, "right"), (4, "top")]).unwrap();
        assert_eq!((&panel.positions, &panel.faces), (&every.positions, &every.faces));
        assert_eq!(panel.side_names, ["hem", "right", "top"]);
        assert_eq!(panel.side("hem").unwrap(), joined(&[1, 2]));
        assert_eq!(panel.side("right").unwrap(), joined(&[3]));
        assert_eq!(panel.side("top").unwrap(), joined(&[4, 5, 0]));
        // One side alone is closed: each vertex once.
        let around = named(&[(2, "rim")]).unwrap();
        let mut closed = joined(&[2, 3, 4, 5, 0, 1]);
        assert_eq!(closed.pop(), Some(closed[0]));
        assert_eq!(around.sides, [closed]);
        let says = |list| named(list).at("p").unwrap_err().to_string();
        assert!(says(&[(6, "a")]).starts_with("p.sides[0].corner: there is no corner 6"));
        assert!(
            says(&[(2, "a"), (2, "b")])
                .starts_with("p.sides[1].corner: corner 2 does not come after corner 2")
        );
        assert!(says(&[(2, "a"), (1, "b")]).contains("list the sides in the order"));
        assert!(
            says(&[(1, "a"), (2, "b"), (3, "a")])
                .starts_with("p.sides[2].name: sides[0] is called \"a\", too")
        );
    }

    #[test]
    fn panels_of_a_few_long_pieces_are_well_shaped() {
        for width_m in [1.05, 1.45, 2.45, 3.45] {
            for height_m in [1.05, 1.45, 2.45] {
                for seed in 0..40 {
                    let panel =
                        Panel::new(&Outline::Rectangle { width_m, height_m }, 1.0, seed).unwrap();
                    let angle = smallest_angle_deg(&panel);
                    assert!(
                        angle >= 25.0,
                        "{width_m} x {height_m} m, seed {seed}: smallest angle {angle}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_smallest_panels_work() {
        let hexagon = Panel::new(&Outline::Disk { radius_m: 2.0 }, 2.0, 0).unwrap();
        assert_eq!((hexagon.positions.len(), hexagon.faces.len()), (7, 6));
        let square =
            Panel::new(&Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, 1.0, 0).unwrap();
        assert_eq!(square.faces.len(), 2);
        let triangle = plain(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]);
        assert_eq!(Panel::new(&triangle, 0.9, 0).unwrap().faces.len(), 2);
        topology(
            &Panel::new(&Outline::Annulus { inner_radius_m: 1.0, outer_radius_m: 1.3 }, 0.3, 0)
                .unwrap(),
        );
    }

    #[test]
    fn the_seed_decides_and_size_only_scales() {
        let disk =
            |radius_m, seed| Panel::new(&Outline::Disk { radius_m }, 0.1 * radius_m, seed).unwrap();
        assert_eq!(disk(1.0, 7), disk(1.0, 7));
        assert_ne!(disk(1.0, 7).positions, disk(1.0, 8).positions);
        let (large, small) = (disk(1.0, 7), disk(2f64.powi(-20), 7));
        assert_eq!(large.faces, small.faces);
    }

    #[test]
    fn unusable_outlines_are_named() {
        let message = |outline: Outline, length| {
            Panel::new(&outline, length, 0).at("panels.0").unwrap_err().to_string()
        };
        let polygon = |c: &[[f64; 2]]| message(plain(c.to_vec()), 0.1);
        let rectangle =
            |width_m, height_m, length| message(Outline::Rectangle { width_m, height_m }, length);
        assert!(rectangle(f64::NAN, 1.0, 0.1).starts_with("panels.0.width_m: NaN"));
        assert!(rectangle(1.0, -2.0, 0.1).starts_with("panels.0.height_m: -2"));
        assert!(rectangle(1.0, 1.0, 0.0).starts_with("panels.0.edge_length_m"));
        assert!(rectangle(1.0, 0.2, 0.3).contains("longer than the panel is wide"));
        assert!(rectangle(1.0, 1.0, 1e-4).contains("2 million"));
        assert!(rectangle(1e200, 1e200, 1.0).contains("2 million"));
        assert!(message(Outline::Disk { radius_m: f64::INFINITY }, 0.1).contains("radius_m"));
        assert!(
            message(Outline::Annulus { inner_radius_m: 1.0, outer_radius_m: 1.0 }, 0.1)
                .contains("not less than the outer")
        );
        assert!(polygon(&[[0.0, 0.0], [1.0, 0.0]]).contains("at least 3"));
        assert!(
            polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
                .contains("corners 1 and 2 are the same")
        );
        assert!(
            polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])
                .contains("sides 0 and 2 meet")
        );
        assert!(
            polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 1.0]])
                .contains("sides 0 and 3 meet")
        );
        assert!(polygon(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]]).contains("run back"));
        assert!(polygon(&[[0.0, 0.0], [2.0, f64::NAN], [1.0, 0.0]]).contains("corner 1"));
    }
}
