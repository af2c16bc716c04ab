//! Widgets that several panels share.

use egui::emath::Numeric;
use egui::{DragValue, ProgressBar, Ui};

use super::plots;
use crate::work::job::Progress;

/// The texts of a field.
#[derive(Clone, Copy)]
pub(crate) struct Labels {
    /// Name beside the field.
    pub name: &'static str,
    /// Unit after the number, with the space before it.
    pub unit: &'static str,
    /// Explanation, shown under the pointer.
    pub tip: &'static str,
}

/// A slider; true if the value changed.
pub(crate) fn slider<N: Numeric>(
    ui: &mut Ui,
    value: &mut N,
    range: std::ops::RangeInclusive<N>,
    labels: Labels,
) -> bool {
    let slider = egui::Slider::new(value, range).text(labels.name).suffix(labels.unit);
    ui.add(slider).on_hover_text(labels.tip).changed()
}

/// A number that changes by `speed` per point of a drag; true if it changed.
pub(crate) fn number(ui: &mut Ui, value: &mut f64, speed: f64, labels: Labels) -> bool {
    ui.horizontal(|ui| {
        let field =
            DragValue::new(value).speed(speed.max(1e-6)).suffix(labels.unit).max_decimals(6);
        let changed = ui.add(field).on_hover_text(labels.tip).changed();
        ui.label(labels.name).on_hover_text(labels.tip);
        changed
    })
    .inner
}

/// The progress of a job, and the plot of its convergence.
pub(crate) fn progress(ui: &mut Ui, progress: &Progress, busy: bool) {
    if busy {
        let residual = progress.steps.last().map_or(0.0, |s| s.residual.max(1.0).log10() as f32);
        let first = progress.steps.iter().map(|s| s.residual).fold(1.0, f64::max).log10() as f32;
        let share = progress.share.unwrap_or(0.0).max(0.02)
            + if first > 0.0 {
                0.4 * (1.0 - residual / first) * (1.0 - progress.share.unwrap_or(0.0))
            } else {
                0.0
            };
        ui.add(ProgressBar::new(share.clamp(0.0, 1.0)).text(progress.stage.clone()));
    }
    plots::convergence(ui, progress);
}
