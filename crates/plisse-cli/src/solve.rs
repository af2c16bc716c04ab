//! `plisse solve`: a scene file to a wrinkled surface.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use plisse::Result;
use plisse::mesh::Up;
use plisse::scene;

use crate::arguments::SolveArguments;
use crate::pipeline::{Job, check_levels, finish, open_output, remove_stale, with_threads};
use crate::progress::Bars;
use crate::terminal::RunEnd;

pub(crate) fn run(arguments: &SolveArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let scene = scene::read(&arguments.scene)?;
    let mut built = scene::build(&scene)?;
    remove_stale(&mut built.field, &arguments.output.without)?;
    match arguments.output.levels {
        Some(levels) => check_levels("--levels", Some(levels as usize), &built.sheet.topology)?,
        None => check_levels(
            &format!("{}, surface.levels", arguments.scene.display()),
            built.levels,
            &built.sheet.topology,
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
            notes: built.notes.iter().cloned().chain(scene::base_notes(&base)).collect(),
        };
        finish(job, &arguments.output, folder, &bars, interrupted, begun, |field, report| {
            scene::measure(&built, field, report)
        })
    })
}
