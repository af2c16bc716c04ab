//! The window in which files are chosen; drawn here, so that it is the same everywhere and tests
//! can use it.

use std::path::{Path, PathBuf};

use egui::{Align2, ScrollArea, TextEdit, Window, vec2};
use plisse::io::disk;

use crate::open::EXTENSIONS;
use crate::work::export::Kind;

/// What the file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// It is opened.
    Open,
    /// The document goes there.
    Save,
    /// This goes there.
    Take(Kind),
}

/// The window.
#[derive(Clone, Debug)]
pub struct Browser {
    /// What the file is for.
    pub purpose: Purpose,
    folder: PathBuf,
    /// What stands in the field.
    name: String,
    entries: Vec<(String, bool)>,
    problem: Option<String>,
    /// A file that is there already and was chosen once.
    sure: Option<PathBuf>,
}

impl Browser {
    /// Chooses a file to open, at first in `folder`.
    pub fn open(folder: Option<&Path>) -> Self {
        let here = std::env::current_dir().unwrap_or_else(|_| PathBuf::from("."));
        Self::new(Purpose::Open, folder.map_or(here, Path::to_path_buf), String::new())
    }

    /// Chooses where the document goes, at first `path`.
    pub fn save(path: &Path) -> Self {
        Self::at(Purpose::Save, path)
    }

    /// Chooses where `kind` goes, at first `path`.
    pub fn take(kind: Kind, path: &Path) -> Self {
        Self::at(Purpose::Take(kind), path)
    }

    fn at(purpose: Purpose, path: &Path) -> Self {
        let whole = disk::whole(path);
        let name = whole.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        Self::new(purpose, whole.parent().unwrap_or(Path::new("/")).to_path_buf(), name)
    }

    fn new(purpose: Purpose, folder: PathBuf, name: String) -> Self {
        let mut browser =
            Self { purpose, folder, name, entries: Vec::new(), problem: None, sure: None };
        browser.list();
        browser
    }

    fn list(&mut self) {
        let mut entries = Vec::new();
        match disk::list(&self.folder) {
            Ok(list) => {
                for (name, is_folder) in list {
                    let known =
                        EXTENSIONS.iter().any(|e| name.to_lowercase().ends_with(&format!(".{e}")));
                    if !name.starts_with('.') && (is_folder || known) {
                        entries.push((name, is_folder));
                    }
                }
                self.problem = None;
            }
            Err(error) => {
                self.problem = Some(format!(
                    "{} cannot be read ({error}); choose another folder",
                    self.folder.display()
                ))
            }
        }
        entries.sort_by(|a, b| {
            b.1.cmp(&a.1).then_with(|| a.0.to_lowercase().cmp(&b.0.to_lowercase()))
        });
        self.entries = entries;
    }

    fn go(&mut self, folder: PathBuf) {
        self.folder = folder;
        self.list();
    }

    /// Shows it; `Some(None)` when it was closed, `Some(path)` when a file was chosen.
    pub fn show(&mut self, ctx: &egui::Context) -> Option<Option<PathBuf>> {
        let (title, verb) = match self.purpose {
            Purpose::Open => ("Open a model, a scene or a document", "Open"),
            Purpose::Save => ("Save as", "Save"),
            Purpose::Take(_) => ("Take away", "Write"),
        };
        let (mut result, mut chosen, mut go) = (None, false, None);
        Window::new(title)
            .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
            .collapsible(false)
            .resizable(false)
            .show(ctx, |ui| {
                ui.set_width(460.0);
                ui.horizontal(|ui| {
                    if ui.button("Up").on_hover_text("the folder around this one").clicked() {
                        go = self.folder.parent().map(Path::to_path_buf);
                    }
                    ui.add(egui::Label::new(self.folder.display().to_string()).truncate());
                });
                ScrollArea::vertical()
                    .max_height(260.0)
                    .min_scrolled_height(260.0)
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        for (name, is_folder) in &self.entries {
                            let text = if *is_folder { format!("{name}/") } else { name.clone() };
                            let response =
                                ui.selectable_label(!is_folder && self.name == *name, text);
                            if response.clicked() && *is_folder {
                                go = Some(self.folder.join(name));
                            } else if response.clicked() {
                                self.name = name.clone();
                            }
                            chosen |= response.double_clicked() && !is_folder;
                        }
                    });
                #[cfg(target_arch = "wasm32")]
                if self.purpose == Purpose::Open
                    && ui
                        .button("From this computer…")
                        .on_hover_text("choose a scene with its files")
                        .clicked()
                {
                    crate::page::choose();
                }
                ui.horizontal(|ui| {
                    let label = ui.label("File:");
                    let field = ui
                        .add(TextEdit::singleline(&mut self.name).desired_width(400.0))
                        .labelled_by(label.id);
                    chosen |= field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
                });
                if let Some(problem) = &self.problem {
                    ui.colored_label(ui.visuals().error_fg_color, problem);
                }
                ui.horizontal(|ui| {
                    chosen |= ui.button(verb).clicked();
                    if ui.button("Cancel").clicked()
                        || ui.input(|i| i.key_pressed(egui::Key::Escape))
                    {
                        result = Some(None);
                    }
                });
            });
        if let Some(folder) = go {
            self.go(folder);
        }
        if chosen && !self.name.trim().is_empty() {
            let path = self.folder.join(self.name.trim());
            // A folder may be there: what goes into it replaces files of the same names only.
            if self.purpose == Purpose::Open
                && self.entries.contains(&(self.name.trim().to_owned(), true))
            {
                self.name.clear();
                self.go(path);
            } else if self.purpose != Purpose::Open
                && disk::has(&path)
                && self.sure.as_ref() != Some(&path)
            {
                self.problem = Some(format!(
                    "{} is there already; choose {verb} again to replace it",
                    path.display()
                ));
                self.sure = Some(path);
            } else {
                result = Some(Some(path));
            }
        }
        result
    }
}
