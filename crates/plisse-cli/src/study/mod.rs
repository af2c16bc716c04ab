//! `plisse study`: the tables of [Chen 2021] beside ours. One file for each study; [`scenes`] holds
//! their scenes, [`solved`] solves and draws them, [`table`] writes the tables.

mod ablation;
mod growth;
mod meshing;
mod resolution;
mod scaling_law;
mod scenes;
mod solved;
mod stable;
mod table;
mod timing;

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use plisse::io::staged::OutputFolder;
use plisse::{Error, Result};

use crate::arguments::{StudyArguments, StudyName};
use crate::pipeline::with_threads;
use crate::progress::Bars;
use crate::terminal::RunEnd;
use table::Document;

/// Reason for ending a study early.
pub(crate) enum Stop {
    /// The user interrupted it.
    Interrupted,
    /// Something failed.
    Failed(Error),
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}

/// A study under way.
pub(crate) struct Study<'a> {
    pub(crate) bars: &'a Bars<'a>,
    interrupted: &'a AtomicBool,
    folder: OutputFolder,
    pub(crate) quick: bool,
    /// Numbers of the scenes of [`timing`]; all if there are none.
    scenes: Vec<u8>,
    /// Maximum number of vertices of a reference shell.
    pub(crate) shell_limit: usize,
    /// Published meshes and solutions.
    pub(crate) data: Option<PathBuf>,
    pub(crate) document: Document,
}

type Work = fn(&mut Study<'_>) -> std::result::Result<(), Stop>;

/// Name, heading and work of a study.
fn studies(name: StudyName) -> Vec<(&'static str, &'static str, Work)> {
    let all: [(StudyName, &str, &str, Work); 6] = [
        (StudyName::Ablation, "ablation", "What each term is for", ablation::run),
        (
            StudyName::ScalingLaw,
            "scaling-law",
            "A scaling law instead of the solve",
            scaling_law::run,
        ),
        (StudyName::Meshing, "meshing", "How the mesh is made", meshing::run),
        (StudyName::Resolution, "resolution", "How fine the mesh is", resolution::run),
        (StudyName::Timing, "timing", "Iterations and seconds", timing::run),
        (StudyName::Growth, "growth", "Folds of a surface that grows", growth::run),
    ];
    // Growth has another paper, and a page of its own.
    let wanted = |study: &&(StudyName, _, _, _)| match name {
        StudyName::All => study.0 != StudyName::Growth,
        name => name == study.0,
    };
    all.iter().filter(wanted).map(|&(_, name, title, work)| (name, title, work)).collect()
}

pub(crate) fn run(arguments: &StudyArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let bars = Bars::new(interrupted);
    with_threads(arguments.threads, || {
        let mut documents = Vec::new();
        for (name, title, work) in studies(arguments.name) {
            let mut study = Study {
                bars: &bars,
                interrupted,
                folder: OutputFolder::create(&arguments.output)?,
                quick: arguments.quick,
                scenes: arguments.scenes.clone(),
                shell_limit: arguments.shell_limit_vertices as usize,
                data: arguments.data.clone(),
                document: begin(name, title, arguments),
            };
            let ended = work(&mut study);
            bars.finish();
            match ended {
                Ok(()) => study.document.complete = true,
                Err(Stop::Interrupted) => {}
                Err(Stop::Failed(error)) => return Err(error),
            }
            documents.push(study.write()?);
            if interrupted.load(Ordering::SeqCst) {
                break;
            }
        }
        if arguments.name == StudyName::All {
            let mut folder = OutputFolder::create(&arguments.output)?;
            folder.write("validation.md", |out| {
                out.write_all(validation(&documents, arguments).as_bytes())
            })?;
            folder.commit()?;
        }
        let _ = writeln!(std::io::stdout(), "written to {}", arguments.output.display());
        Ok(if interrupted.load(Ordering::SeqCst) { RunEnd::Interrupted } else { RunEnd::Complete })
    })
}

fn begin(name: &'static str, title: &'static str, arguments: &StudyArguments) -> Document {
    Document {
        name,
        title,
        plisse: env!("CARGO_PKG_VERSION"),
        command: command(name, arguments),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        threads: rayon::current_num_threads(),
        complete: false,
        tables: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    }
}

/// The command that does this again, but for the folder.
fn command(name: &str, arguments: &StudyArguments) -> String {
    let mut command = format!("plisse study {name}");
    if arguments.quick {
        command += " --quick";
    }
    command += &format!(" --shell-limit-vertices {}", arguments.shell_limit_vertices);
    if !arguments.scenes.is_empty() {
        let numbers: Vec<String> = arguments.scenes.iter().map(u8::to_string).collect();
        command += &format!(" --scenes {}", numbers.join(","));
    }
    if let Some(data) = &arguments.data {
        command += &format!(" --data {}", data.display());
    }
    command
}

/// All studies in one text.
fn validation(documents: &[Document], arguments: &StudyArguments) -> String {
    let mut out = "# Validation\n\nThe figures of this program beside those of Chen et al. 2021 \
        (\"Fine Wrinkling on Coarsely-Meshed Thin Shells\").\n"
        .to_owned();
    out += "A dash means that nothing was published, or that ours was not run.\n\n";
    if let Some(first) = documents.first() {
        out += &first.origin().replace(&first.command, &command("all", arguments));
    }
    for document in documents {
        out += &document.markdown(2);
    }
    out
}

impl Study<'_> {
    /// Writes the study's files and shows its tables.
    fn write(mut self) -> Result<Document> {
        let document = self.document;
        let markdown = document.markdown(1);
        // After the heading, so that a reader of the file knows where it is from.
        let (heading, rest) = markdown.split_once("\n\n").unwrap_or((&markdown, ""));
        self.folder.write(&format!("{}.md", document.name), |out| {
            write!(out, "{heading}\n\n{}{rest}", document.origin())
        })?;
        self.folder.write(&format!("{}.json", document.name), |out| {
            serde_json::to_writer_pretty(&mut *out, &document)?;
            out.write_all(b"\n")
        })?;
        self.folder.commit()?;
        let _ = std::io::stdout().write_all(markdown.as_bytes());
        Ok(document)
    }

    /// True if the scene of this number is asked for.
    pub(crate) fn has_scene(&self, number: usize) -> bool {
        self.scenes.is_empty() || self.scenes.iter().any(|&scene| usize::from(scene) == number)
    }

    /// Ends the study if the user interrupted it.
    pub(crate) fn check_interrupted(&self) -> std::result::Result<(), Stop> {
        if self.interrupted.load(Ordering::SeqCst) { Err(Stop::Interrupted) } else { Ok(()) }
    }

    /// The value of `outcome`. A failure becomes a note, so that the rest of the study goes on.
    pub(crate) fn or_note<T>(
        &mut self,
        what: &str,
        outcome: std::result::Result<T, Stop>,
    ) -> std::result::Result<Option<T>, Stop> {
        match outcome {
            Ok(value) => Ok(Some(value)),
            Err(Stop::Failed(error)) => {
                self.document.notes.push(format!("{what}: {error}"));
                Ok(None)
            }
            Err(Stop::Interrupted) => Err(Stop::Interrupted),
        }
    }
}
