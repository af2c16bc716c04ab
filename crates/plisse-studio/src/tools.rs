//! The brush and the stroke under it. A stroke follows the pointer at once, and is painted as far
//! as each frame has time for it.

use std::sync::Arc;
use std::time::Duration;

use plisse_live::Vec2;
use plisse_live::skin::PosedVertices;
use web_time::Instant;

use crate::brush::{Canvas, Trail, VertexFaces};
use crate::document::{Brush, Document, Layer, Subject};
use crate::messages::Messages;
use crate::view::RenderedFrame;

/// Time for painting dabs in one frame; the last dab may end later.
const PAINTING: Duration = Duration::from_millis(5);

/// The brush, and the stroke that is being painted.
pub struct Tools {
    /// The brush.
    pub brush: Brush,
    /// The stroke that is being painted.
    pub trail: Option<Trail>,
    /// True once the pointer has released the stroke: it ends when all of it is painted.
    pub(crate) released: bool,
    /// Number of times that a stroke has changed the layers.
    pub(crate) dabs: u64,
    /// The faces around each vertex of the subject's mesh.
    pub(crate) vertex_faces: Arc<VertexFaces>,
}

impl Tools {
    /// A brush for `subject`, before the first stroke.
    pub fn new(subject: &Subject) -> Self {
        Self {
            brush: Brush::new(0.1),
            trail: None,
            released: false,
            dabs: 0,
            vertex_faces: Arc::new(vertex_faces(subject)),
        }
    }

    /// Fits the brush to a new `subject`; the layer stays.
    pub(crate) fn reset(&mut self, subject: &Subject, spacing_m: f64) {
        let layer = self.brush.layer;
        self.vertex_faces = Arc::new(vertex_faces(subject));
        self.brush = Brush { radius_m: 0.12 * subject.size_m(), ..Brush::new(0.1) };
        self.choose_layer(layer, spacing_m);
        (self.trail, self.released) = (None, false);
    }

    /// Chooses the layer that the brush paints on, with a suitable value; `spacing_m` is the
    /// document's fold spacing.
    pub(crate) fn choose_layer(&mut self, layer: Layer, spacing_m: f64) {
        let value = match layer {
            Layer::Wrinkles => 0.7,
            Layer::Wavelength => 0.4,
            Layer::Expansion => 0.5,
            Layer::Coherence => 3.0 * spacing_m as f32,
            Layer::Freeze => 1.0,
        };
        self.brush = Brush { layer, value, ..self.brush.clone() };
    }

    /// Begins a stroke, or continues the current one, at `pointer` (shares of the picture's width
    /// and height).
    pub(crate) fn stroke(&mut self, subject: &Subject, frame: &RenderedFrame, pointer: Vec2) {
        if frame.posed.positions.len() != subject.welded.count() {
            return;
        }
        let vertex_faces = Arc::clone(&self.vertex_faces);
        let canvas = canvas(subject, &vertex_faces, &frame.posed);
        match &mut self.trail {
            Some(trail) => trail.extend(&canvas, &frame.camera, pointer),
            None => {
                let trail = Trail::begin(self.brush.clone(), &canvas, &frame.camera, pointer);
                self.trail = Some(trail);
            }
        }
    }

    /// Notes that the pointer released the stroke; it ends once it is painted, which may take some
    /// frames.
    pub(crate) fn release_stroke(&mut self) {
        self.released = self.trail.is_some();
    }

    /// Paints waiting dabs of the stroke as far as a frame has time; true if there were any.
    pub(crate) fn paint(&mut self, document: &mut Document, posed: &PosedVertices) -> bool {
        let subject = Arc::clone(&document.subject);
        let vertex_faces = Arc::clone(&self.vertex_faces);
        let canvas = canvas(&subject, &vertex_faces, posed);
        let begun = Instant::now();
        let Some(trail) = self.trail.as_mut().filter(|trail| trail.is_behind()) else {
            return false;
        };
        trail.paint(&canvas, &mut document.layers, &mut || begun.elapsed() < PAINTING);
        self.dabs += 1;
        true
    }

    /// Ends the stroke, if there is one, and paints all of it; true if there was one.
    pub(crate) fn end_stroke(
        &mut self,
        document: &mut Document,
        frame: Option<&RenderedFrame>,
        messages: &mut Messages,
    ) -> bool {
        self.released = false;
        let (Some(trail), Some(frame)) = (self.trail.take(), frame) else { return false };
        let subject = Arc::clone(&document.subject);
        let canvas = canvas(&subject, &self.vertex_faces, &frame.posed);
        let change = trail.end(&canvas, &mut document.layers, &frame.camera);
        if change.vertices.is_empty() {
            messages.note("the stroke met no vertex; make the brush larger");
        }
        document.push(change);
        self.dabs += 1;
        true
    }
}

fn vertex_faces(subject: &Subject) -> VertexFaces {
    VertexFaces::new(&subject.welded.faces, subject.welded.count())
}

fn canvas<'a>(
    subject: &'a Subject,
    vertex_faces: &'a VertexFaces,
    posed: &'a PosedVertices,
) -> Canvas<'a> {
    Canvas { welded: &subject.welded, vertex_faces, posed: &posed.positions }
}
