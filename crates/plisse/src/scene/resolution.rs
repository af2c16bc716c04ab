//! The same scene on coarser or finer meshes, for studies of what depends on them.

use super::build::{Built, build};
use super::schema::{Pattern, Scene};
use crate::{Error, Result};

/// Steps of the search for an edge length. Vertices go with its inverse square but for the rounding on sides, so a few are enough.
const STEPS: usize = 6;
/// The search ends within this part of the wanted number.
const CLOSE: f64 = 0.01;

/// `scene` with the edge lengths of all its panels scaled so that it has about `vertices` vertices, and what it builds to. Rows and
/// columns of structured panels that the scene counts are scaled too.
///
/// # Errors
/// [`Error::Value`] if the scene wears a mesh; the errors of [`build`].
pub fn with_vertices(scene: &Scene, vertices: usize) -> Result<(Scene, Built)> {
    if scene.mesh.is_some() {
        let message = "a mesh from files cannot be cut anew; give panels";
        return Err(Error::value(format!("{}, mesh", scene.file.display()), message));
    }
    let distance = |built: &Built| (built.topology.vertex_count as f64 / vertices as f64).ln().abs();
    let mut built = build(scene)?;
    let mut best = (scene.clone(), distance(&built), None);
    let mut factor = 1.0;
    for _ in 0..STEPS {
        if best.1 < CLOSE {
            break;
        }
        factor *= (built.topology.vertex_count as f64 / vertices as f64).sqrt();
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
            let count = built.topology.vertex_count as f64;
            assert!((count / vertices as f64 - 1.0).abs() < 0.05, "{count} for {vertices}");
            assert_eq!(scaled.panel[0].edge_length_m, scaled.panel[1].edge_length_m);
            assert_eq!(build(&scaled).unwrap().start, built.start);
        }
    }
}
