//! The one error type of the library. Each variant says where, what is wrong, and how to fix it, in
//! one sentence; its fields let a program tell one fault from another.

mod mesh;
mod place;
mod setup;

pub use mesh::{MeshError, ObstacleError};
pub use place::{At, Place};
pub use setup::SetupError;

use std::path::{Path, PathBuf};

/// A [`std::result::Result`] with the library's [`enum@Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// The reason why a call could not be done. The `Display` text is one sentence: the place, what is
/// wrong there, and the fix.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder could not be read or written.
    #[error("{}{}: {doing} failed ({source}); {fix}", place::before(place), path.display())]
    File {
        /// The field that names the file, e.g. "mesh.rest"; empty if none does.
        place: String,
        /// The file or folder.
        path: PathBuf,
        /// The operation, e.g. "reading".
        doing: &'static str,
        /// The operating system's error.
        source: std::io::Error,
        /// The fix.
        fix: &'static str,
    },
    /// The text of a file is not what its format asks for.
    #[error("{}, line {line}: {message}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line in the file, counted from 1.
        line: usize,
        /// The fault and its fix.
        message: String,
    },
    /// A mesh is not usable.
    #[error("{}{problem}", place::before(place))]
    Mesh {
        /// The file or scene part the mesh came from; empty if not yet known.
        place: String,
        /// The fault.
        problem: MeshError,
    },
    /// A sheet with its clamps, loads and obstacles has no equilibrium to solve for.
    #[error("{}{problem}", place::before(place))]
    Setup {
        /// The part of the setup, e.g. "clamps".
        place: String,
        /// The fault.
        problem: SetupError,
    },
    /// A field of a scene file, a flag or an argument has an unusable value.
    #[error("{}{message}", place::before(field))]
    Value {
        /// The field or flag, e.g. "material.poisson".
        field: String,
        /// The fault, and the values that are allowed.
        message: String,
    },
    /// A numerical step could not go on.
    #[error("{stage}: {message}")]
    Numeric {
        /// The step of the pipeline, e.g. "base solve".
        stage: &'static str,
        /// The fault and its fix.
        message: String,
    },
}

impl Error {
    /// An [`Error::Mesh`] at `place` with a sentence of its own ([`MeshError::Other`]).
    pub fn mesh(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Mesh { place: place.into(), problem: MeshError::Other { message: message.into() } }
    }

    /// An [`Error::Value`] about `field`.
    pub fn value(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Value { field: field.into(), message: message.into() }
    }

    /// An [`Error::Numeric`] in `stage`.
    pub fn numeric(stage: &'static str, message: impl Into<String>) -> Self {
        Self::Numeric { stage, message: message.into() }
    }

    /// An [`Error::Parse`] in `path` at `line` (from 1).
    pub fn parse(path: &Path, line: usize, message: impl Into<String>) -> Self {
        Self::Parse { path: path.to_path_buf(), line, message: message.into() }
    }

    /// An [`Error::File`] for reading `path`.
    pub fn reading(path: &Path, source: std::io::Error) -> Self {
        let fix = match source.kind() {
            std::io::ErrorKind::NotFound => "check the path's spelling",
            std::io::ErrorKind::PermissionDenied => "allow this user to read it",
            _ => "check that it is a readable text file",
        };
        let (place, path) = (String::new(), path.to_path_buf());
        Self::File { place, path, doing: "reading", source, fix }
    }

    /// An [`Error::File`] for writing `path`.
    pub fn writing(path: &Path, source: std::io::Error) -> Self {
        let fix = "choose a folder that exists, can be written and has room";
        let (place, path) = (String::new(), path.to_path_buf());
        Self::File { place, path, doing: "writing", source, fix }
    }

    /// The field of an [`Error::Value`].
    pub fn field(&self) -> Option<&str> {
        match self {
            Self::Value { field, .. } => Some(field),
            _ => None,
        }
    }

    /// The same error, about `field`: the name that the caller has for what an [`Error::Value`]
    /// names otherwise. Other errors stay as they are.
    pub fn about(self, field: impl Into<String>) -> Self {
        match self {
            Self::Value { message, .. } => Self::Value { field: field.into(), message },
            other => other,
        }
    }
}

impl From<MeshError> for Error {
    fn from(problem: MeshError) -> Self {
        Self::Mesh { place: String::new(), problem }
    }
}

impl From<ObstacleError> for Error {
    fn from(problem: ObstacleError) -> Self {
        MeshError::from(problem).into()
    }
}

impl From<SetupError> for Error {
    fn from(problem: SetupError) -> Self {
        Self::Setup { place: problem.part().to_owned(), problem }
    }
}
