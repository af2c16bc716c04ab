//! References in a scene file: sides of panels by name, and files by their path.

use std::path::{Path, PathBuf};

use super::schema::{PanelTable, Scene, Shape};
use crate::mesh::panel::Outline;
use crate::{Error, Result};

impl Scene {
    /// Panel and side that `reference`, "panel.side", names.
    pub(super) fn side(&self, field: &str, reference: &str) -> Result<(usize, String)> {
        if self.mesh.is_some() {
            return Err(Error::value(field, "a mesh has no sides; use near_m or within_m"));
        }
        let Some((panel, side)) = reference.rsplit_once('.') else {
            let message = format!(
                "\"{reference}\" names no side; write it as \"panel.side\", such as \"{}\"",
                self.sides().join("\", \"")
            );
            return Err(Error::value(field, message));
        };
        let Some(p) = self.panel.iter().position(|other| other.name == panel) else {
            return Err(self.no_panel(field, panel));
        };
        let names = side_names(&self.panel[p]);
        if names.is_empty() {
            return Err(Error::value(
                field,
                format!("panel \"{panel}\" is closed and has no sides; use near_m or within_m"),
            ));
        }
        if !names.iter().any(|name| name == side) {
            let message = format!(
                "panel \"{panel}\" has no side \"{side}\"; its sides are {}",
                names.join(", ")
            );
            return Err(Error::value(field, message));
        }
        Ok((p, side.to_owned()))
    }

    /// All sides, as one may name them; a few of them if there are many.
    fn sides(&self) -> Vec<String> {
        let all = self
            .panel
            .iter()
            .flat_map(|p| side_names(p).into_iter().map(|side| format!("{}.{side}", p.name)));
        all.take(4).collect()
    }

    pub(super) fn no_panel(&self, field: &str, name: &str) -> Error {
        if self.panel.is_empty() {
            return Error::value(
                field,
                format!(
                    "a mesh has no panels, so there is no \"{name}\"; remove this, or give panels"
                ),
            );
        }
        let names: Vec<&str> = self.panel.iter().map(|p| p.name.as_str()).collect();
        Error::value(
            field,
            format!("there is no panel \"{name}\"; the panels are {}", names.join(", ")),
        )
    }

    /// A path that the scene file gives relative to itself.
    pub(super) fn beside(&self, path: &Path) -> PathBuf {
        self.file.parent().map_or_else(|| path.to_path_buf(), |folder| folder.join(path))
    }
}

/// Names of a panel's sides, as [`Outline`] lists them.
fn side_names(panel: &PanelTable) -> Vec<String> {
    if let Some(sides) = &panel.sides {
        return sides.iter().map(|side| side.name.clone()).collect();
    }
    let names: &[&str] = match panel.shape {
        Shape::Rectangle => &Outline::RECTANGLE_SIDES,
        Shape::Disk => &["rim"],
        Shape::Annulus => &["outer", "inner"],
        Shape::Sphere | Shape::Torus => &[],
        Shape::Polygon => {
            return (0..panel.corners_m.as_ref().map_or(0, Vec::len))
                .map(|side| side.to_string())
                .collect();
        }
    };
    names.iter().map(|&name| name.to_owned()).collect()
}
