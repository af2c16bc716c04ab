//! The pipeline that `solve` and `wrinkle` share: from a solved field to files.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::field::FieldReport;
use plisse::io::staged::OutputFolder;
use plisse::linalg::Ending;
use plisse::mesh::Up;
use plisse::scene::Measured;
use plisse::shell::BaseReport;
use plisse::wrinkles::PosedField;
use plisse::{Error, Result};

use crate::arguments::OutputArguments;
use crate::outputs;
use crate::progress::Bars;
use crate::report::{BaseSummary, Report, SurfaceSummary, ending_name};
use crate::terminal::RunEnd;

/// A solved field, and what is written about it.
pub(crate) struct Job<'a> {
    pub(crate) arguments: &'a OutputArguments,
    pub(crate) title: &'a str,
    /// Published results, in words; may be empty.
    pub(crate) paper: &'a str,
    pub(crate) posed: PosedField<'a>,
    pub(crate) up: Up,
    pub(crate) base_report: Option<&'a BaseReport>,
    pub(crate) field_report: &'a FieldReport,
    pub(crate) measures: Vec<Measured>,
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

/// `error` about an option of the library, with the flag that gave it.
pub(crate) fn about_flag(error: Error) -> Error {
    match error {
        Error::Value { field, message } if ["levels", "without"].contains(&field.as_str()) => {
            Error::value(format!("--{field}"), message)
        }
        other => other,
    }
}

/// Makes the surface, draws the picture, writes the files and prints the table.
pub(crate) fn finish(
    job: Job<'_>,
    mut folder: OutputFolder,
    bars: &Bars<'_>,
    interrupted: &AtomicBool,
    begun: Instant,
) -> Result<RunEnd> {
    let posed = &job.posed;
    let mut report = Report::new(job.title, posed.sheet, posed.field, job.field_report);
    report.paper = Some(job.paper.to_owned()).filter(|paper| !paper.is_empty());
    report.measures = job.measures;
    report.notes = job.notes;
    if let Some(base) = job.base_report {
        report.base = Some(BaseSummary::from(base));
        report.seconds.base = base.seconds;
    }

    let surface_begun = Instant::now();
    let spinner = bars.spinner("surface");
    // Who interrupts does not want to wait for a fine surface.
    let hurried = interrupted.load(Ordering::SeqCst) && posed.options.levels.is_none();
    let surface = posed.surface(if hurried { 0 } else { posed.levels() });
    let fine = &surface.fine;
    report.surface = SurfaceSummary {
        levels: fine.levels,
        vertices: fine.topology.vertex_count,
        faces: fine.topology.face_count(),
    };
    drop(spinner);

    let spinner = bars.spinner("files");
    let (picture, written) = rayon::join(
        || (!job.arguments.no_picture).then(|| outputs::picture(posed, &surface, job.up)),
        || posed.write(&mut folder, &surface, job.up),
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
        report.notes.push(interrupted_note(&report).to_owned());
    }
    report.seconds.surface = surface_begun.elapsed().as_secs_f64();
    report.seconds.total = begun.elapsed().as_secs_f64();
    let table = report.table();
    outputs::finish(folder, &report, table)?;
    drop(spinner);
    Ok(if was_interrupted { RunEnd::Interrupted } else { RunEnd::Complete })
}

/// The note on an interruption: solution or not.
fn interrupted_note(report: &Report) -> &'static str {
    let interrupted = ending_name(Ending::Cancelled);
    let cut_short = report.ending == interrupted
        || report.base.as_ref().is_some_and(|base| base.ending == interrupted);
    if cut_short {
        "interrupted: this is the best state so far, not a solution"
    } else {
        "interrupted after the solve had ended by itself; nothing is missing"
    }
}
