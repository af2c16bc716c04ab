//! report.json of `plisse grow` and its short table on the terminal: the same figures.

use plisse::growth::adapt::MeshStage;
use plisse::scene::GrownScene;
use plisse::scene::growth::{FoldCount, GrowthMeasures, GrowthStep, Mode};
use serde::Serialize;

/// Figures of a run. Field names carry the units.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) plisse: &'static str,
    pub(super) title: String,
    /// The publication that the scene names.
    pub(super) paper: Option<String>,
    /// "variational" or "reference".
    pub(super) mode: &'static str,
    pub(super) vertices: usize,
    pub(super) faces: usize,
    /// Vertices that are frozen along some axis.
    pub(super) frozen_vertices: usize,
    pub(super) area_start_m2: f64,
    pub(super) area_asked_m2: f64,
    pub(super) area_m2: f64,
    /// Mean over the faces that grow and touch nothing frozen, of length over asked length along
    /// the growth; null if there are none.
    pub(super) length_reached: Option<f64>,
    pub(super) steps: Vec<StepSummary>,
    /// End of the last step.
    pub(super) ending: &'static str,
    /// True if the residual is within the tolerance.
    pub(super) converged: bool,
    /// Largest force that is left on a vertex.
    pub(super) residual: f64,
    /// Unit of residual and tolerance.
    pub(super) residual_unit: &'static str,
    /// The same force (N); none in the reference mode, whose forces have no unit.
    pub(super) residual_newton: Option<f64>,
    pub(super) tolerance: f64,
    pub(super) offset_min_m: f64,
    pub(super) offset_max_m: f64,
    /// Pairs of faces that cross each other, told exactly.
    pub(super) self_intersecting_pairs: usize,
    pub(super) folds: Vec<FoldCount>,
    /// The meshes it grew on, if they followed its folds.
    pub(super) meshes: Vec<MeshSummary>,
    pub(super) frames: usize,
    pub(super) notes: Vec<String>,
    pub(super) seconds: Seconds,
}

#[derive(Clone, Serialize)]
pub(super) struct StepSummary {
    /// Part of the growth (0 to 1).
    pub(super) part: f64,
    pub(super) iterations: usize,
    pub(super) ending: &'static str,
    pub(super) residual: f64,
    /// None in the reference mode, whose forces have no energy.
    pub(super) energy_joule: Option<f64>,
}

#[derive(Serialize)]
pub(super) struct MeshSummary {
    /// Edges asked for to a wavelength.
    pub(super) edges_per_wave: f64,
    pub(super) vertices: usize,
    pub(super) splits: usize,
    pub(super) swaps: usize,
    pub(super) collapses: usize,
    pub(super) iterations: usize,
    pub(super) residual: f64,
    pub(super) remesh_seconds: f64,
    pub(super) solve_seconds: f64,
}

impl MeshSummary {
    pub(super) fn new(mesh: &MeshStage) -> Self {
        Self {
            edges_per_wave: mesh.edges_per_wave,
            vertices: mesh.vertices,
            splits: mesh.remesh.splits,
            swaps: mesh.remesh.swaps,
            collapses: mesh.remesh.collapses,
            iterations: mesh.iterations,
            residual: mesh.residual,
            remesh_seconds: mesh.remesh_seconds,
            solve_seconds: mesh.solve_seconds,
        }
    }
}

#[derive(Default, Serialize)]
pub(super) struct Seconds {
    /// Of reading and building the scene.
    pub(super) setup: f64,
    pub(super) grow: f64,
    pub(super) measure: f64,
    pub(super) picture: f64,
    pub(super) files: f64,
    pub(super) total: f64,
}

impl StepSummary {
    fn new(step: &GrowthStep) -> Self {
        Self {
            part: step.part,
            iterations: step.iterations,
            ending: step.ending.name(),
            residual: step.residual,
            energy_joule: step.energy_joule,
        }
    }
}

impl Report {
    pub(super) fn new(grown: &GrownScene, measures: &GrowthMeasures) -> Self {
        let built = &grown.scene.built;
        Self {
            plisse: env!("CARGO_PKG_VERSION"),
            title: built.title.clone(),
            paper: Some(built.paper.clone()).filter(|paper| !paper.is_empty()),
            mode: match grown.mode {
                Mode::Variational => "variational",
                Mode::Reference => "reference",
            },
            vertices: built.sheet.topology.vertex_count,
            faces: built.sheet.topology.face_count(),
            frozen_vertices: measures.frozen_vertices,
            area_start_m2: measures.area_start_m2,
            area_asked_m2: measures.area_asked_m2,
            area_m2: measures.area_m2,
            length_reached: measures.length_reached,
            steps: grown.steps.iter().map(StepSummary::new).collect(),
            ending: grown.ending().name(),
            converged: grown.at_rest(),
            residual: grown.residual(),
            residual_unit: grown.residual_unit,
            residual_newton: grown.residual_newton,
            tolerance: grown.tolerance,
            offset_min_m: measures.offset_min_m,
            offset_max_m: measures.offset_max_m,
            self_intersecting_pairs: measures.self_intersecting_pairs,
            folds: measures.folds.clone(),
            meshes: grown.meshes.iter().map(MeshSummary::new).collect(),
            frames: 0,
            notes: Vec::new(),
            seconds: Seconds::default(),
        }
    }

    /// The table for the terminal, one figure a line.
    pub(super) fn table(&self) -> String {
        let mut table = format!("{}\n", self.title);
        let mut row = |name: &str, value: String| table += &format!("  {name:<24} {value}\n");
        if let Some(paper) = &self.paper {
            row("published", paper.clone());
        }
        row(
            "mesh",
            format!(
                "{} vertices, {} faces, {} vertices frozen",
                self.vertices, self.faces, self.frozen_vertices
            ),
        );
        let iterations: usize = self.steps.iter().map(|step| step.iterations).sum();
        let residual = self.residual;
        let (mode, steps, ending) = (self.mode, self.steps.len(), self.ending);
        row(
            "growth",
            format!(
                "{mode}, {steps} steps, {iterations} iterations, {ending}, residual {residual:.1e}"
            ),
        );
        if let [first, .., last] = &self.meshes[..] {
            let most = self.meshes.iter().map(|mesh| mesh.vertices).max().unwrap_or(0);
            row(
                "remeshing",
                format!(
                    "{} meshes, from {} vertices, {most} at most, to {}",
                    self.meshes.len(),
                    first.vertices,
                    last.vertices
                ),
            );
        }
        let reached = self.area_m2 / self.area_asked_m2;
        let (start, asked, area) = (self.area_start_m2, self.area_asked_m2, self.area_m2);
        row(
            "area",
            format!("from {start:.4e} to {area:.4e} of {asked:.4e} m² ({:.1} %)", 100.0 * reached),
        );
        if let Some(length) = self.length_reached {
            row(
                "length",
                format!("{:.1} % of what was asked, where nothing is frozen", 100.0 * length),
            );
        }
        row("offset", format!("from {:.4e} to {:.4e} m", self.offset_min_m, self.offset_max_m));
        row("crossing", format!("{} pairs of faces", self.self_intersecting_pairs));
        for count in &self.folds {
            row(
                &count.name,
                match (count.folds, count.wavelength_m, count.peak_width) {
                    (Some(folds), Some(wavelength), Some(width)) => format!(
                        "{folds:.1} folds, {wavelength:.4e} m apart ({:.4e} m asked), peak {:.0} % \
                         wide, crests straight on {:.0} %, length {:.1} %",
                        count.asked_wavelength_m,
                        100.0 * width,
                        100.0 * count.crests_within_10_deg,
                        100.0 * count.length_reached
                    ),
                    _ => "nothing folds".to_owned(),
                },
            );
        }
        let s = &self.seconds;
        row(
            "seconds",
            format!(
                "setup {:.3}, grow {:.3}, picture {:.3}, files {:.3}, total {:.3}",
                s.setup, s.grow, s.picture, s.files, s.total
            ),
        );
        for note in &self.notes {
            table += &format!("  note: {note}\n");
        }
        table
    }
}
