//! `plisse solve`: a scene file to a wrinkled surface.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use plisse::Result;
use plisse::scene;
use plisse::shell::{BaseReport, solve_base};

use crate::Done;
use crate::arguments::{SolveArguments, Up};
use crate::outputs::panel_texture;
use crate::progress::Bars;
use crate::road::{Posed, check_levels, finish, leave_out, open_output, with_threads};

/// Contact thicknesses that wrinkles stay off bodies.
const CLEARANCE: f64 = 0.25;

pub(crate) fn run(arguments: &SolveArguments, interrupted: &AtomicBool) -> Result<Done> {
    let begun = Instant::now();
    let mut built = scene::build(&scene::read(&arguments.scene)?)?;
    leave_out(&mut built.field, &arguments.output.without)?;
    match arguments.output.levels {
        Some(levels) => check_levels("--levels", Some(levels as usize), &built.topology)?,
        None => check_levels(&format!("{}, surface.levels", arguments.scene.display()), built.levels, &built.topology)?,
    }
    let folder = open_output(&arguments.output, &arguments.scene)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.output.threads, || {
        let (pose, base) = solve_base(&built.setup(), &built.start, &built.base, &bars)?;
        bars.finish();
        let posed = Posed {
            title: &built.title,
            paper: Some(built.paper.as_str()).filter(|paper| !paper.is_empty()),
            topology: &built.topology,
            rest: &built.rest,
            rest_shape: (&built.rest_positions, &built.rest_faces),
            texture: built.texture.clone().or_else(|| panel_texture(&built.rest_positions, &built.rest_faces)),
            pose: &pose,
            held: &built.clamps.held(),
            material: &built.material,
            obstacles: (&built.obstacles, CLEARANCE * built.contact_thickness_m),
            field: built.field.clone(),
            levels: built.levels,
            v1: built.v1,
            v2: built.v2,
            up: Up::Z,
            base: Some(&base),
            notes: built.notes.iter().cloned().chain(base_notes(&base)).collect(),
        };
        finish(posed, &arguments.output, folder, &bars, interrupted, begun, |field, report| scene::measure(&built, field, report))
    })
}

/// What the user should know about a base surface: the paper's own warning about tension field theory.
pub(crate) fn base_notes(base: &BaseReport) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(first) = base.resolved_faces.first() {
        let count = base.resolved_faces.len();
        notes.push(format!("{count} face(s) started inside an obstacle, the first is face {first}; they were pushed out"));
    }
    for (faces, what) in [(&base.collapsed_faces, "collapsed"), (&base.inverted_faces, "inverted")] {
        if let Some(first) = faces.first() {
            notes.push(format!(
                "the base surface has {} {what} face(s), the first is face {first}; try another base.compressive_stiffness (0, 1e-3, 1e-2) or finer edges",
                faces.len()
            ));
        }
    }
    notes
}
