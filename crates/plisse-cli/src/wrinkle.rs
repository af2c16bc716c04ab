//! `plisse wrinkle`: wrinkles on a pose made elsewhere.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use plisse::field::{self, FieldOptions};
use plisse::io::clamp_file::read_clamped_vertices;
use plisse::io::garment;
use plisse::material::Material;
use plisse::mesh::islands::panel_texture;
use plisse::wrinkles::{PosedField, SurfaceOptions};
use plisse::{At, Result, Sheet};

use crate::arguments::WrinkleArguments;
use crate::pipeline::{Job, about_flag, finish, open_output, with_threads};
use crate::progress::Bars;
use crate::terminal::RunEnd;

pub(crate) fn run(arguments: &WrinkleArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let material = Material::new(arguments.young, arguments.poisson, arguments.thickness)?;
    let mut options = FieldOptions { rule: arguments.wrinkle_free.into(), ..Default::default() };
    for name in &arguments.output.without {
        options = options.without(name).map_err(about_flag)?;
    }
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
    let surface = SurfaceOptions { levels, ..SurfaceOptions::default() };
    surface.check(&sheet.topology).map_err(about_flag)?;
    let folder = open_output(&arguments.output, &arguments.pose)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.output.threads, || {
        let solved = field::solve(&sheet, &garment.positions, &held, &options, &bars)?;
        bars.finish();
        let job = Job {
            arguments: &arguments.output,
            title: &arguments.pose.display().to_string(),
            paper: "",
            posed: PosedField {
                sheet: &sheet,
                pose: &garment.positions,
                field: &solved.field,
                options: surface,
                obstacles: &[],
                clearance_m: 0.0,
                texture,
            },
            up: arguments.up,
            base_report: None,
            field_report: &solved.report,
            measures: Vec::new(),
            notes: garment.notes,
        };
        finish(job, folder, &bars, interrupted, begun)
    })
}
