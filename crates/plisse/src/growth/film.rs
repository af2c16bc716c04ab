//! Energy of a grown film on a foundation, for [`crate::linalg::newton`]: membrane on the grown
//! metric, bending, the foundation that holds the mean of its folds to the starting surface, the
//! tension that lines its crests up, weight and contact.
//!
//! With the displacement u (m) of each vertex from the starting surface and the offset w = N·u
//! along its normal N there:
//!
//! - membrane: St. Venant–Kirchhoff on ā, [`Membrane`] with full resistance to compression;
//! - bending: [`QuadraticBending`] of u, so that a curved starting surface is at rest. It takes the
//!   rotation of the starting curvature for small against that of the folds;
//! - foundation: k/2·∫(s(w)·(w − w₀)² + grip·|u − wN|²) over the starting area, where s is 1 above
//!   and 1 + stickiness below;
//! - crests: T/2·∫(∂w/∂c)² over the starting area, where c runs along the crests. Folds whose wave
//!   vector leans by qᵥ along c cost T·qᵥ² more. Bending stiffness D along the crests, in (∂²/∂x² +
//!   D·∂²/∂c²)², would cost 2BDq²·qᵥ² to the same order; but it needs second derivatives, which on
//!   irregular triangles let a stiff direction leak into the soft one;
//! - contact with itself, if it is asked for: [`crate::self_contact`].
//!
//! All but membrane, sticking and contact is quadratic in u: one constant matrix.

use nalgebra::SMatrix;
use rayon::prelude::*;

use crate::Result;
use crate::linalg::IndexBlocks;
use crate::linalg::ordered_sum::{CHUNK, ordered_sum};
use crate::linalg::sparse::SymmetricPattern;
use crate::linalg::vertex_pattern::{NO_SLOT, VertexPattern};
use crate::linalg::{Problem, PsdProjection};
use crate::material::Material;
use crate::mesh::{Mat3, NONE, Vec3};
use crate::self_contact::{Contact, SelfContact};
use crate::shell::Setup;
use crate::shell::contact::Barrier;
use crate::shell::quadratic_bending::QuadraticBending;
use crate::shell::tension_field::{FaceHessian, Membrane};

/// Iterations for which the matrix keeps its pattern although a few contacts couple vertices that
/// it does not couple: a new ordering of the unknowns costs as much as several iterations.
const PATTERN_LIFETIME: usize = 12;
/// Contacts for each uncoupled one from which on the uncoupled ones count as few.
const CONTACTS_PER_UNCOUPLED: usize = 12;

/// Foundation that holds one vertex to the starting surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foundation {
    /// Unit normal of the starting surface.
    pub normal: Vec3,
    /// Stiffness against offset along the normal (N/m): k times starting area.
    pub stiffness: f64,
    /// Stiffness against sliding along the surface (N/m).
    pub grip: f64,
    /// w₀: offset (m) at which the foundation is at rest.
    pub offset_m: f64,
    /// Extra stiffness below the surface over that above (no unit): 0 for equally stiff.
    pub stickiness: f64,
}

/// Crest tension on one face: the energy is ½(Σ coefficient·w)² over its corners.
pub type CrestTension = [f64; 3];

/// Energy of a film in its free coordinates.
pub struct Film<'a> {
    setup: &'a Setup<'a>,
    start: &'a [Vec3],
    membranes: Vec<Membrane>,
    foundation: &'a [Foundation],
    barrier: Option<Barrier<'a>>,
    forces_newton: Vec<Vec3>,
    length_m: f64,
    unit_joule: f64,
    pattern: VertexPattern,
    /// Hessian of all that is quadratic, in units.
    constant: Vec<f64>,
    /// Gradient of the constant part at the start, due to held coordinates that are elsewhere, in
    /// units.
    held_gradient: Vec<f64>,
    /// `[F][45]` slots of each face's lower triangle; [`NO_SLOT`] where a coordinate is held.
    slots: Vec<[u32; 45]>,
    pose: Vec<Vec3>,
    product: Vec<f64>,
    self_contact: Option<SelfContact<'a>>,
    /// Active contacts where the energy was last value_and_gradientd.
    contacts: Vec<Contact>,
    /// True once candidates of contact were searched for.
    contacts_detected: bool,
    /// True if contacts changed the pattern since it was last asked for.
    pattern_changed: bool,
    /// Linearisations since the pattern last changed.
    pattern_age: usize,
}

impl<'a> Film<'a> {
    /// The film of `setup` (whose rest metric is the grown one, and whose material is that of faces
    /// of thickness 1) over the starting surface `start` (`[V]`, m). `thickness` (`[F]`, no unit)
    /// is the thickness of each face in units of the material's, `crests` (`[F]`, √J/m) lines folds
    /// up.
    ///
    /// # Errors
    /// [`crate::Error::Value`] if a face's material is none.
    pub fn new(
        setup: &'a Setup<'a>,
        start: &'a [Vec3],
        thickness: &[f64],
        foundation: &'a [Foundation],
        crests: &[CrestTension],
    ) -> Result<Self> {
        let (topology, material) = (&setup.sheet.topology, &setup.sheet.material);
        let (unknown, size) = setup.clamps.free_coordinates();
        let membrane = |f: usize| -> Result<Membrane> {
            let material = Material::new(
                material.young_pa,
                material.poisson,
                material.thickness_m * thickness[f],
            )?;
            Ok(Membrane::new(&setup.sheet.rest.faces[f], &material, 1.0))
        };
        let membranes = (0..topology.face_count()).map(membrane).collect::<Result<_>>()?;
        let bending = bending_rows(setup, thickness);
        let length_m = setup.length_m();
        let unit_joule = material.young_pa * material.thickness_m * length_m * length_m;

        let (mut row_vertices, mut row_ends) = (Vec::new(), vec![0]);
        for row in &bending.rows {
            row_vertices.extend(row.iter().map(|&(v, _)| v));
            row_ends.push(row_vertices.len());
        }
        let rows = row_ends.windows(2).map(|ends| &row_vertices[ends[0]..ends[1]]);
        let pattern =
            VertexPattern::new(unknown, topology.faces.iter().map(|face| &face[..]), rows);
        let slots = topology.faces.iter().map(|face| face_slots(&pattern, face)).collect();
        let held = |v: usize| {
            Vec3::from_fn(|axis, _| setup.clamps.targets[v][axis].unwrap_or(start[v][axis]))
        };
        let pose: Vec<Vec3> = (0..start.len()).map(held).collect();
        let mut film = Self {
            setup,
            start,
            membranes,
            foundation,
            barrier: Barrier::new(setup),
            forces_newton: setup.dead_forces_newton(),
            length_m,
            unit_joule,
            constant: vec![0.0; pattern.pattern().entry_count()],
            held_gradient: vec![0.0; size],
            pattern,
            slots,
            pose,
            product: vec![0.0; size],
            self_contact: None,
            contacts: Vec::new(),
            contacts_detected: false,
            pattern_changed: false,
            pattern_age: 0,
        };
        film.assemble_constant(&bending, crests);
        Ok(film)
    }

    /// The film with contact of the surface with itself.
    pub(super) fn with_self_contact(self, self_contact: Option<SelfContact<'a>>) -> Self {
        Self { self_contact, ..self }
    }

    /// `[V][3]` the unknown of each coordinate; [`NONE`] where it is held.
    pub(super) fn unknowns(&self) -> &[[usize; 3]] {
        self.pattern.unknown()
    }

    /// Joules in one unit of energy.
    pub fn unit_joule(&self) -> f64 {
        self.unit_joule
    }

    /// Metres in one unit of the unknowns.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// The constant part of the Hessian.
    fn assemble_constant(&mut self, bending: &QuadraticBending, crests: &[CrestTension]) {
        let scale = self.length_m * self.length_m / self.unit_joule;
        // By how much coordinates that are held are away from where they started.
        let moved: Vec<Vec3> = self.pose.iter().zip(self.start).map(|(p, q)| p - q).collect();
        let mut rows_of: Vec<Vec<(usize, f64)>> = vec![Vec::new(); self.start.len()];
        for (r, row) in bending.rows.iter().enumerate() {
            row.iter().for_each(|&(v, a)| rows_of[v].push((r, a)));
        }
        let (mut sums, mut met) = (vec![0.0; self.start.len()], Vec::new());
        let unknown = self.pattern.unknown();
        for (v, rows) in rows_of.iter().enumerate().filter(|&(v, _)| unknown[v] != [NONE; 3]) {
            for &(r, a) in rows {
                for &(u, b) in &bending.rows[r] {
                    if sums[u] == 0.0 {
                        met.push(u);
                    }
                    sums[u] += 2.0 * scale * a * b;
                }
            }
            // Where a sum came back to 0, it has been met twice.
            met.sort_unstable();
            met.dedup();
            for u in met.drain(..) {
                let sum = std::mem::take(&mut sums[u]);
                let slots = if u <= v { self.pattern.block(v, u) } else { [[NO_SLOT; 3]; 3] };
                for (axis, &i) in unknown[v].iter().enumerate().filter(|(_, i)| **i != NONE) {
                    if unknown[u][axis] == NONE {
                        self.held_gradient[i] += sum * moved[u][axis] / self.length_m;
                    } else if u <= v {
                        self.constant[slots[axis][axis] as usize] += sum;
                    }
                }
            }
        }
        for (f, tension) in crests.iter().enumerate().filter(|(_, tension)| **tension != [0.0; 3]) {
            let corners = self.setup.sheet.topology.faces[f];
            let slope = SMatrix::<f64, 9, 1>::from_fn(|k, _| {
                tension[k / 3] * self.foundation[corners[k / 3]].normal[k % 3]
            });
            add(&mut self.constant, &self.slots[f], &(slope * slope.transpose() * scale));
            let by: f64 = (0..9).map(|k| slope[k] * moved[corners[k / 3]][k % 3]).sum();
            for k in (0..9).filter(|&k| by != 0.0 && unknown[corners[k / 3]][k % 3] != NONE) {
                self.held_gradient[unknown[corners[k / 3]][k % 3]] +=
                    slope[k] * by * scale / self.length_m;
            }
        }
        for (v, foundation) in self.foundation.iter().enumerate() {
            let normal = foundation.normal * foundation.normal.transpose();
            let block =
                normal * foundation.stiffness + (Mat3::identity() - normal) * foundation.grip;
            add_vertex(&self.pattern, v, &(block * scale), &mut self.constant);
            let force = block * moved[v] * (scale / self.length_m);
            for axis in (0..3).filter(|&axis| unknown[v][axis] != NONE) {
                self.held_gradient[unknown[v][axis]] += force[axis];
            }
        }
    }

    /// The unknowns of `pose` (`[V]`, m).
    pub fn pack(&self, pose: &[Vec3]) -> Vec<f64> {
        let mut x = vec![0.0; self.size()];
        for (v, unknown) in self.pattern.unknown().iter().enumerate() {
            for axis in (0..3).filter(|&axis| unknown[axis] != NONE) {
                x[unknown[axis]] = (pose[v][axis] - self.start[v][axis]) / self.length_m;
            }
        }
        x
    }

    /// The pose (`[V]`, m) of the unknowns; the starting surface to the bit where they are 0.
    pub fn unpack(&self, x: &[f64], pose: &mut [Vec3]) {
        for (v, unknown) in self.pattern.unknown().iter().enumerate() {
            for axis in (0..3).filter(|&axis| unknown[axis] != NONE) {
                pose[v][axis] = self.start[v][axis] + x[unknown[axis]] * self.length_m;
            }
        }
    }

    fn size(&self) -> usize {
        self.held_gradient.len()
    }

    fn set_state(&mut self, x: &[f64]) {
        let mut pose = std::mem::take(&mut self.pose);
        self.unpack(x, &mut pose);
        self.pose = pose;
        let mut product = std::mem::take(&mut self.product);
        self.pattern.pattern().multiply(&self.constant, x, &mut product);
        self.product = product;
    }

    fn corners(&self, f: usize) -> [Vec3; 3] {
        self.setup.sheet.topology.faces[f].map(|v| self.pose[v])
    }

    /// Energy (J), and slope (N) along the normal, of what holds vertex `v` beyond the constant
    /// matrix, where the offset is `w` (m).
    fn foundation_remainder(&self, v: usize, w: f64) -> [f64; 2] {
        let Foundation { stiffness, offset_m, stickiness, .. } = self.foundation[v];
        let below = if w < 0.0 { stickiness * stiffness } else { 0.0 };
        [
            stiffness * offset_m * (0.5 * offset_m - w) + 0.5 * below * w * w,
            below * w - stiffness * offset_m,
        ]
    }

    fn vertex_energy(&self, v: usize) -> f64 {
        let moved = self.pose[v] - self.start[v];
        let mut energy = self.foundation_remainder(v, self.foundation[v].normal.dot(&moved))[0]
            - self.forces_newton[v].dot(&moved);
        if let Some(barrier) = &self.barrier {
            energy += barrier.energy(v, &self.pose[v]);
        }
        energy
    }

    fn energy_here(&self, x: &[f64]) -> f64 {
        let quadratic: f64 = x.iter().zip(&self.product).map(|(x, y)| x * y).sum();
        let linear: f64 = x.iter().zip(&self.held_gradient).map(|(x, y)| x * y).sum();
        let faces =
            ordered_sum(self.membranes.len(), |f| self.membranes[f].energy(&self.corners(f)));
        let contact = self.self_contact.as_ref().map_or(0.0, |contact| contact.energy(&self.pose));
        0.5 * quadratic
            + linear
            + (faces + ordered_sum(self.pose.len(), |v| self.vertex_energy(v)) + contact)
                / self.unit_joule
    }

    /// Searches for candidates of contact, once before the first energy.
    fn detect_contacts(&mut self) {
        if let Some(contact) = self.self_contact.as_mut().filter(|_| !self.contacts_detected) {
            contact.detect(&self.pose);
        }
        self.contacts_detected = true;
    }

    /// Updates the active contacts, and the pattern for their couplings.
    fn update_contacts(&mut self) {
        let Some(contact) = &self.self_contact else { return };
        self.contacts = contact.contacts(&self.pose);
        // Bending couples like axes only; contacts couple all.
        let known = |contact: &Contact| {
            (0..4).all(|k| {
                (0..k).all(|l| self.pattern.couples(contact.vertices[k], contact.vertices[l]))
            })
        };
        let missing: Vec<usize> =
            (0..self.contacts.len()).filter(|&n| !known(&self.contacts[n])).collect();
        self.pattern_age += 1;
        if missing.is_empty() {
            return;
        }
        if self.pattern_age < PATTERN_LIFETIME
            && CONTACTS_PER_UNCOUPLED * missing.len() < self.contacts.len()
        {
            missing.into_iter().for_each(|n| self.contacts[n].uncoupled = true);
            return;
        }
        self.pattern_age = 0;
        let places =
            self.pattern.extend(contact.nearby(&self.pose).iter().map(|vertices| &vertices[..]));
        let mut constant = vec![0.0; self.pattern.pattern().entry_count()];
        for (&place, &value) in places.iter().zip(&self.constant) {
            constant[place as usize] = value;
        }
        for slot in self.slots.iter_mut().flatten().filter(|slot| **slot != NO_SLOT) {
            *slot = places[*slot as usize];
        }
        (self.constant, self.pattern_changed) = (constant, true);
    }

    /// Adds the contacts' Hessians to `values`.
    fn add_contact_hessian(&self, values: &mut [f64], scale: f64) {
        for contact in self.contacts.iter().filter(|contact| contact.uncoupled) {
            // (Σ wₖxₖ)² ≤ Σ|w| · Σ |wₖ|xₖ², and Σ|w| is 2.
            for (&v, slope) in contact
                .vertices
                .iter()
                .zip(&contact.slope)
                .filter(|(_, slope)| **slope != Vec3::zeros())
            {
                let block =
                    slope * slope.transpose() * (2.0 * scale * contact.stiffness / slope.norm());
                add_vertex(&self.pattern, v, &block, values);
            }
        }
        for contact in self.contacts.iter().filter(|contact| !contact.uncoupled) {
            for k in 0..4 {
                for l in 0..=k {
                    let slots = self.pattern.block(contact.vertices[k], contact.vertices[l]);
                    for a in 0..3 {
                        for b in
                            (0..if k == l { a + 1 } else { 3 }).filter(|&b| slots[a][b] != NO_SLOT)
                        {
                            values[slots[a][b] as usize] += scale
                                * contact.stiffness
                                * contact.slope[k][a]
                                * contact.slope[l][b];
                        }
                    }
                }
            }
        }
    }
}

impl Problem for Film<'_> {
    fn pattern(&self) -> SymmetricPattern {
        self.pattern.pattern().clone()
    }

    fn lower_bounds(&self) -> Vec<f64> {
        vec![f64::NEG_INFINITY; self.size()]
    }

    fn index_blocks(&self) -> Option<IndexBlocks> {
        Some(self.pattern.index_blocks())
    }

    fn energy(&mut self, x: &[f64]) -> f64 {
        self.set_state(x);
        self.detect_contacts();
        self.energy_here(x)
    }

    fn value_and_gradient(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        self.set_state(x);
        self.detect_contacts();
        self.update_contacts();
        gradient
            .iter_mut()
            .zip(&self.product)
            .zip(&self.held_gradient)
            .for_each(|((g, product), held)| *g = product + held);
        let scale = self.length_m / self.unit_joule;
        let slopes: Vec<_> = (0..self.membranes.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|f| self.membranes[f].gradient(&self.corners(f)))
            .collect();
        let unknown = self.pattern.unknown();
        let mut add = |v: usize, axis: usize, force: f64| {
            if unknown[v][axis] != NONE {
                gradient[unknown[v][axis]] += scale * force;
            }
        };
        for (face, slope) in self.setup.sheet.topology.faces.iter().zip(&slopes) {
            for k in 0..9 {
                add(face[k / 3], k % 3, slope[k]);
            }
        }
        for v in 0..self.pose.len() {
            let normal = self.foundation[v].normal;
            let mut force = normal
                * self.foundation_remainder(v, normal.dot(&(self.pose[v] - self.start[v])))[1]
                - self.forces_newton[v];
            if let Some(push) =
                self.barrier.as_ref().and_then(|barrier| barrier.push(v, &self.pose[v], false))
            {
                force += push.gradient;
            }
            for axis in 0..3 {
                add(v, axis, force[axis]);
            }
        }
        for contact in &self.contacts {
            for (&v, force) in contact.vertices.iter().zip(&contact.gradient) {
                (0..3).for_each(|axis| add(v, axis, force[axis]));
            }
        }
        self.energy_here(x)
    }

    fn max_step_size(&mut self, _: &[f64], direction: &[f64]) -> f64 {
        let unknown = self.pattern.unknown();
        let by = |v: usize| {
            Vec3::from_fn(|axis, _| match unknown[v][axis] {
                NONE => 0.0,
                u => direction[u] * self.length_m,
            })
        };
        let part =
            self.barrier.as_ref().map_or(1.0, |barrier| barrier.max_step_size(&self.pose, by));
        match &mut self.self_contact {
            Some(contact) => {
                let moves: Vec<Vec3> = (0..self.pose.len()).map(|v| by(v) * part).collect();
                part * contact.collision_free_step(&self.pose, &moves)
            }
            None => part,
        }
    }

    fn new_sparsity(&mut self) -> Option<SymmetricPattern> {
        std::mem::take(&mut self.pattern_changed).then(|| self.pattern.pattern().clone())
    }

    fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]) {
        values.copy_from_slice(&self.constant);
        let scale = self.length_m * self.length_m / self.unit_joule;
        let hessians: Vec<FaceHessian> = (0..self.membranes.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|f| self.membranes[f].derivatives(&self.corners(f), projection).2 * scale)
            .collect();
        for (slots, hessian) in self.slots.iter().zip(&hessians) {
            add(values, slots, hessian);
        }
        for v in 0..self.pose.len() {
            let Foundation { normal, stiffness, stickiness, .. } = self.foundation[v];
            let mut block = Mat3::zeros();
            if stickiness != 0.0 && normal.dot(&(self.pose[v] - self.start[v])) < 0.0 {
                block += normal * normal.transpose() * (stickiness * stiffness);
            }
            if let Some(push) = self
                .barrier
                .as_ref()
                .and_then(|b| b.push(v, &self.pose[v], projection == PsdProjection::None))
            {
                block += push.hessian;
            }
            if block != Mat3::zeros() {
                add_vertex(&self.pattern, v, &(block * scale), values);
            }
        }
        self.add_contact_hessian(values, scale);
    }
}

/// The bending of faces of unequal thickness: each square is scaled by the mean of its faces'
/// thickness, to the power 3/2.
pub(super) fn bending_rows(setup: &Setup<'_>, thickness: &[f64]) -> QuadraticBending {
    let mut bending =
        QuadraticBending::new(&setup.sheet.topology, &setup.sheet.rest, &setup.sheet.material);
    let mut around = vec![(0.0, 0.0); setup.sheet.topology.vertex_count];
    for (f, face) in setup.sheet.topology.faces.iter().enumerate() {
        for &v in face {
            around[v].0 += thickness[f] * setup.sheet.rest.faces[f].area_m2;
            around[v].1 += setup.sheet.rest.faces[f].area_m2;
        }
    }
    for (row, (sum, area)) in bending.rows.iter_mut().zip(around) {
        let scale = (sum / area).powf(1.5);
        row.iter_mut().for_each(|(_, c)| *c *= scale);
    }
    bending
}

fn face_slots(pattern: &VertexPattern, face: &[usize; 3]) -> [u32; 45] {
    let mut slots = [NO_SLOT; 45];
    for p in 0..3 {
        for q in 0..=p {
            let block = pattern.block(face[p], face[q]);
            for a in 0..3 {
                let k = 3 * p + a;
                for b in 0..if p == q { a + 1 } else { 3 } {
                    slots[k * (k + 1) / 2 + 3 * q + b] = block[a][b];
                }
            }
        }
    }
    slots
}

fn add(values: &mut [f64], slots: &[u32; 45], hessian: &FaceHessian) {
    let mut n = 0;
    for k in 0..9 {
        for l in 0..=k {
            if slots[n] != NO_SLOT {
                values[slots[n] as usize] += hessian[(k, l)];
            }
            n += 1;
        }
    }
}

fn add_vertex(pattern: &VertexPattern, v: usize, block: &Mat3, values: &mut [f64]) {
    let slots = pattern.block(v, v);
    for i in 0..3 {
        for j in (0..=i).filter(|&j| slots[i][j] != NO_SLOT) {
            values[slots[i][j] as usize] += block[(i, j)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::derivative_check::check_problem;
    use crate::mesh::Topology;
    use crate::obstacle::Obstacle;
    use crate::random::Random;
    use crate::sheet::Sheet;
    use crate::shell::{Clamps, Loads};

    /// Everything at once on an octahedron: sticking above and below, crests, weight, an obstacle
    /// in touch, a vertex held on one axis.
    #[test]
    fn derivatives_agree_with_differences() {
        let [x, y, z] = [Vec3::x(), Vec3::y(), Vec3::z()];
        let start = vec![x, y, z, -x, -y, -z];
        let faces = vec![
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ];
        let topology = Topology::new(6, faces).unwrap();
        let grown: Vec<Vec3> = start.iter().map(|p| p * 1.2).collect();
        let material = Material::new(50.0, 0.3, 0.3).unwrap();
        let sheet = Sheet::from_rest(grown, topology.faces.clone(), material).unwrap();
        let mut clamps = Clamps::none(6);
        // One held where it started, one away from there.
        clamps.targets[3][1] = Some(start[3].y);
        clamps.targets[1] = [Some(start[1].x + 0.1), None, Some(start[1].z - 0.2)];
        let mut random = Random(5);
        let mut number = || 2.0 * random.unit() - 1.0;
        let pose: Vec<Vec3> =
            start.iter().map(|p| p + 0.2 * Vec3::new(number(), number(), number())).collect();
        let obstacles = [Obstacle::plane("floor", pose[5] - 0.2 * z, z).unwrap()];
        let setup = Setup {
            loads: Loads { density_kg_m3: 2.0, gravity_m_s2: -9.0 * z, ..Loads::default() },
            obstacles: &obstacles,
            contact_thickness_m: 0.5,
            ..Setup::new(&sheet, &clamps)
        };
        let foundation: Vec<Foundation> = start
            .iter()
            .map(|p| Foundation {
                normal: *p,
                stiffness: 2.0 + number(),
                grip: 0.7,
                offset_m: 0.1 * number(),
                stickiness: 1.5,
            })
            .collect();
        let crests: Vec<CrestTension> = (0..8).map(|_| [number(), number(), number()]).collect();
        let thickness: Vec<f64> = (0..8).map(|_| 1.0 + 0.3 * number()).collect();
        let mut film = Film::new(&setup, &start, &thickness, &foundation, &crests).unwrap();
        let x = film.pack(&pose);
        check_problem(&mut film, &x, 0.1);
    }

    #[test]
    fn the_starting_surface_comes_back_to_the_bit() {
        let start = vec![
            Vec3::new(0.1, 0.7, 1.0 / 3.0),
            Vec3::new(1.3, 0.2, 0.9),
            Vec3::new(-0.4, 1.1, 0.6),
        ];
        let topology = Topology::new(3, vec![[0, 1, 2]]).unwrap();
        let material = Material::new(1.0, 0.0, 0.01).unwrap();
        let sheet = Sheet::from_rest(start.clone(), topology.faces, material).unwrap();
        let clamps = Clamps::none(3);
        let setup = Setup::new(&sheet, &clamps);
        let foundation = [Foundation {
            normal: Vec3::z(),
            stiffness: 1.0,
            grip: 1.0,
            offset_m: 0.0,
            stickiness: 0.0,
        }; 3];
        let film = Film::new(&setup, &start, &[1.0], &foundation, &[[0.0; 3]]).unwrap();
        let mut pose = vec![Vec3::zeros(); 3];
        film.unpack(&film.pack(&start), &mut pose);
        assert_eq!(pose, start);
    }
}
