//! Growth: of the whole surface, or under the brush.

use std::sync::Arc;

use crate::document::Document;
use crate::messages::Messages;
use crate::shell::RequestRepaint;
use crate::view::Solid;
use crate::viewport::{PaintRevision, ShownSurface, Viewport};
use crate::work::fold::{Fold, FoldRequest};
use crate::work::grow::{Grown, Part, plan, run};
use crate::work::job::{Job, News, Progress};

/// Growth and its result.
#[derive(Default)]
pub struct Growth {
    job: Option<Job<Part>>,
    solid: Option<Arc<Solid>>,
    /// The last complete result.
    pub grown: Option<Arc<Grown>>,
    progress: Progress,
    /// Folding under the brush, while it is switched on.
    fold: Option<Fold>,
    /// The paint that was sent to it last.
    sent: PaintRevision,
    /// The widths that it uses.
    widths: Widths,
    /// Time of its last piece of work (ms).
    fold_ms: f32,
}

/// The document's widths of folds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Widths {
    spacing_m: f64,
    coherence_m: f64,
}

impl Widths {
    fn of(document: &Document) -> Self {
        let settings = &document.settings;
        Self { spacing_m: settings.fold_spacing_m, coherence_m: settings.coherence_m }
    }
}

impl Growth {
    /// The surface to show, if anything grew.
    pub fn solid(&self) -> Option<Arc<Solid>> {
        self.solid.clone()
    }

    /// True while something grows.
    pub fn is_busy(&self) -> bool {
        self.job.is_some() || self.fold.as_ref().is_some_and(Fold::is_busy)
    }

    /// True if the surface folds under the brush.
    pub fn follows(&self) -> bool {
        self.fold.is_some()
    }

    /// Progress of the last growth of the whole.
    pub(crate) fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Time of the last piece of folding under the brush (ms).
    pub(crate) fn fold_ms(&self) -> f32 {
        self.fold_ms
    }

    /// Stops, and forgets everything.
    pub fn stop(&mut self) {
        *self = Self::default();
    }

    /// Grows the whole surface, or stops its growth.
    pub fn grow_or_stop(&mut self, document: &Document, request_repaint: &RequestRepaint) {
        if let Some(job) = &self.job {
            job.cancel();
            return;
        }
        let (document, request_repaint) = (document.clone(), Arc::clone(request_repaint));
        self.fold = None;
        self.progress = Progress::default();
        self.job = Some(Job::start(
            "grow",
            move || request_repaint(),
            move |reporter| run(&plan(&document)?, reporter),
        ));
    }

    /// Starts folding under the brush, from what has grown so far.
    pub(crate) fn start_folding(
        &mut self,
        document: &Document,
        painted: PaintRevision,
        request_repaint: &RequestRepaint,
    ) {
        self.sent = painted;
        self.widths = Widths::of(document);
        self.fold =
            Some(Fold::start(document.clone(), self.grown.clone(), Arc::clone(request_repaint)));
    }

    /// Ends folding under the brush.
    pub(crate) fn stop_folding(&mut self) {
        self.fold = None;
    }

    /// True if folding under the brush must start anew: the document's widths have changed.
    pub(crate) fn has_other_widths(&self, document: &Document) -> bool {
        self.follows() && self.widths != Widths::of(document)
    }

    /// Sends new paint to the folding under the brush; `strokes`: number of strokes that led to it,
    /// the current one included.
    pub(crate) fn send_paint(
        &mut self,
        document: &Document,
        painted: PaintRevision,
        strokes: usize,
    ) {
        let Some(fold) = self.fold.as_mut().filter(|_| painted != self.sent) else { return };
        self.sent = painted;
        fold.request(FoldRequest { layers: document.layers.clone(), strokes });
    }

    /// Takes what has folded under the brush.
    pub(crate) fn take_fold(&mut self, viewport: &mut Viewport, messages: &mut Messages) {
        match self.fold.as_mut().and_then(Fold::take) {
            Some(Ok(folded)) => {
                (self.solid, self.grown) = (Some(folded.solid), Some(folded.grown));
                self.fold_ms = folded.ms;
                viewport.shown = ShownSurface::Grown;
            }
            Some(Err(error)) => {
                messages.problem(error);
                self.fold = None;
            }
            None => {}
        }
    }

    /// Takes the news of the growth of the whole.
    pub(crate) fn take_growth(&mut self, viewport: &mut Viewport, messages: &mut Messages) {
        let Some(job) = &self.job else { return };
        let (news, cancelled) = (job.take(), job.is_cancelled());
        self.progress = job.progress();
        for news in news {
            match news {
                News::Part(Part::Step(solid)) => {
                    self.solid = Some(solid);
                    viewport.shown = ShownSurface::Grown;
                }
                News::Part(Part::Whole(..)) => {}
                News::Done(done) => {
                    self.job = None;
                    match done {
                        Ok(Part::Whole(solid, grown)) => {
                            self.solid = Some(solid);
                            viewport.shown = ShownSurface::Grown;
                            messages.note(growth_note(&grown, cancelled));
                            self.grown = Some(grown);
                        }
                        Ok(Part::Step(_)) => {}
                        Err(error) => messages.problem(error),
                    }
                }
            }
        }
    }
}

/// The message about growth that ended.
fn growth_note(grown: &Grown, cancelled: bool) -> String {
    let steps = grown.report.steps.len();
    if cancelled {
        return format!("stopped after {steps} steps");
    }
    format!("grown in {steps} steps and {:.1} s", grown.report.seconds)
}
