//! The base solve: the pose of least tension-field and bending energy under clamps, loads and
//! contact (4.1 of [Chen 2021]).

use web_time::Instant;

use super::equilibrium::{Bending, Equilibrium};
use super::quadratic_bending::QuadraticBending;
use super::setup::Setup;
use super::start::{pin_rigid_motions, prepare};
use super::tension_field::{FaceState, Membrane};
use crate::linalg::Ending;
use crate::linalg::newton::{Options, minimise};
use crate::mesh::{Topology, Vec3};
use crate::progress::Observer;
use crate::rest::RestMetric;
use crate::{Error, Result};

/// Distance (in lengths of the sheet) beyond which a surface that moved counts as falling for ever.
const FALLING: f64 = 100.0;

/// Options of the base solve.
#[derive(Clone, Debug)]
pub struct BaseOptions {
    /// Share of the ordinary resistance that is left against compression (no unit, 0 to 1): 0 is
    /// tension field theory.
    pub compressive_stiffness: f64,
    /// Newton iterations at most.
    pub iteration_limit: usize,
    /// Largest gradient component at which the solve ends, in units of Young's modulus · thickness
    /// · size.
    pub tolerance: f64,
}

impl Default for BaseOptions {
    fn default() -> Self {
        Self { compressive_stiffness: 0.0, iteration_limit: 500, tolerance: 1e-12 }
    }
}

/// Report of a base solve.
#[derive(Clone, Debug)]
pub struct BaseReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Reason why they ended.
    pub ending: Ending,
    /// Energy of membrane, bending, loads and contact (J); loads have none at the start.
    pub energy_joule: f64,
    /// Largest gradient component (N).
    pub gradient_newton: f64,
    /// Faces whose area is below 1 % of their rest area.
    pub collapsed_faces: Vec<usize>,
    /// Faces whose normal points against the mean of their neighbours'.
    pub inverted_faces: Vec<usize>,
    /// Faces that started inside an obstacle and were pushed out.
    pub resolved_faces: Vec<usize>,
    /// Numbers of slack, mixed and taut faces.
    pub states: [usize; 3],
    /// Seconds.
    pub seconds: f64,
}

/// The base surface (`[V]`, m) of `setup`, from the pose `start` (`[V]`, m) on.
///
/// `start` is first deformed smoothly so that it meets the clamps, blown up a little if pressure
/// acts on a flat surface, and pushed out of obstacles.
///
/// ```
/// use plisse::progress::Silent;
/// use plisse::shell::{BaseOptions, Clamps, Setup, solve_base};
/// # use plisse::{Material, Sheet};
/// # use plisse::mesh::Vec3;
/// # // A strip of 20 × 4 squares of 1 cm.
/// # let at = |v: usize| Vec3::new(0.01 * (v % 21) as f64, 0.01 * (v / 21) as f64, 0.0);
/// # let rest: Vec<Vec3> = (0..105).map(at).collect();
/// # let squares = (0..84).filter(|v| v % 21 != 20);
/// # let faces: Vec<[usize; 3]> =
/// #     squares.flat_map(|v| [[v, v + 1, v + 22], [v, v + 22, v + 21]]).collect();
/// # let sheet = Sheet::from_rest(rest.clone(), faces, Material::new(1e6, 0.3, 1e-4)?)?;
/// // Hold both ends of a strip and pull one of them 1 cm.
/// let mut clamps = Clamps::none(rest.len());
/// for (v, p) in rest.iter().enumerate() {
///     if p.x < 1e-9 {
///         clamps.hold(v, *p);
///     } else if p.x > 0.2 - 1e-9 {
///         clamps.hold(v, p + Vec3::x() * 0.01);
///     }
/// }
/// let setup = Setup::new(&sheet, &clamps);
/// let (pose, report) = solve_base(&setup, &rest, &BaseOptions::default(), &Silent)?;
/// assert!((pose[20].x - 0.21).abs() < 1e-12 && report.energy_joule > 0.0);
/// # Ok::<(), plisse::Error>(())
/// ```
///
/// # Errors
/// [`Error::Setup`] if nothing holds the surface, it is open under pressure, or the sheet is not
/// thin; [`Error::Mesh`] if it starts too deep inside an obstacle; [`Error::Numeric`] if the energy
/// is not finite, or the surface falls for ever.
pub fn solve_base(
    setup: &Setup<'_>,
    start: &[Vec3],
    options: &BaseOptions,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, BaseReport)> {
    let begun = Instant::now();
    setup.check()?;
    let (begin, resolved_faces) = prepare(setup, start)?;
    let bending = Bending::Quadratic(QuadraticBending::new(
        &setup.sheet.topology,
        &setup.sheet.rest,
        &setup.sheet.material,
    ));
    let criteria = StopCriteria {
        stage: "base",
        iteration_limit: options.iteration_limit,
        tolerance: options.tolerance,
        escape_saddles: false,
    };
    let stiffness = Stiffness { compression: options.compressive_stiffness, bending };
    let solution = equilibrate(setup, &begin, stiffness, &criteria, observer)?;
    let pose = solution.pose;
    let mut states = [0; 3];
    for (rest, face) in setup.sheet.rest.faces.iter().zip(&setup.sheet.topology.faces) {
        let membrane = Membrane::new(rest, &setup.sheet.material, options.compressive_stiffness);
        states[match membrane.state(&face.map(|v| pose[v])) {
            FaceState::Slack => 0,
            FaceState::Mixed => 1,
            FaceState::Taut => 2,
        }] += 1;
    }
    let (collapsed_faces, inverted_faces) =
        defects(&setup.sheet.topology, &setup.sheet.rest, &pose);
    let report = BaseReport {
        iterations: solution.iterations,
        ending: solution.ending,
        energy_joule: solution.energy_joule,
        gradient_newton: solution.gradient_newton,
        collapsed_faces,
        inverted_faces,
        resolved_faces,
        states,
        seconds: begun.elapsed().as_secs_f64(),
    };
    Ok((pose, report))
}

/// Resistance of a shell to compression and to bending.
pub(super) struct Stiffness {
    /// Share of the ordinary resistance that is left against compression (no unit, 0 to 1).
    pub(super) compression: f64,
    pub(super) bending: Bending,
}

/// Criteria by which the search for an equilibrium stops.
pub(super) struct StopCriteria {
    /// Name of the step, for the observer and errors.
    pub(super) stage: &'static str,
    pub(super) iteration_limit: usize,
    /// Largest gradient component at the end, in units of Young's modulus · thickness · size.
    pub(super) tolerance: f64,
    /// True if the search goes on where the shell is in equilibrium but about to buckle.
    pub(super) escape_saddles: bool,
}

/// An equilibrium and the report of its solve.
pub(super) struct Solution {
    /// `[V]` (m).
    pub(super) pose: Vec<Vec3>,
    pub(super) iterations: usize,
    pub(super) ending: Ending,
    pub(super) energy_joule: f64,
    /// Largest gradient component (N), and in units of Young's modulus · thickness · size.
    pub(super) gradient_newton: f64,
    pub(super) residual: f64,
}

/// The equilibrium of a shell with this `stiffness`, from the prepared pose `begin` (`[V]`, m) on.
pub(super) fn equilibrate(
    setup: &Setup<'_>,
    begin: &[Vec3],
    stiffness: Stiffness,
    criteria: &StopCriteria,
    observer: &dyn Observer,
) -> Result<Solution> {
    let mut held = setup.clamps.clone();
    if setup.floats() {
        pin_rigid_motions(&setup.sheet.topology, begin, &mut held);
    }
    let mut problem =
        Equilibrium::new(setup, &held, begin, stiffness.compression, stiffness.bending);
    let unit_joule = problem.unit_joule();
    let newton = Options {
        iteration_limit: criteria.iteration_limit,
        tolerance: criteria.tolerance,
        escape_saddles: criteria.escape_saddles,
        ..Options::new(criteria.stage, unit_joule)
    };
    let x = problem.pack(begin);
    let outcome = minimise(&mut problem, &x, &newton, observer)?;
    let mut pose = begin.to_vec();
    problem.unpack(&outcome.x, &mut pose);
    check_outcome(criteria.stage, setup, outcome.energy, begin, &pose)?;
    Ok(Solution {
        pose,
        iterations: outcome.iterations,
        ending: outcome.ending,
        energy_joule: outcome.energy * unit_joule,
        gradient_newton: outcome.projected_gradient * unit_joule / setup.length_m(),
        residual: outcome.projected_gradient,
    })
}

/// Refuses a result that is no equilibrium of anything: not finite, or endlessly far from the pose
/// that the solve began at.
fn check_outcome(
    stage: &'static str,
    setup: &Setup<'_>,
    energy: f64,
    begin: &[Vec3],
    pose: &[Vec3],
) -> Result<()> {
    if !energy.is_finite() {
        return Err(Error::numeric(
            stage,
            "the energy is not a finite number; check the material's constants and the clamps' \
             positions",
        ));
    }
    let largest = |lengths: &mut dyn Iterator<Item = f64>| lengths.fold(0.0, f64::max);
    let moved = largest(&mut pose.iter().zip(begin).map(|(p, q)| (p - q).norm()));
    if moved > FALLING * (setup.length_m() + largest(&mut begin.iter().map(Vec3::norm))) {
        return Err(Error::numeric(
            stage,
            "the surface falls for ever or is blown up without end; hold it, or lessen the loads",
        ));
    }
    Ok(())
}

/// Faces of `pose` that are collapsed (below 1 % of their rest area) and inverted (normal against
/// the mean of their neighbours').
pub fn defects(topology: &Topology, rest: &RestMetric, pose: &[Vec3]) -> (Vec<usize>, Vec<usize>) {
    let normals: Vec<Vec3> = topology
        .faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.map(|v| pose[v]);
            (b - a).cross(&(c - a)) * 0.5
        })
        .collect();
    let collapsed = (0..topology.face_count())
        .filter(|&f| normals[f].norm() < 0.01 * rest.faces[f].area_m2)
        .collect();
    let inverted = (0..topology.face_count())
        .filter(|&f| {
            let around: Vec3 =
                (0..3).filter_map(|k| topology.neighbour(f, k)).map(|g| normals[g]).sum();
            normals[f].dot(&around) < 0.0
        })
        .collect();
    (collapsed, inverted)
}
