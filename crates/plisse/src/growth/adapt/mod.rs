//! Growth on a mesh that becomes as fine as the folds ask for while they grow (4.2 of [Combaz &
//! Neyret 2002]).
//!
//! The pattern is chosen, and grows, on a mesh just fine enough to carry it; only then the mesh is
//! made as fine as the result shall be. Each refinement needs a few iterations, because it begins
//! where the coarser one ended, with new vertices on curves given by the normals
//! ([`MidpointPlacement`]). The maps go with the mesh; the expansion acts on the ungrown rest
//! metric, whatever the mesh.

mod remesh_surface;

pub use remesh_surface::GrownSurface;

use web_time::Instant;

use super::equilibrate::{FilmModel, StopCriteria};
use super::load_stepping::{
    GrowthOptions, GrowthReport, LoadSteps, StepReport, pattern_selection_part,
};
use super::surface::GrowingSurface;
use crate::linalg::Ending;
use crate::progress::Observer;
use crate::remesh::{MidpointPlacement, RemeshOptions, RemeshReport};
use crate::{Error, Result};

/// Growth (factor of length less 1) below which the mesh is left coarse, as in remeshing.
const NO_GROWTH: f64 = 1e-9;
/// Tolerance of a step that others follow, over that of the last one.
const INTERMEDIATE_TOLERANCE: f64 = 30.0;
/// Newton iterations at most of a step that others follow.
const INTERMEDIATE_ITERATIONS: usize = 30;
/// Factor between the edges to a wavelength of successive refinements at the end.
const REFINEMENT: f64 = 2.0;

/// Options of the mesh that follows the folds.
#[derive(Clone, Debug, PartialEq)]
pub struct AdaptOptions {
    /// Edges to a wavelength where it grows, while it does.
    pub edges_per_wave: f64,
    /// The same at the end.
    pub finish_edges_per_wave: f64,
    /// Length (m) of edges where nothing grows.
    pub longest_m: f64,
    /// Number of vertices beyond which none is added.
    pub most_vertices: usize,
    /// Angle (rad) between the normals at an edge's ends above which it should be shorter, down to
    /// a half.
    pub normal_angle: f64,
    /// Placement of new vertices.
    pub midpoints: MidpointPlacement,
    /// Newton iterations at most on each of the finer meshes at the end.
    pub finish_iterations: usize,
}

impl AdaptOptions {
    /// Six edges to a wavelength, eight at the end, `longest_m` (m) where nothing grows.
    pub fn new(longest_m: f64) -> Self {
        Self {
            edges_per_wave: 6.0,
            finish_edges_per_wave: 8.0,
            longest_m,
            most_vertices: 200_000,
            normal_angle: 1.0,
            midpoints: MidpointPlacement::Folds,
            finish_iterations: 20,
        }
    }

    /// Estimated number of vertices of `surface` at the end.
    pub fn vertices(&self, surface: &GrowingSurface) -> f64 {
        let of = |(f, face): (usize, &[usize; 3])| {
            let at = &surface.maps.vertices;
            let grows = |v: usize| at[v].growth.principal().0[0] > 1.0 + NO_GROWTH;
            let fine = face.iter().map(|&v| at[v].wavelength_m).fold(f64::INFINITY, f64::min)
                / self.finish_edges_per_wave;
            let edge = if face.iter().any(|&v| grows(v)) {
                fine.min(self.longest_m)
            } else {
                self.longest_m
            };
            // Two regular triangles to a vertex.
            surface.rest.faces[f].area_m2 / (0.75_f64.sqrt() * edge * edge)
        };
        surface.topology.faces.iter().enumerate().map(of).sum()
    }

    /// Checks that `surface` can grow on a mesh that follows its folds.
    ///
    /// # Errors
    /// [`Error::Value`] for options out of range, for folds too narrow for
    /// [`AdaptOptions::most_vertices`], for plasticity; else as [`GrowingSurface::check`], but
    /// faces may be of any size.
    pub fn check(&self, surface: &GrowingSurface, options: &GrowthOptions) -> Result<()> {
        surface.check_start()?;
        surface.check_maps()?;
        let place = |name: &str| format!("growth.remesh.{name}");
        for (name, edges) in [
            ("edges_per_wave", self.edges_per_wave),
            ("finish_edges_per_wave", self.finish_edges_per_wave),
        ] {
            if !(5.0..=100.0).contains(&edges) {
                return Err(Error::value(
                    place(name),
                    format!(
                        "{edges} edges to a wavelength carry no folds; give a number from 5 to 100"
                    ),
                ));
            }
        }
        if self.finish_edges_per_wave < self.edges_per_wave {
            let message = format!(
                "{} is less than the {} while it grows; give as many or more",
                self.finish_edges_per_wave, self.edges_per_wave
            );
            return Err(Error::value(place("finish_edges_per_wave"), message));
        }
        if !(self.longest_m.is_finite() && self.longest_m > 0.0) {
            return Err(Error::value(
                place("longest_m"),
                format!("{} is no length; give a positive number of metres", self.longest_m),
            ));
        }
        if options.plasticity > 0.0 {
            return Err(Error::value(
                "growth.plasticity",
                "plasticity is kept on edges, which remeshing changes; give one of them only",
            ));
        }
        let need = self.vertices(surface);
        if need > self.most_vertices as f64 {
            Err(self.too_narrow(surface, &format!("about {need:.0} vertices, more than")))
        } else {
            Ok(())
        }
    }

    fn too_narrow(&self, surface: &GrowingSurface, need: &str) -> Error {
        let narrowest =
            surface.maps.vertices.iter().map(|at| at.wavelength_m).fold(f64::INFINITY, f64::min);
        let message = format!(
            "folds down to {narrowest:.3e} m apart need {need} growth.remesh.most_vertices = {}; \
             ask for wider folds or raise it",
            self.most_vertices
        );
        Error::value("growth.wavelength_m", message)
    }

    fn remeshing(&self, edges_per_wave: f64) -> RemeshOptions {
        RemeshOptions {
            wavelength_channel: remesh_surface::WAVELENGTH,
            growth_channel: Some(remesh_surface::GROWTH),
            edges_per_wave,
            normal_angle: self.normal_angle,
            most_vertices: self.most_vertices,
            midpoints: self.midpoints,
            ..RemeshOptions::new(self.longest_m)
        }
    }
}

/// Report on one mesh.
#[derive(Clone, Debug)]
pub struct MeshStage {
    /// Edges asked for to a wavelength.
    pub edges_per_wave: f64,
    /// Vertices after remeshing.
    pub vertices: usize,
    /// Faces after remeshing.
    pub faces: usize,
    /// Report on the remeshing that made it.
    pub remesh: RemeshReport,
    /// Seconds of remeshing.
    pub remesh_seconds: f64,
    /// Newton iterations on it.
    pub iterations: usize,
    /// Seconds of these.
    pub solve_seconds: f64,
    /// Largest force left at its end, in units of the force that starts folds on an edge.
    pub residual: f64,
}

/// Report on growth on meshes that followed the folds.
#[derive(Clone, Debug)]
pub struct AdaptReport {
    /// Steps, what was asked on the last mesh, seconds.
    pub growth: GrowthReport,
    /// The meshes, one after the other.
    pub meshes: Vec<MeshStage>,
}

/// Follows load steps, as [`super::follow_each`], on meshes that follow the folds, from the
/// starting surface of `start` on. The mesh is adapted after every step, and refined twofold and
/// again at the end. Where nothing grows at all, nothing is changed.
///
/// # Errors
/// As [`AdaptOptions::check`] and [`super::grow`]; those of `each`.
pub fn follow_adapting(
    start: GrownSurface,
    steps: &LoadSteps<'_>,
    adapt: &AdaptOptions,
    observer: &dyn Observer,
    each: &mut dyn FnMut(&StepReport, &GrownSurface) -> Result<()>,
) -> Result<(GrownSurface, AdaptReport)> {
    let begun = Instant::now();
    let LoadSteps { parts, options } = *steps;
    adapt.check(&start.surface, options)?;
    let selection = pattern_selection_part(&start.surface, options);
    let grows = !start.surface.maps.expansion().is_none();
    let (reports, meshes) = (Vec::new(), Vec::new());
    let mut run = Run { grown: start, adapt, options, observer, each, reports, meshes };
    if grows {
        run.remesh(adapt.edges_per_wave)?;
    } else {
        run.begin_stage(adapt.edges_per_wave);
    }
    for (n, &part) in parts.iter().enumerate() {
        let last = n + 1 == parts.len() && adapt.finish_edges_per_wave == adapt.edges_per_wave;
        let criteria = if last || part <= selection {
            StopCriteria::full(options)
        } else {
            StopCriteria::loosened(options, INTERMEDIATE_TOLERANCE, INTERMEDIATE_ITERATIONS)
        };
        if !run.equilibrate(part, criteria)? {
            return run.finish(begun);
        }
        if grows && part > selection && n + 1 < parts.len() {
            run.remesh(adapt.edges_per_wave)?;
        }
    }
    let part = parts.last().copied().unwrap_or(0.0);
    let mut edges = adapt.edges_per_wave;
    while grows && edges < adapt.finish_edges_per_wave {
        edges = (edges * REFINEMENT).min(adapt.finish_edges_per_wave);
        run.remesh(edges)?;
        let last = edges == adapt.finish_edges_per_wave;
        let factor = if last { 1.0 } else { INTERMEDIATE_TOLERANCE };
        let criteria = StopCriteria::loosened(options, factor, adapt.finish_iterations);
        if !run.equilibrate(part, criteria)? {
            break;
        }
    }
    run.finish(begun)
}

/// A growth under way.
struct Run<'a> {
    grown: GrownSurface,
    adapt: &'a AdaptOptions,
    options: &'a GrowthOptions,
    observer: &'a dyn Observer,
    each: &'a mut dyn FnMut(&StepReport, &GrownSurface) -> Result<()>,
    reports: Vec<StepReport>,
    meshes: Vec<MeshStage>,
}

impl Run<'_> {
    /// Begins the record of the present mesh.
    fn begin_stage(&mut self, edges_per_wave: f64) {
        let topology = &self.grown.surface.topology;
        self.meshes.push(MeshStage {
            edges_per_wave,
            vertices: topology.vertex_count,
            faces: topology.face_count(),
            remesh: RemeshReport::default(),
            remesh_seconds: 0.0,
            iterations: 0,
            solve_seconds: 0.0,
            residual: 0.0,
        });
    }

    /// Remeshes; a mesh that did not change is not counted again.
    fn remesh(&mut self, edges_per_wave: f64) -> Result<()> {
        let begun = Instant::now();
        let report = self.grown.remesh(&self.adapt.remeshing(edges_per_wave))?;
        if report.limited {
            return Err(self.adapt.too_narrow(&self.grown.surface, "more vertices than"));
        }
        let seconds = begun.elapsed().as_secs_f64();
        let same = report.splits + report.swaps + report.collapses == 0;
        if !same || self.meshes.last().is_none_or(|mesh| mesh.edges_per_wave != edges_per_wave) {
            self.begin_stage(edges_per_wave);
        }
        if let Some(mesh) = self.meshes.last_mut() {
            mesh.remesh_seconds += seconds;
            if !same {
                mesh.remesh = report;
            }
        }
        Ok(())
    }

    /// One load step on the present mesh; false if it was cancelled.
    fn equilibrate(&mut self, part: f64, criteria: StopCriteria) -> Result<bool> {
        let begun = Instant::now();
        let mut pose = self.grown.pose.clone();
        let step = FilmModel::new(&self.grown.surface, self.options, None)?.equilibrate_part(
            part,
            criteria,
            &mut pose,
            self.observer,
        )?;
        self.grown.pose = pose;
        if let Some(mesh) = self.meshes.last_mut() {
            mesh.iterations += step.iterations;
            mesh.solve_seconds += begun.elapsed().as_secs_f64();
            mesh.residual = step.residual;
        }
        (self.each)(&step, &self.grown)?;
        let goes_on = step.ending != Ending::Cancelled;
        self.reports.push(step);
        Ok(goes_on)
    }

    fn finish(self, begun: Instant) -> Result<(GrownSurface, AdaptReport)> {
        let asked = self.grown.surface.asked()?;
        let growth =
            GrowthReport { steps: self.reports, asked, seconds: begun.elapsed().as_secs_f64() };
        Ok((self.grown, AdaptReport { growth, meshes: self.meshes }))
    }
}
