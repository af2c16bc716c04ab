//! Places of errors, added on the way up: the function that finds a fault knows the face or the
//! number, its callers know the field of the scene and the file.

use std::path::{Path, PathBuf};

use super::{Error, Result};

/// A place in what was given.
#[derive(Clone, Copy, Debug)]
pub enum Place<'a> {
    /// A file.
    File(&'a Path),
    /// A named part: a table, a field, a mesh.
    Part(&'a str),
}

impl<'a> From<&'a Path> for Place<'a> {
    fn from(path: &'a Path) -> Self {
        Self::File(path)
    }
}

impl<'a> From<&'a PathBuf> for Place<'a> {
    fn from(path: &'a PathBuf) -> Self {
        Self::File(path)
    }
}

impl<'a> From<&'a str> for Place<'a> {
    fn from(part: &'a str) -> Self {
        Self::Part(part)
    }
}

impl<'a> From<&'a String> for Place<'a> {
    fn from(part: &'a String) -> Self {
        Self::Part(part)
    }
}

impl Place<'_> {
    /// The place `inner` within this one: "material" and "poisson" are "material.poisson",
    /// "s.toml" and "material.poisson" are "s.toml, material.poisson".
    fn around(&self, inner: &str) -> String {
        match (self, inner.is_empty()) {
            (Self::File(path), true) => path.display().to_string(),
            (Self::File(path), false) => format!("{}, {inner}", path.display()),
            (Self::Part(part), true) => (*part).to_owned(),
            (Self::Part(part), false) => format!("{part}.{inner}"),
        }
    }
}

/// `place` and a colon, as they stand before the sentence of an error; nothing for no place.
pub(super) fn before(place: &str) -> String {
    if place.is_empty() { String::new() } else { format!("{place}: ") }
}

impl Error {
    /// The same error with `place` around the place that it has.
    ///
    /// - The field of an [`Error::Value`] and the part of an [`Error::Setup`] are refined:
    ///   "poisson" at "material" becomes "material.poisson".
    /// - An [`Error::Mesh`] takes `place` if it has none: the place nearest to the fault stays.
    /// - An [`Error::File`] takes the field that names the file. The file in which that field
    ///   stands is added to a field only.
    /// - [`Error::Parse`] and [`Error::Numeric`] know their places, and stay as they are.
    pub fn at<'a>(mut self, place: impl Into<Place<'a>>) -> Self {
        let outer = place.into();
        match &mut self {
            Self::Value { field: inner, .. } | Self::Setup { place: inner, .. } => {
                *inner = outer.around(inner);
            }
            Self::Mesh { place: inner, .. } if inner.is_empty() => *inner = outer.around(""),
            Self::File { place: inner, .. } => {
                if !inner.is_empty() || matches!(outer, Place::Part(_)) {
                    *inner = outer.around(inner);
                }
            }
            Self::Mesh { .. } | Self::Parse { .. } | Self::Numeric { .. } => {}
        }
        self
    }
}

/// [`Error::at`] for results: `Topology::new(count, faces).at("sheet")?`.
pub trait At {
    /// The same result; an error has `place` around the place that it has ([`Error::at`]).
    fn at<'a>(self, place: impl Into<Place<'a>>) -> Self;
}

impl<T> At for Result<T> {
    fn at<'a>(self, place: impl Into<Place<'a>>) -> Self {
        self.map_err(|error| error.at(place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{MeshError, SetupError};

    #[test]
    fn values_and_setups_are_refined() {
        let value = || Error::value("poisson", "it is 2; give less");
        assert_eq!(value().at("material").to_string(), "material.poisson: it is 2; give less");
        let in_file = value().at("material").at(Path::new("s.toml"));
        assert_eq!(in_file.to_string(), "s.toml, material.poisson: it is 2; give less");
        let setup = Error::from(SetupError::Unheld { axis: 1 }).at(Path::new("s.toml"));
        assert!(setup.to_string().starts_with("s.toml, clamps: nothing holds the surface along y"));
    }

    #[test]
    fn the_place_nearest_to_a_mesh_stays() {
        let mesh = || Error::from(MeshError::NoFaces);
        assert_eq!(mesh().to_string(), "the mesh has no faces; give a triangle mesh");
        let placed = mesh().at("sleeve").at(Path::new("s.toml"));
        assert_eq!(placed.to_string(), "sleeve: the mesh has no faces; give a triangle mesh");
        let placed = mesh().at(Path::new("m.obj"));
        assert_eq!(placed.to_string(), "m.obj: the mesh has no faces; give a triangle mesh");
    }

    #[test]
    fn a_file_takes_the_field_that_names_it() {
        let file = || Error::reading(Path::new("m.obj"), std::io::ErrorKind::NotFound.into());
        let alone = file().to_string();
        assert!(alone.starts_with("m.obj: reading failed"), "{alone}");
        assert_eq!(file().at(Path::new("s.toml")).to_string(), alone);
        let named = file().at("mesh.rest").at(Path::new("s.toml")).to_string();
        assert_eq!(named, format!("s.toml, mesh.rest: {alone}"));
    }

    #[test]
    fn lines_and_stages_stay() {
        let parse = || Error::parse(Path::new("m.obj"), 3, "no number; give one");
        assert_eq!(parse().at("mesh").at(Path::new("s.toml")).to_string(), parse().to_string());
        let numeric = || Error::numeric("base", "no energy; give less");
        assert_eq!(numeric().at("solve").to_string(), numeric().to_string());
    }
}
