//! Profiles of wrinkles (6.3): even, 2π-periodic functions. They are stored as on the GPU: 32
//! values with linear interpolation, the last one next to the first.

use std::f32::consts::{PI, TAU};
use std::path::Path;

use plisse::{Error, Result};

/// Number of entries of the table.
pub const ENTRIES: usize = 32;

/// f and f′ over one period.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// `[32]` height at phase 2π·i/32, in [−1, 1].
    pub f: [f32; ENTRIES],
    /// `[32]` derivative by the phase (1/rad): at each entry the mean of the slopes of the two
    /// pieces of `f` that meet there.
    pub df: [f32; ENTRIES],
}

impl Profile {
    /// The profile that `curve` (of a phase in [0, π]) gives; the other half is its mirror.
    pub fn new(curve: impl Fn(f32) -> f32) -> Self {
        let step = TAU / ENTRIES as f32;
        let f: [f32; ENTRIES] = std::array::from_fn(|i| curve(step * i.min(ENTRIES - i) as f32));
        let df = std::array::from_fn(|i| {
            (f[(i + 1) % ENTRIES] - f[(i + ENTRIES - 1) % ENTRIES]) / (2.0 * step)
        });
        Self { f, df }
    }

    /// The cosine of eq. 3.
    pub fn sine() -> Self {
        Self::new(f32::cos)
    }

    /// Straight flanks, as in figure 5.
    pub fn accordion() -> Self {
        Self::new(|x| 1.0 - 2.0 * x / PI)
    }

    /// Pencil pleats: round ridges side by side with sharp valleys between.
    pub fn pencil() -> Self {
        Self::new(|x| 2.0 * (0.5 * x).cos() - 1.0)
    }

    /// Heights from crest (phase 0) to trough (phase π), evenly spaced, with linear interpolation.
    /// At least two; they should lie in [−1, 1].
    ///
    /// # Errors
    /// [`Error::Value`] for fewer than two heights or one that is no number.
    pub fn from_list(heights: &[f32]) -> Result<Self> {
        if heights.len() < 2 {
            return Err(Error::value(
                "profile",
                format!(
                    "{} heights are too few; give at least two, from crest to trough",
                    heights.len()
                ),
            ));
        }
        if let Some(i) = heights.iter().position(|h| !h.is_finite()) {
            return Err(Error::value(
                "profile",
                format!("height {i} is {}; give numbers between -1 and 1", heights[i]),
            ));
        }
        Ok(Self::new(|x| {
            let at = (x / PI).clamp(0.0, 1.0) * (heights.len() - 1) as f32;
            let i = (at as usize).min(heights.len() - 2);
            heights[i] + (heights[i + 1] - heights[i]) * (at - i as f32)
        }))
    }

    /// "sine", "accordion", "pencil", or a list of heights as text (separated by spaces, commas or
    /// line ends).
    ///
    /// # Errors
    /// As [`Profile::from_list`]; also for a word that is neither a name nor a number.
    pub fn parse(text: &str) -> Result<Self> {
        match text.trim() {
            "sine" => return Ok(Self::sine()),
            "accordion" => return Ok(Self::accordion()),
            "pencil" => return Ok(Self::pencil()),
            _ => {}
        }
        let words = text.split([' ', ',', '\n', '\r', '\t']).filter(|w| !w.is_empty());
        let number = |w: &str| {
            w.parse().map_err(|_| {
                Error::value(
                    "profile",
                    format!("\"{w}\" is neither sine, accordion, pencil nor a number; correct it"),
                )
            })
        };
        Self::from_list(&words.map(number).collect::<Result<Vec<f32>>>()?)
    }

    /// The profile in the text file `path`, as [`Profile::parse`] takes it.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read; [`Error::Value`] naming the file, as
    /// [`Profile::parse`].
    pub fn read(path: &Path) -> Result<Self> {
        let text = plisse::io::disk::read_text(path).map_err(|e| Error::reading(path, e))?;
        Self::parse(&text).map_err(|error| match error {
            Error::Value { message, .. } => Error::value(path.display().to_string(), message),
            other => other,
        })
    }

    /// The profile that a user asks for: by its name, by heights, or else by the path of a file
    /// with either.
    ///
    /// # Errors
    /// As [`Profile::read`] and [`Profile::from_list`].
    pub fn open(text: &str) -> Result<Self> {
        let mut words = text.split([' ', ',']).filter(|w| !w.is_empty()).peekable();
        let heights = words.peek().is_some() && words.all(|w| w.parse::<f32>().is_ok());
        if heights || ["sine", "accordion", "pencil"].contains(&text) {
            Self::parse(text)
        } else {
            Self::read(Path::new(text))
        }
    }

    /// f and f′ at `phase` (rad), linear between entries.
    pub fn at(&self, phase: f32) -> (f32, f32) {
        let at = phase / TAU * ENTRIES as f32;
        let (low, share) = (at.floor(), at - at.floor());
        let i = low.rem_euclid(ENTRIES as f32) as usize % ENTRIES;
        let j = (i + 1) % ENTRIES;
        let mix = |t: &[f32; ENTRIES]| t[i] + (t[j] - t[i]) * share;
        (mix(&self.f), mix(&self.df))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivative_is_that_of_what_is_stored() {
        for profile in [
            Profile::sine(),
            Profile::accordion(),
            Profile::pencil(),
            Profile::from_list(&[1.0, 0.8, -0.3, -1.0]).unwrap(),
        ] {
            let step = TAU / ENTRIES as f32;
            for i in 0..ENTRIES {
                let x = step * i as f32;
                let slope = (profile.at(x + step).0 - profile.at(x - step).0) / (2.0 * step);
                assert!((profile.at(x).1 - slope).abs() < 1e-4, "{i}");
                assert!(
                    (profile.at(x).0 - profile.at(-x).0).abs() < 1e-5
                        && (profile.at(x).1 + profile.at(-x).1).abs() < 1e-4
                );
            }
        }
        let worst = (0..1000)
            .map(|i| i as f32 * 0.01)
            .map(|x| (Profile::sine().at(x).1 + x.sin()).abs())
            .fold(0.0, f32::max);
        assert!(worst < 0.012, "{worst}");
        // Shown to fail: a derivative of twice the frequency is far off.
        assert!(
            (0..32).any(|i| (Profile::sine().at(i as f32).1 + (2.0 * i as f32).sin()).abs() > 0.5)
        );
    }

    #[test]
    fn profiles_are_read_from_text() {
        assert_eq!(Profile::parse("accordion").unwrap(), Profile::accordion());
        assert_eq!(Profile::parse("1, -1\n").unwrap(), Profile::from_list(&[1.0, -1.0]).unwrap());
        let path = std::env::temp_dir().join(format!("plisse-profile-{}.txt", std::process::id()));
        std::fs::write(&path, "1\n0.5\n-1\n").unwrap();
        let text = path.display().to_string();
        assert_eq!(Profile::open(&text).unwrap(), Profile::from_list(&[1.0, 0.5, -1.0]).unwrap());
        assert_eq!(Profile::open("pencil").unwrap(), Profile::pencil());
        assert_eq!(Profile::open("1, -1").unwrap(), Profile::from_list(&[1.0, -1.0]).unwrap());
        std::fs::write(&path, "steep").unwrap();
        assert!(Profile::open(&text).unwrap_err().to_string().starts_with(&text));
        std::fs::remove_file(&path).unwrap();
        assert!(Profile::open(&text).is_err() && Profile::open("").is_err());
        for bad in ["", "1", "1 x", "1 NaN"] {
            assert!(Profile::parse(bad).is_err(), "{bad}");
        }
    }
}
