//! The file `NAME.plisse.json`: a document beside its model.
//!
//! JSON with the fields of [`Saved`]. The model itself stays in its own file and is named relative
//! to this one; layers are lists of `[vertex, a, b, c, d]` for the unified vertices that were
//! painted (numbers of each layer: see [`Layer`]). `docs/studio.md` describes it for people.

use plisse::{Error, Result};
use serde::{Deserialize, Serialize};

use super::layers::{Layer, Layers};
use super::settings::Settings;
use super::stroke::Stroke;
use super::{Document, Source};

/// The number in the field `plisse_studio`; files with a larger one are of a later program.
pub const FORMAT: u32 = 1;

/// What the file says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saved {
    /// Number of the format, [`FORMAT`].
    pub plisse_studio: u32,
    /// The model.
    pub model: SavedModel,
    /// How wrinkles are made.
    pub settings: Settings,
    /// What is painted.
    pub layers: Vec<SavedLayer>,
    /// How it was painted, the oldest stroke first; for people and other programs, layers are what
    /// counts.
    #[serde(default)]
    pub strokes: Vec<Stroke>,
    /// The scene's text, where it was changed.
    #[serde(default)]
    pub scene: Option<String>,
}

/// Which model the document is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedModel {
    /// A model of the program's own, or none.
    pub own: Option<String>,
    /// A file, relative to this one where that can be, or none.
    pub file: Option<String>,
    /// Unified vertices that it had.
    pub vertices: usize,
    /// Faces that it had.
    pub faces: usize,
}

/// One layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedLayer {
    /// Which.
    pub layer: Layer,
    /// `[vertex, a, b, c, d]` of each vertex that was painted, ascending.
    pub vertices: Vec<(u32, f32, f32, f32, f32)>,
}

/// The text of the file for `document`. `name_of` writes the path of a model file as it shall stand
/// there.
pub fn write(document: &Document, name_of: impl Fn(&std::path::Path) -> String) -> String {
    let subject = &document.subject;
    let (own, file) = match &subject.source {
        Source::Own(name) => (Some(name.clone()), None),
        Source::File(path) => (None, Some(name_of(path))),
    };
    let layer = |layer: Layer| {
        let painted = document
            .layers
            .of(layer)
            .iter()
            .enumerate()
            .filter(move |(_, x)| **x != layer.neutral());
        SavedLayer {
            layer,
            vertices: painted.map(|(v, x)| (v as u32, x[0], x[1], x[2], x[3])).collect(),
        }
    };
    let saved = Saved {
        plisse_studio: FORMAT,
        model: SavedModel {
            own,
            file,
            vertices: subject.unified.count(),
            faces: subject.model.faces.len(),
        },
        settings: document.settings.clone(),
        layers: Layer::ALL.map(layer).into_iter().filter(|l| !l.vertices.is_empty()).collect(),
        strokes: document.history.done().iter().map(|c| c.stroke.clone()).collect(),
        scene: subject.scene.as_ref().map(|s| s.text.clone()),
    };
    // Only maps with keys that are no strings, and numbers that are none, could fail here.
    serde_json::to_string(&saved).unwrap_or_default() + "\n"
}

/// What the file `place` with this `text` says.
///
/// # Errors
/// [`Error::Value`] at `place` for what is no such file, or one of a later program.
pub fn read(place: &str, text: &str) -> Result<Saved> {
    let version: serde_json::Value = serde_json::from_str(text).map_err(|e| {
        Error::value(place, format!("this is no JSON ({e}); take an earlier copy of the file"))
    })?;
    match version["plisse_studio"].as_u64() {
        None => {
            return Err(Error::value(
                place,
                "there is no number plisse_studio; open a file that Plissé Studio saved",
            ));
        }
        Some(n) if n > u64::from(FORMAT) => {
            return Err(Error::value(
                place,
                format!(
                    "its format is {n}, this program knows {FORMAT}; open it with a later version"
                ),
            ));
        }
        Some(_) => {}
    }
    serde_json::from_str(text).map_err(|e| {
        Error::value(
            place,
            format!("a field is not as it should be ({e}); correct it or take an earlier copy"),
        )
    })
}

impl Saved {
    /// The layers for a model of `count` unified vertices and `faces` faces.
    ///
    /// # Errors
    /// [`Error::Value`] at `place` if the model has changed since, or a number is unusable.
    pub fn layers(&self, place: &str, count: usize, faces: usize) -> Result<Layers> {
        if (self.model.vertices, self.model.faces) != (count, faces) {
            let had = format!(
                "it was painted on {} vertices and {} faces",
                self.model.vertices, self.model.faces
            );
            return Err(Error::value(
                place,
                format!(
                    "{had}, but the model now has {count} and {faces}; give it its old model file"
                ),
            ));
        }
        let mut layers = Layers::neutral(count);
        for saved in &self.layers {
            let name = saved.layer.name();
            let values = layers.of_mut(saved.layer);
            for &(v, a, b, c, d) in &saved.vertices {
                let numbers = [a, b, c, d];
                let Some(value) = values.get_mut(v as usize) else {
                    return Err(Error::value(
                        place,
                        format!("layer {name} names vertex {v} of {count}; take an earlier copy"),
                    ));
                };
                if numbers.iter().any(|x| !x.is_finite())
                    || (saved.layer == Layer::Wrinkles && a * a + b * b + c * c >= 1.0)
                {
                    return Err(Error::value(
                        place,
                        format!("layer {name} has unusable numbers at vertex {v}; correct them"),
                    ));
                }
                *value = numbers;
            }
        }
        Ok(layers)
    }
}
