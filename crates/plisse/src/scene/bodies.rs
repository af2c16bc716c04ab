//! Obstacles: what a scene says about them, and the bodies it means.

use nalgebra::{Rotation3, Unit};

use super::schema::{ObstacleKind, ObstacleTable, Scene};
use super::value::{angle, direction, in_reach, not_blank, not_blank_path, positive};
use crate::io::obj;
use crate::mesh::Vec3;
use crate::obstacle::Obstacle;
use crate::{At, Error, Result};

/// Checks that need no file.
pub(super) fn check(scene: &Scene) -> Result<()> {
    for (i, table) in scene.obstacle.iter().enumerate() {
        let place = format!("obstacle[{i}]");
        not_blank(&format!("{place}.name"), &table.name)?;
        if let Some(j) = scene.obstacle[..i].iter().position(|other| other.name == table.name) {
            let message = format!(
                "obstacle[{j}] is called \"{}\", too; give each obstacle a name of its own",
                table.name
            );
            return Err(Error::value(format!("{place}.name"), message));
        }
        check_fields(&place, table)?;
        for (name, point) in [
            ("point_m", table.point_m),
            ("centre_m", table.centre_m),
            ("from_m", table.from_m),
            ("to_m", table.to_m),
        ] {
            if let Some(point) = point {
                in_reach(&format!("{place}.{name}"), &point)?;
            }
        }
        for (name, length) in [
            ("radius_m", table.radius_m),
            ("end_radius_m", table.end_radius_m),
            ("tube_radius_m", table.tube_radius_m),
            ("metres_per_unit", table.metres_per_unit),
        ] {
            if let Some(length) = length {
                positive(&format!("{place}.{name}"), length)?;
            }
        }
        for (k, radius) in table.radii_m.iter().flatten().enumerate() {
            positive(&format!("{place}.radii_m[{k}]"), *radius)?;
        }
        if let Some(normal) = table.normal {
            direction(&format!("{place}.normal"), normal)?;
        }
        if let Some(axis) = table.axis {
            direction(&format!("{place}.axis"), axis)?;
        }
        if let Some(turn) = &table.turn {
            direction(&format!("{place}.turn.axis"), turn.axis)?;
            angle(&format!("{place}.turn.angle_deg"), turn.angle_deg)?;
        }
        if let Some(file) = &table.file {
            not_blank_path(&format!("{place}.file"), file)?;
        }
    }
    Ok(())
}

/// Each kind has its own fields, some of which may be left out.
fn check_fields(place: &str, table: &ObstacleTable) -> Result<()> {
    let given = [
        ("point_m", table.point_m.is_some()),
        ("normal", table.normal.is_some()),
        ("centre_m", table.centre_m.is_some()),
        ("radius_m", table.radius_m.is_some()),
        ("from_m", table.from_m.is_some()),
        ("to_m", table.to_m.is_some()),
        ("end_radius_m", table.end_radius_m.is_some()),
        ("radii_m", table.radii_m.is_some()),
        ("turn", table.turn.is_some()),
        ("axis", table.axis.is_some()),
        ("tube_radius_m", table.tube_radius_m.is_some()),
        ("file", table.file.is_some()),
        ("metres_per_unit", table.metres_per_unit.is_some()),
    ];
    let (kind, needed, more): (&str, &[&str], &[&str]) = match table.kind {
        ObstacleKind::Plane => ("a plane", &["point_m", "normal"], &[]),
        ObstacleKind::Sphere => ("a sphere", &["centre_m", "radius_m"], &[]),
        ObstacleKind::Capsule => ("a capsule", &["from_m", "to_m", "radius_m"], &["end_radius_m"]),
        ObstacleKind::Ellipsoid => ("an ellipsoid", &["centre_m", "radii_m"], &["turn"]),
        ObstacleKind::Torus => ("a torus", &["centre_m", "axis", "radius_m", "tube_radius_m"], &[]),
        ObstacleKind::Mesh => ("a mesh", &["file"], &["metres_per_unit"]),
    };
    for (name, is_given) in given {
        let what = match (is_given, needed.contains(&name), more.contains(&name)) {
            (false, true, _) => "needs this; give it",
            (true, false, false) => "has no such field; remove it",
            _ => continue,
        };
        let fields = [needed, more].concat().join(", ");
        return Err(Error::value(
            format!("{place}.{name}"),
            format!("{kind} {what} (its fields: {fields})"),
        ));
    }
    Ok(())
}

/// The scene's obstacles, in its order.
pub(super) fn obstacles(scene: &Scene) -> Result<Vec<Obstacle>> {
    let body = |(i, table): (usize, &ObstacleTable)| {
        let place = format!("obstacle[{i}]");
        obstacle(scene, &place, table).map_err(|error| {
            // The library names the obstacle; a scene names the field.
            let own = format!("{}.", table.name);
            match error.field().and_then(|field| field.strip_prefix(&own)) {
                Some(name) => {
                    let field = format!("{place}.{name}");
                    error.about(field)
                }
                None => error,
            }
        })
    };
    scene.obstacle.iter().enumerate().map(body).collect()
}

fn obstacle(scene: &Scene, place: &str, table: &ObstacleTable) -> Result<Obstacle> {
    // All of these are given where check_fields says that they are needed.
    let point = |given: Option<[f64; 3]>| Vec3::from(given.unwrap_or_default());
    let radius = table.radius_m.unwrap_or_default();
    match table.kind {
        ObstacleKind::Plane => {
            Obstacle::plane(&table.name, point(table.point_m), point(table.normal))
        }
        ObstacleKind::Sphere => Obstacle::sphere(&table.name, point(table.centre_m), radius),
        ObstacleKind::Capsule => {
            let end_radius = table.end_radius_m.unwrap_or(radius);
            Obstacle::capsule(
                &table.name,
                point(table.from_m),
                point(table.to_m),
                radius,
                end_radius,
            )
        }
        ObstacleKind::Ellipsoid => {
            let turn = table.turn.map_or_else(Rotation3::identity, |turn| {
                Rotation3::from_axis_angle(
                    &Unit::new_normalize(Vec3::from(turn.axis)),
                    turn.angle_deg.to_radians(),
                )
            });
            Obstacle::ellipsoid(
                &table.name,
                point(table.centre_m),
                table.radii_m.unwrap_or_default(),
                turn,
            )
        }
        ObstacleKind::Torus => Obstacle::torus(
            &table.name,
            point(table.centre_m),
            point(table.axis),
            radius,
            table.tube_radius_m.unwrap_or_default(),
        ),
        ObstacleKind::Mesh => {
            let path = scene.beside(table.file.as_deref().unwrap_or(&scene.file));
            let mesh = obj::read(&path).at(&format!("{place}.file"))?;
            let scale = table.metres_per_unit.unwrap_or(1.0);
            let positions: Vec<Vec3> = mesh.positions.iter().map(|p| p * scale).collect();
            let place = format!("{}, {place} ({})", scene.file.display(), path.display());
            Obstacle::mesh(&table.name, &positions, &mesh.faces).at(&place)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BuiltScene, build, parse};

    /// A sheet above what `obstacles` says; nothing holds it.
    fn built_at(path: &str, obstacles: &str) -> Result<BuiltScene> {
        let text = format!(
            "title = \"t\"\n[material]\nyoung_pa = 1e6\npoisson = 0.3\nthickness_m = \
             1e-3\ndensity_kg_m3 = 400\n\
             [[panel]]\nname = \"p\"\nshape = \"rectangle\"\nwidth_m = 3.0\nheight_m = \
             4.0\nedge_length_m = 1.0\n\
             [load]\ngravity_m_s2 = [0, 0, -9.81]\n{obstacles}"
        );
        build(&parse(path, &text)?)
    }

    fn built(obstacles: &str) -> Result<BuiltScene> {
        built_at("s.toml", obstacles)
    }

    const BODIES: &str = r#"
        [[obstacle]]
        name = "floor"
        kind = "plane"
        point_m = [9, 9, -3]
        normal = [0, 0, 2]
        [[obstacle]]
        name = "ball"
        kind = "sphere"
        centre_m = [0, 0, -2]
        radius_m = 1.5
        [[obstacle]]
        name = "arm"
        kind = "capsule"
        from_m = [0, 0, -2]
        to_m = [2, 0, -2]
        radius_m = 0.5
        [[obstacle]]
        name = "egg"
        kind = "ellipsoid"
        centre_m = [0, 0, -2]
        radii_m = [1.5, 1.0, 0.5]
        turn = { axis = [0, 2, 0], angle_deg = -90 }
        [[obstacle]]
        name = "ring"
        kind = "torus"
        centre_m = [0, 0, -2]
        axis = [0, 0, 3]
        radius_m = 1.75
        tube_radius_m = 0.75
        [contact]
        thickness_m = 0.002
    "#;

    #[test]
    fn bodies_are_where_the_scene_says() {
        let b = built(BODIES).unwrap();
        let distances: Vec<f64> =
            b.obstacles.iter().map(|body| body.distance_m(&Vec3::zeros())).collect();
        // The turn stands the ellipsoid up.
        for (found, expected) in
            distances.iter().zip([3.0, 0.5, 1.5, 0.5, (4.0_f64 + 1.75 * 1.75).sqrt() - 0.75])
        {
            assert!((found - expected).abs() < 1e-9, "{distances:?}");
        }
        assert_eq!((b.obstacles.len(), b.contact_thickness_m), (5, 0.002));
        let wide = built(
            &BODIES
                .replace("radius_m = 0.5\n", "radius_m = 0.5\nend_radius_m = 1.0\n")
                .replace("thickness_m = 0.002", ""),
        )
        .unwrap();
        assert!((wide.obstacles[2].distance_m(&Vec3::new(2.0, 0.0, 0.0)) - 1.0).abs() < 0.2);
        assert!((wide.contact_thickness_m - 5e-3).abs() < 1e-15, "a thousandth of the diagonal");
    }

    #[test]
    fn wrong_bodies_name_their_field() {
        for (from, to, field, says) in [
            (
                "name = \"ball\"",
                "name = \"floor\"",
                "obstacle[1].name",
                "obstacle[0] is called \"floor\", too",
            ),
            ("name = \"ball\"", "name = \" \"", "obstacle[1].name", "empty"),
            ("normal = [0, 0, 2]", "normal = [0, 0, 0]", "obstacle[0].normal", "no length"),
            (
                "normal = [0, 0, 2]",
                "",
                "obstacle[0].normal",
                "a plane needs this; give it (its fields: point_m, normal)",
            ),
            (
                "radius_m = 1.5",
                "radius_m = 1.5\nto_m = [0, 0, 1]",
                "obstacle[1].to_m",
                "a sphere has no such field",
            ),
            (
                "radius_m = 1.5",
                "radius_m = -1.5",
                "obstacle[1].radius_m",
                "-1.5 is no usable length",
            ),
            ("radius_m = 1.5", "radius_m = 1e8", "obstacle[1].radius_m", "1e6"),
            ("[9, 9, -3]", "[9, 9, nan]", "obstacle[0].point_m", "NaN"),
            (
                "[1.5, 1.0, 0.5]",
                "[1.5, 0.0, 0.5]",
                "obstacle[3].radii_m[1]",
                "0 is no usable length",
            ),
            ("[1.5, 1.0, 0.5]", "[1.5, 1e-6, 0.5]", "obstacle[3].radii_m", "unlike"),
            ("[0, 2, 0]", "[0, 0, 0]", "obstacle[3].turn.axis", "no length"),
            ("-90", "inf", "obstacle[3].turn.angle_deg", "inf"),
            ("axis = [0, 0, 3]", "axis = [0, 0, 0]", "obstacle[4].axis", "no length"),
            ("axis = [0, 0, 3]", "", "obstacle[4].axis", "a torus needs this"),
            (
                "tube_radius_m = 0.75",
                "tube_radius_m = 1.75",
                "obstacle[4].tube_radius_m",
                "closes the hole",
            ),
            (
                "thickness_m = 0.002",
                "thickness_m = 0",
                "contact.thickness_m",
                "0 is no usable length",
            ),
        ] {
            assert_eq!(BODIES.matches(from).count(), 1, "{from}");
            let text = built(&BODIES.replace(from, to)).unwrap_err().to_string();
            assert!(
                text.starts_with(&format!("s.toml, {field}: ")) && text.contains(says),
                "{from} -> {to}: {text}"
            );
        }
    }

    #[test]
    fn meshes_are_read_beside_the_scene_and_their_faults_told() {
        let folder = std::env::temp_dir().join(format!("plisse-bodies-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let scene = folder.join("s.toml");
        let solid = "v 0 0 -100\nv 100 0 -100\nv 0 100 -100\nv 0 0 -200\nf 1 2 3\nf 1 4 2\nf 1 3 \
            4\nf 2 4 3\n";
        std::fs::write(folder.join("solid.obj"), solid).unwrap();
        std::fs::write(folder.join("holes.obj"), solid.replace("f 1 2 3\n", "")).unwrap();
        let with = |file: &str| {
            built_at(
                scene.to_str().unwrap(),
                &format!(
                    "[[obstacle]]\nname = \"block\"\nkind = \"mesh\"\nfile = \
                     \"{file}\"\nmetres_per_unit = 0.01"
                ),
            )
        };
        let b = with("solid.obj").unwrap();
        assert!((b.obstacles[0].distance_m(&Vec3::new(0.1, 0.1, 0.5)) - 1.5).abs() < 1e-12);
        let text = with("holes.obj").unwrap_err().to_string();
        assert!(
            text.contains("s.toml, obstacle[0] (")
                && text.contains("holes.obj): the obstacle has holes"),
            "{text}"
        );
        let text = with("none.obj").unwrap_err().to_string();
        assert!(
            text.contains("s.toml, obstacle[0].file: ")
                && text.contains("none.obj")
                && text.contains("spelling"),
            "{text}"
        );
        assert!(with("").unwrap_err().to_string().contains("obstacle[0].file: this is empty"));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
