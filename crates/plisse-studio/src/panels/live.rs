//! Live: clips, and how wrinkles are made while they play.

use egui::{ComboBox, Slider, Ui};

use super::{plots, slider};
use crate::document::settings::ProfileChoice;
use crate::studio::{Looking, Studio};

impl Studio {
    pub(crate) fn live_panel(&mut self, ui: &mut Ui) {
        ui.heading("Clip");
        let clips: Vec<(String, f32)> = self
            .document
            .subject
            .model
            .clips
            .iter()
            .map(|c| (c.name.clone(), c.duration_s()))
            .collect();
        if clips.is_empty() {
            ui.label("this model has no clip; it stands still");
        } else {
            let settings = &mut self.document.settings;
            let chosen = settings.clip.clone().unwrap_or_else(|| "rest pose".into());
            ComboBox::from_label("clip").selected_text(chosen).width(180.0).show_ui(ui, |ui| {
                ui.selectable_value(&mut settings.clip, None, "rest pose");
                for (name, _) in &clips {
                    ui.selectable_value(&mut settings.clip, Some(name.clone()), name);
                }
            });
            let duration_s =
                clips.iter().find(|c| Some(&c.0) == settings.clip.as_ref()).map_or(0.0, |c| c.1);
            ui.horizontal(|ui| {
                let name = if self.playing { "Hold" } else { "Play" };
                if ui
                    .add_enabled(settings.clip.is_some(), egui::Button::new(name))
                    .on_hover_text("space")
                    .clicked()
                {
                    self.playing = !self.playing;
                    self.looking = Looking::Live;
                }
                let time = Slider::new(&mut settings.time_s, 0.0..=duration_s.max(1e-3))
                    .text("time")
                    .suffix(" s")
                    .fixed_decimals(2);
                if ui
                    .add_enabled(settings.clip.is_some(), time)
                    .on_hover_text("time in the clip (s)")
                    .changed()
                {
                    self.playing = false;
                }
            });
            slider(
                ui,
                &mut settings.speed,
                0.1..=2.0,
                "speed",
                "×",
                "speed of playing, 1 as it was made",
            );
        }
        ui.add_space(6.0);
        ui.heading("Wrinkles");
        let size_m = self.document.subject.size_m();
        let settings = &mut self.document.settings;
        let wavelength = Slider::new(&mut settings.wavelength_m, 0.002 * size_m..=0.3 * size_m)
            .logarithmic(true)
            .text("wavelength")
            .suffix(" m");
        ui.add(wavelength).on_hover_text("width of one wrinkle in the rest pose (m)");
        ComboBox::from_label("profile").selected_text(settings.profile.name()).show_ui(ui, |ui| {
            for choice in [ProfileChoice::Sine, ProfileChoice::Accordion, ProfileChoice::Pencil] {
                let name = choice.name();
                ui.selectable_value(&mut settings.profile, choice, name);
            }
            let own = matches!(settings.profile, ProfileChoice::Heights(_));
            if ui.selectable_label(own, "From heights").clicked() && !own {
                settings.profile = ProfileChoice::Heights(vec![1.0, 0.7, -0.2, -1.0]);
            }
        });
        if let ProfileChoice::Heights(heights) = &mut settings.profile {
            ui.label("heights from crest to trough (−1 to 1)");
            ui.horizontal_wrapped(|ui| {
                for height in heights.iter_mut() {
                    ui.add(egui::DragValue::new(height).range(-1.0..=1.0).speed(0.01));
                }
                if ui.button("+").on_hover_text("one more height").clicked() && heights.len() < 16 {
                    heights.push(-1.0);
                }
                if ui.button("−").on_hover_text("one height less").clicked() && heights.len() > 2
                {
                    heights.pop();
                }
            });
        }
        slider(
            ui,
            &mut settings.rounds,
            0..=20,
            "rounds",
            "",
            "rounds of relaxation a frame; 0 leaves phases as they are",
        );
        slider(
            ui,
            &mut settings.rate,
            0.0..=0.5,
            "step",
            "",
            "share of the way to the neighbours' phases a round goes",
        );
        ui.label(format!("ε = {:.2}", settings.epsilon()))
            .on_hover_text("the step of eq. 6 of Loviscach 2006: 2π² times the share");
        ui.checkbox(&mut settings.parallax, "texture shifts with the wrinkles")
            .on_hover_text("parallax, section 6.2");
        ui.add_space(6.0);
        ui.heading("Light and texture");
        ui.horizontal(|ui| {
            ui.color_edit_button_srgb(&mut self.colour);
            ui.label("colour of the cloth");
        });
        if ui.button("Checked cloth").on_hover_text("shows where the texture shifts").clicked() {
            self.texture = std::sync::Arc::new(plisse_live::texture::Texture::checked());
            self.settle = self.settle.max(2);
        }
        if ui.button("The model's own, or plain").clicked() {
            let own = self.document.subject.model.base_colour.is_some();
            let plain = plisse_live::texture::Texture::plain([214, 176, 158]);
            self.texture = std::sync::Arc::new(if own {
                crate::view::easel::texture_of(&self.document.subject).0
            } else {
                plain
            });
            self.settle = self.settle.max(2);
        }
        ui.add_space(6.0);
        if let Some(sheet) = &self.sheet {
            ui.heading("Milliseconds");
            plots::stages(ui, &sheet.stage_ms);
            ui.label(format!("mean phase error {:.4} waves", sheet.phase_error))
                .on_hover_text("over edges whose ends both wrinkle; random phases give 0.25");
        }
    }
}
