//! Panels that are closed surfaces: a sphere or a torus, whose rest shape is itself.

use super::placed::PlacedPanel;
use super::schema::{PanelTable, Pattern, Place, Scene, Shape};
use super::value::positive;
use crate::mesh::Chart;
use crate::mesh::Vec3;
use crate::mesh::closed::{Closed, sphere, torus};
use crate::{At, Error, Result};

impl Shape {
    /// True for a closed surface, which has no sides.
    pub(super) fn closed(self) -> bool {
        matches!(self, Self::Sphere | Self::Torus)
    }
}

/// Checks of a closed panel that need no mesh; its sizes are given.
pub(super) fn check(place: &str, panel: &PanelTable) -> Result<()> {
    for (name, size) in [("radius_m", panel.radius_m), ("tube_radius_m", panel.tube_radius_m)] {
        if let Some(size) = size {
            positive(&format!("{place}.{name}"), size)?;
        }
    }
    if panel.mesh != Pattern::Irregular {
        return Err(Error::value(
            format!("{place}.mesh"),
            "only rectangles can have rows and columns; remove this",
        ));
    }
    match panel.place {
        Place::Flat { .. } => Ok(()),
        Place::Rolled { .. } => Err(Error::value(
            format!("{place}.place"),
            "a closed surface cannot be rolled; place it flat, where its origin is its centre",
        )),
    }
}

/// A closed panel called `place` in errors.
pub(super) fn cut(place: &str, table: &PanelTable) -> Result<Closed> {
    let radius_m = table.radius_m.unwrap_or_default();
    let surface = match table.shape {
        Shape::Torus => {
            torus(radius_m, table.tube_radius_m.unwrap_or_default(), table.edge_length_m)
        }
        _ => sphere(radius_m, table.edge_length_m),
    };
    surface.at(place)
}

/// Puts the rest vertices (`[R]`, m) of closed panels where they lie; returns the panel coordinates
/// (m) of all panels, if there is a closed one.
pub(super) fn shape(
    scene: &Scene,
    panels: &[PlacedPanel],
    rest_positions: &mut [Vec3],
    rest_faces: &[[usize; 3]],
) -> Result<Option<Chart>> {
    if !scene.panel.iter().any(|panel| panel.shape.closed()) {
        return Ok(None);
    }
    let mut chart = Chart::default();
    for (i, (panel, table)) in panels.iter().zip(&scene.panel).enumerate() {
        let first = chart.points.len();
        if table.shape.closed() {
            let surface = cut(&format!("panel[{i}]"), table)?;
            rest_positions[panel.rest_vertices.clone()].copy_from_slice(&surface.positions);
            chart.points.extend(surface.chart);
            chart.faces.extend(surface.chart_faces.iter().map(|face| face.map(|p| first + p)));
        } else {
            chart.points.extend(rest_positions[panel.rest_vertices.clone()].iter().map(|p| p.xy()));
            chart.faces.extend(
                rest_faces[panel.faces.clone()]
                    .iter()
                    .map(|face| face.map(|r| first + r - panel.rest_vertices.start)),
            );
        }
    }
    Ok(Some(chart))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::testing::HEAD;
    use crate::scene::{BuiltScene, build, parse};

    fn built(panel: &str, more: &str) -> Result<BuiltScene> {
        build(&parse("s.toml", &format!("{HEAD}[[panel]]\nname = \"p\"\n{panel}\n{more}"))?)
    }

    const SPHERE: &str = "shape = \"sphere\"\nradius_m = 0.5\nedge_length_m = 0.1";
    const TORUS: &str = "shape = \"torus\"\nradius_m = 1\ntube_radius_m = 0.25\nedge_length_m = \
        0.1\n\
        place = { kind = \"flat\", origin_m = [1, 2, 3], x_axis = [0, 1, 0], y_axis = [0, 0, 1] }";
    const HELD: &str = "[[clamp]]\nwithin_m = { low = [-9, -9, -9], high = [9, 9, 9] }";

    #[test]
    fn closed_panels_rest_as_they_are_where_they_are_placed() {
        let ball = built(SPHERE, HELD).unwrap();
        assert_eq!(ball.start, ball.sheet.rest_shape.positions);
        assert!(
            (ball.sheet.rest.area_m2() / (4.0 * std::f64::consts::PI * 0.25) - 1.0).abs() < 0.02
        );
        let ring = built(TORUS, HELD).unwrap();
        assert_eq!(
            ring.sheet.topology.vertex_count + ring.sheet.topology.face_count(),
            ring.sheet.topology.edge_count()
        );
        for (p, rest) in ring.start.iter().zip(&ring.sheet.rest_shape.positions) {
            assert!((p - Vec3::new(1.0 + rest.z, 2.0 + rest.x, 3.0 + rest.y)).norm() < 1e-12);
        }
        let texture = ring.texture.unwrap();
        assert!(
            texture.faces.len() == ring.sheet.topology.face_count()
                && texture.points.iter().all(|uv| uv.min() >= 0.0 && uv.max() <= 1.0)
        );
        // Beside a flat panel, each keeps its own; pressure is on the inside.
        let other = "[[panel]]\nname = \"q\"\nshape = \"disk\"\nradius_m = 1\nedge_length_m = 0.2";
        let both = built(SPHERE, &format!("{other}\n{HELD}")).unwrap();
        let disk = &both.panels[1];
        assert!(
            both.start[ball.start.len()..].iter().all(|p| p.z == 0.0)
                && disk.rest_vertices.start == ball.start.len()
        );
        assert_eq!(both.texture.unwrap().faces.len(), both.sheet.topology.face_count());
        assert!(built(SPHERE, "[load]\npressure_pa = 1").is_ok());
    }

    #[test]
    fn what_closed_panels_do_not_have_is_told() {
        for (panel, more, says) in [
            (
                SPHERE.replace("radius_m = 0.5", ""),
                "",
                "panel[0].radius_m: a sphere needs this; give it (its sizes: radius_m)",
            ),
            (format!("{SPHERE}\nwidth_m = 1"), "", "panel[0].width_m: a sphere has no such field"),
            (SPHERE.replace("0.5", "-0.5"), "", "panel[0].radius_m: -0.5 is no usable length"),
            (
                SPHERE.replace("0.1", "0.6"),
                "",
                "panel[0].edge_length_m: edges of 0.6 m cannot go around",
            ),
            (
                TORUS.replace("0.25", "1.25"),
                "",
                "panel[0].tube_radius_m: a tube of 1.25 m closes the hole",
            ),
            (
                TORUS.replace("tube_radius_m = 0.25", ""),
                "",
                "panel[0].tube_radius_m: a torus needs this",
            ),
            (format!("{SPHERE}\nmesh = \"rising\""), "", "panel[0].mesh: only rectangles"),
            (format!("{SPHERE}\nsides = []"), "", "panel[0].sides: only a polygon's sides"),
            (
                format!("{SPHERE}\nplace = {{ kind = \"rolled\", radius_m = 1 }}"),
                "",
                "panel[0].place: a closed surface cannot be rolled",
            ),
            (
                SPHERE.to_owned(),
                "[[clamp]]\nside = \"p.rim\"",
                "clamp[0].side: panel \"p\" is closed and has no sides; use near_m",
            ),
            (SPHERE.to_owned(), "", "nothing holds the surface; add"),
        ] {
            let text = built(&panel, more).unwrap_err().to_string();
            assert!(text.contains(says) && text.contains("; "), "{says}: {text}");
        }
    }
}
