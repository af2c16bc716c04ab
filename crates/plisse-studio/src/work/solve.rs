//! A scene solved in the background, by the library's own road: base surface, wrinkle field, fine surface.
//!
//! To show something on the way, the base solve runs in bouts, each from where the last one ended, ever longer ones. That leads to the same
//! equilibrium but not to the same bits as one run; the files of [`super::scene_files`] come from one run, as `plisse solve` makes it.

use std::sync::Arc;

use plisse::Result;
use plisse::field::{FieldReport, WrinkleField, curvature, solve};
use plisse::linalg::newton::Ending;
use plisse::mesh::{Topology, Vec3};
use plisse::progress::Observer;
use plisse::scene::{Built, MOST_LEVELS, Measured, measure};
use plisse::shell::{BaseOptions, BaseReport, solve_base};
use plisse::strain::strain;
use plisse::surface::{Displacement, Upsampled, displace, keep_out, suggest_levels, upsample};
use plisse_live::field::{Waves, from_field};
use plisse_live::render::Corner;
use plisse_live::skin::Skinned;
use plisse_live::unify::{Unified, vertex_normals};
use plisse_live::{Vec2, Vec3 as Seen};

use super::job::Reporter;
use crate::document::subject::shown;
use crate::view::Solid;

/// Iterations of the first bout of the base solve.
const FIRST_BOUT: usize = 6;
/// Contact thicknesses that wrinkles stay off bodies, as `plisse solve` has it.
pub(crate) const CLEARANCE: f64 = 0.25;
/// Most faces of a fine surface that is only looked at.
const MOST_FACES: usize = 150_000;

/// A solved scene.
#[derive(Clone, Debug)]
pub struct SolvedScene {
    /// The scene.
    pub built: Arc<Built>,
    /// `[V]` base surface (m).
    pub pose: Vec<Vec3>,
    /// How the base solve went.
    pub base: BaseReport,
    /// Its wrinkles.
    pub field: WrinkleField,
    /// How the field's solve went.
    pub report: FieldReport,
    /// The divided surface.
    pub fine: Upsampled,
    /// Its wrinkled places (m).
    pub wrinkled: Vec<Vec3>,
    /// What the scene asks to measure.
    pub measures: Vec<Measured>,
}

/// What a solve hands over.
#[derive(Clone)]
pub enum Part {
    /// A pose on the way, to look at, and `[V]` its places (m).
    Pose(Arc<Solid>, Arc<Vec<Vec3>>),
    /// The end.
    Whole(Arc<Solid>, Arc<SolvedScene>),
}

/// Solves `built`, from `start` (`[V]`, m) on if it was solved before.
///
/// # Errors
/// As [`solve_base`] and [`solve`].
pub fn run(built: &Arc<Built>, start: Option<&[Vec3]>, reporter: &Reporter<Part>) -> Result<Part> {
    reporter.stage("base surface", Some(0.0));
    let mut pose = start.map_or_else(|| built.start.clone(), <[Vec3]>::to_vec);
    let (mut bout, mut spent, mut seconds) = (FIRST_BOUT, 0, 0.0);
    let base = loop {
        let limit = bout.min(built.base.iteration_limit.saturating_sub(spent)).max(1);
        let options = BaseOptions { iteration_limit: limit, ..built.base.clone() };
        let (next, mut report) = solve_base(&built.setup(), &pose, &options, reporter)?;
        (pose, spent) = (next, spent + report.iterations);
        seconds += report.seconds;
        (report.iterations, report.seconds) = (spent, seconds);
        let ended = report.ending != Ending::IterationLimit || spent >= built.base.iteration_limit;
        reporter.part(Part::Pose(Arc::new(look(built, &pose, None, None)), Arc::new(pose.clone())));
        if ended {
            break report;
        }
        bout *= 2;
    };
    reporter.stage("wrinkle field", Some(0.5));
    let solved = solve(&built.topology, &built.rest, &pose, &built.clamps.held(), &built.material, &built.field, reporter)?;
    reporter.stage("fine surface", Some(0.9));
    let wavelength_m = median_wavelength_m(built, &solved.field);
    let most = (0..=6).take_while(|&l| built.topology.face_count() * 4usize.pow(l) <= MOST_FACES).last().unwrap_or(0) as usize;
    let levels = built.levels.unwrap_or_else(|| suggest_levels(&built.topology, &built.rest, wavelength_m)).min(most);
    let levels = if reporter.cancelled() { 0 } else { levels };
    let (fine, wrinkled) = fine_surface(built, &pose, &solved.field, levels);
    let solid = look(built, &pose, Some(&solved.field), Some((&fine, &wrinkled)));
    let measures = measure(built, &solved.field, &solved.report);
    let scene = SolvedScene { built: Arc::clone(built), pose, base, field: solved.field, report: solved.report, fine, wrinkled, measures };
    Ok(Part::Whole(Arc::new(solid), Arc::new(scene)))
}

/// Most faces of a fine surface in files, as `plisse solve` has it.
const FACE_LIMIT: usize = 20_000_000;

/// Subdivisions of the surface that `plisse solve` writes: the scene's, else those that the wavelength asks for.
pub(crate) fn levels_in_files(built: &Built, field: &WrinkleField) -> usize {
    let topology = &built.topology;
    let faces = |levels: usize| topology.face_count().saturating_mul(4_usize.pow(levels as u32));
    let most = (1..=MOST_LEVELS).take_while(|&levels| faces(levels) <= FACE_LIMIT).last().unwrap_or(0);
    built.levels.unwrap_or_else(|| suggest_levels(topology, &built.rest, median_wavelength_m(built, field)).min(most))
}

/// The divided base surface and its wrinkled places.
pub(crate) fn fine_surface(built: &Built, pose: &[Vec3], field: &WrinkleField, levels: usize) -> (Upsampled, Vec<Vec3>) {
    let mut fine = upsample(&built.topology, pose, field, &built.rest_positions, &built.rest_faces, levels);
    let forms = built.v1.then(|| curvature::second_forms(&built.topology, pose, built.field.curvature_rings));
    let how = Displacement { v2: built.v2, v1: forms.as_deref().map(|forms| (forms, &built.material)) };
    let mut wrinkled = displace(&fine, &how);
    for positions in [&mut wrinkled, &mut fine.base] {
        keep_out(positions, &built.obstacles, CLEARANCE * built.contact_thickness_m);
    }
    (fine, wrinkled)
}

/// Median wavelength (m) of the wrinkled faces whose amplitude is at least 1 % of the largest, as `plisse solve` reports it.
pub(crate) fn median_wavelength_m(built: &Built, field: &WrinkleField) -> Option<f64> {
    let largest = field.amplitude_m.iter().copied().fold(0.0, f64::max);
    let topology = &built.topology;
    let strong = |f: &usize| {
        let mean = topology.faces[*f].iter().map(|&v| field.amplitude_m[v]).sum::<f64>() / 3.0;
        !field.wrinkle_free[*f] && largest > 0.0 && mean >= 0.01 * largest
    };
    let lengths =
        (0..topology.face_count()).filter(strong).map(|f| std::f64::consts::TAU / field.frequency(topology, &built.rest, f).norm());
    let mut list: Vec<f64> = lengths.filter(|w| w.is_finite()).collect();
    list.sort_by(f64::total_cmp);
    list.get(list.len() / 2).copied()
}

/// What is seen of a pose, its field and its fine surface, as far as they are known.
fn look(built: &Built, pose: &[Vec3], field: Option<&WrinkleField>, fine: Option<(&Upsampled, &Vec<Vec3>)>) -> Solid {
    let posed = seen(pose, &built.topology);
    let waves = field.map_or_else(
        || Waves { amplitude_m: vec![0.0; pose.len()], wave: vec![Seen::zeros(); pose.len()], phase: vec![0.0; pose.len()] },
        |field| from_field(&built.topology, &posed, field),
    );
    let lengths = |e: f64| ((1.0 + e).max(0.0).sqrt() - 1.0) as f32;
    let strain = strain(&built.topology, &built.rest, pose).iter().map(|s| ordered(s.principal.map(lengths))).collect();
    let fine = fine.map(|(fine, wrinkled)| {
        let posed = seen(wrinkled, &fine.topology);
        corners(&fine.topology, &posed, None)
    });
    Solid { strain, fine, ..solid(&built.topology, posed, &waves) }
}

fn ordered([a, b]: [f32; 2]) -> [f32; 2] {
    [a.min(b), a.max(b)]
}

/// A surface with waves, without strain and fine surface.
pub(crate) fn solid(topology: &Topology, posed: Skinned, waves: &Waves) -> Solid {
    Solid {
        coarse: corners(topology, &posed, Some(waves)),
        fine: None,
        unified: Arc::new(unified(topology, &posed)),
        posed: Arc::new(posed),
        amplitude_m: waves.amplitude_m.clone(),
        wave: waves.wave.clone(),
        strain: Vec::new(),
    }
}

/// `pose` as it is shown.
pub(crate) fn seen(pose: &[Vec3], topology: &Topology) -> Skinned {
    let positions: Vec<Seen> = pose.iter().map(shown).collect();
    let faces: Vec<[u32; 3]> = topology.faces.iter().map(|f| f.map(|v| v as u32)).collect();
    let normals = vertex_normals(&positions, &faces);
    Skinned { positions, normals }
}

fn corners(topology: &Topology, posed: &Skinned, waves: Option<&Waves>) -> Vec<[Corner; 3]> {
    let corner = |v: usize| Corner {
        position: posed.positions[v],
        normal: posed.normals[v],
        uv: Vec2::zeros(),
        amplitude_m: waves.map_or(0.0, |w| w.amplitude_m[v]),
        wave: waves.map_or_else(Seen::zeros, |w| w.wave[v]),
        phase: waves.map_or(0.0, |w| w.phase[v]),
    };
    topology.faces.iter().map(|face| face.map(corner)).collect()
}

/// The mesh as marks and depths need it.
fn unified(topology: &Topology, posed: &Skinned) -> Unified {
    let model = plisse_live::model::Model::rigid(
        "",
        posed.positions.clone(),
        Vec::new(),
        topology.faces.iter().map(|f| f.map(|v| v as u32)).collect(),
    );
    crate::document::subject::one_to_one(&model)
}
