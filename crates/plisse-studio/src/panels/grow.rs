//! The Grow tab: growth of the whole surface, or under the brush.

use egui::{Button, Ui};

use super::paint::brush_controls;
use super::widgets::{Labels, progress, slider};
use crate::commands::Command;
use crate::document::{Brush, Document, Layer};
use crate::jobs::growth::Growth;
use crate::view::View;

/// Shows the tab; the commands that were chosen.
pub(crate) fn panel(
    ui: &mut Ui,
    document: &mut Document,
    growth: &Growth,
    brush: &mut Brush,
    view: &mut View,
) -> Vec<Command> {
    let painted = document.layers.is_painted(Layer::Expansion);
    let in_scene = document.subject.scene.as_ref().is_some_and(|s| s.scene.growth.is_some());
    ui.label(match (painted, in_scene) {
        (true, _) => {
            "The surface grows by the painted Expansion. Wavelength, Coherence and Freeze shape \
             the folds."
        }
        (false, true) => {
            "The surface grows as the scene says. Paint Expansion to use that instead."
        }
        (false, false) => "Paint Expansion first: it sets the amount and the direction of growth.",
    });
    ui.add_space(4.0);
    if painted || !in_scene {
        widths(ui, document);
    }
    let mut follows = growth.follows();
    let mut commands = Vec::new();
    let tip = "the surface grows while you paint, and its surroundings follow";
    if ui.checkbox(&mut follows, "fold under the brush").on_hover_text(tip).changed() {
        commands.push(Command::FoldUnderBrush(follows));
    }
    if follows {
        ui.label("Drag on the surface: it grows under the brush.");
        commands.extend(brush_controls(ui, document, brush, view));
        ui.label(format!("the last dabs took {:.0} ms", growth.fold_ms()));
        return commands;
    }
    let busy = growth.is_busy();
    let name = if busy { "Stop" } else { "Grow the whole" };
    if ui.add_enabled(busy || painted || in_scene, Button::new(name)).clicked() {
        commands.push(Command::Grow);
    }
    progress(ui, growth.progress(), busy);
    result(ui, growth);
    commands
}

fn widths(ui: &mut Ui, document: &mut Document) {
    let size_m = f64::from(document.subject.size_m());
    let settings = &mut document.settings;
    let (low, high) = (0.005 * size_m, 0.5 * size_m);
    let labels = Labels {
        name: "spacing",
        unit: " m",
        tip: "distance between folds, along the surface before growth (m)",
    };
    slider(ui, &mut settings.fold_spacing_m, low..=high, labels);
    let labels = Labels {
        name: "coherence",
        unit: " m",
        tip: "length over which crests run straight where none is painted (m)",
    };
    slider(ui, &mut settings.coherence_m, 0.0..=size_m, labels);
}

fn result(ui: &mut Ui, growth: &Growth) {
    let Some(grown) = &growth.grown else { return };
    let report = &grown.report;
    let iterations: usize = report.steps.iter().map(|s| s.iterations).sum();
    ui.label(format!(
        "{} steps, {iterations} iterations, {:.1} s",
        report.steps.len(),
        report.seconds
    ));
    if let Some(last) = report.steps.last() {
        ui.label(format!("residual {:.1e}, energy {:.4e} J", last.residual, last.energy_joule));
    }
}
