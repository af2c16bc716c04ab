//! `plisse grow`: a scene file to a surface that has grown and folded up.

mod report;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::growth::adapt::{AdaptReport, MeshStage};
use plisse::growth::reference::{LevelReport, grow_by_forces_each};
use plisse::growth::{AdaptOptions, GrowthReport, StepReport, Surface, grow_adapting, grow_each};
use plisse::io::aside::OutputFolder;
use plisse::io::{glb, obj};
use plisse::linalg::Ending;
use plisse::mesh::normals::vertex_normals;
use plisse::mesh::{Up, Vec3};
use plisse::picture::CLOTH;
use plisse::picture::{Camera, Image, Paint, PanelView, Subject};
use plisse::progress::{Observer, Step};
use plisse::relief::offsets_m;
use plisse::rest::RestMetric;
use plisse::scene::growth::Mode;
use plisse::scene::{self, BuiltGrowth};
use plisse::strain::strain;
use plisse::{Error, Result};

use crate::arguments::{GrowArguments, GrowthMode};
use crate::outputs::{self, CLOTH_SRGB, Frame, draw_frames, draw_panels_by};
use crate::pipeline::{open_output_at, with_threads};
use crate::progress::Bars;
use crate::report::ending_name;
use crate::terminal::{RunEnd, with_hint};
use report::{Report, Seconds, StepSummary};

/// Share of the growth that is missing from which on it is worth a note.
const SHORT: f64 = 0.97;

/// Height over width below which a surface lies.
const LYING: f64 = 0.1;

/// Where Newton's steps go: the bar counts steps of growth instead.
struct Watched<'a> {
    bar: indicatif::ProgressBar,
    interrupted: &'a AtomicBool,
}

impl Observer for Watched<'_> {
    fn step(&self, step: &Step) {
        self.bar.set_message(format!(
            "iteration {}, residual {:.1e} (until {:.0e})",
            step.iteration, step.residual, step.tolerance
        ));
    }

    fn cancelled(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }
}

/// How folding went, in either mode.
pub(crate) struct Outcome {
    mode: Mode,
    pose: Vec<Vec3>,
    asked: RestMetric,
    steps: Vec<StepSummary>,
    /// The meshes that followed the folds, one after the other.
    meshes: Vec<MeshStage>,
    cancelled: bool,
    /// Largest force on a vertex at which the mode would have ended.
    tolerance: f64,
    /// The unit of that, and of what is left.
    unit: &'static str,
    residual_newton: Option<f64>,
    seconds: f64,
}

impl Outcome {
    /// How the last step ended; "converged" where there was none.
    fn ending(&self) -> &'static str {
        self.steps.last().map_or(ending_name(Ending::Converged), |step| step.ending)
    }

    fn residual(&self) -> f64 {
        self.steps.last().map_or(0.0, |step| step.residual)
    }

    fn at_rest(&self) -> bool {
        self.steps.last().is_none_or(|step| step.at_rest)
    }
}

/// What is done with each pose that a step led to, and its faces.
type Each<'a> = &'a mut dyn FnMut(&[Vec3], &[[usize; 3]]) -> Result<()>;

/// Folds; also the scene on the mesh that followed its folds, if it did.
fn fold(
    grown: &BuiltGrowth,
    mode: Mode,
    parts: &[f64],
    watched: &Watched<'_>,
    each: Each<'_>,
) -> Result<(Option<BuiltGrowth>, Outcome)> {
    let (growing, faces) = (grown.growing(), &grown.built.topology.faces);
    if mode == Mode::Reference {
        if grown.options.plasticity > 0.0 {
            return Err(Error::value(
                "growth.plasticity",
                "the reference mode forgets no stress; remove this, or use the other mode",
            ));
        }
        if grown.adapt.is_some() {
            return Err(Error::value(
                "growth.remesh",
                "the reference mode keeps its mesh; remove this, or use the other mode",
            ));
        }
        let (pose, found) =
            grow_by_forces_each(&growing, &grown.reference, watched, &mut |_, pose| {
                each(pose, faces)
            })?;
        let last = found.levels.len();
        let ending = |n: usize, converged: bool| match converged {
            true => ending_name(Ending::Converged),
            false if found.cancelled && n + 1 == last => ending_name(Ending::Cancelled),
            false => ending_name(Ending::IterationLimit),
        };
        let summary = |(n, level): (usize, &LevelReport)| StepSummary {
            part: level.part,
            iterations: level.iterations,
            ending: ending(n, level.converged),
            residual: level.residual,
            energy_joule: None,
            at_rest: level.converged,
        };
        let steps = found.levels.iter().enumerate().map(summary).collect();
        let unit = "of the folding force k_p on a vertex";
        let (cancelled, tolerance, asked, seconds) =
            (found.cancelled, grown.reference.tolerance, found.asked, found.seconds);
        let meshes = Vec::new();
        return Ok((
            None,
            Outcome {
                mode,
                pose,
                asked,
                steps,
                meshes,
                cancelled,
                tolerance,
                unit,
                residual_newton: None,
                seconds,
            },
        ));
    }
    let (on, pose, found, meshes) = match &grown.adapt {
        Some(adapt) => {
            let (on, report) = follow(grown, adapt, parts, watched, each)?;
            let growth = GrowthReport { asked: on.asked, ..report.growth };
            (Some(on.grown), on.pose, growth, report.meshes)
        }
        None => {
            let (pose, found) = grow_each(
                &growing,
                parts,
                growing.start,
                &grown.options,
                watched,
                &mut |_, pose| each(pose, faces),
            )?;
            (None, pose, found, Vec::new())
        }
    };
    let summary = |step: &StepReport| StepSummary {
        part: step.part,
        iterations: step.iterations,
        ending: ending_name(step.ending),
        residual: step.residual,
        energy_joule: Some(step.energy_joule),
        at_rest: step.ending == Ending::Converged || step.residual <= grown.options.tolerance,
    };
    let last = found.steps.last();
    let outcome = Outcome {
        mode,
        pose,
        asked: found.asked,
        steps: found.steps.iter().map(summary).collect(),
        cancelled: last.is_some_and(|step| step.ending == Ending::Cancelled),
        tolerance: grown.options.tolerance,
        unit: "of the force that starts folds on an edge",
        residual_newton: Some(last.map_or(0.0, |step| step.residual_newton)),
        seconds: found.seconds,
        meshes,
    };
    Ok((on, outcome))
}

/// The scene on another mesh.
struct Followed {
    grown: BuiltGrowth,
    pose: Vec<Vec3>,
    asked: RestMetric,
}

/// Grows on a mesh that follows the folds.
fn follow(
    grown: &BuiltGrowth,
    adapt: &AdaptOptions,
    parts: &[f64],
    watched: &Watched<'_>,
    each: Each<'_>,
) -> Result<(Followed, AdaptReport)> {
    let mut each =
        |_: &StepReport, surface: &Surface<'_>| each(&surface.pose, &surface.topology.faces);
    let (surface, report) = grow_adapting(
        &grown.growing(),
        grown.chart(),
        parts,
        &grown.options,
        adapt,
        watched,
        &mut each,
    )?;
    let (grown, pose, asked) = grown.on(surface)?;
    Ok((Followed { grown, pose, asked }, report))
}

pub(crate) fn run(arguments: &GrowArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let scene = scene::read(&arguments.scene)?;
    let mut grown = scene::build_growth(&scene).map_err(|error| match scene.growth {
        None => with_hint(error, ", or use plisse solve"),
        Some(_) => error,
    })?;
    let mode = match arguments.mode {
        Some(GrowthMode::Variational) => Mode::Variational,
        Some(GrowthMode::Reference) => Mode::Reference,
        None => grown.mode,
    };
    let steps = arguments.steps.map(|steps| steps as usize);
    let parts = grown.parts(steps);
    grown.reference.levels = steps.unwrap_or(grown.reference.levels);
    let count = if mode == Mode::Reference { grown.reference.levels } else { parts.len() };
    let mut folder = open_output_at(arguments.output.as_deref(), &arguments.scene)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.threads, || {
        let setup_seconds = begun.elapsed().as_secs_f64();
        let watched = Watched { bar: bars.counter("grow", count), interrupted };
        let texture = grown.built.texture();
        let mut frames: Vec<Frame> = Vec::new();
        let mut frame = |pose: &[Vec3], faces: &[[usize; 3]]| {
            if arguments.frames {
                // Another mesh has no texture coordinates yet.
                let texture = texture.as_ref().filter(|_| faces == grown.built.topology.faces);
                let texture =
                    texture.map(|(coordinates, corners)| (&coordinates[..], &corners[..]));
                folder.write(&format!("frame-{:04}.obj", frames.len()), |out| {
                    obj::write(out, pose, faces, texture)
                })?;
                frames.push((pose.to_vec(), faces.to_vec()));
            }
            Ok(())
        };
        frame(&grown.built.start, &grown.built.topology.faces)?;
        let mut each = |pose: &[Vec3], faces: &[[usize; 3]]| {
            watched.bar.inc(1);
            frame(pose, faces)
        };
        let (on, found) = fold(&grown, mode, &parts, &watched, &mut each)?;
        watched.bar.finish_and_clear();
        let grown = on.as_ref().unwrap_or(&grown);
        let measured = Instant::now();
        let counted = grown.count(&found.pose, &found.asked)?;
        let reached = grown.reached(&found.pose, &found.asked);
        let mut report = Report::new(grown, &found, reached, counted);
        report.frames = frames.len();
        report.seconds = Seconds {
            setup: setup_seconds,
            grow: found.seconds,
            measure: measured.elapsed().as_secs_f64(),
            ..Seconds::default()
        };
        report.notes = notes(grown, &report, &found, count, interrupted);
        leave_out_other_frames(&mut folder, arguments, frames.len());

        if arguments.no_picture {
            folder.leave_out("picture.png");
        } else {
            let (spinner, drawn) = (bars.spinner("picture"), Instant::now());
            let picture = picture(grown, &found.asked, &found.pose)?;
            folder.write("picture.png", |out| plisse::picture::write_png(&picture, out))?;
            let images = draw_frames(
                &frames,
                &camera(&grown.built.start, &found.pose),
                &grown.built.obstacles,
            );
            for (n, image) in images.iter().enumerate() {
                folder.write(&format!("frame-{n:04}.png"), |out| {
                    plisse::picture::write_png(image, out)
                })?;
            }
            report.seconds.picture = drawn.elapsed().as_secs_f64();
            drop(spinner);
        }
        let (spinner, written) = (bars.spinner("files"), Instant::now());
        write_meshes(&mut folder, grown, &found.pose)?;
        report.seconds.files = written.elapsed().as_secs_f64();
        report.seconds.total = begun.elapsed().as_secs_f64();
        let table = report.table();
        outputs::finish(folder, &report, table)?;
        drop(spinner);
        Ok(if interrupted.load(Ordering::SeqCst) { RunEnd::Interrupted } else { RunEnd::Complete })
    })
}

/// What the user should know about what has grown.
fn notes(
    grown: &BuiltGrowth,
    report: &Report,
    found: &Outcome,
    steps: usize,
    interrupted: &AtomicBool,
) -> Vec<String> {
    let mut notes = grown.built.notes.clone();
    if found.cancelled {
        let part = found.steps.last().map_or(0.0, |step| 100.0 * step.part);
        let message = format!(
            "interrupted in step {} of {steps}: {part:.0} % of the growth was asked for so far, \
             not all of it",
            found.steps.len()
        );
        notes.push(message);
    } else if interrupted.load(Ordering::SeqCst) {
        notes.push("interrupted after growth had ended by itself; nothing is missing".to_owned());
    } else if !found.at_rest() {
        let (ending, residual, tolerance) = (found.ending(), found.residual(), found.tolerance);
        let mend = if found.meshes.is_empty() {
            "growth.iteration_limit or take more steps"
        } else {
            "growth.remesh.finish_iterations"
        };
        notes.push(format!(
            "it ended ({ending}) with a residual of {residual:.1e}, above {tolerance:.0e}; this is \
             no equilibrium, raise {mend}"
        ));
    } else if let Some(length) = report.length_reached.filter(|&length| length < SHORT) {
        notes.push(format!(
            "{:.0} % of the asked length was reached; what is frozen, sticks or \
            weighs may hold the rest",
            100.0 * length
        ));
    }
    notes
}

/// Frames of an earlier run beside those of this one go.
fn leave_out_other_frames(folder: &mut OutputFolder, arguments: &GrowArguments, frames: usize) {
    let path = folder_path(arguments);
    for entry in std::fs::read_dir(path).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let rest = name.strip_prefix("frame-").unwrap_or_default();
        let number = |ending: &str| rest.strip_suffix(ending).and_then(|n| n.parse::<usize>().ok());
        let drawn = if arguments.no_picture { 0 } else { frames };
        if number(".obj").is_some_and(|n| n >= frames) || number(".png").is_some_and(|n| n >= drawn)
        {
            folder.leave_out(&name);
        }
    }
}

fn folder_path(arguments: &GrowArguments) -> std::path::PathBuf {
    let stem =
        arguments.scene.file_stem().map_or_else(|| "plisse".into(), |stem| stem.to_os_string());
    arguments.output.clone().unwrap_or_else(|| Path::new("out").join(stem))
}

fn write_meshes(folder: &mut OutputFolder, grown: &BuiltGrowth, pose: &[Vec3]) -> Result<()> {
    let (texture, faces) = (grown.built.texture(), &grown.built.topology.faces);
    let texture = texture.as_ref().map(|(coordinates, corners)| (&coordinates[..], &corners[..]));
    folder.write("folded.obj", |out| obj::write(out, pose, faces, texture))?;
    let normals = vertex_normals(&grown.built.topology, pose);
    let mesh = glb::Mesh { positions: pose, normals: &normals, faces, texture };
    folder.write("folded.glb", |out| glb::write(out, &mesh, CLOTH, Up::Z))
}

/// The start with its expansion, the offset on it, what strain is left, and what has folded.
fn picture(grown: &BuiltGrowth, asked: &RestMetric, pose: &[Vec3]) -> Result<Image> {
    let (topology, start) = (&grown.built.topology, &grown.built.start);
    let longer: Vec<f64> = grown
        .maps
        .expansion
        .vertices
        .iter()
        .map(|growth| 100.0 * (growth.principal().0[0] - 1.0).max(0.0))
        .collect();
    let offset: Vec<f64> = offsets_m(topology, start, pose)?.into_iter().map(|w| 1e3 * w).collect();
    let low = offset.iter().copied().fold(f64::INFINITY, f64::min);
    let raised: Vec<f64> = offset.iter().map(|w| w - low).collect();
    let mut missing = vec![0.0_f64; pose.len()];
    for (face, strain) in topology.faces.iter().zip(strain(topology, asked, pose)) {
        // Ê is twice the strain.
        let percent = 50.0 * (-strain.principal[0]).max(0.0);
        face.iter().for_each(|&v| missing[v] = missing[v].max(percent));
    }
    let most = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
    let (flat, folded) = (
        Subject { positions: start, faces: &topology.faces },
        Subject { positions: pose, faces: &topology.faces },
    );
    let panels = [
        PanelView {
            title: "Start, and how much longer it shall grow",
            subject: flat,
            paint: Paint::Scalar { values: &longer, maximum: most(&longer), unit: "%" },
        },
        PanelView {
            title: "Offset, from the lowest",
            subject: flat,
            paint: Paint::Scalar { values: &raised, maximum: most(&raised), unit: "mm" },
        },
        PanelView {
            title: "Growth that is missing",
            subject: folded,
            paint: Paint::Scalar { values: &missing, maximum: most(&missing), unit: "%" },
        },
        PanelView {
            title: "Folded surface",
            subject: folded,
            paint: Paint::Plain { colour: CLOTH_SRGB, wireframe: false },
        },
    ];
    Ok(draw_panels_by(&panels, pose, &camera(start, pose), &grown.built.obstacles))
}

/// What lies is seen from aside, so that its folds stand out; all else from where it shows best.
fn camera(start: &[Vec3], pose: &[Vec3]) -> Camera {
    let (low, high) =
        start.iter().fold((start[0], start[0]), |(low, high), p| (low.inf(p), high.sup(p)));
    let size = high - low;
    if size.z < LYING * size.x.min(size.y) {
        Camera::fit(pose, Up::Z, 20.0, 45.0)
    } else {
        Camera::automatic(pose, Up::Z)
    }
}
