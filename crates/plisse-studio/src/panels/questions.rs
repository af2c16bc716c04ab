//! Questions that need an answer before something is lost, and problems.

use egui::{Align2, Window, vec2};

use crate::messages::{Messages, Weight};
use crate::shell::{Question, Shell};

/// The texts of a question.
struct Texts {
    title: &'static str,
    text: String,
    yes: &'static str,
    no: &'static str,
}

/// Shows the question that waits, and problems; the question that was answered with yes.
pub(crate) fn show(ctx: &egui::Context, shell: &mut Shell) -> Option<Question> {
    let answered = shell.open_question().and_then(|question| {
        let answer = ask(ctx, &texts(&question))?;
        let is_recovery = matches!(question, Question::Recover(_));
        if is_recovery {
            shell.recovers_later |= !answer;
        } else {
            shell.question = None;
        }
        answer.then_some(question)
    });
    if shell.messages.open {
        problems(ctx, &mut shell.messages);
    }
    answered
}

fn texts(question: &Question) -> Texts {
    let unsaved = |text: String, yes| Texts {
        title: "Not saved",
        text: format!("Your paint is not saved. {text}"),
        yes,
        no: "Cancel",
    };
    match question {
        Question::Open(path) => unsaved(format!("Open {} anyway?", path.display()), "Open"),
        Question::OpenModel(name) => unsaved(format!("Open the {name} anyway?"), "Open"),
        Question::Quit => unsaved("Quit anyway?".to_owned(), "Quit"),
        Question::Reload(path) => Texts {
            title: "Changed on the disk",
            text: format!(
                "{} has changed since it was read. Read it again? Until then, the document stays \
                 as it is.",
                path.display()
            ),
            yes: "Read again",
            no: "Keep what is open",
        },
        Question::Recover(leftover) => Texts {
            title: "Recover",
            text: format!(
                "The program ended before {} was saved. Recover the autosave? It stays in the \
                 menu, under File, Recover.",
                leftover.name
            ),
            yes: "Recover",
            no: "Later",
        },
    }
}

/// Asks a question; the answer, once there is one.
fn ask(ctx: &egui::Context, texts: &Texts) -> Option<bool> {
    let mut answer = None;
    Window::new(texts.title)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .collapsible(false)
        .resizable(false)
        .show(ctx, |ui| {
            ui.set_max_width(380.0);
            ui.label(&texts.text);
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                if ui.button(texts.yes).clicked() {
                    answer = Some(true);
                }
                if ui.button(texts.no).clicked() {
                    answer = Some(false);
                }
            });
        });
    answer
}

fn problems(ctx: &egui::Context, messages: &mut Messages) {
    let problems: Vec<String> = messages
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
        messages.open = false;
    }
}
