//! Edits of a scene's text: constants and clamps change; everything else stays, comments too.

use plisse::scene::{Scene, parse};
use plisse::{Error, Result};
use toml_edit::{Array, DocumentMut, Item, Value, value};

use super::subject::{SceneText, ready};
use crate::fabrics::Fabric;

/// An edit by the Physics tab.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// The constants of the material.
    Material {
        /// Young's modulus (Pa).
        young_pa: f64,
        /// Poisson's ratio.
        poisson: f64,
        /// Thickness (m).
        thickness_m: f64,
        /// Density (kg/m³), where the scene has or needs one.
        density_kg_m3: Option<f64>,
    },
    /// The displacement of a clamp.
    ClampMove {
        /// Number of the clamp.
        clamp: usize,
        /// Displacement from the start (m).
        move_m: [f64; 3],
    },
    /// The angle of a clamp that turns.
    ClampTurn {
        /// Number of the clamp.
        clamp: usize,
        /// Angle (degrees).
        angle_deg: f64,
    },
    /// The pressure inside.
    Pressure {
        /// Pressure above that outside (Pa).
        pressure_pa: f64,
    },
}

impl Edit {
    /// The constants of `fabric`.
    pub fn fabric(fabric: &Fabric) -> Self {
        let Fabric { young_pa, poisson, thickness_m, density_kg_m3, .. } = *fabric;
        Self::Material { young_pa, poisson, thickness_m, density_kg_m3: Some(density_kg_m3) }
    }
}

/// An edited scene that is not built yet.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The file's text.
    pub text: String,
    /// The scene in it.
    pub scene: Scene,
}

impl Draft {
    /// `scene` as it is.
    pub fn of(scene: &SceneText) -> Self {
        Self { text: scene.text.clone(), scene: scene.scene.clone() }
    }

    /// This draft with one more edit.
    ///
    /// # Errors
    /// As [`parse`], for an invalid edit.
    pub fn with(&self, edit: &Edit) -> Result<Self> {
        let text = changed(&self.text, edit)?;
        let scene = parse(&self.scene.file, &text)?;
        Ok(Self { text, scene })
    }

    /// The scene ready for the solvers.
    ///
    /// # Errors
    /// As [`ready`].
    pub fn build(self) -> Result<SceneText> {
        let built = std::sync::Arc::new(ready(&self.scene)?);
        Ok(SceneText { text: self.text, scene: self.scene, built })
    }
}

/// A scene's `text` with `edit`.
fn changed(text: &str, edit: &Edit) -> Result<String> {
    let bad = |e: &dyn std::fmt::Display| {
        Error::value("scene", format!("its text is no TOML ({e}); correct it"))
    };
    let mut document: DocumentMut = text.parse().map_err(|e| bad(&e))?;
    match edit {
        Edit::Material { young_pa, poisson, thickness_m, density_kg_m3 } => {
            set(&mut document["material"], "young_pa", *young_pa);
            set(&mut document["material"], "poisson", *poisson);
            set(&mut document["material"], "thickness_m", *thickness_m);
            if let Some(density) = density_kg_m3 {
                set(&mut document["material"], "density_kg_m3", *density);
            }
        }
        Edit::ClampMove { clamp, move_m } => {
            let list: Array = move_m.iter().copied().collect();
            if let Some(clamp) = clamp_table(&mut document, *clamp) {
                clamp.insert("move_m", value(list));
            }
        }
        Edit::ClampTurn { clamp, angle_deg } => {
            let clamp = clamp_table(&mut document, *clamp);
            if let Some(turn) = clamp.and_then(|c| c.get_mut("turn")) {
                set(turn, "angle_deg", *angle_deg);
            }
        }
        Edit::Pressure { pressure_pa } => {
            if document.get("load").is_none() {
                document["load"] = toml_edit::table();
            }
            set(&mut document["load"], "pressure_pa", *pressure_pa);
        }
    }
    Ok(document.to_string())
}

/// Replaces a number, and keeps the comments and spaces around it.
fn set(table: &mut Item, key: &str, number: f64) {
    let Some(table) = table.as_table_like_mut() else { return };
    let mut fresh = Value::from(number);
    if let Some(old) = table.get(key).and_then(Item::as_value) {
        *fresh.decor_mut() = old.decor().clone();
    }
    table.insert(key, Item::Value(fresh));
}

/// The table of a clamp in a scene's text.
fn clamp_table(document: &mut DocumentMut, number: usize) -> Option<&mut dyn toml_edit::TableLike> {
    match document.get_mut("clamp")? {
        Item::ArrayOfTables(list) => {
            list.get_mut(number).map(|t| t as &mut dyn toml_edit::TableLike)
        }
        Item::Value(Value::Array(list)) => {
            list.get_mut(number)?.as_inline_table_mut().map(|t| t as &mut dyn toml_edit::TableLike)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Subject;

    #[test]
    fn constants_and_clamps_change_and_comments_stay() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/01-twisted-cylinder.toml");
        let subject = Subject::scene(path.into(), std::fs::read_to_string(path).unwrap()).unwrap();
        let scene = Draft::of(&subject.scene.unwrap());
        let found = scene.with(&Edit::ClampTurn { clamp: 1, angle_deg: 7.5 }).unwrap();
        assert_eq!(found.scene.clamp[1].turn.unwrap().angle_deg, 7.5);
        assert_eq!(found.text.lines().next(), scene.text.lines().next());
        let found = found.with(&Edit::ClampMove { clamp: 0, move_m: [0.0, 0.0, -0.01] }).unwrap();
        assert_eq!(found.scene.clamp[0].move_m, [0.0, 0.0, -0.01]);
        let found = found.with(&Edit::fabric(&crate::fabrics::FABRICS[0])).unwrap();
        assert_eq!(found.scene.material.young_pa, crate::fabrics::FABRICS[0].young_pa);
        // Every digit of a number comes back.
        let number = 0.1 + 0.2;
        let found = found.with(&Edit::ClampTurn { clamp: 1, angle_deg: number }).unwrap();
        assert_eq!(found.scene.clamp[1].turn.unwrap().angle_deg.to_bits(), number.to_bits());
        let bad =
            Edit::Material { young_pa: -1.0, poisson: 0.3, thickness_m: 1e-3, density_kg_m3: None };
        assert!(found.with(&bad).unwrap_err().to_string().contains("young"));
        assert_eq!(
            found.build().unwrap().built.sheet.material.young_pa,
            crate::fabrics::FABRICS[0].young_pa
        );
    }
}
