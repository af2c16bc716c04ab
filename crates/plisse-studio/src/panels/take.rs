//! Take away: files.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Button, ComboBox, Ui};

use super::browser::Browser;
use crate::studio::{Looking, Studio};
use crate::work::export::{Kind, Source, write};
use crate::work::job::{Job, News};

/// Files on their way.
pub struct Taking {
    job: Option<Job<Vec<PathBuf>>>,
    /// Texels along each side of maps.
    pub map_size: usize,
    /// The paths written last.
    pub written: Vec<PathBuf>,
}

impl Default for Taking {
    fn default() -> Self {
        Self { job: None, map_size: 1024, written: Vec::new() }
    }
}

impl Taking {
    /// Whether files are on their way.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }
}

impl Studio {
    /// What the window shows, as files take it.
    fn source(&self) -> Source {
        let document = Box::new(self.document.clone());
        match (self.looking, &self.physics.solved, &self.growth.grown) {
            (Looking::Solved, Some(solved), _) => Source::Solved(Arc::clone(solved), document),
            (Looking::Grown, _, Some(grown)) => Source::Grown(Arc::clone(grown), document),
            _ => Source::Live(document),
        }
    }

    /// Writes `kind` to `path` in the background.
    pub fn take(&mut self, kind: Kind, path: PathBuf) {
        if self.taking.is_busy() {
            self.messages.problem("take away: files are on their way already; wait for them");
            return;
        }
        let (source, size, wake) = (self.source(), self.taking.map_size, Arc::clone(&self.wake));
        self.taking.job = Some(Job::start(
            "take away",
            move || wake(),
            move |reporter| write(kind, &source, &path, size, reporter),
        ));
    }

    pub(crate) fn take_taken(&mut self) {
        let Some(job) = &self.taking.job else { return };
        for news in job.take() {
            if let News::Done(done) = news {
                self.taking.job = None;
                match done {
                    Ok(paths) => {
                        let names: Vec<String> = paths
                            .iter()
                            .filter_map(|p| p.file_name())
                            .map(|n| n.to_string_lossy().into_owned())
                            .collect();
                        let folder = paths
                            .first()
                            .and_then(|p| p.parent())
                            .map_or_else(String::new, |p| p.display().to_string());
                        let to =
                            if folder.is_empty() { String::new() } else { format!(" to {folder}") };
                        self.messages.note(format!("wrote {}{to}", names.join(", ")));
                        self.taking.written = paths;
                    }
                    Err(error) => {
                        self.messages.problem(format!("{error}; your work is still here"))
                    }
                }
                return;
            }
        }
    }

    /// Writes the picture as it is seen to `path`.
    pub fn take_picture(&mut self, path: &std::path::Path) {
        let Some(sheet) = &self.sheet else { return };
        if sheet.texture.is_some() {
            self.wanted = Some(path.to_path_buf());
            (self.wake)();
            return;
        }
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default().to_owned();
        let image = &sheet.image;
        let written = plisse::io::aside::OutputFolder::create(
            path.parent().unwrap_or(std::path::Path::new(".")),
        )
        .and_then(|mut folder| {
            folder.write(&name, |out| plisse::picture::write_png(image, out))?;
            folder.commit()
        });
        match written {
            Ok(_) => self.messages.note(format!("wrote {}", path.display())),
            Err(error) => self.messages.problem(format!("{error}; your work is still here")),
        }
    }

    pub(crate) fn take_panel(&mut self, ui: &mut Ui) {
        let stem = self.document.subject.source.stem();
        let what = match self.source() {
            Source::Live(_) => "the model with its live waves",
            Source::Solved(..) => "the solved scene",
            Source::Grown(..) => "what has grown",
        };
        ui.label(format!("Taken away is what the picture shows: {what}."));
        ui.add_space(4.0);
        let busy = self.taking.is_busy();
        let mut wanted = None;
        ui.add_enabled_ui(!busy, |ui| {
            ui.heading("Surface");
            ui.horizontal(|ui| {
                for extension in ["obj", "ply", "glb"] {
                    if ui
                        .add(Button::new(extension.to_uppercase()))
                        .on_hover_text("wrinkled geometry (m)")
                        .clicked()
                    {
                        wanted = Some((Kind::Surface, format!("{stem}-wrinkled.{extension}")));
                    }
                }
            });
            ui.heading("Maps");
            ComboBox::from_label("texels along a side")
                .selected_text(self.taking.map_size.to_string())
                .show_ui(ui, |ui| {
                    for size in [256, 512, 1024, 2048, 4096] {
                        ui.selectable_value(&mut self.taking.map_size, size, size.to_string());
                    }
                });
            ui.horizontal(|ui| {
                if ui
                    .button("Height and normals")
                    .on_hover_text("16-bit PNG, with the command that bakes them again")
                    .clicked()
                {
                    wanted = Some((Kind::Maps, format!("{stem}-maps")));
                }
                if ui
                    .button("Paint")
                    .on_hover_text("painted layers as PNG, the bias as JSON")
                    .clicked()
                {
                    wanted = Some((Kind::Paint, format!("{stem}-paint")));
                }
            });
            ui.heading("Field and scene");
            if ui.button("Wrinkle field (JSON)").clicked() {
                wanted = Some((Kind::Field, format!("{stem}-field.json")));
            }
            let scene = self.document.subject.scene.is_some();
            let tip =
                "scene.toml, the files it names, and what plisse solve makes of them, to the bit";
            if ui
                .add_enabled(scene, Button::new("Scene and its files"))
                .on_hover_text(tip)
                .clicked()
            {
                wanted = Some((Kind::SceneFiles, format!("{stem}-solved")));
            }
        });
        if let Some((kind, name)) = wanted {
            let beside = match &self.document.subject.source {
                crate::document::Source::File(path) => path.with_file_name(name),
                crate::document::Source::Own(_) => PathBuf::from(name),
            };
            self.browser = Some(Browser::take(kind, &beside));
        }
        if ui.button("Picture (PNG)").on_hover_text("as it is seen, beside the model").clicked() {
            let path = PathBuf::from(format!("{stem}-picture.png"));
            self.take_picture(&path);
        }
        if let Some(job) = &self.taking.job {
            ui.add_space(6.0);
            let progress = job.progress();
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label(progress.stage);
                if ui.button("Stop").clicked() {
                    job.cancel();
                }
            });
        }
        if !self.taking.written.is_empty() {
            ui.add_space(6.0);
            ui.label("Written last:");
            for path in &self.taking.written {
                ui.add(egui::Label::new(path.display().to_string()).truncate());
            }
        }
    }
}
