//! The reference shell: St. Venant–Kirchhoff membrane and mid-edge bending by full Newton (appendix
//! A and section 6 of [Chen 2021]). It shows wrinkles only where the mesh is fine enough for them;
//! the wrinkle field is held against it.

use web_time::Instant;

use super::base::{Stiffness, StopCriteria, equilibrate};
use super::equilibrium::Bending;
use super::mid_edge_bending::MidEdgeBending;
use super::setup::Setup;
use super::start::prepare;
use crate::Result;
use crate::linalg::Ending;
use crate::mesh::Vec3;
use crate::progress::Observer;
use crate::random::Random;

/// Options of the solve of the reference shell.
#[derive(Clone, Debug)]
pub struct ReferenceOptions {
    /// Newton iterations at most.
    pub iteration_limit: usize,
    /// Largest gradient component at which the solve ends, in units of Young's modulus · thickness
    /// · size.
    pub tolerance: f64,
    /// Each free vertex starts up to this far (m) off its place along the normal, so that a flat
    /// surface can buckle at all.
    pub imperfection_m: f64,
    /// Chooses the imperfection.
    pub seed: u64,
}

/// Residual above which a solve that cannot go on has not converged.
const STUCK: f64 = 1e-7;

impl Default for ReferenceOptions {
    fn default() -> Self {
        Self { iteration_limit: 1000, tolerance: 1e-10, imperfection_m: 0.0, seed: 1 }
    }
}

/// Report of a solve of the reference shell.
#[derive(Clone, Debug)]
pub struct ReferenceReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Reason why they ended.
    pub ending: Ending,
    /// Energy of membrane, bending, loads and contact (J); loads have none at the start.
    pub energy_joule: f64,
    /// Largest gradient component (N).
    pub gradient_newton: f64,
    /// The same, in units of Young's modulus · thickness · size.
    pub residual: f64,
    /// Faces that started inside an obstacle and were pushed out.
    pub resolved_faces: Vec<usize>,
    /// Seconds.
    pub seconds: f64,
}

impl ReferenceReport {
    /// True if it ended where no step lowers the energy although forces are far from balanced: the
    /// energy has a jump where a face loses its area.
    pub fn is_stuck(&self) -> bool {
        self.ending == Ending::RoundOff && self.residual > STUCK
    }
}

/// The equilibrium (`[V]`, m) of the reference shell of `setup`, from the pose `start` (`[V]`, m)
/// on: best the base surface on the same mesh (appendix F.4).
///
/// # Errors
/// As [`super::solve_base`].
pub fn solve_reference(
    setup: &Setup<'_>,
    start: &[Vec3],
    options: &ReferenceOptions,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, ReferenceReport)> {
    let begun = Instant::now();
    setup.check()?;
    let disturbed = disturb(setup, start, options);
    let (begin, resolved_faces) = prepare(setup, &disturbed)?;
    let bending = Bending::MidEdge(MidEdgeBending::new(
        &setup.sheet.topology,
        &setup.sheet.rest,
        &setup.sheet.material,
    ));
    let criteria = StopCriteria {
        stage: "shell",
        iteration_limit: options.iteration_limit,
        tolerance: options.tolerance,
        escape_saddles: true,
    };
    let stiffness = Stiffness { compression: 1.0, bending };
    let solution = equilibrate(setup, &begin, stiffness, &criteria, observer)?;
    let report = ReferenceReport {
        iterations: solution.iterations,
        ending: solution.ending,
        energy_joule: solution.energy_joule,
        gradient_newton: solution.gradient_newton,
        residual: solution.residual,
        resolved_faces,
        seconds: begun.elapsed().as_secs_f64(),
    };
    Ok((solution.pose, report))
}

/// `start` with every vertex moved along its normal by a seeded random length.
fn disturb(setup: &Setup<'_>, start: &[Vec3], options: &ReferenceOptions) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); start.len()];
    for face in &setup.sheet.topology.faces {
        let [a, b, c] = face.map(|v| start[v]);
        for &v in face {
            normals[v] += (b - a).cross(&(c - a));
        }
    }
    let mut random = Random(options.seed);
    let move_by = |(p, normal): (&Vec3, &Vec3)| {
        p + normal.try_normalize(0.0).unwrap_or_default()
            * (options.imperfection_m * (2.0 * random.unit() - 1.0))
    };
    start.iter().zip(&normals).map(move_by).collect()
}
