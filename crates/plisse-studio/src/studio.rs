//! The program's state and what it does with it. [`Studio::ui`] is one frame of the window; nothing
//! in it takes long: what does is done by the [`Easel`]'s thread or by jobs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{ColorImage, TextureHandle, TextureOptions};
use plisse_live::Vec3;
use plisse_live::live::LiveOptions;
use plisse_live::texture::Texture;

use crate::brush::{Surface, Trail};
use crate::commands::Command;
use crate::document::{Action, Brush, Document, Layer, Settings, Subject};
use crate::guard::{Guard, Left};
use crate::messages::Messages;
use crate::open;
use crate::panels::browser::Browser;
use crate::panels::grow::Growth;
use crate::panels::physics::Physics;
use crate::panels::take::Taking;
use crate::reading::Reading;
use crate::view::easel::texture_of;
use crate::view::{Easel, Graphics, Order, Sheet, Shown, Turntable, View};

/// Pictures after a change until the phases have settled, and steps of the stages in each.
pub(crate) const SETTLE: usize = 5;
const SETTLE_STEPS: usize = 8;
/// A picture that took longer (ms) is drawn at half the size while things move.
const SLOW_MS: f32 = 45.0;

/// Calls for another frame of the window, from any thread.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// The panel on the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tab {
    /// Clips and how wrinkles are made.
    Live,
    /// The brush.
    Paint,
    /// Material, clamps, solve.
    Physics,
    /// Growth.
    Grow,
    /// Files out.
    TakeAway,
}

impl Tab {
    /// All, in their order.
    pub const ALL: [Self; 5] = [Self::Live, Self::Paint, Self::Physics, Self::Grow, Self::TakeAway];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Live => "Live",
            Self::Paint => "Paint",
            Self::Physics => "Physics",
            Self::Grow => "Grow",
            Self::TakeAway => "Take away",
        }
    }
}

/// Which surface is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looking {
    /// The model with its live waves.
    Live,
    /// The solved scene.
    Solved,
    /// What has grown.
    Grown,
}

/// How the program begins.
pub struct Start {
    /// What may draw.
    pub graphics: Graphics,
    /// Where autosaves lie; none: nowhere.
    pub keep: Option<PathBuf>,
    /// Calls for another frame.
    pub wake: Wake,
}

/// The program.
pub struct Studio {
    /// What is worked on.
    pub document: Document,
    /// Where it is saved.
    pub path: Option<PathBuf>,
    pub(crate) saved_revision: u64,
    saved_settings: Settings,
    pub(crate) surface: Arc<Surface>,
    pub(crate) easel: Easel,
    /// The last picture.
    pub sheet: Option<Sheet>,
    pub(crate) picture: Option<TextureHandle>,
    /// The camera.
    pub table: Turntable,
    pub(crate) size: [usize; 2],
    pub(crate) moving: bool,
    /// What the picture shows.
    pub view: View,
    /// Which surface it shows.
    pub looking: Looking,
    /// The panel on the left.
    pub tab: Tab,
    /// The brush.
    pub brush: Brush,
    /// The stroke on its way.
    pub trail: Option<Trail>,
    /// Whether the pointer has let go of it: it ends once it is painted.
    pub(crate) released: bool,
    /// Whether the clip plays.
    pub playing: bool,
    pub(crate) cached: Cached,
    pub(crate) texture: Arc<Texture>,
    /// Colour that the texture is multiplied with (sRGB).
    pub colour: [u8; 3],
    /// What the program has to say.
    pub messages: Messages,
    /// Solving scenes.
    pub physics: Physics,
    /// Growing.
    pub growth: Growth,
    /// Taking away.
    pub taking: Taking,
    pub(crate) reading: Reading,
    pub(crate) browser: Option<Browser>,
    pub(crate) asks: Option<Question>,
    pub(crate) guard: Guard,
    pub(crate) left: Vec<Left>,
    pub(crate) later: bool,
    pub(crate) settle: usize,
    pub(crate) lose_device: bool,
    /// Where the next picture is to be written.
    pub(crate) wanted: Option<PathBuf>,
    /// Whether to end.
    pub quits: bool,
    pub(crate) wake: Wake,
    last_s: Option<f64>,
    /// Milliseconds that the last frames of the window took.
    pub frame_ms: f32,
}

/// Something that needs an answer first.
#[derive(Clone, Debug, PartialEq)]
pub enum Question {
    /// The document is not saved; open this one all the same?
    Open(PathBuf),
    /// The document is not saved; open one of the program's own models all the same?
    Own(String),
    /// The document is not saved; quit all the same?
    Quit,
    /// A file changed on the disk; read it again?
    Reload(PathBuf),
}

/// What is made of the document and only made anew when it changes.
pub(crate) struct Cached {
    key: Option<(u64, u64, Settings)>,
    /// Counts what strokes on their way have painted.
    pub(crate) dabs: u64,
    options: Arc<LiveOptions>,
    layer_key: Option<(u64, u64, View)>,
    layer: Arc<Vec<[f32; 4]>>,
    ordered: Option<OrderKey>,
}

/// What decides whether a picture is still right.
type OrderKey =
    (Turntable, [usize; 2], View, Looking, f32, usize, usize, usize, [u8; 3], bool, Settings);

impl Studio {
    /// The program with its own curtain.
    ///
    /// # Errors
    /// None in practice (of the model).
    pub fn new(start: Start) -> plisse::Result<Self> {
        let document = Document::new(Subject::own("curtain")?);
        let wake = Arc::clone(&start.wake);
        let guard = Guard::new(start.keep);
        let left = guard.left();
        let mut studio = Self {
            surface: Arc::new(Surface::new(
                &document.subject.unified.faces,
                document.subject.unified.count(),
            )),
            easel: Easel::new(start.graphics, move || wake()),
            sheet: None,
            picture: None,
            table: Turntable::fit(&document.subject.unified.vertices.positions, 0.35, 0.1, 1.3),
            size: [640, 480],
            moving: false,
            view: View::Wrinkled,
            looking: Looking::Live,
            tab: Tab::Live,
            brush: Brush::new(0.1),
            trail: None,
            released: false,
            playing: true,
            cached: Cached {
                key: None,
                dabs: 0,
                options: Arc::new(LiveOptions::new(0.1)),
                layer_key: None,
                layer: Arc::new(Vec::new()),
                ordered: None,
            },
            texture: Arc::new(Texture::checked()),
            colour: [255; 3],
            messages: Messages::default(),
            physics: Physics::default(),
            growth: Growth::default(),
            taking: Taking::default(),
            reading: Reading::default(),
            browser: None,
            asks: None,
            left,
            later: false,
            guard,
            settle: SETTLE,
            lose_device: false,
            wanted: None,
            quits: false,
            wake: start.wake,
            last_s: None,
            frame_ms: 0.0,
            path: None,
            saved_revision: 0,
            saved_settings: document.settings.clone(),
            document,
        };
        let document = studio.document.clone();
        studio.show(document, None);
        Ok(studio)
    }

    /// Replaces what is worked on.
    pub fn show(&mut self, document: Document, path: Option<PathBuf>) {
        let subject = Arc::clone(&document.subject);
        self.physics.stop();
        self.growth.stop();
        self.surface = Arc::new(Surface::new(&subject.unified.faces, subject.unified.count()));
        let (texture, problem) = texture_of(&subject);
        self.texture = Arc::new(texture);
        if let Some(problem) = problem {
            self.messages.problem(problem);
        }
        subject.notes.iter().for_each(|note| self.messages.note(note.clone()));
        let layer = self.brush.layer;
        self.brush = Brush { radius_m: 0.12 * subject.size_m(), ..Brush::new(0.1) };
        self.choose_layer(layer);
        (self.saved_revision, self.path) = (document.revision, path);
        self.saved_settings = document.settings.clone();
        if matches!(self.view, View::Painted(_) | View::Expansion) {
            self.view = View::Wrinkled;
        }
        (self.trail, self.released) = (None, false);
        (self.looking, self.playing) = (Looking::Live, !subject.model.clips.is_empty());
        self.tab =
            if subject.scene.is_some() && self.tab == Tab::Live { Tab::Physics } else { self.tab };
        self.document = document;
        self.cached.key = None;
        self.cached.layer_key = None;
        self.sheet = None;
        self.settle = SETTLE;
        self.guard.watch(&self.document);
        self.fit();
    }

    /// Whether there is something that is not saved.
    pub fn is_unsaved(&self) -> bool {
        // Playing changes nothing that would have to be saved.
        let still = |s: &Settings| Settings { time_s: 0.0, clip: None, ..s.clone() };
        self.document.revision != self.saved_revision
            || still(&self.document.settings) != still(&self.saved_settings)
    }

    /// Saves to `path`.
    pub fn save(&mut self, path: &Path) {
        match open::save(&self.document, path) {
            Ok(()) => {
                (self.saved_revision, self.saved_settings) =
                    (self.document.revision, self.document.settings.clone());
                self.path = Some(path.to_path_buf());
                self.guard.clear();
                self.messages.note(format!("saved {}", path.display()));
            }
            Err(error) => self
                .messages
                .problem(format!("{error}; your work is still here, save it elsewhere")),
        }
    }

    /// Fits the camera.
    pub fn fit(&mut self) {
        let aspect = self.size[0] as f32 / self.size[1].max(1) as f32;
        let at: Vec<Vec3> = match (&self.sheet, self.looking) {
            (Some(sheet), _) => sheet.posed.positions.clone(),
            _ => {
                let subject = &self.document.subject;
                let clip = self
                    .document
                    .settings
                    .clip
                    .as_deref()
                    .and_then(|c| subject.model.clip(Some(c)));
                let pose =
                    plisse_live::skin::pose(&subject.model, clip, self.document.settings.time_s);
                plisse_live::skin::skin(&subject.unified.vertices, &pose).positions
            }
        };
        self.table = Turntable::fit(&at, self.table.yaw_rad, self.table.pitch_rad, aspect);
    }

    /// Chooses what the brush paints on, with a value that suits.
    pub fn choose_layer(&mut self, layer: Layer) {
        let value = match layer {
            Layer::Wrinkles => 0.7,
            Layer::Wavelength => 0.4,
            Layer::Expansion => 0.5,
            Layer::Coherence => 3.0 * self.document.settings.fold_spacing_m as f32,
            Layer::Freeze => 1.0,
        };
        self.brush = Brush { layer, value, ..self.brush.clone() };
        if let View::Painted(_) | View::Expansion = self.view {
            self.view =
                if layer == Layer::Expansion { View::Expansion } else { View::Painted(layer) };
        }
    }

    /// Does what a menu or a key asks.
    pub fn run(&mut self, command: Command) {
        match command {
            Command::Open => {
                self.browser = Some(Browser::open(self.path.as_deref().and_then(Path::parent)))
            }
            Command::Save => match self.path.clone() {
                Some(path) => self.save(&path),
                None => self.run(Command::SaveAs),
            },
            Command::SaveAs => {
                self.browser = Some(Browser::save(&open::usual_path(&self.document.subject.source)))
            }
            Command::Quit if self.is_unsaved() => self.asks = Some(Question::Quit),
            Command::Quit => self.quits = true,
            Command::Undo => self.history(Document::undo, "nothing to undo"),
            Command::Redo => self.history(Document::redo, "nothing to do again"),
            Command::Play => self.playing = !self.playing && self.document.settings.clip.is_some(),
            Command::Frame => self.fit(),
            Command::SmallerBrush => self.brush.radius_m /= 1.2,
            Command::LargerBrush => self.brush.radius_m *= 1.2,
            Command::Erase => {
                self.brush.action =
                    if self.brush.action == Action::Paint { Action::Erase } else { Action::Paint };
            }
            Command::Solve => self.solve_or_stop(),
            Command::View(n) => self.view = View::MAIN[usize::from(n) % View::MAIN.len()],
        }
    }

    fn history(&mut self, step: impl FnOnce(&mut Document) -> bool, nothing: &str) {
        // A stroke on its way is ended first, so that it is what is undone.
        self.end_stroke();
        if step(&mut self.document) {
            self.settle = SETTLE;
        } else {
            self.messages.note(nothing);
        }
    }

    /// Everything that goes on by itself: time, pictures, jobs, files.
    pub fn advance(&mut self, ctx: &egui::Context, now_s: f64) {
        let passed = self.last_s.map_or(0.0, |last| (now_s - last).clamp(0.0, 0.2));
        self.last_s = Some(now_s);
        self.take_sheet(ctx);
        self.take_jobs();
        self.paint();
        self.follow_brush();
        if self.playing && self.looking == Looking::Live {
            self.play(passed as f32);
        }
        if let Some(path) = self.guard.look(now_s) {
            self.asks = Some(Question::Reload(path));
        }
        if let Err(error) = self.guard.autosave(&self.document, now_s) {
            self.messages.problem(format!("the autosave failed: {error}"));
        }
        self.order();
        if self.playing || self.settle > 0 || self.trail.is_some() {
            ctx.request_repaint_after(std::time::Duration::from_millis(8));
        } else {
            // To look after files now and then.
            ctx.request_repaint_after(std::time::Duration::from_secs(2));
        }
    }

    fn play(&mut self, passed_s: f32) {
        let settings = &mut self.document.settings;
        let duration_s = settings
            .clip
            .as_deref()
            .and_then(|c| self.document.subject.model.clip(Some(c)))
            .map_or(0.0, |c| c.duration_s());
        if duration_s <= 0.0 {
            self.playing = false;
            return;
        }
        // Time goes on only as fast as pictures come.
        if !self.easel.is_busy() {
            settings.time_s =
                (settings.time_s + passed_s.max(1.0 / 60.0) * settings.speed) % duration_s;
        }
    }

    fn take_sheet(&mut self, ctx: &egui::Context) {
        let Some(mut sheet) = self.easel.take() else { return };
        if let Some(message) = sheet.message.take() {
            self.messages.problem(message);
        }
        if sheet.texture.is_none() {
            let image =
                ColorImage::from_rgb([sheet.image.width, sheet.image.height], &sheet.image.pixels);
            match &mut self.picture {
                Some(picture) => picture.set(image, TextureOptions::LINEAR),
                None => {
                    self.picture = Some(ctx.load_texture("picture", image, TextureOptions::LINEAR))
                }
            }
        }
        self.sheet = Some(sheet);
        if let Some(path) = self.wanted.take() {
            self.take_picture(&path);
        }
        self.settle = self.settle.saturating_sub(1);
    }

    /// The options of the stages, made anew only when something changed.
    pub fn options(&mut self) -> Arc<LiveOptions> {
        let key = (self.document.revision, self.cached.dabs, self.document.settings.clone());
        // Time and clip are no options of the stages.
        let key = (key.0, key.1, Settings { time_s: 0.0, clip: None, ..key.2 });
        if self.cached.key.as_ref() != Some(&key) {
            self.cached.options = Arc::new(self.document.live_options());
            self.cached.key = Some(key);
            self.settle = self.settle.max(SETTLE);
        }
        Arc::clone(&self.cached.options)
    }

    fn layer_of_view(&mut self) -> Arc<Vec<[f32; 4]>> {
        let key = (self.document.revision, self.cached.dabs, self.view);
        if self.cached.layer_key != Some(key) {
            let layer = match self.view {
                View::Expansion => Some(Layer::Expansion),
                View::Painted(layer) => Some(layer),
                _ => None,
            };
            self.cached.layer =
                Arc::new(layer.map_or_else(Vec::new, |l| self.document.layers.of(l).to_vec()));
            self.cached.layer_key = Some(key);
        }
        Arc::clone(&self.cached.layer)
    }

    /// Asks for a picture if the last one is no longer right and none is on its way.
    fn order(&mut self) {
        if self.easel.is_busy() || self.size[0] == 0 || self.size[1] == 0 {
            return;
        }
        let (options, layer) = (self.options(), self.layer_of_view());
        let settings = self.document.settings.clone();
        let solid = match self.looking {
            Looking::Live => None,
            Looking::Solved => self.physics.solid(),
            Looking::Grown => self.growth.solid(),
        };
        let moves = self.moving || self.playing || self.trail.is_some() || self.settle > 1;
        let slow = self
            .sheet
            .as_ref()
            .is_some_and(|s| s.stage_ms[4] > SLOW_MS || s.image.width * 2 < self.size[0] + 2);
        let size = if moves && slow { self.size.map(|s| (s / 2).max(1)) } else { self.size };
        let shown = match &solid {
            Some(solid) => Shown::Solid(Arc::clone(solid)),
            None => Shown::Live {
                subject: Arc::clone(&self.document.subject),
                options: Arc::clone(&options),
                clip: settings.clip.clone(),
                time_s: settings.time_s,
            },
        };
        let key: OrderKey = (
            self.table,
            size,
            self.view,
            self.looking,
            settings.time_s,
            Arc::as_ptr(&options) as usize,
            Arc::as_ptr(&layer) as usize,
            solid.as_ref().map_or(0, |s| Arc::as_ptr(s) as usize),
            self.colour,
            self.lose_device,
            settings.clone(),
        );
        if solid.is_some() {
            self.settle = 0;
        }
        if self.cached.ordered.as_ref() == Some(&key) && self.settle == 0 && self.wanted.is_none() {
            return;
        }
        let colour = self.colour.map(plisse_live::shade::from_srgb);
        self.easel.order(Order {
            shown,
            view: self.view,
            camera: self.table.camera(size[0] as f32 / size[1] as f32),
            size,
            profile: settings.profile.profile(),
            parallax: settings.parallax,
            colour: Vec3::from(colour),
            texture: Arc::clone(&self.texture),
            layer,
            steps: if self.settle > 0 && !self.playing { SETTLE_STEPS } else { 1 },
            to_memory: self.wanted.is_some(),
            lose_device: std::mem::take(&mut self.lose_device),
        });
        self.cached.ordered = Some(key);
    }

    /// Whether nothing is on its way: no picture, no job.
    pub fn is_idle(&self) -> bool {
        !self.easel.is_busy()
            && self.trail.is_none()
            && self.settle == 0
            && !self.physics.is_busy()
            && !self.growth.is_busy()
            && !self.taking.is_busy()
            && !self.reading.is_busy()
    }

    /// Ends the program cleanly.
    pub fn close(&mut self) {
        self.guard.clear();
    }

    /// Takes the GPU away, as if it had been lost; for tests.
    pub fn lose_device(&mut self) {
        self.lose_device = true;
        self.cached.ordered = None;
    }
}
