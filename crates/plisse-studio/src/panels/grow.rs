//! Grow: what is painted, or what the scene says, grows and folds up.

use std::sync::Arc;

use egui::{Button, Ui};

use super::physics::progress;
use super::slider;
use crate::document::Layer;
use crate::studio::{Looking, Studio};
use crate::view::Solid;
use crate::work::fold::{Fold, Wanted};
use crate::work::grow::{Grown, Part, plan, run};
use crate::work::job::{Job, News, Progress};

/// Growth on its way, and what came of it.
#[derive(Default)]
pub struct Growth {
    job: Option<Job<Part>>,
    solid: Option<Arc<Solid>>,
    /// The last whole result.
    pub grown: Option<Arc<Grown>>,
    progress: Progress,
    /// What follows the brush, while that is asked for.
    fold: Option<Fold>,
    /// What it was asked to follow last: revision and dabs.
    followed: (u64, u64),
    /// The spacing and the coherence (m) that it goes by.
    widths_m: (f64, f64),
    /// Milliseconds that it took last.
    fold_ms: f32,
}

impl Growth {
    /// What is to be seen, if anything grew.
    pub fn solid(&self) -> Option<Arc<Solid>> {
        self.solid.clone()
    }

    /// Whether something grows.
    pub fn is_busy(&self) -> bool {
        self.job.is_some() || self.fold.as_ref().is_some_and(Fold::is_busy)
    }

    /// Whether the surface folds under the brush.
    pub fn follows(&self) -> bool {
        self.fold.is_some()
    }

    /// Forgets everything.
    pub fn stop(&mut self) {
        *self = Self::default();
    }
}

impl Studio {
    /// Lets the whole grow, or stops.
    pub fn grow_or_stop(&mut self) {
        if let Some(job) = &self.growth.job {
            job.cancel();
            return;
        }
        let (document, wake) = (self.document.clone(), Arc::clone(&self.wake));
        self.growth.fold = None;
        self.growth.progress = Progress::default();
        self.growth.job = Some(Job::start(
            "grow",
            move || wake(),
            move |reporter| run(&plan(&document)?, reporter),
        ));
    }

    /// Lets the surface fold under the brush from now on, or no longer.
    pub fn fold_under_brush(&mut self, on: bool) {
        if !on {
            self.growth.fold = None;
            return;
        }
        let document = self.document.clone();
        self.growth.followed = (self.document.revision, self.cached.dabs);
        self.growth.widths_m = (document.settings.fold_spacing_m, document.settings.coherence_m);
        self.growth.fold =
            Some(Fold::start(document, self.growth.grown.clone(), Arc::clone(&self.wake)));
        if self.brush.layer != Layer::Expansion {
            self.choose_layer(Layer::Expansion);
        }
    }

    /// Has the fold follow what was painted, and takes what came of it.
    pub(crate) fn follow_brush(&mut self) {
        let settings = &self.document.settings;
        if self.growth.follows()
            && self.growth.widths_m != (settings.fold_spacing_m, settings.coherence_m)
        {
            self.fold_under_brush(true);
        }
        let Some(fold) = &mut self.growth.fold else { return };
        let painted = (self.document.revision, self.cached.dabs);
        if painted != self.growth.followed {
            self.growth.followed = painted;
            let strokes = self.document.history.done().len() + usize::from(self.trail.is_some());
            fold.want(Wanted { layers: self.document.layers.clone(), strokes });
        }
        match fold.take() {
            Some(Ok(folded)) => {
                (self.growth.solid, self.growth.grown) = (Some(folded.solid), Some(folded.grown));
                self.growth.fold_ms = folded.ms;
                self.looking = Looking::Grown;
            }
            Some(Err(error)) => {
                self.messages.problem(error);
                self.growth.fold = None;
            }
            None => {}
        }
    }

    pub(crate) fn take_growth(&mut self) {
        let Some(job) = &self.growth.job else { return };
        let (news, cancelled) = (job.take(), job.is_cancelled());
        self.growth.progress = job.progress();
        for news in news {
            match news {
                News::Part(Part::Step(solid)) => {
                    self.growth.solid = Some(solid);
                    self.looking = Looking::Grown;
                }
                News::Part(Part::Whole(..)) => {}
                News::Done(done) => {
                    self.growth.job = None;
                    match done {
                        Ok(Part::Whole(solid, grown)) => {
                            self.growth.solid = Some(solid);
                            self.looking = Looking::Grown;
                            let steps = grown.report.steps.len();
                            let text =
                                format!("grown in {steps} steps and {:.1} s", grown.report.seconds);
                            self.messages.note(if cancelled {
                                format!("stopped after {steps} steps")
                            } else {
                                text
                            });
                            self.growth.grown = Some(grown);
                        }
                        Ok(Part::Step(_)) => {}
                        Err(error) => self.messages.problem(error),
                    }
                }
            }
        }
    }

    pub(crate) fn grow_panel(&mut self, ui: &mut Ui) {
        let painted = self.document.layers.is_painted(Layer::Expansion);
        let told = self.document.subject.scene.as_ref().is_some_and(|s| s.scene.growth.is_some());
        ui.label(match (painted, told) {
            (true, _) => {
                "What is painted as Expansion grows; Wavelength, Coherence and Freeze say \
                how."
            }
            (false, true) => {
                "The scene says what grows. Paint Expansion to have that grow \
                instead."
            }
            (false, false) => {
                "Paint Expansion first: it says where, by how much, and along what \
                the surface grows."
            }
        });
        ui.add_space(4.0);
        let size_m = f64::from(self.document.subject.size_m());
        if painted || !told {
            let settings = &mut self.document.settings;
            let (low, high) = (0.005 * size_m, 0.5 * size_m);
            slider(
                ui,
                &mut settings.fold_spacing_m,
                low..=high,
                "spacing",
                " m",
                "distance from fold to fold, as seen before growth (m)",
            );
            slider(
                ui,
                &mut settings.coherence_m,
                0.0..=size_m,
                "coherence",
                " m",
                "how far crests run straight where none is painted (m)",
            );
        }
        let mut follows = self.growth.follows();
        let tip = "what the brush paints grows at once, and what lies around it follows";
        if ui.checkbox(&mut follows, "fold under the brush").on_hover_text(tip).changed() {
            self.fold_under_brush(follows);
        }
        if follows {
            ui.label("Drag on the surface: it grows under the brush.");
            self.brush_controls(ui);
            ui.label(format!("the last dabs took {:.0} ms", self.growth.fold_ms));
            return;
        }
        let busy = self.growth.is_busy();
        if ui
            .add_enabled(
                busy || painted || told,
                Button::new(if busy { "Stop" } else { "Grow the whole" }),
            )
            .clicked()
        {
            self.grow_or_stop();
        }
        progress(ui, &self.growth.progress, busy);
        if let Some(grown) = &self.growth.grown {
            let iterations: usize = grown.report.steps.iter().map(|s| s.iterations).sum();
            ui.label(format!(
                "{} steps, {iterations} iterations, {:.1} s",
                grown.report.steps.len(),
                grown.report.seconds
            ));
            if let Some(last) = grown.report.steps.last() {
                ui.label(format!(
                    "residual {:.1e}, energy {:.4e} J",
                    last.residual, last.energy_joule
                ));
            }
        }
    }
}
