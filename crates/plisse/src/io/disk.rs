//! Reading by path: from the disk, or in a web page, which has none, from a [`Store`].

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use super::store::Store;
use crate::{Error, Result};

/// True if files are in memory only.
pub const IN_MEMORY: bool = cfg!(target_arch = "wasm32");

static STORE: Mutex<Store> = Mutex::new(Store::new());

/// The files in memory; natively nobody reads them by path.
pub fn store() -> MutexGuard<'static, Store> {
    STORE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The bytes of a file.
///
/// # Errors
/// Those of the system.
pub fn read(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    if IN_MEMORY { store().read(path.as_ref()) } else { std::fs::read(path) }
}

/// The text of a file.
///
/// # Errors
/// Those of the system; [`io::ErrorKind::InvalidData`] if it is not UTF-8.
pub fn read_text(path: impl AsRef<Path>) -> io::Result<String> {
    let text = String::from_utf8(read(path)?);
    text.map_err(|_| {
        io::Error::new(io::ErrorKind::InvalidData, "stream did not contain valid UTF-8")
    })
}

/// True if there is a file (not a folder) of that name.
pub fn has(path: &Path) -> bool {
    if IN_MEMORY { store().has(path) } else { path.is_file() }
}

/// Removes a file.
///
/// # Errors
/// Those of the system.
pub fn remove(path: &Path) -> io::Result<()> {
    if IN_MEMORY { store().remove(path) } else { std::fs::remove_file(path) }
}

/// Time at which a file was last changed, where that is known.
pub fn modified(path: &Path) -> Option<SystemTime> {
    if IN_MEMORY { None } else { std::fs::metadata(path).and_then(|m| m.modified()).ok() }
}

/// Names in a folder, each with `true` if it is a folder too.
///
/// # Errors
/// Those of the system.
pub fn list(folder: &Path) -> io::Result<Vec<(String, bool)>> {
    if IN_MEMORY {
        return Ok(store().list(folder));
    }
    let entries = std::fs::read_dir(folder)?.flatten();
    Ok(entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path().is_dir()))
        .collect())
}

/// The absolute path of `path`.
pub fn whole(path: &Path) -> PathBuf {
    if IN_MEMORY {
        Path::new("/").join(path)
    } else {
        std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
    }
}

/// Checks that `name` can be that of an output.
///
/// # Errors
/// [`Error::Value`] if it is not a plain file name.
pub(super) fn check_name(name: &str) -> Result<()> {
    if name.is_empty() || name.starts_with('.') || name.contains(['/', '\\', '\0']) {
        return Err(Error::value(
            "output name",
            format!("'{name}' is not a plain file name; give one without folders or leading dot"),
        ));
    }
    Ok(())
}
