//! The Export tab: files for other programs.

use std::path::PathBuf;

use egui::{Button, ComboBox, Ui};

use crate::commands::Command;
use crate::document::{Document, Source};
use crate::jobs::export::Export;
use crate::viewport::ShownSurface;
use crate::work::export::Kind;

/// Shows the tab, for files of the surface `exported`; the commands that were chosen.
pub(crate) fn panel(
    ui: &mut Ui,
    document: &Document,
    export: &mut Export,
    exported: ShownSurface,
) -> Vec<Command> {
    let stem = document.subject.source.stem();
    ui.label(match exported {
        ShownSurface::Live => "Exports the model with its live wrinkles.",
        ShownSurface::Solved => "Exports the solved scene.",
        ShownSurface::Grown => "Exports the grown surface.",
    });
    ui.add_space(4.0);
    let mut commands = Vec::new();
    let chosen = ui
        .add_enabled_ui(!export.is_busy(), |ui| {
            let surface = surface(ui, &stem);
            let maps = maps(ui, &stem, &mut export.map_size);
            surface.or(maps).or(field_and_scene(ui, &stem, document.subject.scene.is_some()))
        })
        .inner;
    if let Some(File { kind, name }) = chosen {
        let beside = match &document.subject.source {
            Source::File(path) => path.with_file_name(name),
            Source::Own(_) => PathBuf::from(name),
        };
        commands.push(Command::Export(kind, beside));
    }
    let picture = ui.button("Picture (PNG)");
    if picture.on_hover_text("the picture as you see it, written to the current folder").clicked() {
        commands.push(Command::ExportPicture(PathBuf::from(format!("{stem}-picture.png"))));
    }
    if let Some(progress) = export.progress() {
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(progress.stage);
            if ui.button("Stop").clicked() {
                commands.push(Command::StopExport);
            }
        });
    }
    if !export.written.is_empty() {
        ui.add_space(6.0);
        ui.label("Exported last:");
        for path in &export.written {
            ui.add(egui::Label::new(path.display().to_string()).truncate());
        }
    }
    commands
}

/// A file to export: its kind and its suggested name.
struct File {
    kind: Kind,
    name: String,
}

fn surface(ui: &mut Ui, stem: &str) -> Option<File> {
    ui.heading("Surface");
    let mut chosen = None;
    ui.horizontal(|ui| {
        for extension in ["obj", "ply", "glb"] {
            let button = ui.add(Button::new(extension.to_uppercase()));
            if button.on_hover_text("wrinkled geometry (m)").clicked() {
                let name = format!("{stem}-wrinkled.{extension}");
                chosen = Some(File { kind: Kind::Surface, name });
            }
        }
    });
    chosen
}

fn maps(ui: &mut Ui, stem: &str, map_size: &mut usize) -> Option<File> {
    ui.heading("Maps");
    ComboBox::from_label("width and height (texels)").selected_text(map_size.to_string()).show_ui(
        ui,
        |ui| {
            for size in [256, 512, 1024, 2048, 4096] {
                ui.selectable_value(map_size, size, size.to_string());
            }
        },
    );
    let mut chosen = None;
    ui.horizontal(|ui| {
        let tip = "16-bit PNG, with the command that bakes them again";
        if ui.button("Height and normals").on_hover_text(tip).clicked() {
            chosen = Some(File { kind: Kind::Maps, name: format!("{stem}-maps") });
        }
        let tip = "painted layers as PNG, the bias as JSON";
        if ui.button("Painted layers").on_hover_text(tip).clicked() {
            chosen = Some(File { kind: Kind::Paint, name: format!("{stem}-paint") });
        }
    });
    chosen
}

fn field_and_scene(ui: &mut Ui, stem: &str, has_scene: bool) -> Option<File> {
    ui.heading("Field and scene");
    if ui.button("Wrinkle field (JSON)").clicked() {
        return Some(File { kind: Kind::Field, name: format!("{stem}-field.json") });
    }
    let tip = "scene.toml, the files it names, and the exact files that plisse solve makes of them";
    let button = ui.add_enabled(has_scene, Button::new("Scene and its files"));
    button
        .on_hover_text(tip)
        .clicked()
        .then(|| File { kind: Kind::SceneFiles, name: format!("{stem}-solved") })
}
