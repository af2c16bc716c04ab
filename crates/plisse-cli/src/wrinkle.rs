//! `plisse wrinkle`: wrinkles on a pose made elsewhere.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use plisse::field::FieldOptions;
use plisse::io::clamp_file::read_clamped_vertices;
use plisse::io::garment;
use plisse::material::Material;
use plisse::mesh::islands::panel_texture;
use plisse::wrinkled::Posed;
use plisse::{At, Result, Sheet};

use crate::arguments::WrinkleArguments;
use crate::pipeline::{Job, check_levels, finish, open_output, remove_stale, with_threads};
use crate::progress::Bars;
use crate::terminal::RunEnd;

pub(crate) fn run(arguments: &WrinkleArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let material = Material::new(arguments.young, arguments.poisson, arguments.thickness)?;
    let mut field = FieldOptions { rule: arguments.wrinkle_free.into(), ..FieldOptions::default() };
    remove_stale(&mut field, &arguments.output.without)?;
    let garment = garment::read(&arguments.pose, garment::RestSource::File(&arguments.rest), 1.0)?;
    let texture = garment.texture.or_else(|| panel_texture(&garment.rest_shape));
    let sheet =
        Sheet::with_topology(garment.topology, garment.rest_shape, material).at(&arguments.rest)?;
    let mut held = vec![false; sheet.topology.vertex_count];
    if let Some(path) = &arguments.clamp {
        for v in read_clamped_vertices(path, garment.vertex_of_input.len())? {
            held[garment.vertex_of_input[v]] = true;
        }
    }
    let levels = arguments.output.levels.map(|levels| levels as usize);
    check_levels("--levels", levels, &sheet.topology)?;
    let folder = open_output(&arguments.output, &arguments.pose)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.output.threads, || {
        let posed = Posed {
            sheet: &sheet,
            texture,
            pose: &garment.positions,
            curvature_rings: field.curvature_rings,
            obstacles: &[],
            clearance_m: 0.0,
            levels,
            v1: false,
            v2: true,
        };
        let job = Job {
            title: &arguments.pose.display().to_string(),
            paper: None,
            posed,
            held: &held,
            field,
            up: arguments.up,
            base: None,
            notes: garment.notes,
        };
        finish(job, &arguments.output, folder, &bars, interrupted, begun, |_, _| Vec::new())
    })
}
