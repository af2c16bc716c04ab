//! A staged output folder: the files of a run are written under temporary names and renamed
//! together at its end, so that nothing half-written ever appears under its own name, and the
//! outputs of an earlier run stay until new ones are complete.
//!
//! A staged file `name` is called `.name.<process>.part`. Limits: the renames follow each other at
//! once but are not one step for the operating system; one process should have one [`OutputFolder`]
//! for a folder at a time.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// Staged files of a folder. They appear with [`OutputFolder::commit`]; if this is dropped before,
/// nothing has changed.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    /// Names of the staged files, in the order in which they were written.
    staged: Vec<String>,
    /// Names of files of earlier runs, to be removed when the new ones appear.
    stale: Vec<String>,
    /// Folders that were created for this one, innermost first.
    made: Vec<PathBuf>,
}

impl OutputFolder {
    /// Creates the folder `path` if it is missing, with its parents, and writes a trial file in it.
    ///
    /// # Errors
    /// [`Error::File`] if that cannot be done.
    pub fn create(path: &Path) -> Result<Self> {
        // "" stands for the working folder, as it is the parent of "out.glb".
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        let made = path.ancestors().take_while(is_missing).map(Path::to_path_buf).collect();
        let folder = Self { path: path.to_path_buf(), staged: Vec::new(), stale: Vec::new(), made };
        let trial = folder.part("trial");
        let attempt = fs::create_dir_all(path).and_then(|()| {
            new_file(&trial)?.write_all(b"trial")?;
            fs::remove_file(&trial)
        });
        attempt.map_err(|source| {
            fs::remove_file(&trial).ok();
            Error::writing(path, source)
        })?;
        Ok(folder)
    }

    /// Stages a file that will be called `name`, by calling `write` with a buffered writer. A file
    /// staged under that name before is replaced; parts of that name left by runs that have died
    /// are removed.
    ///
    /// # Errors
    /// [`Error::Value`] if `name` is not a plain file name, or if `write` fails with
    /// [`io::ErrorKind::InvalidData`] (the contents are at fault, not the disk); else
    /// [`Error::File`]. The file is not staged then; others still are.
    pub fn write(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<()> {
        super::disk::check_name(name)?;
        self.staged.retain(|n| n != name);
        let part = self.part(name);
        let attempt = self.remove_dead_parts(name).and_then(|()| {
            let mut buffered = BufWriter::new(new_file(&part)?);
            write(&mut buffered)?;
            buffered.into_inner()?.sync_all()
        });
        if let Err(source) = attempt {
            fs::remove_file(&part).ok();
            let path = self.path.join(name);
            return Err(match source.kind() {
                io::ErrorKind::InvalidData => {
                    Error::value(path.display().to_string(), source.to_string())
                }
                _ => Error::writing(&path, source),
            });
        }
        self.staged.push(name.to_string());
        Ok(())
    }

    /// Removes the file `name` of an earlier run when the new files appear, so that it is not
    /// mistaken for one of them.
    pub fn remove_stale(&mut self, name: &str) {
        self.stale.push(name.to_string());
    }

    /// Renames all staged files to their names, in place of those that were there; returns their
    /// paths in the order of writing.
    ///
    /// # Errors
    /// [`Error::File`] before anything is renamed if a folder has the name of a file or a part is
    /// gone; or if a rename fails.
    pub fn commit(mut self) -> Result<Vec<PathBuf>> {
        let paths: Vec<PathBuf> = self.staged.iter().map(|name| self.path.join(name)).collect();
        for (name, path) in self.staged.iter().zip(&paths) {
            if path.is_dir() {
                return Err(Error::writing(path, io::ErrorKind::IsADirectory.into()));
            }
            fs::metadata(self.part(name)).map_err(|source| Error::writing(path, source))?;
        }
        for (name, path) in self.staged.iter().zip(&paths) {
            fs::rename(self.part(name), path).map_err(|source| Error::writing(path, source))?;
        }
        for name in &self.stale {
            fs::remove_file(self.path.join(name)).ok();
        }
        // So that the names outlast a power cut too, where the system can do that.
        File::open(&self.path).and_then(|folder| folder.sync_all()).ok();
        self.staged.clear();
        self.made.clear();
        Ok(paths)
    }

    fn part(&self, name: &str) -> PathBuf {
        self.path.join(format!(".{name}.{}.part", std::process::id()))
    }

    fn remove_dead_parts(&self, name: &str) -> io::Result<()> {
        for entry in fs::read_dir(&self.path)? {
            let entry = entry?;
            let process = entry.file_name().to_str().and_then(|file| process_of(file, name));
            if process.is_some_and(|process| is_dead(process, &entry)) {
                fs::remove_file(entry.path()).ok();
            }
        }
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        for name in &self.staged {
            fs::remove_file(self.part(name)).ok();
        }
        // A folder that something else was put in stays: only empty ones can be removed so.
        for folder in &self.made {
            fs::remove_dir(folder).ok();
        }
    }
}

/// A new file; one that a dead run with this process number left is replaced.
fn new_file(path: &Path) -> io::Result<File> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    File::create_new(path)
}

/// The process number if `file` is a part of `name`.
fn process_of(file: &str, name: &str) -> Option<u32> {
    file.strip_prefix('.')?
        .strip_prefix(name)?
        .strip_prefix('.')?
        .strip_suffix(".part")?
        .parse()
        .ok()
}

/// True if the run that wrote a part has ended: its process is gone, or, where that cannot be seen,
/// the part is a day old. (A run on another computer that shares the folder looks gone too.)
fn is_dead(process: u32, part: &fs::DirEntry) -> bool {
    let processes = Path::new("/proc");
    if processes.join("self").exists() {
        return !processes.join(process.to_string()).exists();
    }
    let age = part.metadata().and_then(|m| m.modified()).ok().and_then(|time| time.elapsed().ok());
    process != std::process::id() && age.is_some_and(|age| age.as_secs() > 24 * 60 * 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fresh folder for one test, removed at its end.
    struct Place(PathBuf);

    impl Place {
        fn new(test: &str) -> Self {
            let path =
                std::env::temp_dir().join(format!("plisse-staged-{test}-{}", std::process::id()));
            fs::remove_dir_all(&path).ok();
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        /// Names and contents of all files, hidden ones too.
        fn contents(&self) -> Vec<(String, String)> {
            let entry = |e: fs::DirEntry| {
                (e.file_name().into_string().unwrap(), fs::read_to_string(e.path()).unwrap())
            };
            let mut list: Vec<_> =
                fs::read_dir(&self.0).unwrap().map(|e| entry(e.unwrap())).collect();
            list.sort();
            list
        }
    }

    impl Drop for Place {
        fn drop(&mut self) {
            fs::remove_dir_all(&self.0).ok();
        }
    }

    fn files(list: &[(&str, &str)]) -> Vec<(String, String)> {
        list.iter().map(|(name, text)| (name.to_string(), text.to_string())).collect()
    }

    #[test]
    fn files_appear_together_at_commit() {
        let place = Place::new("together");
        fs::write(place.0.join("a.txt"), "old").unwrap();
        let mut folder = OutputFolder::create(&place.0).unwrap();
        assert_eq!(place.contents(), files(&[("a.txt", "old")]), "nothing is left of the trial");
        folder.write("b.txt", |out| out.write_all(b"first")).unwrap();
        folder.write("a.txt", |out| out.write_all(b"new")).unwrap();
        folder.write("b.txt", |out| out.write_all(b"second")).unwrap();
        let visible: Vec<_> =
            place.contents().into_iter().filter(|f| !f.0.starts_with('.')).collect();
        assert_eq!(visible, files(&[("a.txt", "old")]));
        assert_eq!(folder.commit().unwrap(), [place.0.join("a.txt"), place.0.join("b.txt")]);
        assert_eq!(place.contents(), files(&[("a.txt", "new"), ("b.txt", "second")]));
    }

    #[test]
    fn a_failed_or_dropped_run_leaves_the_folder_as_it_was() {
        let place = Place::new("failed");
        fs::write(place.0.join("a.txt"), "old").unwrap();
        let mut folder = OutputFolder::create(&place.0).unwrap();
        folder.write("a.txt", |out| out.write_all(b"new")).unwrap();
        let full = |out: &mut dyn Write| {
            out.write_all(&[b'x'; 100_000])?;
            Err(io::ErrorKind::StorageFull.into())
        };
        let error = folder.write("b.txt", full).unwrap_err();
        assert!(
            matches!(&error, Error::File { path, .. } if *path == place.0.join("b.txt")),
            "{error}"
        );
        let error = folder
            .write("c.txt", |_| Err(io::Error::new(io::ErrorKind::InvalidData, "no faces")))
            .unwrap_err();
        assert!(matches!(&error, Error::Value { message, .. } if message == "no faces"), "{error}");
        assert_eq!(place.contents().len(), 2, "only a.txt and its part");
        drop(folder);
        assert_eq!(place.contents(), files(&[("a.txt", "old")]));
    }

    #[test]
    fn missing_folders_are_made_and_go_if_nothing_came() {
        let place = Place::new("made");
        let inner = place.0.join("x/y");
        drop(OutputFolder::create(&inner).unwrap());
        assert!(!place.0.join("x").exists());
        OutputFolder::create(&place.0.join("z")).unwrap().commit().unwrap();
        assert!(
            place.0.join("z").exists(),
            "a run that ended well keeps its folder, even without files"
        );
        let mut folder = OutputFolder::create(&inner).unwrap();
        folder.write("a.txt", |out| out.write_all(b"new")).unwrap();
        folder.commit().unwrap();
        assert_eq!(fs::read_to_string(inner.join("a.txt")).unwrap(), "new");
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_told_at_once() {
        let place = Place::new("unwritable");
        fs::write(place.0.join("file"), "old").unwrap();
        for path in ["file", "file/folder"] {
            let error = OutputFolder::create(&place.0.join(path)).unwrap_err().to_string();
            assert!(error.contains(path) && error.contains("writing failed"), "{error}");
        }
        assert_eq!(place.contents(), files(&[("file", "old")]));
    }

    #[test]
    fn nothing_is_renamed_when_a_folder_is_in_the_way() {
        let place = Place::new("in-the-way");
        fs::create_dir(place.0.join("b.txt")).unwrap();
        let mut folder = OutputFolder::create(&place.0).unwrap();
        folder.write("a.txt", |out| out.write_all(b"new")).unwrap();
        folder.write("b.txt", |out| out.write_all(b"new")).unwrap();
        assert!(folder.commit().unwrap_err().to_string().contains("b.txt"));
        assert!(!place.0.join("a.txt").exists());
        assert_eq!(fs::read_dir(&place.0).unwrap().count(), 1, "no parts are left");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn only_parts_of_dead_runs_under_the_same_name_are_removed() {
        let place = Place::new("dead");
        // No process has the largest number; the parent of this one lives as long as it.
        let living = format!(".a.txt.{}.part", std::os::unix::process::parent_id());
        let dead =
            [".a.txt.4294967295.part".to_string(), format!(".a.txt.{}.part", std::process::id())];
        let others =
            [".b.txt.4294967295.part", ".a.txt.old.part", "a.txt.4294967295.part", living.as_str()];
        for name in dead.iter().map(String::as_str).chain(others) {
            fs::write(place.0.join(name), "left").unwrap();
        }
        let mut folder = OutputFolder::create(&place.0).unwrap();
        folder.write("a.txt", |out| out.write_all(b"new")).unwrap();
        folder.commit().unwrap();
        let mut expected: Vec<_> =
            others.iter().map(|name| (name.to_string(), "left".to_string())).collect();
        expected.push(("a.txt".into(), "new".into()));
        expected.sort();
        assert_eq!(place.contents(), expected);
    }

    #[test]
    fn names_with_folders_are_refused() {
        let place = Place::new("names");
        let mut folder = OutputFolder::create(&place.0).unwrap();
        for name in ["", ".", "..", ".hidden", "../a.txt", "x/a.txt", "x\\a.txt"] {
            let error = folder.write(name, |_| Ok(())).unwrap_err();
            assert!(matches!(error, Error::Value { .. }), "{name}");
        }
        assert!(place.contents().is_empty());
    }

    #[test]
    fn a_file_that_is_left_out_goes_only_with_the_commit() {
        let root = std::env::temp_dir().join(format!("plisse-staged-leave-{}", std::process::id()));
        fs::create_dir_all(&root).unwrap();
        fs::write(root.join("old.png"), "old").unwrap();
        for commit in [false, true] {
            let mut folder = OutputFolder::create(&root).unwrap();
            folder.remove_stale("old.png");
            folder.remove_stale("never-there.png");
            folder.write("new.txt", |out| out.write_all(b"new")).unwrap();
            if commit {
                folder.commit().unwrap();
            } else {
                drop(folder);
            }
            assert_eq!(root.join("old.png").exists(), !commit);
        }
        fs::remove_dir_all(&root).unwrap();
    }
}
