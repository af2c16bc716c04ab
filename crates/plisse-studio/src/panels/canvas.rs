//! The picture: the row of views, the rendered frame, the pointer's work on it, and the legend.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use plisse_live::{Vec2, Vec3};

use crate::brush::{Canvas, Hit, trail};
use crate::document::{Action, Document, Layer};
use crate::messages::Messages;
use crate::tools::Tools;
use crate::view::{Legend, View};
use crate::viewport::{ShownSurface, Viewport};

/// Angle (rad) that a drag over the height of the picture turns.
const TURN: f32 = 3.5;
/// Colour of lines and texts over the picture.
const INK: Color32 = Color32::from_rgb(28, 34, 44);
/// Number of segments of the brush's rim.
const RIM: usize = 48;

/// Shows the row of views above the picture. `painted`: the layer whose paint can be seen, if any;
/// `others`: the surfaces that can be seen instead of the model.
pub(crate) fn views(
    ui: &mut Ui,
    viewport: &mut Viewport,
    painted: Option<Layer>,
    others: &[ShownSurface],
) {
    ui.add_space(3.0);
    ui.horizontal_wrapped(|ui| {
        ui.add_space(6.0);
        for (n, view) in View::MAIN.into_iter().enumerate() {
            let label = ui.selectable_label(viewport.view == view, view.name());
            if label.on_hover_text(format!("key {}", n + 1)).clicked() {
                viewport.view = view;
            }
        }
        if let Some(layer) = painted {
            let view = View::Painted(layer);
            let label = ui.selectable_label(viewport.view == view, "Paint");
            if label.on_hover_text("the paint on the brush's layer").clicked() {
                viewport.view = view;
            }
        }
        if !others.is_empty() {
            ui.separator();
            for surface in [ShownSurface::Live].iter().chain(others) {
                ui.selectable_value(&mut viewport.shown, *surface, surface.name());
            }
        }
    });
    ui.add_space(3.0);
}

/// The picture and what the pointer changes on it.
pub(crate) struct Picture<'a> {
    pub document: &'a mut Document,
    pub viewport: &'a mut Viewport,
    pub tools: &'a mut Tools,
    pub messages: &'a mut Messages,
    /// True if the pointer paints where it meets the surface.
    pub paints: bool,
}

impl Picture<'_> {
    /// Shows the picture.
    pub(crate) fn show(&mut self, ui: &mut Ui) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        let scale = ui.ctx().pixels_per_point();
        self.viewport.size = [(rect.width() * scale) as usize, (rect.height() * scale) as usize]
            .map(|s| s.clamp(8, 4096));
        show_frame(ui, self.viewport, rect);
        self.pointer(ui, &response, rect);
        let painter = ui.painter_at(rect);
        if let Some(frame) = &self.viewport.frame {
            for mark in &frame.marks {
                let ends = mark.ends.map(|e| {
                    pos2(rect.left() + e.x * rect.width(), rect.top() + e.y * rect.height())
                });
                let colour = INK.gamma_multiply(0.35 + 0.65 * mark.strength);
                painter.line_segment(ends, Stroke::new(1.4, colour));
            }
            if let Some(legend) = &frame.legend {
                show_legend(&painter, rect, legend);
            }
        }
        show_hint(&painter, rect, self.paints);
    }

    fn pointer(&mut self, ui: &Ui, response: &egui::Response, rect: Rect) {
        let at = |p: Pos2| {
            Vec2::new((p.x - rect.left()) / rect.width(), (p.y - rect.top()) / rect.height())
        };
        self.paint(ui, response, at);
        self.move_camera(ui, response, rect);
        if response.double_clicked() && !self.paints {
            self.viewport.fit(self.document);
        }
        if let (true, Some(p)) = (self.paints, response.hover_pos()) {
            self.rim(ui, rect, at(p));
        }
    }

    /// Paints with the primary button; `at` maps a position to shares of the picture.
    fn paint(&mut self, ui: &Ui, response: &egui::Response, at: impl Fn(Pos2) -> Vec2) {
        let primary = response.dragged_by(egui::PointerButton::Primary);
        let can_paint = self.paints && !ui.input(|i| i.modifiers.alt);
        if response.drag_started_by(egui::PointerButton::Primary) && can_paint {
            let press = ui.input(|i| i.pointer.press_origin()).unwrap_or(response.rect.center());
            if self.hit(at(press)).is_some() {
                self.viewport.playing = false;
                self.stroke(at(press));
            }
        }
        if let (Some(_), false, true, Some(p)) =
            (&self.tools.trail, self.tools.released, primary, response.interact_pointer_pos())
        {
            self.stroke(at(p));
        }
        if self.tools.trail.is_some() && response.drag_stopped() {
            self.tools.release_stroke();
        }
        let dabs = response.clicked() && can_paint && self.tools.trail.is_none();
        if let Some(p) =
            response.interact_pointer_pos().filter(|p| dabs && self.hit(at(*p)).is_some())
        {
            self.viewport.playing = false;
            self.stroke(at(p));
            self.end_stroke();
        }
    }

    fn move_camera(&mut self, ui: &Ui, response: &egui::Response, rect: Rect) {
        let (modifiers, scroll, pinch) =
            ui.input(|i| (i.modifiers, i.smooth_scroll_delta.y, i.zoom_delta()));
        let delta = response.drag_delta() / rect.height().max(1.0);
        let primary = response.dragged_by(egui::PointerButton::Primary);
        let secondary = response.dragged_by(egui::PointerButton::Secondary);
        let pans = response.dragged_by(egui::PointerButton::Middle)
            || (modifiers.shift && (primary || secondary));
        let viewport = &mut *self.viewport;
        viewport.moving = false;
        if self.tools.trail.is_none() && pans {
            viewport.orbit.pan(delta.x, delta.y);
            viewport.moving = true;
        } else if self.tools.trail.is_none() && (primary || secondary) {
            viewport.orbit.orbit(-TURN * delta.x, TURN * delta.y);
            viewport.moving = true;
        }
        if response.hovered() && (scroll != 0.0 || pinch != 1.0) {
            viewport.orbit.zoom((scroll / 240.0).exp() * pinch);
            viewport.moving = true;
        }
    }

    /// Begins a stroke, or continues the current one; a released one is ended first.
    pub(crate) fn stroke(&mut self, pointer: Vec2) {
        if self.tools.released {
            self.end_stroke();
        }
        let Some(frame) = &self.viewport.frame else { return };
        self.tools.stroke(&self.document.subject, frame, pointer);
        self.viewport.unsettle();
    }

    /// Paints waiting dabs of the stroke as far as a frame has time, and ends a released stroke
    /// once all are painted.
    pub(crate) fn paint_waiting(&mut self) {
        let subject = Arc::clone(&self.document.subject);
        if self.tools.trail.is_none() {
            return;
        }
        let posed = self.viewport.posed(&subject);
        if posed.positions.len() != subject.welded.count() {
            return;
        }
        if self.tools.paint(self.document, &posed) {
            self.viewport.unsettle();
        } else if self.tools.released {
            self.end_stroke();
        }
    }

    /// Ends the stroke, if there is one, and paints all of it.
    pub(crate) fn end_stroke(&mut self) {
        if self.tools.end_stroke(self.document, self.viewport.frame.as_ref(), self.messages) {
            self.viewport.unsettle();
        }
    }

    /// The point of the surface under a point of the picture.
    fn hit(&self, at: Vec2) -> Option<Hit> {
        let frame = self.viewport.frame.as_ref()?;
        let welded = &self.document.subject.welded;
        if frame.posed.positions.len() != welded.count() {
            return None;
        }
        let canvas = Canvas {
            welded,
            vertex_faces: &self.tools.vertex_faces,
            posed: &frame.posed.positions,
        };
        trail::hit(&canvas, &frame.camera, at)
    }

    /// Shows the brush's rim on the surface.
    fn rim(&self, ui: &Ui, rect: Rect, at: Vec2) {
        let (Some(hit), Some(frame)) = (self.hit(at), &self.viewport.frame) else { return };
        let [a, b, c] =
            self.document.subject.welded.faces[hit.face].map(|v| frame.posed.positions[v as usize]);
        let Some(n) = (b - a).cross(&(c - a)).try_normalize(1e-30) else { return };
        let other = if n.x.abs() < 0.7 { Vec3::x() } else { Vec3::y() };
        let Some(u) = n.cross(&other).try_normalize(1e-9) else { return };
        let (v, map) = (n.cross(&u), frame.camera.clip_from_world());
        let brush = &self.tools.brush;
        let place = |k: usize| {
            let (sin, cos) = (std::f32::consts::TAU * k as f32 / RIM as f32).sin_cos();
            let clip = map * (hit.position + (u * cos + v * sin) * brush.radius_m).push(1.0);
            let ndc = clip.xyz() / clip.w.max(1e-6);
            pos2(
                rect.left() + (0.5 + 0.5 * ndc.x) * rect.width(),
                rect.top() + (0.5 - 0.5 * ndc.y) * rect.height(),
            )
        };
        let points: Vec<Pos2> = (0..=RIM).map(place).collect();
        let painter = ui.painter_at(rect);
        let colour = if brush.action == Action::Erase {
            Color32::from_rgb(170, 40, 40)
        } else {
            Color32::from_rgb(24, 80, 160)
        };
        painter.line(points.clone(), Stroke::new(3.0, Color32::from_white_alpha(170)));
        painter.line(points, Stroke::new(1.5, colour));
    }
}

/// Shows the rendered frame, or a text before the first.
fn show_frame(ui: &Ui, viewport: &Viewport, rect: Rect) {
    let [r, g, b] = plisse_live::draw::BACKGROUND;
    ui.painter().rect_filled(rect, 0.0, Color32::from_rgb(r, g, b));
    let on_adapter = viewport.frame.as_ref().and_then(|frame| frame.texture);
    if let Some(texture) = on_adapter.or_else(|| viewport.picture.as_ref().map(|p| p.id())) {
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(texture, rect, whole, Color32::WHITE);
    } else {
        let font = FontId::proportional(16.0);
        ui.painter().text(rect.center(), Align2::CENTER_CENTER, "Rendering…", font, INK);
    }
}

/// Shows what the buttons of the pointer do, in the lower right corner.
fn show_hint(painter: &egui::Painter, rect: Rect, paints: bool) {
    let hint = if paints {
        "drag on the surface: paint   right drag: turn   middle drag: move   wheel: zoom"
    } else {
        "drag: turn   middle or shift drag: move   wheel: zoom   double click: fit"
    };
    let ink = INK.gamma_multiply(0.85);
    let text = painter.layout_no_wrap(hint.to_owned(), FontId::proportional(11.5), ink);
    let place =
        Align2::RIGHT_BOTTOM.anchor_size(rect.right_bottom() - vec2(10.0, 8.0), text.size());
    painter.rect_filled(place.expand2(vec2(6.0, 2.0)), 4.0, Color32::from_white_alpha(200));
    painter.galley(place.min, text, INK);
}

/// Shows the legend of the colours, in the lower left corner.
fn show_legend(painter: &egui::Painter, rect: Rect, legend: &Legend) {
    let size = vec2(240.0, 54.0);
    let frame = Rect::from_min_size(pos2(rect.left() + 12.0, rect.bottom() - size.y - 28.0), size);
    painter.rect_filled(frame, 5.0, Color32::from_white_alpha(225));
    painter.rect_stroke(frame, 5.0, Stroke::new(1.0, INK.gamma_multiply(0.35)), StrokeKind::Inside);
    let small = FontId::proportional(11.5);
    painter.text(
        frame.left_top() + vec2(10.0, 6.0),
        Align2::LEFT_TOP,
        &legend.title,
        FontId::proportional(12.5),
        INK,
    );
    let bar = Rect::from_min_max(
        frame.left_top() + vec2(10.0, 24.0),
        frame.right_top() + vec2(-10.0, 33.0),
    );
    let parts = 60;
    for k in 0..parts {
        let (from, to) = (k as f32 / parts as f32, (k + 1) as f32 / parts as f32);
        let [r, g, b] = legend.colours.at(0.5 * (from + to));
        let piece = Rect::from_min_max(
            pos2(bar.left() + from * bar.width(), bar.top()),
            pos2((bar.left() + to * bar.width() + 0.5).min(bar.right()), bar.bottom()),
        );
        painter.rect_filled(piece, 0.0, Color32::from_rgb(r, g, b));
    }
    for (k, align) in
        [Align2::LEFT_TOP, Align2::CENTER_TOP, Align2::RIGHT_TOP].into_iter().enumerate()
    {
        let x = bar.left() + bar.width() * 0.5 * k as f32;
        painter.text(pos2(x, bar.bottom() + 3.0), align, &legend.ticks[k], small.clone(), INK);
    }
}
