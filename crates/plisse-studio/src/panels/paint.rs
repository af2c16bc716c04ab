//! Paint: the brush.

use egui::{ComboBox, Slider, Ui};

use super::slider;
use crate::commands::Command;
use crate::document::{Action, Falloff, Heading, Layer, Mirror};
use crate::studio::Studio;
use crate::view::View;

impl Studio {
    pub(crate) fn paint_panel(&mut self, ui: &mut Ui) {
        ui.heading("Layer");
        let mut layer = self.brush.layer;
        for choice in Layer::ALL {
            let painted = if self.document.layers.is_painted(choice) { " (painted)" } else { "" };
            ui.radio_value(&mut layer, choice, format!("{}{painted}", choice.name()))
                .on_hover_text(tip(choice));
        }
        if layer != self.brush.layer {
            self.choose_layer(layer);
        }
        ui.add_space(6.0);
        self.brush_controls(ui);
    }

    /// The brush, whatever it paints on.
    pub(crate) fn brush_controls(&mut self, ui: &mut Ui) {
        let layer = self.brush.layer;
        ui.heading("Brush");
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.brush.action, Action::Paint, "Paint");
            ui.selectable_value(&mut self.brush.action, Action::Erase, "Erase")
                .on_hover_text("E: back to what nobody painted");
        });
        let size_m = self.document.subject.size_m();
        let radius = Slider::new(&mut self.brush.radius_m, 0.005 * size_m..=0.5 * size_m)
            .logarithmic(true)
            .text("radius")
            .suffix(" m");
        ui.add(radius).on_hover_text("radius along the surface (m); keys [ and ]");
        slider(
            ui,
            &mut self.brush.strength,
            0.05..=1.0,
            "strength",
            "",
            "share of the way to the value that one stroke goes at its middle",
        );
        let (low, high, unit) = layer.range();
        let high = if layer == Layer::Coherence { size_m } else { high };
        let name = match layer {
            Layer::Wrinkles => "amount",
            Layer::Wavelength => "share of the wavelength",
            Layer::Expansion => "growth",
            Layer::Coherence => "length",
            Layer::Freeze => "frozen",
        };
        slider(ui, &mut self.brush.value, low..=high, name, unit, tip(layer));
        ComboBox::from_label("falloff").selected_text(falloff_name(self.brush.falloff)).show_ui(
            ui,
            |ui| {
                for falloff in [Falloff::Smooth, Falloff::Linear, Falloff::Hard] {
                    ui.selectable_value(&mut self.brush.falloff, falloff, falloff_name(falloff));
                }
            },
        );
        if layer.is_directed() {
            let mut headings = vec![Heading::AlongStroke, Heading::AcrossStroke, Heading::Screen];
            if layer == Layer::Expansion {
                headings.push(Heading::Isotropic);
            } else if self.brush.heading == Heading::Isotropic {
                self.brush.heading = Heading::AlongStroke;
            }
            ComboBox::from_label("direction")
                .selected_text(heading_name(layer, self.brush.heading))
                .width(190.0)
                .show_ui(ui, |ui| {
                    for heading in headings {
                        ui.selectable_value(
                            &mut self.brush.heading,
                            heading,
                            heading_name(layer, heading),
                        );
                    }
                });
            if self.brush.heading == Heading::Screen {
                let mut degrees = self.brush.screen_angle_rad.to_degrees();
                if slider(
                    ui,
                    &mut degrees,
                    -90.0..=90.0,
                    "angle",
                    "°",
                    "from the picture's right upwards (degrees)",
                ) {
                    self.brush.screen_angle_rad = degrees.to_radians();
                }
            }
        }
        ComboBox::from_label("mirror").selected_text(mirror_name(self.brush.mirror)).show_ui(
            ui,
            |ui| {
                for mirror in [Mirror::Off, Mirror::X, Mirror::Y, Mirror::Z] {
                    ui.selectable_value(&mut self.brush.mirror, mirror, mirror_name(mirror));
                }
            },
        );
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let undo =
                ui.add_enabled(!self.document.history.done().is_empty(), egui::Button::new("Undo"));
            if undo.on_hover_text(ui.ctx().format_shortcut(&Command::Undo.shortcut())).clicked() {
                self.run(Command::Undo);
            }
            let redo =
                ui.add_enabled(self.document.history.undone() > 0, egui::Button::new("Redo"));
            if redo.on_hover_text(ui.ctx().format_shortcut(&Command::Redo.shortcut())).clicked() {
                self.run(Command::Redo);
            }
            let strokes = self.document.history.done().len();
            ui.label(format!("{strokes} stroke{}", if strokes == 1 { "" } else { "s" }));
        });
        let (view, name) = match layer {
            Layer::Expansion => (View::Expansion, "Show what is painted"),
            _ => (View::Painted(layer), "Show what is painted"),
        };
        let mut shown = self.view == view;
        if ui.checkbox(&mut shown, name).changed() {
            self.view = if shown { view } else { View::Wrinkled };
        }
    }
}

fn tip(layer: Layer) -> &'static str {
    match layer {
        Layer::Wrinkles => {
            "wrinkles that are there in the rest pose; the surface counts as shorter by the square \
             of the amount"
        }
        Layer::Wavelength => "share of the wavelength, 0.05 to 1",
        Layer::Expansion => "by how much the surface shall grow (1 is twice as long)",
        Layer::Coherence => "how far the crests of folds run straight (m)",
        Layer::Freeze => "what is frozen from one half on does not move when it grows",
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
        (_, Heading::Isotropic) => "grows all ways",
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
