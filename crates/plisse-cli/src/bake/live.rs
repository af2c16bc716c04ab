//! Maps of an animated model's live waves: one frame, or a sequence over a clip.

use std::time::Instant;

use plisse::io::staged::OutputFolder;
use plisse::{Error, Result};
use plisse_live::bake;
use plisse_live::live::Frame;
use plisse_live::live_model::LiveModel;
use plisse_live::play::Player;

use super::Job;
use crate::animated;
use crate::progress::Bars;
use crate::terminal::RunEnd;

/// Bakes the model file or own model that the command names.
pub(super) fn model(job: &mut Job<'_>) -> Result<RunEnd> {
    let a = job.arguments;
    let live =
        animated::open(&a.input, &a.waves, ", a scene .toml file, a folder of plisse solve")?;
    let LiveModel { model, welded, options, profile, wavelength_m } = &live;
    let time_s = a.time.unwrap_or(0.0);
    if !(0.0..=3600.0).contains(&time_s) {
        return Err(Error::value(
            "--time",
            format!("{time_s} s cannot be played to; give 0 to 3600"),
        ));
    }
    bake::check(model)?;
    let mut player = Player::new(model, welded, options, a.waves.clip.as_deref())?;
    let times: Vec<f32> = match (a.frames, player.clip()) {
        (Some(count), Some(clip)) => clip.times(count),
        (Some(_), None) => {
            return Err(Error::value(
                "--frames",
                format!("{} has no clip to play; leave it out", model.name),
            ));
        }
        (None, _) => vec![time_s as f32],
    };
    let path = job.output();
    let mut folder = OutputFolder::create(&path)?;
    let report = &mut job.report;
    (report.kind, report.wavelength_m, report.profile) =
        ("live", Some(*wavelength_m), Some(a.waves.profile.clone().unwrap_or("sine".into())));
    (report.vertices, report.faces) = (welded.count(), model.faces.len());
    report.notes.extend(model.notes.iter().cloned());
    report.clip = player.clip().map(|c| c.name.clone());
    report.height_scale_m = f64::from(bake::largest_height_m(&options.wavelength_m, profile));
    let bars = Bars::new(job.interrupted);
    let bar = bars.counter("bake", times.len());
    for (k, &time_s) in times.iter().enumerate() {
        // One frame at least, or there is nothing to keep.
        if k > 0 && job.is_interrupted() {
            break;
        }
        let begun = Instant::now();
        let drawn = player.play_to(time_s);
        let posed = Instant::now();
        let frame = Frame { state: &player.state, drawn: &drawn };
        let maps = bake::bake(model, welded, &frame, profile, &job.options())?;
        job.report.seconds.waves += (posed - begun).as_secs_f64();
        job.report.seconds.bake += posed.elapsed().as_secs_f64();
        job.write(&mut folder, &maps, a.frames.map(|_| k), f64::from(time_s))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    job.finish(folder, &path)
}
