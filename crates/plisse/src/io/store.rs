//! Files by name, in memory: the disk of a program that has none.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Component, Path, PathBuf};

/// Named files. Names are paths without "." and ".."; folders are there while a file is in them.
#[derive(Debug, Default)]
pub struct Store {
    files: BTreeMap<PathBuf, Vec<u8>>,
    /// Files written since the last [`Store::take_written`], in that order.
    written: Vec<PathBuf>,
}

impl Store {
    /// An empty store.
    pub const fn new() -> Self {
        Self { files: BTreeMap::new(), written: Vec::new() }
    }

    /// Puts a file in, in place of one of that name.
    pub fn put(&mut self, path: &Path, bytes: Vec<u8>) {
        self.files.insert(plain(path), bytes);
    }

    /// As [`Store::put`], for a file that [`Store::take_written`] is to tell.
    pub fn write(&mut self, path: &Path, bytes: Vec<u8>) {
        let path = plain(path);
        self.written.retain(|p| *p != path);
        self.written.push(path.clone());
        self.files.insert(path, bytes);
    }

    /// Files written since the last call, in that order.
    pub fn take_written(&mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.written)
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// [`io::ErrorKind::NotFound`] if there is none of that name.
    pub fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.files.get(&plain(path)).cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    /// True if there is a file of that name.
    pub fn has(&self, path: &Path) -> bool {
        self.files.contains_key(&plain(path))
    }

    /// Removes a file.
    ///
    /// # Errors
    /// As [`Store::read`].
    pub fn remove(&mut self, path: &Path) -> io::Result<()> {
        self.files.remove(&plain(path)).map(|_| ()).ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    /// Names in a folder, in their order, each with `true` if it is a folder too.
    pub fn list(&self, folder: &Path) -> Vec<(String, bool)> {
        let folder = plain(folder);
        let inside = self.files.keys().filter_map(|path| {
            let mut rest = path.strip_prefix(&folder).ok()?.components();
            let name = rest.next()?.as_os_str().to_string_lossy().into_owned();
            Some((name, rest.next().is_some()))
        });
        inside.collect::<BTreeSet<_>>().into_iter().collect()
    }
}

fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => plain.push(name),
            Component::ParentDir => {
                plain.pop();
            }
            _ => {}
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_found_by_every_way_to_its_name() {
        let mut store = Store::new();
        store.put(Path::new("a/b.obj"), b"one".to_vec());
        for way in ["a/b.obj", "./a/b.obj", "a/./b.obj", "c/../a/b.obj", "/a/b.obj"] {
            assert_eq!(store.read(Path::new(way)).unwrap(), b"one", "{way}");
        }
        assert_eq!(store.read(Path::new("b.obj")).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert!(store.has(Path::new("a/b.obj")) && !store.has(Path::new("a")));
        store.remove(Path::new("a/b.obj")).unwrap();
        assert!(!store.has(Path::new("a/b.obj")) && store.remove(Path::new("a/b.obj")).is_err());
    }

    #[test]
    fn folders_list_what_is_in_them_once() {
        let mut store = Store::new();
        for path in ["b.obj", "a/1.obj", "a/2.obj", "a/c/3.obj"] {
            store.put(Path::new(path), Vec::new());
        }
        let list = |folder: &str| store.list(Path::new(folder));
        assert_eq!(list("."), [("a".into(), true), ("b.obj".into(), false)]);
        assert_eq!(
            list("a"),
            [("1.obj".into(), false), ("2.obj".into(), false), ("c".into(), true)]
        );
        assert_eq!(list("x"), []);
    }

    #[test]
    fn what_was_written_is_told_once() {
        let mut store = Store::new();
        store.put(Path::new("in.obj"), Vec::new());
        for path in ["b.obj", "a.obj", "b.obj"] {
            store.write(Path::new(path), path.as_bytes().to_vec());
        }
        assert_eq!(store.take_written(), [Path::new("a.obj"), Path::new("b.obj")]);
        assert!(store.take_written().is_empty() && store.has(Path::new("b.obj")));
    }
}
