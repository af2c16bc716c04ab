//! `plisse grow`: a scene file to a surface that has grown and folded up.

mod report;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::Result;
use plisse::field::curvature::vertex_normals;
use plisse::growth::adapt::MeshStage;
use plisse::growth::equilibrium::grow_each;
use plisse::growth::measure::offsets_m;
use plisse::growth::{AdaptOptions, GrowthReport, StepReport, Surface, grow_adapting};
use plisse::io::aside::OutputFolder;
use plisse::io::{glb, obj};
use plisse::linalg::newton::Ending;
use plisse::mesh::{Vec2, Vec3};
use plisse::picture::{Axis, Camera, Image, Paint, PanelView, Subject};
use plisse::progress::{Observer, Step};
use plisse::rest::RestMetric;
use plisse::scene::{self, BuiltGrowth};
use plisse::strain::strain;

use crate::Done;
use crate::arguments::GrowArguments;
use crate::outputs::{self, CLOTH, CLOTH_SRGB, draw_panels_by, panel_texture};
use crate::progress::Bars;
use crate::report::ending_name;
use crate::road::{open_output_at, with_threads};
use report::{Report, Seconds};

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
        self.bar.set_message(format!("iteration {}, residual {:.1e} (until {:.0e})", step.iteration, step.residual, step.tolerance));
    }

    fn cancelled(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }
}

pub(crate) fn run(arguments: &GrowArguments, interrupted: &AtomicBool) -> Result<Done> {
    let begun = Instant::now();
    let grown = scene::build_growth(&scene::read(&arguments.scene)?)?;
    let parts = grown.parts(arguments.steps.map(|steps| steps as usize));
    let mut folder = open_output_at(arguments.output.as_deref(), &arguments.scene)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.threads, || {
        let setup_seconds = begun.elapsed().as_secs_f64();
        let watched = Watched { bar: bars.counter("grow", parts.len()), interrupted };
        let mut frames = 0;
        let (grown, followed) = match grown.adapt.clone() {
            Some(adapt) => {
                let frames = arguments.frames.then_some((&mut folder, &mut frames));
                let (on, followed) = follow(&grown, &adapt, &parts, &watched, frames)?;
                (on, Some(followed))
            }
            None => (grown, None),
        };
        let texture = grown.built.texture.clone().or_else(|| panel_texture(&grown.built.rest_positions, &grown.built.rest_faces));
        let texture = texture.as_ref().map(|(coordinates, corners)| (&coordinates[..], &corners[..]));
        let faces = &grown.built.topology.faces;
        let (growing, start) = (grown.growing(), &grown.built.start);
        let mut frame = |folder: &mut OutputFolder, pose: &[Vec3]| {
            frames += 1;
            folder.write(&format!("frame-{:04}.obj", frames - 1), |out| obj::write(out, pose, faces, texture))
        };
        if arguments.frames && followed.is_none() {
            frame(&mut folder, start)?;
        }
        let mut each = |_: &StepReport, pose: &[Vec3]| {
            watched.bar.inc(1);
            if arguments.frames { frame(&mut folder, pose) } else { Ok(()) }
        };
        let (pose, found, meshes) = match followed {
            Some(followed) => followed,
            None => {
                let (pose, found) = grow_each(&growing, &parts, start, &grown.options, &watched, &mut each)?;
                (pose, found, Vec::new())
            }
        };
        watched.bar.finish_and_clear();
        let measured = Instant::now();
        let counted = grown.count(&pose, &found.asked)?;
        let reached = grown.reached(&pose, &found.asked);
        let mut report = Report::new(&grown, &pose, &found, reached, counted);
        report.frames = frames;
        report.meshes = meshes.iter().map(report::MeshSummary::new).collect();
        report.seconds =
            Seconds { setup: setup_seconds, grow: found.seconds, measure: measured.elapsed().as_secs_f64(), ..Seconds::default() };
        report.notes = notes(&grown, &report, &found, parts.len(), interrupted);
        leave_out_other_frames(&mut folder, arguments, frames);

        if arguments.no_picture {
            folder.leave_out("picture.png");
        } else {
            let (spinner, drawn) = (bars.spinner("picture"), Instant::now());
            let picture = picture(&grown, &found.asked, &pose)?;
            folder.write("picture.png", |out| plisse::picture::write_png(&picture, out))?;
            report.seconds.picture = drawn.elapsed().as_secs_f64();
            drop(spinner);
        }
        let (spinner, written) = (bars.spinner("files"), Instant::now());
        write_meshes(&mut folder, &pose, faces, texture, &grown)?;
        report.seconds.files = written.elapsed().as_secs_f64();
        report.seconds.total = begun.elapsed().as_secs_f64();
        let table = report.table();
        outputs::leave(folder, &report, table)?;
        drop(spinner);
        Ok(if interrupted.load(Ordering::SeqCst) { Done::Interrupted } else { Done::Whole })
    })
}

/// Grows on a mesh that follows the folds: the scene on it, the pose (`[V]`, m), how it grew, and the meshes. Frames have no texture
/// coordinates, because each may have another mesh.
fn follow(
    grown: &BuiltGrowth,
    adapt: &AdaptOptions,
    parts: &[f64],
    watched: &Watched<'_>,
    mut frames: Option<(&mut OutputFolder, &mut usize)>,
) -> Result<(BuiltGrowth, (Vec<Vec3>, GrowthReport, Vec<MeshStage>))> {
    let mut frame = |pose: &[Vec3], faces: &[[usize; 3]]| {
        let Some((folder, count)) = &mut frames else { return Ok(()) };
        **count += 1;
        folder.write(&format!("frame-{:04}.obj", **count - 1), |out| obj::write(out, pose, faces, None))
    };
    frame(&grown.built.start, &grown.built.topology.faces)?;
    let mut each = |_: &StepReport, surface: &Surface<'_>| {
        watched.bar.inc(1);
        frame(&surface.pose, &surface.topology.faces)
    };
    let (surface, report) = grow_adapting(&grown.growing(), grown.chart(), parts, &grown.options, adapt, watched, &mut each)?;
    let (on, pose, asked) = grown.on(surface)?;
    Ok((on, (pose, GrowthReport { asked, ..report.growth }, report.meshes)))
}

/// What the user should know about what has grown.
fn notes(
    grown: &BuiltGrowth,
    report: &Report,
    found: &plisse::growth::GrowthReport,
    steps: usize,
    interrupted: &AtomicBool,
) -> Vec<String> {
    let mut notes = grown.built.notes.clone();
    let last = found.steps.last();
    if last.is_some_and(|step| step.ending == Ending::Cancelled) {
        let part = last.map_or(0.0, |step| 100.0 * step.part);
        let message =
            format!("interrupted in step {} of {steps}: {part:.0} % of the growth was asked for so far, not all of it", found.steps.len());
        notes.push(message);
    } else if interrupted.load(Ordering::SeqCst) {
        notes.push("interrupted after growth had ended by itself; nothing is missing".to_owned());
    } else if last.is_some_and(|step| step.ending == Ending::IterationLimit) {
        let residual = last.map_or(0.0, |step| step.residual);
        let mend = if grown.adapt.is_some() { "growth.remesh.finish_iterations" } else { "growth.iteration_limit or take more steps" };
        notes.push(format!("the iteration limit came first with a residual of {residual:.1e}; this is no equilibrium, raise {mend}"));
    } else if let Some(length) = report.length_reached.filter(|&length| length < SHORT) {
        notes.push(format!("{:.0} % of the asked length was reached; what is frozen, sticks or weighs may hold the rest", 100.0 * length));
    }
    notes
}

/// Frames of an earlier run beside those of this one go.
fn leave_out_other_frames(folder: &mut OutputFolder, arguments: &GrowArguments, frames: usize) {
    let path = folder_path(arguments);
    for entry in std::fs::read_dir(path).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let number = name.strip_prefix("frame-").and_then(|n| n.strip_suffix(".obj")).and_then(|n| n.parse::<usize>().ok());
        if number.is_some_and(|n| n >= frames) {
            folder.leave_out(&name);
        }
    }
}

fn folder_path(arguments: &GrowArguments) -> std::path::PathBuf {
    let stem = arguments.scene.file_stem().map_or_else(|| "plisse".into(), |stem| stem.to_os_string());
    arguments.output.clone().unwrap_or_else(|| Path::new("out").join(stem))
}

fn write_meshes(
    folder: &mut OutputFolder,
    pose: &[Vec3],
    faces: &[[usize; 3]],
    texture: Option<(&[Vec2], &[[usize; 3]])>,
    grown: &BuiltGrowth,
) -> Result<()> {
    folder.write("folded.obj", |out| obj::write(out, pose, faces, texture))?;
    let normals = vertex_normals(&grown.built.topology, pose);
    let mesh = glb::Mesh { positions: pose, normals: &normals, faces, texture };
    folder.write("folded.glb", |out| glb::write(out, &mesh, CLOTH, glb::UpAxis::Z))
}

/// The start with its expansion, the offset on it, what strain is left, and what has folded.
fn picture(grown: &BuiltGrowth, asked: &RestMetric, pose: &[Vec3]) -> Result<Image> {
    let (topology, start) = (&grown.built.topology, &grown.built.start);
    let longer: Vec<f64> = grown.expansion.vertices.iter().map(|growth| 100.0 * (growth.principal().0[0] - 1.0).max(0.0)).collect();
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
    let (flat, folded) = (Subject { positions: start, faces: &topology.faces }, Subject { positions: pose, faces: &topology.faces });
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
        PanelView { title: "Folded surface", subject: folded, paint: Paint::Plain { colour: CLOTH_SRGB, wireframe: false } },
    ];
    Ok(draw_panels_by(&panels, pose, &camera(start, pose), &grown.built.obstacles))
}

/// What lies is seen from aside, so that its folds stand out; all else from where it shows best.
fn camera(start: &[Vec3], pose: &[Vec3]) -> Camera {
    let (low, high) = start.iter().fold((start[0], start[0]), |(low, high), p| (low.inf(p), high.sup(p)));
    let size = high - low;
    if size.z < LYING * size.x.min(size.y) { Camera::fit(pose, Axis::Z, 20.0, 45.0) } else { Camera::automatic(pose, Axis::Z) }
}

/// How the last step ended; "converged" where there was none.
fn ending(found: &plisse::growth::GrowthReport) -> &'static str {
    ending_name(found.steps.last().map_or(Ending::Converged, |step| step.ending))
}
