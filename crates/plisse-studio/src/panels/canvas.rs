//! The picture: what is shown, the pointer's work on it, and what colours mean.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use plisse_live::{Vec2, Vec3};

use crate::brush::{Canvas, trail};
use crate::document::{Action, Layer};
use crate::studio::{Looking, Studio, Tab};
use crate::view::{Legend, View};

/// Angle (rad) that a drag over the height of the picture turns.
const TURN: f32 = 3.5;
const INK: Color32 = Color32::from_rgb(28, 34, 44);

impl Studio {
    /// The picture and its controls.
    pub(crate) fn canvas(&mut self, ui: &mut Ui) {
        self.views(ui);
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        let scale = ui.ctx().pixels_per_point();
        self.size = [(rect.width() * scale) as usize, (rect.height() * scale) as usize]
            .map(|s| s.clamp(8, 4096));
        let [r, g, b] = plisse_live::draw::BACKGROUND;
        ui.painter().rect_filled(rect, 0.0, Color32::from_rgb(r, g, b));
        let texture = self
            .sheet
            .as_ref()
            .and_then(|s| s.texture)
            .or_else(|| self.picture.as_ref().map(|p| p.id()));
        if let Some(texture) = texture {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture, rect, whole, Color32::WHITE);
        } else {
            ui.painter().text(
                rect.center(),
                Align2::CENTER_CENTER,
                "The first picture is on its way",
                FontId::proportional(16.0),
                INK,
            );
        }
        self.pointer(ui, &response, rect);
        let painter = ui.painter_at(rect);
        if let Some(sheet) = &self.sheet {
            for mark in &sheet.marks {
                let ends = mark.ends.map(|e| {
                    pos2(rect.left() + e.x * rect.width(), rect.top() + e.y * rect.height())
                });
                let colour = INK.gamma_multiply(0.35 + 0.65 * mark.strength);
                painter.line_segment(ends, Stroke::new(1.4, colour));
            }
            if let Some(legend) = &sheet.legend {
                show_legend(&painter, rect, legend);
            }
        }
        let hint = match self.paints() {
            true => {
                "drag on the surface: paint   right drag: turn   middle drag: move   wheel: nearer"
            }
            false => "drag: turn   middle or shift drag: move   wheel: nearer   double click: fit",
        };
        let text = painter.layout_no_wrap(
            hint.to_owned(),
            FontId::proportional(11.5),
            INK.gamma_multiply(0.85),
        );
        let place =
            Align2::RIGHT_BOTTOM.anchor_size(rect.right_bottom() - vec2(10.0, 8.0), text.size());
        painter.rect_filled(place.expand2(vec2(6.0, 2.0)), 4.0, Color32::from_white_alpha(200));
        painter.galley(place.min, text, INK);
    }

    /// The row of views above the picture.
    fn views(&mut self, ui: &mut Ui) {
        ui.add_space(3.0);
        ui.horizontal_wrapped(|ui| {
            ui.add_space(6.0);
            for (n, view) in View::MAIN.into_iter().enumerate() {
                let tip = format!("key {}", n + 1);
                if ui.selectable_label(self.view == view, view.name()).on_hover_text(tip).clicked()
                {
                    self.view = view;
                }
            }
            let painted = View::Painted(self.brush.layer);
            if self.tab == Tab::Paint && self.brush.layer != Layer::Expansion {
                let tip = "how much of the brush's layer is painted";
                if ui.selectable_label(self.view == painted, "Paint").on_hover_text(tip).clicked() {
                    self.view = painted;
                }
            }
            let others = [
                (Looking::Solved, "Solved", self.physics.solid().is_some()),
                (Looking::Grown, "Grown", self.growth.solid().is_some()),
            ];
            if others.iter().any(|o| o.2) {
                ui.separator();
                ui.selectable_value(&mut self.looking, Looking::Live, "Model");
                for (looking, name, there) in others {
                    if there {
                        ui.selectable_value(&mut self.looking, looking, name);
                    }
                }
            }
        });
        ui.add_space(3.0);
    }

    /// Whether the pointer paints where it meets the surface.
    fn paints(&self) -> bool {
        self.tab == Tab::Paint || self.tab == Tab::Grow && self.growth.follows()
    }

    fn pointer(&mut self, ui: &Ui, response: &egui::Response, rect: Rect) {
        let at = |p: Pos2| {
            Vec2::new((p.x - rect.left()) / rect.width(), (p.y - rect.top()) / rect.height())
        };
        let (modifiers, scroll, pinch) =
            ui.input(|i| (i.modifiers, i.smooth_scroll_delta.y, i.zoom_delta()));
        let delta = response.drag_delta() / rect.height().max(1.0);
        let primary = response.dragged_by(egui::PointerButton::Primary);
        let can_paint = self.paints() && !modifiers.alt;
        if response.drag_started_by(egui::PointerButton::Primary) && can_paint {
            let press = ui.input(|i| i.pointer.press_origin()).unwrap_or(rect.center());
            if self.hit(at(press)).is_some() {
                self.playing = false;
                self.stroke(at(press));
            }
        }
        if let (Some(_), false, true, Some(p)) =
            (&self.trail, self.released, primary, response.interact_pointer_pos())
        {
            self.stroke(at(p));
        }
        if self.trail.is_some() && response.drag_stopped() {
            self.release_stroke();
        }
        let dabs = response.clicked() && can_paint && self.trail.is_none();
        if let Some(p) =
            response.interact_pointer_pos().filter(|p| dabs && self.hit(at(*p)).is_some())
        {
            self.playing = false;
            self.stroke(at(p));
            self.end_stroke();
        }
        let pans = response.dragged_by(egui::PointerButton::Middle)
            || (modifiers.shift
                && (primary || response.dragged_by(egui::PointerButton::Secondary)));
        let turns = response.dragged_by(egui::PointerButton::Secondary) || primary;
        self.moving = false;
        if self.trail.is_none() && pans {
            self.table.pan(delta.x, delta.y);
            self.moving = true;
        } else if self.trail.is_none() && turns {
            self.table.orbit(-TURN * delta.x, TURN * delta.y);
            self.moving = true;
        }
        if response.hovered() && (scroll != 0.0 || pinch != 1.0) {
            self.table.zoom((scroll / 240.0).exp() * pinch);
            self.moving = true;
        }
        if response.double_clicked() && !self.paints() {
            self.fit();
        }
        if let (true, Some(p)) = (self.paints(), response.hover_pos()) {
            self.ring(ui, rect, at(p));
        }
    }

    /// Where the surface is under a point of the picture.
    pub(crate) fn hit(&self, at: Vec2) -> Option<crate::brush::Hit> {
        let sheet = self.sheet.as_ref()?;
        let unified = &self.document.subject.unified;
        if sheet.posed.positions.len() != unified.count() {
            return None;
        }
        let canvas = Canvas { unified, surface: &self.surface, posed: &sheet.posed.positions };
        trail::meet(&canvas, &sheet.camera, at)
    }

    /// The brush's rim on the surface.
    fn ring(&self, ui: &Ui, rect: Rect, at: Vec2) {
        let (Some(hit), Some(sheet)) = (self.hit(at), &self.sheet) else { return };
        let [a, b, c] = self.document.subject.unified.faces[hit.face]
            .map(|v| sheet.posed.positions[v as usize]);
        let Some(n) = (b - a).cross(&(c - a)).try_normalize(1e-30) else { return };
        let other = if n.x.abs() < 0.7 { Vec3::x() } else { Vec3::y() };
        let Some(u) = n.cross(&other).try_normalize(1e-9) else { return };
        let (v, map) = (n.cross(&u), sheet.camera.clip_from_world());
        let place = |k: usize| {
            let (sin, cos) = (std::f32::consts::TAU * k as f32 / 48.0).sin_cos();
            let clip = map * (hit.position + (u * cos + v * sin) * self.brush.radius_m).push(1.0);
            let ndc = clip.xyz() / clip.w.max(1e-6);
            pos2(
                rect.left() + (0.5 + 0.5 * ndc.x) * rect.width(),
                rect.top() + (0.5 - 0.5 * ndc.y) * rect.height(),
            )
        };
        let points: Vec<Pos2> = (0..=48).map(place).collect();
        let painter = ui.painter_at(rect);
        let colour = if self.brush.action == Action::Erase {
            Color32::from_rgb(170, 40, 40)
        } else {
            Color32::from_rgb(24, 80, 160)
        };
        painter.line(points.clone(), Stroke::new(3.0, Color32::from_white_alpha(170)));
        painter.line(points, Stroke::new(1.5, colour));
    }
}

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
