//! Grow: what is painted, or what the scene says, grows and folds up.

use std::sync::Arc;

use egui::{Button, Ui};

use super::physics::progress;
use super::slider;
use crate::document::Layer;
use crate::studio::{Looking, Studio};
use crate::view::Solid;
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
}

impl Growth {
    /// What is to be seen, if anything grew.
    pub fn solid(&self) -> Option<Arc<Solid>> {
        self.solid.clone()
    }

    /// Whether something grows.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
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
        self.growth.progress = Progress::default();
        self.growth.job = Some(Job::start("grow", move || wake(), move |reporter| run(&plan(&document)?, reporter)));
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
                            let text = format!("grown in {steps} steps and {:.1} s", grown.report.seconds);
                            self.messages.note(if cancelled { format!("stopped after {steps} steps") } else { text });
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
            (true, _) => "What is painted as Expansion grows; Wavelength, Coherence and Freeze say how.",
            (false, true) => "The scene says what grows. Paint Expansion to have that grow instead.",
            (false, false) => "Paint Expansion first: it says where, by how much, and along what the surface grows.",
        });
        ui.add_space(4.0);
        let size_m = f64::from(self.document.subject.size_m());
        if painted || !told {
            let settings = &mut self.document.settings;
            let (low, high) = (0.005 * size_m, 0.5 * size_m);
            slider(ui, &mut settings.fold_spacing_m, low..=high, "spacing", " m", "distance from fold to fold, as seen before growth (m)");
            slider(ui, &mut settings.coherence_m, 0.0..=size_m, "coherence", " m", "how far crests run straight where none is painted (m)");
        }
        let busy = self.growth.is_busy();
        if ui.add_enabled(busy || painted || told, Button::new(if busy { "Stop" } else { "Grow the whole" })).clicked() {
            self.grow_or_stop();
        }
        progress(ui, &self.growth.progress, busy);
        if let Some(grown) = &self.growth.grown {
            let iterations: usize = grown.report.steps.iter().map(|s| s.iterations).sum();
            ui.label(format!("{} steps, {iterations} iterations, {:.1} s", grown.report.steps.len(), grown.report.seconds));
            if let Some(last) = grown.report.steps.last() {
                ui.label(format!("residual {:.1e}, energy {:.4e} J", last.residual, last.energy_joule));
            }
        }
    }
}
