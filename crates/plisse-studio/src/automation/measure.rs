//! Milliseconds per frame of every view, on a large sheet, without a window.

use std::io::Write as _;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plisse::{Error, Result};
use plisse_live::stage::Stage;
use plisse_live::{Vec2, models};

use crate::commands::Command;
use crate::document::{Document, Mirror, Source, Subject};
use crate::shell::Tab;
use crate::studio::{Start, Studio};
use crate::view::{Graphics, View};

/// Number of vertices along each side of the sheet.
const SIDE: usize = 317;
/// Number of frames measured while nothing moves.
const FRAMES: usize = 60;
/// Size of the window (points).
const SCREEN: egui::Vec2 = egui::vec2(1280.0, 800.0);
/// Number of pictures of each view in the table.
const PICTURES: usize = 5;

/// Times of one view.
#[derive(Clone, Debug)]
pub struct Row {
    /// The view.
    pub view: View,
    /// Time of the window's own thread per frame while nothing moves (ms): user interface and
    /// tessellation.
    pub idle_ms: f32,
    /// The longest frame of the window's own thread while pictures come in (ms).
    pub longest_ms: f32,
    /// Time of the stages before drawing, in the render thread (ms).
    pub stages_ms: f32,
    /// Time of drawing, in the render thread (ms).
    pub render_ms: f32,
}

/// Times of painting.
#[derive(Clone, Copy, Debug)]
pub struct Strokes {
    /// Longest frame (ms) while two quick strokes cross the sheet, the second one mirrored.
    pub longest_ms: f32,
    /// Number of vertices that the two strokes changed, in sum.
    pub vertices: usize,
}

/// Times of all views and of painting.
#[derive(Clone, Debug)]
pub struct Report {
    /// The views.
    pub rows: Vec<Row>,
    /// Painting.
    pub strokes: Strokes,
    /// Name of the device that drew.
    pub device: String,
}

/// The program without a window, and the clock of its frames.
struct Bench {
    studio: Studio,
    ctx: egui::Context,
    now_s: f64,
}

impl Bench {
    /// The program on a sheet of about 100,000 vertices; `gpu`: true if it may use a GPU.
    fn new(gpu: bool) -> Result<Self> {
        let mut studio = Studio::new(Start {
            graphics: Graphics::own(gpu),
            autosave_folder: None,
            request_repaint: Arc::new(|| {}),
        })?;
        let sheet = Subject::new(Source::Own("sheet".into()), models::sheet(SIDE, SIDE));
        studio.show(Document::new(sheet), None);
        studio.session.document.settings.time_s = 0.5;
        studio.session.document.settings.wavelength_m = 0.02;
        studio.viewport.playing = false;
        studio.run(Command::Frame);
        Ok(Self { studio, ctx: egui::Context::default(), now_s: 0.0 })
    }

    /// Runs one frame; its time (ms).
    fn frame(&mut self) -> f32 {
        self.now_s += 1.0 / 60.0;
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, SCREEN)),
            time: Some(self.now_s),
            ..Default::default()
        };
        let begun = Instant::now();
        let mut output = self.ctx.run_ui(input, |ui| self.studio.ui(ui));
        // No window takes the textures.
        output.textures_delta.clear();
        let primitives = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        std::hint::black_box(primitives);
        begun.elapsed().as_secs_f32() * 1e3
    }

    /// Measures `pictures` pictures of a view, and frames while nothing moves.
    fn view(&mut self, view: View, pictures: usize) -> Result<Row> {
        self.studio.viewport.view = view;
        let (mut longest_ms, mut stages_ms, mut render_ms) = (0f32, Vec::new(), Vec::new());
        for _ in 0..pictures {
            self.studio.viewport.orbit.orbit(0.02, 0.0);
            self.studio.viewport.frame = None;
            let begun = Instant::now();
            while self.studio.viewport.frame.is_none() {
                longest_ms = longest_ms.max(self.frame());
                if begun.elapsed() > Duration::from_secs(120) {
                    return Err(Error::numeric(
                        "measure",
                        "no picture came within two minutes; try --cpu",
                    ));
                }
                std::thread::sleep(Duration::from_millis(5));
            }
            if let Some(frame) = &self.studio.viewport.frame {
                let others = frame.stage_ms.iter().filter(|(stage, _)| *stage != Stage::Render);
                stages_ms.push(others.map(|(_, ms)| ms).sum::<f32>());
                render_ms.push(frame.stage_ms[Stage::Render]);
            }
        }
        let begun = Instant::now();
        while !self.studio.is_idle() && begun.elapsed() < Duration::from_secs(300) {
            self.frame();
            std::thread::sleep(Duration::from_millis(5));
        }
        let idle: Vec<f32> = (0..FRAMES).map(|_| self.frame()).collect();
        Ok(Row {
            view,
            idle_ms: median(idle),
            longest_ms,
            stages_ms: median(stages_ms),
            render_ms: median(render_ms),
        })
    }

    /// Measures two quick strokes across the whole sheet, the second one mirrored.
    fn strokes(&mut self) -> Strokes {
        self.studio.shell.tab = Tab::Paint;
        let mut longest_ms = 0f32;
        for mirror in [Mirror::Off, Mirror::Y] {
            self.studio.tools.brush.mirror = mirror;
            for k in 0..=10 {
                let begun = Instant::now();
                self.studio.stroke(Vec2::new(0.3 + 0.04 * k as f32, 0.4 + 0.01 * k as f32));
                let stroke_ms = begun.elapsed().as_secs_f32() * 1e3;
                longest_ms = longest_ms.max(stroke_ms + self.frame());
            }
            self.studio.release_stroke();
            while self.studio.tools.trail.is_some() {
                longest_ms = longest_ms.max(self.frame());
            }
        }
        let changes = self.studio.session.document.history.done();
        Strokes { longest_ms, vertices: changes.iter().map(|c| c.vertices.len()).sum() }
    }
}

/// Measures some `pictures` of each of the `views`, and painting; `gpu`: true if a GPU may be used.
///
/// # Errors
/// [`Error::Numeric`] if no picture comes.
pub fn measure(gpu: bool, views: &[View], pictures: usize) -> Result<Report> {
    let mut bench = Bench::new(gpu)?;
    // Fonts are laid out in the first frame of all.
    bench.frame();
    let rows = views.iter().map(|&view| bench.view(view, pictures)).collect::<Result<Vec<_>>>()?;
    let strokes = bench.strokes();
    let frame = bench.studio.viewport.frame.as_ref();
    let device = frame.map_or_else(String::new, |frame| frame.device.clone());
    Ok(Report { rows, strokes, device })
}

fn median(mut list: Vec<f32>) -> f32 {
    list.sort_by(f32::total_cmp);
    list.get(list.len() / 2).copied().unwrap_or(0.0)
}

/// Prints [`measure()`] as a table.
///
/// # Errors
/// As [`measure()`].
pub fn run(gpu: bool) -> Result<()> {
    let Report { rows, strokes, device } = measure(gpu, &View::MAIN, PICTURES)?;
    let mut text = format!("{} vertices; drawn by {device}\n\n", SIDE * SIDE);
    text += "| view | frame, idle (ms) | longest frame (ms) | stages (ms) | drawing (ms) \
        |\n|---|---|---|---|---|\n";
    for row in rows {
        text += &format!(
            "| {} | {:.2} | {:.2} | {:.1} | {:.1} |\n",
            row.view.name(),
            row.idle_ms,
            row.longest_ms,
            row.stages_ms,
            row.render_ms
        );
    }
    text += &format!(
        "\nLongest frame while painting {} vertices: {:.2} ms\n",
        strokes.vertices, strokes.longest_ms
    );
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(())
}
