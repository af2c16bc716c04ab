//! The energy of a shell in its free coordinates, for [`crate::linalg::newton`]: membrane, bending,
//! loads and contact.

use std::ops::Range;

use nalgebra::SMatrix;
use rayon::prelude::*;

use super::contact::Barrier;
use super::mid_edge_bending::{ElementHessian, MidEdgeBending};
use super::pressure;
use super::quadratic_bending::QuadraticBending;
use super::setup::{Clamps, Setup};
use super::tension_field::{FaceHessian, Membrane};
use crate::linalg::ordered_sum::{CHUNK, ordered_sum};
use crate::linalg::sparse::SymmetricPattern;
use crate::linalg::{Problem, PsdProjection};
use crate::mesh::{NONE, Vec3};

/// Faces whose element Hessians are added at once.
const BUFFER: usize = 2048;

/// Bending energy of a shell.
pub(super) enum Bending {
    /// For base surfaces: quadratic in the positions.
    Quadratic(QuadraticBending),
    /// For the reference shell: by the angle between faces.
    MidEdge(MidEdgeBending),
}

/// The energy in the free coordinates, which come vertex by vertex, in units of the sheet's length
/// and Y·h·length².
pub(super) struct Equilibrium<'a> {
    setup: &'a Setup<'a>,
    membranes: Vec<Membrane>,
    bending: Bending,
    dead_newton: Vec<Vec3>,
    barrier: Option<Barrier<'a>>,
    /// `[V][3]` unknown of each coordinate.
    unknown: Vec<[usize; 3]>,
    size: usize,
    length_m: f64,
    unit_joule: f64,
    /// `[V]` positions (m) in which loads have no energy.
    origin: Vec<Vec3>,
    pose: Vec<Vec3>,
    /// Corners of each face; and with mid-edge bending, those of its neighbours, too.
    faces: Elements,
    hinges: Elements,
    pattern: SymmetricPattern,
    bending_values: Vec<f64>,
    buffers: [Buffer; 2],
}

/// Hessians of a batch of faces, and of their hinges if there are any.
#[derive(Clone, Default)]
struct Buffer {
    faces: Vec<FaceHessian>,
    hinges: Vec<ElementHessian>,
}

/// The free coordinates of each element, and where their couplings are in the matrix.
struct Elements {
    /// Local coordinates that are free and their unknowns, element after element.
    free: Vec<(u32, u32)>,
    /// `[n+1]` where each element starts in `free`.
    first: Vec<usize>,
    /// Slots of each element's lower triangle, element after element.
    slots: Vec<u32>,
    /// `[n]` where each element starts in `slots`.
    first_slot: Vec<usize>,
}

impl Elements {
    fn new(vertices: impl Iterator<Item = Vec<usize>>, unknown: &[[usize; 3]]) -> Self {
        let (mut free, mut first) = (Vec::new(), vec![0]);
        for element in vertices {
            for (corner, &v) in element.iter().enumerate().filter(|(_, v)| **v != NONE) {
                for axis in (0..3).filter(|&axis| unknown[v][axis] != NONE) {
                    free.push(((3 * corner + axis) as u32, unknown[v][axis] as u32));
                }
            }
            first.push(free.len());
        }
        Self { free, first, slots: Vec::new(), first_slot: Vec::new() }
    }

    fn unknowns(&self) -> impl Iterator<Item = Vec<usize>> {
        (0..self.first.len() - 1).map(|n| self.of(n).iter().map(|&(_, u)| u as usize).collect())
    }

    fn find_slots(&mut self, pattern: &SymmetricPattern) {
        let (mut slots, mut first_slot) = (Vec::new(), Vec::new());
        for list in self.unknowns() {
            first_slot.push(slots.len());
            slots.extend(pattern.element_slots(&list).map(|s| s as u32));
        }
        (self.slots, self.first_slot) = (slots, first_slot);
    }

    fn of(&self, n: usize) -> &[(u32, u32)] {
        &self.free[self.first[n]..self.first[n + 1]]
    }

    fn add_gradient(&self, n: usize, element: &[f64], scale: f64, gradient: &mut [f64]) {
        for &(c, u) in self.of(n) {
            gradient[u as usize] += scale * element[c as usize];
        }
    }

    fn add_hessian<const N: usize>(
        &self,
        n: usize,
        element: &SMatrix<f64, N, N>,
        scale: f64,
        values: &mut [f64],
    ) {
        let free = self.of(n);
        let mut slot = self.first_slot[n];
        for (k, &(c, u)) in free.iter().enumerate() {
            for &(d, v) in &free[..=k] {
                // An unknown that occurs twice couples with itself both ways.
                let times = if u == v && c != d { 2.0 } else { 1.0 };
                values[self.slots[slot] as usize] +=
                    times * scale * element[(c as usize, d as usize)];
                slot += 1;
            }
        }
    }
}

impl<'a> Equilibrium<'a> {
    /// The problem of `setup` near `pose` (m), with `held` instead of the setup's clamps.
    pub(super) fn new(
        setup: &'a Setup<'a>,
        held: &Clamps,
        pose: &[Vec3],
        compressive_stiffness: f64,
        bending: Bending,
    ) -> Self {
        let topology = &setup.sheet.topology;
        let (unknown, size) = held.free_coordinates();
        let mut faces = Elements::new(topology.faces.iter().map(|face| face.to_vec()), &unknown);
        let hinge_vertices: Vec<Vec<usize>> = match &bending {
            Bending::Quadratic(_) => Vec::new(),
            Bending::MidEdge(bending) => {
                (0..topology.face_count()).map(|f| bending.vertices(f).to_vec()).collect()
            }
        };
        let mut hinges = Elements::new(hinge_vertices.into_iter(), &unknown);
        let lists: Vec<Vec<usize>> = if let Bending::MidEdge(_) = bending {
            hinges.unknowns().collect()
        } else {
            faces.unknowns().collect()
        };
        let pattern = SymmetricPattern::from_elements(size, lists.iter().map(Vec::as_slice));
        faces.find_slots(&pattern);
        hinges.find_slots(&pattern);
        let length_m = setup.length_m();
        let unit_joule =
            setup.sheet.material.young_pa * setup.sheet.material.thickness_m * length_m * length_m;
        let batch = BUFFER.min(topology.face_count());
        let buffer = Buffer {
            faces: vec![FaceHessian::zeros(); batch],
            hinges: match bending {
                Bending::Quadratic(_) => Vec::new(),
                Bending::MidEdge(_) => vec![ElementHessian::zeros(); batch],
            },
        };
        let mut problem = Self {
            setup,
            membranes: setup
                .sheet
                .rest
                .faces
                .iter()
                .map(|r| Membrane::new(r, &setup.sheet.material, compressive_stiffness))
                .collect(),
            dead_newton: setup.dead_forces_newton(),
            barrier: Barrier::new(setup),
            unknown,
            size,
            length_m,
            unit_joule,
            origin: pose.to_vec(),
            pose: pose.to_vec(),
            buffers: [buffer.clone(), buffer],
            faces,
            hinges,
            bending_values: vec![0.0; pattern.entry_count()],
            pattern,
            bending,
        };
        problem.gather_quadratic_bending();
        problem
    }

    /// The part of quadratic bending's Hessian that fits the pattern; it never changes.
    fn gather_quadratic_bending(&mut self) {
        let Bending::Quadratic(bending) = &self.bending else { return };
        let scale = 2.0 * self.length_m * self.length_m / self.unit_joule;
        for row in &bending.rows {
            for axis in 0..3 {
                for (n, &(v, a)) in row.iter().enumerate() {
                    for &(u, b) in &row[..=n] {
                        let (i, j) = (self.unknown[v][axis], self.unknown[u][axis]);
                        if i == NONE || j == NONE {
                            continue;
                        }
                        let value = scale * a * b;
                        match self.pattern.find(i, j) {
                            Some(slot) => self.bending_values[slot] += value,
                            // Left out; the diagonal makes up for it, so that the matrix bounds the
                            // Hessian from above.
                            None => {
                                self.bending_values[self.pattern.slot(i, i)] += value.abs();
                                self.bending_values[self.pattern.slot(j, j)] += value.abs();
                            }
                        }
                    }
                }
            }
        }
    }

    /// Joules in one unit of energy.
    pub(super) fn unit_joule(&self) -> f64 {
        self.unit_joule
    }

    /// The unknowns of `pose` (m).
    pub(super) fn pack(&self, pose: &[Vec3]) -> Vec<f64> {
        let mut x = vec![0.0; self.size];
        for (unknown, p) in self.unknown.iter().zip(pose) {
            for axis in 0..3 {
                if unknown[axis] != NONE {
                    x[unknown[axis]] = p[axis] / self.length_m;
                }
            }
        }
        x
    }

    /// Writes the unknowns into `pose` (m); what is held stays.
    pub(super) fn unpack(&self, x: &[f64], pose: &mut [Vec3]) {
        for (unknown, p) in self.unknown.iter().zip(pose) {
            for axis in 0..3 {
                if unknown[axis] != NONE {
                    p[axis] = x[unknown[axis]] * self.length_m;
                }
            }
        }
    }

    fn take_pose(&mut self, x: &[f64]) {
        let mut pose = std::mem::take(&mut self.pose);
        self.unpack(x, &mut pose);
        self.pose = pose;
    }

    /// Corners of face `f` relative to a fixed point, for the volume.
    fn corners_about(&self, f: usize) -> [Vec3; 3] {
        self.setup.sheet.topology.faces[f].map(|v| self.pose[v] - self.origin[0])
    }

    fn face_energy(&self, f: usize) -> f64 {
        let mut energy =
            self.membranes[f].energy(&self.setup.sheet.topology.faces[f].map(|v| self.pose[v]));
        if let Bending::MidEdge(bending) = &self.bending {
            energy += bending.energy(f, &self.pose);
        }
        if self.setup.loads.pressure_pa != 0.0 {
            energy -=
                self.setup.loads.pressure_pa * pressure::signed_volume(&self.corners_about(f));
        }
        energy
    }

    /// Energy (J) of what belongs to vertices: quadratic bending, dead loads, contact.
    fn vertex_energy(&self, v: usize) -> f64 {
        let mut energy = -self.dead_newton[v].dot(&(self.pose[v] - self.origin[v]));
        if let Bending::Quadratic(bending) = &self.bending {
            energy +=
                bending.rows[v].iter().map(|&(u, c)| self.pose[u] * c).sum::<Vec3>().norm_squared();
        }
        if let Some(barrier) = &self.barrier {
            energy += barrier.energy(v, &self.pose[v]);
        }
        energy
    }

    fn energy_here(&self) -> f64 {
        let faces = ordered_sum(self.setup.sheet.topology.face_count(), |f| self.face_energy(f));
        (faces + ordered_sum(self.pose.len(), |v| self.vertex_energy(v))) / self.unit_joule
    }

    fn batches(&self) -> impl Iterator<Item = Range<usize>> + use<> {
        let n = self.setup.sheet.topology.face_count();
        (0..n).step_by(BUFFER).map(move |first| first..n.min(first + BUFFER))
    }

    fn element_hessians(
        &self,
        batch: &Range<usize>,
        projection: PsdProjection,
        buffer: &mut Buffer,
    ) {
        let pressure_pa = self.setup.loads.pressure_pa;
        buffer.faces.par_iter_mut().with_min_len(CHUNK).zip(batch.clone()).for_each(|(out, f)| {
            *out = self.membranes[f]
                .derivatives(&self.setup.sheet.topology.faces[f].map(|v| self.pose[v]), projection)
                .2;
            // The volume's Hessian is indefinite: it has no place in a convex one.
            if pressure_pa != 0.0 && projection == PsdProjection::None {
                *out -= pressure::hessian(&self.corners_about(f)) * pressure_pa;
            }
        });
        if let Bending::MidEdge(bending) = &self.bending {
            let hinges = buffer.hinges.par_iter_mut().with_min_len(CHUNK);
            hinges
                .zip(batch.clone())
                .for_each(|(out, f)| *out = bending.derivatives(f, &self.pose, projection).2);
        }
    }

    fn add_vertex_gradient(&self, gradient: &mut [f64]) {
        let scale = self.length_m / self.unit_joule;
        let mut add = |v: usize, force: Vec3| {
            for axis in 0..3 {
                if self.unknown[v][axis] != NONE {
                    gradient[self.unknown[v][axis]] += scale * force[axis];
                }
            }
        };
        for v in 0..self.pose.len() {
            add(v, -self.dead_newton[v]);
            if let Some(push) =
                self.barrier.as_ref().and_then(|barrier| barrier.push(v, &self.pose[v], false))
            {
                add(v, push.gradient);
            }
        }
        if let Bending::Quadratic(bending) = &self.bending {
            for row in &bending.rows {
                let sum: Vec3 = row.iter().map(|&(v, c)| self.pose[v] * c).sum();
                for &(v, c) in row {
                    add(v, sum * (2.0 * c));
                }
            }
        }
    }
}

impl Problem for Equilibrium<'_> {
    fn pattern(&self) -> SymmetricPattern {
        self.pattern.clone()
    }

    fn lower_bounds(&self) -> Vec<f64> {
        vec![f64::NEG_INFINITY; self.size]
    }

    fn energy(&mut self, x: &[f64]) -> f64 {
        self.take_pose(x);
        self.energy_here()
    }

    fn value_and_gradient(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        self.take_pose(x);
        gradient.fill(0.0);
        let scale = self.length_m / self.unit_joule;
        let pressure_pa = self.setup.loads.pressure_pa;
        for batch in self.batches() {
            let slopes: Vec<_> = batch
                .clone()
                .into_par_iter()
                .with_min_len(CHUNK)
                .map(|f| {
                    let mut slope = self.membranes[f]
                        .gradient(&self.setup.sheet.topology.faces[f].map(|v| self.pose[v]));
                    if pressure_pa != 0.0 {
                        slope -= pressure::gradient(&self.corners_about(f)) * pressure_pa;
                    }
                    slope
                })
                .collect();
            for (f, slope) in batch.clone().zip(&slopes) {
                self.faces.add_gradient(f, slope.as_slice(), scale, gradient);
            }
            if let Bending::MidEdge(bending) = &self.bending {
                let slopes: Vec<_> = batch
                    .clone()
                    .into_par_iter()
                    .with_min_len(CHUNK)
                    .map(|f| bending.gradient(f, &self.pose))
                    .collect();
                for (f, slope) in batch.zip(&slopes) {
                    self.hinges.add_gradient(f, slope.as_slice(), scale, gradient);
                }
            }
        }
        self.add_vertex_gradient(gradient);
        self.energy_here()
    }

    /// Quadratic bending reaches over two rings of vertices, the pattern over one: a third of the
    /// couplings, and far less fill.
    fn apply_hessian_remainder(&self, x: &[f64], out: &mut [f64]) -> bool {
        let Bending::Quadratic(bending) = &self.bending else { return false };
        self.pattern.add_multiple(-1.0, &self.bending_values, x, out);
        let scale = 2.0 * self.length_m * self.length_m / self.unit_joule;
        for row in &bending.rows {
            for axis in 0..3 {
                let free = || {
                    row.iter().map(|&(v, c)| (self.unknown[v][axis], c)).filter(|&(u, _)| u != NONE)
                };
                let sum: f64 = free().map(|(u, c)| c * x[u]).sum();
                for (u, c) in free() {
                    out[u] += scale * c * sum;
                }
            }
        }
        true
    }

    fn max_step_size(&mut self, _: &[f64], direction: &[f64]) -> f64 {
        let by = |v: usize| {
            Vec3::from_fn(|axis, _| match self.unknown[v][axis] {
                NONE => 0.0,
                u => direction[u] * self.length_m,
            })
        };
        self.barrier.as_ref().map_or(1.0, |barrier| barrier.max_step_size(&self.pose, by))
    }

    fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]) {
        values.copy_from_slice(&self.bending_values);
        let scale = self.length_m * self.length_m / self.unit_joule;
        let mut batches = self.batches();
        let [mut here, mut ahead] = std::mem::take(&mut self.buffers);
        let mut batch = batches.next();
        if let Some(batch) = &batch {
            self.element_hessians(batch, projection, &mut here);
        }
        // One batch is added, in order, while the next is being computed.
        while let Some(ready) = batch {
            batch = batches.next();
            let add = || {
                for (f, hessian) in ready.clone().zip(&here.faces) {
                    self.faces.add_hessian(f, hessian, scale, values);
                }
                for (f, hessian) in ready.zip(&here.hinges) {
                    self.hinges.add_hessian(f, hessian, scale, values);
                }
            };
            let compute = || {
                if let Some(batch) = &batch {
                    self.element_hessians(batch, projection, &mut ahead);
                }
            };
            rayon::join(add, compute);
            std::mem::swap(&mut here, &mut ahead);
        }
        self.buffers = [here, ahead];
        let Some(barrier) = &self.barrier else { return };
        for v in 0..self.pose.len() {
            let Some(push) = barrier.push(v, &self.pose[v], projection == PsdProjection::None)
            else {
                continue;
            };
            for i in 0..3 {
                for j in 0..=i {
                    let (a, b) = (self.unknown[v][i], self.unknown[v][j]);
                    if a != NONE && b != NONE {
                        values[self.pattern.slot(a, b)] += scale * push.hessian[(i, j)];
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::loads::Loads;
    use super::*;
    use crate::linalg::derivative_check::check_problem;
    use crate::material::Material;
    use crate::obstacle::Obstacle;
    use crate::random::Random;
    use crate::sheet::Sheet;

    /// A tetrahedron, where the neighbours of a face share their far corner, and an octahedron.
    fn closed_surfaces() -> [(Vec<Vec3>, Vec<[usize; 3]>); 2] {
        let [x, y, z] = [Vec3::x(), Vec3::y(), Vec3::z()];
        let around = [
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ];
        [
            (vec![Vec3::zeros(), x, y, z], vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
            (vec![x, y, z, -x, -y, -z], around.to_vec()),
        ]
    }

    /// Everything at once: gravity, a point force, pressure, two obstacles in touch with a vertex,
    /// and clamps on some axes.
    #[test]
    fn derivatives_of_everything_together_agree_with_differences() {
        for (shape, faces) in closed_surfaces() {
            // Thick, so that bending is not lost beside the membrane.
            let material = Material::new(50.0, 0.3, 0.3).unwrap();
            let sheet = Sheet::from_rest(shape.clone(), faces, material).unwrap();
            let mut random = Random(7);
            let mut number = || 2.0 * random.unit() - 1.0;
            let pose: Vec<Vec3> = shape
                .iter()
                .map(|p| 1.05 * p + 0.15 * Vec3::new(number(), number(), number()))
                .collect();
            let mut clamps = Clamps::none(pose.len());
            clamps.targets[0] = [Some(pose[0].x), None, Some(pose[0].z)];
            clamps.targets[3] = [None, Some(pose[3].y), None];
            let out = (pose[2] - pose.iter().sum::<Vec3>() / pose.len() as f64).normalize();
            let beside = (out + Vec3::new(0.3, 0.0, -0.2)).normalize();
            let obstacles = [
                Obstacle::plane("beyond", pose[2] + 0.2 * out, Vec3::new(0.1, 0.2, 0.0) - out)
                    .unwrap(),
                Obstacle::sphere("beside", pose[2] + 0.8 * beside, 0.5).unwrap(),
            ];
            let setup = Setup {
                loads: Loads {
                    density_kg_m3: 2.0,
                    gravity_m_s2: Vec3::new(0.3, -1.0, -9.0),
                    pressure_pa: 4.0,
                    forces_newton: vec![(1, Vec3::new(1.0, -2.0, 0.5))],
                },
                obstacles: &obstacles,
                contact_thickness_m: 0.5,
                ..Setup::new(&sheet, &clamps)
            };
            assert!(
                obstacles.iter().all(|o| (0.0..0.5).contains(&o.distance_m(&pose[2]))),
                "both touch vertex 2"
            );
            for (stiffness, bending) in [
                (
                    0.1,
                    Bending::Quadratic(QuadraticBending::new(
                        &sheet.topology,
                        &sheet.rest,
                        &material,
                    )),
                ),
                (
                    1.0,
                    Bending::MidEdge(MidEdgeBending::new(&sheet.topology, &sheet.rest, &material)),
                ),
            ] {
                let mut problem = Equilibrium::new(&setup, &clamps, &pose, stiffness, bending);
                let x = problem.pack(&pose);
                assert_eq!(x.len(), 3 * pose.len() - 3);
                check_problem(&mut problem, &x, 1.0);
            }
        }
    }
}
