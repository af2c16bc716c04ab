//! Folds a grown surface up: the variational mode. A film on a soft foundation, grown in steps, each solved to equilibrium.
//!
//! A film of bending stiffness B on a foundation k wrinkles, as soon as it is pressed by ε_c = h²q²/(6(1−ν²)), with the wave number
//! q = 2π/λ = (k/B)^¼. So the wavelength λ is a design parameter: **λ is the spacing of the folds that is seen on the starting
//! surface**. (Along the grown surface a fold is longer: g·λ, which is the λ of the paper's own derivation.) The film is made
//! [`GrowthOptions::thickness_share`] of λ thick, and k = Bq⁴/c(g) follows from λ, softened by [`super::fold_angle::softening`] as the
//! folds grow large, so that no growth makes folds split or merge. What is asked beyond ε_c goes into length.
//!
//! Growth is applied in steps of equal *factors*, small ones where folds begin, so that the pattern is chosen near onset where λ alone
//! decides; later it only grows. The grip of the foundation on sliding keeps folds from gathering in one place: on a foundation that
//! resists offset only, a row of folds is unstable against a single large one (Diamant & Witten 2011).

use std::time::Instant;

use super::bands::{Banded, check_bands};
use super::expansion::{Expansion, scale_edges, vertex_normals};
use super::film::{CrestTension, Film, Foundation};
use super::fold_angle::softening;
use super::imperfection::band_limited;
use super::loose;
use super::self_contact::SelfContact;
use crate::linalg::newton::{Convexity, Ending, Options, minimise};
use crate::material::Material;
use crate::mesh::crossing::crossing_pairs;
use crate::mesh::{Topology, Vec3};
use crate::obstacle::Obstacle;
use crate::progress::Observer;
use crate::rest::RestMetric;
use crate::shell::{Clamps, Loads, Setup};
use crate::{Error, Result};

/// Fewest edges that must fit into a wavelength.
const LEAST_EDGES: f64 = 3.5;
/// Growth (logarithm) at which imperfections have their full size.
const FULL_IMPERFECTION: f64 = 0.02;
/// Factor between the first levels of growth.
const LEVELS: f64 = 1.35;
/// How much more force than at the end may be left after a step that others follow, and how many iterations it may take.
const PASSING: (f64, usize) = (10.0, 60);
/// Longest move of a vertex in one iteration, in edges, where folds may meet.
const LONGEST_MOVE: f64 = 2.0;
/// Up to this level of growth, in units of ε_c, every step is solved exactly: here the pattern of folds is chosen.
const CHOOSING: f64 = 3.0;

/// A surface that is to grow, and what it has to put up with.
#[derive(Clone, Debug)]
pub struct Growing<'a> {
    /// Connectivity.
    pub topology: &'a Topology,
    /// `[F]` rest metric before growth.
    pub rest: &'a RestMetric,
    /// `[V]` the starting surface (m), smooth, over which the folds lie.
    pub start: &'a [Vec3],
    /// `[V]` places (m) from which imperfections are drawn: the starting surface, or its rest shape, so that they move with it.
    pub places: Vec<Vec3>,
    /// How it grows.
    pub expansion: Expansion,
    /// `[V]` spacing λ (m) of the folds, as seen on the starting surface.
    pub wavelength_m: Vec<f64>,
    /// `[V]` coherence length Λ (m): how far crests run straight; 0 leaves only what the film's own stiffness gives.
    pub coherence_m: Vec<f64>,
    /// `[V]` offset that the surface prefers, in wavelengths: positive pushes folds out along the normals (k_pi of eq. 5).
    pub bias: Vec<f64>,
    /// `[V]` how much harder than out the surface goes in (no unit): 0 for folds both ways, 100 for what sticks to a hard ground.
    pub stickiness: Vec<f64>,
    /// `[V]` how much of the foundation there is (no unit): 1 as λ asks, 0 for a surface that nothing holds to its start.
    pub hold: Vec<f64>,
    /// `[V]` axes along which each vertex is frozen.
    pub frozen: Vec<[bool; 3]>,
    /// Sets of vertices that move as one.
    pub bands: Vec<Vec<usize>>,
    /// What pushes.
    pub loads: Loads,
    /// Bodies that no vertex enters.
    pub obstacles: &'a [Obstacle],
    /// Distance (m) from an obstacle within which it pushes back.
    pub contact_thickness_m: f64,
    /// Whether folds keep from passing through each other, about the film's thickness apart.
    pub self_contact: bool,
}

impl<'a> Growing<'a> {
    /// A free surface with the same λ and Λ (m) everywhere, without bias, sticking, loads or obstacles.
    pub fn new(
        topology: &'a Topology,
        rest: &'a RestMetric,
        start: &'a [Vec3],
        expansion: Expansion,
        wavelength_m: f64,
        coherence_m: f64,
    ) -> Self {
        let n = start.len();
        Self {
            topology,
            rest,
            start,
            places: start.to_vec(),
            expansion,
            wavelength_m: vec![wavelength_m; n],
            coherence_m: vec![coherence_m; n],
            bias: vec![0.0; n],
            stickiness: vec![0.0; n],
            hold: vec![1.0; n],
            frozen: vec![[false; 3]; n],
            bands: Vec::new(),
            loads: Loads::default(),
            obstacles: &[],
            contact_thickness_m: 1e-3,
            self_contact: true,
        }
    }

    /// Freezes all axes of the vertices for which `choose` (vertex, place in m) says so.
    pub fn freeze(&mut self, choose: impl Fn(usize, &Vec3) -> bool) {
        for (v, frozen) in self.frozen.iter_mut().enumerate() {
            if choose(v, &self.start[v]) {
                *frozen = [true; 3];
            }
        }
    }

    /// Largest logarithm of a factor of length that is asked for, up or down.
    pub fn most_growth(&self) -> f64 {
        let log = |v: &super::expansion::Growth| v.principal().0.map(|factor| factor.ln().abs()).into_iter().fold(0.0, f64::max);
        self.expansion.vertices.iter().map(log).fold(0.0, f64::max)
    }

    /// Mean length (m) of the edges of the starting surface.
    fn mean_edge_m(&self) -> f64 {
        let lengths: f64 = self.topology.edges.iter().map(|&[i, j]| (self.start[j] - self.start[i]).norm()).sum();
        lengths / self.topology.edge_count() as f64
    }

    /// Longest extent (m) of a side of face `f` across the folds that it will have; 0 where nothing grows.
    fn side_across_folds_m(&self, f: usize) -> f64 {
        let face = self.topology.faces[f];
        let across = |v: usize, side: &Vec3| {
            let ([most, least], [along, _]) = self.expansion.vertices[v].principal();
            if most <= 1.0 + 1e-9 {
                return 0.0;
            }
            // Where it grows all ways alike, folds may run any way.
            let even = (least.ln() / most.ln()).clamp(0.0, 1.0);
            let part = side.dot(&along).powi(2);
            (part + even * (side.norm_squared() - part)).sqrt()
        };
        let side = |k: usize| self.start[face[(k + 1) % 3]] - self.start[face[k]];
        (0..9).map(|n| across(face[n / 3], &side(n % 3))).fold(0.0, f64::max)
    }

    /// Whether it can grow at all; [`grow`] asks this first.
    ///
    /// # Errors
    /// [`Error::Value`] naming the map and the vertex whose value cannot be used, or a face too large for its folds, or if all is frozen;
    /// [`Error::Mesh`] naming a vertex that starts in an obstacle, or two faces that cross.
    pub fn check(&self) -> Result<()> {
        self.check_start()?;
        self.check_painted()
    }

    /// Whether what is painted on the surface can be.
    pub(super) fn check_painted(&self) -> Result<()> {
        self.check_maps()?;
        for (f, face) in self.topology.faces.iter().enumerate() {
            let side_m = self.side_across_folds_m(f);
            let wavelength = face.iter().map(|&v| self.wavelength_m[v]).sum::<f64>() / 3.0;
            if wavelength < LEAST_EDGES * side_m {
                let message = format!(
                    "folds {wavelength:.3e} m apart need edges of {:.3e} m or less across them, but face {f} has one of {side_m:.3e} m; refine the mesh or ask for wider folds",
                    wavelength / LEAST_EDGES
                );
                return Err(Error::value("growth.wavelength_m", message));
            }
        }
        Ok(())
    }

    /// Whether the starting surface crosses itself where it must not.
    pub(super) fn check_start(&self) -> Result<()> {
        if !self.self_contact {
            return Ok(());
        }
        if let Some(&[f, g]) = crossing_pairs(&self.topology.faces, self.start).first() {
            let message = format!("faces {f} and {g} of the starting surface cross; part them, or set growth.self_contact = false");
            return Err(Error::mesh("growth", message));
        }
        Ok(())
    }

    /// As [`Growing::check_painted`], but faces may be of any size.
    pub(super) fn check_maps(&self) -> Result<()> {
        let n = self.topology.vertex_count;
        let map = |name: &str, values: &[f64], allowed: fn(f64) -> bool, mend: &str| match values.iter().position(|&x| !allowed(x)) {
            Some(v) => Err(Error::value(format!("growth.{name}"), format!("it is {} at vertex {v}; {mend}", values[v]))),
            None if values.len() == n => Ok(()),
            None => {
                Err(Error::value(format!("growth.{name}"), format!("it has {} values; give one for each of {n} vertices", values.len())))
            }
        };
        map("wavelength_m", &self.wavelength_m, |x| x.is_finite() && x > 0.0, "give a positive number of metres")?;
        map("coherence_m", &self.coherence_m, |x| x.is_finite() && x >= 0.0, "give 0 or a positive number of metres")?;
        map("bias", &self.bias, |x| x.is_finite() && x.abs() <= 1.0, "give a share of the wavelength from -1 to 1")?;
        map("stickiness", &self.stickiness, |x| x.is_finite() && x >= 0.0, "give 0 or a positive number")?;
        check_bands(&self.bands, &self.frozen)?;
        map("hold", &self.hold, |x| x.is_finite() && x >= 0.0, "give 0, 1 or another positive number")?;
        if self.frozen.iter().flatten().all(|&frozen| frozen) {
            return Err(Error::value("growth.freeze", "every vertex is frozen, so nothing can fold; leave some free"));
        }
        if let Some(v) = (0..n).find(|&v| self.obstacles.iter().any(|o| o.distance_m(&self.start[v]) <= 0.0)) {
            return Err(Error::mesh("growth", format!("vertex {v} of the starting surface is inside an obstacle; move it out")));
        }
        Ok(())
    }
}

/// How folds are solved for.
#[derive(Clone, Debug)]
pub struct GrowthOptions {
    /// Young's modulus (Pa) of the film: only loads and contact are measured against it.
    pub young_pa: f64,
    /// Poisson's ratio of the film.
    pub poisson: f64,
    /// Thickness of the film over λ: folds begin at the strain 6.6·share²/(1−ν²), which is what is missing of the asked length.
    pub thickness_share: f64,
    /// How stiffly the foundation resists sliding, over its stiffness against offset.
    pub grip: f64,
    /// Size of the random imperfections from which folds begin, in wavelengths.
    pub imperfection: f64,
    /// Chooses the imperfections.
    pub seed: u64,
    /// Largest step of growth: the logarithm of a factor of length.
    pub largest_step: f64,
    /// ε of 4.5: share of what is left between rest lengths and lengths that is forgotten after each step.
    pub plasticity: f64,
    /// Newton iterations at most in each step.
    pub iteration_limit: usize,
    /// Largest force on a vertex at the end of a step, in units of the force that starts folds on an edge.
    pub tolerance: f64,
}

impl Default for GrowthOptions {
    fn default() -> Self {
        Self {
            young_pa: 1e5,
            poisson: 0.0,
            thickness_share: 0.04,
            grip: 0.3,
            imperfection: 0.02,
            seed: 1,
            largest_step: 0.1,
            plasticity: 0.0,
            iteration_limit: 200,
            tolerance: 1e-3,
        }
    }
}

impl GrowthOptions {
    /// ε_c: the strain at which folds begin.
    pub fn onset(&self) -> f64 {
        (self.thickness_share * std::f64::consts::TAU).powi(2) / (6.0 * (1.0 - self.poisson * self.poisson))
    }

    /// The parts of a growth whose largest logarithm is `most`, one for each step: finer where folds begin, the last is 1.
    pub fn parts(&self, most: f64) -> Vec<f64> {
        let (mut parts, mut level) = (Vec::new(), 0.8 * self.onset());
        while level < most {
            parts.push(level / most);
            level = (level * LEVELS).min(level + self.largest_step);
        }
        // No tiny last step.
        if parts.last().is_some_and(|&last| (1.0 - last) * most < 0.1 * self.largest_step) {
            parts.pop();
        }
        parts.push(1.0);
        parts
    }
}

/// How one step of growth went.
#[derive(Clone, Debug)]
pub struct StepReport {
    /// Part of the growth (0 to 1) that was applied.
    pub part: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Why they ended.
    pub ending: Ending,
    /// Largest force left on a vertex, in units of the force that starts folds on an edge.
    pub residual: f64,
    /// The same force (N).
    pub residual_newton: f64,
    /// Energy (J) of the film and its foundation.
    pub energy_joule: f64,
}

/// How a surface grew.
#[derive(Clone, Debug)]
pub struct GrowthReport {
    /// Every step.
    pub steps: Vec<StepReport>,
    /// The rest metric that was asked for, before any plasticity.
    pub asked: RestMetric,
    /// Seconds.
    pub seconds: f64,
}

/// The folded surface (`[V]`, m).
///
/// # Errors
/// [`Error::Value`] or [`Error::Mesh`] if something asked for cannot be; [`Error::Numeric`] if a step has no finite energy.
pub fn grow(growing: &Growing<'_>, options: &GrowthOptions, observer: &dyn Observer) -> Result<(Vec<Vec3>, GrowthReport)> {
    grow_through(growing, &options.parts(growing.most_growth()), growing.start, options, observer)
}

/// Goes through these `parts` of the growth, one after the other, from `pose` (`[V]`, m) on. Parts may fall again: 0 is the ungrown surface.
///
/// # Errors
/// As [`grow`].
pub fn grow_through(
    growing: &Growing<'_>,
    parts: &[f64],
    pose: &[Vec3],
    options: &GrowthOptions,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, GrowthReport)> {
    grow_each(growing, parts, pose, options, observer, &mut |_, _| Ok(()))
}

/// As [`grow_through`]; `each` is told of every step and the pose (`[V]`, m) that it led to.
///
/// # Errors
/// As [`grow`]; those of `each`.
pub fn grow_each(
    growing: &Growing<'_>,
    parts: &[f64],
    pose: &[Vec3],
    options: &GrowthOptions,
    observer: &dyn Observer,
    each: &mut dyn FnMut(&StepReport, &[Vec3]) -> Result<()>,
) -> Result<(Vec<Vec3>, GrowthReport)> {
    let begun = Instant::now();
    growing.check()?;
    let film = Prepared::new(growing, options, None)?;
    let mut pose = pose.to_vec();
    let mut plastic = vec![1.0; growing.topology.edge_count()];
    let mut steps = Vec::new();
    let choosing = choosing_part(growing, options);
    let exactly = |n: usize, part: f64| n + 1 == parts.len() || part <= choosing;
    for (n, &part) in parts.iter().enumerate() {
        let expansion = growing.expansion.part(part);
        let kept = scale_edges(growing.topology, growing.rest, &plastic)?;
        let grown = expansion.act_on(growing.topology, growing.start, &kept)?;
        let effort = if exactly(n, part) { Effort::exact(options) } else { Effort::of(options, PASSING) };
        let report = film.settle(part, effort, &expansion, &grown, &mut pose, observer)?;
        let cancelled = report.ending == Ending::Cancelled;
        each(&report, &pose)?;
        steps.push(report);
        if options.plasticity > 0.0 {
            forget(growing.topology, &grown, &pose, options.plasticity, &mut plastic);
        }
        if cancelled {
            break;
        }
    }
    let asked = growing.expansion.act_on(growing.topology, growing.start, growing.rest)?;
    Ok((pose, GrowthReport { steps, asked, seconds: begun.elapsed().as_secs_f64() }))
}

/// Part of the growth up to which the pattern of folds is chosen.
pub(super) fn choosing_part(growing: &Growing<'_>, options: &GrowthOptions) -> f64 {
    CHOOSING * options.onset() / growing.most_growth().max(f64::MIN_POSITIVE)
}

/// Solves one part (0 to 1) of the growth of `growing`, from `pose` (`[V]`, m) on; with `within`, only what is not still there.
///
/// # Errors
/// As [`grow`], but nothing is checked beforehand.
pub(super) fn settle_part(
    growing: &Growing<'_>,
    part: f64,
    effort: Effort,
    options: &GrowthOptions,
    within: Option<&Within<'_>>,
    pose: &mut [Vec3],
    observer: &dyn Observer,
) -> Result<StepReport> {
    let expansion = growing.expansion.part(part);
    let grown = expansion.act_on(growing.topology, growing.start, growing.rest)?;
    Prepared::new(growing, options, within)?.settle(part, effort, &expansion, &grown, pose, observer)
}

/// How long a step goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Newton iterations at most.
    pub(super) iteration_limit: usize,
    /// Largest force left on a vertex, in units of the force that starts folds on an edge.
    pub(super) tolerance: f64,
}

impl Effort {
    /// Until all is at rest.
    pub(super) fn exact(options: &GrowthOptions) -> Self {
        Self { iteration_limit: options.iteration_limit, tolerance: options.tolerance }
    }

    /// Until what is left is `loose` times what may be at the end, or this many iterations were made.
    pub(super) fn of(options: &GrowthOptions, (loose, most_iterations): (f64, usize)) -> Self {
        Self { iteration_limit: options.iteration_limit.min(most_iterations), tolerance: loose * options.tolerance }
    }
}

/// `[V]` starting area (m²) and `[V]` imperfections of size 1 (no unit) of a surface with the starting metric `surface`.
pub(super) fn areas_and_imperfections(growing: &Growing<'_>, surface: &RestMetric, seed: u64) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut area_m2 = vec![0.0; growing.start.len()];
    for (face, rest) in growing.topology.faces.iter().zip(&surface.faces) {
        face.iter().for_each(|&v| area_m2[v] += rest.area_m2 / 3.0);
    }
    let rough = band_limited(growing, surface, &area_m2, seed)?;
    Ok((area_m2, rough))
}

/// A part of a larger surface, which is solved alone.
pub(super) struct Within<'a> {
    /// `[V]` whether each vertex stays at its pose.
    pub(super) still: &'a [bool],
    /// `[V]` the pose (m); frozen axes stay there, too.
    pub(super) pose: &'a [Vec3],
    /// `[V]` normals of the starting surface.
    pub(super) normals: &'a [Vec3],
    /// `[V]` starting area (m²), also of faces that are not in the part.
    pub(super) area_m2: &'a [f64],
    /// `[V]` imperfections, of size 1 (no unit).
    pub(super) rough: &'a [f64],
    /// Scale of the whole surface.
    pub(super) scale: Scale,
}

/// Lengths of a whole surface by which its parts are measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Mean of λ (m) over vertices.
    pub(super) wavelength_m: f64,
    /// Mean length (m) of the edges of the starting surface.
    pub(super) edge_m: f64,
}

impl Scale {
    pub(super) fn of(growing: &Growing<'_>) -> Self {
        Self { wavelength_m: growing.wavelength_m.iter().sum::<f64>() / growing.start.len() as f64, edge_m: growing.mean_edge_m() }
    }
}

/// Plasticity (4.5): l₀ becomes (1 − ε)l₀ + εl, kept as a factor of each edge.
fn forget(topology: &Topology, rest: &RestMetric, pose: &[Vec3], share: f64, factors: &mut [f64]) {
    for (f, face) in topology.faces.iter().enumerate() {
        let [u, v] = rest.faces[f].edges();
        let lengths = [u.norm(), (v - u).norm(), v.norm()];
        for k in 0..3 {
            let e = topology.face_edges[f][k];
            if topology.edge_faces[e][0] == f {
                let length = (pose[face[(k + 1) % 3]] - pose[face[k]]).norm();
                factors[e] *= 1.0 + share * (length / lengths[k] - 1.0);
            }
        }
    }
}

/// What does not change from step to step.
struct Prepared<'a, 'b> {
    growing: &'b Growing<'a>,
    options: &'b GrowthOptions,
    normals: Vec<Vec3>,
    clamps: Clamps,
    /// A film of mean λ's thickness.
    material: Material,
    /// `[F]` thickness in units of the material's.
    thickness: Vec<f64>,
    /// `[V]` starting area (m²).
    area_m2: Vec<f64>,
    /// `[F]` slope of the offset along the crests by the offsets of its corners (1/m), times √(2·area/q²)·Λ/λ; 0 where nothing grows
    /// one way more than the other.
    crests: Vec<CrestTension>,
    /// `[V]` size 1, mean about 0 (no unit).
    rough: Vec<f64>,
    scale: Scale,
}

impl<'a, 'b> Prepared<'a, 'b> {
    fn new(growing: &'b Growing<'a>, options: &'b GrowthOptions, within: Option<&Within<'_>>) -> Result<Self> {
        let (topology, start) = (growing.topology, growing.start);
        let scale = within.map_or_else(|| Scale::of(growing), |within| within.scale);
        let mean = scale.wavelength_m;
        let material = Material::new(options.young_pa, options.poisson, options.thickness_share * mean)?;
        let thickness: Vec<f64> =
            topology.faces.iter().map(|face| face.iter().map(|&v| growing.wavelength_m[v]).sum::<f64>() / (3.0 * mean)).collect();
        let mut clamps = Clamps::none(start.len());
        for (v, frozen) in growing.frozen.iter().enumerate() {
            let (still, place) = within.map_or((false, &start[v]), |within| (within.still[v], &within.pose[v]));
            clamps.targets[v] = std::array::from_fn(|axis| (still || frozen[axis]).then_some(place[axis]));
        }
        let surface = RestMetric::from_shape("growth", start, &topology.faces)?;
        let (area_m2, rough) = match within {
            Some(within) => (within.area_m2.to_vec(), within.rough.to_vec()),
            None => areas_and_imperfections(growing, &surface, options.seed)?,
        };
        Ok(Self {
            growing,
            options,
            normals: within.map_or_else(|| vertex_normals(topology, start), |within| Ok(within.normals.to_vec()))?,
            clamps,
            material,
            thickness,
            area_m2,
            crests: (0..topology.face_count()).map(|f| crest_tension(growing, &surface, f)).collect(),
            rough,
            scale,
        })
    }

    /// k (N/m³) at vertex `v`, grown by the factor `growth`.
    fn stiffness(&self, v: usize, growth: f64) -> f64 {
        let (wavelength, poisson) = (self.growing.wavelength_m[v], self.options.poisson);
        let thickness = self.options.thickness_share * wavelength;
        let bending = self.options.young_pa * thickness.powi(3) / (12.0 * (1.0 - poisson * poisson));
        loose::share(self.growing.hold[v]) * bending * (std::f64::consts::TAU / wavelength).powi(4) / softening(growth)
    }

    /// What keeps the surface from passing through itself, pushing about as hard as the foundation does under a fold.
    fn contact(&self, foundation: &[Foundation]) -> Option<SelfContact<'b>> {
        let growing = self.growing;
        let strength: Vec<f64> =
            foundation.iter().zip(&growing.wavelength_m).map(|(held, wavelength)| held.stiffness * wavelength).collect();
        // Not much more than an edge can tell apart.
        let reach = self.material.thickness_m.min(0.5 * self.scale.edge_m);
        growing.self_contact.then(|| SelfContact::new(growing.topology, growing.start, reach, LONGEST_MOVE * self.scale.edge_m, &strength))
    }

    fn settle(
        &self,
        part: f64,
        effort: Effort,
        expansion: &Expansion,
        grown: &RestMetric,
        pose: &mut [Vec3],
        observer: &dyn Observer,
    ) -> Result<StepReport> {
        let (growing, options) = (self.growing, self.options);
        let most: Vec<f64> = expansion.vertices.iter().map(|growth| growth.principal().0[0]).collect();
        let stiff: Vec<f64> = (0..most.len()).map(|v| self.stiffness(v, most[v])).collect();
        // What does not grow is pushed nowhere.
        let begun = |v: usize| (most[v].ln().max(0.0) / FULL_IMPERFECTION).min(1.0);
        let offset_of = |v: usize, rough: f64| begun(v) * growing.wavelength_m[v] * options.imperfection * rough;
        let foundation: Vec<Foundation> = (0..most.len())
            .map(|v| {
                let stiffness = stiff[v] * self.area_m2[v];
                Foundation {
                    normal: self.normals[v],
                    stiffness,
                    grip: options.grip * stiffness,
                    offset_m: begun(v) * growing.wavelength_m[v] * (growing.bias[v] + options.imperfection * self.rough[v]),
                    stickiness: growing.stickiness[v],
                }
            })
            .collect();
        let crests: Vec<CrestTension> = growing
            .topology
            .faces
            .iter()
            .zip(&self.crests)
            .map(|(face, crest)| {
                let stiffness = face.iter().map(|&v| stiff[v]).sum::<f64>() / 3.0;
                crest.map(|c| c * stiffness.sqrt())
            })
            .collect();
        let mut setup = Setup {
            loads: growing.loads.clone(),
            obstacles: growing.obstacles,
            contact_thickness_m: growing.contact_thickness_m,
            contact_pressure_pa: foundation
                .iter()
                .zip(&growing.wavelength_m)
                .map(|(held, wavelength)| held.stiffness * wavelength)
                .sum::<f64>()
                / self.area_m2.iter().sum::<f64>(),
            ..Setup::new(growing.topology, grown, &self.material, &self.clamps)
        };
        let rest_offset_m: Vec<Vec3> =
            (0..most.len()).map(|v| self.normals[v] * (loose::missing(growing.hold[v]) * offset_of(v, self.rough[v]))).collect();
        setup.loads.forces_newton.extend(loose::forces_newton(&setup, &self.thickness, &rest_offset_m));
        let mut film = Film::new(&setup, growing.start, &self.thickness, &foundation, &crests)?.apart(self.contact(&foundation));
        let force = options.onset() * self.scale.edge_m / film.length_m();
        let newton = Options {
            stage: "grow",
            iteration_limit: effort.iteration_limit,
            tolerance: effort.tolerance * force,
            convexity: Convexity::Clamped,
            ridge: 1e-14,
            leave_saddles: false,
            energy_unit_joule: film.unit_joule(),
        };
        let (unit_joule, length_m, begin) = (film.unit_joule(), film.length_m(), film.pack(pose));
        let outcome = if growing.bands.is_empty() {
            let outcome = minimise(&mut film, &begin, &newton, observer)?;
            film.unpack(&outcome.x, pose);
            outcome
        } else {
            let unknown = film.unknowns().to_vec();
            let mut banded = Banded::new(film, &growing.bands, &unknown, growing.start, &self.area_m2, length_m);
            let begin = banded.pack(&begin, growing.start, pose);
            let outcome = minimise(&mut banded, &begin, &newton, observer)?;
            banded.inner().unpack(&banded.unpack(&outcome.x), pose);
            banded.straighten(growing.start, pose);
            outcome
        };
        if !outcome.energy.is_finite() {
            return Err(Error::numeric("grow", "the energy is not a finite number; check the expansion and the loads"));
        }
        Ok(StepReport {
            part,
            iterations: outcome.iterations,
            ending: outcome.ending,
            residual: outcome.projected_gradient / force,
            residual_newton: outcome.projected_gradient * unit_joule / length_m,
            energy_joule: outcome.energy * unit_joule,
        })
    }
}

/// The crest tension of face `f` over √k: T = 2k/q²·(Λ/λ)² against slopes along the direction that grows least.
fn crest_tension(growing: &Growing<'_>, surface: &RestMetric, f: usize) -> CrestTension {
    let face = growing.topology.faces[f];
    let [a, b, c] = face.map(|v| growing.start[v]);
    // A face's frame: the first vector along side 0→1, as in its metric.
    let first = (b - a).normalize();
    let second = (b - a).cross(&(c - a)).normalize().cross(&first);
    // The directions are lines: their dyads are averaged, weighted by how much more grows one way than the other.
    let (mut dyads, mut ratio) = (crate::mesh::Mat2::zeros(), 0.0);
    for v in face {
        let ([most, least], [_, along]) = growing.expansion.vertices[v].principal();
        let uneven = if most > 1.0 { 1.0 - least.ln().max(0.0) / most.ln() } else { 0.0 };
        let along = crate::mesh::Vec2::new(first.dot(&along), second.dot(&along));
        dyads += along * along.transpose() * uneven;
        ratio += uneven / 3.0 * growing.coherence_m[v] / growing.wavelength_m[v];
    }
    if ratio == 0.0 {
        return [0.0; 3];
    }
    let (_, low) = crate::strain::principal_pair(&dyads);
    let crest = crate::mesh::Vec2::new(-low.y, low.x);
    let wavelength = face.iter().map(|&v| growing.wavelength_m[v]).sum::<f64>() / 3.0;
    let scale = (2.0 * surface.faces[f].area_m2).sqrt() * wavelength / std::f64::consts::TAU * ratio;
    surface.faces[f].barycentric_gradients().map(|g| scale * g.dot(&crest))
}
