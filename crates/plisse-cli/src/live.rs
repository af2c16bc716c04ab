//! `plisse live`: an animated model, frame by frame, on the GPU or by its twins ([`machine`]).

mod animation;
mod bench;
mod machine;
mod report;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::io::staged::OutputFolder;
use plisse::picture::{Image, write_png};
use plisse::{Error, Result};
use plisse_live::camera::Camera;
use plisse_live::crush::jumping;
use plisse_live::draw::Look;
use plisse_live::export::{self, Between, Fine};
use plisse_live::live::LiveState;
use plisse_live::model::Clip;
use plisse_live::play::clip;
use plisse_live::relax::{VISIBLE, mean_phase_error};
use plisse_live::skin::{Pose, pose, skin};
use plisse_live::texture::Texture;
use plisse_live::{Vec3, bake};

use crate::animated::{self, Animated};
use crate::arguments::LiveArguments;
use crate::pipeline::with_threads;
use crate::progress::Bars;
use crate::terminal::RunEnd;
use machine::Machine;
use report::Report;

/// Longest step of the waves (s).
const LONGEST_STEP_S: f64 = 1.0 / 60.0;
/// Frames that are made if nobody says how many.
const MOST_FRAMES: u32 = 240;
/// Poses that the camera is fitted to.
const FITTED: usize = 24;
/// Parts of a wave that --export gives an edge each.
const PER_WAVE: f32 = 6.0;

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

/// When to step, and which steps are frames.
struct Timeline {
    /// Each step's time (s) and whether a frame is shown then.
    steps: Vec<(f64, bool)>,
    frames: usize,
}

impl Timeline {
    fn new(arguments: &LiveArguments, clip: Option<&Clip>) -> Result<Self> {
        let (fps, start) = (arguments.fps, arguments.start);
        if !(0.1..=10_000.0).contains(&fps) {
            return Err(Error::value(
                "--fps",
                format!("{fps} frames a second cannot be made; give 0.1 to 10000"),
            ));
        }
        if !(0.0..=3600.0).contains(&start) {
            return Err(Error::value(
                "--start",
                format!("{start} s cannot be played to; give 0 to 3600"),
            ));
        }
        let whole = clip.map_or(0.0, |c| (f64::from(c.duration_s()) - start).max(0.0) * fps).floor()
            as u32
            + 1;
        let frames = arguments.frames.unwrap_or(whole.min(MOST_FRAMES)) as usize;
        let mut steps = Vec::new();
        let before = (start / LONGEST_STEP_S).ceil();
        steps.extend((0..before as usize).map(|k| (start * k as f64 / before, false)));
        let parts = (1.0 / (fps * LONGEST_STEP_S) - 1e-9).ceil().max(1.0) as usize;
        for frame in 0..frames {
            let shown = start + frame as f64 / fps;
            if frame > 0 {
                steps.extend(
                    (1..parts).map(|p| (shown - (parts - p) as f64 / (fps * parts as f64), false)),
                );
            }
            steps.push((shown, true));
        }
        Ok(Self { steps, frames })
    }
}

fn frames(arguments: &LiveArguments, input: &str, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let animated = animated::open(input, &arguments.waves, "")?;
    let Animated { model, unified, .. } = &animated;
    let playing = clip(model, arguments.waves.clip.as_deref())?;
    let timeline = Timeline::new(arguments, playing)?;
    let size = size(&arguments.size)?;
    let mut report = Report::new(&animated, playing, arguments, size);
    let texture = texture(arguments, &animated, &mut report.notes)?;
    let parts = arguments.parts.map_or_else(
        || export::suggest_parts(unified, animated.wavelength_m as f32, PER_WAVE),
        |n| n as usize,
    );
    if arguments.export.is_some() {
        export::check_size(model, parts, timeline.frames)?;
    }
    let stem = std::path::Path::new(input)
        .file_stem()
        .map_or_else(|| "plisse".into(), |s| s.to_os_string());
    let path =
        arguments.output.clone().unwrap_or_else(|| PathBuf::from("out").join(stem).join("live"));
    let mut folder = OutputFolder::create(&path)?;
    let at = |time_s: f64| pose(model, playing, time_s as f32);
    let camera = camera(arguments, &animated, &timeline, &at, size);
    let look = Look {
        profile: &animated.profile,
        texture: &texture,
        colour: Vec3::repeat(1.0),
        parallax: !arguments.no_parallax,
    };
    let mut machine = Machine::new(arguments.cpu, &animated, size, &texture)?;
    report.adapter = machine.name();
    let bars = Bars::new(interrupted);
    let bar = bars.counter("live", timeline.steps.len());
    let mut film = animation::Film::new(size, timeline.frames, arguments.fps);
    let mut fine: Vec<Fine> = Vec::new();
    let mut last: Option<LiveState> = None;
    for &(time_s, shown) in &timeline.steps {
        // One frame at least, or there is nothing to keep.
        if report.frames > 0 && interrupted.load(Ordering::SeqCst) {
            break;
        }
        let now: Pose = at(time_s);
        machine.step(&animated, &now)?;
        let state = machine.state()?;
        if let Some(last) = &last {
            let strength = [&last.crushed.strength[..], &state.crushed.strength[..]];
            report.jumps.push(f64::from(jumping(strength, [&last.phase, &state.phase], VISIBLE)));
        }
        if shown {
            report.phase_errors.push(f64::from(mean_phase_error(
                unified,
                &state.posed.positions,
                &state.crushed,
                &state.phase,
            )));
            let picture = machine.draw(&animated, &now, &camera, &look)?;
            report.pixels.push(picture.covered);
            write_frame(&mut folder, report.frames, &picture.image)?;
            film.push(&picture.image);
            if arguments.export.is_some() {
                let drawn = skin(&model.draw, &now);
                fine.push(export::refine(model, unified, &drawn, &state, &animated.profile, parts));
            }
            report.frames += 1;
        }
        machine.take_times(&mut report.stage_ms, shown)?;
        last = Some(state);
        bar.inc(1);
    }
    bar.finish_and_clear();
    report.singular_vertices = machine.singular(&animated, &at(timeline.steps[0].0));
    let spinner = bars.spinner("files");
    film.write(&mut folder)?;
    let exported = match &arguments.export {
        Some(file) => Some(write_export(file, &animated, &fine, arguments.fps)?),
        None => None,
    };
    let stopped = report.frames < timeline.frames;
    if stopped {
        report.notes.push(format!(
            "interrupted: the first {} frame(s) are whole, others are missing",
            report.frames
        ));
    }
    leave_out_others(&mut folder, &path, report.frames);
    report.seconds_total = begun.elapsed().as_secs_f64();
    report.write(folder, exported.as_deref())?;
    drop(spinner);
    report.print(&path);
    Ok(if stopped { RunEnd::Interrupted } else { RunEnd::Complete })
}

/// The image that the model is drawn with: the one asked for, its own, or a checked cloth.
fn texture(
    arguments: &LiveArguments,
    animated: &Animated,
    notes: &mut Vec<String>,
) -> Result<Texture> {
    if let Some(path) = &arguments.texture {
        let bytes = std::fs::read(path).map_err(|e| Error::reading(path, e))?;
        return Texture::decode(&path.display().to_string(), &bytes);
    }
    let own = animated
        .model
        .base_colour
        .as_ref()
        .map(|bytes| Texture::decode(&animated.model.name, bytes));
    Ok(match own {
        Some(Ok(texture)) => texture,
        Some(Err(error)) => {
            notes.push(format!("{error}; drawn without it"));
            Texture::checked()
        }
        None if bake::check(&animated.model).is_ok() => Texture::checked(),
        None => Texture::plain([214, 176, 158]),
    })
}

/// Sees every pose of the timeline.
fn camera(
    arguments: &LiveArguments,
    animated: &Animated,
    timeline: &Timeline,
    at: &impl Fn(f64) -> Pose,
    size: [usize; 2],
) -> Camera {
    let shown: Vec<f64> = timeline.steps.iter().filter(|s| s.1).map(|s| s.0).collect();
    let few = (0..FITTED.min(shown.len()))
        .map(|k| shown[k * (shown.len() - 1) / (FITTED.min(shown.len()) - 1).max(1)]);
    let places: Vec<Vec3> =
        few.flat_map(|t| skin(&animated.unified.vertices, &at(t)).positions).collect();
    let angle = |degrees: f64| if degrees.is_finite() { degrees.to_radians() as f32 } else { 0.0 };
    Camera::fit(
        places.iter(),
        angle(arguments.yaw),
        angle(arguments.pitch),
        size[0] as f32 / size[1] as f32,
    )
}

fn write_frame(folder: &mut OutputFolder, number: usize, image: &Image) -> Result<()> {
    folder.write(&format!("frame-{number:04}.png"), |out| write_png(image, out))
}

/// Frames of a longer run before this one go.
fn leave_out_others(folder: &mut OutputFolder, path: &std::path::Path, frames: usize) {
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

/// Writes the geometry of all frames to `file`; returns its place for the report.
fn write_export(
    file: &std::path::Path,
    animated: &Animated,
    fine: &[Fine],
    fps: f64,
) -> Result<String> {
    let parent =
        file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(std::path::Path::new("."));
    let name = file.file_name().and_then(|n| n.to_str());
    let name = name.ok_or_else(|| {
        Error::value(
            "--export",
            format!("{} names no file; give one that ends in .glb", file.display()),
        )
    })?;
    let mut folder = OutputFolder::create(parent)?;
    let between = if fps < 24.0 { Between::Linear } else { Between::Step };
    folder.write(name, |out| {
        export::write_sequence(out, &animated.model, fine, fps as f32, between)
    })?;
    folder.commit()?;
    Ok(file.display().to_string())
}
