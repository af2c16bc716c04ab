//! The document's settings of wrinkles and folds.

use plisse_live::profile::Profile;
use plisse_live::relax;
use serde::{Deserialize, Serialize};

use super::subject::Subject;

/// A profile of wrinkles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProfileChoice {
    /// The cosine of eq. 3.
    Sine,
    /// Straight flanks.
    Accordion,
    /// Round ridges with sharp valleys.
    Pencil,
    /// Heights from crest to trough, −1 to 1.
    Heights(Vec<f32>),
}

impl ProfileChoice {
    /// The profile; the cosine for unusable heights.
    pub fn profile(&self) -> Profile {
        match self {
            Self::Sine => Profile::sine(),
            Self::Accordion => Profile::accordion(),
            Self::Pencil => Profile::pencil(),
            Self::Heights(list) => Profile::from_list(list).unwrap_or_else(|_| Profile::sine()),
        }
    }

    /// Name in the window.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sine => "Sine",
            Self::Accordion => "Accordion",
            Self::Pencil => "Pencil pleats",
            Self::Heights(_) => "From heights",
        }
    }
}

/// The settings of the Live and Grow tabs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Wavelength in the rest pose (m).
    pub wavelength_m: f32,
    /// The wrinkles' profile.
    pub profile: ProfileChoice,
    /// Rounds of phase relaxation per frame.
    pub rounds: usize,
    /// Step of each round, as a share (0 to ½) of the way to the neighbours' phases; ε of eq. 6 of
    /// [Loviscach 2006] is 2π² times it.
    pub rate: f32,
    /// True if the texture shifts with the wrinkles (section 6.2 of [Loviscach 2006]).
    pub parallax: bool,
    /// Name of the clip; `None`: the rest pose.
    pub clip: Option<String>,
    /// Time in the clip (s).
    pub time_s: f32,
    /// Playing speed; 1 is the clip's own.
    pub speed: f32,
    /// Spacing λ of grown folds (m).
    pub fold_spacing_m: f64,
    /// Coherence length Λ of grown folds where none is painted (m).
    pub coherence_m: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            wavelength_m: 0.05,
            profile: ProfileChoice::Sine,
            rounds: 1,
            rate: 0.25,
            parallax: true,
            clip: None,
            time_s: 0.0,
            speed: 1.0,
            fold_spacing_m: 0.1,
            coherence_m: 0.0,
        }
    }
}

impl Settings {
    /// Suitable settings for `subject`: a wavelength for its size, and its first clip; built-in
    /// models at a time at which they wrinkle.
    pub fn for_subject(subject: &Subject) -> Self {
        let (wavelength_m, time_s) = match subject.model.name.as_str() {
            "square" => (0.08, 2.2),
            "curtain" => (0.12, 1.4),
            "zeppelin" => (0.45, 1.2),
            "shirt" => (0.05, 0.5),
            "sleeve" => (0.025, 0.8),
            _ => (two_digits(subject.size_m() / 25.0), 0.0),
        };
        let clip = subject.model.clips.first().map(|c| c.name.clone());
        let fold_spacing_m = f64::from(two_digits(mean_edge_m(subject) * 6.0));
        Self { wavelength_m, clip, time_s, fold_spacing_m, ..Self::default() }
    }

    /// Limits every number, as it may come from a file, to the range of the stages.
    pub fn clamp(&mut self) {
        let sane = |x: f32, low: f32, high: f32, other: f32| {
            if x.is_finite() { x.clamp(low, high) } else { other }
        };
        self.wavelength_m = sane(self.wavelength_m, 1e-5, 1e4, 0.05);
        self.rate = sane(self.rate, 0.0, 0.5, 0.25);
        self.time_s = sane(self.time_s, 0.0, 3600.0, 0.0);
        self.speed = sane(self.speed, 0.0, 4.0, 1.0);
        self.rounds = self.rounds.min(200);
        self.fold_spacing_m = if self.fold_spacing_m.is_finite() {
            self.fold_spacing_m.clamp(1e-5, 1e4)
        } else {
            0.1
        };
        self.coherence_m =
            if self.coherence_m.is_finite() { self.coherence_m.clamp(0.0, 1e4) } else { 0.0 };
    }

    /// The step ε in eq. 6 of [Loviscach 2006].
    pub fn epsilon(&self) -> f32 {
        2.0 * std::f32::consts::PI.powi(2) * self.rate
    }

    /// Strength below which wrinkles count as invisible.
    pub fn visible() -> f32 {
        relax::VISIBLE
    }
}

fn mean_edge_m(subject: &Subject) -> f32 {
    let (welded, mut sum, mut count) = (&subject.welded, 0.0f64, 0usize);
    for v in 0..welded.count() {
        for &n in welded.around(v) {
            sum += f64::from(
                (welded.vertices.positions[n as usize] - welded.vertices.positions[v]).norm(),
            );
            count += 1;
        }
    }
    (sum / count.max(1) as f64) as f32
}

/// `x`, rounded to two digits.
fn two_digits(x: f32) -> f32 {
    if !(x > 0.0 && x.is_finite()) {
        return 0.05;
    }
    let unit = 10f32.powf(x.log10().floor() - 1.0);
    (x / unit).round() * unit
}
