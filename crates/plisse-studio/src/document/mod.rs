//! What is worked on: the model, what is painted on it, how its wrinkles are made, and everything
//! that was done to it.
//!
//! Knows no window, no GPU and no file system: files come and go as bytes, so that all of it also
//! runs in a web page.

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
    /// What is painted on it.
    pub layers: Layers,
    /// What was done.
    pub history: History,
    /// How its wrinkles are made.
    pub settings: Settings,
    /// Counts up with everything that files would have to take in.
    pub revision: u64,
}

impl Document {
    /// A document about `subject` on which nothing is painted.
    pub fn new(subject: Subject) -> Self {
        let layers = Layers::neutral(subject.unified.count());
        let settings = Settings::for_subject(&subject);
        Self {
            subject: Arc::new(subject),
            layers,
            history: History::default(),
            settings,
            revision: 0,
        }
    }

    /// Takes a change that is in the layers already into the history; one that changed nothing is
    /// left out.
    pub fn push(&mut self, change: Change) {
        if !change.vertices.is_empty() {
            self.history.push(change);
            self.revision += 1;
        }
    }

    /// Takes the last stroke back; whether there was one.
    pub fn undo(&mut self) -> bool {
        let found = self.history.undo(&mut self.layers).is_some();
        self.revision += u64::from(found);
        found
    }

    /// Does the last stroke that was taken back again; whether there was one.
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
