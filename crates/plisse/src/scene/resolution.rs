//! The same scene on coarser or finer meshes, for studies of what depends on them.

use super::build::{BuiltScene, build};
use super::probe::Quantity;
use super::schema::{Pattern, Scene};
use crate::mesh::subdivide::refine_rest;
use crate::mesh::{Topology, Vec3};
use crate::rest::RestMetric;
use crate::shell::Clamps;
use crate::{At, Error, Result};

/// Steps of the search for an edge length. Vertices go with its inverse square but for the rounding
/// on sides, so a few are enough.
const STEPS: usize = 6;
/// The search ends within this part of the wanted number.
const CLOSE: f64 = 0.01;

/// `scene` with the edge lengths of all its panels scaled so that it has about `vertices` vertices,
/// and what it builds to. Rows and columns of structured panels that the scene counts are scaled
/// too.
///
/// # Errors
/// [`Error::Value`] if the scene wears a mesh; the errors of [`build`].
pub fn with_vertices(scene: &Scene, vertices: usize) -> Result<(Scene, BuiltScene)> {
    if scene.mesh.is_some() {
        let message = "a mesh from files cannot be cut anew; give panels";
        return Err(Error::value(format!("{}, mesh", scene.file.display()), message));
    }
    let distance = |built: &BuiltScene| {
        (built.sheet.topology.vertex_count as f64 / vertices as f64).ln().abs()
    };
    let mut built = build(scene)?;
    let mut best = (scene.clone(), distance(&built), None);
    let mut factor = 1.0;
    for _ in 0..STEPS {
        if best.1 < CLOSE {
            break;
        }
        factor *= (built.sheet.topology.vertex_count as f64 / vertices as f64).sqrt();
        let scaled = with_edges_scaled(scene, factor);
        built = build(&scaled)?;
        if distance(&built) < best.1 {
            best = (scaled, distance(&built), Some(built.clone()));
        }
    }
    let built = match best.2 {
        Some(built) => built,
        None => build(&best.0)?,
    };
    Ok((best.0, built))
}

fn with_edges_scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scaled = scene.clone();
    for panel in &mut scaled.panel {
        panel.edge_length_m *= factor;
        if panel.mesh != Pattern::Irregular {
            let count = |n: Option<usize>| n.map(|n| ((n as f64 / factor).round() as usize).max(1));
            (panel.columns, panel.rows) = (count(panel.columns), count(panel.rows));
        }
    }
    scaled
}

/// `built` with every face cut in four of the same shape, nothing smoothed. What the middle of an
/// edge is held at is the mean of both ends, if both are held. Measures along lines and sides are
/// left out.
///
/// # Errors
/// [`Error::Mesh`] if a face has no area; there is none if `built` comes from [`build`].
pub fn refined(built: &BuiltScene) -> Result<BuiltScene> {
    let coarse = &built.sheet.topology;
    let (start, faces) = refine_rest(&built.start, &coarse.faces);
    let rest_shape = built.sheet.rest_shape.refined();
    let target = |t: &[Option<f64>; 3]| Vec3::from(t.map(|c| c.unwrap_or(0.0)));
    let is_held = |t: &[Option<f64>; 3]| Vec3::from(t.map(|c| if c.is_some() { 1.0 } else { 0.0 }));
    let targets: Vec<Vec3> =
        refine_rest(&built.clamps.targets.iter().map(target).collect::<Vec<_>>(), &coarse.faces).0;
    let held: Vec<Vec3> =
        refine_rest(&built.clamps.targets.iter().map(is_held).collect::<Vec<_>>(), &coarse.faces).0;
    let clamp = |(target, held): (&Vec3, &Vec3)| {
        [0, 1, 2].map(|axis| (held[axis] == 1.0).then_some(target[axis]))
    };
    let mut fine = built.clone();
    fine.sheet.rest =
        RestMetric::from_shape(&rest_shape.positions, &rest_shape.faces).at(&built.title)?;
    fine.sheet.topology = Topology::new(start.len(), faces).at(&built.title)?;
    fine.clamps = Clamps { targets: targets.iter().zip(&held).map(clamp).collect() };
    fine.probes.retain(|probe| {
        matches!(probe.quantity, Quantity::LargestPeriod | Quantity::PeakAmplitude)
    });
    fine.texture = built.texture.as_ref().map(|chart| chart.refined(1));
    for panel in &mut fine.panels {
        panel.faces = 4 * panel.faces.start..4 * panel.faces.end;
        // New rest vertices come after all the old ones, so only one panel's are together.
        panel.rest_vertices = if built.panels.len() == 1 {
            0..rest_shape.positions.len()
        } else {
            panel.rest_vertices.clone()
        };
    }
    (fine.start, fine.sheet.rest_shape) = (start, rest_shape);
    Ok(fine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;

    #[test]
    fn the_wanted_number_of_vertices_is_met() {
        let text = r#"
            title = "balloon"
            material = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }
            panel = [
                { name = "front", shape = "disk", radius_m = 1.0, edge_length_m = 0.1 },
                { name = "back", shape = "disk", radius_m = 1.0, edge_length_m = 0.1, seed = 7 },
            ]
            seam = [{ a = "front.rim", b = "back.rim" }]
            clamp = [{ side = "front.rim" }]"#;
        let scene = parse("balloon.toml", text).unwrap();
        for vertices in [300, 1000, 5000] {
            let (scaled, built) = with_vertices(&scene, vertices).unwrap();
            let count = built.sheet.topology.vertex_count as f64;
            assert!((count / vertices as f64 - 1.0).abs() < 0.05, "{count} for {vertices}");
            assert_eq!(scaled.panel[0].edge_length_m, scaled.panel[1].edge_length_m);
            assert_eq!(build(&scaled).unwrap().start, built.start);
        }
    }

    #[test]
    fn refined_meshes_have_the_same_shape_and_clamps() {
        let text = concat!(
            r#"
            title = "sheet"
            material = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }
            panel = [{ name = "p", shape = "rectangle", width_m = 1.0, height_m = 0.5, "#,
            r#"edge_length_m = 0.1 }]
            clamp = [{ side = "p.left", move_m = [-0.1, 0.0, 0.0] }]
            measure = [{ name = "n", kind = "waves_along", panel = "p", from_m = [0.5, 0.0], "#,
            r#"to_m = [0.5, 0.5] }, { name = "a", kind = "peak_amplitude" }]"#
        );
        let coarse = build(&parse("sheet.toml", text).unwrap()).unwrap();
        let fine = refined(&coarse).unwrap();
        assert_eq!(fine.sheet.topology.face_count(), 4 * coarse.sheet.topology.face_count());
        assert!((fine.sheet.rest.area_m2() - 0.5).abs() < 1e-12);
        let count = |built: &BuiltScene| built.clamps.held().iter().filter(|held| **held).count();
        assert_eq!(count(&fine), 2 * count(&coarse) - 1);
        for (start, target) in fine.start.iter().zip(&fine.clamps.targets) {
            let expected =
                if start.x == 0.0 { [Some(-0.1), Some(start.y), Some(0.0)] } else { [None; 3] };
            assert_eq!(*target, expected);
        }
        assert_eq!(
            (fine.probes.len(), fine.panels[0].faces.clone()),
            (1, 0..fine.sheet.topology.face_count())
        );
    }
}
