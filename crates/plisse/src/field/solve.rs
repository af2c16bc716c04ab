//! From strain to wrinkles: the whole field solve.

use web_time::Instant;

use super::WrinkleField;
use super::closed_forms::ClosedForms;
use super::closest_closed_form::ClosestClosedForm;
use super::curvature::second_forms;
use super::density::{Density, EnergyTerms, Local, Terms, energy_terms};
use super::domain::Domain;
use super::initialise::{Unrounded, compression, first_guess, first_wavelength_m};
use super::phase_unknowns::one_form;
use super::problem::FieldProblem;
use super::wrinkle_free::WrinkleFreeRule;
use crate::linalg::newton::{Options, minimise};
use crate::linalg::{Ending, PsdProjection};
use crate::mesh::{Mat3, Topology, Vec3};
use crate::progress::Observer;
use crate::rest::RestMetric;
use crate::sheet::Sheet;
use crate::strain::FaceStrain;
use crate::{Error, Result};

/// The solve ends with a Newton step that was to lower the energy by less than this share of what
/// the wrinkled faces hold before they wrinkle.
const PREDICTED_DECREASE_TOLERANCE: f64 = 1e-13;

/// Options of the field solve.
#[derive(Clone, Debug)]
pub struct FieldOptions {
    /// Rule by which wrinkle-free faces are found.
    pub rule: WrinkleFreeRule,
    /// Terms of the energy that take part.
    pub terms: Terms,
    /// True if ω may be unclosed on wrinkle-free faces (section 5.1). If not, no face is
    /// wrinkle-free, for ablation.
    pub relaxed_integrability: bool,
    /// Rings of vertices that curvature is fitted to.
    pub curvature_rings: usize,
    /// Projection of indefinite element Hessians, until the true Hessian takes over.
    pub psd_projection: PsdProjection,
    /// Largest component of the projected gradient at which the solve ends, in the problem's own
    /// units; it ends, too, with a step by which next to nothing is to be gained (10⁻¹³ of the
    /// energy).
    pub tolerance: f64,
    /// Newton iterations at most.
    pub iteration_limit: usize,
}

impl Default for FieldOptions {
    fn default() -> Self {
        Self {
            rule: WrinkleFreeRule::Paper,
            terms: Terms::default(),
            relaxed_integrability: true,
            curvature_rings: 5,
            psd_projection: PsdProjection::Abs,
            tolerance: 1e-12,
            iteration_limit: 1000,
        }
    }
}

impl FieldOptions {
    /// Name of relaxed integrability for [`FieldOptions::without`].
    pub const RELAXED_INTEGRABILITY: &'static str = "relaxed-integrability";

    /// These options without the term ([`Terms::NAMES`]) or correction called `name`, for ablation.
    ///
    /// # Errors
    /// [`Error::Value`] about "without" if there is none of that name.
    pub fn without(self, name: &str) -> Result<Self> {
        if name == Self::RELAXED_INTEGRABILITY {
            return Ok(Self { relaxed_integrability: false, ..self });
        }
        let unknown = || {
            let (names, last) = (Terms::NAMES.join(", "), Self::RELAXED_INTEGRABILITY);
            let message = format!("there is no term \"{name}\"; the terms are {names}, {last}");
            Error::value("without", message)
        };
        Ok(Self { terms: self.terms.without(name).ok_or_else(unknown)?, ..self })
    }
}

/// The phase's gain around one loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    /// Whole turns after rounding.
    pub turns: i64,
    /// Turns that the energy alone asks for.
    pub before_rounding: f64,
    /// Edges of the loop.
    pub loop_edges: usize,
}

/// Report of a field solve.
#[derive(Clone, Debug)]
pub struct FieldReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Reason why they ended.
    pub ending: Ending,
    /// Energy of the wrinkled faces (J), before rounding, without the constant bending of the base
    /// surface.
    pub energy_joule: f64,
    /// The same by terms.
    pub energy_terms: EnergyTerms,
    /// Stretching of the wrinkle-free faces (J).
    pub wrinkle_free_energy_joule: f64,
    /// Largest component of the projected gradient (J/m for amplitudes, J/rad for phases).
    pub projected_gradient: f64,
    /// `[b₁]` periods, the largest first.
    pub periods: Vec<Period>,
    /// True if the integers are proven to be the best.
    pub rounding_exact: bool,
    /// Seconds of everything before rounding.
    pub field_seconds: f64,
    /// Seconds of rounding.
    pub phase_seconds: f64,
}

/// A wrinkle field and the report of its solve.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The field.
    pub field: WrinkleField,
    /// Report of the solve.
    pub report: FieldReport,
}

/// The wrinkle field of least energy over a pose (`[V]`, m), with zero amplitude at the `held`
/// vertices (`[V]`; clamped ones).
///
/// ```
/// use plisse::field::{FieldOptions, solve};
/// use plisse::progress::Silent;
/// # use plisse::{Material, Sheet};
/// # use plisse::mesh::Vec3;
/// # // A strip of 20 × 4 squares of 1 cm, pressed together by 2 % along x.
/// # let at = |v: usize| Vec3::new(0.01 * (v % 21) as f64, 0.01 * (v / 21) as f64, 0.0);
/// # let rest: Vec<Vec3> = (0..105).map(at).collect();
/// # let squares = (0..84).filter(|v| v % 21 != 20);
/// # let faces: Vec<[usize; 3]> =
/// #     squares.flat_map(|v| [[v, v + 1, v + 22], [v, v + 22, v + 21]]).collect();
/// # let pose: Vec<Vec3> = rest.iter().map(|p| Vec3::new(0.98 * p.x, p.y, 0.0)).collect();
/// # let sheet = Sheet::from_rest(rest, faces, Material::new(1e6, 0.3, 1e-4)?)?;
/// let held = vec![false; pose.len()];
/// let solved = solve(&sheet, &pose, &held, &FieldOptions::default(), &Silent)?;
/// // Waves along x take up the 2 % that the pose is shorter.
/// assert!(solved.field.largest_amplitude_m() > 1e-4);
/// println!("{} iterations, {:e} J", solved.report.iterations, solved.report.energy_joule);
/// # Ok::<(), plisse::Error>(())
/// ```
///
/// # Errors
/// [`Error::Value`] if there is not one entry of `held` and `pose` for each vertex;
/// [`Error::Setup`] if the sheet is not thin; [`Error::Numeric`] if the energy is not finite
/// (absurd material or pose).
pub fn solve(
    sheet: &Sheet,
    pose: &[Vec3],
    held: &[bool],
    options: &FieldOptions,
    observer: &dyn Observer,
) -> Result<Solved> {
    let Sheet { topology, rest, material, .. } = sheet;
    if held.len() != topology.vertex_count || pose.len() != topology.vertex_count {
        return Err(Error::value(
            "positions",
            format!(
                "give one position and one clamp flag for each of the {} vertices",
                topology.vertex_count
            ),
        ));
    }
    material.check_thin(rest.area_m2())?;
    let begun = Instant::now();
    let strain = sheet.strain(pose);
    let domain = Domain::new(topology, &strain, held, options);
    let curvature = second_forms(topology, pose, options.curvature_rings);
    let densities: Vec<Density> = (0..topology.face_count())
        .map(|f| Density::new(&rest.faces[f], &strain[f], &curvature[f], material, &options.terms))
        .collect();
    let wrinkle_free_energy_joule = (0..topology.face_count())
        .filter(|&f| domain.wrinkle_free[f])
        .fold(0.0, |sum, f| sum + densities[f].energy(&Local::zeros()));

    let wavelength_m = first_wavelength_m(material, pose);
    let everywhere = vec![wavelength_m; topology.face_count()];
    let guess = first_guess(sheet, pose, &strain, &domain, &everywhere)?;
    let (amplitude_unit_m, energy_unit_joule) =
        units(rest, &strain, &domain.wrinkle_free, &densities, wavelength_m);
    let mut problem =
        FieldProblem::new(topology, &domain, &densities, amplitude_unit_m, energy_unit_joule);
    let mut start = problem.pack(&guess);
    problem.rescale(&mut start);
    let newton = Options {
        iteration_limit: options.iteration_limit,
        tolerance: options.tolerance,
        predicted_decrease_tolerance: PREDICTED_DECREASE_TOLERANCE,
        psd_projection: options.psd_projection,
        ridge: 1e-13,
        ..Options::new("field", energy_unit_joule)
    };
    let outcome = minimise(&mut problem, &start, &newton, observer)?;
    if !outcome.energy.is_finite() {
        return Err(Error::numeric(
            "field",
            "the energy is not a finite number; check the material's constants and the pose's size",
        ));
    }
    let unrounded = problem.unpack(&outcome.x);
    let projected_gradient = problem.projected_gradient_si(&outcome.x, &outcome.gradient);
    let field_seconds = begun.elapsed().as_secs_f64();

    let begun = Instant::now();
    let Phased { field, periods, rounding_exact } = with_phase(sheet, &domain, unrounded)?;
    let energy_terms = sum_of_terms(sheet, &strain, &curvature, &options.terms, &field);
    let report = FieldReport {
        iterations: outcome.iterations,
        ending: outcome.ending,
        // The sum over no faces is −0.
        energy_joule: outcome.energy * energy_unit_joule + 0.0,
        energy_terms,
        wrinkle_free_energy_joule,
        projected_gradient,
        periods,
        rounding_exact,
        field_seconds,
        phase_seconds: begun.elapsed().as_secs_f64(),
    };
    Ok(Solved { field, report })
}

/// Energy of `field` on a pose (`[V]`, m) by terms: of its wrinkled faces, without
/// the constant bending of the base surface.
pub fn energy(
    sheet: &Sheet,
    pose: &[Vec3],
    options: &FieldOptions,
    field: &WrinkleField,
) -> EnergyTerms {
    let curvature = second_forms(&sheet.topology, pose, options.curvature_rings);
    sum_of_terms(sheet, &sheet.strain(pose), &curvature, &options.terms, field)
}

fn sum_of_terms(
    sheet: &Sheet,
    strain: &[FaceStrain],
    curvature: &[Mat3],
    terms: &Terms,
    field: &WrinkleField,
) -> EnergyTerms {
    let Sheet { topology, rest, material, .. } = sheet;
    let mut sum = EnergyTerms::default();
    for f in (0..topology.face_count()).filter(|&f| !field.wrinkle_free[f]) {
        let local = local_unknowns(topology, field, f);
        let density = |terms: &Terms| {
            Density::new(&rest.faces[f], &strain[f], &curvature[f], material, terms)
        };
        let part = energy_terms(density, terms, &local);
        sum.stretching_joule += part.stretching_joule;
        sum.curvature_joule += part.curvature_joule;
        sum.mixed_joule += part.mixed_joule;
        sum.amplitude_gradient_joule += part.amplitude_gradient_joule;
        sum.bending_joule += part.bending_joule;
    }
    sum
}

/// A field whose phase gains whole turns around every loop.
pub(super) struct Phased {
    pub(super) field: WrinkleField,
    /// `[b₁]` the largest first.
    pub(super) periods: Vec<Period>,
    pub(super) rounding_exact: bool,
}

/// The field whose ω is that of `unrounded` and whose phase is rounded to whole turns.
pub(super) fn with_phase(sheet: &Sheet, domain: &Domain, unrounded: Unrounded) -> Result<Phased> {
    let Sheet { topology, rest, .. } = sheet;
    let Domain { wrinkle_free, forms, .. } = domain;
    let Unrounded { amplitude_m, phases, coefficients } = unrounded;
    let omega = one_form(topology, forms, &phases, &coefficients);
    let weight: Vec<f64> = wrinkle_free.iter().map(|&free| if free { 0.0 } else { 1.0 }).collect();
    let rounded = ClosestClosedForm::new(topology, rest, forms, &weight)?
        .with_whole_periods(&phases, &coefficients);
    let phase = corner_phases(topology, forms, wrinkle_free, &rounded.phases, &rounded.turns);
    let mut periods: Vec<Period> = (0..coefficients.len())
        .map(|k| Period {
            turns: rounded.turns[k].abs(),
            before_rounding: coefficients[k].abs() / std::f64::consts::TAU,
            loop_edges: forms.loop_lengths[k],
        })
        .collect();
    periods.sort_by(|p, q| {
        q.turns.cmp(&p.turns).then(q.before_rounding.total_cmp(&p.before_rounding))
    });
    let field = WrinkleField { amplitude_m, omega, phase, wrinkle_free: wrinkle_free.to_vec() };
    Ok(Phased { field, periods, rounding_exact: rounded.exact })
}

/// Unknowns of face `f` in the order of [`Local`].
fn local_unknowns(topology: &Topology, field: &WrinkleField, f: usize) -> Local {
    let [i, j, k] = topology.faces[f];
    Local::from([
        field.amplitude_m[i],
        field.amplitude_m[j],
        field.amplitude_m[k],
        topology.side_sign(f, 0) * field.omega[topology.face_edges[f][0]],
        -topology.side_sign(f, 2) * field.omega[topology.face_edges[f][2]],
    ])
}

/// Metres in a unit of amplitude and joules in a unit of energy: the root mean square of the first
/// guess, and what the wrinkled faces hold before they wrinkle.
fn units(
    rest: &RestMetric,
    strain: &[FaceStrain],
    wrinkle_free: &[bool],
    densities: &[Density],
    wavelength_m: f64,
) -> (f64, f64) {
    let (mut area, mut squares, mut energy) = (0.0, 0.0, 0.0);
    for f in (0..strain.len()).filter(|&f| !wrinkle_free[f]) {
        area += rest.faces[f].area_m2;
        squares += rest.faces[f].area_m2 * 2.0 * compression(&strain[f]);
        energy += densities[f].energy(&Local::zeros());
    }
    let k = wavelength_m / std::f64::consts::TAU;
    let amplitude = k * (squares / area).sqrt();
    (if amplitude > 0.0 { amplitude } else { k }, if energy > 0.0 { energy } else { 1.0 })
}

/// `[F][3]` phase at each corner: the vertex's phase plus whole turns.
fn corner_phases(
    topology: &Topology,
    forms: &ClosedForms,
    wrinkle_free: &[bool],
    phases: &[f64],
    turns: &[i64],
) -> Vec<[f64; 3]> {
    let whole = |e: usize| {
        forms.on_edge[e].iter().map(|&(k, value)| turns[k] * i64::from(value)).sum::<i64>()
    };
    topology
        .faces
        .iter()
        .enumerate()
        .map(|(f, face)| {
            if wrinkle_free[f] {
                return [0.0; 3];
            }
            let at_1 = topology.side_sign(f, 0) as i64 * whole(topology.face_edges[f][0]);
            let at_2 = -topology.side_sign(f, 2) as i64 * whole(topology.face_edges[f][2]);
            let turn = |m: i64| std::f64::consts::TAU * m as f64;
            [phases[face[0]], phases[face[1]] + turn(at_1), phases[face[2]] + turn(at_2)]
        })
        .collect()
}
