//! The Paint tab: the layers and the brush.

use egui::{ComboBox, Slider, Ui};

use super::widgets::{Labels, slider};
use crate::commands::Command;
use crate::document::{Action, Brush, Document, Falloff, Heading, Layer, Mirror};
use crate::view::View;

/// Shows the tab; the commands that were chosen.
pub(crate) fn panel(
    ui: &mut Ui,
    document: &Document,
    brush: &mut Brush,
    view: &mut View,
) -> Vec<Command> {
    let mut commands = Vec::new();
    ui.heading("Layer");
    let mut layer = brush.layer;
    for choice in Layer::ALL {
        let painted = if document.layers.is_painted(choice) { " (painted)" } else { "" };
        ui.radio_value(&mut layer, choice, format!("{}{painted}", choice.name()))
            .on_hover_text(tip(choice));
    }
    if layer != brush.layer {
        commands.push(Command::ChooseLayer(layer));
    }
    ui.add_space(6.0);
    commands.extend(brush_controls(ui, document, brush, view));
    commands
}

/// Shows the controls of the brush; the commands that were chosen.
pub(crate) fn brush_controls(
    ui: &mut Ui,
    document: &Document,
    brush: &mut Brush,
    view: &mut View,
) -> Vec<Command> {
    let layer = brush.layer;
    ui.heading("Brush");
    ui.horizontal(|ui| {
        ui.selectable_value(&mut brush.action, Action::Paint, "Paint");
        ui.selectable_value(&mut brush.action, Action::Erase, "Erase")
            .on_hover_text("E: back to the unpainted value");
    });
    sizes(ui, brush, document.subject.size_m());
    falloff(ui, &mut brush.falloff);
    if layer.is_directed() {
        direction(ui, brush);
    }
    mirror(ui, &mut brush.mirror);
    ui.add_space(6.0);
    let commands = history(ui, document);
    let painted = if layer == Layer::Expansion { View::Expansion } else { View::Painted(layer) };
    let mut shown = *view == painted;
    if ui.checkbox(&mut shown, "Show what is painted").changed() {
        *view = if shown { painted } else { View::Wrinkled };
    }
    commands
}

fn sizes(ui: &mut Ui, brush: &mut Brush, size_m: f32) {
    let radius = Slider::new(&mut brush.radius_m, 0.005 * size_m..=0.5 * size_m)
        .logarithmic(true)
        .text("radius")
        .suffix(" m");
    ui.add(radius).on_hover_text("radius along the surface (m); keys [ and ]");
    let labels = Labels {
        name: "strength",
        unit: "",
        tip: "share of the way to the value that one stroke goes at its middle",
    };
    slider(ui, &mut brush.strength, 0.05..=1.0, labels);
    let layer = brush.layer;
    let range = layer.range();
    let high = if layer == Layer::Coherence { size_m } else { range.high };
    let name = match layer {
        Layer::Wrinkles => "amount",
        Layer::Wavelength => "share of the wavelength",
        Layer::Expansion => "growth",
        Layer::Coherence => "length",
        Layer::Freeze => "frozen",
    };
    let labels = Labels { name, unit: range.unit, tip: tip(layer) };
    slider(ui, &mut brush.value, range.low..=high, labels);
}

fn falloff(ui: &mut Ui, falloff: &mut Falloff) {
    ComboBox::from_label("falloff").selected_text(falloff_name(*falloff)).show_ui(ui, |ui| {
        for choice in [Falloff::Smooth, Falloff::Linear, Falloff::Hard] {
            ui.selectable_value(falloff, choice, falloff_name(choice));
        }
    });
}

fn direction(ui: &mut Ui, brush: &mut Brush) {
    let layer = brush.layer;
    let mut headings = vec![Heading::AlongStroke, Heading::AcrossStroke, Heading::Screen];
    if layer == Layer::Expansion {
        headings.push(Heading::Isotropic);
    } else if brush.heading == Heading::Isotropic {
        brush.heading = Heading::AlongStroke;
    }
    ComboBox::from_label("direction")
        .selected_text(heading_name(layer, brush.heading))
        .width(190.0)
        .show_ui(ui, |ui| {
            for heading in headings {
                ui.selectable_value(&mut brush.heading, heading, heading_name(layer, heading));
            }
        });
    if brush.heading == Heading::Screen {
        let mut degrees = brush.screen_angle_rad.to_degrees();
        let labels = Labels {
            name: "angle",
            unit: "°",
            tip: "angle from the picture's right, upwards (degrees)",
        };
        if slider(ui, &mut degrees, -90.0..=90.0, labels) {
            brush.screen_angle_rad = degrees.to_radians();
        }
    }
}

fn mirror(ui: &mut Ui, mirror: &mut Mirror) {
    ComboBox::from_label("mirror").selected_text(mirror_name(*mirror)).show_ui(ui, |ui| {
        for choice in [Mirror::Off, Mirror::X, Mirror::Y, Mirror::Z] {
            ui.selectable_value(mirror, choice, mirror_name(choice));
        }
    });
}

fn history(ui: &mut Ui, document: &Document) -> Vec<Command> {
    let strokes = document.history.done().len();
    let buttons = [
        ("Undo", Command::Undo, strokes > 0),
        ("Redo", Command::Redo, document.history.undone() > 0),
    ];
    let mut commands = Vec::new();
    ui.horizontal(|ui| {
        for (name, command, enabled) in buttons {
            let mut button = ui.add_enabled(enabled, egui::Button::new(name));
            if let Some(keys) = command.shortcut() {
                button = button.on_hover_text(ui.ctx().format_shortcut(&keys));
            }
            if button.clicked() {
                commands.push(command);
            }
        }
        ui.label(format!("{strokes} stroke{}", if strokes == 1 { "" } else { "s" }));
    });
    commands
}

fn tip(layer: Layer) -> &'static str {
    match layer {
        Layer::Wrinkles => {
            "wrinkles in the rest pose; the surface counts as shorter by the square of the amount"
        }
        Layer::Wavelength => "share of the wavelength, 0.05 to 1",
        Layer::Expansion => "growth of the surface; 1 makes it twice as long",
        Layer::Coherence => "length over which the crests of folds run straight (m)",
        Layer::Freeze => "from 0.5 on, the surface does not move when it grows",
    }
}

fn falloff_name(falloff: Falloff) -> &'static str {
    match falloff {
        Falloff::Smooth => "smooth",
        Falloff::Linear => "linear",
        Falloff::Hard => "hard",
    }
}

fn heading_name(layer: Layer, heading: Heading) -> &'static str {
    match (layer, heading) {
        (Layer::Expansion, Heading::AlongStroke) => "grows along the stroke",
        (Layer::Expansion, Heading::AcrossStroke) => "grows across the stroke",
        (Layer::Expansion, Heading::Screen) => "grows along the screen",
        (_, Heading::Isotropic) => "grows in all directions",
        (_, Heading::AlongStroke) => "folds along the stroke",
        (_, Heading::AcrossStroke) => "folds across the stroke",
        (_, Heading::Screen) => "folds along the screen",
    }
}

fn mirror_name(mirror: Mirror) -> &'static str {
    match mirror {
        Mirror::Off => "off",
        Mirror::X => "x (left and right)",
        Mirror::Y => "y (up and down)",
        Mirror::Z => "z (front and back)",
    }
}
