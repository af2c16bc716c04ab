//! report.json of `plisse live`, and its short table.

use std::path::Path;

use plisse::Result;
use plisse::io::staged::OutputFolder;
use plisse_live::live_model::LiveModel;
use plisse_live::measures::{Measures, Summary};
use plisse_live::model::Clip;
use plisse_live::stage::Stage;
use serde_json::json;

use crate::arguments::LiveArguments;
use crate::outputs::write_json;
use crate::terminal::print;

/// The figures of a run.
#[derive(Default)]
pub(super) struct Report {
    model: String,
    welded_vertices: usize,
    draw_vertices: usize,
    faces: usize,
    clip: Option<String>,
    wavelength_m: f64,
    fps: f64,
    size: [usize; 2],
    pub(super) adapter: String,
    pub(super) measures: Measures,
    pub(super) notes: Vec<String>,
    pub(super) seconds_total: f64,
}

impl Report {
    pub(super) fn new(
        live: &LiveModel,
        clip: Option<&Clip>,
        arguments: &LiveArguments,
        size: [usize; 2],
    ) -> Self {
        let mut report = Self {
            model: live.model.name.clone(),
            welded_vertices: live.welded.count(),
            draw_vertices: live.model.draw.positions.len(),
            faces: live.model.faces.len(),
            clip: clip.map(|c| c.name.clone()),
            wavelength_m: live.wavelength_m,
            fps: arguments.fps,
            size,
            notes: live.model.notes.clone(),
            ..Self::default()
        };
        if clip.is_none() {
            report.notes.push("the model has no animation: it stands still".to_owned());
        }
        report
    }

    /// Writes report.json and lets all files appear.
    pub(super) fn write(&self, mut folder: OutputFolder, exported: Option<&str>) -> Result<()> {
        let measures = &self.measures;
        let stages: serde_json::Map<String, serde_json::Value> = Stage::ALL
            .into_iter()
            .map(|stage| (stage.name().to_owned(), json!(measures.stage_ms_median(stage))))
            .collect();
        let errors = Summary::of(&measures.phase_errors);
        let jumps = Summary::of(&measures.phase_jump_shares);
        let report = json!({
            "plisse": env!("CARGO_PKG_VERSION"),
            "model": self.model,
            "adapter": self.adapter,
            "welded_vertices": self.welded_vertices,
            "draw_vertices": self.draw_vertices,
            "faces": self.faces,
            "singular_vertices": measures.singular_vertices,
            "clip": self.clip,
            "wavelength_m": self.wavelength_m,
            "frames": measures.pixels.len(),
            "fps": self.fps,
            "size_pixels": self.size,
            "pixels_mean": measures.pixels_mean(),
            "stage_ms_median": stages,
            "phase_error_waves": {
                "first": measures.phase_errors.first(),
                "mean": errors.map(|s| s.mean),
                "max": errors.map(|s| s.max),
            },
            "phase_jump_share": {
                "mean": jumps.map(|s| s.mean),
                "max": jumps.map(|s| s.max),
            },
            "export": exported,
            "notes": self.notes,
            "seconds_total": self.seconds_total,
        });
        write_json(&mut folder, "report.json", &report)?;
        folder.commit().map(|_| ())
    }

    /// The same figures on the terminal.
    pub(super) fn print(&self, path: &Path) {
        let mut table = format!("{}\n", self.model);
        let mut row = |name: &str, value: String| table += &format!("  {name:<24} {value}\n");
        row("adapter", self.adapter.clone());
        row(
            "mesh",
            format!(
                "{} welded vertices ({} drawn), {} faces",
                self.welded_vertices, self.draw_vertices, self.faces
            ),
        );
        if let Some(clip) = &self.clip {
            row("clip", clip.clone());
        }
        row(
            "frames",
            format!(
                "{} at {} a second, {:.0} pixels of the model on each",
                self.measures.pixels.len(),
                self.fps,
                self.measures.pixels_mean()
            ),
        );
        let median = |stage: Stage| {
            let ms = self.measures.stage_ms_median(stage)?;
            Some(format!("{} {ms:.3}", stage.name()))
        };
        let stages: Vec<String> = Stage::ALL.into_iter().filter_map(median).collect();
        row(
            "stages (ms)",
            if stages.is_empty() {
                "the adapter cannot tell".to_owned()
            } else {
                stages.join(", ")
            },
        );
        if let Some(Summary { mean, max }) = Summary::of(&self.measures.phase_errors) {
            row("phase error (waves)", format!("mean {mean:.4}, max {max:.4}"));
        }
        if let Some(Summary { mean, max }) = Summary::of(&self.measures.phase_jump_shares) {
            row(
                "phase jumps (%)",
                format!(
                    "mean {:.3}, max {:.3} of the wrinkled vertices",
                    100.0 * mean,
                    100.0 * max
                ),
            );
        }
        row("seconds", format!("total {:.3}", self.seconds_total));
        for note in &self.notes {
            table += &format!("  note: {note}\n");
        }
        table += &format!("  written to               {}\n", path.display());
        print(&table);
    }
}
