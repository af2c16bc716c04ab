//! `plisse live`: an animated model, frame by frame, on the GPU or by the stages' CPU references.

mod bench;
mod report;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use plisse::io::staged::OutputFolder;
use plisse::picture::{Image, write_png};
use plisse::progress::Observer as _;
use plisse::{Error, Result};
use plisse_gpu::GpuBackend;
use plisse_live::Vec3;
use plisse_live::backend::{Backend, CpuBackend};
use plisse_live::draw::Look;
use plisse_live::export::{self, FrameInterpolation};
use plisse_live::film::Film;
use plisse_live::fine_mesh::{FineMesh, PARTS_PER_WAVE, suggest_parts};
use plisse_live::live_model::LiveModel;
use plisse_live::measures::Measures;
use plisse_live::play::clip;
use plisse_live::recording::Recording;
use plisse_live::texture::Texture;
use plisse_live::timeline::{Timeline, View};

use crate::animated;
use crate::arguments::LiveArguments;
use crate::pipeline::with_threads;
use crate::progress::Bars;
use crate::terminal::RunEnd;
use report::Report;

pub(crate) fn run(arguments: &LiveArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    with_threads(arguments.threads, || match &arguments.model {
        Some(model) if !arguments.bench => frames(arguments, model, interrupted),
        _ => bench::run(arguments, interrupted),
    })
}

/// Width and height of `text`, "960x720".
fn size(text: &str) -> Result<[usize; 2]> {
    let parse = |part: &str| part.trim().parse().ok().filter(|n| (1..=8192).contains(n));
    let found = text.split_once(['x', 'X']).and_then(|(w, h)| Some([parse(w)?, parse(h)?]));
    found.ok_or_else(|| {
        Error::value(
            "--size",
            format!(
                "\"{text}\" is no size; give WIDTHxHEIGHT in pixels, each 1 \
            to 8192, such as 960x720"
            ),
        )
    })
}

/// The error about the flag that sets what `error` is about.
fn flag(error: Error) -> Error {
    match error {
        Error::Value { field, message } => Error::value(format!("--{field}"), message),
        other => other,
    }
}

fn frames(arguments: &LiveArguments, input: &str, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let live = animated::open(input, &arguments.waves, "")?;
    let playing = clip(&live.model, arguments.waves.clip.as_deref())?;
    let frames = arguments.frames.map(|n| n as usize);
    let timeline = Timeline::new(playing, arguments.start, arguments.fps, frames).map_err(flag)?;
    let view =
        View { yaw_deg: arguments.yaw, pitch_deg: arguments.pitch, size: size(&arguments.size)? };
    let mut report = Report::new(&live, playing, arguments, view.size);
    let texture = texture(arguments, &live, &mut report.notes)?;
    let parts = arguments.parts.map_or_else(
        || suggest_parts(&live.welded, live.wavelength_m as f32, PARTS_PER_WAVE),
        |n| n as usize,
    );
    if arguments.export.is_some() {
        export::check_size(&live.model, parts, timeline.frames)?;
    }
    let path = output(arguments, input);
    let folder = OutputFolder::create(&path)?;
    let look = Look {
        profile: &live.profile,
        texture: &texture,
        colour: Vec3::repeat(1.0),
        parallax: !arguments.no_parallax,
    };
    let mut backend: Box<dyn Backend> = if arguments.cpu {
        Box::new(CpuBackend::new(&live, view.size))
    } else {
        Box::new(GpuBackend::new(&live, view.size, &texture)?)
    };
    report.adapter = backend.name();
    let camera = timeline.camera(&live, &view);
    let recording = Recording::new(&live, &timeline, camera, look, &mut *backend);
    let bars = Bars::new(interrupted);
    let mut results = Results {
        folder,
        film: Film::new(view.size, timeline.frames, arguments.fps),
        parts: arguments.export.is_some().then_some(parts),
        fine: Vec::new(),
    };
    report.measures = record(recording, &timeline, &mut results, &bars)?;
    let Results { mut folder, film, fine, .. } = results;
    let spinner = bars.spinner("files");
    write_film(&mut folder, film)?;
    let exported = match &arguments.export {
        Some(file) => Some(write_export(file, &live, &fine, arguments.fps)?),
        None => None,
    };
    let done = report.measures.pixels.len();
    let stopped = done < timeline.frames;
    if stopped {
        report
            .notes
            .push(format!("interrupted: the first {done} frame(s) are whole, others are missing"));
    }
    leave_out_others(&mut folder, &path, done);
    report.seconds_total = begun.elapsed().as_secs_f64();
    report.write(folder, exported.as_deref())?;
    drop(spinner);
    report.print(&path);
    Ok(if stopped { RunEnd::Interrupted } else { RunEnd::Complete })
}

/// The results of a run in the making.
struct Results {
    folder: OutputFolder,
    film: Film,
    /// Parts of an edge of exported geometry; `None` if nothing is exported.
    parts: Option<usize>,
    fine: Vec<FineMesh>,
}

/// Records the frames until the timeline ends or the run is interrupted.
fn record(
    mut recording: Recording<'_>,
    timeline: &Timeline<'_>,
    results: &mut Results,
    bars: &Bars<'_>,
) -> Result<Measures> {
    let bar = bars.counter("live", timeline.steps.len());
    for step in &timeline.steps {
        let number = recording.frames();
        // One frame at least, or there is nothing to keep.
        if number > 0 && bars.cancelled() {
            break;
        }
        if let Some(frame) = recording.step(step)? {
            write_frame(&mut results.folder, number, &frame.picture.image)?;
            results.film.push(&frame.picture.image);
            results.fine.extend(results.parts.map(|parts| frame.refine(parts)));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(recording.finish())
}

/// The folder asked for, or one named after the input.
fn output(arguments: &LiveArguments, input: &str) -> PathBuf {
    let stem = Path::new(input).file_stem().map_or_else(|| "plisse".into(), |s| s.to_os_string());
    arguments.output.clone().unwrap_or_else(|| PathBuf::from("out").join(stem).join("live"))
}

/// The image that the model is drawn with: the one asked for, or else as [`Texture::of`].
fn texture(
    arguments: &LiveArguments,
    live: &LiveModel,
    notes: &mut Vec<String>,
) -> Result<Texture> {
    if let Some(path) = &arguments.texture {
        let bytes = std::fs::read(path).map_err(|e| Error::reading(path, e))?;
        return Texture::decode(&path.display().to_string(), &bytes);
    }
    let (texture, problem) = Texture::of(&live.model);
    notes.extend(problem.map(|error| format!("{error}; drawn without it")));
    Ok(texture)
}

fn write_frame(folder: &mut OutputFolder, number: usize, image: &Image) -> Result<()> {
    folder.write(&format!("frame-{number:04}.png"), |out| write_png(image, out))
}

/// Writes animation.png; nothing for a single frame.
fn write_film(folder: &mut OutputFolder, film: Film) -> Result<()> {
    if film.is_still() {
        folder.remove_stale("animation.png");
        return Ok(());
    }
    folder.write("animation.png", |out| film.write(out))
}

/// Leaves out the frames that a longer run into the same folder has left there.
fn leave_out_others(folder: &mut OutputFolder, path: &Path, frames: usize) {
    for entry in std::fs::read_dir(path).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let number = name
            .strip_prefix("frame-")
            .and_then(|n| n.strip_suffix(".png"))
            .and_then(|n| n.parse::<usize>().ok());
        if number.is_some_and(|n| n >= frames) {
            folder.remove_stale(&name);
        }
    }
}

/// Writes the geometry of all frames to `file`; the file's path for the report.
fn write_export(file: &Path, live: &LiveModel, fine: &[FineMesh], fps: f64) -> Result<String> {
    let parent = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = file.file_name().and_then(|n| n.to_str());
    let name = name.ok_or_else(|| {
        Error::value(
            "--export",
            format!("{} names no file; give one that ends in .glb", file.display()),
        )
    })?;
    let mut folder = OutputFolder::create(parent)?;
    let between = FrameInterpolation::for_fps(fps);
    folder
        .write(name, |out| export::write_sequence(out, &live.model, fine, fps as f32, between))?;
    folder.commit()?;
    Ok(file.display().to_string())
}
