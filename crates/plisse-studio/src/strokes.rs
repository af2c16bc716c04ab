//! Strokes of the brush in the window: they follow the pointer at once and are painted as far as a
//! frame has time for it.

use std::sync::Arc;
use std::time::Duration;

use plisse_live::Vec2;
use plisse_live::skin::Skinned;
use web_time::Instant;

use crate::brush::{Canvas, Trail};
use crate::studio::{SETTLE, Studio};

/// How long dabs are painted in one frame; the last one may end later.
const PAINTING: Duration = Duration::from_millis(5);

impl Studio {
    /// Where unified vertices are seen; the rest pose before the first picture.
    pub fn posed(&self) -> Arc<Skinned> {
        match &self.sheet {
            Some(sheet) => Arc::clone(&sheet.posed),
            None => {
                let v = &self.document.subject.unified.vertices;
                Arc::new(Skinned { positions: v.positions.clone(), normals: v.normals.clone() })
            }
        }
    }

    /// Begins a stroke, or goes on with the one on its way; `pointer` is a share of the picture.
    pub fn stroke(&mut self, pointer: Vec2) {
        if self.released {
            self.end_stroke();
        }
        let Some(camera) = self.sheet.as_ref().map(|s| s.camera) else { return };
        let (subject, surface, posed) =
            (Arc::clone(&self.document.subject), Arc::clone(&self.surface), self.posed());
        if posed.positions.len() != subject.unified.count() {
            return;
        }
        let canvas =
            Canvas { unified: &subject.unified, surface: &surface, posed: &posed.positions };
        match &mut self.trail {
            Some(trail) => trail.go(&canvas, &camera, pointer),
            None => self.trail = Some(Trail::begin(self.brush.clone(), &canvas, &camera, pointer)),
        }
        self.settle = SETTLE;
    }

    /// The pointer lets go: the stroke ends once it is painted, which may take some frames.
    pub fn release_stroke(&mut self) {
        self.released = self.trail.is_some();
    }

    /// Paints what waits of the stroke on its way, as far as a frame has time.
    pub(crate) fn paint(&mut self) {
        if self.trail.is_none() {
            return;
        }
        let (subject, surface, posed) =
            (Arc::clone(&self.document.subject), Arc::clone(&self.surface), self.posed());
        let canvas =
            Canvas { unified: &subject.unified, surface: &surface, posed: &posed.positions };
        let begun = Instant::now();
        let Some(trail) =
            self.trail.as_mut().filter(|_| posed.positions.len() == subject.unified.count())
        else {
            return;
        };
        if trail.is_behind() {
            trail.paint(&canvas, &mut self.document.layers, &mut || begun.elapsed() < PAINTING);
            self.cached.dabs += 1;
            self.settle = SETTLE;
        } else if self.released {
            self.end_stroke();
        }
    }

    /// Ends the stroke on its way, if there is one, at once.
    pub fn end_stroke(&mut self) {
        self.released = false;
        let Some(trail) = self.trail.take() else { return };
        let Some(camera) = self.sheet.as_ref().map(|s| s.camera) else { return };
        let (subject, surface, posed) =
            (Arc::clone(&self.document.subject), Arc::clone(&self.surface), self.posed());
        let canvas =
            Canvas { unified: &subject.unified, surface: &surface, posed: &posed.positions };
        let change = trail.end(&canvas, &mut self.document.layers, &camera);
        if change.vertices.is_empty() {
            self.messages.note("the stroke met no vertex; make the brush larger");
        }
        self.document.push(change);
        self.cached.dabs += 1;
        self.settle = SETTLE;
    }
}
