//! The one error type of the library: each variant says where, what is wrong, and how to mend it,
//! in one sentence.

use std::path::{Path, PathBuf};

/// A [`std::result::Result`] with the library's [`enum@Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Why a call could not be done. The `Display` text is one sentence: the place, what is wrong
/// there, and the mend.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file or folder could not be read or written.
    #[error("{}: {doing} failed ({source}); {mend}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What was tried, e.g. "reading".
        doing: &'static str,
        /// What the operating system said.
        source: std::io::Error,
        /// What the user can do.
        mend: &'static str,
    },
    /// The text of a file is not what its format asks for.
    #[error("{}, line {line}: {message}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line in the file, counted from 1.
        line: usize,
        /// What is wrong and how to mend it.
        message: String,
    },
    /// A mesh is not usable; the message names vertex, edge or face (counted from 0) and the mend.
    #[error("{place}: {message}")]
    Mesh {
        /// The file or scene part the mesh came from.
        place: String,
        /// What is wrong and how to mend it.
        message: String,
    },
    /// A field of a scene file, a flag or an argument has an unusable value.
    #[error("{field}: {message}")]
    Value {
        /// The field or flag, e.g. "material.poisson".
        field: String,
        /// What is wrong and which values are allowed.
        message: String,
    },
    /// A numerical step could not go on.
    #[error("{stage}: {message}")]
    Numeric {
        /// The step of the pipeline, e.g. "base solve".
        stage: &'static str,
        /// What happened and how to mend it.
        message: String,
    },
}

impl Error {
    /// A [`Error::Mesh`] at `place`.
    pub fn mesh(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Mesh { place: place.into(), message: message.into() }
    }

    /// A [`Error::Value`] about `field`.
    pub fn value(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Value { field: field.into(), message: message.into() }
    }

    /// A [`Error::Numeric`] in `stage`.
    pub fn numeric(stage: &'static str, message: impl Into<String>) -> Self {
        Self::Numeric { stage, message: message.into() }
    }

    /// A [`Error::Parse`] in `path` at `line` (from 1).
    pub fn parse(path: &Path, line: usize, message: impl Into<String>) -> Self {
        Self::Parse { path: path.to_path_buf(), line, message: message.into() }
    }

    /// A [`Error::File`] for reading `path`.
    pub fn reading(path: &Path, source: std::io::Error) -> Self {
        let mend = match source.kind() {
            std::io::ErrorKind::NotFound => "check the path's spelling",
            std::io::ErrorKind::PermissionDenied => "allow this user to read it",
            _ => "check that it is a readable text file",
        };
        Self::File { path: path.to_path_buf(), doing: "reading", source, mend }
    }

    /// A [`Error::File`] for writing `path`.
    pub fn writing(path: &Path, source: std::io::Error) -> Self {
        let mend = "choose a folder that exists, can be written and has room (-o DIR)";
        Self::File { path: path.to_path_buf(), doing: "writing", source, mend }
    }
}
