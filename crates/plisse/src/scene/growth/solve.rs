//! Growth of a scene, in either mode: from the built scene to the grown one.

use super::build::BuiltGrowth;
use super::count::FoldCount;
use crate::growth::adapt::MeshStage;
use crate::growth::reference::{LevelReport, ReferenceReport, grow_by_forces_each};
use crate::growth::{
    AdaptOptions, GrownSurface, GrowthReport, LoadSteps, StepReport, follow_adapting, follow_each,
};
use crate::io::staged::OutputFolder;
use crate::io::{glb, obj};
use crate::linalg::newton::Ending;
use crate::mesh::crossing::crossing_pairs;
use crate::mesh::normals::vertex_normals;
use crate::mesh::{Up, Vec3};
use crate::picture::{CLOTH, Camera};
use crate::progress::Observer;
use crate::relief::offsets_m;
use crate::rest::RestMetric;
use crate::scene::schema::Mode;
use crate::strain::compression_percent;
use crate::{Error, Result};

/// Share of the asked length below which a note says that some is missing.
const SHORT: f64 = 0.97;
/// Height over width below which a surface counts as lying flat.
const LYING: f64 = 0.1;
/// Direction from which a surface that lies flat is seen: azimuth and elevation (degrees). Its
/// folds stand out there.
const LYING_VIEW_DEG: [f64; 2] = [20.0, 45.0];

/// Choices of a run that replace those of its scene.
#[derive(Clone, Debug, Default)]
pub struct GrowOptions {
    /// Mode of growth; none: the scene's.
    pub mode: Option<Mode>,
    /// Steps of growth at least, levels in the reference mode; none: the scene's.
    pub steps: Option<usize>,
}

/// One step of growth, in either mode.
#[derive(Clone, Debug)]
pub struct GrowthStep {
    /// Part of the growth (0 to 1) that was applied.
    pub part: f64,
    /// Iterations.
    pub iterations: usize,
    /// Reason for which they ended.
    pub ending: Ending,
    /// Largest force left on a vertex, in units of [`GrownScene::residual_unit`].
    pub residual: f64,
    /// Energy (J); none in the reference mode, whose forces have no energy.
    pub energy_joule: Option<f64>,
    /// True if the residual is within the tolerance.
    pub at_rest: bool,
}

/// A scene that has grown.
#[derive(Clone, Debug)]
pub struct GrownScene {
    /// The scene, on the mesh on which growth ended.
    pub scene: BuiltGrowth,
    /// Mode in which it grew.
    pub mode: Mode,
    /// `[V]` the pose (m).
    pub pose: Vec<Vec3>,
    /// `[F]` the rest metric that was asked for.
    pub asked: RestMetric,
    /// All steps that were begun.
    pub steps: Vec<GrowthStep>,
    /// Number of steps that were planned.
    pub planned_steps: usize,
    /// The meshes that followed the folds, one after the other; none if the mesh stayed.
    pub meshes: Vec<MeshStage>,
    /// True if the observer cancelled it.
    pub cancelled: bool,
    /// Largest force on a vertex with which growth ends.
    pub tolerance: f64,
    /// Unit of the tolerance and of residuals.
    pub residual_unit: &'static str,
    /// The last residual (N); none in the reference mode, whose forces have no unit.
    pub residual_newton: Option<f64>,
    /// Seconds.
    pub seconds: f64,
}

/// Measures of a scene that has grown.
#[derive(Clone, Debug)]
pub struct GrowthMeasures {
    /// Area (m²) of the starting surface.
    pub area_start_m2: f64,
    /// Area (m²) that was asked for.
    pub area_asked_m2: f64,
    /// Area (m²).
    pub area_m2: f64,
    /// Mean of length over asked length along the growth, over the faces that grow and touch
    /// nothing frozen; none without such faces.
    pub length_reached: Option<f64>,
    /// Vertices that are frozen along some axis.
    pub frozen_vertices: usize,
    /// Lowest offset (m), at most 0.
    pub offset_min_m: f64,
    /// Highest offset (m), at least 0.
    pub offset_max_m: f64,
    /// Pairs of faces that cross each other, told exactly.
    pub self_intersecting_pairs: usize,
    /// Folds in the windows of the scene.
    pub folds: Vec<FoldCount>,
}

/// Values at the vertices of a scene that has grown, for pictures.
#[derive(Clone, Debug)]
pub struct GrowthFields {
    /// `[V]` growth that was asked for (%, of length).
    pub asked_percent: Vec<f64>,
    /// `[V]` offset from the lowest one (mm).
    pub raised_mm: Vec<f64>,
    /// `[V]` growth that is missing (%, of length): the largest compression of a face around.
    pub missing_percent: Vec<f64>,
}

/// Receives each pose (`[V]`, m) that a step led to, and its faces.
pub type EachPose<'a> = &'a mut dyn FnMut(&[Vec3], &[[usize; 3]]) -> Result<()>;

/// Grows `scene`; `each` is called after every step.
///
/// # Errors
/// As [`crate::growth::grow`]; [`Error::Value`] for what the reference mode does not know; those of
/// `each`.
pub fn grow(
    scene: &BuiltGrowth,
    options: &GrowOptions,
    observer: &dyn Observer,
    each: EachPose<'_>,
) -> Result<GrownScene> {
    match options.mode.unwrap_or(scene.mode) {
        Mode::Variational => grow_by_energy(scene, options, observer, each),
        Mode::Reference => grow_by_reference(scene, options, observer, each),
    }
}

impl BuiltGrowth {
    /// Number of steps in which the scene grows with these options.
    pub fn step_count(&self, options: &GrowOptions) -> usize {
        match options.mode.unwrap_or(self.mode) {
            Mode::Variational => self.parts(options.steps).len(),
            Mode::Reference => options.steps.unwrap_or(self.reference.levels),
        }
    }
}

fn grow_by_energy(
    scene: &BuiltGrowth,
    options: &GrowOptions,
    observer: &dyn Observer,
    each: EachPose<'_>,
) -> Result<GrownScene> {
    let parts = scene.parts(options.steps);
    let steps = LoadSteps { parts: &parts, options: &scene.options };
    let grown = match &scene.adapt {
        Some(adapt) => grow_on_adapted_mesh(scene, &steps, adapt, observer, each)?,
        None => {
            let (surface, faces) = (scene.surface(), &scene.built.sheet.topology.faces);
            let mut each = |_: &StepReport, pose: &[Vec3]| each(pose, faces);
            let (pose, report) =
                follow_each(&surface, &surface.start, &steps, observer, &mut each)?;
            OnMesh { scene: scene.clone(), pose, report, meshes: Vec::new() }
        }
    };
    let OnMesh { scene: grown_scene, pose, report, meshes } = grown;
    let tolerance = scene.options.tolerance;
    let step = |step: &StepReport| GrowthStep {
        part: step.part,
        iterations: step.iterations,
        ending: step.ending,
        residual: step.residual,
        energy_joule: Some(step.energy_joule),
        at_rest: step.ending == Ending::Converged || step.residual <= tolerance,
    };
    let last = report.steps.last();
    Ok(GrownScene {
        scene: grown_scene,
        mode: Mode::Variational,
        pose,
        steps: report.steps.iter().map(step).collect(),
        planned_steps: parts.len(),
        meshes,
        cancelled: last.is_some_and(|step| step.ending == Ending::Cancelled),
        tolerance,
        residual_unit: "of the force that starts folds on an edge",
        residual_newton: Some(last.map_or(0.0, |step| step.residual_newton)),
        seconds: report.seconds,
        asked: report.asked,
    })
}

/// A scene on the mesh on which growth ended.
struct OnMesh {
    scene: BuiltGrowth,
    pose: Vec<Vec3>,
    report: GrowthReport,
    meshes: Vec<MeshStage>,
}

fn grow_on_adapted_mesh(
    scene: &BuiltGrowth,
    steps: &LoadSteps<'_>,
    adapt: &AdaptOptions,
    observer: &dyn Observer,
    each: EachPose<'_>,
) -> Result<OnMesh> {
    let start = GrownSurface::new(scene.surface(), scene.chart());
    let mut each = |_: &StepReport, on: &GrownSurface| each(&on.pose, &on.surface.topology.faces);
    let (grown, report) = follow_adapting(start, steps, adapt, observer, &mut each)?;
    let (scene, pose, asked) = scene.on(grown)?;
    let growth = GrowthReport { asked, ..report.growth };
    Ok(OnMesh { scene, pose, report: growth, meshes: report.meshes })
}

fn grow_by_reference(
    scene: &BuiltGrowth,
    options: &GrowOptions,
    observer: &dyn Observer,
    each: EachPose<'_>,
) -> Result<GrownScene> {
    if scene.options.plasticity > 0.0 {
        return Err(Error::value(
            "growth.plasticity",
            "the reference mode forgets no stress; remove this, or use the other mode",
        ));
    }
    if scene.adapt.is_some() {
        return Err(Error::value(
            "growth.remesh",
            "the reference mode keeps its mesh; remove this, or use the other mode",
        ));
    }
    let mut scene = scene.clone();
    scene.reference.levels = options.steps.unwrap_or(scene.reference.levels);
    let faces = &scene.built.sheet.topology.faces;
    let mut each = |_: &LevelReport, pose: &[Vec3]| each(pose, faces);
    let (pose, report) =
        grow_by_forces_each(&scene.surface(), &scene.reference, observer, &mut each)?;
    Ok(GrownScene {
        mode: Mode::Reference,
        pose,
        steps: reference_steps(&report),
        planned_steps: scene.reference.levels,
        meshes: Vec::new(),
        cancelled: report.cancelled,
        tolerance: scene.reference.tolerance,
        residual_unit: "of the folding force k_p on a vertex",
        residual_newton: None,
        seconds: report.seconds,
        asked: report.asked,
        scene,
    })
}

/// The levels of the reference mode as steps.
fn reference_steps(report: &ReferenceReport) -> Vec<GrowthStep> {
    let count = report.levels.len();
    let ending = |n: usize, converged: bool| match converged {
        true => Ending::Converged,
        false if report.cancelled && n + 1 == count => Ending::Cancelled,
        false => Ending::IterationLimit,
    };
    let step = |(n, level): (usize, &LevelReport)| GrowthStep {
        part: level.part,
        iterations: level.iterations,
        ending: ending(n, level.converged),
        residual: level.residual,
        energy_joule: None,
        at_rest: level.converged,
    };
    report.levels.iter().enumerate().map(step).collect()
}

impl GrownScene {
    /// `[F]` the faces of the pose.
    pub fn faces(&self) -> &[[usize; 3]] {
        &self.scene.built.sheet.topology.faces
    }

    /// End of the last step; [`Ending::Converged`] without any.
    pub fn ending(&self) -> Ending {
        self.steps.last().map_or(Ending::Converged, |step| step.ending)
    }

    /// Residual of the last step; 0 without any.
    pub fn residual(&self) -> f64 {
        self.steps.last().map_or(0.0, |step| step.residual)
    }

    /// True if the last residual is within the tolerance.
    pub fn at_rest(&self) -> bool {
        self.steps.last().is_none_or(|step| step.at_rest)
    }

    /// Measures the grown surface, and counts its folds.
    ///
    /// # Errors
    /// [`Error::Value`] for a window in which folds cannot be counted.
    pub fn measures(&self) -> Result<GrowthMeasures> {
        let (built, pose) = (&self.scene.built, &self.pose);
        let folds = self.scene.count(pose, &self.asked)?;
        let realised = self.scene.reached(pose, &self.asked);
        let area = |positions: &[Vec3]| -> f64 {
            let of = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).cross(&(c - a)).norm();
            built.sheet.topology.faces.iter().map(|face| of(face.map(|v| positions[v]))).sum()
        };
        let offsets = offsets_m(&built.sheet.topology, &built.start, pose).unwrap_or_default();
        let frozen = self.scene.maps.vertices.iter().filter(|at| at.frozen.contains(&true));
        Ok(GrowthMeasures {
            area_start_m2: area(&built.start),
            area_asked_m2: self.asked.area_m2(),
            area_m2: area(pose),
            length_reached: realised.map(|realised| realised.length),
            frozen_vertices: frozen.count(),
            offset_min_m: offsets.iter().copied().fold(0.0, f64::min),
            offset_max_m: offsets.iter().copied().fold(0.0, f64::max),
            self_intersecting_pairs: crossing_pairs(&built.sheet.topology.faces, pose).len(),
            folds,
        })
    }

    /// Notes for the user on what has grown, in whole sentences.
    pub fn notes(&self, measures: &GrowthMeasures) -> Vec<String> {
        let mut notes = self.scene.built.notes.clone();
        if self.cancelled {
            let part = self.steps.last().map_or(0.0, |step| 100.0 * step.part);
            notes.push(format!(
                "interrupted in step {} of {}: {part:.0} % of the growth was asked for so far, \
                 not all of it",
                self.steps.len(),
                self.planned_steps
            ));
        } else if !self.at_rest() {
            let (residual, tolerance) = (self.residual(), self.tolerance);
            let fix = if self.meshes.is_empty() {
                "growth.iteration_limit or take more steps"
            } else {
                "growth.remesh.finish_iterations"
            };
            notes.push(format!(
                "it ended ({}) with a residual of {residual:.1e}, above {tolerance:.0e}; this is \
                 no equilibrium, raise {fix}",
                self.ending().name()
            ));
        } else if let Some(length) = measures.length_reached.filter(|&length| length < SHORT) {
            notes.push(format!(
                "{:.0} % of the asked length was reached; what is frozen, sticks or \
                 weighs may hold the rest",
                100.0 * length
            ));
        }
        notes
    }

    /// Values at the vertices for pictures.
    ///
    /// # Errors
    /// [`Error::Mesh`] if the starting surface has no normal somewhere.
    pub fn fields(&self) -> Result<GrowthFields> {
        let (topology, start) = (&self.scene.built.sheet.topology, &self.scene.built.start);
        let longer = |factor: f64| 100.0 * (factor - 1.0).max(0.0);
        let at = &self.scene.maps.vertices;
        let asked_percent = at.iter().map(|at| longer(at.growth.principal().0[0])).collect();
        let offset: Vec<f64> =
            offsets_m(topology, start, &self.pose)?.into_iter().map(|w| 1e3 * w).collect();
        let low = offset.iter().copied().fold(f64::INFINITY, f64::min);
        let missing_percent = compression_percent(topology, &self.asked, &self.pose);
        let raised_mm = offset.iter().map(|w| w - low).collect();
        Ok(GrowthFields { asked_percent, raised_mm, missing_percent })
    }

    /// View of the pose: a surface that lies flat is seen from the side, so that its folds stand
    /// out; all else from where it shows best.
    pub fn camera(&self) -> Camera {
        let start = &self.scene.built.start;
        let (low, high) =
            start.iter().fold((start[0], start[0]), |(low, high), p| (low.inf(p), high.sup(p)));
        let size = high - low;
        if size.z < LYING * size.x.min(size.y) {
            Camera::fit(&self.pose, Up::Z, LYING_VIEW_DEG[0], LYING_VIEW_DEG[1])
        } else {
            Camera::automatic(&self.pose, Up::Z)
        }
    }

    /// Writes folded.obj and folded.glb.
    ///
    /// # Errors
    /// As [`OutputFolder::write`].
    pub fn write(&self, folder: &mut OutputFolder) -> Result<()> {
        let (texture, faces) = (self.scene.built.texture(), self.faces());
        let texture = texture.as_ref();
        folder.write("folded.obj", |out| obj::write(out, &self.pose, faces, texture))?;
        let normals = vertex_normals(&self.scene.built.sheet.topology, &self.pose);
        let mesh = glb::Mesh { positions: &self.pose, normals: &normals, faces, texture };
        folder.write("folded.glb", |out| glb::write(out, &mesh, CLOTH, Up::Z))
    }
}
