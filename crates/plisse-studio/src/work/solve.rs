//! The solve of a scene in the background: base surface, wrinkle field, fine surface.
//!
//! To show poses on the way, the base solve runs in ever longer bouts, each from the pose of the
//! last. That leads to the same equilibrium, but not to the same bits as one run; the files of
//! [`super::scene_files`] come from one run, as in `plisse solve`.

use std::sync::Arc;

use plisse::Result;
use plisse::field::WrinkleField;
use plisse::linalg::Ending;
use plisse::mesh::{Topology, Vec3};
use plisse::progress::Observer;
use plisse::scene::{BuiltScene, SolvedScene, solve_field};
use plisse::shell::{BaseOptions, solve_base};
use plisse::strain::strain;
use plisse::surface::levels_within;
use plisse::wrinkles::WrinkledSurface;
use plisse_live::field::{Waves, from_field};
use plisse_live::render::Corner;
use plisse_live::skin::PosedVertices;
use plisse_live::weld::{WeldedMesh, vertex_normals};
use plisse_live::{Vec2, Vec3 as Seen};

use super::job::Reporter;
use crate::document::subject::shown;
use crate::view::Solid;

/// Iterations of the first bout of the base solve.
const FIRST_BOUT: usize = 6;
/// Most faces of a fine surface that is only shown.
const MOST_FACES: usize = 150_000;

/// A part of the result of a solve.
#[derive(Clone)]
pub enum Part {
    /// A pose on the way, to show, and its `[V]` positions (m).
    Pose(Arc<Solid>, Arc<Vec<Vec3>>),
    /// The complete result.
    Whole(Arc<Solid>, Arc<SolvedScene>),
}

/// Solves `built`, from the pose `start` (`[V]`, m) if there is one.
///
/// # Errors
/// As [`solve_base`] and [`solve_field`].
pub fn run(
    built: &Arc<BuiltScene>,
    start: Option<&[Vec3]>,
    reporter: &Reporter<Part>,
) -> Result<Part> {
    reporter.stage("base surface", Some(0.0));
    let mut pose = start.map_or_else(|| built.start.clone(), <[Vec3]>::to_vec);
    let (mut bout, mut spent, mut seconds) = (FIRST_BOUT, 0, 0.0);
    let base = loop {
        let limit = bout.min(built.base_options.iteration_limit.saturating_sub(spent)).max(1);
        let options = BaseOptions { iteration_limit: limit, ..built.base_options.clone() };
        let (next, mut report) = solve_base(&built.setup(), &pose, &options, reporter)?;
        (pose, spent) = (next, spent + report.iterations);
        seconds += report.seconds;
        (report.iterations, report.seconds) = (spent, seconds);
        let ended =
            report.ending != Ending::IterationLimit || spent >= built.base_options.iteration_limit;
        reporter.part(Part::Pose(Arc::new(look(built, &pose, None, None)), Arc::new(pose.clone())));
        if ended {
            break report;
        }
        bout *= 2;
    };
    reporter.stage("wrinkle field", Some(0.5));
    let solved = solve_field(Arc::clone(built), pose, base, reporter)?;
    reporter.stage("fine surface", Some(0.9));
    let posed = solved.posed_field();
    let levels = if reporter.cancelled() {
        0
    } else {
        posed.levels().min(levels_within(&built.sheet.topology, MOST_FACES))
    };
    let surface = posed.surface(levels);
    let solid = look(built, &solved.pose, Some(&solved.field), Some(&surface));
    Ok(Part::Whole(Arc::new(solid), Arc::new(solved)))
}

/// The surface to show for a pose, with its field and its fine surface, as far as they are known.
fn look(
    built: &BuiltScene,
    pose: &[Vec3],
    field: Option<&WrinkleField>,
    surface: Option<&WrinkledSurface>,
) -> Solid {
    let posed = seen(pose, &built.sheet.topology);
    let waves = field.map_or_else(
        || Waves {
            amplitude_m: vec![0.0; pose.len()],
            wave: vec![Seen::zeros(); pose.len()],
            phase: vec![0.0; pose.len()],
        },
        |field| from_field(&built.sheet.topology, &posed, field),
    );
    let lengths = |e: f64| ((1.0 + e).max(0.0).sqrt() - 1.0) as f32;
    let strain = strain(&built.sheet.topology, &built.sheet.rest, pose)
        .iter()
        .map(|s| ordered(s.principal.map(lengths)))
        .collect();
    let fine = surface.map(|surface| {
        let topology = &surface.fine.topology;
        corners(topology, &seen(&surface.positions, topology), None)
    });
    Solid { strain, fine, ..solid(&built.sheet.topology, posed, &waves) }
}

fn ordered([a, b]: [f32; 2]) -> [f32; 2] {
    [a.min(b), a.max(b)]
}

/// The surface to show for a pose with waves; strain and fine surface are empty.
pub(crate) fn solid(topology: &Topology, posed: PosedVertices, waves: &Waves) -> Solid {
    Solid {
        coarse: corners(topology, &posed, Some(waves)),
        fine: None,
        welded: Arc::new(welded(topology, &posed)),
        posed: Arc::new(posed),
        amplitude_m: waves.amplitude_m.clone(),
        wave: waves.wave.clone(),
        strain: Vec::new(),
    }
}

/// `pose` in the window's axes, with normals.
pub(crate) fn seen(pose: &[Vec3], topology: &Topology) -> PosedVertices {
    let positions: Vec<Seen> = pose.iter().map(shown).collect();
    let faces: Vec<[u32; 3]> = topology.faces.iter().map(|f| f.map(|v| v as u32)).collect();
    let normals = vertex_normals(&positions, &faces);
    PosedVertices { positions, normals }
}

fn corners(topology: &Topology, posed: &PosedVertices, waves: Option<&Waves>) -> Vec<[Corner; 3]> {
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

/// The mesh of a surface to show.
fn welded(topology: &Topology, posed: &PosedVertices) -> WeldedMesh {
    let model = plisse_live::model::Model::rigid(
        "",
        posed.positions.clone(),
        Vec::new(),
        topology.faces.iter().map(|f| f.map(|v| v as u32)).collect(),
    );
    crate::document::subject::one_to_one(&model)
}
