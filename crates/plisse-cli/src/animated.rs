//! Animated models and the wrinkles they get, as `plisse live` and `plisse bake` open them.

use std::path::Path;

use plisse::{Error, Result};
use plisse_live::live_model::LiveModel;
use plisse_live::profile::Profile;
use plisse_live::{bias, gltf_in, models, wavelength};

use crate::arguments::WaveArguments;

/// True if `input` is named like a model file.
pub(crate) fn is_model_file(input: &Path) -> bool {
    let extension =
        input.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    ["glb", "gltf"].contains(&extension.as_str())
}

/// Opens the model file or built-in model `input`. `others` names the other inputs of the command,
/// for the error message.
pub(crate) fn open(input: &str, waves: &WaveArguments, others: &str) -> Result<LiveModel> {
    let path = Path::new(input);
    let found = if is_model_file(path) || path.is_file() {
        Some(gltf_in::read_scene(path, waves.scene.as_deref())?)
    } else {
        models::by_name(input)?
    };
    let model = found.ok_or_else(|| {
        let known = models::NAMES.join(", ");
        Error::value(
            input,
            format!(
                "there is no such file or folder; give a .glb or .gltf \
            file{others}, or a model: {known}"
            ),
        )
    })?;
    if let Some(scene) = waves.scene.as_deref().filter(|_| !path.is_file()) {
        return Err(Error::value(
            "--scene",
            format!("{input} has no scenes, so there is no \"{scene}\"; leave it out"),
        ));
    }
    let Some(wavelength_m) = waves.wavelength else {
        return Err(Error::value(
            "--wavelength",
            "it is missing; give the width of one wrinkle (m, in the rest pose), such as 0.03",
        ));
    };
    if !(wavelength_m > 0.0 && wavelength_m.is_finite()) {
        return Err(Error::value(
            "--wavelength",
            format!("{wavelength_m} is no width; give metres above 0, such as 0.03"),
        ));
    }
    let profile = Profile::open(waves.profile.as_deref().unwrap_or("sine"))?;
    let mut live = LiveModel::new(model, wavelength_m, profile);
    if let Some(path) = &waves.wavelength_map {
        let bytes = std::fs::read(path).map_err(|e| Error::reading(path, e))?;
        let shares = wavelength::sample_map(&bytes, &live.model.uvs)?;
        live.set_wavelength_shares(Some(&shares));
    }
    let seed = waves.seed.unwrap_or(1);
    let bias = match (&waves.bias, waves.random_wrinkles) {
        (Some(path), _) => bias::read(path, live.welded.count())?,
        (None, Some(amount)) if (0.0..=0.95).contains(&amount) => {
            bias::random(&live.welded, amount as f32, seed)
        }
        (None, Some(amount)) => {
            return Err(Error::value(
                "--random-wrinkles",
                format!("{amount} is no amount; give 0 (none) to 0.95"),
            ));
        }
        (None, None) => Vec::new(),
    };
    let options = &mut live.options;
    (options.bias, options.seed) = (bias, seed);
    if waves.unrelaxed {
        (options.rounds, options.first_rounds, options.propagate_new) = (0, 0, false);
    }
    options.rounds = waves.rounds.map_or(options.rounds, |k| k as usize);
    options.every = waves.every.map_or(options.every, |n| n as usize);
    Ok(live)
}
