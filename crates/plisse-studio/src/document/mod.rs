//! The document: a model, the layers painted on it, the settings of its wrinkles, and the history.
//!
//! Knows no window, no GPU and no file system, so that all of it also runs in a web page.

pub mod history;
pub mod layers;
pub mod maps;
pub mod saved;
pub mod scene_edit;
pub mod settings;
pub mod stroke;
pub mod subject;

use std::sync::Arc;

use plisse_live::live::LiveOptions;

pub use history::{Change, History};
pub use layers::{Layer, Layers};
pub use settings::Settings;
pub use stroke::{Action, Brush, Falloff, Heading, Mirror, Stroke};
pub use subject::{SceneText, Source, Subject};

/// A document.
#[derive(Clone, Debug)]
pub struct Document {
    /// The model.
    pub subject: Arc<Subject>,
    /// The painted layers.
    pub layers: Layers,
    /// The strokes, done and undone.
    pub history: History,
    /// The settings of its wrinkles.
    pub settings: Settings,
    /// Number of changes that a file would have to hold.
    pub revision: u64,
}

impl Document {
    /// An unpainted document about `subject`.
    pub fn new(subject: Subject) -> Self {
        let layers = Layers::neutral(subject.welded.count());
        let settings = Settings::for_subject(&subject);
        Self {
            subject: Arc::new(subject),
            layers,
            history: History::default(),
            settings,
            revision: 0,
        }
    }

    /// Adds a change that is already in the layers to the history, unless it changed no vertex.
    pub fn push(&mut self, change: Change) {
        if !change.vertices.is_empty() {
            self.history.push(change);
            self.revision += 1;
        }
    }

    /// Undoes the last stroke; true if there was one.
    pub fn undo(&mut self) -> bool {
        let found = self.history.undo(&mut self.layers).is_some();
        self.revision += u64::from(found);
        found
    }

    /// Redoes the last stroke that was undone; true if there was one.
    pub fn redo(&mut self) -> bool {
        let found = self.history.redo(&mut self.layers).is_some();
        self.revision += u64::from(found);
        found
    }

    /// The options of the real-time stages.
    pub fn live_options(&self) -> LiveOptions {
        let s = &self.settings;
        let own = self.subject.own_wavelength_m(s.wavelength_m);
        LiveOptions {
            wavelength_m: self.layers.wavelength_m(s.wavelength_m, &own),
            bias: self.layers.bias(),
            rounds: s.rounds,
            rate: s.rate,
            ..LiveOptions::new(s.wavelength_m)
        }
    }
}
