//! Maps of a wrinkle field that `plisse solve` or `plisse wrinkle` wrote, or of a scene, which is
//! solved first.

use std::path::Path;
use std::time::Instant;

use plisse::bake::{Surface, bake, field_sampler};
use plisse::io::obj;
use plisse::io::staged::OutputFolder;
use plisse::mesh::Topology;
use plisse::mesh::normals::vertex_normals;
use plisse::{At, Error, Result};

use super::{Job, refuse};
use crate::arguments::{OutputArguments, SolveArguments};
use crate::progress::Bars;
use crate::terminal::RunEnd;

/// Bakes the folder `input` with its base.obj and field.json.
pub(super) fn folder(job: &mut Job<'_>, input: &Path) -> Result<RunEnd> {
    check_flags(job)?;
    let path = job.output();
    baked(job, input, &path)
}

/// Solves the scene `input` into the folder `solve` beside the maps, then bakes that.
pub(super) fn scene(job: &mut Job<'_>, input: &Path) -> Result<RunEnd> {
    check_flags(job)?;
    let path = job.output();
    let solved = path.join("solve");
    let output = OutputArguments {
        output: Some(solved.clone()),
        levels: None,
        threads: job.arguments.threads,
        no_picture: true,
        without: Vec::new(),
    };
    match crate::solve::run(
        &SolveArguments { scene: input.to_path_buf(), output },
        job.interrupted,
    )? {
        RunEnd::Complete => baked(job, &solved, &path),
        RunEnd::Interrupted => Ok(RunEnd::Interrupted),
    }
}

fn check_flags(job: &Job<'_>) -> Result<()> {
    let a = job.arguments;
    if let Some(flag) = a.waves.given() {
        refuse(flag, true, "a solved field has its own waves and does not move")?;
    }
    refuse("--frames", a.frames.is_some(), "a solved field does not move")?;
    refuse("--time", a.time.is_some(), "a solved field does not move")
}

fn baked(job: &mut Job<'_>, from: &Path, path: &Path) -> Result<RunEnd> {
    let (mesh_path, field_path) = (from.join("base.obj"), from.join("field.json"));
    for file in [&mesh_path, &field_path] {
        if !file.is_file() {
            let message = format!(
                "there is no {} in it; give a folder that plisse solve wrote",
                file.file_name().unwrap_or_default().display()
            );
            return Err(Error::value(from.display().to_string(), message));
        }
    }
    let mesh = obj::read(&mesh_path)?;
    let place = mesh_path.display().to_string();
    let topology = Topology::new(mesh.positions.len(), mesh.faces).at(&place)?;
    let field = plisse::field::json::read(&field_path, &topology)?;
    let Some(uv_faces) = mesh.texture_faces else {
        let message = "its faces have no texture coordinates to bake into; unwrap the mesh that \
            was solved and solve it again";
        return Err(Error::mesh(place, message));
    };
    let mut folder = OutputFolder::create(path)?;
    let bars = Bars::new(job.interrupted);
    let spinner = bars.spinner("bake");
    let begun = Instant::now();
    let normals = vertex_normals(&topology, &mesh.positions);
    let surface = Surface {
        positions: &mesh.positions,
        normals: &normals,
        faces: &topology.faces,
        uvs: &mesh.texture_coordinates,
        uv_faces: &uv_faces,
    };
    let maps = bake(&surface, field_sampler(&topology, &mesh.positions, &field), &job.options())?;
    job.report.seconds.bake = begun.elapsed().as_secs_f64();
    job.report.height_scale_m = field.amplitude_m.iter().copied().fold(0.0, f64::max);
    (job.report.vertices, job.report.faces) = (topology.vertex_count, topology.face_count());
    job.write(&mut folder, &maps, None, 0.0)?;
    drop(spinner);
    job.finish(folder, path)
}
