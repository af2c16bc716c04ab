//! The base surface of a scene; on a fine mesh, by way of a coarse one.
//!
//! Panels that start apart and are sewn pull one row of faces across the gap between them: the
//! finer the mesh, the stiffer that row and the longer the solve. So a coarse mesh of the scene is
//! solved first, and the fine one starts from its base surface.

use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::TriMesh;

use super::build::BuiltScene;
use super::placed::PlacedPanel;
use super::resolution::with_vertices;
use super::schema::Scene;
use crate::mesh::Vec3;
use crate::progress::{Observer, Step};
use crate::shell::{self, BaseReport};
use crate::{Error, Result};

/// Vertices from which on a mesh is fine, and those of the coarse one that is solved before it.
const FINE: usize = 8000;
const COARSE: usize = 2000;

/// The base surface (`[V]`, m) of `scene`, which was built to `built`. From 8,000 vertices on,
/// panels are first solved on a mesh of about 2,000; the report's seconds are then those of both,
/// its other numbers those of `built`'s mesh.
///
/// # Errors
/// Those of [`shell::solve_base`].
pub fn solve_base(
    scene: &Scene,
    built: &BuiltScene,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, BaseReport)> {
    solve_base_by_way(scene, built, [FINE, COARSE], observer)
}

/// Warnings about a base surface, a sentence each: faces that started inside an
/// obstacle, and those that collapsed or turned over, of which [Chen 2021] warns in tension field
/// theory.
pub fn base_notes(base: &BaseReport) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(first) = base.resolved_faces.first() {
        let count = base.resolved_faces.len();
        notes.push(format!(
            "{count} face(s) started inside an obstacle, the first is face {first}; \
            they were pushed out"
        ));
    }
    for (faces, what) in [(&base.collapsed_faces, "collapsed"), (&base.inverted_faces, "inverted")]
    {
        if let Some(first) = faces.first() {
            notes.push(format!(
                "the base surface has {} {what} face(s), the first is face {first}; try another \
                 base.compressive_stiffness (0, 1e-3, 1e-2) or finer edges",
                faces.len()
            ));
        }
    }
    notes
}

fn solve_base_by_way(
    scene: &Scene,
    built: &BuiltScene,
    [fine, coarse]: [usize; 2],
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, BaseReport)> {
    if scene.mesh.is_none() && built.sheet.topology.vertex_count >= fine {
        // Where that fails, the fine mesh is solved as it is, and tells what is wrong.
        if let Ok(found) = from_coarse(scene, coarse, built, observer) {
            return Ok(found);
        }
    }
    shell::solve_base(&built.setup(), &built.start, &built.base_options, observer)
}

/// The base surface of `built`, from that of a mesh of `scene` with about so many `vertices` on.
fn from_coarse(
    scene: &Scene,
    vertices: usize,
    built: &BuiltScene,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, BaseReport)> {
    let (_, coarse) = with_vertices(scene, vertices)?;
    let (pose, first) = shell::solve_base(
        &coarse.setup(),
        &coarse.start,
        &coarse.base_options,
        &Renamed(observer),
    )?;
    let (pose, mut report) = shell::solve_base(
        &built.setup(),
        &carried(&coarse, &pose, built)?,
        &built.base_options,
        observer,
    )?;
    report.seconds += first.seconds;
    // What began inside an obstacle did so because coarse faces are flat.
    report.resolved_faces.clear();
    Ok((pose, report))
}

/// Tells the steps of a coarse solve by a name of their own.
struct Renamed<'a>(&'a dyn Observer);

impl Observer for Renamed<'_> {
    fn step(&self, step: &Step) {
        self.0.step(&Step { stage: "coarse", ..*step });
    }

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// `pose` (`[V]` of `coarse`, m) on the mesh of `fine`: each rest vertex goes where the coarse face
/// that is nearest to it in its panel takes it, also a little beyond that face's sides. Where
/// panels are sewn, the mean of both. Both meshes are of one scene's panels.
fn carried(coarse: &BuiltScene, pose: &[Vec3], fine: &BuiltScene) -> Result<Vec<Vec3>> {
    let mut vertex_of_rest = vec![usize::MAX; fine.sheet.rest_shape.positions.len()];
    for (rest_face, face) in fine.sheet.rest_shape.faces.iter().zip(&fine.sheet.topology.faces) {
        rest_face.iter().zip(face).for_each(|(&r, &v)| vertex_of_rest[r] = v);
    }
    let (mut sum, mut times) = (
        vec![Vec3::zeros(); fine.sheet.topology.vertex_count],
        vec![0.0; fine.sheet.topology.vertex_count],
    );
    for (from, to) in coarse.panels.iter().zip(&fine.panels) {
        let surface = rest_surface(coarse, from)?;
        for r in to.rest_vertices.clone().filter(|&r| vertex_of_rest[r] != usize::MAX) {
            let place = &fine.sheet.rest_shape.positions[r];
            let (_, (leaf, _)) = surface.project_local_point_and_get_location(
                Vector::new(place.x, place.y, place.z),
                false,
            );
            let f = from.faces.start + leaf as usize;
            let weights = barycentric(
                place,
                &coarse.sheet.rest_shape.faces[f].map(|r| coarse.sheet.rest_shape.positions[r]),
            );
            let v = vertex_of_rest[r];
            sum[v] +=
                (0..3).map(|k| pose[coarse.sheet.topology.faces[f][k]] * weights[k]).sum::<Vec3>();
            times[v] += 1.0;
        }
    }
    Ok(sum.iter().zip(times).map(|(sum, times)| sum / times).collect())
}

/// The rest shape of a panel; its n-th triangle is the panel's n-th face.
fn rest_surface(built: &BuiltScene, panel: &PlacedPanel) -> Result<TriMesh> {
    let first = panel.rest_vertices.start;
    let positions = built.sheet.rest_shape.positions[panel.rest_vertices.clone()]
        .iter()
        .map(|p| Vector::new(p.x, p.y, p.z))
        .collect();
    let faces = built.sheet.rest_shape.faces[panel.faces.clone()]
        .iter()
        .map(|face| face.map(|r| (r - first) as u32))
        .collect();
    TriMesh::new(positions, faces).map_err(|error| {
        Error::mesh(panel.name.clone(), format!("the panel cannot be searched: {error}"))
    })
}

/// Barycentric coordinates of the foot of `p` in the plane of a triangle; negative beyond its
/// sides.
fn barycentric(p: &Vec3, [a, b, c]: &[Vec3; 3]) -> [f64; 3] {
    let normal = (b - a).cross(&(c - a));
    let share = |q: &Vec3, r: &Vec3| (q - p).cross(&(r - p)).dot(&normal) / normal.norm_squared();
    let (u, v) = (share(b, c), share(c, a));
    [u, v, 1.0 - u - v]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;
    use crate::scene::parse;

    /// Two sheets before and behind a ball, sewn at the sides; they hang from the ends of their
    /// seams, 0.2 m of cloth between 0.1 m.
    const SHEETS: &str = concat!(
        r#"
        title = "two sheets around a ball"
        material = { young_pa = 1e5, poisson = 0.3, thickness_m = 1e-3, density_kg_m3 = 200.0 }
        panel = [
            { name = "front", shape = "rectangle", width_m = 0.4, height_m = 0.3, "#,
        r#"edge_length_m = 0.04, place = { kind = "flat", origin_m = [-0.2, -0.12, 0.0], "#,
        r#"x_axis = [1.0, 0.0, 0.0], y_axis = [0.0, 0.0, 1.0] } },
            { name = "back", shape = "rectangle", width_m = 0.4, height_m = 0.3, "#,
        r#"edge_length_m = 0.04, seed = 2, "#,
        r#"place = { kind = "flat", origin_m = [-0.2, 0.12, 0.0], "#,
        r#"x_axis = [1.0, 0.0, 0.0], y_axis = [0.0, 0.0, 1.0] } },
        ]
        seam = [
            { a = "front.left", b = "back.left", start_apart = true },
            { a = "front.right", b = "back.right", start_apart = true },
        ]
        clamp = [{ near_m = [-0.2, 0.0, 0.3] }, { near_m = [0.2, 0.0, 0.3] }]
        load = { gravity_m_s2 = [0.0, 0.0, -9.81] }
        obstacle = [{ name = "ball", kind = "sphere", centre_m = [0.0, 0.0, 0.15], "#,
        r#"radius_m = 0.08 }]
        contact = { thickness_m = 0.01 }
        base = { compressive_stiffness = 0.01 }"#
    );

    #[test]
    fn what_is_affine_in_each_panel_is_carried_exactly() {
        let mut scene = parse("sheets.toml", SHEETS).unwrap();
        // Panels that nobody sewed: each has its own affine map.
        scene.seam.clear();
        scene.obstacle.clear();
        scene.clamp[0].side = Some("front.top".to_owned());
        scene.clamp[1].side = Some("back.top".to_owned());
        scene.clamp.iter_mut().for_each(|clamp| clamp.near_m = None);
        let (_, coarse) = with_vertices(&scene, 200).unwrap();
        let (_, fine) = with_vertices(&scene, 1000).unwrap();
        let carried = carried(&coarse, &coarse.start, &fine).unwrap();
        let most = carried.iter().zip(&fine.start).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(most < 1e-12, "{most}");
    }

    #[test]
    fn fine_meshes_come_to_the_same_base_by_way_of_a_coarse_one_and_sooner() {
        let (scene, built) = with_vertices(&parse("sheets.toml", SHEETS).unwrap(), 2500).unwrap();
        let (direct, report) =
            shell::solve_base(&built.setup(), &built.start, &built.base_options, &Silent).unwrap();
        let (by_way, shorter) = solve_base_by_way(&scene, &built, [2000, 300], &Silent).unwrap();
        let apart = direct.iter().zip(&by_way).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 1e-3, "{apart} m apart");
        assert!(
            2 * shorter.iterations < report.iterations,
            "{} and {} iterations",
            shorter.iterations,
            report.iterations
        );
        assert!(shorter.resolved_faces.is_empty());
        // Too few vertices for that.
        assert_eq!(solve_base(&scene, &built, &Silent).unwrap().0, direct);
    }
}
