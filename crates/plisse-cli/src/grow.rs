//! `plisse grow`: a scene file to a surface that has grown and folded up.

mod report;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::Result;
use plisse::io::obj;
use plisse::io::staged::OutputFolder;
use plisse::mesh::Vec3;
use plisse::picture::{Image, Paint, PanelView, Subject};
use plisse::progress::{Observer, Step};
use plisse::scene::growth::{GrowthMeasures, Mode};
use plisse::scene::{self, GrowOptions, GrownScene};

use crate::arguments::{GrowArguments, GrowthMode};
use crate::outputs::{self, CLOTH_SRGB, Frame, draw_frames, draw_panels_by};
use crate::pipeline::{open_output_at, with_threads};
use crate::progress::Bars;
use crate::terminal::{RunEnd, with_hint};
use report::{Report, Seconds};

/// Observer of Newton's steps; the bar counts steps of growth instead.
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

pub(crate) fn run(arguments: &GrowArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let scene = scene::read(&arguments.scene)?;
    let scene = scene::build_growth(&scene).map_err(|error| match scene.growth {
        None => with_hint(error, ", or use plisse solve"),
        Some(_) => error,
    })?;
    let mode = arguments.mode.map(|mode| match mode {
        GrowthMode::Variational => Mode::Variational,
        GrowthMode::Reference => Mode::Reference,
    });
    let options = GrowOptions { mode, steps: arguments.steps.map(|steps| steps as usize) };
    let count = scene.step_count(&options);
    let mut folder = open_output_at(arguments.output.as_deref(), &arguments.scene)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.threads, || {
        let setup_seconds = begun.elapsed().as_secs_f64();
        let watched = Watched { bar: bars.counter("grow", count), interrupted };
        let texture = scene.built.texture();
        let mut frames: Vec<Frame> = Vec::new();
        let mut frame = |pose: &[Vec3], faces: &[[usize; 3]]| {
            if arguments.frames {
                // Another mesh has no texture coordinates yet.
                let texture =
                    texture.as_ref().filter(|_| faces == scene.built.sheet.topology.faces);
                folder.write(&format!("frame-{:04}.obj", frames.len()), |out| {
                    obj::write(out, pose, faces, texture)
                })?;
                frames.push((pose.to_vec(), faces.to_vec()));
            }
            Ok(())
        };
        frame(&scene.built.start, &scene.built.sheet.topology.faces)?;
        let mut each = |pose: &[Vec3], faces: &[[usize; 3]]| {
            watched.bar.inc(1);
            frame(pose, faces)
        };
        let grown = scene::grow(&scene, &options, &watched, &mut each)?;
        watched.bar.finish_and_clear();
        let measured = Instant::now();
        let measures = grown.measures()?;
        let mut report = Report::new(&grown, &measures);
        report.frames = frames.len();
        report.seconds = Seconds {
            setup: setup_seconds,
            grow: grown.seconds,
            measure: measured.elapsed().as_secs_f64(),
            ..Seconds::default()
        };
        report.notes = notes(&grown, &measures, interrupted);
        leave_out_other_frames(&mut folder, arguments, frames.len());

        if arguments.no_picture {
            folder.remove_stale("picture.png");
        } else {
            let (spinner, drawn) = (bars.spinner("picture"), Instant::now());
            let picture = picture(&grown)?;
            folder.write("picture.png", |out| plisse::picture::write_png(&picture, out))?;
            let images = draw_frames(&frames, &grown.camera(), &grown.scene.built.obstacles);
            for (n, image) in images.iter().enumerate() {
                folder.write(&format!("frame-{n:04}.png"), |out| {
                    plisse::picture::write_png(image, out)
                })?;
            }
            report.seconds.picture = drawn.elapsed().as_secs_f64();
            drop(spinner);
        }
        let (spinner, written) = (bars.spinner("files"), Instant::now());
        grown.write(&mut folder)?;
        report.seconds.files = written.elapsed().as_secs_f64();
        report.seconds.total = begun.elapsed().as_secs_f64();
        let table = report.table();
        outputs::finish(folder, &report, table)?;
        drop(spinner);
        Ok(if interrupted.load(Ordering::SeqCst) { RunEnd::Interrupted } else { RunEnd::Complete })
    })
}

/// Notes for the user on what has grown.
fn notes(grown: &GrownScene, measures: &GrowthMeasures, interrupted: &AtomicBool) -> Vec<String> {
    if grown.cancelled || !interrupted.load(Ordering::SeqCst) {
        return grown.notes(measures);
    }
    let mut notes = grown.scene.built.notes.clone();
    notes.push("interrupted after growth had ended by itself; nothing is missing".to_owned());
    notes
}

/// Removes frames of an earlier run beside those of this one.
fn leave_out_other_frames(folder: &mut OutputFolder, arguments: &GrowArguments, frames: usize) {
    let path = folder_path(arguments);
    for entry in std::fs::read_dir(path).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let rest = name.strip_prefix("frame-").unwrap_or_default();
        let number = |ending: &str| rest.strip_suffix(ending).and_then(|n| n.parse::<usize>().ok());
        let drawn = if arguments.no_picture { 0 } else { frames };
        if number(".obj").is_some_and(|n| n >= frames) || number(".png").is_some_and(|n| n >= drawn)
        {
            folder.remove_stale(&name);
        }
    }
}

fn folder_path(arguments: &GrowArguments) -> std::path::PathBuf {
    let stem =
        arguments.scene.file_stem().map_or_else(|| "plisse".into(), |stem| stem.to_os_string());
    arguments.output.clone().unwrap_or_else(|| Path::new("out").join(stem))
}

/// Four panels: the start with its expansion, the offset, the missing growth, the folded surface.
fn picture(grown: &GrownScene) -> Result<Image> {
    let (built, faces) = (&grown.scene.built, grown.faces());
    let fields = grown.fields()?;
    let most = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
    let scalar = |values, unit| Paint::Scalar { values, maximum: most(values), unit };
    let flat = Subject { positions: &built.start, faces };
    let folded = Subject { positions: &grown.pose, faces };
    let panels = [
        PanelView {
            title: "Start, and how much longer it shall grow",
            subject: flat,
            paint: scalar(&fields.asked_percent, "%"),
        },
        PanelView {
            title: "Offset, from the lowest",
            subject: flat,
            paint: scalar(&fields.raised_mm, "mm"),
        },
        PanelView {
            title: "Growth that is missing",
            subject: folded,
            paint: scalar(&fields.missing_percent, "%"),
        },
        PanelView {
            title: "Folded surface",
            subject: folded,
            paint: Paint::Plain { colour: CLOTH_SRGB, wireframe: false },
        },
    ];
    Ok(draw_panels_by(&panels, &grown.pose, &grown.camera(), &built.obstacles))
}
