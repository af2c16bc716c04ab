//! Plots: bars of milliseconds, and energy and residual over iterations.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};

use crate::work::job::Progress;

const BLUE: Color32 = Color32::from_rgb(46, 104, 178);
const RED: Color32 = Color32::from_rgb(186, 66, 52);

/// A bar for each stage.
pub fn stages(ui: &mut Ui, ms: &[f32; 5]) {
    let names = ["skin", "crush", "relax", "gather", "render"];
    let most = ms.iter().copied().fold(1e-3, f32::max);
    for (name, ms) in names.iter().zip(ms) {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(46.0, 14.0), Sense::hover());
            let colour = ui.visuals().text_color();
            ui.painter().text(
                rect.left_center(),
                Align2::LEFT_CENTER,
                name,
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

/// Energy (blue) and residual over its tolerance (red, logarithmic) of all steps, stage after stage.
pub fn convergence(ui: &mut Ui, progress: &Progress) {
    let steps = &progress.steps;
    if steps.len() < 2 {
        return;
    }
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width().min(290.0), 120.0), Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let inner = rect.shrink2(vec2(8.0, 18.0));
    let x = |k: usize| inner.left() + inner.width() * k as f32 / (steps.len() - 1) as f32;
    let residuals: Vec<f64> = steps.iter().map(|s| s.residual.max(1e-3).log10()).collect();
    let (low, high) = range(&residuals);
    let residual_line: Vec<Pos2> =
        residuals.iter().enumerate().map(|(k, r)| pos2(x(k), y(inner, *r, low, high))).collect();
    painter.line(residual_line, Stroke::new(1.5, RED));
    // Energies of different stages have nothing to do with each other: each has its own range.
    let mut begin = 0;
    while begin < steps.len() {
        let end = (begin..steps.len())
            .find(|&k| steps[k].stage != steps[begin].stage)
            .unwrap_or(steps.len());
        let energies: Vec<f64> = steps[begin..end].iter().map(|s| s.energy_joule).collect();
        let (low, high) = range(&energies);
        let line: Vec<Pos2> = energies
            .iter()
            .enumerate()
            .map(|(k, e)| pos2(x(begin + k), y(inner, *e, low, high)))
            .collect();
        if line.len() > 1 {
            painter.line(line, Stroke::new(1.5, BLUE));
        }
        if end < steps.len() {
            painter.vline(
                x(end),
                inner.y_range(),
                Stroke::new(1.0, ui.visuals().weak_text_color()),
            );
        }
        begin = end;
    }
    let font = FontId::proportional(11.0);
    painter.text(rect.left_top() + vec2(6.0, 3.0), Align2::LEFT_TOP, "energy", font.clone(), BLUE);
    painter.text(
        rect.right_top() + vec2(-6.0, 3.0),
        Align2::RIGHT_TOP,
        "residual / tolerance (log)",
        font.clone(),
        RED,
    );
    let weak = ui.visuals().text_color();
    painter.text(
        rect.right_bottom() + vec2(-6.0, -3.0),
        Align2::RIGHT_BOTTOM,
        format!("{} iterations", steps.len()),
        font,
        weak,
    );
    if let Some(last) = steps.last() {
        response.on_hover_text(format!(
            "{}: energy {:.6e} J, residual {:.1e} times the tolerance",
            last.stage, last.energy_joule, last.residual
        ));
    }
}

fn range(values: &[f64]) -> (f64, f64) {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max))
}

fn y(inner: Rect, value: f64, low: f64, high: f64) -> f32 {
    let share = if high > low { ((value - low) / (high - low)) as f32 } else { 0.5 };
    inner.bottom() - inner.height() * if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 }
}
