//! The session: the open document, its file, and what of it is saved.

use std::path::{Path, PathBuf};

use crate::document::{Document, Settings};

/// The open document and its file.
pub struct Session {
    /// The document.
    pub document: Document,
    /// Path of the document's file, if it was saved or opened there.
    pub path: Option<PathBuf>,
    saved_revision: u64,
    saved_settings: Settings,
}

impl Session {
    /// A session with `document`, whose file is `path`.
    pub fn new(document: Document, path: Option<PathBuf>) -> Self {
        let (saved_revision, saved_settings) = (document.revision, document.settings.clone());
        Self { document, path, saved_revision, saved_settings }
    }

    /// True if something is not saved.
    pub fn is_unsaved(&self) -> bool {
        // Playing changes nothing that would have to be saved.
        let still = |s: &Settings| Settings { time_s: 0.0, clip: None, ..s.clone() };
        self.document.revision != self.saved_revision
            || still(&self.document.settings) != still(&self.saved_settings)
    }

    /// Notes that the document was saved to `path`.
    pub(crate) fn mark_saved(&mut self, path: &Path) {
        self.saved_revision = self.document.revision;
        self.saved_settings = self.document.settings.clone();
        self.path = Some(path.to_path_buf());
    }

    /// Notes that the document is in no file of the user's yet.
    pub(crate) fn mark_unsaved(&mut self) {
        self.saved_revision = 0;
    }
}
