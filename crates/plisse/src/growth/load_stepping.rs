//! Folds a grown surface up: the variational mode. A film on a soft foundation, grown in steps,
//! each solved to equilibrium.
//!
//! A film of bending stiffness B on a foundation k wrinkles, as soon as it is pressed by ε_c =
//! h²q²/(6(1−ν²)), with the wave number q = 2π/λ = (k/B)^¼. So the wavelength λ is a design
//! parameter: **λ is the spacing of the folds that is seen on the starting surface**. (Along the
//! grown surface a fold is longer: g·λ, which is the λ of the paper's own derivation.) The film is
//! made
//! [`GrowthOptions::thickness_share`] of λ thick, and k = Bq⁴/c(g) follows from λ, softened by [`super::fold_angle::softening`] as the
//! folds grow large, so that no growth makes folds split or merge. What is asked beyond ε_c goes
//! into length.
//!
//! Growth is applied in steps of equal *factors*, small ones where folds begin, so that the pattern
//! is chosen near onset where λ alone decides; later it only grows. The grip of the foundation on
//! sliding keeps folds from gathering in one place: on a foundation that resists offset only, a row
//! of folds is unstable against a single large one (Diamant & Witten 2011).

use web_time::Instant;

use super::equilibrate::{Effort, Prepared};
use super::expansion::scale_edges;
use super::surface::Growing;
use crate::Result;
use crate::linalg::Ending;
use crate::mesh::{Topology, Vec3};
use crate::progress::Observer;
use crate::rest::RestMetric;

/// Factor between the first levels of growth.
const LEVELS: f64 = 1.35;
/// How much more force than at the end may be left after a step that others follow, and how many
/// iterations it may take.
const PASSING: (f64, usize) = (10.0, 60);
/// Up to this level of growth, in units of ε_c, every step is solved exactly: here the pattern of
/// folds is chosen.
const CHOOSING: f64 = 3.0;

/// How folds are solved for.
#[derive(Clone, Debug)]
pub struct GrowthOptions {
    /// Young's modulus (Pa) of the film: only loads and contact are measured against it.
    pub young_pa: f64,
    /// Poisson's ratio of the film.
    pub poisson: f64,
    /// Thickness of the film over λ: folds begin at the strain 6.6·share²/(1−ν²), which is what is
    /// missing of the asked length.
    pub thickness_share: f64,
    /// How stiffly the foundation resists sliding, over its stiffness against offset.
    pub grip: f64,
    /// Size of the random imperfections from which folds begin, in wavelengths.
    pub imperfection: f64,
    /// Chooses the imperfections.
    pub seed: u64,
    /// Largest step of growth: the logarithm of a factor of length.
    pub largest_step: f64,
    /// ε of 4.5: share of what is left between rest lengths and lengths that is forgotten after
    /// each step.
    pub plasticity: f64,
    /// Newton iterations at most in each step.
    pub iteration_limit: usize,
    /// Largest force on a vertex at the end of a step, in units of the force that starts folds on
    /// an edge.
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
            iteration_limit: 500,
            tolerance: 1e-3,
        }
    }
}

impl GrowthOptions {
    /// ε_c: the strain at which folds begin.
    pub fn onset(&self) -> f64 {
        (self.thickness_share * std::f64::consts::TAU).powi(2)
            / (6.0 * (1.0 - self.poisson * self.poisson))
    }

    /// The parts of a growth whose largest logarithm is `most`, one for each step: finer where
    /// folds begin, the last is 1.
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
/// [`crate::Error::Value`] or [`crate::Error::Mesh`] if something asked for cannot be; [`crate::Error::Numeric`] if a step has no finite energy.
pub fn grow(
    growing: &Growing<'_>,
    options: &GrowthOptions,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, GrowthReport)> {
    grow_through(
        growing,
        &options.parts(growing.maps.most_growth()),
        growing.start,
        options,
        observer,
    )
}

/// Goes through these `parts` of the growth, one after the other, from `pose` (`[V]`, m) on. Parts
/// may fall again: 0 is the ungrown surface.
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
        let expansion = growing.maps.expansion.part(part);
        let kept = scale_edges(growing.topology, growing.rest, &plastic)?;
        let grown = expansion.act_on(growing.topology, growing.start, &kept)?;
        let effort =
            if exactly(n, part) { Effort::exact(options) } else { Effort::of(options, PASSING) };
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
    let asked = growing.maps.expansion.act_on(growing.topology, growing.start, growing.rest)?;
    Ok((pose, GrowthReport { steps, asked, seconds: begun.elapsed().as_secs_f64() }))
}

/// Part of the growth up to which the pattern of folds is chosen.
pub(super) fn choosing_part(growing: &Growing<'_>, options: &GrowthOptions) -> f64 {
    CHOOSING * options.onset() / growing.maps.most_growth().max(f64::MIN_POSITIVE)
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
