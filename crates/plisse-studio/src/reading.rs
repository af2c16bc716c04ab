//! Files read in the background: opened, read again after they changed, or recovered. What was open
//! stays until the new one is whole.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plisse::io::disk;

use crate::document::{Document, Subject};
use crate::guard::Left;
use crate::open;
use crate::studio::Studio;
use crate::work::job::{Job, News};

/// What is read, and what for.
#[derive(Clone)]
enum Purpose {
    Open(PathBuf),
    Again(PathBuf),
    Recover(Left),
}

/// What came of it.
enum Read {
    Document(Box<Document>),
    Subject(Box<Subject>),
}

/// A file on its way in.
#[derive(Default)]
pub(crate) struct Reading(Option<(Job<Read>, Purpose)>);

impl Reading {
    /// Whether a file is on its way in.
    pub(crate) fn is_busy(&self) -> bool {
        self.0.is_some()
    }
}

impl Studio {
    /// Opens the file `path`, in the background; what goes wrong becomes a message, and what was
    /// open stays.
    pub fn open(&mut self, path: &Path) {
        self.messages.note(format!("opening {}", path.display()));
        self.read(Purpose::Open(path.to_path_buf()));
    }

    /// Reads the file that is open again, keeping what is painted where the mesh is still the same.
    pub(crate) fn reload(&mut self, path: &Path) {
        self.read(Purpose::Again(path.to_path_buf()));
    }

    /// Takes over what a program left that did not end by itself.
    pub(crate) fn recover(&mut self, left: &Left) {
        self.read(Purpose::Recover(left.clone()));
    }

    fn read(&mut self, purpose: Purpose) {
        let (wake, asked) = (Arc::clone(&self.wake), purpose.clone());
        let work = move |_: &_| match asked {
            Purpose::Open(path) => {
                open::open(&path).map(|document| Read::Document(Box::new(document)))
            }
            Purpose::Recover(left) => {
                open::open(&left.path).map(|document| Read::Document(Box::new(document)))
            }
            Purpose::Again(path) => {
                open::subject(&path).map(|subject| Read::Subject(Box::new(subject)))
            }
        };
        self.reading = Reading(Some((Job::start("open", move || wake(), work), purpose)));
    }

    /// Takes what was read.
    pub(crate) fn take_read(&mut self) {
        let Some((job, purpose)) = &self.reading.0 else { return };
        let (news, purpose) = (job.take(), purpose.clone());
        for news in news {
            let News::Done(done) = news else { continue };
            self.reading = Reading(None);
            match (done, &purpose) {
                (Ok(Read::Document(document)), Purpose::Open(path)) => {
                    let is_document = path.to_string_lossy().ends_with(open::DOCUMENT_END);
                    self.show(*document, is_document.then(|| path.clone()));
                    self.messages.note(format!("opened {}", path.display()));
                }
                (Ok(Read::Document(document)), Purpose::Recover(left)) => {
                    self.recovered(*document, left)
                }
                (Ok(Read::Subject(subject)), Purpose::Again(path)) => self.reloaded(*subject, path),
                (Ok(_), _) => {}
                (Err(error), Purpose::Again(_)) => {
                    self.messages.problem(format!("{error}; what is open here stays"))
                }
                (Err(error), _) => self.messages.problem(error),
            }
        }
    }

    fn reloaded(&mut self, subject: Subject, path: &Path) {
        let (old, new) = (&self.document.subject.unified, &subject.unified);
        let same = new.count() == old.count() && new.faces == old.faces;
        let mut fresh = Document::new(subject);
        if same {
            fresh.layers = self.document.layers.clone();
            fresh.history = self.document.history.clone();
            fresh.settings = self.document.settings.clone();
            fresh.revision = self.document.revision + 1;
            let path = self.path.clone();
            self.show(fresh, path);
            self.messages.note("read again; what was painted is kept");
        } else if self.document.history.done().is_empty() {
            self.show(fresh, None);
            self.messages.note("read again");
        } else {
            self.messages.problem(format!(
                "{}: its mesh is another one, what was painted does not fit it; save your work, \
                 then open the file anew",
                path.display()
            ));
        }
    }

    fn recovered(&mut self, mut document: Document, left: &Left) {
        // It is in no file of the user's yet.
        document.revision = 1;
        self.show(document, None);
        self.saved_revision = 0;
        match self.guard.keep(&self.document) {
            Ok(()) => {
                let _ = disk::remove(&left.path);
                self.left.retain(|l| l != left);
                self.messages.note(format!("recovered {}; save it", left.name));
            }
            Err(error) => self.messages.problem(error),
        }
    }
}
