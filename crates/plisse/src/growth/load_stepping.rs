//! Folds a grown surface up: the variational mode. A film on a soft foundation is grown in load
//! steps, and each step is solved to equilibrium (path following).
//!
//! A film of bending stiffness B on a foundation k wrinkles, as soon as it is pressed by ε_c =
//! h²q²/(6(1−ν²)), with the wave number q = 2π/λ = (k/B)^¼. So the wavelength λ is a design
//! parameter: **λ is the spacing of the folds that is seen on the starting surface**. (Along the
//! grown surface a fold is longer: g·λ, which is the λ of the paper's own derivation.) The film is
//! [`GrowthOptions::thickness_share`] of λ thick. Then k = Bq⁴/c(g) follows from λ, softened by
//! [`super::fold_angle::softening`] as the folds grow large, so that no growth makes folds split or
//! merge. Growth beyond ε_c goes into length.
//!
//! Growth is applied in steps of equal *factors*, small ones where folds begin, so that the pattern
//! is chosen near onset where λ alone decides; later it only grows. The grip of the foundation on
//! sliding keeps folds from gathering in one place: on a foundation that resists offset only, a row
//! of folds is unstable against a single large one (Diamant & Witten 2011).

use web_time::Instant;

use super::equilibrate::{FilmModel, LoadStep, StopCriteria};
use super::expansion::scale_edges;
use super::surface::GrowingSurface;
use crate::Result;
use crate::linalg::Ending;
use crate::mesh::{Topology, Vec3};
use crate::progress::Observer;
use crate::rest::RestMetric;

/// Factor between the first levels of growth.
const LEVELS: f64 = 1.35;
/// Tolerance of a step that others follow, over the tolerance of the last one.
const INTERMEDIATE_TOLERANCE: f64 = 10.0;
/// Newton iterations at most of a step that others follow.
const INTERMEDIATE_ITERATIONS: usize = 60;
/// Growth, in units of ε_c, up to which every step is solved to the full tolerance: there the
/// pattern of folds is chosen.
const PATTERN_SELECTION: f64 = 3.0;

/// Options of the variational mode.
#[derive(Clone, Debug)]
pub struct GrowthOptions {
    /// Young's modulus (Pa) of the film: only loads and contact are measured against it.
    pub young_pa: f64,
    /// Poisson's ratio of the film.
    pub poisson: f64,
    /// Thickness of the film over λ: folds begin at the strain 6.6·share²/(1−ν²), which is what is
    /// missing of the asked length.
    pub thickness_share: f64,
    /// Stiffness of the foundation against sliding, over its stiffness against offset.
    pub grip: f64,
    /// Size of the random imperfections from which folds begin, in wavelengths.
    pub imperfection: f64,
    /// Seed of the imperfections.
    pub seed: u64,
    /// Largest step of growth: the logarithm of a factor of length.
    pub largest_step: f64,
    /// ε of 4.5: share of the difference between lengths and rest lengths that becomes plastic
    /// after each step.
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

/// Report on one load step.
#[derive(Clone, Debug)]
pub struct StepReport {
    /// Part of the growth (0 to 1) that was applied.
    pub part: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Reason for which they ended.
    pub ending: Ending,
    /// Largest force left on a vertex, in units of the force that starts folds on an edge.
    pub residual: f64,
    /// The same force (N).
    pub residual_newton: f64,
    /// Energy (J) of the film and its foundation.
    pub energy_joule: f64,
}

/// Report on all load steps.
#[derive(Clone, Debug)]
pub struct GrowthReport {
    /// Every step.
    pub steps: Vec<StepReport>,
    /// The rest metric that was asked for, before any plasticity.
    pub asked: RestMetric,
    /// Seconds.
    pub seconds: f64,
}

/// The load steps that are followed, and how each of them is solved.
#[derive(Clone, Copy, Debug)]
pub struct LoadSteps<'a> {
    /// Parts (0 to 1) of the growth, one after the other. They may fall again: 0 is the ungrown
    /// surface.
    pub parts: &'a [f64],
    /// Options of every step.
    pub options: &'a GrowthOptions,
}

/// The folded surface (`[V]`, m).
///
/// ```
/// use plisse::growth::grow;
/// use plisse::prelude::*;
/// # let at = |v: usize| Vec3::new(0.05 * (v % 21) as f64, 0.05 * (v / 21) as f64, 0.0);
/// # let start: Vec<Vec3> = (0..189).map(at).collect();
/// # let squares = (0..168).filter(|v| v % 21 != 20);
/// # let faces: Vec<[usize; 3]> =
/// #     squares.flat_map(|v| [[v, v + 1, v + 22], [v, v + 22, v + 21]]).collect();
/// # let sheet = Sheet::from_rest(start.clone(), faces, Material::new(1e5, 0.3, 1e-3)?)?;
/// // A strip of 1 m × 0.4 m grows by 20 % along x, between ends that stay where they are.
/// let (along, factors) = (vec![Vec3::x(); start.len()], vec![1.2; start.len()]);
/// let expansion = Expansion::from_directions(&sheet.topology, &start, &along, &factors)?;
/// let maps = GrowthMaps::even(&expansion, 0.5, 0.0);
/// let mut surface = GrowingSurface::new(sheet.topology, sheet.rest, start, maps);
/// surface.freeze(|_, p| p.x < 1e-9 || p.x > 1.0 - 1e-9);
/// let (folded, _) = grow(&surface, &GrowthOptions::default(), &Silent)?;
/// assert!(folded.iter().any(|p| p.z.abs() > 0.05));
/// # Ok::<(), plisse::Error>(())
/// ```
///
/// # Errors
/// [`crate::Error::Value`] or [`crate::Error::Mesh`] if something asked for cannot be;
/// [`crate::Error::Numeric`] if a step has no finite energy.
pub fn grow(
    surface: &GrowingSurface,
    options: &GrowthOptions,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, GrowthReport)> {
    let parts = options.parts(surface.maps.most_growth());
    follow(surface, &surface.start, &LoadSteps { parts: &parts, options }, observer)
}

/// Follows these load steps from `pose` (`[V]`, m) on.
///
/// # Errors
/// As [`grow`].
pub fn follow(
    surface: &GrowingSurface,
    pose: &[Vec3],
    steps: &LoadSteps<'_>,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, GrowthReport)> {
    follow_each(surface, pose, steps, observer, &mut |_, _| Ok(()))
}

/// As [`follow`]; `each` is called with every step and the pose (`[V]`, m) that it led to.
///
/// # Errors
/// As [`grow`]; those of `each`.
pub fn follow_each(
    surface: &GrowingSurface,
    pose: &[Vec3],
    steps: &LoadSteps<'_>,
    observer: &dyn Observer,
    each: &mut dyn FnMut(&StepReport, &[Vec3]) -> Result<()>,
) -> Result<(Vec<Vec3>, GrowthReport)> {
    let begun = Instant::now();
    let LoadSteps { parts, options } = *steps;
    surface.check()?;
    let film = FilmModel::new(surface, options, None)?;
    let (whole, mut pose) = (surface.maps.expansion(), pose.to_vec());
    let mut plastic = vec![1.0; surface.topology.edge_count()];
    let mut reports = Vec::new();
    let selection = pattern_selection_part(surface, options);
    for (n, &part) in parts.iter().enumerate() {
        let expansion = whole.part(part);
        let rest = scale_edges(&surface.topology, &surface.rest, &plastic)?;
        let grown = expansion.act_on(&surface.topology, &surface.start, &rest)?;
        let criteria = if n + 1 == parts.len() || part <= selection {
            StopCriteria::full(options)
        } else {
            StopCriteria::loosened(options, INTERMEDIATE_TOLERANCE, INTERMEDIATE_ITERATIONS)
        };
        let step = LoadStep { part, criteria, expansion: &expansion, grown: &grown };
        let report = film.equilibrate(&step, &mut pose, observer)?;
        let cancelled = report.ending == Ending::Cancelled;
        each(&report, &pose)?;
        reports.push(report);
        if options.plasticity > 0.0 {
            relax_rest_lengths(&surface.topology, &grown, &pose, options.plasticity, &mut plastic);
        }
        if cancelled {
            break;
        }
    }
    let (asked, seconds) = (surface.asked()?, begun.elapsed().as_secs_f64());
    Ok((pose, GrowthReport { steps: reports, asked, seconds }))
}

/// Part of the growth up to which the pattern of folds is chosen.
pub(super) fn pattern_selection_part(surface: &GrowingSurface, options: &GrowthOptions) -> f64 {
    PATTERN_SELECTION * options.onset() / surface.maps.most_growth().max(f64::MIN_POSITIVE)
}

/// Plasticity (4.5): l₀ becomes (1 − ε)l₀ + εl, kept as a factor of each edge.
fn relax_rest_lengths(
    topology: &Topology,
    rest: &RestMetric,
    pose: &[Vec3],
    share: f64,
    factors: &mut [f64],
) {
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
