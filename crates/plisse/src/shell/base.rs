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

/// How far (in lengths of the sheet) a surface may move before it counts as falling for ever.
const FALLING: f64 = 100.0;

/// How the base surface is solved.
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

/// How the base solve went.
#[derive(Clone, Debug)]
pub struct BaseReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Why they ended.
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
/// # Errors
/// [`Error::Value`] if nothing holds the surface, it is open under pressure, or the sheet is not thin; [`Error::Mesh`] if it starts too
/// deep inside an obstacle; [`Error::Numeric`] if the energy is not finite, or the surface falls
/// for ever.
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
    let effort = Effort {
        stage: "base",
        iteration_limit: options.iteration_limit,
        tolerance: options.tolerance,
        escape_saddles: false,
    };
    let settled = settle(setup, &begin, options.compressive_stiffness, bending, &effort, observer)?;
    let pose = settled.pose;
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
        iterations: settled.iterations,
        ending: settled.ending,
        energy_joule: settled.energy_joule,
        gradient_newton: settled.gradient_newton,
        collapsed_faces,
        inverted_faces,
        resolved_faces,
        states,
        seconds: begun.elapsed().as_secs_f64(),
    };
    Ok((pose, report))
}

/// How long, and how exactly, an equilibrium is sought.
pub(super) struct Effort {
    /// Name of the step, for the observer and errors.
    pub(super) stage: &'static str,
    pub(super) iteration_limit: usize,
    /// Largest gradient component at the end, in units of Young's modulus · thickness · size.
    pub(super) tolerance: f64,
    /// Whether to go on from where the shell is in equilibrium but about to buckle.
    pub(super) escape_saddles: bool,
}

/// An equilibrium, and how it was found.
pub(super) struct Settled {
    /// `[V]` (m).
    pub(super) pose: Vec<Vec3>,
    pub(super) iterations: usize,
    pub(super) ending: Ending,
    pub(super) energy_joule: f64,
    /// Largest gradient component (N), and in units of Young's modulus · thickness · size.
    pub(super) gradient_newton: f64,
    pub(super) residual: f64,
}

/// The equilibrium of a shell that resists bending by `bending`, from the prepared pose `begin`
/// (`[V]`, m) on.
pub(super) fn settle(
    setup: &Setup<'_>,
    begin: &[Vec3],
    compressive_stiffness: f64,
    bending: Bending,
    effort: &Effort,
    observer: &dyn Observer,
) -> Result<Settled> {
    let mut held = setup.clamps.clone();
    if setup.floats() {
        pin_rigid_motions(&setup.sheet.topology, begin, &mut held);
    }
    let mut problem = Equilibrium::new(setup, &held, begin, compressive_stiffness, bending);
    let unit_joule = problem.unit_joule();
    let newton = Options {
        iteration_limit: effort.iteration_limit,
        tolerance: effort.tolerance,
        escape_saddles: effort.escape_saddles,
        ..Options::new(effort.stage, unit_joule)
    };
    let x = problem.pack(begin);
    let outcome = minimise(&mut problem, &x, &newton, observer)?;
    let mut pose = begin.to_vec();
    problem.unpack(&outcome.x, &mut pose);
    check_outcome(effort.stage, setup, outcome.energy, begin, &pose)?;
    Ok(Settled {
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
