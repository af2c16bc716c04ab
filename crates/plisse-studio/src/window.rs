//! The program as eframe runs it.

use std::sync::{Arc, Mutex};

use plisse::Error;

use crate::automation::driver::Driver;
use crate::commands::Command;
use crate::studio::Studio;

/// The program in its window.
pub struct Window {
    /// The program.
    pub studio: Studio,
    /// The driver of a script, while there is one.
    pub driver: Option<Driver>,
    /// The error that ended the script.
    pub failure: Arc<Mutex<Option<Error>>>,
}

impl Window {
    /// One frame of the program, and one step of its script.
    pub fn frame(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        self.studio.ui(ui);
        let now_s = ctx.input(|i| i.time);
        let Some(driver) = &mut self.driver else { return };
        if let Err(error) = driver.advance(&mut self.studio, &ctx, now_s) {
            if let Ok(mut failure) = self.failure.lock() {
                *failure = Some(error);
            }
            self.studio.shell.quits = true;
        } else if driver.is_done() {
            self.driver = None;
        }
    }

    /// Closes the window if that was asked for; unsaved work needs an answer first.
    pub fn close_if_asked(&mut self, ctx: &egui::Context) {
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

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.frame(ui);
        self.close_if_asked(ui.ctx());
    }
}
