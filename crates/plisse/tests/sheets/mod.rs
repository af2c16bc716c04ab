//! Sheets that the tests and benches of this crate work on, and seeded randomness to shuffle them
//! with.

#![allow(dead_code)] // Each test file takes what it needs.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::ops::Deref;

use plisse::field::{FieldOptions, Solved, solve};
use plisse::growth::{Expansion, GrowingSurface, GrowthMaps};
use plisse::linalg::Ending;
use plisse::material::Material;
use plisse::mesh::Vec3;
use plisse::mesh::panel::{Outline, Panel};
use plisse::mesh::sew::{Seam, reversed, sew};
use plisse::progress::{Observer, Silent};
pub(crate) use plisse::random::Random;
use plisse::shell::{
    BaseOptions, BaseReport, Clamps, ReferenceOptions, Setup, solve_base, solve_reference,
};
use plisse::{RestShape, Result, Sheet};

/// A sheet of Mylar in a pose.
#[derive(Clone)]
pub(crate) struct PosedSheet {
    pub(crate) sheet: Sheet,
    /// `[V]` pose (m).
    pub(crate) pose: Vec<Vec3>,
    /// `[V]` vertices whose amplitude is zero.
    pub(crate) held: Vec<bool>,
}

impl Deref for PosedSheet {
    type Target = Sheet;

    fn deref(&self) -> &Sheet {
        &self.sheet
    }
}

impl PosedSheet {
    pub(crate) fn new(rest_shape: RestShape, faces: Vec<[usize; 3]>, pose: Vec<Vec3>) -> Self {
        let sheet = Sheet::sewn(faces, rest_shape, mylar()).unwrap();
        assert_eq!(sheet.topology.vertex_count, pose.len());
        let held = vec![false; pose.len()];
        Self { sheet, pose, held }
    }

    /// At rest where it is.
    pub(crate) fn at_rest(positions: Vec<Vec3>, faces: Vec<[usize; 3]>) -> Self {
        let rest_shape = RestShape { positions: positions.clone(), faces: faces.clone() };
        Self::new(rest_shape, faces, positions)
    }

    /// A growing surface that starts here, with the same λ and Λ (m) everywhere.
    pub(crate) fn growing_surface(
        &self,
        expansion: &Expansion,
        wavelength_m: f64,
        coherence_m: f64,
    ) -> GrowingSurface {
        let maps = GrowthMaps::even(expansion, wavelength_m, coherence_m);
        GrowingSurface::new(self.topology.clone(), self.rest.clone(), self.pose.clone(), maps)
    }

    /// A flat irregular panel at rest, in the plane z = 0.
    pub(crate) fn flat(outline: &Outline, edge_length_m: f64, seed: u64) -> Self {
        let panel = Panel::new(outline, edge_length_m, seed).unwrap();
        let positions: Vec<Vec3> =
            panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        Self::at_rest(positions, panel.faces)
    }

    pub(crate) fn rectangle(width_m: f64, height_m: f64, edge_length_m: f64, seed: u64) -> Self {
        Self::flat(&Outline::Rectangle { width_m, height_m }, edge_length_m, seed)
    }

    /// A flat rectangle at rest of `columns` × `rows` squares, all cut the same way, so that any
    /// two neighbouring faces form a parallelogram: there mid-edge bending converges to that of a
    /// plate. Vertex j·(columns + 1) + i is the i-th of row j.
    pub(crate) fn lattice(width_m: f64, height_m: f64, columns: usize, rows: usize) -> Self {
        let row = columns + 1;
        let at = |v: usize| {
            Vec3::new(
                width_m * (v % row) as f64 / columns as f64,
                height_m * (v / row) as f64 / rows as f64,
                0.0,
            )
        };
        let positions: Vec<Vec3> = (0..row * (rows + 1)).map(at).collect();
        let corners = (0..rows * row).filter(|v| (v + 1) % row != 0);
        let faces: Vec<[usize; 3]> =
            corners.flat_map(|v| [[v, v + 1, v + row], [v + 1, v + row + 1, v + row]]).collect();
        Self::at_rest(positions, faces)
    }

    /// A closed ball at rest: an icosahedron of which every face is cut into four `cuts` times, on
    /// the sphere of this radius.
    pub(crate) fn ball(radius_m: f64, cuts: usize) -> Self {
        let (positions, faces) = icosphere(cuts);
        let positions: Vec<Vec3> = positions.iter().map(|p| p * radius_m).collect();
        Self::at_rest(positions, faces)
    }

    /// A ring of this radius whose tube has the radius `tube_m`, at rest, of about regular
    /// triangles of this edge length.
    pub(crate) fn torus(radius_m: f64, tube_m: f64, edge_length_m: f64) -> Self {
        let around = (TAU * radius_m / edge_length_m).round() as usize;
        let rows = 2 * (0.5 * TAU * tube_m / (edge_length_m * 0.75_f64.sqrt())).round() as usize;
        let at = |v: usize| {
            let (i, j) = (v % around, v / around);
            // Every second row lies half an edge farther on.
            let (long, short) = (
                TAU * (i as f64 + 0.5 * (j % 2) as f64) / around as f64,
                TAU * j as f64 / rows as f64,
            );
            let out = radius_m + tube_m * short.cos();
            Vec3::new(out * long.cos(), out * long.sin(), tube_m * short.sin())
        };
        let positions: Vec<Vec3> = (0..around * rows).map(at).collect();
        let squares = (0..around * rows).flat_map(|v| {
            let (i, j) = (v % around, v / around);
            let (next, above) = ((i + 1) % around, (j + 1) % rows * around);
            let (a, b, c, d) = (v, j * around + next, above + i, above + next);
            if j % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] }
        });
        let faces: Vec<[usize; 3]> = squares.collect();
        Self::at_rest(positions, faces)
    }

    /// The same sheet with every vertex of the pose moved.
    pub(crate) fn posed(mut self, map: impl Fn(Vec3) -> Vec3) -> Self {
        self.pose = self.pose.iter().map(|&p| map(p)).collect();
        self
    }

    /// The same sheet of another material.
    pub(crate) fn of(&self, material: &Material) -> Sheet {
        Sheet { material: *material, ..self.sheet.clone() }
    }

    /// Solves for the field of the sheet of this material.
    pub(crate) fn solve(&self, material: &Material, options: &FieldOptions) -> Solved {
        solve(&self.of(material), &self.pose, &self.held, options, &Silent).unwrap()
    }

    /// Middle of face `f` at rest (m).
    pub(crate) fn middle(&self, f: usize) -> Vec3 {
        self.rest_shape.corners(f).iter().sum::<Vec3>() / 3.0
    }
}

/// Vertices on the unit sphere and faces (counter-clockwise seen from outside) of an icosahedron,
/// cut `cuts` times.
pub(crate) fn icosphere(cuts: usize) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let corners: Vec<Vec3> = (0..3)
        .flat_map(|axis| {
            [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)].map(|(a, b)| {
                let mut p = Vec3::zeros();
                (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (a, b);
                p
            })
        })
        .collect();
    // Faces are the triples of corners that are all 2 apart.
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let [a, b, c] = [i, j, k].map(|v| corners[v]);
                if [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (p - q).norm() < 2.1) {
                    faces.push(if (b - a).cross(&(c - a)).dot(&a) > 0.0 {
                        [i, j, k]
                    } else {
                        [i, k, j]
                    });
                }
            }
        }
    }
    let mut positions: Vec<Vec3> = corners.iter().map(|p| p.normalize()).collect();
    for _ in 0..cuts {
        let mut middles = BTreeMap::new();
        let mut middle = |i: usize, j: usize| {
            *middles.entry([i.min(j), i.max(j)]).or_insert_with(|| {
                positions.push((positions[i] + positions[j]).normalize());
                positions.len() - 1
            })
        };
        let cut = |&[i, j, k]: &[usize; 3]| {
            let [a, b, c] = [middle(i, j), middle(j, k), middle(k, i)];
            [[i, a, c], [a, j, b], [c, b, k], [a, b, c]]
        };
        faces = faces.iter().flat_map(cut).collect();
    }
    (positions, faces)
}

/// The two solves of a shell under loads, for tests that both must pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solver {
    Base,
    Reference,
}

/// The common part of both solves' reports.
#[derive(Clone, Debug)]
pub(crate) struct Equilibrium {
    pub(crate) pose: Vec<Vec3>,
    pub(crate) energy_joule: f64,
    pub(crate) gradient_newton: f64,
    pub(crate) iterations: usize,
    pub(crate) ending: Ending,
    pub(crate) resolved_faces: Vec<usize>,
}

impl Equilibrium {
    /// True if the solve came to its end by itself.
    pub(crate) fn settled(&self) -> bool {
        matches!(self.ending, Ending::Converged | Ending::RoundOff)
    }

    /// `[V][3]` the pose bit for bit.
    pub(crate) fn bits(&self) -> Vec<u64> {
        self.pose.iter().flat_map(|p| p.iter().map(|x| x.to_bits())).collect()
    }
}

impl Solver {
    pub(crate) const BOTH: [Self; 2] = [Self::Base, Self::Reference];

    pub(crate) fn solve(self, setup: &Setup<'_>, start: &[Vec3]) -> Result<Equilibrium> {
        self.observed(setup, start, &Silent)
    }

    pub(crate) fn observed(
        self,
        setup: &Setup<'_>,
        start: &[Vec3],
        observer: &dyn Observer,
    ) -> Result<Equilibrium> {
        match self {
            Self::Base => {
                let (pose, r) = solve_base(setup, start, &BaseOptions::default(), observer)?;
                let (iterations, ending, resolved_faces) =
                    (r.iterations, r.ending, r.resolved_faces);
                let (energy_joule, gradient_newton) = (r.energy_joule, r.gradient_newton);
                Ok(Equilibrium {
                    pose,
                    energy_joule,
                    gradient_newton,
                    iterations,
                    ending,
                    resolved_faces,
                })
            }
            Self::Reference => {
                let (pose, r) =
                    solve_reference(setup, start, &ReferenceOptions::default(), observer)?;
                let (iterations, ending, resolved_faces) =
                    (r.iterations, r.ending, r.resolved_faces);
                let (energy_joule, gradient_newton) = (r.energy_joule, r.gradient_newton);
                Ok(Equilibrium {
                    pose,
                    energy_joule,
                    gradient_newton,
                    iterations,
                    ending,
                    resolved_faces,
                })
            }
        }
    }
}

/// A ring of which the inside is opened and the rim turned, over a low hill, with both rims held:
/// sheared faces that wrinkle around a wrinkle-free, tense inside. Its phase gains turns around the
/// hole (b₁ = 1).
pub(crate) fn twisted_ring(edge_length_m: f64, seed: u64) -> PosedSheet {
    let (inner, outer) = (0.3, 1.0);
    let ring = PosedSheet::flat(
        &Outline::Annulus { inner_radius_m: inner, outer_radius_m: outer },
        edge_length_m,
        seed,
    );
    let held = ring.topology.boundary_vertices();
    let mut ring = ring.posed(|p| {
        let (r, angle) = (p.x.hypot(p.y), p.y.atan2(p.x));
        let t = (r - inner) / (outer - inner);
        let (s, c) = (angle + 0.12 * t * t).sin_cos();
        let radius = 1.02 * r + 0.02;
        Vec3::new(radius * c, radius * s, 0.1 * (1.0 - r * r))
    });
    ring.held = held;
    ring
}

/// The twisted cylinder of the paper (radius 1 m, height 5 m, irregular, sewn from one panel), its
/// top turned by 10°: a smooth pose to start the base solve from, with the rims as clamps.
pub(crate) fn twisted_cylinder(edge_length_m: f64) -> (PosedSheet, Clamps) {
    let panel =
        Panel::new(&Outline::Rectangle { width_m: TAU, height_m: 5.0 }, edge_length_m, 7).unwrap();
    let left = reversed(panel.side("left").unwrap());
    let seam = Seam::new((0, panel.side("right").unwrap()), (0, &left));
    let sewn = sew(std::slice::from_ref(&panel), &[seam]).unwrap();
    let rest_positions: Vec<Vec3> =
        sewn.rest_positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
    let mut pose = vec![Vec3::zeros(); sewn.topology.vertex_count];
    let mut clamps = Clamps::none(pose.len());
    for (p, &v) in sewn.rest_positions.iter().zip(&sewn.vertex_of_rest) {
        let (s, c) = (p.x + PI / 18.0 * p.y / 5.0).sin_cos();
        pose[v] = Vec3::new(c, -s, p.y);
        if p.y < 1e-9 || p.y > 5.0 - 1e-9 {
            clamps.hold(v, pose[v]);
        }
    }
    let rest_shape = RestShape { positions: rest_positions, faces: sewn.rest_faces };
    let mut sheet = PosedSheet::new(rest_shape, sewn.topology.faces, pose);
    sheet.held = clamps.held();
    (sheet, clamps)
}

/// [`twisted_cylinder`] after its base solve.
pub(crate) fn twisted_cylinder_at_rest(edge_length_m: f64) -> (PosedSheet, BaseReport) {
    let (mut sheet, clamps) = twisted_cylinder(edge_length_m);
    let (pose, report) =
        solve_base(&Setup::new(&sheet, &clamps), &sheet.pose, &BaseOptions::default(), &Silent)
            .unwrap();
    sheet.pose = pose;
    (sheet, report)
}

/// The material of the paper's disk and cylinder.
pub(crate) fn mylar() -> Material {
    Material::new(1e7, 0.44, 1e-4).unwrap()
}

/// `0..n` in random order.
pub(crate) fn permutation(random: &mut Random, n: usize) -> Vec<usize> {
    let mut list: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        list.swap(i, (random.next_u64() % (i as u64 + 1)) as usize);
    }
    list
}

/// Edge length (m) with which [`twisted_cylinder`] has about this many vertices.
pub(crate) fn edge_length_for(vertices: usize) -> f64 {
    (TAU * 5.0 / (0.85 * vertices as f64)).sqrt()
}
