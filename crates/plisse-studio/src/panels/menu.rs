//! The menu bar and the status line.

use egui::{Button, MenuBar, RichText, Ui};
use plisse::io::disk;

use crate::commands::Command;
use crate::document::Document;
use crate::messages::{Message, Messages, Weight};
use crate::session::Session;
use crate::shell::{Shell, Tab};
use crate::view::View;
use crate::viewport::Viewport;

/// Shows the menu bar; the commands that were chosen.
pub(crate) fn bar(ui: &mut Ui, session: &Session, shell: &mut Shell) -> Vec<Command> {
    let document = &session.document;
    let mut commands = Vec::new();
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| commands.extend(file(ui, document, shell)));
        ui.menu_button("Edit", |ui| {
            commands.extend(entry(ui, document, Command::Undo));
            commands.extend(entry(ui, document, Command::Redo));
            ui.separator();
            commands.extend(entry(ui, document, Command::SmallerBrush));
            commands.extend(entry(ui, document, Command::LargerBrush));
            commands.extend(entry(ui, document, Command::Erase));
        });
        ui.menu_button("View", |ui| {
            for n in 0..View::MAIN.len() {
                commands.extend(entry(ui, document, Command::View(n as u8)));
            }
            ui.separator();
            commands.extend(entry(ui, document, Command::Frame));
        });
        ui.menu_button("Run", |ui| {
            commands.extend(entry(ui, document, Command::Play));
            commands.extend(entry(ui, document, Command::Solve));
        });
        ui.menu_button("Messages", |ui| message_list(ui, &shell.messages));
        let name = document.subject.source.stem();
        let star = if session.is_unsaved() { " *" } else { "" };
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(format!("{name}{star}")).strong());
        });
    });
    commands
}

fn file(ui: &mut Ui, document: &Document, shell: &mut Shell) -> Vec<Command> {
    let mut commands = Vec::new();
    commands.extend(entry(ui, document, Command::Open));
    ui.menu_button("Built-in models", |ui| {
        for name in plisse_live::models::NAMES {
            if ui.button(name).clicked() {
                commands.push(Command::OpenModel(name.to_owned()));
            }
        }
    });
    if !shell.leftovers.is_empty() {
        ui.menu_button("Recover", |ui| {
            for leftover in &shell.leftovers {
                let button = ui.button(&leftover.name);
                if button.on_hover_text(leftover.path.display().to_string()).clicked() {
                    commands.push(Command::Recover(leftover.clone()));
                }
            }
        });
    }
    ui.separator();
    commands.extend(entry(ui, document, Command::Save));
    commands.extend(entry(ui, document, Command::SaveAs));
    if ui.button("Export…").clicked() {
        shell.tab = Tab::Export;
    }
    if !disk::IN_MEMORY {
        ui.separator();
        commands.extend(entry(ui, document, Command::Quit));
    }
    commands
}

/// An entry of a menu; its command if it was chosen.
fn entry(ui: &mut Ui, document: &Document, command: Command) -> Option<Command> {
    let enabled = match command {
        Command::Undo => !document.history.done().is_empty(),
        Command::Redo => document.history.undone() > 0,
        Command::Play => document.settings.clip.is_some(),
        Command::Solve => document.subject.scene.is_some(),
        _ => true,
    };
    let mut button = Button::new(command.name());
    if let Some(keys) = command.shortcut() {
        button = button.shortcut_text(ui.ctx().format_shortcut(&keys));
    }
    ui.add_enabled(enabled, button).clicked().then_some(command)
}

fn message_list(ui: &mut Ui, messages: &Messages) {
    ui.set_min_width(420.0);
    if messages.list().is_empty() {
        ui.label("no messages yet");
    }
    egui::ScrollArea::vertical().max_height(360.0).stick_to_bottom(true).show(ui, |ui| {
        for message in messages.list() {
            let times = match message.times {
                1 => String::new(),
                times => format!(" (×{times})"),
            };
            ui.label(coloured(ui, message, format!("{}{times}", message.text)));
        }
    });
}

/// A message's text, in the colour of its weight.
fn coloured(ui: &Ui, message: &Message, text: String) -> RichText {
    let text = RichText::new(text);
    if message.weight == Weight::Problem { text.color(ui.visuals().error_fg_color) } else { text }
}

/// Shows the status line: size of the mesh, milliseconds, device, and the last message.
pub(crate) fn status(ui: &mut Ui, document: &Document, viewport: &Viewport, shell: &Shell) {
    ui.horizontal(|ui| {
        let welded = &document.subject.welded;
        ui.label(format!("{} vertices, {} faces", welded.count(), welded.faces.len()));
        ui.separator();
        if let Some(frame) = &viewport.frame {
            let total: f32 = frame.stage_ms.values().iter().sum();
            ui.label(format!("picture {total:.0} ms"))
                .on_hover_text("time of the stages and of drawing, in the render thread (ms)");
            ui.separator();
            ui.label(format!("frame {:.1} ms", shell.frame_ms))
                .on_hover_text("time of the window's own thread per frame (ms)");
            ui.separator();
            ui.label(&frame.device).on_hover_text("the device that draws the picture");
            ui.separator();
        }
        if let Some(message) = shell.messages.last() {
            let text = coloured(ui, message, message.text.clone());
            ui.add(egui::Label::new(text).truncate()).on_hover_text(&message.text);
        }
    });
}
