//! Animated models and the wrinkles they get, as `plisse live` and `plisse bake` open them.

use std::path::Path;

use plisse::{Error, Result};
use plisse_live::live::LiveOptions;
use plisse_live::model::Model;
use plisse_live::profile::Profile;
use plisse_live::unify::{Unified, fill_normals};
use plisse_live::{bias, gltf_in, models, wavelength};

use crate::arguments::WaveArguments;

/// Distance, relative to the model's size, within which vertices are welded.
const TOLERANCE: f32 = 1e-5;

/// A model ready to move.
pub(crate) struct Animated {
    pub(crate) model: Model,
    pub(crate) unified: Unified,
    pub(crate) options: LiveOptions,
    pub(crate) profile: Profile,
    pub(crate) wavelength_m: f64,
}

/// True if `input` is named like a model file.
pub(crate) fn is_model_file(input: &Path) -> bool {
    let extension =
        input.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    ["glb", "gltf"].contains(&extension.as_str())
}

/// Opens the model file or built-in model `input`. `others` names the other inputs of the command,
/// for the error message.
pub(crate) fn open(input: &str, waves: &WaveArguments, others: &str) -> Result<Animated> {
    let path = Path::new(input);
    let found = if is_model_file(path) || path.is_file() {
        Some(gltf_in::read(path)?)
    } else {
        models::by_name(input)?
    };
    let mut model = found.ok_or_else(|| {
        let known = models::NAMES.join(", ");
        Error::value(
            input,
            format!(
                "there is no such file or folder; give a .glb or .gltf \
            file{others}, or a model: {known}"
            ),
        )
    })?;
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
    let unified = Unified::new(&model, TOLERANCE);
    fill_normals(&mut model, &unified);
    let shares = match &waves.wavelength_map {
        Some(path) => {
            let bytes = std::fs::read(path).map_err(|e| Error::reading(path, e))?;
            Some(wavelength::sample_map(&bytes, &model.uvs)?)
        }
        None => model.wavelength_share.clone(),
    };
    let seed = waves.seed.unwrap_or(1);
    let bias = match (&waves.bias, waves.random_wrinkles) {
        (Some(path), _) => bias::read(path, unified.count())?,
        (None, Some(amount)) if (0.0..=0.95).contains(&amount) => {
            bias::random(&unified, amount as f32, seed)
        }
        (None, Some(amount)) => {
            return Err(Error::value(
                "--random-wrinkles",
                format!("{amount} is no amount; give 0 (none) to 0.95"),
            ));
        }
        (None, None) => Vec::new(),
    };
    let usual = LiveOptions::new(wavelength_m as f32);
    let usual = if waves.unrelaxed {
        LiveOptions { rounds: 0, first_rounds: 0, spread_new: false, ..usual }
    } else {
        usual
    };
    let options = LiveOptions {
        wavelength_m: wavelength::per_vertex(&unified, wavelength_m as f32, shares.as_deref()),
        bias,
        rounds: waves.rounds.map_or(usual.rounds, |k| k as usize),
        every: waves.every.map_or(usual.every, |n| n as usize),
        seed,
        ..usual
    };
    Ok(Animated { model, unified, options, profile, wavelength_m })
}
