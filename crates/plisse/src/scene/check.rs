//! Checks of a scene beyond its types: ranges, names that must exist or be unique, fields that
//! belong to another shape.

use super::panels::check_panel;
use super::schema::{MeasureKind, Scene};
use super::value::{in_reach, not_blank, positive, within};
use super::{bodies, garment, growth, hold, options};
use crate::surface::MOST_LEVELS;
use crate::{Error, Result};

/// Highest density (kg/m³), far above any material's.
const MOST_DENSITY: f64 = 1e6;
/// Most iterations one may ask for.
const MOST_ITERATIONS: usize = 1_000_000;
/// Most rings that curvature may be fitted to.
const MOST_RINGS: usize = 20;

impl Scene {
    /// All checks that need no mesh; fields in errors are dotted names.
    pub(super) fn check(&self) -> Result<()> {
        not_blank("title", &self.title)?;
        options::material(self)?;
        self.check_loads()?;
        match &self.mesh {
            None if self.panel.is_empty() => {
                return Err(Error::value(
                    "panel",
                    "the scene has no panel and no mesh; add at least one [[panel]], or a [mesh]",
                ));
            }
            None => {}
            Some(_) if !self.panel.is_empty() => {
                return Err(Error::value(
                    "mesh",
                    "the scene has panels and a mesh; keep one of them",
                ));
            }
            Some(_) if !self.seam.is_empty() => {
                return Err(Error::value(
                    "seam",
                    "a mesh is sewn already, and has no sides; remove the seams",
                ));
            }
            Some(mesh) => garment::check(mesh)?,
        }
        for (i, panel) in self.panel.iter().enumerate() {
            check_panel(&format!("panel[{i}]"), panel)?;
            if let Some(j) = self.panel[..i].iter().position(|other| other.name == panel.name) {
                let message = format!(
                    "panel[{j}] is called \"{}\", too; give each panel a name of its own",
                    panel.name
                );
                return Err(Error::value(format!("panel[{i}].name"), message));
            }
        }
        for (i, seam) in self.seam.iter().enumerate() {
            let a = self.side(&format!("seam[{i}].a"), &seam.a)?;
            if self.side(&format!("seam[{i}].b"), &seam.b)? == a {
                let message = format!(
                    "\"{}\" is already a; a side cannot be sewn to itself, so name another one",
                    seam.b
                );
                return Err(Error::value(format!("seam[{i}].b"), message));
            }
        }
        hold::check(self)?;
        bodies::check(self)?;
        self.check_options()?;
        if let Some(table) = &self.growth {
            growth::check::check(self, table)?;
        }
        self.check_measures()
    }

    fn check_loads(&self) -> Result<()> {
        in_reach("load.gravity_m_s2", &self.load.gravity_m_s2)?;
        in_reach("load.pressure_pa", &[self.load.pressure_pa])?;
        let density = self.material.density_kg_m3;
        let field = "material.density_kg_m3";
        if let Some(density) = density
            && !(0.0..=MOST_DENSITY).contains(&density)
        {
            return Err(Error::value(
                field,
                format!("{density} is no density; give a number from 0 to {MOST_DENSITY:e} kg/m³"),
            ));
        }
        if self.load.gravity_m_s2 != [0.0; 3] && density.is_none_or(|density| density == 0.0) {
            return Err(Error::value(
                field,
                "gravity needs a density above 0; give it in kg/m³, such as 400.0 for cotton, or \
                 remove the gravity",
            ));
        }
        if let Some(thickness) = self.contact.thickness_m {
            positive("contact.thickness_m", thickness)?;
        }
        Ok(())
    }

    fn check_options(&self) -> Result<()> {
        if let Some(share) = self.base.compressive_stiffness
            && !(0.0..=1.0).contains(&share)
        {
            return Err(Error::value(
                "base.compressive_stiffness",
                format!("{share} is no share; give a number from 0 to 1"),
            ));
        }
        within("base.iteration_limit", self.base.iteration_limit, 1, MOST_ITERATIONS)?;
        within("field.iteration_limit", self.field.iteration_limit, 1, MOST_ITERATIONS)?;
        within("field.curvature_rings", self.field.curvature_rings, 1, MOST_RINGS)?;
        within("surface.levels", self.surface.levels, 0, MOST_LEVELS)?;
        options::field_options(self)?;
        for (i, name) in self.field.without.iter().enumerate() {
            if self.field.without[..i].contains(name) {
                return Err(Error::value(
                    format!("field.without[{i}]"),
                    format!("\"{name}\" is left out twice; remove one"),
                ));
            }
        }
        Ok(())
    }

    fn check_measures(&self) -> Result<()> {
        for (i, measure) in self.measure.iter().enumerate() {
            let field = |name: &str| format!("measure[{i}].{name}");
            not_blank(&field("name"), &measure.name)?;
            if let Some(j) = self.measure[..i].iter().position(|other| other.name == measure.name) {
                let message = format!(
                    "measure[{j}] is called \"{}\", too; give each measure a name of its own",
                    measure.name
                );
                return Err(Error::value(field("name"), message));
            }
            for (name, given, kind, word, needs) in [
                (
                    "panel",
                    measure.panel.is_some(),
                    MeasureKind::WavesAlong,
                    "waves_along",
                    "panel, from_m and to_m",
                ),
                (
                    "from_m",
                    measure.from_m.is_some(),
                    MeasureKind::WavesAlong,
                    "waves_along",
                    "panel, from_m and to_m",
                ),
                (
                    "to_m",
                    measure.to_m.is_some(),
                    MeasureKind::WavesAlong,
                    "waves_along",
                    "panel, from_m and to_m",
                ),
                ("side", measure.side.is_some(), MeasureKind::WavesAround, "waves_around", "side"),
            ] {
                let needed = measure.kind == kind;
                if given != needed {
                    let message = if needed {
                        format!("this is missing; {word} needs {needs}")
                    } else {
                        format!("only {word} has this; remove it or change the kind")
                    };
                    return Err(Error::value(field(name), message));
                }
            }
            if let Some(side) = &measure.side {
                self.side(&field("side"), side)?;
            }
            if let (Some(panel), Some(from), Some(to)) =
                (&measure.panel, &measure.from_m, &measure.to_m)
            {
                if !self.panel.iter().any(|p| p.name == *panel) {
                    return Err(self.no_panel(&field("panel"), panel));
                }
                in_reach(&field("from_m"), from)?;
                in_reach(&field("to_m"), to)?;
                if from == to {
                    return Err(Error::value(
                        field("to_m"),
                        "this is where the line starts; give another end",
                    ));
                }
            }
            if let Some(published) = measure.published
                && !published.is_finite()
            {
                return Err(Error::value(
                    field("published"),
                    format!("{published} is no measured number; give it or leave it out"),
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;

    const SCENE: &str = concat!(
        r#"
        title = "t"
        material = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }
        panel = [
            { name = "p", shape = "rectangle", width_m = 1.0, height_m = 0.5, "#,
        r#"edge_length_m = 0.1, place = { kind = "rolled", radius_m = 2.0 } },
            { name = "q", shape = "polygon", corners_m = [[0, 0], [1, 0], [0, 1]], "#,
        r#"edge_length_m = 0.2, "#,
        r#"place = { kind = "flat", x_axis = [1, 0, 0], y_axis = [0, 2, 0] } },
        ]
        seam = [{ a = "p.left", b = "p.right" }]
        clamp = [{ side = "q.2", axes = "zx", move_m = [0, 0, 0], turn = { axis = [0, 0, 1], "#,
        r#"angle_deg = 1 } }]
        base = { compressive_stiffness = 0.5, iteration_limit = 10 }
        field = { without = ["v1", "v2"], curvature_rings = 4, iteration_limit = 10 }
        surface = { levels = 8 }
        measure = [
            { name = "m", kind = "waves_along", panel = "p", from_m = [0, 0], to_m = [1, 0], "#,
        r#"published = 3 },
            { name = "n", kind = "peak_amplitude" },
        ]"#
    );

    #[test]
    fn wrong_values_name_their_field() {
        parse("s.toml", SCENE).unwrap();
        for (from, to, field, says) in [
            ("title = \"t\"", "title = \" \"", "title", "empty"),
            ("1e7", "-1", "material.young_pa", "above 0"),
            ("poisson = 0.3", "poisson = 0.6", "material.poisson", "0.6"),
            ("1e-4", "nan", "material.thickness_m", "NaN"),
            ("name = \"q\"", "name = \"p\"", "panel[1].name", "panel[0] is called \"p\", too"),
            ("name = \"q\"", "name = \"q.r\"", "panel[1].name", "dot"),
            ("width_m = 1.0, ", "", "panel[0].width_m", "a rectangle needs this"),
            (
                "width_m = 1.0",
                "width_m = 1.0, radius_m = 1.0",
                "panel[0].radius_m",
                "a rectangle has no such field",
            ),
            ("width_m = 1.0", "width_m = 0.0", "panel[0].width_m", "0 is no usable length"),
            ("height_m = 0.5", "height_m = 1e10", "panel[0].height_m", "1e9"),
            ("edge_length_m = 0.2", "edge_length_m = inf", "panel[1].edge_length_m", "inf"),
            ("[1, 0], [0, 1]]", "[1, nan], [0, 1]]", "panel[1].corners_m[1]", "NaN"),
            ("radius_m = 2.0", "radius_m = -2.0", "panel[0].place.radius_m", "-2"),
            ("[0, 2, 0]", "[1, 2, 0]", "panel[1].place.y_axis", "perpendicular"),
            ("x_axis = [1, 0, 0]", "x_axis = [0, 0, 0]", "panel[1].place.x_axis", "no length"),
            ("p.right", "p.up", "seam[0].b", "its sides are bottom, right, top, left"),
            ("p.right", "p.left", "seam[0].b", "cannot be sewn to itself"),
            ("p.left", "left", "seam[0].a", "\"panel.side\", such as \"p.bottom\""),
            ("q.2", "q.3", "clamp[0].side", "its sides are 0, 1, 2"),
            ("q.2", "r.2", "clamp[0].side", "the panels are p, q"),
            ("\"zx\"", "\"xx\"", "clamp[0].axes", "each once"),
            ("\"zx\"", "\"\"", "clamp[0].axes", "letters x, y and z"),
            ("\"zx\"", "\"xw\"", "clamp[0].axes", "letters x, y and z"),
            ("move_m = [0, 0, 0]", "move_m = [0, 0, 1e300]", "clamp[0].move_m", "finite"),
            ("axis = [0, 0, 1]", "axis = [0, 0, 0]", "clamp[0].turn.axis", "no length"),
            ("angle_deg = 1", "angle_deg = nan", "clamp[0].turn.angle_deg", "NaN"),
            (
                "angle_deg = 1",
                "angle_deg = 1, centre_m = [inf, 0, 0]",
                "clamp[0].turn.centre_m",
                "inf",
            ),
            ("0.5, iteration", "1.5, iteration", "base.compressive_stiffness", "from 0 to 1"),
            (
                "0.5, iteration_limit = 10",
                "0.5, iteration_limit = 0",
                "base.iteration_limit",
                "from 1 to 1000000",
            ),
            (
                "\"v2\"]",
                "\"v3\"]",
                "field.without[1]",
                "amplitude-gradient, bending, v1, v2, relaxed-integrability",
            ),
            ("\"v2\"]", "\"v1\"]", "field.without[1]", "twice"),
            ("rings = 4", "rings = 21", "field.curvature_rings", "from 1 to 20"),
            (
                "4, iteration_limit = 10",
                "4, iteration_limit = 1000001",
                "field.iteration_limit",
                "1000001",
            ),
            (
                "levels = 8",
                "levels = 9",
                "surface.levels",
                "9 is out of range; give a whole number from 0 to 8",
            ),
            ("name = \"n\"", "name = \"m\"", "measure[1].name", "measure[0]"),
            ("panel = \"p\", ", "", "measure[0].panel", "waves_along needs panel, from_m and to_m"),
            (
                "\"peak_amplitude\"",
                "\"peak_amplitude\", to_m = [1, 1]",
                "measure[1].to_m",
                "only waves_along",
            ),
            ("panel = \"p\"", "panel = \"s\"", "measure[0].panel", "the panels are p, q"),
            ("to_m = [1, 0]", "to_m = [0, 0]", "measure[0].to_m", "another end"),
            ("from_m = [0, 0]", "from_m = [0, nan]", "measure[0].from_m", "NaN"),
            ("published = 3", "published = inf", "measure[0].published", "inf"),
        ] {
            assert_eq!(SCENE.matches(from).count(), 1, "{from}");
            let text = parse("s.toml", &SCENE.replace(from, to)).unwrap_err().to_string();
            assert!(
                text.starts_with(&format!("s.toml, {field}: ")) && text.contains(says),
                "{from} -> {to}: {text}"
            );
        }
        let none =
            "title = \"t\"\npanel = []\nmaterial = { young_pa = 1, poisson = 0, thickness_m = 1 }";
        assert!(
            parse("s.toml", none).unwrap_err().to_string().contains("add at least one [[panel]]")
        );
    }
}
