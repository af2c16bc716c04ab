//! `plisse bake`: wrinkles to height and normal maps in texture space. Where wrinkles come from: a
//! solved folder or a scene ([`solved`]), or an animated model ([`live`]).

mod live;
mod solved;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::bake::{Baked, Coverage, Options, png16};
use plisse::io::staged::OutputFolder;
use plisse::{Error, Result};
use serde::Serialize;

use crate::arguments::{BakeArguments, Map};
use crate::outputs::write_json;
use crate::pipeline::with_threads;
use crate::terminal::{RunEnd, print};

/// Results of a run. Field names carry the units.
#[derive(Serialize)]
struct Report {
    plisse: &'static str,
    input: String,
    /// "field" of a solved folder, or "live" waves of a model.
    kind: &'static str,
    size: usize,
    padding: usize,
    vertices: usize,
    faces: usize,
    wavelength_m: Option<f64>,
    profile: Option<String>,
    clip: Option<String>,
    /// White of the height maps; black is as far below.
    height_scale_m: f64,
    frames: Vec<Frame>,
    notes: Vec<String>,
    seconds: Seconds,
}

/// One frame's maps.
#[derive(Serialize)]
struct Frame {
    time_s: f64,
    files: Vec<String>,
    height_max_m: f64,
    covered_texels: usize,
    padded_texels: usize,
    overlapping_texels: usize,
    missed_faces: usize,
}

#[derive(Default, Serialize)]
struct Seconds {
    /// Of posing and running waves through the clip.
    waves: f64,
    bake: f64,
    write: f64,
    total: f64,
}

pub(crate) fn run(arguments: &BakeArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let input = Path::new(&arguments.input);
    let extension =
        input.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let mut job = Job::new(arguments, interrupted, begun);
    with_threads(arguments.threads, || {
        if input.is_dir() {
            solved::folder(&mut job, input)
        } else if extension == "toml" {
            solved::scene(&mut job, input)
        } else {
            live::model(&mut job)
        }
    })
}

/// A run on its way.
struct Job<'a> {
    arguments: &'a BakeArguments,
    interrupted: &'a AtomicBool,
    begun: Instant,
    report: Report,
}

impl<'a> Job<'a> {
    fn new(arguments: &'a BakeArguments, interrupted: &'a AtomicBool, begun: Instant) -> Self {
        let report = Report {
            plisse: env!("CARGO_PKG_VERSION"),
            input: arguments.input.clone(),
            kind: "field",
            size: arguments.size as usize,
            padding: arguments.padding as usize,
            vertices: 0,
            faces: 0,
            wavelength_m: None,
            profile: None,
            clip: None,
            height_scale_m: 0.0,
            frames: Vec::new(),
            notes: Vec::new(),
            seconds: Seconds::default(),
        };
        Self { arguments, interrupted, begun, report }
    }

    fn options(&self) -> Options {
        Options { size: self.arguments.size as usize, padding: self.arguments.padding as usize }
    }

    /// The folder asked for, or one named after the input.
    fn output(&self) -> PathBuf {
        let stem = Path::new(&self.arguments.input)
            .file_stem()
            .map_or_else(|| "plisse".into(), |s| s.to_os_string());
        self.arguments
            .output
            .clone()
            .unwrap_or_else(|| PathBuf::from("out").join(stem).join("maps"))
    }

    fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }

    /// Writes the maps of one frame and takes them into the report. `number` is that of a
    /// sequence's frame.
    fn write(
        &mut self,
        folder: &mut OutputFolder,
        baked: &Baked,
        number: Option<usize>,
        time_s: f64,
    ) -> Result<()> {
        let begun = Instant::now();
        let name = |map: &str| {
            number.map_or_else(|| format!("{map}.png"), |n| format!("{map}-{n:04}.png"))
        };
        let mut files = Vec::new();
        if self.arguments.map != Map::Height {
            folder.write(&name("normal"), |out| png16::write_normal(out, baked))?;
            files.push(name("normal"));
        }
        if self.arguments.map != Map::Normal {
            // Where nothing wrinkles any scale is right.
            let scale_m =
                if self.report.height_scale_m > 0.0 { self.report.height_scale_m } else { 1.0 };
            folder.write(&name("height"), |out| png16::write_height(out, baked, scale_m))?;
            files.push(name("height"));
        }
        let count = |what: Coverage| baked.coverage.iter().filter(|&&c| c == what).count();
        self.report.frames.push(Frame {
            time_s,
            files,
            height_max_m: baked
                .height_m
                .iter()
                .fold(0.0, |most: f64, &h| most.max(f64::from(h).abs())),
            covered_texels: count(Coverage::Covered),
            padded_texels: count(Coverage::Padded),
            overlapping_texels: baked.overlapping,
            missed_faces: baked.missed_faces,
        });
        self.report.seconds.write += begun.elapsed().as_secs_f64();
        Ok(())
    }

    /// report.json and the table; maps of earlier runs that this one did not write go.
    fn finish(&mut self, mut folder: OutputFolder, path: &Path) -> Result<RunEnd> {
        let interrupted = self.is_interrupted()
            && self.report.frames.len() < self.arguments.frames.unwrap_or(1) as usize;
        let report = &mut self.report;
        if let Some(frame) = report.frames.first() {
            if frame.overlapping_texels > 0 {
                let share =
                    100.0 * frame.overlapping_texels as f64 / frame.covered_texels.max(1) as f64;
                report.notes.push(format!(
                    "{share:.1} % of the texels lie on several faces; the first has \
                        them (texture coordinates overlap)"
                ));
            }
            if frame.missed_faces > 0 {
                report.notes.push(format!(
                    "{} face(s) have no texel; they are too small in texture space",
                    frame.missed_faces
                ));
            }
        }
        if interrupted {
            report.notes.push(format!(
                "interrupted: the first {} frame(s) are whole, others are missing",
                report.frames.len()
            ));
        }
        report.seconds.total = self.begun.elapsed().as_secs_f64();
        let written: Vec<&String> = report.frames.iter().flat_map(|f| &f.files).collect();
        for entry in std::fs::read_dir(path).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if is_map(&name) && !written.contains(&&name) {
                folder.remove_stale(&name);
            }
        }
        write_json(&mut folder, "report.json", &report)?;
        folder.commit()?;
        print(&report.table(path));
        Ok(if interrupted { RunEnd::Interrupted } else { RunEnd::Complete })
    }
}

impl Report {
    fn table(&self, path: &Path) -> String {
        let mut table = format!("{}\n", self.input);
        let mut row = |name: &str, value: String| table += &format!("  {name:<24} {value}\n");
        row("mesh", format!("{} vertices, {} faces", self.vertices, self.faces));
        if let Some(clip) = &self.clip {
            row("clip", clip.clone());
        }
        let highest = self.frames.iter().fold(0.0, |most: f64, f| most.max(f.height_max_m));
        row(
            "maps",
            format!("{} frame(s) of {} x {} texels", self.frames.len(), self.size, self.size),
        );
        row("height", format!("max {highest:.4e} m, scale {:.4e} m", self.height_scale_m));
        if let Some(frame) = self.frames.first() {
            row(
                "texels",
                format!(
                    "{} covered, {} padded, {} overlapping",
                    frame.covered_texels, frame.padded_texels, frame.overlapping_texels
                ),
            );
        }
        let s = &self.seconds;
        row(
            "seconds",
            format!(
                "waves {:.3}, bake {:.3}, write {:.3}, total {:.3}",
                s.waves, s.bake, s.write, s.total
            ),
        );
        for note in &self.notes {
            table += &format!("  note: {note}\n");
        }
        table += &format!("  written to               {}\n", path.display());
        table
    }
}

/// True if `name` is that of a map: normal.png, height-0012.png.
fn is_map(name: &str) -> bool {
    let middle = |map: &str| name.strip_prefix(map).and_then(|rest| rest.strip_suffix(".png"));
    let number = |rest: &str| {
        rest.strip_prefix('-')
            .is_some_and(|n| n.len() >= 4 && n.bytes().all(|b| b.is_ascii_digit()))
    };
    ["normal", "height"]
        .iter()
        .filter_map(|map| middle(map))
        .any(|rest| rest.is_empty() || number(rest))
}

/// Refuses a flag that means nothing for this input.
fn refuse(flag: &str, given: bool, what: &str) -> Result<()> {
    if given { Err(Error::value(flag, format!("{what}; leave it out"))) } else { Ok(()) }
}
