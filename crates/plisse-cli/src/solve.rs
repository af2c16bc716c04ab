//! `plisse solve`: a scene file to a wrinkled surface.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use plisse::Result;
use plisse::mesh::Up;
use plisse::scene::{self, SolveOptions, SolvedScene};

use crate::arguments::SolveArguments;
use crate::pipeline::{Job, about_flag, finish, open_output, with_threads};
use crate::progress::Bars;
use crate::terminal::RunEnd;

pub(crate) fn run(arguments: &SolveArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    solve(arguments, interrupted).map(|(_, end)| end)
}

/// Solves the scene and writes its files.
pub(crate) fn solve(
    arguments: &SolveArguments,
    interrupted: &AtomicBool,
) -> Result<(SolvedScene, RunEnd)> {
    let begun = Instant::now();
    let scene = scene::read(&arguments.scene)?;
    let options = SolveOptions {
        levels: arguments.output.levels.map(|levels| levels as usize),
        without: arguments.output.without.clone(),
    };
    let built = scene::build_with(&scene, &options).map_err(about_flag)?;
    let folder = open_output(&arguments.output, &arguments.scene)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.output.threads, || {
        let solved = scene::solve_built(&scene, built, &bars)?;
        bars.finish();
        let job = Job {
            arguments: &arguments.output,
            title: &solved.built.title,
            paper: &solved.built.paper,
            posed: solved.posed_field(),
            up: Up::Z,
            base_report: Some(&solved.base_report),
            field_report: &solved.field_report,
            measures: solved.measures.clone(),
            notes: solved.notes.clone(),
        };
        let end = finish(job, folder, &bars, interrupted, begun)?;
        Ok((solved, end))
    })
}
