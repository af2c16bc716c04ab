//! The file `NAME.plisse.json`: a document beside its model.
//!
//! JSON with the fields of [`Saved`]. The model stays in its own file, named relative to this one.
//! Layers are lists of `[vertex, a, b, c, d]` for the painted welded vertices (the numbers of
//! [`Layer`]). `docs/studio.md` describes the format.

use plisse::{Error, Result};
use serde::{Deserialize, Serialize};

use super::layers::{Layer, Layers};
use super::settings::Settings;
use super::stroke::Stroke;
use super::{Document, Source};

/// Number of the format; files with a larger one need a later version of the program.
pub const FORMAT: u32 = 1;

/// The content of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saved {
    /// Number of the format, [`FORMAT`].
    pub plisse_studio: u32,
    /// The model.
    pub model: SavedModel,
    /// The settings of wrinkles and folds.
    pub settings: Settings,
    /// The painted layers.
    pub layers: Vec<SavedLayer>,
    /// The strokes, the oldest first; for information only: the layers count.
    #[serde(default)]
    pub strokes: Vec<Stroke>,
    /// The scene's text, with the edits.
    #[serde(default)]
    pub scene: Option<String>,
}

/// The model of a document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedModel {
    /// Name of a built-in model.
    pub own: Option<String>,
    /// Path of a file, relative to this one if possible.
    pub file: Option<String>,
    /// Number of its welded vertices.
    pub vertices: usize,
    /// Number of its faces.
    pub faces: usize,
}

/// A painted layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedLayer {
    /// The layer.
    pub layer: Layer,
    /// The painted vertices, ascending.
    pub vertices: Vec<PaintedVertex>,
}

/// A painted vertex; `[vertex, a, b, c, d]` in the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "(u32, f32, f32, f32, f32)", into = "(u32, f32, f32, f32, f32)")]
pub struct PaintedVertex {
    /// The welded vertex.
    pub vertex: u32,
    /// Its numbers.
    pub numbers: [f32; 4],
}

impl From<(u32, f32, f32, f32, f32)> for PaintedVertex {
    fn from((vertex, a, b, c, d): (u32, f32, f32, f32, f32)) -> Self {
        Self { vertex, numbers: [a, b, c, d] }
    }
}

impl From<PaintedVertex> for (u32, f32, f32, f32, f32) {
    fn from(PaintedVertex { vertex, numbers: [a, b, c, d] }: PaintedVertex) -> Self {
        (vertex, a, b, c, d)
    }
}

/// The text of the file for `document`. `name_of` gives the path of the model's file in it.
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
            vertices: painted
                .map(|(v, &numbers)| PaintedVertex { vertex: v as u32, numbers })
                .collect(),
        }
    };
    let saved = Saved {
        plisse_studio: FORMAT,
        model: SavedModel {
            own,
            file,
            vertices: subject.welded.count(),
            faces: subject.model.faces.len(),
        },
        settings: document.settings.clone(),
        layers: Layer::ALL.map(layer).into_iter().filter(|l| !l.vertices.is_empty()).collect(),
        strokes: document.history.done().iter().map(|c| c.stroke.clone()).collect(),
        scene: subject.scene.as_ref().map(|s| s.text.clone()),
    };
    // Only maps whose keys are no strings could fail here.
    serde_json::to_string(&saved).unwrap_or_default() + "\n"
}

/// The content of the file `place` with this `text`.
///
/// # Errors
/// [`Error::Value`] at `place` for a text of another kind, or a later format.
pub fn read(place: &str, text: &str) -> Result<Saved> {
    let version: serde_json::Value = serde_json::from_str(text).map_err(|e| {
        Error::value(place, format!("it is no JSON ({e}); take an earlier copy of the file"))
    })?;
    match version["plisse_studio"].as_u64() {
        None => {
            return Err(Error::value(
                place,
                "it has no number plisse_studio; open a file that Plissé Studio saved",
            ));
        }
        Some(n) if n > u64::from(FORMAT) => {
            return Err(Error::value(
                place,
                format!("its format is {n}, not {FORMAT} or earlier; open it with a later version"),
            ));
        }
        Some(_) => {}
    }
    serde_json::from_str(text).map_err(|e| {
        Error::value(place, format!("a field is invalid ({e}); correct it or take an earlier copy"))
    })
}

impl Saved {
    /// The layers for a model of `count` welded vertices and `faces` faces.
    ///
    /// # Errors
    /// [`Error::Value`] at `place` if the model has changed, or a number is invalid.
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
            for &PaintedVertex { vertex: v, numbers } in &saved.vertices {
                let [a, b, c, _] = numbers;
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
                        format!("layer {name} has invalid numbers at vertex {v}; correct them"),
                    ));
                }
                *value = numbers;
            }
        }
        Ok(layers)
    }
}
