//! Growth on a mesh that becomes as fine as the folds ask for while they grow (4.2 of [Combaz &
//! Neyret 2002]).
//!
//! The pattern is chosen, and grows, on a mesh just fine enough to carry it; only then the mesh is
//! made as fine as the result shall be, and each refinement needs a few iterations, because it
//! begins where the coarser one ended, with new vertices on the curves that its normals tell
//! ([`MidpointPlacement`]). What the surface carries goes with it; the expansion acts on the ungrown rest
//! metric, whatever the mesh.

mod remesh_surface;

pub use remesh_surface::Surface;

use web_time::Instant;

use super::equilibrate::{Effort, settle_part};
use super::load_stepping::{GrowthOptions, GrowthReport, StepReport, choosing_part};
use super::surface::Growing;
use crate::linalg::Ending;
use crate::mesh::Vec2;
use crate::progress::Observer;
use crate::remesh::{MidpointPlacement, RemeshOptions, RemeshReport};
use crate::rest::RestMetric;
use crate::{Error, Result};

/// Growth (factor of length less 1) below which a place is left coarse, as in remeshing.
const QUIET: f64 = 1e-9;
/// How much more force than at the end may be left after a step on the coarse mesh, and how many
/// iterations it may take.
const ON_THE_WAY: (f64, usize) = (30.0, 30);
/// By how much finer each level of the end is than the one before.
const REFINING: f64 = 2.0;

/// How the mesh follows the folds.
#[derive(Clone, Debug, PartialEq)]
pub struct AdaptOptions {
    /// Edges to a wavelength where it grows, while it does.
    pub edges_per_wave: f64,
    /// The same at the end.
    pub finish_edges_per_wave: f64,
    /// How long edges should be where nothing grows (m).
    pub longest_m: f64,
    /// No vertex is added beyond this many.
    pub most_vertices: usize,
    /// Angle (rad) between the normals at an edge's ends above which it should be shorter, down to
    /// a half.
    pub normal_angle: f64,
    /// Where new vertices go.
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

    /// About how many vertices `growing` has at the end.
    pub fn vertices(&self, growing: &Growing<'_>) -> f64 {
        let of = |(f, face): (usize, &[usize; 3])| {
            let grows =
                |v: usize| growing.maps.expansion.vertices[v].principal().0[0] > 1.0 + QUIET;
            let fine =
                face.iter().map(|&v| growing.maps.wavelength_m[v]).fold(f64::INFINITY, f64::min)
                    / self.finish_edges_per_wave;
            let edge = if face.iter().any(|&v| grows(v)) {
                fine.min(self.longest_m)
            } else {
                self.longest_m
            };
            // Two regular triangles to a vertex.
            growing.rest.faces[f].area_m2 / (0.75_f64.sqrt() * edge * edge)
        };
        growing.topology.faces.iter().enumerate().map(of).sum()
    }

    /// Whether `growing` can grow on a mesh that follows its folds.
    ///
    /// # Errors
    /// [`Error::Value`] for options that are none, for folds too narrow for [`AdaptOptions::most_vertices`], for plasticity; else as
    /// [`Growing::check`], but faces may be of any size.
    pub fn check(&self, growing: &Growing<'_>, options: &GrowthOptions) -> Result<()> {
        growing.check_start()?;
        growing.check_maps()?;
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
        let need = self.vertices(growing);
        if need > self.most_vertices as f64 {
            Err(self.too_narrow(growing, &format!("about {need:.0} vertices, more than")))
        } else {
            Ok(())
        }
    }

    fn too_narrow(&self, growing: &Growing<'_>, need: &str) -> Error {
        let narrowest = growing.maps.wavelength_m.iter().copied().fold(f64::INFINITY, f64::min);
        let message = format!(
            "folds down to {narrowest:.3e} m apart need {need} growth.remesh.most_vertices = {}; \
             ask for wider folds or raise it",
            self.most_vertices
        );
        Error::value("growth.wavelength_m", message)
    }

    fn remeshing(&self, edges_per_wave: f64) -> RemeshOptions {
        RemeshOptions {
            edges_per_wave,
            normal_angle: self.normal_angle,
            most_vertices: self.most_vertices,
            midpoints: self.midpoints,
            ..RemeshOptions::new(self.longest_m)
        }
    }
}

/// What happened on one mesh.
#[derive(Clone, Debug)]
pub struct MeshStage {
    /// Edges asked for to a wavelength.
    pub edges_per_wave: f64,
    /// Vertices after remeshing.
    pub vertices: usize,
    /// Faces after remeshing.
    pub faces: usize,
    /// How the mesh was made.
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

/// How a surface grew on meshes that followed it.
#[derive(Clone, Debug)]
pub struct AdaptReport {
    /// Steps, what was asked on the last mesh, seconds.
    pub growth: GrowthReport,
    /// The meshes, one after the other.
    pub meshes: Vec<MeshStage>,
}

/// Goes through the `parts` of the growth of `growing` (as [`super::grow_each`], which see for
/// `each`) on meshes that follow its folds, from its starting surface, with texture places
/// (`[F][3]`) or none. The mesh is looked at again after every step, and refined twofold and again
/// at the end. Where nothing grows at all, nothing is changed.
///
/// # Errors
/// As [`AdaptOptions::check`] and [`super::grow`]; those of `each`.
pub fn grow_adapting<'a>(
    growing: &Growing<'a>,
    uvs: Option<Vec<[Vec2; 3]>>,
    parts: &[f64],
    options: &GrowthOptions,
    adapt: &AdaptOptions,
    observer: &dyn Observer,
    each: &mut dyn FnMut(&StepReport, &Surface<'a>) -> Result<()>,
) -> Result<(Surface<'a>, AdaptReport)> {
    let begun = Instant::now();
    adapt.check(growing, options)?;
    let mut run = Run {
        surface: Surface::new(growing, uvs),
        adapt,
        options,
        observer,
        steps: Vec::new(),
        meshes: Vec::new(),
    };
    let choosing = choosing_part(growing, options);
    let grows = !growing.maps.expansion.is_none();
    if grows {
        run.remesh(adapt.edges_per_wave)?;
    } else {
        run.stay(adapt.edges_per_wave);
    }
    for (n, &part) in parts.iter().enumerate() {
        let last = n + 1 == parts.len() && adapt.finish_edges_per_wave == adapt.edges_per_wave;
        let effort = if last || part <= choosing {
            Effort::exact(options)
        } else {
            Effort::of(options, ON_THE_WAY)
        };
        if !run.settle(part, effort, each)? {
            return run.finish(begun);
        }
        if grows && part > choosing && n + 1 < parts.len() {
            run.remesh(adapt.edges_per_wave)?;
        }
    }
    let part = parts.last().copied().unwrap_or(0.0);
    let mut edges = adapt.edges_per_wave;
    while grows && edges < adapt.finish_edges_per_wave {
        edges = (edges * REFINING).min(adapt.finish_edges_per_wave);
        run.remesh(edges)?;
        let last = edges == adapt.finish_edges_per_wave;
        let effort =
            Effort::of(options, (if last { 1.0 } else { ON_THE_WAY.0 }, adapt.finish_iterations));
        if !run.settle(part, effort, each)? {
            break;
        }
    }
    run.finish(begun)
}

/// A growth under way.
struct Run<'a, 'b> {
    surface: Surface<'a>,
    adapt: &'b AdaptOptions,
    options: &'b GrowthOptions,
    observer: &'b dyn Observer,
    steps: Vec<StepReport>,
    meshes: Vec<MeshStage>,
}

impl<'a> Run<'a, '_> {
    /// Goes on with the mesh as it is.
    fn stay(&mut self, edges_per_wave: f64) {
        self.meshes.push(MeshStage {
            edges_per_wave,
            vertices: self.surface.topology.vertex_count,
            faces: self.surface.topology.face_count(),
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
        let report = self.surface.remesh(&self.adapt.remeshing(edges_per_wave))?;
        if report.limited {
            return Err(self.adapt.too_narrow(&self.surface.growing(), "more vertices than"));
        }
        let seconds = begun.elapsed().as_secs_f64();
        let same = report.splits + report.swaps + report.collapses == 0;
        if !same || self.meshes.last().is_none_or(|mesh| mesh.edges_per_wave != edges_per_wave) {
            self.stay(edges_per_wave);
        }
        if let Some(mesh) = self.meshes.last_mut() {
            mesh.remesh_seconds += seconds;
            if !same {
                mesh.remesh = report;
            }
        }
        Ok(())
    }

    /// One step on the mesh there is; whether to go on.
    fn settle(
        &mut self,
        part: f64,
        effort: Effort,
        each: &mut dyn FnMut(&StepReport, &Surface<'a>) -> Result<()>,
    ) -> Result<bool> {
        let begun = Instant::now();
        let mut pose = self.surface.pose.clone();
        let step = settle_part(
            &self.surface.growing(),
            part,
            effort,
            self.options,
            None,
            &mut pose,
            self.observer,
        )?;
        self.surface.pose = pose;
        if let Some(mesh) = self.meshes.last_mut() {
            mesh.iterations += step.iterations;
            mesh.solve_seconds += begun.elapsed().as_secs_f64();
            mesh.residual = step.residual;
        }
        each(&step, &self.surface)?;
        let goes_on = step.ending != Ending::Cancelled;
        self.steps.push(step);
        Ok(goes_on)
    }

    fn finish(self, begun: Instant) -> Result<(Surface<'a>, AdaptReport)> {
        let surface = self.surface;
        let asked: RestMetric =
            surface.maps.expansion.act_on(&surface.topology, &surface.start, &surface.rest)?;
        let growth =
            GrowthReport { steps: self.steps, asked, seconds: begun.elapsed().as_secs_f64() };
        Ok((surface, AdaptReport { growth, meshes: self.meshes }))
    }
}
