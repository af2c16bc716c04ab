//! The staged output folder where files are in memory: the files of a run appear together at its
//! end, or not at all.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::disk;
use crate::{Error, Result};

/// Staged files of a folder. They appear with [`OutputFolder::commit`]; if this is dropped before,
/// nothing has changed.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    staged: Vec<(String, Vec<u8>)>,
    stale: Vec<String>,
}

impl OutputFolder {
    /// Prepares for files in the folder `path`.
    ///
    /// # Errors
    /// [`Error::File`] if that is a file.
    pub fn create(path: &Path) -> Result<Self> {
        if disk::store().has(path) {
            return Err(Error::writing(path, io::ErrorKind::NotADirectory.into()));
        }
        Ok(Self { path: path.to_path_buf(), staged: Vec::new(), stale: Vec::new() })
    }

    /// Stages a file that will be called `name`, in place of one staged under that name before.
    ///
    /// # Errors
    /// [`Error::Value`] if `name` is not a plain file name, or if `write` fails with
    /// [`io::ErrorKind::InvalidData`]; else [`Error::File`].
    pub fn write(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<()> {
        disk::check_name(name)?;
        self.staged.retain(|(n, _)| n != name);
        let mut bytes = Vec::new();
        write(&mut bytes).map_err(|source| {
            let path = self.path.join(name);
            match source.kind() {
                io::ErrorKind::InvalidData => {
                    Error::value(path.display().to_string(), source.to_string())
                }
                _ => Error::writing(&path, source),
            }
        })?;
        self.staged.push((name.to_owned(), bytes));
        Ok(())
    }

    /// Removes the file `name` of an earlier run when the new files appear.
    pub fn remove_stale(&mut self, name: &str) {
        self.stale.push(name.to_owned());
    }

    /// Puts all staged files under their names; returns their paths in the order of writing.
    ///
    /// # Errors
    /// [`Error::File`] if a folder has the name of a file.
    pub fn commit(self) -> Result<Vec<PathBuf>> {
        let mut store = disk::store();
        let paths: Vec<PathBuf> =
            self.staged.iter().map(|(name, _)| self.path.join(name)).collect();
        if let Some(path) = paths.iter().find(|path| !store.list(path).is_empty()) {
            return Err(Error::writing(path, io::ErrorKind::IsADirectory.into()));
        }
        paths.iter().zip(self.staged).for_each(|(path, (_, bytes))| store.write(path, bytes));
        for name in &self.stale {
            // It need not have been there.
            let _ = store.remove(&self.path.join(name));
        }
        Ok(paths)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_appear_together_or_not_at_all() {
        let place = Path::new("staged-in-memory");
        let file = |name: &str| disk::store().read(&place.join(name)).ok();
        disk::store().put(&place.join("old.txt"), b"old".to_vec());
        for commit in [false, true] {
            let mut folder = OutputFolder::create(place).unwrap();
            folder.remove_stale("old.txt");
            folder.remove_stale("never-there.txt");
            folder.write("a.txt", |out| out.write_all(b"first")).unwrap();
            folder.write("a.txt", |out| out.write_all(b"second")).unwrap();
            let error = folder
                .write("b.txt", |_| Err(io::Error::new(io::ErrorKind::InvalidData, "no faces")))
                .unwrap_err();
            assert!(
                matches!(&error, Error::Value { message, .. } if message == "no faces"),
                "{error}"
            );
            assert!(folder.write("../c.txt", |_| Ok(())).is_err());
            assert_eq!((file("a.txt"), file("old.txt")), (None, Some(b"old".to_vec())));
            if commit {
                assert_eq!(folder.commit().unwrap(), [place.join("a.txt")]);
            }
        }
        assert_eq!(
            (file("a.txt"), file("old.txt"), file("b.txt")),
            (Some(b"second".to_vec()), None, None)
        );
        assert!(OutputFolder::create(&place.join("a.txt")).is_err(), "a file is no folder");
        let mut above = OutputFolder::create(Path::new("")).unwrap();
        above.write("staged-in-memory", |_| Ok(())).unwrap();
        assert!(above.commit().is_err(), "a folder is no file");
    }
}
