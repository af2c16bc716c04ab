//! What the types of a scene cannot say: ranges, names that must exist or be unique, fields that belong to another shape.

use super::schema::{MeasureKind, PanelTable, Place, Scene, Shape};
use crate::field::Terms;
use crate::material::Material;
use crate::mesh::Vec3;
use crate::mesh::panel::Outline;
use crate::{Error, Result};

/// Longest length and farthest coordinate (m): the squares of what lies beyond serve nobody.
const FARTHEST_M: f64 = 1e9;
/// Most iterations one may ask for.
const MOST_ITERATIONS: usize = 1_000_000;
/// Most rings that curvature may be fitted to.
const MOST_RINGS: usize = 20;
/// Most subdivisions: each makes four faces of one.
const MOST_LEVELS: usize = 6;
/// Name in `field.without` that is no term of the energy.
pub(super) const RELAXED_INTEGRABILITY: &str = "relaxed-integrability";

impl Scene {
    /// All checks that need no mesh; fields in errors are dotted names.
    pub(super) fn check(&self) -> Result<()> {
        not_blank("title", &self.title)?;
        self.checked_material()?;
        if self.panel.is_empty() {
            return Err(Error::value("panel", "the scene has no panel; add at least one [[panel]]"));
        }
        for (i, panel) in self.panel.iter().enumerate() {
            check_panel(&format!("panel[{i}]"), panel)?;
            if let Some(j) = self.panel[..i].iter().position(|other| other.name == panel.name) {
                let message = format!("panel[{j}] is called \"{}\", too; give each panel a name of its own", panel.name);
                return Err(Error::value(format!("panel[{i}].name"), message));
            }
        }
        for (i, seam) in self.seam.iter().enumerate() {
            let a = self.side(&format!("seam[{i}].a"), &seam.a)?;
            if self.side(&format!("seam[{i}].b"), &seam.b)? == a {
                let message = format!("\"{}\" is already a; a side cannot be sewn to itself, so name another one", seam.b);
                return Err(Error::value(format!("seam[{i}].b"), message));
            }
        }
        self.check_clamps()?;
        self.check_options()?;
        self.check_measures()
    }

    /// The material.
    pub(super) fn checked_material(&self) -> Result<Material> {
        let m = &self.material;
        Material::new(m.young_pa, m.poisson, m.thickness_m).map_err(|error| match error {
            Error::Value { field, message } => {
                let unit = match field.as_str() {
                    "young" => "_pa",
                    "thickness" => "_m",
                    _ => "",
                };
                Error::Value { field: format!("material.{field}{unit}"), message }
            }
            other => other,
        })
    }

    /// Panel and side that `reference`, "panel.side", names.
    pub(super) fn side(&self, field: &str, reference: &str) -> Result<(usize, String)> {
        let Some((panel, side)) = reference.rsplit_once('.') else {
            let message = format!("\"{reference}\" names no side; write it as \"panel.side\", such as \"{}\"", self.sides().join("\", \""));
            return Err(Error::value(field, message));
        };
        let Some(p) = self.panel.iter().position(|other| other.name == panel) else {
            return Err(self.no_panel(field, panel));
        };
        let names = side_names(&self.panel[p]);
        if !names.iter().any(|name| name == side) {
            let message = format!("panel \"{panel}\" has no side \"{side}\"; its sides are {}", names.join(", "));
            return Err(Error::value(field, message));
        }
        Ok((p, side.to_owned()))
    }

    /// All sides, as one may name them; a few of them if there are many.
    fn sides(&self) -> Vec<String> {
        let all = self.panel.iter().flat_map(|p| side_names(p).into_iter().map(|side| format!("{}.{side}", p.name)));
        all.take(4).collect()
    }

    fn no_panel(&self, field: &str, name: &str) -> Error {
        let names: Vec<&str> = self.panel.iter().map(|p| p.name.as_str()).collect();
        Error::value(field, format!("there is no panel \"{name}\"; the panels are {}", names.join(", ")))
    }

    fn check_clamps(&self) -> Result<()> {
        for (i, clamp) in self.clamp.iter().enumerate() {
            let field = |name: &str| format!("clamp[{i}].{name}");
            self.side(&field("side"), &clamp.side)?;
            let letters: Vec<char> = clamp.axes.chars().collect();
            let twice = letters.iter().enumerate().any(|(k, c)| letters[..k].contains(c));
            if letters.is_empty() || twice || letters.iter().any(|c| !"xyz".contains(*c)) {
                let message = format!("\"{}\" names no axes; give some of the letters x, y and z, each once", clamp.axes);
                return Err(Error::value(field("axes"), message));
            }
            in_reach(&field("move_m"), &clamp.move_m)?;
            if let Some(turn) = &clamp.turn {
                direction(&field("turn.axis"), turn.axis)?;
                in_reach(&field("turn.centre_m"), &turn.centre_m)?;
                if !(turn.angle_deg.abs() <= 1e6) {
                    let message = format!("{} is no usable angle; give degrees between -1e6 and 1e6", turn.angle_deg);
                    return Err(Error::value(field("turn.angle_deg"), message));
                }
            }
        }
        Ok(())
    }

    fn check_options(&self) -> Result<()> {
        if let Some(share) = self.base.compressive_stiffness
            && !(0.0..=1.0).contains(&share)
        {
            return Err(Error::value("base.compressive_stiffness", format!("{share} is no share; give a number from 0 to 1")));
        }
        within("base.iteration_limit", self.base.iteration_limit, 1, MOST_ITERATIONS)?;
        within("field.iteration_limit", self.field.iteration_limit, 1, MOST_ITERATIONS)?;
        within("field.curvature_rings", self.field.curvature_rings, 1, MOST_RINGS)?;
        within("surface.levels", self.surface.levels, 0, MOST_LEVELS)?;
        for (i, name) in self.field.without.iter().enumerate() {
            let field = format!("field.without[{i}]");
            if name != RELAXED_INTEGRABILITY && Terms::default().without(name).is_none() {
                let names = Terms::NAMES.join(", ");
                return Err(Error::value(field, format!("there is no term \"{name}\"; the terms are {names}, {RELAXED_INTEGRABILITY}")));
            }
            if self.field.without[..i].contains(name) {
                return Err(Error::value(field, format!("\"{name}\" is left out twice; remove one")));
            }
        }
        Ok(())
    }

    fn check_measures(&self) -> Result<()> {
        for (i, measure) in self.measure.iter().enumerate() {
            let field = |name: &str| format!("measure[{i}].{name}");
            not_blank(&field("name"), &measure.name)?;
            if let Some(j) = self.measure[..i].iter().position(|other| other.name == measure.name) {
                let message = format!("measure[{j}] is called \"{}\", too; give each measure a name of its own", measure.name);
                return Err(Error::value(field("name"), message));
            }
            let along = measure.kind == MeasureKind::WavesAlong;
            for (name, given) in
                [("panel", measure.panel.is_some()), ("from_m", measure.from_m.is_some()), ("to_m", measure.to_m.is_some())]
            {
                if given != along {
                    let message = if along {
                        "this is missing; waves_along needs panel, from_m and to_m"
                    } else {
                        "only waves_along has this; remove it or change the kind"
                    };
                    return Err(Error::value(field(name), message));
                }
            }
            if let (Some(panel), Some(from), Some(to)) = (&measure.panel, &measure.from_m, &measure.to_m) {
                if !self.panel.iter().any(|p| p.name == *panel) {
                    return Err(self.no_panel(&field("panel"), panel));
                }
                in_reach(&field("from_m"), from)?;
                in_reach(&field("to_m"), to)?;
                if from == to {
                    return Err(Error::value(field("to_m"), "this is where the line starts; give another end"));
                }
            }
            if let Some(published) = measure.published
                && !published.is_finite()
            {
                return Err(Error::value(field("published"), format!("{published} is no measured number; give it or leave it out")));
            }
        }
        Ok(())
    }
}

/// The outline of a panel called `place` in errors.
pub(super) fn outline(place: &str, panel: &PanelTable) -> Result<Outline> {
    let given = [
        ("width_m", panel.width_m.is_some()),
        ("height_m", panel.height_m.is_some()),
        ("radius_m", panel.radius_m.is_some()),
        ("inner_radius_m", panel.inner_radius_m.is_some()),
        ("outer_radius_m", panel.outer_radius_m.is_some()),
        ("corners_m", panel.corners_m.is_some()),
    ];
    let (shape, needed): (&str, &[&str]) = match panel.shape {
        Shape::Rectangle => ("a rectangle", &["width_m", "height_m"]),
        Shape::Disk => ("a disk", &["radius_m"]),
        Shape::Annulus => ("an annulus", &["inner_radius_m", "outer_radius_m"]),
        Shape::Polygon => ("a polygon", &["corners_m"]),
    };
    for (name, is_given) in given {
        if is_given != needed.contains(&name) {
            let what = if is_given { "has no such field; remove it" } else { "needs this; give it" };
            let message = format!("{shape} {what} (its sizes: {})", needed.join(", "));
            return Err(Error::value(format!("{place}.{name}"), message));
        }
    }
    let size = |name: &str, value: Option<f64>| positive(&format!("{place}.{name}"), value.unwrap_or_default());
    Ok(match panel.shape {
        Shape::Rectangle => {
            Outline::Rectangle { width_m: size("width_m", panel.width_m)?, height_m: size("height_m", panel.height_m)? }
        }
        Shape::Disk => Outline::Disk { radius_m: size("radius_m", panel.radius_m)? },
        Shape::Annulus => Outline::Annulus {
            inner_radius_m: size("inner_radius_m", panel.inner_radius_m)?,
            outer_radius_m: size("outer_radius_m", panel.outer_radius_m)?,
        },
        Shape::Polygon => {
            let corners_m = panel.corners_m.clone().unwrap_or_default();
            for (c, corner) in corners_m.iter().enumerate() {
                in_reach(&format!("{place}.corners_m[{c}]"), corner)?;
            }
            Outline::Polygon { corners_m }
        }
    })
}

/// Unit vector along `axis`.
pub(super) fn direction(field: &str, axis: [f64; 3]) -> Result<Vec3> {
    in_reach(field, &axis)?;
    let axis = Vec3::from(axis);
    axis.try_normalize(1e-100).ok_or_else(|| Error::value(field, "the axis has no length; give a direction such as [0.0, 0.0, 1.0]"))
}

/// Unit vectors along the axes of a flat place.
pub(super) fn plane(place: &str, x_axis: [f64; 3], y_axis: [f64; 3]) -> Result<[Vec3; 2]> {
    let x = direction(&format!("{place}.place.x_axis"), x_axis)?;
    let y = direction(&format!("{place}.place.y_axis"), y_axis)?;
    if x.dot(&y).abs() > 1e-9 {
        let message = "the axes are not perpendicular, which would stretch the panel; give perpendicular ones";
        return Err(Error::value(format!("{place}.place.y_axis"), message));
    }
    Ok([x, y])
}

fn check_panel(place: &str, panel: &PanelTable) -> Result<()> {
    not_blank(&format!("{place}.name"), &panel.name)?;
    if panel.name.contains('.') {
        let message = format!("\"{}\" has a dot, which separates panel and side; write the name without", panel.name);
        return Err(Error::value(format!("{place}.name"), message));
    }
    outline(place, panel)?;
    positive(&format!("{place}.edge_length_m"), panel.edge_length_m)?;
    match panel.place {
        Place::Flat { origin_m, x_axis, y_axis } => {
            in_reach(&format!("{place}.place.origin_m"), &origin_m)?;
            plane(place, x_axis, y_axis)?;
        }
        Place::Rolled { radius_m } => {
            positive(&format!("{place}.place.radius_m"), radius_m)?;
        }
    }
    Ok(())
}

/// Names of a panel's sides, as [`Outline`] lists them.
fn side_names(panel: &PanelTable) -> Vec<String> {
    let names: &[&str] = match panel.shape {
        Shape::Rectangle => &["bottom", "right", "top", "left"],
        Shape::Disk => &["rim"],
        Shape::Annulus => &["outer", "inner"],
        Shape::Polygon => return (0..panel.corners_m.as_ref().map_or(0, Vec::len)).map(|side| side.to_string()).collect(),
    };
    names.iter().map(|&name| name.to_owned()).collect()
}

fn not_blank(field: &str, text: &str) -> Result<()> {
    if text.trim().is_empty() { Err(Error::value(field, "this is empty; write a name")) } else { Ok(()) }
}

fn positive(field: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value <= FARTHEST_M {
        Ok(value)
    } else {
        Err(Error::value(field, format!("{value} is no usable length; give a number of metres above 0 and at most {FARTHEST_M:e}")))
    }
}

fn in_reach(field: &str, values: &[f64]) -> Result<()> {
    match values.iter().find(|value| !(value.abs() <= FARTHEST_M)) {
        None => Ok(()),
        Some(value) => Err(Error::value(field, format!("{value} is no usable number; give finite ones of at most {FARTHEST_M:e}"))),
    }
}

fn within(field: &str, value: Option<usize>, low: usize, high: usize) -> Result<()> {
    match value {
        Some(value) if !(low..=high).contains(&value) => {
            Err(Error::value(field, format!("{value} is out of range; give a whole number from {low} to {high}")))
        }
        _ => Ok(()),
    }
}
