//! The Live tab: clips, and the wrinkles that the real-time stages make while they play.

use egui::{ComboBox, Slider, Ui};
use plisse_live::texture::Texture;

use super::plots;
use super::widgets::{Labels, slider};
use crate::document::settings::ProfileChoice;
use crate::document::{Document, Settings};
use crate::viewport::{ShownSurface, Viewport, texture_of};

/// Shows the tab.
pub(crate) fn panel(ui: &mut Ui, document: &mut Document, viewport: &mut Viewport) {
    ui.heading("Clip");
    clip(ui, document, viewport);
    ui.add_space(6.0);
    ui.heading("Wrinkles");
    let size_m = document.subject.size_m();
    wrinkles(ui, &mut document.settings, size_m);
    ui.add_space(6.0);
    ui.heading("Light and texture");
    texture(ui, document, viewport);
    ui.add_space(6.0);
    if let Some(frame) = &viewport.frame {
        ui.heading("Milliseconds");
        plots::stages(ui, &frame.stage_ms);
        ui.label(format!("mean phase error {:.4} waves", frame.phase_error))
            .on_hover_text("over edges whose ends both wrinkle; random phases give 0.25");
    }
}

fn clip(ui: &mut Ui, document: &mut Document, viewport: &mut Viewport) {
    let (model, settings) = (&document.subject.model, &mut document.settings);
    if model.clips.is_empty() {
        ui.label("this model has no clip; it stands still");
        return;
    }
    let chosen = settings.clip.clone().unwrap_or_else(|| "rest pose".into());
    ComboBox::from_label("clip").selected_text(chosen).width(180.0).show_ui(ui, |ui| {
        ui.selectable_value(&mut settings.clip, None, "rest pose");
        for clip in &model.clips {
            ui.selectable_value(&mut settings.clip, Some(clip.name.clone()), &clip.name);
        }
    });
    let playing_clip = model.clips.iter().find(|c| Some(&c.name) == settings.clip.as_ref());
    let duration_s = playing_clip.map_or(0.0, |c| c.duration_s());
    ui.horizontal(|ui| {
        let has_clip = settings.clip.is_some();
        let name = if viewport.playing { "Pause" } else { "Play" };
        let play = ui.add_enabled(has_clip, egui::Button::new(name)).on_hover_text("space");
        if play.clicked() {
            viewport.playing = !viewport.playing;
            viewport.shown = ShownSurface::Live;
        }
        let time = Slider::new(&mut settings.time_s, 0.0..=duration_s.max(1e-3))
            .text("time")
            .suffix(" s")
            .fixed_decimals(2);
        if ui.add_enabled(has_clip, time).on_hover_text("time in the clip (s)").changed() {
            viewport.playing = false;
        }
    });
    let labels = Labels { name: "speed", unit: "×", tip: "playing speed; 1 is the clip's own" };
    slider(ui, &mut settings.speed, 0.1..=2.0, labels);
}

fn wrinkles(ui: &mut Ui, settings: &mut Settings, size_m: f32) {
    let wavelength = Slider::new(&mut settings.wavelength_m, 0.002 * size_m..=0.3 * size_m)
        .logarithmic(true)
        .text("wavelength")
        .suffix(" m");
    ui.add(wavelength).on_hover_text("wavelength of the wrinkles in the rest pose (m)");
    profile(ui, &mut settings.profile);
    let labels = Labels {
        name: "rounds",
        unit: "",
        tip: "rounds of phase relaxation per frame; 0 leaves phases as they are",
    };
    slider(ui, &mut settings.rounds, 0..=20, labels);
    let labels = Labels {
        name: "step",
        unit: "",
        tip: "step of each round, as a share of the way to the neighbours' phases",
    };
    slider(ui, &mut settings.rate, 0.0..=0.5, labels);
    ui.label(format!("ε = {:.2}", settings.epsilon()))
        .on_hover_text("the step in eq. 6 of Loviscach 2006: 2π² times the share");
    ui.checkbox(&mut settings.parallax, "texture shifts with the wrinkles")
        .on_hover_text("parallax, section 6.2 of Loviscach 2006");
}

fn profile(ui: &mut Ui, profile: &mut ProfileChoice) {
    ComboBox::from_label("profile").selected_text(profile.name()).show_ui(ui, |ui| {
        for choice in [ProfileChoice::Sine, ProfileChoice::Accordion, ProfileChoice::Pencil] {
            let name = choice.name();
            ui.selectable_value(profile, choice, name);
        }
        let own = matches!(profile, ProfileChoice::Heights(_));
        if ui.selectable_label(own, "From heights").clicked() && !own {
            *profile = ProfileChoice::Heights(vec![1.0, 0.7, -0.2, -1.0]);
        }
    });
    let ProfileChoice::Heights(heights) = profile else { return };
    ui.label("heights from crest to trough (−1 to 1)");
    ui.horizontal_wrapped(|ui| {
        for height in heights.iter_mut() {
            ui.add(egui::DragValue::new(height).range(-1.0..=1.0).speed(0.01));
        }
        if ui.button("+").on_hover_text("add a height").clicked() && heights.len() < 16 {
            heights.push(-1.0);
        }
        if ui.button("−").on_hover_text("remove a height").clicked() && heights.len() > 2 {
            heights.pop();
        }
    });
}

fn texture(ui: &mut Ui, document: &Document, viewport: &mut Viewport) {
    ui.horizontal(|ui| {
        ui.color_edit_button_srgb(&mut viewport.colour);
        ui.label("colour of the cloth");
    });
    if ui.button("Checked cloth").on_hover_text("shows how the texture shifts").clicked() {
        viewport.set_texture(Texture::checked());
    }
    if ui.button("The model's own, or plain").clicked() {
        let has_own = document.subject.model.base_colour.is_some();
        viewport.set_texture(if has_own {
            texture_of(&document.subject).0
        } else {
            Texture::plain([214, 176, 158])
        });
    }
}
