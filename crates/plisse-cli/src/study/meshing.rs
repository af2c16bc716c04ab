//! Dependence of the field on the structure of the mesh (section 6.3 of [Chen 2021]).

use plisse::scene::schema::Pattern;
use plisse::scene::{self, BuiltScene, Scene};

use super::solved::{Figures, Look};
use super::table::{count, fixed, maybe, none, text};
use super::{Stop, Study, scenes};

/// Columns of both tables.
const COLUMNS: [&str; 8] = [
    "mesh",
    "vertices",
    "waves before rounding",
    "waves",
    "published waves",
    "wavelength (mm)",
    "largest amplitude (mm)",
    "iterations",
];

pub(crate) fn run(study: &mut Study<'_>) -> Result<(), Stop> {
    cylinder(study)?;
    drape(study)
}

/// A scene on `columns` × `rows` squares cut by diagonals.
fn structured(
    scene: &Scene,
    pattern: Pattern,
    columns: usize,
    rows: usize,
) -> Result<BuiltScene, Stop> {
    let mut scene = scene.clone();
    for panel in &mut scene.panel {
        (panel.mesh, panel.columns, panel.rows) = (pattern, Some(columns), Some(rows));
    }
    Ok(scene::build(&scene)?)
}

fn cylinder(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Twisted cylinder (scene 01)",
        "Structured meshes have so many vertices around and along the cylinder; the wrinkles run \
         from lower left to upper right, so rising diagonals are along them. Published: Chen et \
         al. 2021, section 6.3 and figure 21.",
        &COLUMNS,
    );
    let scene = scenes::first_three(1)?;
    // Vertices around (columns, closed) and along (one more than rows).
    let grids: &[(usize, usize, [i64; 2])] =
        if study.quick { &[(40, 7, [39, 40])] } else { &[(80, 12, [39, 40]), (120, 9, [38, 40])] };
    let (_, irregular) = scene::with_vertices(&scene, if study.quick { 250 } else { 1309 })?;
    let mut meshes = vec![MeshOfScene {
        name: "irregular".to_owned(),
        built: irregular,
        published_waves: Some(46),
    }];
    for &(around, along, published) in grids {
        for (pattern, what, published) in [
            (Pattern::Rising, "along the wrinkles", published[0]),
            (Pattern::Falling, "against them", published[1]),
        ] {
            meshes.push(MeshOfScene {
                name: format!("{around} × {along}, diagonals {what}"),
                built: structured(&scene, pattern, around, along - 1)?,
                published_waves: Some(published).filter(|_| !study.quick),
            });
        }
    }
    solve_all(study, meshes, "meshing-cylinder", "Scene 01 on irregular and structured meshes")
}

fn drape(study: &mut Study<'_>) -> Result<(), Stop> {
    let Some(scene) = scenes::numbered(4)? else { return Ok(()) };
    study.document.table(
        "Sphere drape (scene 04)",
        "The same cloth on four meshes. Published (Chen et al. 2021, figure 18, of a dress, as \
         pictures only): the wrinkled shapes are consistent.",
        &COLUMNS,
    );
    let vertices = if study.quick { 300 } else { 1600 };
    let (_, irregular) = scene::with_vertices(&scene, vertices)?;
    let (_, coarse) = scene::with_vertices(&scene, vertices / 4)?;
    let side = (vertices as f64).sqrt().round() as usize - 1;
    let meshes = [
        ("Delaunay", irregular),
        ("refined from a coarser one", scene::refined(&coarse)?),
        ("squares, rising diagonals", structured(&scene, Pattern::Rising, side, side)?),
        ("squares, falling diagonals", structured(&scene, Pattern::Falling, side, side)?),
    ];
    let meshes = meshes.map(|(name, built)| MeshOfScene {
        name: name.to_owned(),
        built,
        published_waves: None,
    });
    solve_all(study, meshes.into(), "meshing-drape", "Scene 04 on four meshes")
}

/// A mesh of a scene, ready to be solved.
struct MeshOfScene {
    name: String,
    built: BuiltScene,
    published_waves: Option<i64>,
}

/// A row for each mesh, and a picture of the first four.
fn solve_all(
    study: &mut Study<'_>,
    meshes: Vec<MeshOfScene>,
    picture: &str,
    caption: &str,
) -> Result<(), Stop> {
    let mut looks = Vec::new();
    let first = meshes[0].built.clone();
    for MeshOfScene { name, built, published_waves } in meshes {
        let outcome = study.solve(built);
        let Some(solution) = study.or_note(&name, outcome)? else { continue };
        let around = solution.around();
        study.document.row([
            text(&name),
            count(solution.vertices()),
            maybe(around, |p| fixed(p.before_rounding, 2)),
            maybe(around, |p| count(p.turns)),
            published_waves.map_or_else(none, count),
            solution.wavelength_mm(),
            fixed(solution.peak_mm(), 3),
            count(solution.field_report.iterations),
        ]);
        if looks.len() < 4 {
            looks.push(Look::wrinkled(
                &name,
                &solution.built,
                &solution.pose,
                &solution.field,
                true,
            ));
        }
    }
    match <[Look; 4]>::try_from(looks) {
        Ok(looks) => study.picture(picture, caption, &first, &looks),
        Err(_) => Ok(()),
    }
}
