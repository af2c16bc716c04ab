//! Milliseconds a frame of every view, on a large sheet, without a window.

use std::io::Write as _;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plisse::{Error, Result};
use plisse_live::models;

use crate::commands::Command;
use crate::document::{Document, Source, Subject};
use crate::studio::{Start, Studio};
use crate::view::{Graphics, View};

/// Vertices along each side of the sheet.
const SIDE: usize = 317;
/// Frames that are measured with the window idle.
const FRAMES: usize = 60;
/// Pictures of each view in the table.
const PICTURES: usize = 5;

/// What one view took, in milliseconds.
#[derive(Clone, Debug)]
pub struct Row {
    /// The view.
    pub view: View,
    /// Of a frame of the window's own thread while nothing moves: user interface and tessellation.
    pub idle_ms: f32,
    /// The longest frame of the window's own thread while pictures come in.
    pub longest_ms: f32,
    /// Of the stages before drawing, on their own thread.
    pub stages_ms: f32,
    /// Of drawing, on the same.
    pub render_ms: f32,
}

/// What painting took.
#[derive(Clone, Copy, Debug)]
pub struct Strokes {
    /// Longest frame (ms) while two quick strokes ran over the sheet, the second one mirrored.
    pub longest_ms: f32,
    /// Vertices that they changed, both together.
    pub vertices: usize,
}

/// Runs the program without a window on a sheet of about 100,000 vertices, with some `pictures` of
/// each of the `views`; `gpu`: whether it may use one. Also the name of what drew.
///
/// # Errors
/// [`Error::Numeric`] if no picture comes.
pub fn rows(gpu: bool, views: &[View], pictures: usize) -> Result<(Vec<Row>, Strokes, String)> {
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
    let ctx = egui::Context::default();
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 800.0));
    let mut now_s = 0.0;
    let mut frame = |studio: &mut Studio| {
        now_s += 1.0 / 60.0;
        let input =
            egui::RawInput { screen_rect: Some(screen), time: Some(now_s), ..Default::default() };
        let begun = Instant::now();
        let mut output = ctx.run_ui(input, |ui| studio.ui(ui));
        // No window takes the textures.
        output.textures_delta.clear();
        let primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
        std::hint::black_box(primitives);
        begun.elapsed().as_secs_f32() * 1e3
    };
    // Fonts are laid out in the first frame of all.
    frame(&mut studio);
    let mut rows = Vec::new();
    for &view in views {
        studio.viewport.view = view;
        let (mut longest_ms, mut stages_ms, mut render_ms) = (0f32, Vec::new(), Vec::new());
        for _ in 0..pictures {
            studio.viewport.orbit.orbit(0.02, 0.0);
            studio.viewport.frame = None;
            let begun = Instant::now();
            while studio.viewport.frame.is_none() {
                longest_ms = longest_ms.max(frame(&mut studio));
                if begun.elapsed() > Duration::from_secs(120) {
                    return Err(Error::numeric(
                        "measure",
                        "no picture came within two minutes; try --cpu",
                    ));
                }
                std::thread::sleep(Duration::from_millis(5));
            }
            if let Some(frame) = &studio.viewport.frame {
                stages_ms.push(frame.stage_ms[..4].iter().sum::<f32>());
                render_ms.push(frame.stage_ms[4]);
            }
        }
        // Until nothing is on its way.
        let begun = Instant::now();
        while !studio.is_idle() && begun.elapsed() < Duration::from_secs(300) {
            frame(&mut studio);
            std::thread::sleep(Duration::from_millis(5));
        }
        let idle: Vec<f32> = (0..FRAMES).map(|_| frame(&mut studio)).collect();
        rows.push(Row {
            view,
            idle_ms: median(idle),
            longest_ms,
            stages_ms: median(stages_ms),
            render_ms: median(render_ms),
        });
    }
    // A quick stroke across the whole sheet, once there and once mirrored.
    studio.shell.tab = crate::shell::Tab::Paint;
    let mut stroke_ms = 0f32;
    for mirror in [crate::document::Mirror::Off, crate::document::Mirror::Y] {
        studio.tools.brush.mirror = mirror;
        for k in 0..=10 {
            let begun = Instant::now();
            studio.stroke(plisse_live::Vec2::new(0.3 + 0.04 * k as f32, 0.4 + 0.01 * k as f32));
            stroke_ms = stroke_ms.max(begun.elapsed().as_secs_f32() * 1e3 + frame(&mut studio));
        }
        studio.release_stroke();
        while studio.tools.trail.is_some() {
            stroke_ms = stroke_ms.max(frame(&mut studio));
        }
    }
    let painted = studio.session.document.history.done().iter().map(|c| c.vertices.len()).sum();
    let stroke = Strokes { longest_ms: stroke_ms, vertices: painted };
    let device = studio.viewport.frame.as_ref().map_or_else(String::new, |s| s.device.clone());
    Ok((rows, stroke, device))
}

fn median(mut list: Vec<f32>) -> f32 {
    list.sort_by(f32::total_cmp);
    list.get(list.len() / 2).copied().unwrap_or(0.0)
}

/// Prints [`rows`] as a table.
///
/// # Errors
/// As [`rows`].
pub fn run(gpu: bool) -> Result<()> {
    let (rows, strokes, device) = rows(gpu, &View::MAIN, PICTURES)?;
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
