//! Maps of a wrinkle field that `plisse solve` or `plisse wrinkle` wrote, or of a scene, which is
//! solved first.

use std::path::Path;
use std::time::Instant;

use plisse::field::{WrinkleField, json};
use plisse::io::obj;
use plisse::io::staged::OutputFolder;
use plisse::mesh::{Chart, Topology, Vec3};
use plisse::wrinkles::bake_field;
use plisse::{At, Error, Result};

use super::{Job, refuse};
use crate::arguments::{OutputArguments, SolveArguments};
use crate::progress::Bars;
use crate::terminal::RunEnd;

/// A field on a pose (`[V]`, m) of a surface.
struct Source<'a> {
    /// The mesh, for messages.
    place: &'a Path,
    topology: &'a Topology,
    pose: &'a [Vec3],
    texture: Option<&'a Chart>,
    field: &'a WrinkleField,
}

/// Bakes the folder `input` with its base.obj and field.json.
pub(super) fn folder(job: &mut Job<'_>, input: &Path) -> Result<RunEnd> {
    check_flags(job)?;
    let (mesh_path, field_path) = (input.join("base.obj"), input.join("field.json"));
    for file in [&mesh_path, &field_path] {
        if !file.is_file() {
            let message = format!(
                "there is no {} in it; give a folder that plisse solve wrote",
                file.file_name().unwrap_or_default().display()
            );
            return Err(Error::value(input.display().to_string(), message));
        }
    }
    let mesh = obj::read(&mesh_path)?;
    let topology = Topology::new(mesh.positions.len(), mesh.faces).at(&mesh_path)?;
    let field = json::read(&field_path, &topology)?;
    let texture = mesh.texture_faces.map(|faces| Chart { points: mesh.texture_coordinates, faces });
    let source = Source {
        place: &mesh_path,
        topology: &topology,
        pose: &mesh.positions,
        texture: texture.as_ref(),
        field: &field,
    };
    bake(job, &source)
}

/// Solves the scene `input` into the folder `solve` beside the maps, then bakes what it found.
pub(super) fn scene(job: &mut Job<'_>, input: &Path) -> Result<RunEnd> {
    check_flags(job)?;
    let folder = job.output().join("solve");
    let output = OutputArguments {
        output: Some(folder.clone()),
        levels: None,
        threads: job.arguments.threads,
        no_picture: true,
        without: Vec::new(),
    };
    let arguments = SolveArguments { scene: input.to_path_buf(), output };
    let (solved, end) = crate::solve::solve(&arguments, job.interrupted)?;
    if let RunEnd::Interrupted = end {
        return Ok(end);
    }
    let texture = solved.built.texture();
    let source = Source {
        place: &folder.join("base.obj"),
        topology: &solved.built.sheet.topology,
        pose: &solved.pose,
        texture: texture.as_ref(),
        field: &solved.field,
    };
    bake(job, &source)
}

fn check_flags(job: &Job<'_>) -> Result<()> {
    let a = job.arguments;
    if let Some(flag) = a.waves.given() {
        refuse(flag, true, "a solved field has its own waves and does not move")?;
    }
    refuse("--frames", a.frames.is_some(), "a solved field does not move")?;
    refuse("--time", a.time.is_some(), "a solved field does not move")
}

/// Bakes `source` and writes its maps.
fn bake(job: &mut Job<'_>, source: &Source<'_>) -> Result<RunEnd> {
    let &Source { topology, pose, field, .. } = source;
    let Some(texture) = source.texture else {
        let message = "its faces have no texture coordinates to bake into; unwrap the mesh that \
            was solved and solve it again";
        return Err(Error::mesh(source.place.display().to_string(), message));
    };
    let path = job.output();
    let mut folder = OutputFolder::create(&path)?;
    let bars = Bars::new(job.interrupted);
    let spinner = bars.spinner("bake");
    let begun = Instant::now();
    let maps = bake_field(topology, pose, texture, field, &job.options())?;
    job.report.seconds.bake = begun.elapsed().as_secs_f64();
    job.report.height_scale_m = field.amplitude_m.iter().copied().fold(0.0, f64::max);
    (job.report.vertices, job.report.faces) = (topology.vertex_count, topology.face_count());
    job.write(&mut folder, &maps, None, 0.0)?;
    drop(spinner);
    job.finish(folder, &path)
}
