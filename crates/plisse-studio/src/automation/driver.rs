//! The driver of a script: one step a frame.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use egui::{ColorImage, ScreenshotCallback, ViewportCommand};
use plisse::picture::Image;
use plisse::{Error, Result};
use plisse_live::Vec2;

use crate::automation::script::Step;
use crate::commands::Command;
use crate::document::{Action, Falloff, Heading, Layer, Mirror};
use crate::shell::Tab;
use crate::studio::Studio;
use crate::view::View;
use crate::viewport::ShownSurface;
use crate::work::export::Kind;

/// Frames without any work after which the program counts as settled.
const CALM: usize = 4;

/// A screenshot that is awaited: its path, and the image once it has come.
struct Shot {
    path: PathBuf,
    image: Arc<Mutex<Option<Arc<ColorImage>>>>,
}

/// A script that is running.
pub struct Driver {
    steps: Vec<Step>,
    at: usize,
    /// Time of the next step (s).
    waits_s: f64,
    calm: usize,
    /// The points of a stroke that are not painted yet.
    stroke: Vec<Vec2>,
    shot: Option<Shot>,
}

impl Driver {
    /// A driver before the first step.
    pub fn new(steps: Vec<Step>) -> Self {
        Self { steps, at: 0, waits_s: 0.0, calm: 0, stroke: Vec::new(), shot: None }
    }

    /// True if all steps are done.
    pub fn is_done(&self) -> bool {
        self.at >= self.steps.len() && self.shot.is_none() && self.stroke.is_empty()
    }

    /// Runs the next step, if its time has come.
    ///
    /// # Errors
    /// [`Error::Value`] naming the line of a step that cannot be done; [`Error::File`] for a
    /// picture
    /// that cannot be written.
    pub fn advance(&mut self, studio: &mut Studio, ctx: &egui::Context, now_s: f64) -> Result<()> {
        ctx.request_repaint();
        if let Some(Shot { path, image }) = &self.shot {
            let Some(image) = image.lock().ok().and_then(|mut i| i.take()) else { return Ok(()) };
            write(path, &image)?;
            self.shot = None;
            return Ok(());
        }
        if now_s < self.waits_s {
            return Ok(());
        }
        if !self.stroke.is_empty() {
            // One point a frame, as from a hand.
            let point = self.stroke.remove(0);
            studio.stroke(point);
            if self.stroke.is_empty() {
                studio.end_stroke();
            }
            return Ok(());
        }
        if studio.jobs.reading.is_busy() {
            return Ok(());
        }
        let Some(step) = self.steps.get(self.at).cloned() else { return Ok(()) };
        if step.word == "settle" {
            self.calm =
                if studio.is_idle() && studio.viewport.frame.is_some() { self.calm + 1 } else { 0 };
            if self.calm < CALM {
                return Ok(());
            }
            self.calm = 0;
        }
        self.at += 1;
        self.step(&step, studio, ctx, now_s)
    }

    fn step(
        &mut self,
        step: &Step,
        studio: &mut Studio,
        ctx: &egui::Context,
        now_s: f64,
    ) -> Result<()> {
        let is_known = self.window_step(step, studio, ctx, now_s)?
            || view_step(step, studio)?
            || self.brush_step(step, studio)?
            || job_step(step, studio)?;
        if is_known { Ok(()) } else { Err(unknown(step, &format!("command \"{}\"", step.word))) }
    }

    /// A step of files and of the window itself; false for other commands.
    fn window_step(
        &mut self,
        step: &Step,
        studio: &mut Studio,
        ctx: &egui::Context,
        now_s: f64,
    ) -> Result<bool> {
        match step.word.as_str() {
            "settle" => {}
            "open" => match step.text(0)? {
                name if plisse_live::models::NAMES.contains(&name) => studio.show_own(name),
                path => studio.open(Path::new(path)),
            },
            "tab" => {
                let name = step.rest.join(" ");
                studio.shell.tab = Tab::ALL
                    .into_iter()
                    .find(|t| t.name().eq_ignore_ascii_case(&name))
                    .ok_or_else(|| unknown(step, "such tab"))?;
            }
            "save" => studio.save(Path::new(step.text(0)?)),
            "wait" => self.waits_s = now_s + f64::from(step.number(0)?),
            "screenshot" => {
                let image = Arc::new(Mutex::new(None));
                let theirs = Arc::clone(&image);
                let taken = ScreenshotCallback::new(move |picture| {
                    if let Ok(mut there) = theirs.lock() {
                        *there = Some(picture);
                    }
                });
                ctx.send_viewport_cmd(ViewportCommand::Screenshot(taken));
                self.shot = Some(Shot { path: PathBuf::from(step.text(0)?), image });
            }
            "quit" => studio.shell.quits = true,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// A step of the brush and the history; false for other commands.
    fn brush_step(&mut self, step: &Step, studio: &mut Studio) -> Result<bool> {
        match step.word.as_str() {
            "brush" => brush(step, studio)?,
            "stroke" => {
                let numbers =
                    (0..step.rest.len()).map(|k| step.number(k)).collect::<Result<Vec<f32>>>()?;
                self.stroke = numbers.chunks_exact(2).map(|p| Vec2::new(p[0], p[1])).collect();
            }
            "undo" => studio.run(Command::Undo),
            "redo" => studio.run(Command::Redo),
            _ => return Ok(false),
        }
        Ok(true)
    }
}

fn unknown(step: &Step, name: &str) -> Error {
    Error::value(format!("script, line {}", step.line), format!("there is no {name}; correct it"))
}

/// A step of the picture, the camera and the clip; false for other commands.
fn view_step(step: &Step, studio: &mut Studio) -> Result<bool> {
    let (viewport, settings) = (&mut studio.viewport, &mut studio.session.document.settings);
    match step.word.as_str() {
        "view" => {
            viewport.view = match step.text(0)? {
                "painted" => View::Painted(studio.tools.brush.layer),
                name => View::MAIN
                    .into_iter()
                    .find(|v| v.word() == name)
                    .ok_or_else(|| unknown(step, "such view"))?,
            };
        }
        "show" => {
            viewport.shown = match step.text(0)? {
                "model" => ShownSurface::Live,
                "solved" => ShownSurface::Solved,
                "grown" => ShownSurface::Grown,
                _ => return Err(unknown(step, "such surface")),
            }
        }
        "time" => (settings.time_s, viewport.playing) = (step.number(0)?, false),
        "clip" => settings.clip = Some(step.rest.join(" ")).filter(|c| c != "none"),
        "play" => viewport.playing = true,
        "hold" => viewport.playing = false,
        "orbit" => viewport.orbit.orbit(step.number(0)?.to_radians(), step.number(1)?.to_radians()),
        "zoom" => viewport.orbit.zoom(step.number(0)?),
        "fit" => studio.run(Command::Frame),
        "lose-gpu" => viewport.lose_device(),
        _ => return Ok(false),
    }
    Ok(true)
}

/// A step of wrinkles, solves, growth and export; false for other commands.
fn job_step(step: &Step, studio: &mut Studio) -> Result<bool> {
    let settings = &mut studio.session.document.settings;
    match step.word.as_str() {
        "wavelength" => settings.wavelength_m = step.number(0)?,
        "spacing" => settings.fold_spacing_m = f64::from(step.number(0)?),
        "solve" => studio.run(Command::Solve),
        "grow" => studio.run(Command::Grow),
        "fold" => studio.fold_under_brush(step.text(0)? == "on"),
        // `take` is the older name.
        "export" | "take" => {
            let kind = match step.text(0)? {
                "surface" => Kind::Surface,
                "maps" => Kind::Maps,
                "field" => Kind::Field,
                "paint" => Kind::Paint,
                "scene" => Kind::SceneFiles,
                _ => return Err(unknown(step, "such kind of file")),
            };
            studio.export_files(kind, Path::new(step.text(1)?));
        }
        _ => return Ok(false),
    }
    Ok(true)
}

fn brush(step: &Step, studio: &mut Studio) -> Result<()> {
    let unknown = || {
        Error::value(
            format!("script, line {}", step.line),
            "the brush has no such setting or value; correct it",
        )
    };
    let value = step.text(1)?;
    match step.text(0)? {
        "layer" => {
            let layer = match value {
                "wrinkles" => Layer::Wrinkles,
                "wavelength" => Layer::Wavelength,
                "expansion" => Layer::Expansion,
                "coherence" => Layer::Coherence,
                "freeze" => Layer::Freeze,
                _ => return Err(unknown()),
            };
            studio.choose_layer(layer);
        }
        "radius" => studio.tools.brush.radius_m = step.number(1)?,
        "strength" => studio.tools.brush.strength = step.number(1)?,
        "value" => studio.tools.brush.value = step.number(1)?,
        "heading" => {
            studio.tools.brush.heading = match value {
                "along" => Heading::AlongStroke,
                "across" => Heading::AcrossStroke,
                "screen" => Heading::Screen,
                "isotropic" => Heading::Isotropic,
                _ => return Err(unknown()),
            }
        }
        "mirror" => {
            studio.tools.brush.mirror = match value {
                "off" => Mirror::Off,
                "x" => Mirror::X,
                "y" => Mirror::Y,
                "z" => Mirror::Z,
                _ => return Err(unknown()),
            }
        }
        "falloff" => {
            studio.tools.brush.falloff = match value {
                "smooth" => Falloff::Smooth,
                "linear" => Falloff::Linear,
                "hard" => Falloff::Hard,
                _ => return Err(unknown()),
            }
        }
        "action" => {
            studio.tools.brush.action = if value == "erase" { Action::Erase } else { Action::Paint }
        }
        _ => return Err(unknown()),
    }
    Ok(())
}

fn write(path: &Path, image: &ColorImage) -> Result<()> {
    let pixels = image.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b()]).collect();
    let image = Image { width: image.size[0], height: image.size[1], pixels };
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
    let mut folder =
        plisse::io::staged::OutputFolder::create(path.parent().unwrap_or(Path::new(".")))?;
    folder.write(name, |out| plisse::picture::write_png(&image, out))?;
    folder.commit().map(|_| ())
}
