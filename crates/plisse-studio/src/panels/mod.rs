//! The window: menus, the panel on the left with its tabs, the picture, the line below.

pub mod browser;
pub mod canvas;
pub mod grow;
pub mod live;
pub mod menu;
pub mod paint;
pub mod physics;
pub mod plots;
pub mod questions;
pub mod take;

use egui::{CentralPanel, Panel, ScrollArea, Ui};

use crate::commands::Command;
use crate::studio::{Studio, Tab};

/// Width of the panel on the left (points).
const WIDTH: f32 = 312.0;

impl Studio {
    /// One frame of the window.
    pub fn ui(&mut self, ui: &mut Ui) {
        let begun = web_time::Instant::now();
        let ctx = ui.ctx().clone();
        let now_s = ctx.input(|i| i.time);
        let dropped = ctx.input(|i| i.raw.dropped_files.clone());
        #[cfg(target_arch = "wasm32")]
        if !dropped.is_empty() {
            crate::page::read_dropped(dropped);
        }
        #[cfg(not(target_arch = "wasm32"))]
        for file in dropped {
            self.ask_to_open(file.path().to_path_buf());
        }
        Command::pressed(&ctx).into_iter().for_each(|c| self.run(c));
        Panel::top("menu").show(ui, |ui| self.menu(ui));
        Panel::bottom("status").show(ui, |ui| self.status(ui));
        Panel::left("tools").exact_size(WIDTH).resizable(false).show(ui, |ui| {
            ui.add_space(4.0);
            ui.horizontal(|ui| {
                for tab in Tab::ALL {
                    ui.selectable_value(&mut self.tab, tab, tab.name());
                }
            });
            ui.separator();
            ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| match self.tab {
                Tab::Live => self.live_panel(ui),
                Tab::Paint => self.paint_panel(ui),
                Tab::Physics => self.physics_panel(ui),
                Tab::Grow => self.grow_panel(ui),
                Tab::TakeAway => self.take_panel(ui),
            });
        });
        let plain = egui::Frame::NONE.fill(ui.visuals().panel_fill);
        CentralPanel::default().frame(plain).show(ui, |ui| self.canvas(ui));
        self.questions(&ctx);
        self.browse(&ctx);
        self.advance(&ctx, now_s);
        let ms = begun.elapsed().as_secs_f32() * 1e3;
        self.frame_ms = if self.frame_ms == 0.0 { ms } else { 0.9 * self.frame_ms + 0.1 * ms };
    }
}

/// A slider with its unit and what it means.
pub(crate) fn slider<N: egui::emath::Numeric>(
    ui: &mut Ui,
    value: &mut N,
    range: std::ops::RangeInclusive<N>,
    name: &str,
    unit: &str,
    tip: &str,
) -> bool {
    ui.add(egui::Slider::new(value, range).text(name).suffix(unit)).on_hover_text(tip).changed()
}
