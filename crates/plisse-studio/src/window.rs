//! The program as eframe runs it, in a window of its own and in a page.

use std::sync::{Arc, Mutex};

use plisse::Error;

use crate::automation::driver::Driver;
use crate::commands::Command;
use crate::studio::Studio;

/// The program in its window.
pub struct Window {
    /// The program.
    pub studio: Studio,
    /// The script that drives it, while there is one.
    pub driver: Option<Driver>,
    /// Why the script ended, if it could not be done.
    pub failure: Arc<Mutex<Option<Error>>>,
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.studio.ui(ui);
        let now_s = ctx.input(|i| i.time);
        #[cfg(target_arch = "wasm32")]
        let was_driven = self.driver.is_some();
        if let Some(driver) = &mut self.driver {
            if let Err(error) = driver.go(&mut self.studio, &ctx, now_s) {
                if let Ok(mut failure) = self.failure.lock() {
                    *failure = Some(error);
                }
                self.studio.shell.quits = true;
            } else if driver.is_done() {
                self.driver = None;
            }
        }
        #[cfg(target_arch = "wasm32")]
        crate::page::after_frame(self, was_driven);
        let closes = ctx.input(|i| i.viewport().close_requested());
        if closes && !self.studio.shell.quits && self.studio.session.is_unsaved() {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.studio.run(Command::Quit);
        } else if self.studio.shell.quits {
            self.studio.close();
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        } else if closes {
            self.studio.close();
        }
    }
}
