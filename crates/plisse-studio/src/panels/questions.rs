//! What needs an answer before something is lost.

use egui::{Align2, Window, vec2};

use crate::messages::Weight;
use crate::studio::{Question, Studio};

impl Studio {
    /// Shows the question that waits, autosaves of programs that were killed, and problems.
    pub(crate) fn questions(&mut self, ctx: &egui::Context) {
        if let Some(question) = self.asks.clone() {
            let (title, text, yes) = match &question {
                Question::Open(path) => (
                    "Not saved",
                    format!("What you painted is not saved. Open {} all the same?", path.display()),
                    "Open",
                ),
                Question::Own(name) => (
                    "Not saved",
                    format!("What you painted is not saved. Show the {name} all the same?"),
                    "Show",
                ),
                Question::Quit => (
                    "Not saved",
                    "What you painted is not saved. Quit all the same?".to_owned(),
                    "Quit",
                ),
                Question::Reload(path) => (
                    "Changed on the disk",
                    format!(
                        "{} has changed since it was read. What is open here stays as it is until \
                         you read it again.",
                        path.display()
                    ),
                    "Read again",
                ),
            };
            let mut answer = None;
            Window::new(title)
                .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
                .collapsible(false)
                .resizable(false)
                .show(ctx, |ui| {
                    ui.set_max_width(380.0);
                    ui.label(text);
                    ui.add_space(6.0);
                    ui.horizontal(|ui| {
                        if ui.button(yes).clicked() {
                            answer = Some(true);
                        }
                        let no = if matches!(question, Question::Reload(_)) {
                            "Keep what is open"
                        } else {
                            "Stay"
                        };
                        if ui.button(no).clicked() {
                            answer = Some(false);
                        }
                    });
                });
            match answer {
                Some(true) => {
                    self.asks = None;
                    match question {
                        Question::Open(path) => self.open(&path),
                        Question::Own(name) => self.show_own(&name),
                        Question::Quit => self.quits = true,
                        Question::Reload(path) => self.reload(&path),
                    }
                }
                Some(false) => self.asks = None,
                None => {}
            }
        }
        if let (Some(left), None, false) = (self.left.first().cloned(), &self.asks, self.later) {
            let mut answer = None;
            Window::new("Recover")
                .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
                .collapsible(false)
                .resizable(false)
                .show(ctx, |ui| {
                    ui.set_max_width(380.0);
                    ui.label(format!(
                        "The program ended before {} was saved. Take it up again?",
                        left.name
                    ));
                    ui.add_space(6.0);
                    ui.horizontal(|ui| {
                        if ui.button("Recover").clicked() {
                            answer = Some(true);
                        }
                        if ui
                            .button("Later")
                            .on_hover_text("it stays under File, Recover")
                            .clicked()
                        {
                            answer = Some(false);
                        }
                    });
                });
            match answer {
                Some(true) => self.recover(&left),
                Some(false) => self.later = true,
                None => {}
            }
        }
        if self.messages.open {
            self.problems(ctx);
        }
    }

    fn problems(&mut self, ctx: &egui::Context) {
        let problems: Vec<String> = self
            .messages
            .list()
            .iter()
            .rev()
            .filter(|m| m.weight == Weight::Problem)
            .take(3)
            .map(|m| m.text.clone())
            .collect();
        let mut closed = false;
        Window::new("Message")
            .anchor(Align2::RIGHT_TOP, vec2(-12.0, 64.0))
            .collapsible(false)
            .resizable(false)
            .show(ctx, |ui| {
                ui.set_max_width(360.0);
                for text in &problems {
                    ui.colored_label(ui.visuals().error_fg_color, text);
                    ui.add_space(4.0);
                }
                closed = ui.button("Close").on_hover_text("messages stay in the menu").clicked();
            });
        if closed {
            self.messages.open = false;
        }
    }
}
