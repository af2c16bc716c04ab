//! `plisse solve`: a scene file to a wrinkled surface.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use plisse::Result;
use plisse::scene;
use plisse::shell::BaseReport;

use crate::arguments::{SolveArguments, Up};
use crate::pipeline::{Job, check_levels, finish, leave_out, open_output, with_threads};
use crate::progress::Bars;
use crate::terminal::RunEnd;

pub(crate) fn run(arguments: &SolveArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let scene = scene::read(&arguments.scene)?;
    let mut built = scene::build(&scene)?;
    leave_out(&mut built.field, &arguments.output.without)?;
    match arguments.output.levels {
        Some(levels) => check_levels("--levels", Some(levels as usize), &built.topology)?,
        None => check_levels(
            &format!("{}, surface.levels", arguments.scene.display()),
            built.levels,
            &built.topology,
        )?,
    }
    let folder = open_output(&arguments.output, &arguments.scene)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.output.threads, || {
        let (pose, base) = scene::solve_base(&scene, &built, &bars)?;
        bars.finish();
        let mut posed = built.posed(&pose);
        posed.levels = arguments.output.levels.map(|levels| levels as usize).or(posed.levels);
        let job = Job {
            title: &built.title,
            paper: Some(built.paper.as_str()).filter(|paper| !paper.is_empty()),
            posed,
            held: &built.clamps.held(),
            field: built.field.clone(),
            up: Up::Z,
            base: Some(&base),
            notes: built.notes.iter().cloned().chain(base_notes(&base)).collect(),
        };
        finish(job, &arguments.output, folder, &bars, interrupted, begun, |field, report| {
            scene::measure(&built, field, report)
        })
    })
}

/// What the user should know about a base surface: the paper's own warning about tension field
/// theory.
pub(crate) fn base_notes(base: &BaseReport) -> Vec<String> {
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
