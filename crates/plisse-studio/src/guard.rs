//! Autosaves, which survive a killed program, and the watch on open files.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use plisse::Result;
use plisse::io::disk;

use crate::document::{Document, Source};
use crate::open;

/// Time between autosaves (s).
const AUTOSAVE_S: f64 = 20.0;
/// Time between checks of open files (s).
const WATCH_S: f64 = 1.5;

/// The autosave of this process, and the times of the open files. Paths in an autosave are relative
/// to its folder.
#[derive(Debug)]
pub struct Guard {
    /// Folder of the autosaves; `None`: there are none.
    folder: Option<PathBuf>,
    /// Revision of the last autosave.
    kept: u64,
    last_autosave_s: f64,
    last_watch_s: f64,
    /// The open files, with the times of their last change.
    watched: Vec<(PathBuf, Option<SystemTime>)>,
}

/// An autosave that an earlier run left behind, because it was killed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leftover {
    /// The file.
    pub path: PathBuf,
    /// Name of its model.
    pub name: String,
}

/// The usual folder of autosaves on this system.
pub fn usual_folder() -> Option<PathBuf> {
    let env = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
    let state = env("XDG_STATE_HOME")
        .or_else(|| env("LOCALAPPDATA"))
        .or_else(|| env("HOME").map(|h| h.join(".local").join("state")));
    state.map(|s| s.join("plisse-studio"))
}

impl Guard {
    /// A guard whose autosaves go to `folder`.
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { folder, kept: 0, last_autosave_s: 0.0, last_watch_s: 0.0, watched: Vec::new() }
    }

    /// Watches the file of `document` from now on.
    pub fn watch(&mut self, document: &Document) {
        self.kept = document.revision;
        self.watched = match &document.subject.source {
            Source::Own(_) => Vec::new(),
            Source::File(path) => vec![(path.clone(), disk::modified(path))],
        };
    }

    /// An open file that has changed on the disk since it was read; each change is returned once.
    pub fn changed_file(&mut self, now_s: f64) -> Option<PathBuf> {
        if now_s - self.last_watch_s < WATCH_S {
            return None;
        }
        self.last_watch_s = now_s;
        for (path, known) in &mut self.watched {
            let there = disk::modified(path);
            // A missing file may come back: programs replace files by renaming.
            if there.is_some() && there != *known {
                *known = there;
                return Some(path.clone());
            }
        }
        None
    }

    /// Autosaves `document` if it has changed and the time has come; true if it was written.
    ///
    /// # Errors
    /// [`plisse::Error::File`] if it cannot be written.
    pub fn autosave(&mut self, document: &Document, now_s: f64) -> Result<bool> {
        if document.revision == self.kept || now_s - self.last_autosave_s < AUTOSAVE_S {
            return Ok(false);
        }
        self.last_autosave_s = now_s;
        self.keep(document)?;
        Ok(true)
    }

    /// Autosaves `document` now.
    ///
    /// # Errors
    /// [`plisse::Error::File`] if it cannot be written.
    pub fn keep(&mut self, document: &Document) -> Result<()> {
        if let Some(folder) = &self.folder {
            open::save(document, &folder.join(own_name()))?;
        }
        self.kept = document.revision;
        Ok(())
    }

    /// Removes the autosave: the program ends, and nothing is to be recovered.
    pub fn clear(&self) {
        if let Some(folder) = &self.folder {
            let _ = disk::remove(&folder.join(own_name()));
        }
    }

    /// Autosaves of processes that are gone, the newest first.
    pub fn leftovers(&self) -> Vec<Leftover> {
        let Some(folder) = &self.folder else { return Vec::new() };
        let mut found: Vec<(SystemTime, Leftover)> = Vec::new();
        for (name, _) in disk::list(folder).unwrap_or_default() {
            let process = name
                .strip_prefix("autosave-")
                .and_then(|n| n.strip_suffix(open::DOCUMENT_END))
                .and_then(|n| n.parse::<u32>().ok());
            let Some(process) = process.filter(|&p| p != own_number() && !is_alive(p)) else {
                continue;
            };
            let path = folder.join(&name);
            let saved = disk::read_text(&path)
                .ok()
                .and_then(|t| crate::document::saved::read(&name, &t).ok());
            let name = saved
                .and_then(|s| s.model.own.or(s.model.file))
                .unwrap_or_else(|| format!("process {process}"));
            let name = Path::new(&name)
                .file_name()
                .map_or(name.clone(), |n| n.to_string_lossy().into_owned());
            found.push((
                disk::modified(&path).unwrap_or(SystemTime::UNIX_EPOCH),
                Leftover { path, name },
            ));
        }
        found.sort_by_key(|b| std::cmp::Reverse(b.0));
        found.into_iter().map(|f| f.1).collect()
    }
}

fn own_name() -> String {
    format!("autosave-{}{}", own_number(), open::DOCUMENT_END)
}

/// Number of this process; pages have none.
fn own_number() -> u32 {
    if disk::IN_MEMORY { 1 } else { std::process::id() }
}

/// True if a process runs; false where that is unknown.
fn is_alive(process: u32) -> bool {
    Path::new("/proc").join(process.to_string()).exists()
}
