//! Plots: bars of milliseconds, and energy and residual over iterations.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};
use plisse_live::stage::PerStage;

use crate::work::job::{Progress, SolverStep};

const BLUE: Color32 = Color32::from_rgb(46, 104, 178);
const RED: Color32 = Color32::from_rgb(186, 66, 52);

/// A bar for each stage.
pub fn stages(ui: &mut Ui, ms: &PerStage<f32>) {
    let most = ms.values().iter().copied().fold(1e-3, f32::max);
    for (stage, ms) in ms.iter() {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(46.0, 14.0), Sense::hover());
            let colour = ui.visuals().text_color();
            ui.painter().text(
                rect.left_center(),
                Align2::LEFT_CENTER,
                stage.name(),
                FontId::proportional(12.0),
                colour,
            );
            let (rect, _) = ui.allocate_exact_size(vec2(150.0, 10.0), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
            let bar = Rect::from_min_size(
                rect.min,
                vec2(rect.width() * (ms / most).clamp(0.0, 1.0), rect.height()),
            );
            ui.painter().rect_filled(bar, 2.0, BLUE);
            ui.label(format!("{ms:.2} ms"));
        });
    }
}

/// Energy (blue) and residual over its tolerance (red, logarithmic) of all steps, stage after
/// stage.
pub fn convergence(ui: &mut Ui, progress: &Progress) {
    let steps = &progress.steps;
    let (Some(last), 2..) = (steps.last(), steps.len()) else { return };
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width().min(290.0), 120.0), Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    curves(ui, &painter, rect.shrink2(vec2(8.0, 18.0)), steps);
    let label = |pos: Pos2, align: Align2, text: String, colour: Color32| {
        painter.text(pos, align, text, FontId::proportional(11.0), colour);
    };
    let (left, right) = (rect.left_top() + vec2(6.0, 3.0), rect.right_top() + vec2(-6.0, 3.0));
    label(left, Align2::LEFT_TOP, "energy".into(), BLUE);
    label(right, Align2::RIGHT_TOP, "residual / tolerance (log)".into(), RED);
    let count = format!("{} iterations", steps.len());
    let corner = rect.right_bottom() + vec2(-6.0, -3.0);
    label(corner, Align2::RIGHT_BOTTOM, count, ui.visuals().text_color());
    response.on_hover_text(format!(
        "{}: energy {:.6e} J, residual {:.1e} times the tolerance",
        last.stage, last.energy_joule, last.residual
    ));
}

/// The curves of two or more steps in the rectangle `inner`.
fn curves(ui: &Ui, painter: &Painter, inner: Rect, steps: &[SolverStep]) {
    let x = |k: usize| inner.left() + inner.width() * k as f32 / (steps.len() - 1) as f32;
    let curve = |begin: usize, values: &[f64], colour: Color32| {
        let (low, high) = range(values);
        let at = |(k, value): (usize, &f64)| pos2(x(begin + k), y(inner, *value, low, high));
        let points: Vec<Pos2> = values.iter().enumerate().map(at).collect();
        if points.len() > 1 {
            painter.line(points, Stroke::new(1.5, colour));
        }
    };
    let residuals: Vec<f64> = steps.iter().map(|s| s.residual.max(1e-3).log10()).collect();
    curve(0, &residuals, RED);
    // Energies of different stages cannot be compared: each stage has a range of its own.
    let mut begin = 0;
    for stage in steps.chunk_by(|a, b| a.stage == b.stage) {
        let energies: Vec<f64> = stage.iter().map(|s| s.energy_joule).collect();
        curve(begin, &energies, BLUE);
        begin += stage.len();
        if begin < steps.len() {
            let stroke = Stroke::new(1.0, ui.visuals().weak_text_color());
            painter.vline(x(begin), inner.y_range(), stroke);
        }
    }
}

/// Least and largest of the finite values.
fn range(values: &[f64]) -> (f64, f64) {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max))
}

/// Height of `value` in the rectangle `inner`.
fn y(inner: Rect, value: f64, low: f64, high: f64) -> f32 {
    let share = if high > low { ((value - low) / (high - low)) as f32 } else { 0.5 };
    inner.bottom() - inner.height() * if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 }
}
