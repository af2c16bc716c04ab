//! The menu bar and the line below.

use egui::{Button, MenuBar, RichText, Ui};
use plisse::io::disk;

use crate::commands::Command;
use crate::messages::Weight;
use crate::panels::browser::Browser;
use crate::studio::{Question, Studio, Tab};
use crate::view::View;

impl Studio {
    pub(crate) fn menu(&mut self, ui: &mut Ui) {
        MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| {
                self.entry(ui, Command::Open);
                ui.menu_button("Models of its own", |ui| {
                    for name in plisse_live::models::NAMES {
                        if ui.button(name).clicked() {
                            self.ask_to_show(name);
                        }
                    }
                });
                if !self.left.is_empty() {
                    ui.menu_button("Recover", |ui| {
                        for left in self.left.clone() {
                            if ui
                                .button(&left.name)
                                .on_hover_text(left.path.display().to_string())
                                .clicked()
                            {
                                self.recover(&left);
                            }
                        }
                    });
                }
                ui.separator();
                self.entry(ui, Command::Save);
                self.entry(ui, Command::SaveAs);
                if ui.button("Take away…").clicked() {
                    self.tab = Tab::TakeAway;
                }
                if !disk::IN_MEMORY {
                    ui.separator();
                    self.entry(ui, Command::Quit);
                }
            });
            ui.menu_button("Edit", |ui| {
                self.entry(ui, Command::Undo);
                self.entry(ui, Command::Redo);
                ui.separator();
                self.entry(ui, Command::SmallerBrush);
                self.entry(ui, Command::LargerBrush);
                self.entry(ui, Command::Erase);
            });
            ui.menu_button("View", |ui| {
                (0..View::MAIN.len()).for_each(|n| self.entry(ui, Command::View(n as u8)));
                ui.separator();
                self.entry(ui, Command::Frame);
            });
            ui.menu_button("Run", |ui| {
                self.entry(ui, Command::Play);
                self.entry(ui, Command::Solve);
            });
            ui.menu_button("Messages", |ui| {
                ui.set_min_width(420.0);
                if self.messages.list().is_empty() {
                    ui.label("nothing yet");
                }
                egui::ScrollArea::vertical().max_height(360.0).stick_to_bottom(true).show(
                    ui,
                    |ui| {
                        for message in self.messages.list() {
                            let times = if message.times > 1 {
                                format!(" (×{})", message.times)
                            } else {
                                String::new()
                            };
                            let text = RichText::new(format!("{}{times}", message.text));
                            ui.label(if message.weight == Weight::Problem {
                                text.color(ui.visuals().error_fg_color)
                            } else {
                                text
                            });
                        }
                    },
                );
            });
            let name = self.document.subject.source.stem();
            let star = if self.is_unsaved() { " *" } else { "" };
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(format!("{name}{star}")).strong());
            });
        });
    }

    fn entry(&mut self, ui: &mut Ui, command: Command) {
        let enabled = match command {
            Command::Undo => !self.document.history.done().is_empty(),
            Command::Redo => self.document.history.undone() > 0,
            Command::Play => self.document.settings.clip.is_some(),
            Command::Solve => self.document.subject.scene.is_some(),
            _ => true,
        };
        let keys = ui.ctx().format_shortcut(&command.shortcut());
        if ui.add_enabled(enabled, Button::new(command.name()).shortcut_text(keys)).clicked() {
            self.run(command);
        }
    }

    /// The line below: vertices, milliseconds, what draws, and the last message.
    pub(crate) fn status(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let unified = &self.document.subject.unified;
            ui.label(format!("{} vertices, {} faces", unified.count(), unified.faces.len()));
            ui.separator();
            if let Some(sheet) = &self.sheet {
                let total: f32 = sheet.stage_ms.iter().sum();
                ui.label(format!("picture {total:.0} ms"))
                    .on_hover_text("milliseconds of stages and drawing, on their own thread");
                ui.separator();
                ui.label(format!("frame {:.1} ms", self.frame_ms))
                    .on_hover_text("milliseconds the window's own thread takes a frame");
                ui.separator();
                ui.label(&sheet.device).on_hover_text("what draws the picture");
                ui.separator();
            }
            if let Some(message) = self.messages.last() {
                let text = RichText::new(&message.text);
                let text = if message.weight == Weight::Problem {
                    text.color(ui.visuals().error_fg_color)
                } else {
                    text
                };
                ui.add(egui::Label::new(text).truncate()).on_hover_text(&message.text);
            }
        });
    }

    /// Opens `path`, after a question if that would lose something.
    pub fn ask_to_open(&mut self, path: std::path::PathBuf) {
        if self.is_unsaved() {
            self.asks = Some(Question::Open(path));
        } else {
            self.open(&path);
        }
    }

    fn ask_to_show(&mut self, name: &str) {
        if self.is_unsaved() {
            self.asks = Some(Question::Own(name.to_owned()));
        } else {
            self.show_own(name);
        }
    }

    /// Shows one of the program's own models.
    pub fn show_own(&mut self, name: &str) {
        match crate::document::Subject::own(name) {
            Ok(subject) => self.show(crate::document::Document::new(subject), None),
            Err(error) => self.messages.problem(error),
        }
    }

    /// The window in which files are chosen.
    pub(crate) fn browse(&mut self, ctx: &egui::Context) {
        let Some(mut browser) = self.browser.take() else { return };
        match browser.show(ctx) {
            None => self.browser = Some(browser),
            Some(None) => {}
            Some(Some(path)) => self.chosen(&browser, path),
        }
    }

    fn chosen(&mut self, browser: &Browser, path: std::path::PathBuf) {
        match browser.purpose {
            crate::panels::browser::Purpose::Open => self.ask_to_open(path),
            crate::panels::browser::Purpose::Save => self.save(&path),
            crate::panels::browser::Purpose::Take(kind) => self.take(kind, path),
        }
    }
}
