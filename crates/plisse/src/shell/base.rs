//! The base solve: the pose of least tension-field and bending energy under clamps.

use std::time::Instant;

use rayon::prelude::*;

use super::quadratic_bending::QuadraticBending;
use super::tension_field::{FaceGradient, FaceHessian, FaceState, Membrane};
use crate::linalg::cholesky::Cholesky;
use crate::linalg::newton::{Convexity, Ending, Options, Problem, minimise};
use crate::linalg::sparse::SymmetricPattern;
use crate::material::Material;
use crate::mesh::{NONE, Topology, Vec3};
use crate::progress::Observer;
use crate::rest::RestMetric;
use crate::{Error, Result};

/// Faces a thread takes at once.
const CHUNK: usize = 128;

/// What holds the surface: for each vertex and axis a target position (m), or nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Clamps {
    /// `[V][3]` target of each coordinate (m), `None` where it is free.
    pub targets: Vec<[Option<f64>; 3]>,
}

impl Clamps {
    /// No clamps on `vertex_count` vertices.
    pub fn none(vertex_count: usize) -> Self {
        Self { targets: vec![[None; 3]; vertex_count] }
    }

    /// Holds all coordinates of vertex `v` at `position` (m).
    pub fn hold(&mut self, v: usize, position: Vec3) {
        self.targets[v] = [Some(position.x), Some(position.y), Some(position.z)];
    }

    /// `[V]` whether any coordinate of each vertex is held.
    pub fn held(&self) -> Vec<bool> {
        self.targets.iter().map(|t| t.iter().any(Option::is_some)).collect()
    }
}

/// How the base surface is solved.
#[derive(Clone, Debug)]
pub struct BaseOptions {
    /// Share of the ordinary resistance that is left against compression (no unit, 0 to 1): 0 is tension field theory.
    pub compressive_stiffness: f64,
    /// Newton iterations at most.
    pub iteration_limit: usize,
    /// Largest gradient component at which the solve ends, in units of Young's modulus · thickness · size.
    pub tolerance: f64,
}

impl Default for BaseOptions {
    fn default() -> Self {
        Self { compressive_stiffness: 0.0, iteration_limit: 500, tolerance: 1e-12 }
    }
}

/// How the base solve went.
#[derive(Clone, Debug)]
pub struct BaseReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Why they ended.
    pub ending: Ending,
    /// Membrane and bending energy (J).
    pub energy_joule: f64,
    /// Largest gradient component (N).
    pub gradient_newton: f64,
    /// Faces whose area is below 1 % of their rest area.
    pub collapsed_faces: Vec<usize>,
    /// Faces whose normal points against the mean of their neighbours'.
    pub inverted_faces: Vec<usize>,
    /// Numbers of slack, mixed and taut faces.
    pub states: [usize; 3],
    /// Seconds.
    pub seconds: f64,
}

/// The base surface (`[V]`, m) of `topology` with rest metric `rest`, from the pose `start` (`[V]`, m) on.
///
/// `start` is first deformed smoothly so that it meets the clamps.
///
/// # Errors
/// [`Error::Value`] if no clamp holds the surface, or the sheet is not thin; [`Error::Numeric`] if the energy is not finite.
pub fn solve_base(
    topology: &Topology,
    rest: &RestMetric,
    start: &[Vec3],
    clamps: &Clamps,
    material: &Material,
    options: &BaseOptions,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, BaseReport)> {
    let begun = Instant::now();
    material.check_thin(rest.area_m2())?;
    for axis in 0..3 {
        if clamps.targets.iter().all(|t| t[axis].is_none()) {
            let name = ["x", "y", "z"][axis];
            return Err(Error::value(
                "clamps",
                format!("nothing holds the surface along {name}; clamp at least one vertex in that direction"),
            ));
        }
    }
    let length = rest.area_m2().sqrt();
    let energy_unit = material.young_pa * material.thickness_m * length * length;
    let mut pose = meet_clamps(topology, start, clamps)?;
    let mut problem = BaseProblem::new(topology, rest, &pose, clamps, material, options, length, energy_unit);
    let x = problem.pack(&pose);
    let newton = Options {
        stage: "base",
        iteration_limit: options.iteration_limit,
        tolerance: options.tolerance,
        convexity: Convexity::Clamped,
        ridge: 1e-14,
        energy_unit_joule: energy_unit,
    };
    let outcome = minimise(&mut problem, &x, &newton, observer)?;
    if !outcome.energy.is_finite() {
        return Err(Error::numeric("base", "the energy is not a finite number; check the material's constants and the clamps' positions"));
    }
    problem.unpack(&outcome.x, &mut pose);
    let mut states = [0; 3];
    for (membrane, face) in problem.membranes.iter().zip(&topology.faces) {
        states[match membrane.state(&face.map(|v| pose[v])) {
            FaceState::Slack => 0,
            FaceState::Mixed => 1,
            FaceState::Taut => 2,
        }] += 1;
    }
    let (collapsed_faces, inverted_faces) = defects(topology, rest, &pose);
    let report = BaseReport {
        iterations: outcome.iterations,
        ending: outcome.ending,
        energy_joule: outcome.energy * energy_unit,
        gradient_newton: outcome.projected_gradient * energy_unit / length,
        collapsed_faces,
        inverted_faces,
        states,
        seconds: begun.elapsed().as_secs_f64(),
    };
    Ok((pose, report))
}

/// Faces of `pose` that are collapsed (below 1 % of their rest area) and inverted (normal against the mean of their
/// neighbours').
pub fn defects(topology: &Topology, rest: &RestMetric, pose: &[Vec3]) -> (Vec<usize>, Vec<usize>) {
    let normals: Vec<Vec3> = topology
        .faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.map(|v| pose[v]);
            (b - a).cross(&(c - a)) * 0.5
        })
        .collect();
    let collapsed = (0..topology.face_count()).filter(|&f| normals[f].norm() < 0.01 * rest.faces[f].area_m2).collect();
    let inverted = (0..topology.face_count())
        .filter(|&f| {
            let around: Vec3 = (0..3).filter_map(|k| topology.neighbour(f, k)).map(|g| normals[g]).sum();
            normals[f].dot(&around) < 0.0
        })
        .collect();
    (collapsed, inverted)
}

/// `start` plus the smoothest (graph-harmonic) displacement that brings it to the clamps.
fn meet_clamps(topology: &Topology, start: &[Vec3], clamps: &Clamps) -> Result<Vec<Vec3>> {
    let n = topology.vertex_count;
    let pattern = SymmetricPattern::from_elements(n, topology.edges.iter().map(|e| &e[..]));
    let mut laplacian = vec![0.0; pattern.entry_count()];
    for &[i, j] in &topology.edges {
        laplacian[pattern.slot(i, i)] += 1.0;
        laplacian[pattern.slot(j, j)] += 1.0;
        laplacian[pattern.slot(i, j)] -= 1.0;
    }
    let mut cholesky = Cholesky::new(pattern)?;
    let mut pose = start.to_vec();
    for axis in 0..3 {
        let fixed: Vec<bool> = clamps.targets.iter().map(|t| t[axis].is_some()).collect();
        let mut moved: Vec<f64> = (0..n).map(|v| clamps.targets[v][axis].map_or(0.0, |t| t - start[v][axis])).collect();
        if moved.iter().all(|&d| d == 0.0) {
            continue;
        }
        let mut right = vec![0.0; n];
        cholesky.pattern().multiply(&laplacian, &moved, &mut right);
        let mut values = laplacian.clone();
        cholesky.pattern().isolate(&mut values, &fixed);
        for v in 0..n {
            right[v] = if fixed[v] { 0.0 } else { -right[v] };
        }
        // A part that no clamp touches makes the matrix singular; it stays where it is.
        if cholesky.factorise(&values) {
            cholesky.solve(&mut right);
            for v in 0..n {
                moved[v] += right[v];
            }
        }
        for v in 0..n {
            pose[v][axis] += moved[v];
            if let Some(target) = clamps.targets[v][axis] {
                pose[v][axis] = target;
            }
        }
    }
    Ok(pose)
}

/// The base energy in the free coordinates, which come vertex by vertex.
struct BaseProblem<'a> {
    topology: &'a Topology,
    membranes: Vec<Membrane>,
    bending: QuadraticBending,
    /// `[V][3]` unknown of each coordinate.
    unknown: Vec<[usize; 3]>,
    size: usize,
    length: f64,
    energy_unit: f64,
    pose: Vec<Vec3>,
    elements: Vec<Element>,
    slots: Vec<u32>,
    pattern: SymmetricPattern,
    bending_values: Vec<f64>,
    states: Vec<State>,
}

struct Element {
    /// Local coordinates (0..9) that are free, and their unknowns.
    free: Vec<(usize, usize)>,
    first_slot: usize,
}

#[derive(Clone)]
struct State {
    energy: f64,
    gradient: FaceGradient,
    hessian: FaceHessian,
}

impl<'a> BaseProblem<'a> {
    #[allow(clippy::too_many_arguments)]
    fn new(
        topology: &'a Topology,
        rest: &RestMetric,
        pose: &[Vec3],
        clamps: &Clamps,
        material: &Material,
        options: &BaseOptions,
        length: f64,
        energy_unit: f64,
    ) -> Self {
        let mut size = 0;
        let unknown: Vec<[usize; 3]> = clamps
            .targets
            .iter()
            .map(|t| {
                t.map(|target| {
                    if target.is_some() {
                        NONE
                    } else {
                        size += 1;
                        size - 1
                    }
                })
            })
            .collect();
        let bending = QuadraticBending::new(topology, rest, material);
        let mut elements: Vec<Element> = topology
            .faces
            .iter()
            .map(|face| {
                let free = (0..9).map(|c| (c, unknown[face[c / 3]][c % 3])).filter(|&(_, u)| u != NONE).collect();
                Element { free, first_slot: 0 }
            })
            .collect();
        let lists: Vec<Vec<usize>> = elements.iter().map(|e| e.free.iter().map(|&(_, u)| u).collect()).collect();
        let pattern = SymmetricPattern::from_elements(size, lists.iter().map(Vec::as_slice));
        let mut slots = Vec::new();
        for (element, list) in elements.iter_mut().zip(&lists) {
            element.first_slot = slots.len();
            slots.extend(pattern.element_slots(list).map(|s| s as u32));
        }
        let mut bending_values = vec![0.0; pattern.entry_count()];
        let scale = 2.0 * length * length / energy_unit;
        for row in &bending.rows {
            for axis in 0..3 {
                for (n, &(v, a)) in row.iter().enumerate() {
                    for &(u, b) in &row[..=n] {
                        let (i, j) = (unknown[v][axis], unknown[u][axis]);
                        if i == NONE || j == NONE {
                            continue;
                        }
                        let value = scale * a * b;
                        match pattern.find(i, j) {
                            Some(slot) => bending_values[slot] += value,
                            // Left out; the diagonal makes up for it, so that the matrix bounds the Hessian from above.
                            None => {
                                bending_values[pattern.slot(i, i)] += value.abs();
                                bending_values[pattern.slot(j, j)] += value.abs();
                            }
                        }
                    }
                }
            }
        }
        let membranes = rest.faces.iter().map(|r| Membrane::new(r, material, options.compressive_stiffness)).collect();
        let states = vec![State { energy: 0.0, gradient: FaceGradient::zeros(), hessian: FaceHessian::zeros() }; topology.face_count()];
        Self {
            topology,
            membranes,
            bending,
            unknown,
            size,
            length,
            energy_unit,
            pose: pose.to_vec(),
            elements,
            slots,
            pattern,
            bending_values,
            states,
        }
    }

    fn pack(&self, pose: &[Vec3]) -> Vec<f64> {
        let mut x = vec![0.0; self.size];
        for (unknown, p) in self.unknown.iter().zip(pose) {
            for axis in 0..3 {
                if unknown[axis] != NONE {
                    x[unknown[axis]] = p[axis] / self.length;
                }
            }
        }
        x
    }

    fn unpack(&self, x: &[f64], pose: &mut [Vec3]) {
        for (unknown, p) in self.unknown.iter().zip(pose) {
            for axis in 0..3 {
                if unknown[axis] != NONE {
                    p[axis] = x[unknown[axis]] * self.length;
                }
            }
        }
    }

    fn take_pose(&mut self, x: &[f64]) {
        let mut pose = std::mem::take(&mut self.pose);
        self.unpack(x, &mut pose);
        self.pose = pose;
    }

    fn bending_energy(&self) -> f64 {
        let sums = self.bending.rows.iter().map(|row| row.iter().map(|&(v, c)| self.pose[v] * c).sum::<Vec3>().norm_squared());
        sums.sum()
    }
}

impl Problem for BaseProblem<'_> {
    fn pattern(&self) -> SymmetricPattern {
        self.pattern.clone()
    }

    fn lower_bounds(&self) -> Vec<f64> {
        vec![f64::NEG_INFINITY; self.size]
    }

    fn energy(&mut self, x: &[f64]) -> f64 {
        self.take_pose(x);
        let sums: Vec<f64> = self
            .topology
            .faces
            .par_chunks(CHUNK)
            .zip(self.membranes.par_chunks(CHUNK))
            .map(|(faces, membranes)| faces.iter().zip(membranes).map(|(f, m)| m.energy(&f.map(|v| self.pose[v]))).sum())
            .collect();
        (sums.iter().sum::<f64>() + self.bending_energy()) / self.energy_unit
    }

    fn linearise(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        self.take_pose(x);
        let mut states = std::mem::take(&mut self.states);
        let (scale, square) = (self.length / self.energy_unit, self.length * self.length / self.energy_unit);
        states.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(f, state)| {
            let corners = self.topology.faces[f].map(|v| self.pose[v]);
            let (energy, gradient, hessian) = self.membranes[f].derivatives(&corners, Convexity::Clamped);
            *state = State { energy, gradient: gradient * scale, hessian: hessian * square };
        });
        self.states = states;
        gradient.fill(0.0);
        for (state, element) in self.states.iter().zip(&self.elements) {
            for &(c, u) in &element.free {
                gradient[u] += state.gradient[c];
            }
        }
        for row in &self.bending.rows {
            let sum: Vec3 = row.iter().map(|&(v, c)| self.pose[v] * c).sum();
            for &(v, c) in row {
                for axis in 0..3 {
                    if self.unknown[v][axis] != NONE {
                        gradient[self.unknown[v][axis]] += 2.0 * scale * c * sum[axis];
                    }
                }
            }
        }
        let sums = self.states.chunks(CHUNK).map(|chunk| chunk.iter().map(|s| s.energy).sum::<f64>());
        (sums.sum::<f64>() + self.bending_energy()) / self.energy_unit
    }

    /// Bending reaches over two rings of vertices, the pattern over one: a third of the couplings, and far less fill.
    fn add_rest_of_hessian(&self, x: &[f64], out: &mut [f64]) -> bool {
        self.pattern.add_multiple(-1.0, &self.bending_values, x, out);
        let scale = 2.0 * self.length * self.length / self.energy_unit;
        for row in &self.bending.rows {
            for axis in 0..3 {
                let free = || row.iter().map(|&(v, c)| (self.unknown[v][axis], c)).filter(|&(u, _)| u != NONE);
                let sum: f64 = free().map(|(u, c)| c * x[u]).sum();
                for (u, c) in free() {
                    out[u] += scale * c * sum;
                }
            }
        }
        true
    }

    fn hessian(&mut self, _: Convexity, values: &mut [f64]) {
        values.copy_from_slice(&self.bending_values);
        for (state, element) in self.states.iter().zip(&self.elements) {
            let mut slot = element.first_slot;
            for (n, &(c, _)) in element.free.iter().enumerate() {
                for &(d, _) in &element.free[..=n] {
                    values[self.slots[slot] as usize] += state.hessian[(c, d)];
                    slot += 1;
                }
            }
        }
    }
}
