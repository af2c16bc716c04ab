//! Runs a script, step by step, frame by frame.

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

/// Frames that must go by with nothing on its way for the program to count as settled.
const CALM: usize = 4;

/// A screenshot that is awaited: where it goes, and where it comes in.
type Shot = (PathBuf, Arc<Mutex<Option<Arc<ColorImage>>>>);

/// A script on its way.
pub struct Driver {
    steps: Vec<Step>,
    at: usize,
    /// Nothing happens before this time (s).
    waits_s: f64,
    calm: usize,
    /// The points of a stroke that are still to come.
    stroke: Vec<Vec2>,
    shot: Option<Shot>,
}

impl Driver {
    /// Before the first step.
    pub fn new(steps: Vec<Step>) -> Self {
        Self { steps, at: 0, waits_s: 0.0, calm: 0, stroke: Vec::new(), shot: None }
    }

    /// Whether all is done.
    pub fn is_done(&self) -> bool {
        self.at >= self.steps.len() && self.shot.is_none() && self.stroke.is_empty()
    }

    /// Goes on by one step, if it is time.
    ///
    /// # Errors
    /// [`Error::Value`] naming the line of a step that cannot be done; [`Error::File`] for a picture that cannot be written.
    pub fn go(&mut self, studio: &mut Studio, ctx: &egui::Context, now_s: f64) -> Result<()> {
        ctx.request_repaint();
        if let Some((path, image)) = &self.shot {
            let Some(image) = image.lock().ok().and_then(|mut i| i.take()) else { return Ok(()) };
            write(path, &image)?;
            self.shot = None;
            return Ok(());
        }
        if now_s < self.waits_s {
            return Ok(());
        }
        if !self.stroke.is_empty() {
            // One point a frame, as a hand would.
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
        let unknown = |what: &str| {
            Error::value(
                format!("script, line {}", step.line),
                format!("there is no {what}; correct it"),
            )
        };
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
                    .ok_or_else(|| unknown("such tab"))?;
            }
            "view" => {
                let name = step.text(0)?;
                studio.viewport.view = match name {
                    "painted" => View::Painted(studio.tools.brush.layer),
                    name => View::MAIN
                        .into_iter()
                        .find(|v| v.word() == name)
                        .ok_or_else(|| unknown("such view"))?,
                };
            }
            "show" => {
                studio.viewport.shown = match step.text(0)? {
                    "model" => ShownSurface::Live,
                    "solved" => ShownSurface::Solved,
                    "grown" => ShownSurface::Grown,
                    _ => return Err(unknown("such surface")),
                }
            }
            "time" => {
                (studio.session.document.settings.time_s, studio.viewport.playing) =
                    (step.number(0)?, false)
            }
            "clip" => {
                studio.session.document.settings.clip =
                    Some(step.rest.join(" ")).filter(|c| c != "none")
            }
            "wavelength" => studio.session.document.settings.wavelength_m = step.number(0)?,
            "play" => studio.viewport.playing = true,
            "hold" => studio.viewport.playing = false,
            "orbit" => studio
                .viewport
                .orbit
                .orbit(step.number(0)?.to_radians(), step.number(1)?.to_radians()),
            "zoom" => studio.viewport.orbit.zoom(step.number(0)?),
            "fit" => studio.run(Command::Frame),
            "brush" => brush(step, studio)?,
            "stroke" => {
                let numbers =
                    (0..step.rest.len()).map(|k| step.number(k)).collect::<Result<Vec<f32>>>()?;
                self.stroke = numbers.chunks_exact(2).map(|p| Vec2::new(p[0], p[1])).collect();
            }
            "undo" => studio.run(Command::Undo),
            "redo" => studio.run(Command::Redo),
            "solve" => studio.run(Command::Solve),
            "grow" => studio.run(Command::Grow),
            "fold" => studio.fold_under_brush(step.text(0)? == "on"),
            "spacing" => {
                studio.session.document.settings.fold_spacing_m = f64::from(step.number(0)?)
            }
            // `take` is the older name.
            "export" | "take" => {
                let kind = match step.text(0)? {
                    "surface" => Kind::Surface,
                    "maps" => Kind::Maps,
                    "field" => Kind::Field,
                    "paint" => Kind::Paint,
                    "scene" => Kind::SceneFiles,
                    _ => return Err(unknown("such kind of file")),
                };
                studio.export_files(kind, Path::new(step.text(1)?));
            }
            "save" => studio.save(Path::new(step.text(0)?)),
            "wait" => self.waits_s = now_s + f64::from(step.number(0)?),
            "lose-gpu" => studio.viewport.lose_device(),
            "screenshot" => {
                let image = Arc::new(Mutex::new(None));
                let theirs = Arc::clone(&image);
                let taken = ScreenshotCallback::new(move |picture| {
                    if let Ok(mut there) = theirs.lock() {
                        *there = Some(picture);
                    }
                });
                ctx.send_viewport_cmd(ViewportCommand::Screenshot(taken));
                self.shot = Some((PathBuf::from(step.text(0)?), image));
            }
            "quit" => studio.shell.quits = true,
            _ => return Err(unknown(&format!("command \"{}\"", step.word))),
        }
        Ok(())
    }
}

fn brush(step: &Step, studio: &mut Studio) -> Result<()> {
    let unknown = || {
        Error::value(
            format!("script, line {}", step.line),
            "the brush has no such thing; correct it",
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
        plisse::io::aside::OutputFolder::create(path.parent().unwrap_or(Path::new(".")))?;
    folder.write(name, |out| plisse::picture::write_png(&image, out))?;
    folder.commit().map(|_| ())
}
