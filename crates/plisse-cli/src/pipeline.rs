//! The pipeline that `solve` and `wrinkle` share: from a pose to files.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::field::{FieldOptions, FieldReport, Terms, WrinkleField, solve};
use plisse::io::staged::OutputFolder;
use plisse::linalg::Ending;
use plisse::mesh::{Topology, Up};
use plisse::scene::Measured;
use plisse::shell::BaseReport;
use plisse::surface::{MOST_FACES, levels_within};
use plisse::wrinkled;
use plisse::{Error, Result};

use crate::arguments::OutputArguments;
use crate::outputs;
use crate::progress::Bars;
use crate::report::{BaseSummary, Report, SurfaceSummary, ending_name};
use crate::terminal::RunEnd;

/// What both commands make of their input.
pub(crate) struct Job<'a> {
    pub(crate) title: &'a str,
    /// What was published about it.
    pub(crate) paper: Option<&'a str>,
    pub(crate) posed: wrinkled::Posed<'a>,
    pub(crate) held: &'a [bool],
    pub(crate) field: FieldOptions,
    pub(crate) up: Up,
    pub(crate) base: Option<&'a BaseReport>,
    pub(crate) notes: Vec<String>,
}

/// The folder that results go to, proven writable before anything long begins.
pub(crate) fn open_output(arguments: &OutputArguments, input: &Path) -> Result<OutputFolder> {
    open_output_at(arguments.output.as_deref(), input)
}

/// As [`open_output`], for the folder asked for or one named after `input`.
pub(crate) fn open_output_at(output: Option<&Path>, input: &Path) -> Result<OutputFolder> {
    let stem = input.file_stem().map_or_else(|| "plisse".into(), |s| s.to_os_string());
    OutputFolder::create(&output.map_or_else(|| PathBuf::from("out").join(stem), Path::to_path_buf))
}

/// Runs `work` with as many threads as the user asked for.
pub(crate) fn with_threads<T: Send>(
    threads: Option<u32>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0) as usize);
    let pool = builder.build().map_err(|e| {
        Error::value("threads", format!("the threads could not be started ({e}); ask for fewer"))
    })?;
    pool.install(work)
}

/// Takes the terms named on the command line out of `field`.
pub(crate) fn remove_stale(field: &mut FieldOptions, names: &[String]) -> Result<()> {
    for name in names {
        if name == "relaxed-integrability" {
            field.relaxed_integrability = false;
        } else {
            field.terms = field.terms.without(name).ok_or_else(|| {
                let known = Terms::NAMES.join(", ");
                Error::value(
                    "--without",
                    format!("there is no term '{name}'; known are {known}, relaxed-integrability"),
                )
            })?;
        }
    }
    Ok(())
}

/// Refuses `levels`, which `field` asked for, if they would make too many faces; before anything
/// long begins.
pub(crate) fn check_levels(field: &str, levels: Option<usize>, topology: &Topology) -> Result<()> {
    let most = levels_within(topology, MOST_FACES);
    match levels {
        Some(levels) if levels > most => {
            let message = format!(
                "{levels} levels would make more than {MOST_FACES} faces of {}; ask for {most} or \
                 fewer",
                topology.face_count()
            );
            Err(Error::value(field, message))
        }
        _ => Ok(()),
    }
}

/// Field, phase, surface, picture, files, table.
pub(crate) fn finish(
    job: Job<'_>,
    arguments: &OutputArguments,
    mut folder: OutputFolder,
    bars: &Bars<'_>,
    interrupted: &AtomicBool,
    begun: Instant,
    measure: impl FnOnce(&WrinkleField, &FieldReport) -> Vec<Measured>,
) -> Result<RunEnd> {
    let (posed, topology) = (&job.posed, &job.posed.sheet.topology);
    let solved = solve(posed.sheet, posed.pose, job.held, &job.field, bars)?;
    bars.finish();
    let (field, found) = (&solved.field, &solved.report);
    let mut report = Report::new(job.title, posed.sheet, field, found);
    report.paper = job.paper.map(str::to_owned);
    report.measures = measure(field, found);
    report.notes = job.notes;
    if let Some(base) = job.base {
        report.base = Some(BaseSummary::from(base));
        report.seconds.base = base.seconds;
    }

    let surface_begun = Instant::now();
    let spinner = bars.spinner("surface");
    // Who interrupts does not want to wait for a fine surface.
    let hurried = interrupted.load(Ordering::SeqCst) && posed.levels.is_none();
    let wrinkled = posed.wrinkle(field, if hurried { 0 } else { posed.levels(field) });
    let fine = &wrinkled.fine;
    report.surface = SurfaceSummary {
        levels: fine.levels,
        vertices: fine.topology.vertex_count,
        faces: fine.topology.face_count(),
    };
    drop(spinner);

    let spinner = bars.spinner("files");
    let draw = || {
        outputs::picture(
            topology,
            posed.pose,
            &wrinkled,
            report.amplitude_m.max,
            job.up,
            posed.obstacles,
        )
    };
    let (picture, written) = rayon::join(
        || (!arguments.no_picture).then(draw),
        || posed.write(&mut folder, field, &wrinkled, job.up),
    );
    written?;
    match picture {
        Some(picture) => {
            folder.write("picture.png", |out| plisse::picture::write_png(&picture, out))?
        }
        None => folder.remove_stale("picture.png"),
    }
    let was_interrupted = interrupted.load(Ordering::SeqCst);
    if was_interrupted {
        let interrupted = ending_name(Ending::Cancelled);
        let cut_short = report.ending == interrupted
            || report.base.as_ref().is_some_and(|base| base.ending == interrupted);
        report.notes.push(match cut_short {
            true => "interrupted: this is the best state so far, not a solution".to_owned(),
            false => {
                "interrupted after the solve had ended by itself; nothing is missing".to_owned()
            }
        });
    }
    report.seconds.surface = surface_begun.elapsed().as_secs_f64();
    report.seconds.total = begun.elapsed().as_secs_f64();
    let table = report.table();
    outputs::finish(folder, &report, table)?;
    drop(spinner);
    Ok(if was_interrupted { RunEnd::Interrupted } else { RunEnd::Complete })
}
