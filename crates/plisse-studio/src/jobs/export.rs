//! Export of files for other programs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::messages::Messages;
use crate::shell::Shell;
use crate::work::export::{Kind, Source, write};
use crate::work::job::{Job, News, Progress};

/// Files that are being exported.
pub struct Export {
    job: Option<Job<Vec<PathBuf>>>,
    /// Width and height of maps (texels).
    pub map_size: usize,
    /// Paths of the files that were exported last.
    pub written: Vec<PathBuf>,
}

impl Default for Export {
    fn default() -> Self {
        Self { job: None, map_size: 1024, written: Vec::new() }
    }
}

impl Export {
    /// True while files are being written.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// Progress of the files that are being written.
    pub(crate) fn progress(&self) -> Option<Progress> {
        self.job.as_ref().map(Job::progress)
    }

    /// Stops writing.
    pub(crate) fn stop(&self) {
        if let Some(job) = &self.job {
            job.cancel();
        }
    }

    /// Writes `kind` of `source` to `path` in the background.
    pub(crate) fn start(&mut self, kind: Kind, source: Source, path: &Path, shell: &mut Shell) {
        if self.is_busy() {
            shell.messages.problem("export: files are being written; wait until they are there");
            return;
        }
        let request_repaint = Arc::clone(&shell.request_repaint);
        let (path, size) = (path.to_path_buf(), self.map_size);
        self.job = Some(Job::start(
            "export",
            move || request_repaint(),
            move |reporter| write(kind, &source, &path, size, reporter),
        ));
    }

    /// Takes the paths once the files are written.
    pub(crate) fn take(&mut self, messages: &mut Messages) {
        let Some(job) = &self.job else { return };
        for news in job.take() {
            if let News::Done(done) = news {
                self.job = None;
                match done {
                    Ok(paths) => {
                        messages.note(written_note(&paths));
                        self.written = paths;
                    }
                    Err(error) => messages.problem(format!("{error}; your work is still here")),
                }
                return;
            }
        }
    }
}

/// The message about files that were written, all to one folder.
fn written_note(paths: &[PathBuf]) -> String {
    let names: Vec<String> = paths
        .iter()
        .filter_map(|p| p.file_name())
        .map(|n| n.to_string_lossy().into_owned())
        .collect();
    let folder = paths
        .first()
        .and_then(|p| p.parent())
        .map_or_else(String::new, |p| p.display().to_string());
    let to = if folder.is_empty() { String::new() } else { format!(" to {folder}") };
    format!("wrote {}{to}", names.join(", "))
}
