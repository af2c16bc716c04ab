//! Maps of an animated model's live waves: one frame, or a sequence over a clip.

use std::path::Path;
use std::time::Instant;

use plisse::io::aside::OutputFolder;
use plisse::{Error, Result};
use plisse_live::live::LiveOptions;
use plisse_live::model::Model;
use plisse_live::play::Player;
use plisse_live::profile::Profile;
use plisse_live::unify::{Unified, fill_normals};
use plisse_live::{bake, gltf_in, models, wavelength};

use super::Job;
use crate::Done;
use crate::progress::Bars;

/// Vertices closer than this share of the model's size are one place.
const TOLERANCE: f32 = 1e-5;

/// Bakes the model file or own model that the command names.
pub(super) fn model(job: &mut Job<'_>, extension: &str) -> Result<Done> {
    let a = job.arguments;
    let mut model = open(&a.input, extension)?;
    let Some(wavelength_m) = a.wavelength else {
        return Err(Error::value("--wavelength", "it is missing; give the width of one wrinkle (m, in the rest pose), such as 0.03"));
    };
    if !(wavelength_m > 0.0 && wavelength_m.is_finite()) {
        return Err(Error::value("--wavelength", format!("{wavelength_m} is no width; give metres above 0, such as 0.03")));
    }
    let time_s = a.time.unwrap_or(0.0);
    if !(0.0..=3600.0).contains(&time_s) {
        return Err(Error::value("--time", format!("{time_s} s cannot be played to; give 0 to 3600")));
    }
    let profile = Profile::open(a.profile.as_deref().unwrap_or("sine"))?;
    bake::check(&model)?;
    let unified = Unified::new(&model, TOLERANCE);
    fill_normals(&mut model, &unified);
    let options = LiveOptions {
        wavelength_m: wavelength::per_vertex(&unified, wavelength_m as f32, model.wavelength_share.as_deref()),
        ..LiveOptions::new(wavelength_m as f32)
    };
    let mut player = Player::new(&model, &unified, &options, a.clip.as_deref())?;
    let times: Vec<f32> = match (a.frames, player.clip()) {
        (Some(count), Some(clip)) => (0..count).map(|k| clip.duration_s() * k as f32 / (count - 1).max(1) as f32).collect(),
        (Some(_), None) => return Err(Error::value("--frames", format!("{} has no clip to play; leave it out", model.name))),
        (None, _) => vec![time_s as f32],
    };
    let path = job.output();
    let mut folder = OutputFolder::create(&path)?;
    let report = &mut job.report;
    (report.kind, report.wavelength_m, report.profile) = ("live", Some(wavelength_m), Some(a.profile.clone().unwrap_or("sine".into())));
    (report.vertices, report.faces) = (unified.count(), model.faces.len());
    report.clip = player.clip().map(|c| c.name.clone());
    report.height_scale_m = f64::from(bake::largest_height_m(&options.wavelength_m, &profile));
    let bars = Bars::new(job.interrupted);
    let bar = bars.counter("bake", times.len());
    for (k, &time_s) in times.iter().enumerate() {
        // One frame at least, or there is nothing to keep.
        if k > 0 && job.is_interrupted() {
            break;
        }
        let begun = Instant::now();
        let draw = player.play_to(time_s);
        let posed = Instant::now();
        let maps = bake::bake(&model, &unified, &draw, &player.state, &profile, &job.options())?;
        job.report.seconds.waves += (posed - begun).as_secs_f64();
        job.report.seconds.bake += posed.elapsed().as_secs_f64();
        job.write(&mut folder, &maps, a.frames.map(|_| k), f64::from(time_s))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    job.finish(folder, &path)
}

/// The model in a glTF file, or the own model of that name.
fn open(input: &str, extension: &str) -> Result<Model> {
    let path = Path::new(input);
    if ["glb", "gltf"].contains(&extension) || path.is_file() {
        return gltf_in::read(path);
    }
    models::by_name(input)?.ok_or_else(|| {
        let known = models::NAMES.join(", ");
        let message = format!(
            "there is no such file or folder; give a .glb, .gltf or scene .toml file, a folder of plisse solve, or a model: {known}"
        );
        Error::value(input, message)
    })
}
