//! The program: its state, its commands, and one frame of its window. No frame takes long: pictures
//! come from the render thread, and long work is done by jobs.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use egui::{CentralPanel, Panel, ScrollArea, Ui};
use plisse::io::disk;
use plisse::io::staged::OutputFolder;
use plisse_live::Vec2;

use crate::commands::Command;
use crate::document::{Action, Document, Layer, Subject};
use crate::file_chooser::{Choice, FileChooser, Purpose};
use crate::guard::Leftover;
use crate::jobs::Jobs;
use crate::jobs::reading::{Content, Purpose as ReadPurpose, ReadFile};
use crate::open;
use crate::panels::canvas::{self, Picture};
use crate::panels::{export, grow, live, menu, paint, physics, questions};
use crate::session::Session;
use crate::shell::{Question, RequestRepaint, Shell, Tab};
use crate::tools::Tools;
use crate::view::{Graphics, View};
use crate::viewport::{PaintRevision, ShownSurface, Viewport};
use crate::work::export::Kind;

/// Width of the panel on the left (points).
const WIDTH: f32 = 312.0;
/// Time to the next frame of the window while something moves.
const SOON: Duration = Duration::from_millis(8);
/// Time to the next frame of the window while nothing moves: files are watched.
const LATER: Duration = Duration::from_secs(2);

/// The start of the program.
pub struct Start {
    /// The device that may draw.
    pub graphics: Graphics,
    /// Folder of the autosaves; `None`: there are none.
    pub autosave_folder: Option<PathBuf>,
    /// Requests another frame of the window.
    pub request_repaint: RequestRepaint,
}

/// The program.
pub struct Studio {
    /// The document and its file.
    pub session: Session,
    /// The picture.
    pub viewport: Viewport,
    /// The brush.
    pub tools: Tools,
    /// Long work in the background.
    pub jobs: Jobs,
    /// The window around the document.
    pub shell: Shell,
    /// Time of the last frame of the window (s).
    last_s: Option<f64>,
}

impl Studio {
    /// The program with the built-in curtain.
    ///
    /// # Errors
    /// None in practice (of the model).
    pub fn new(start: Start) -> plisse::Result<Self> {
        let document = Document::new(Subject::own("curtain")?);
        let request_repaint = Arc::clone(&start.request_repaint);
        let mut studio = Self {
            viewport: Viewport::new(start.graphics, request_repaint, &document),
            tools: Tools::new(&document.subject),
            jobs: Jobs::default(),
            shell: Shell::new(start.autosave_folder, start.request_repaint),
            session: Session::new(document.clone(), None),
            last_s: None,
        };
        studio.show(document, None);
        Ok(studio)
    }

    /// Replaces the open document; `path` is that of its file.
    pub fn show(&mut self, document: Document, path: Option<PathBuf>) {
        self.jobs.stop();
        self.viewport.reset(&document, &mut self.shell.messages);
        self.tools.reset(&document.subject, self.session.document.settings.fold_spacing_m);
        let notes = &document.subject.notes;
        notes.iter().for_each(|note| self.shell.messages.note(note.clone()));
        if document.subject.scene.is_some() && self.shell.tab == Tab::Live {
            self.shell.tab = Tab::Physics;
        }
        self.session = Session::new(document, path);
        self.shell.guard.watch(&self.session.document);
    }

    /// Saves the document to `path`.
    pub fn save(&mut self, path: &Path) {
        match open::save(&self.session.document, path) {
            Ok(()) => {
                self.session.mark_saved(path);
                self.shell.guard.clear();
                self.shell.messages.note(format!("saved {}", path.display()));
            }
            Err(error) => self
                .shell
                .messages
                .problem(format!("{error}; your work is still here, save it elsewhere")),
        }
    }

    /// Opens the file `path` in the background. An error becomes a message, and the open document
    /// stays.
    pub fn open(&mut self, path: &Path) {
        self.shell.messages.note(format!("opening {}", path.display()));
        self.read(ReadPurpose::Open(path.to_path_buf()));
    }

    /// Opens `path`, after a question if something is not saved.
    pub fn ask_to_open(&mut self, path: PathBuf) {
        if self.session.is_unsaved() {
            self.shell.question = Some(Question::Open(path));
        } else {
            self.open(&path);
        }
    }

    /// Opens a built-in model.
    pub fn show_own(&mut self, name: &str) {
        match Subject::own(name) {
            Ok(subject) => self.show(Document::new(subject), None),
            Err(error) => self.shell.messages.problem(error),
        }
    }

    fn read(&mut self, purpose: ReadPurpose) {
        self.jobs.reading.start(purpose, &self.shell.request_repaint);
    }

    /// Chooses the layer that the brush paints on, with a suitable value.
    pub fn choose_layer(&mut self, layer: Layer) {
        self.tools.choose_layer(layer, self.session.document.settings.fold_spacing_m);
        self.viewport.follow_layer(layer);
    }

    /// Switches folding under the brush on or off.
    pub fn fold_under_brush(&mut self, on: bool) {
        if !on {
            self.jobs.growth.stop_folding();
            return;
        }
        let painted = self.paint_revision();
        let document = &self.session.document;
        self.jobs.growth.start_folding(document, painted, &self.shell.request_repaint);
        if self.tools.brush.layer != Layer::Expansion {
            self.choose_layer(Layer::Expansion);
        }
    }

    /// Exports `kind` of the shown surface to `path` in the background.
    pub fn export_files(&mut self, kind: Kind, path: &Path) {
        let source = self.jobs.source(self.viewport.shown, &self.session.document);
        self.jobs.export.start(kind, source, path, &mut self.shell);
    }

    /// Writes the picture as it is seen to `path`.
    pub fn export_picture(&mut self, path: &Path) {
        let Some(frame) = &self.viewport.frame else { return };
        if frame.texture.is_some() {
            // The pixels are not in memory: the next picture is rendered there.
            self.viewport.picture_path = Some(path.to_path_buf());
            (self.shell.request_repaint)();
            return;
        }
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default().to_owned();
        let written =
            OutputFolder::create(path.parent().unwrap_or(Path::new("."))).and_then(|mut folder| {
                folder.write(&name, |out| plisse::picture::write_png(&frame.image, out))?;
                folder.commit()
            });
        let messages = &mut self.shell.messages;
        match written {
            Ok(_) => messages.note(format!("wrote {}", path.display())),
            Err(error) => messages.problem(format!("{error}; your work is still here")),
        }
    }

    /// Begins a stroke, or continues the current one, at `pointer` (shares of the picture's width
    /// and height).
    pub fn stroke(&mut self, pointer: Vec2) {
        self.picture().stroke(pointer);
    }

    /// Releases the stroke: it ends once it is painted, which may take some frames.
    pub fn release_stroke(&mut self) {
        self.tools.release_stroke();
    }

    /// Ends the stroke, if there is one, and paints all of it.
    pub fn end_stroke(&mut self) {
        self.picture().end_stroke();
    }

    fn picture(&mut self) -> Picture<'_> {
        let tab = self.shell.tab;
        let paints = tab == Tab::Paint || tab == Tab::Grow && self.jobs.growth.follows();
        Picture {
            document: &mut self.session.document,
            viewport: &mut self.viewport,
            tools: &mut self.tools,
            messages: &mut self.shell.messages,
            paints,
        }
    }

    fn paint_revision(&self) -> PaintRevision {
        PaintRevision { revision: self.session.document.revision, dabs: self.tools.dabs }
    }

    /// Runs a command.
    pub fn run(&mut self, command: Command) {
        let document = &self.session.document;
        let brush = &mut self.tools.brush;
        match command {
            Command::Open => {
                let folder = self.session.path.as_deref().and_then(Path::parent);
                self.shell.file_chooser = Some(FileChooser::open(folder));
            }
            Command::Save => match self.session.path.clone() {
                Some(path) => self.save(&path),
                None => self.run(Command::SaveAs),
            },
            Command::SaveAs => {
                let path = open::usual_path(&document.subject.source);
                self.shell.file_chooser = Some(FileChooser::save(&path));
            }
            Command::Quit if self.session.is_unsaved() => {
                self.shell.question = Some(Question::Quit);
            }
            Command::Quit => self.shell.quits = true,
            Command::Undo => self.history(Document::undo, "nothing to undo"),
            Command::Redo => self.history(Document::redo, "nothing to redo"),
            Command::Play => {
                self.viewport.playing = !self.viewport.playing && document.settings.clip.is_some();
            }
            Command::Frame => self.viewport.fit(document),
            Command::SmallerBrush => brush.radius_m /= 1.2,
            Command::LargerBrush => brush.radius_m *= 1.2,
            Command::Erase => {
                brush.action =
                    if brush.action == Action::Paint { Action::Erase } else { Action::Paint };
            }
            Command::View(n) => self.viewport.view = View::MAIN[usize::from(n) % View::MAIN.len()],
            Command::OpenModel(name) if self.session.is_unsaved() => {
                self.shell.question = Some(Question::OpenModel(name));
            }
            Command::OpenModel(name) => self.show_own(&name),
            Command::Recover(leftover) => self.read(ReadPurpose::Recover(leftover)),
            Command::ChooseLayer(layer) => self.choose_layer(layer),
            job => self.run_job(job),
        }
    }

    /// Runs a command of the jobs.
    fn run_job(&mut self, command: Command) {
        let (document, shell) = (&self.session.document, &mut self.shell);
        match command {
            Command::Solve => self.jobs.physics.solve_or_stop(document, shell),
            Command::SolveFromStart => self.jobs.physics.solve_from_start(document, shell),
            Command::EditScene(edit) => self.jobs.physics.edit_scene(document, &edit, shell),
            Command::Grow => self.jobs.growth.grow_or_stop(document, &shell.request_repaint),
            Command::FoldUnderBrush(on) => self.fold_under_brush(on),
            Command::Export(kind, path) => {
                shell.file_chooser = Some(FileChooser::export(kind, &path));
            }
            Command::ExportPicture(path) => self.export_picture(&path),
            Command::StopExport => self.jobs.export.stop(),
            _ => {}
        }
    }

    fn history(&mut self, step: impl FnOnce(&mut Document) -> bool, nothing: &str) {
        // The current stroke is ended first, so that it is what is undone.
        self.end_stroke();
        if step(&mut self.session.document) {
            self.viewport.unsettle();
        } else {
            self.shell.messages.note(nothing);
        }
    }

    /// One frame of the window.
    pub fn ui(&mut self, ui: &mut Ui) {
        let begun = web_time::Instant::now();
        let ctx = ui.ctx().clone();
        let now_s = ctx.input(|i| i.time);
        self.take_dropped(&ctx);
        self.run_all(Command::pressed(&ctx));
        let mut commands =
            Panel::top("menu").show(ui, |ui| menu::bar(ui, &self.session, &mut self.shell)).inner;
        Panel::bottom("status").show(ui, |ui| {
            menu::status(ui, &self.session.document, &self.viewport, &self.shell);
        });
        commands.extend(
            Panel::left("tools")
                .exact_size(WIDTH)
                .resizable(false)
                .show(ui, |ui| self.tabs(ui))
                .inner,
        );
        self.run_all(commands);
        let plain = egui::Frame::NONE.fill(ui.visuals().panel_fill);
        CentralPanel::default().frame(plain).show(ui, |ui| {
            self.views(ui);
            self.picture().show(ui);
        });
        if let Some(question) = questions::show(&ctx, &mut self.shell) {
            self.answered(question);
        }
        self.choose_file(&ctx);
        self.advance(&ctx, now_s);
        let ms = begun.elapsed().as_secs_f32() * 1e3;
        let mean = &mut self.shell.frame_ms;
        *mean = if *mean == 0.0 { ms } else { 0.9 * *mean + 0.1 * ms };
    }

    fn run_all(&mut self, commands: Vec<Command>) {
        commands.into_iter().for_each(|command| self.run(command));
    }

    fn take_dropped(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|i| i.raw.dropped_files.clone());
        #[cfg(target_arch = "wasm32")]
        if !dropped.is_empty() {
            crate::page::files::read_dropped(dropped);
        }
        #[cfg(not(target_arch = "wasm32"))]
        for file in dropped {
            self.ask_to_open(file.path().to_path_buf());
        }
    }

    /// Shows the tabs and the panel of the open one; the commands that were chosen.
    fn tabs(&mut self, ui: &mut Ui) -> Vec<Command> {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            for tab in Tab::ALL {
                ui.selectable_value(&mut self.shell.tab, tab, tab.name());
            }
        });
        ui.separator();
        let document = &mut self.session.document;
        let (jobs, viewport) = (&mut self.jobs, &mut self.viewport);
        let brush = &mut self.tools.brush;
        let tab = self.shell.tab;
        let panel = |ui: &mut Ui| match tab {
            Tab::Live => {
                live::panel(ui, document, viewport);
                Vec::new()
            }
            Tab::Paint => paint::panel(ui, document, brush, &mut viewport.view),
            Tab::Physics => physics::panel(ui, document, &mut jobs.physics),
            Tab::Grow => grow::panel(ui, document, &jobs.growth, brush, &mut viewport.view),
            Tab::Export => {
                let exported = jobs.exported(viewport.shown);
                export::panel(ui, document, &mut jobs.export, exported)
            }
        };
        ScrollArea::vertical().auto_shrink([false, true]).show(ui, panel).inner
    }

    fn views(&mut self, ui: &mut Ui) {
        let layer = self.tools.brush.layer;
        let shows_paint = self.shell.tab == Tab::Paint && layer != Layer::Expansion;
        let others: Vec<ShownSurface> = [ShownSurface::Solved, ShownSurface::Grown]
            .into_iter()
            .filter(|&surface| self.jobs.solid(surface).is_some())
            .collect();
        canvas::views(ui, &mut self.viewport, shows_paint.then_some(layer), &others);
    }

    /// Does what a question was about, after the answer yes.
    fn answered(&mut self, question: Question) {
        match question {
            Question::Open(path) => self.open(&path),
            Question::OpenModel(name) => self.show_own(&name),
            Question::Quit => self.shell.quits = true,
            Question::Reload(path) => self.read(ReadPurpose::Reload(path)),
            Question::Recover(leftover) => self.read(ReadPurpose::Recover(leftover)),
        }
    }

    /// Shows the file chooser, and uses the file that was chosen.
    fn choose_file(&mut self, ctx: &egui::Context) {
        let Some(mut chooser) = self.shell.file_chooser.take() else { return };
        match chooser.show(ctx) {
            Choice::Open => self.shell.file_chooser = Some(chooser),
            Choice::Cancelled => {}
            Choice::File(path) => match chooser.purpose {
                Purpose::Open => self.ask_to_open(path),
                Purpose::Save => self.save(&path),
                Purpose::Export(kind) => self.export_files(kind, &path),
            },
        }
    }

    /// Advances everything that goes on by itself: time, pictures, jobs, files.
    fn advance(&mut self, ctx: &egui::Context, now_s: f64) {
        let passed_s = self.last_s.map_or(0.0, |last_s| (now_s - last_s).clamp(0.0, 0.2));
        self.last_s = Some(now_s);
        if self.viewport.take_frame(ctx, &mut self.shell.messages) {
            if let Some(path) = self.viewport.picture_path.take() {
                self.export_picture(&path);
            }
            self.viewport.settle();
        }
        self.take_jobs();
        self.picture().paint_waiting();
        self.follow_brush();
        self.viewport.play(&mut self.session.document, passed_s as f32);
        if let Some(path) = self.shell.guard.changed_file(now_s) {
            self.shell.question = Some(Question::Reload(path));
        }
        if let Err(error) = self.shell.guard.autosave(&self.session.document, now_s) {
            self.shell.messages.problem(format!("the autosave failed: {error}"));
        }
        let solid = self.jobs.solid(self.viewport.shown);
        let (painted, paints) = (self.paint_revision(), self.tools.trail.is_some());
        self.viewport.request(&self.session.document, solid, painted, paints);
        let moves = self.viewport.is_animated() || paints;
        ctx.request_repaint_after(if moves { SOON } else { LATER });
    }

    /// Takes what the jobs have computed.
    fn take_jobs(&mut self) {
        let (jobs, viewport, shell) = (&mut self.jobs, &mut self.viewport, &mut self.shell);
        jobs.physics.take_draft(&mut self.session.document, shell);
        jobs.physics.take_solve(viewport, &mut shell.messages);
        jobs.growth.take_growth(viewport, &mut shell.messages);
        jobs.export.take(&mut shell.messages);
        if let Some(file) = jobs.reading.take() {
            self.take_file(file);
        }
    }

    /// Sends new paint to the folding under the brush, and takes what has folded.
    fn follow_brush(&mut self) {
        if self.jobs.growth.has_other_widths(&self.session.document) {
            self.fold_under_brush(true);
        }
        let (painted, document) = (self.paint_revision(), &self.session.document);
        let strokes = document.history.done().len() + usize::from(self.tools.trail.is_some());
        self.jobs.growth.send_paint(document, painted, strokes);
        self.jobs.growth.take_fold(&mut self.viewport, &mut self.shell.messages);
    }

    /// Takes a file that was read.
    fn take_file(&mut self, file: ReadFile) {
        match (file.result, file.purpose) {
            (Ok(Content::Document(document)), ReadPurpose::Open(path)) => {
                let is_document = path.to_string_lossy().ends_with(open::DOCUMENT_END);
                self.show(*document, is_document.then(|| path.clone()));
                self.shell.messages.note(format!("opened {}", path.display()));
            }
            (Ok(Content::Document(document)), ReadPurpose::Recover(leftover)) => {
                self.recovered(*document, &leftover);
            }
            (Ok(Content::Subject(subject)), ReadPurpose::Reload(path)) => {
                self.reloaded(*subject, &path);
            }
            (Ok(_), _) => {}
            (Err(error), ReadPurpose::Reload(_)) => {
                self.shell.messages.problem(format!("{error}; the open document stays"));
            }
            (Err(error), _) => self.shell.messages.problem(error),
        }
    }

    /// Takes a file that was read again; paint is kept if the mesh is the same.
    fn reloaded(&mut self, subject: Subject, path: &Path) {
        let document = &self.session.document;
        let (old, new) = (&document.subject.welded, &subject.welded);
        let same = new.count() == old.count() && new.faces == old.faces;
        let mut fresh = Document::new(subject);
        if same {
            fresh.layers = document.layers.clone();
            fresh.history = document.history.clone();
            fresh.settings = document.settings.clone();
            fresh.revision = document.revision + 1;
            let path = self.session.path.clone();
            self.show(fresh, path);
            self.shell.messages.note("read again; your paint is kept");
        } else if document.history.done().is_empty() {
            self.show(fresh, None);
            self.shell.messages.note("read again");
        } else {
            self.shell.messages.problem(format!(
                "{}: its mesh has changed, and your paint does not fit it; save your work, then \
                 open the file anew",
                path.display()
            ));
        }
    }

    /// Takes a recovered autosave, which is in no file of the user's yet.
    fn recovered(&mut self, mut document: Document, leftover: &Leftover) {
        document.revision = 1;
        self.show(document, None);
        self.session.mark_unsaved();
        match self.shell.guard.keep(&self.session.document) {
            Ok(()) => {
                let _ = disk::remove(&leftover.path);
                self.shell.leftovers.retain(|l| l != leftover);
                self.shell.messages.note(format!("recovered {}; save it", leftover.name));
            }
            Err(error) => self.shell.messages.problem(error),
        }
    }

    /// True if nothing is on its way: no picture, no stroke, no job.
    pub fn is_idle(&self) -> bool {
        !self.viewport.is_busy() && self.tools.trail.is_none() && !self.jobs.is_busy()
    }

    /// Ends the program without leaving an autosave behind.
    pub fn close(&mut self) {
        self.shell.guard.clear();
    }
}
