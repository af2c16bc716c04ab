//! Files that are read in the background: opened, read again after they changed, or recovered. The
//! open document stays until the new one is complete.

use std::path::PathBuf;
use std::sync::Arc;

use crate::document::{Document, Subject};
use crate::guard::Leftover;
use crate::open;
use crate::shell::RequestRepaint;
use crate::work::job::{Job, News};

/// The file that is read, and its purpose.
#[derive(Clone)]
pub(crate) enum Purpose {
    /// A file to open.
    Open(PathBuf),
    /// The open file, read again after it changed.
    Reload(PathBuf),
    /// An autosave that an earlier run left behind.
    Recover(Leftover),
}

/// A file that was read.
pub(crate) enum Content {
    Document(Box<Document>),
    Subject(Box<Subject>),
}

/// The result of reading a file.
pub(crate) struct ReadFile {
    pub purpose: Purpose,
    pub result: Result<Content, String>,
}

/// A file that is being read.
#[derive(Default)]
pub(crate) struct Reading(Option<(Job<Content>, Purpose)>);

impl Reading {
    /// True while a file is being read.
    pub(crate) fn is_busy(&self) -> bool {
        self.0.is_some()
    }

    /// Starts reading a file, in place of one that is being read.
    pub(crate) fn start(&mut self, purpose: Purpose, request_repaint: &RequestRepaint) {
        let (request_repaint, asked) = (Arc::clone(request_repaint), purpose.clone());
        let work = move |_: &_| match asked {
            Purpose::Open(path) => {
                open::open(&path).map(|document| Content::Document(Box::new(document)))
            }
            Purpose::Recover(leftover) => {
                open::open(&leftover.path).map(|document| Content::Document(Box::new(document)))
            }
            Purpose::Reload(path) => {
                open::subject(&path).map(|subject| Content::Subject(Box::new(subject)))
            }
        };
        self.0 = Some((Job::start("open", move || request_repaint(), work), purpose));
    }

    /// The file that was read since the last call.
    pub(crate) fn take(&mut self) -> Option<ReadFile> {
        let (job, _) = self.0.as_ref()?;
        let result = job.take().into_iter().find_map(|news| match news {
            News::Done(done) => Some(done),
            News::Part(_) => None,
        })?;
        let (_, purpose) = self.0.take()?;
        Some(ReadFile { purpose, result })
    }
}
