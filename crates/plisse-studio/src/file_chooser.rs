//! The file chooser: a window of the program's own, so that it is the same on every system and
//! tests can use it.

use std::path::{Path, PathBuf};

use egui::{Align2, ScrollArea, TextEdit, Ui, Window, vec2};
use plisse::io::disk;

use crate::open::EXTENSIONS;
use crate::work::export::Kind;

/// The purpose of the chosen file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// It is opened.
    Open,
    /// The document is saved there.
    Save,
    /// Files of this kind are exported there.
    Export(Kind),
}

/// A file or folder in the list.
#[derive(Clone, Debug)]
struct Entry {
    name: String,
    is_folder: bool,
}

/// The clicks of one frame.
#[derive(Default)]
struct Clicks {
    /// The folder to enter.
    folder: Option<PathBuf>,
    is_chosen: bool,
    is_cancelled: bool,
}

/// The answer of the file chooser.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// None yet: the window stays open.
    Open,
    /// No file: the window was closed.
    Cancelled,
    /// This file.
    File(PathBuf),
}

/// The window of the file chooser.
#[derive(Clone, Debug)]
pub struct FileChooser {
    /// The purpose of the chosen file.
    pub purpose: Purpose,
    folder: PathBuf,
    /// Content of the name field.
    name: String,
    entries: Vec<Entry>,
    problem: Option<String>,
    /// An existing file that was chosen once: a second time replaces it.
    replaces: Option<PathBuf>,
}

impl FileChooser {
    /// A chooser of a file to open, at first in `folder`.
    pub fn open(folder: Option<&Path>) -> Self {
        let here = std::env::current_dir().unwrap_or_else(|_| PathBuf::from("."));
        Self::new(Purpose::Open, folder.map_or(here, Path::to_path_buf), String::new())
    }

    /// A chooser of the document's path, at first `path`.
    pub fn save(path: &Path) -> Self {
        Self::at(Purpose::Save, path)
    }

    /// A chooser of the path of an export, at first `path`.
    pub fn export(kind: Kind, path: &Path) -> Self {
        Self::at(Purpose::Export(kind), path)
    }

    fn at(purpose: Purpose, path: &Path) -> Self {
        let whole = disk::whole(path);
        let name = whole.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        Self::new(purpose, whole.parent().unwrap_or(Path::new("/")).to_path_buf(), name)
    }

    fn new(purpose: Purpose, folder: PathBuf, name: String) -> Self {
        let mut chooser =
            Self { purpose, folder, name, entries: Vec::new(), problem: None, replaces: None };
        chooser.list();
        chooser
    }

    fn list(&mut self) {
        let is_known =
            |name: &str| EXTENSIONS.iter().any(|e| name.to_lowercase().ends_with(&format!(".{e}")));
        self.entries.clear();
        match disk::list(&self.folder) {
            Ok(list) => {
                self.entries = list
                    .into_iter()
                    .map(|(name, is_folder)| Entry { name, is_folder })
                    .filter(|e| !e.name.starts_with('.') && (e.is_folder || is_known(&e.name)))
                    .collect();
                self.problem = None;
            }
            Err(error) => {
                self.problem = Some(format!(
                    "{} cannot be read ({error}); choose another folder",
                    self.folder.display()
                ))
            }
        }
        self.entries.sort_by(|a, b| {
            b.is_folder
                .cmp(&a.is_folder)
                .then_with(|| a.name.to_lowercase().cmp(&b.name.to_lowercase()))
        });
    }

    fn enter(&mut self, folder: PathBuf) {
        self.folder = folder;
        self.list();
    }

    /// Title of the window, and text of its button.
    fn texts(&self) -> [&'static str; 2] {
        match self.purpose {
            Purpose::Open => ["Open a model, a scene or a document", "Open"],
            Purpose::Save => ["Save as", "Save"],
            Purpose::Export(_) => ["Export", "Write"],
        }
    }

    /// Shows the window; [`Choice::File`] once a file was chosen.
    pub fn show(&mut self, ctx: &egui::Context) -> Choice {
        let [title, verb] = self.texts();
        let mut clicks = Clicks::default();
        Window::new(title)
            .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
            .collapsible(false)
            .resizable(false)
            .show(ctx, |ui| {
                ui.set_width(460.0);
                self.folder_row(ui, &mut clicks);
                self.list_rows(ui, &mut clicks);
                #[cfg(target_arch = "wasm32")]
                if self.purpose == Purpose::Open
                    && ui
                        .button("From this computer…")
                        .on_hover_text("choose a scene with its files")
                        .clicked()
                {
                    crate::page::files::choose();
                }
                ui.horizontal(|ui| {
                    let label = ui.label("File:");
                    let field = ui
                        .add(TextEdit::singleline(&mut self.name).desired_width(400.0))
                        .labelled_by(label.id);
                    clicks.is_chosen |=
                        field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
                });
                if let Some(problem) = &self.problem {
                    ui.colored_label(ui.visuals().error_fg_color, problem);
                }
                ui.horizontal(|ui| {
                    clicks.is_chosen |= ui.button(verb).clicked();
                    clicks.is_cancelled = ui.button("Cancel").clicked()
                        || ui.input(|i| i.key_pressed(egui::Key::Escape));
                });
            });
        if let Some(folder) = clicks.folder.take() {
            self.enter(folder);
        }
        self.choice(&clicks)
    }

    fn folder_row(&self, ui: &mut Ui, clicks: &mut Clicks) {
        ui.horizontal(|ui| {
            if ui.button("Up").on_hover_text("the parent folder").clicked() {
                clicks.folder = self.folder.parent().map(Path::to_path_buf);
            }
            ui.add(egui::Label::new(self.folder.display().to_string()).truncate());
        });
    }

    fn list_rows(&mut self, ui: &mut Ui, clicks: &mut Clicks) {
        let rows = ScrollArea::vertical()
            .max_height(260.0)
            .min_scrolled_height(260.0)
            .auto_shrink([false, false]);
        rows.show(ui, |ui| {
            for Entry { name, is_folder } in &self.entries {
                let text = if *is_folder { format!("{name}/") } else { name.clone() };
                let response = ui.selectable_label(!is_folder && self.name == *name, text);
                if response.clicked() && *is_folder {
                    clicks.folder = Some(self.folder.join(name));
                } else if response.clicked() {
                    self.name = name.clone();
                }
                clicks.is_chosen |= response.double_clicked() && !is_folder;
            }
        });
    }

    /// The choice that the clicks of this frame make.
    fn choice(&mut self, clicks: &Clicks) -> Choice {
        let name = self.name.trim().to_owned();
        if !clicks.is_chosen || name.is_empty() {
            return if clicks.is_cancelled { Choice::Cancelled } else { Choice::Open };
        }
        let path = self.folder.join(&name);
        let is_folder = self.entries.iter().any(|e| e.is_folder && e.name == name);
        if self.purpose == Purpose::Open && is_folder {
            self.name.clear();
            self.enter(path);
        } else if self.purpose != Purpose::Open
            && disk::has(&path)
            && self.replaces.as_ref() != Some(&path)
        {
            // A folder may be there, too: an export replaces files of the same names only.
            let [_, verb] = self.texts();
            self.problem = Some(format!(
                "{} exists already; choose {verb} again to replace it",
                path.display()
            ));
            self.replaces = Some(path);
        } else {
            return Choice::File(path);
        }
        if clicks.is_cancelled { Choice::Cancelled } else { Choice::Open }
    }
}
