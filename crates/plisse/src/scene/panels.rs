//! Panels: what a scene says about them, and the surface they are sewn to.

use super::closed;
use super::placed::{PlacedPanel, PlacedSurface, Side, extent};
use super::schema::{PanelTable, Pattern, Place, Scene, Shape, SideTable};
use super::value::{angle, direction, in_reach, not_blank, positive};
use crate::mesh::Vec3;
use crate::mesh::grid::{Diagonal, grid};
use crate::mesh::islands::side_by_side;
use crate::mesh::panel::{Outline, Panel};
use crate::mesh::sew::{Seam, Sewn, reversed, sew};
use crate::mesh::{Chart, RestShape};
use crate::{At, Error, Result};

/// Largest distance between the two start positions of a sewn vertex, relative to the size of the
/// start pose.
const SEAM_TOLERANCE: f64 = 1e-6;

/// Checks of a panel that need no mesh.
pub(super) fn check_panel(place: &str, panel: &PanelTable) -> Result<()> {
    not_blank(&format!("{place}.name"), &panel.name)?;
    if panel.name.contains('.') {
        let message = format!(
            "\"{}\" has a dot, which separates panel and side; write the name without",
            panel.name
        );
        return Err(Error::value(format!("{place}.name"), message));
    }
    check_sizes(place, panel)?;
    if panel.shape.closed() {
        closed::check(place, panel)?;
    } else {
        outline(place, panel)?;
    }
    positive(&format!("{place}.edge_length_m"), panel.edge_length_m)?;
    if let Some(sides) = &panel.sides {
        check_sides(place, sides)?;
    }
    check_pattern(place, panel)?;
    match panel.place {
        Place::Flat { origin_m, x_axis, y_axis } => {
            in_reach(&format!("{place}.place.origin_m"), &origin_m)?;
            plane(place, x_axis, y_axis)?;
        }
        Place::Rolled { radius_m, centre_m, start_deg } => {
            positive(&format!("{place}.place.radius_m"), radius_m)?;
            in_reach(&format!("{place}.place.centre_m"), &centre_m)?;
            angle(&format!("{place}.place.start_deg"), start_deg)?;
        }
    }
    Ok(())
}

/// The names that a polygon gives its sides; their corners are checked when it is cut.
fn check_sides(place: &str, sides: &[SideTable]) -> Result<()> {
    if sides.is_empty() {
        return Err(Error::value(
            format!("{place}.sides"),
            "this lists no side; list at least one, or remove it",
        ));
    }
    for (n, side) in sides.iter().enumerate() {
        let field = format!("{place}.sides[{n}].name");
        not_blank(&field, &side.name)?;
        if side.name.contains('.') {
            let message = format!(
                "\"{}\" has a dot, which separates panel and side; write the name without",
                side.name
            );
            return Err(Error::value(field, message));
        }
    }
    Ok(())
}

fn check_pattern(place: &str, panel: &PanelTable) -> Result<()> {
    if panel.mesh != Pattern::Irregular && panel.shape != Shape::Rectangle {
        return Err(Error::value(
            format!("{place}.mesh"),
            "only rectangles can have rows and columns; choose \"irregular\"",
        ));
    }
    for (name, given) in [("columns", panel.columns), ("rows", panel.rows)] {
        let field = format!("{place}.{name}");
        match given {
            Some(_) if panel.mesh == Pattern::Irregular => {
                return Err(Error::value(
                    field,
                    "an irregular panel has none; choose mesh = \"rising\" or \"falling\", or \
                     remove this",
                ));
            }
            Some(0) => {
                return Err(Error::value(
                    field,
                    "a panel cannot have 0 of them; give a whole number of 1 or more",
                ));
            }
            _ => {}
        }
    }
    Ok(())
}

/// The sizes that a shape must have, and no others.
fn check_sizes(place: &str, panel: &PanelTable) -> Result<()> {
    let given = [
        ("width_m", panel.width_m.is_some()),
        ("height_m", panel.height_m.is_some()),
        ("radius_m", panel.radius_m.is_some()),
        ("inner_radius_m", panel.inner_radius_m.is_some()),
        ("outer_radius_m", panel.outer_radius_m.is_some()),
        ("tube_radius_m", panel.tube_radius_m.is_some()),
        ("corners_m", panel.corners_m.is_some()),
    ];
    if panel.sides.is_some() && panel.shape != Shape::Polygon {
        return Err(Error::value(
            format!("{place}.sides"),
            "only a polygon's sides can be named; remove this",
        ));
    }
    let (shape, needed): (&str, &[&str]) = match panel.shape {
        Shape::Rectangle => ("a rectangle", &["width_m", "height_m"]),
        Shape::Disk => ("a disk", &["radius_m"]),
        Shape::Annulus => ("an annulus", &["inner_radius_m", "outer_radius_m"]),
        Shape::Polygon => ("a polygon", &["corners_m"]),
        Shape::Sphere => ("a sphere", &["radius_m"]),
        Shape::Torus => ("a torus", &["radius_m", "tube_radius_m"]),
    };
    for (name, is_given) in given {
        if is_given != needed.contains(&name) {
            let what =
                if is_given { "has no such field; remove it" } else { "needs this; give it" };
            let message = format!("{shape} {what} (its sizes: {})", needed.join(", "));
            return Err(Error::value(format!("{place}.{name}"), message));
        }
    }
    Ok(())
}

/// The outline of a flat panel called `place` in errors, whose sizes are given.
pub(super) fn outline(place: &str, panel: &PanelTable) -> Result<Outline> {
    let size = |name: &str, value: Option<f64>| {
        positive(&format!("{place}.{name}"), value.unwrap_or_default())
    };
    Ok(match panel.shape {
        Shape::Rectangle => Outline::Rectangle {
            width_m: size("width_m", panel.width_m)?,
            height_m: size("height_m", panel.height_m)?,
        },
        Shape::Disk => Outline::Disk { radius_m: size("radius_m", panel.radius_m)? },
        Shape::Annulus => Outline::Annulus {
            inner_radius_m: size("inner_radius_m", panel.inner_radius_m)?,
            outer_radius_m: size("outer_radius_m", panel.outer_radius_m)?,
        },
        // Closed surfaces have no outline; `cut` does not ask for one.
        Shape::Polygon | Shape::Sphere | Shape::Torus => {
            let corners_m = panel.corners_m.clone().unwrap_or_default();
            for (c, corner) in corners_m.iter().enumerate() {
                in_reach(&format!("{place}.corners_m[{c}]"), corner)?;
            }
            let sides =
                panel.sides.iter().flatten().map(|side| (side.corner, side.name.clone())).collect();
            Outline::Polygon { corners_m, sides }
        }
    })
}

/// Unit vectors along the axes of a flat place.
pub(super) fn plane(place: &str, x_axis: [f64; 3], y_axis: [f64; 3]) -> Result<[Vec3; 2]> {
    let x = direction(&format!("{place}.place.x_axis"), x_axis)?;
    let y = direction(&format!("{place}.place.y_axis"), y_axis)?;
    if x.dot(&y).abs() > 1e-9 {
        let message = "the axes are not perpendicular, which would stretch the panel; give \
            perpendicular ones";
        return Err(Error::value(format!("{place}.place.y_axis"), message));
    }
    Ok([x, y])
}

/// The panels, cut and sewn and placed into space.
pub(super) fn place_surface(scene: &Scene) -> Result<PlacedSurface> {
    let place = scene.file.display().to_string();
    let cut: Vec<Panel> = scene
        .panel
        .iter()
        .enumerate()
        .map(|(i, table)| cut(&format!("panel[{i}]"), table))
        .collect::<Result<_>>()?;
    let (mut panels, mut sides, mut face, mut rest) = (Vec::new(), Vec::new(), 0, 0);
    for (panel, table) in cut.iter().zip(&scene.panel) {
        let of_panel = panel.sides.iter().zip(&panel.side_names).map(|(chain, name)| Side {
            name: name.clone(),
            rest_vertices: chain.iter().map(|v| rest + v).collect(),
            closed: closed(table),
        });
        sides.push(of_panel.collect());
        let (faces, rest_vertices) =
            (face..face + panel.faces.len(), rest..rest + panel.positions.len());
        (face, rest) = (faces.end, rest_vertices.end);
        panels.push(PlacedPanel { name: table.name.clone(), faces, rest_vertices });
    }
    let side = |field: String, reference: &str| -> Result<(usize, &[usize])> {
        let (p, name) = scene.side(&field, reference)?;
        let missing =
            || Error::value(field, format!("panel {p} has no side \"{name}\"; name another one"));
        Ok((p, cut[p].side(&name).ok_or_else(missing)?))
    };

    let mut chains = Vec::new();
    for (i, seam) in scene.seam.iter().enumerate() {
        let (a, b) =
            (side(format!("seam[{i}].a"), &seam.a)?, side(format!("seam[{i}].b"), &seam.b)?);
        let b_chain = match (seam.reversed, closed(&scene.panel[b.0])) {
            (false, _) => b.1.to_vec(),
            (true, false) => reversed(b.1),
            (true, true) => {
                b.1[..1].iter().copied().chain(b.1[1..].iter().rev().copied()).collect()
            }
        };
        chains.push((a, (b.0, b_chain)));
    }
    let seams: Vec<Seam<'_>> = chains.iter().map(|(a, b)| Seam::new(*a, (b.0, &b.1))).collect();
    let sewn = sew(&cut, &seams).at(&place)?;
    let mut rest_positions: Vec<Vec3> =
        sewn.rest_positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
    let chart = closed::shape(scene, &panels, &mut rest_positions, &sewn.rest_faces)?;
    let placed = place_panels(scene, &panels, &rest_positions)?;
    let start = start(scene, &panels, &seams, &sewn, &placed)?;
    let texture = chart.as_ref().map(|chart| Chart {
        points: side_by_side(&chart.points, &chart.faces),
        faces: chart.faces.clone(),
    });
    Ok(PlacedSurface {
        topology: sewn.topology,
        rest_shape: RestShape { positions: rest_positions, faces: sewn.rest_faces },
        start,
        vertex_of_rest: sewn.vertex_of_rest,
        panels,
        sides,
        chart,
        texture,
        attributes: Vec::new(),
        notes: Vec::new(),
    })
}

/// A panel called `place` in errors; of a closed surface its faces, with vertices that
/// [`closed::shape`] puts right.
fn cut(place: &str, table: &PanelTable) -> Result<Panel> {
    if table.shape.closed() {
        let surface = closed::cut(place, table)?;
        let positions = surface.positions.iter().map(|p| p.xy()).collect();
        return Ok(Panel {
            positions,
            faces: surface.faces,
            sides: Vec::new(),
            side_names: Vec::new(),
        });
    }
    let outline = outline(place, table)?;
    let diagonal = match table.mesh {
        Pattern::Irregular => None,
        Pattern::Rising => Some(Diagonal::Rising),
        Pattern::Falling => Some(Diagonal::Falling),
    };
    let panel = match (outline, diagonal) {
        (Outline::Rectangle { width_m, height_m }, Some(diagonal)) => {
            grid([width_m, height_m], table.edge_length_m, [table.columns, table.rows], diagonal)
        }
        (outline, _) => Panel::new(&outline, table.edge_length_m, table.seed),
    };
    panel.at(place)
}

/// True if the sides of a panel return to where they begin.
fn closed(panel: &PanelTable) -> bool {
    matches!(panel.shape, Shape::Disk | Shape::Annulus)
        || panel.sides.as_ref().is_some_and(|sides| sides.len() == 1)
}

/// `[R]` start position (m) of each rest vertex.
fn place_panels(
    scene: &Scene,
    panels: &[PlacedPanel],
    rest_positions: &[Vec3],
) -> Result<Vec<Vec3>> {
    let mut placed = Vec::with_capacity(rest_positions.len());
    for (i, (panel, table)) in panels.iter().zip(&scene.panel).enumerate() {
        let own = &rest_positions[panel.rest_vertices.clone()];
        match table.place {
            Place::Flat { origin_m, x_axis, y_axis } => {
                let [x, y] = plane(&format!("panel[{i}]"), x_axis, y_axis)?;
                let z = x.cross(&y);
                placed
                    .extend(own.iter().map(|p| Vec3::from(origin_m) + x * p.x + y * p.y + z * p.z));
            }
            Place::Rolled { radius_m, centre_m, start_deg } => placed.extend(own.iter().map(|p| {
                let (sine, cosine) = (start_deg.to_radians() + p.x / radius_m).sin_cos();
                Vec3::from(centre_m) + Vec3::new(radius_m * cosine, radius_m * sine, p.y)
            })),
        }
    }
    Ok(placed)
}

/// `[V]` start position (m) of each vertex, from those of the rest vertices; sewn sides must meet
/// unless they may start apart.
fn start(
    scene: &Scene,
    panels: &[PlacedPanel],
    seams: &[Seam<'_>],
    sewn: &Sewn,
    placed: &[Vec3],
) -> Result<Vec<Vec3>> {
    let [low, high] = extent(placed);
    let tolerance_m = SEAM_TOLERANCE * (high - low).norm();
    // Vertices that start at the mean of their places.
    let mut between = vec![false; sewn.topology.vertex_count];
    for (i, seam) in seams.iter().enumerate() {
        let rest = |(p, v): (usize, usize)| panels[p].rest_vertices.start + v;
        for (&u, &v) in seam.a.vertices.iter().zip(seam.b.vertices) {
            let (u, v) = (rest((seam.a.panel, u)), rest((seam.b.panel, v)));
            if scene.seam[i].start_apart {
                between[sewn.vertex_of_rest[u]] = true;
                continue;
            }
            let apart = (placed[u] - placed[v]).norm();
            if apart > tolerance_m {
                let message = format!(
                    "\"{}\" and \"{}\" start {apart:.3e} m apart; place the panels so that sewn \
                     sides meet, change reversed, \
                     or set start_apart = true",
                    scene.seam[i].a, scene.seam[i].b
                );
                return Err(Error::value(format!("seam[{i}]"), message));
            }
        }
    }
    let mut start = Vec::with_capacity(between.len());
    let mut places = vec![0_usize; between.len()];
    for (r, &v) in sewn.vertex_of_rest.iter().enumerate() {
        // Vertices are numbered by their lowest rest vertex, so it comes first.
        if v == start.len() {
            start.push(placed[r]);
        } else if between[v] {
            start[v] += placed[r];
        }
        places[v] += 1;
    }
    for v in (0..between.len()).filter(|&v| between[v]) {
        start[v] /= places[v] as f64;
    }
    Ok(start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::testing::HEAD;
    use crate::scene::{BuiltScene, build, parse};

    fn built(rest: &str) -> Result<BuiltScene> {
        build(&parse("s.toml", &format!("{HEAD}{rest}"))?)
    }

    fn panel(name: &str, more: &str) -> String {
        format!(
            "[[panel]]\nname = \"{name}\"\nshape = \"rectangle\"\nwidth_m = 1.0\nheight_m = \
             0.5\nedge_length_m = 0.1\n{more}\n"
        )
    }

    const CLAMP: &str = "[[clamp]]\nside = \"p.left\"\n";

    #[test]
    fn rolls_have_a_centre_and_a_start() {
        let roll = |more: &str| {
            built(
                &(panel("p", &format!("place = {{ kind = \"rolled\", radius_m = 2.0{more} }}"))
                    + CLAMP),
            )
            .unwrap()
        };
        let (plain, moved) = (roll(""), roll(", centre_m = [1.0, -2.0, 3.0], start_deg = 90"));
        for (a, b) in plain.start.iter().zip(&moved.start) {
            assert!((Vec3::new(1.0 - a.y, a.x - 2.0, a.z + 3.0) - b).norm() < 1e-14);
        }
    }

    #[test]
    fn sides_that_start_apart_meet_halfway() {
        let text = |more: &str| {
            let place = "place = { kind = \"flat\", origin_m = [1.5, 0.0, 0.25] }";
            format!(
                "{}{}[[seam]]\na = \"p.right\"\nb = \"q.left\"\nreversed = true\n{more}{CLAMP}",
                panel("p", ""),
                panel("q", place)
            )
        };
        let refused = built(&text("")).unwrap_err().to_string();
        assert!(
            refused.contains("seam[0]") && refused.contains("or set start_apart = true"),
            "{refused}"
        );
        let b = built(&text("start_apart = true\n")).unwrap();
        let met: Vec<Vec3> = b.start.iter().copied().filter(|p| p.x == 1.25).collect();
        assert_eq!(met.len(), 6);
        assert!(met.iter().all(|p| p.z == 0.125));
        // Nothing else moves, and the rest shape does not.
        assert!(
            b.start
                .iter()
                .all(|p| (p.x <= 1.0 && p.z == 0.0) || (p.x >= 1.5 && p.z == 0.25) || p.x == 1.25)
        );
        assert!((b.sheet.rest.area_m2() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn named_sides_are_sewn_and_clamped() {
        let trapezium = |sides: &str| {
            format!(
                "[[panel]]\nname = \"p\"\nshape = \"polygon\"\ncorners_m = [[0, 0], [1, 0], [2, \
                 0], [2, 1], [0, 1]]\n{sides}\nedge_length_m = 0.2\n"
            )
        };
        let sides = "sides = [{ name = \"hem\", corner = 0 }, { name = \"rest\", corner = 2 }]";
        let b = built(&(trapezium(sides) + "[[clamp]]\nside = \"p.hem\"\n")).unwrap();
        let held: Vec<Vec3> =
            (0..b.start.len()).filter(|&v| b.clamps.held()[v]).map(|v| b.start[v]).collect();
        assert_eq!(held.len(), 11);
        assert!(held.iter().all(|p| p.y == 0.0));
        let refused =
            |sides: &str, clamp: &str| built(&(trapezium(sides) + clamp)).unwrap_err().to_string();
        let clamp = "[[clamp]]\nside = \"p.hem\"\n";
        assert!(refused(sides, "[[clamp]]\nside = \"p.0\"").contains("its sides are hem, rest"));
        for (wrong, says) in [
            ("sides = []", "panel[0].sides: this lists no side"),
            (
                "sides = [{ name = \"hem\", corner = 5 }]",
                "panel[0].sides[0].corner: there is no corner 5",
            ),
            (
                "sides = [{ name = \"hem\", corner = 3 }, { name = \"a\", corner = 1 }]",
                "panel[0].sides[1].corner: corner 1 does not come after",
            ),
            (
                "sides = [{ name = \"hem\", corner = 3 }, { name = \"hem\", corner = 4 }]",
                "panel[0].sides[1].name: sides[0] is called \"hem\"",
            ),
            (
                "sides = [{ name = \"hem\", corner = 3 }, { name = \"\", corner = 4 }]",
                "panel[0].sides[1].name: this is empty",
            ),
            (
                "sides = [{ name = \"a.b\", corner = 3 }, { name = \"hem\", corner = 4 }]",
                "panel[0].sides[0].name: \"a.b\" has a dot",
            ),
        ] {
            assert!(refused(wrong, clamp).contains(says), "{wrong}: {}", refused(wrong, clamp));
        }
        // A polygon's only side is closed, and may be sewn to another such.
        let corners: Vec<[f64; 2]> = (0..8)
            .map(|k| (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos())
            .map(|(s, c)| [c, s])
            .collect();
        let octagon = |name: &str| {
            format!(
                "[[panel]]\nname = \"{name}\"\nshape = \"polygon\"\ncorners_m = \
                 {corners:?}\nedge_length_m = 0.2\n\
                 sides = [{{ name = \"rim\", corner = 1 }}]\n"
            )
        };
        let two = octagon("p")
            + &octagon("q")
            + "[[seam]]\na = \"p.rim\"\nb = \"q.rim\"\n[load]\npressure_pa = 1\n";
        let b = built(&two).unwrap();
        assert_eq!(
            b.sheet.topology.vertex_count + b.sheet.topology.face_count(),
            b.sheet.topology.edge_count() + 2
        );
    }

    #[test]
    fn structured_panels_are_rectangles_only() {
        let b = built(&(panel("p", "mesh = \"falling\"\ncolumns = 4") + CLAMP)).unwrap();
        assert_eq!(
            (b.sheet.topology.face_count(), b.clamps.held().iter().filter(|h| **h).count()),
            (2 * 4 * 5, 6)
        );
        assert!(b.sheet.rest.faces.iter().all(|f| (f.area_m2 - 0.5 * 0.25 * 0.1).abs() < 1e-15));
        let refused = |more: &str| built(&(panel("p", more) + CLAMP)).unwrap_err().to_string();
        assert!(
            refused("rows = 3")
                .contains("panel[0].rows: an irregular panel has none; choose mesh =")
        );
        assert!(
            refused("mesh = \"rising\"\nrows = 0").contains("panel[0].rows: a panel cannot have 0")
        );
        assert!(
            refused("mesh = \"wavy\"")
                .contains("panel.mesh cannot be \"wavy\"; give one of irregular, rising, falling")
        );
        assert!(
            refused("sides = [{ name = \"a\", corner = 0 }]")
                .contains("panel[0].sides: only a polygon's sides")
        );
        let disk = "[[panel]]\nname = \"p\"\nshape = \"disk\"\nradius_m = 1.0\nedge_length_m = \
            0.3\nmesh = \"rising\"\n";
        assert!(built(disk).unwrap_err().to_string().contains("panel[0].mesh: only rectangles"));
    }
}
