//! report.json of `plisse live`, and its short table.

use std::path::Path;

use plisse::Result;
use plisse::io::staged::OutputFolder;
use plisse_gpu::STAGES;
use plisse_live::model::Clip;
use serde_json::json;

use crate::animated::Animated;
use crate::arguments::LiveArguments;
use crate::outputs::write_json;
use crate::terminal::print;

/// What a run found.
#[derive(Default)]
pub(super) struct Report {
    model: String,
    unified_vertices: usize,
    draw_vertices: usize,
    faces: usize,
    clip: Option<String>,
    wavelength_m: f64,
    fps: f64,
    size: [usize; 2],
    pub(super) adapter: String,
    pub(super) frames: usize,
    pub(super) singular_vertices: usize,
    /// Of each step that ran the stage (ms).
    pub(super) stage_ms: [Vec<f64>; 5],
    /// Pixels that show the model, of each frame.
    pub(super) pixels: Vec<usize>,
    /// Of each frame (waves, 0 to 1/2).
    pub(super) phase_errors: Vec<f64>,
    /// Share of the wrinkled vertices whose phase moved more than π/4, of each step.
    pub(super) jumps: Vec<f64>,
    pub(super) notes: Vec<String>,
    pub(super) seconds_total: f64,
}

fn mean(list: &[f64]) -> Option<f64> {
    (!list.is_empty()).then(|| list.iter().sum::<f64>() / list.len() as f64)
}

fn largest(list: &[f64]) -> Option<f64> {
    list.iter().copied().reduce(f64::max)
}

impl Report {
    pub(super) fn new(
        animated: &Animated,
        clip: Option<&Clip>,
        arguments: &LiveArguments,
        size: [usize; 2],
    ) -> Self {
        let mut report = Self {
            model: animated.model.name.clone(),
            unified_vertices: animated.unified.count(),
            draw_vertices: animated.model.draw.positions.len(),
            faces: animated.model.faces.len(),
            clip: clip.map(|c| c.name.clone()),
            wavelength_m: animated.wavelength_m,
            fps: arguments.fps,
            size,
            ..Self::default()
        };
        if clip.is_none() {
            report.notes.push("the model has no animation: it stands still".to_owned());
        }
        report
    }

    /// Milliseconds of stage `s`: the median, which the first frames' preparations do not move.
    fn stage(&self, s: usize) -> Option<f64> {
        let mut sorted = self.stage_ms[s].clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    fn pixels_mean(&self) -> f64 {
        self.pixels.iter().sum::<usize>() as f64 / self.pixels.len().max(1) as f64
    }

    /// Writes report.json and lets all files appear.
    pub(super) fn write(&self, mut folder: OutputFolder, exported: Option<&str>) -> Result<()> {
        let stages: serde_json::Map<String, serde_json::Value> = STAGES
            .iter()
            .enumerate()
            .map(|(s, name)| ((*name).to_owned(), json!(self.stage(s))))
            .collect();
        let report = json!({
            "plisse": env!("CARGO_PKG_VERSION"),
            "model": self.model,
            "adapter": self.adapter,
            "unified_vertices": self.unified_vertices,
            "draw_vertices": self.draw_vertices,
            "faces": self.faces,
            "singular_vertices": self.singular_vertices,
            "clip": self.clip,
            "wavelength_m": self.wavelength_m,
            "frames": self.frames,
            "fps": self.fps,
            "size_pixels": self.size,
            "pixels_mean": self.pixels_mean(),
            "stage_ms_median": stages,
            "phase_error_waves": {"first": self.phase_errors.first(), "mean": mean(&self.phase_errors), "max": largest(&self.phase_errors)},
            "phase_jump_share": {"mean": mean(&self.jumps), "max": largest(&self.jumps)},
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
                "{} unified vertices ({} drawn), {} faces",
                self.unified_vertices, self.draw_vertices, self.faces
            ),
        );
        if let Some(clip) = &self.clip {
            row("clip", clip.clone());
        }
        row(
            "frames",
            format!(
                "{} at {} a second, {:.0} pixels of the model on each",
                self.frames,
                self.fps,
                self.pixels_mean()
            ),
        );
        let stages: Vec<String> = (0..STAGES.len())
            .filter_map(|s| self.stage(s).map(|ms| format!("{} {ms:.3}", STAGES[s])))
            .collect();
        row(
            "stages (ms)",
            if stages.is_empty() {
                "the adapter cannot tell".to_owned()
            } else {
                stages.join(", ")
            },
        );
        if let (Some(mean), Some(most)) = (mean(&self.phase_errors), largest(&self.phase_errors)) {
            row("phase error (waves)", format!("mean {mean:.4}, max {most:.4}"));
        }
        if let (Some(mean), Some(most)) = (mean(&self.jumps), largest(&self.jumps)) {
            row(
                "phase jumps (%)",
                format!(
                    "mean {:.3}, max {:.3} of the wrinkled vertices",
                    100.0 * mean,
                    100.0 * most
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
