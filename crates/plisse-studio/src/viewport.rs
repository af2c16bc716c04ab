//! The viewport: the camera, the view, the surface that is shown, and the pictures of it. Pictures
//! are requested when something has changed, and come from the [`RenderThread`].

use std::path::PathBuf;
use std::sync::Arc;

use egui::{ColorImage, TextureHandle, TextureOptions};
use plisse_live::Vec3;
use plisse_live::live::LiveOptions;
use plisse_live::skin::{PosedVertices, pose, skin};
use plisse_live::stage::Stage;
use plisse_live::texture::Texture;

use crate::document::{Document, Layer, Settings, Subject};
use crate::messages::Messages;
use crate::view::{
    Graphics, LiveSurface, OrbitCamera, RenderRequest, RenderThread, RenderedFrame,
    RenderedSurface, Solid, View,
};

/// Pictures after a change until the phases have settled.
const SETTLE: usize = 5;
/// Steps of the stages in each of these pictures.
const SETTLE_STEPS: usize = 8;
/// Time of drawing (ms) above which pictures have half the size while things move.
const SLOW_MS: f32 = 45.0;

/// The surface that the picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShownSurface {
    /// The model with its live wrinkles.
    Live,
    /// The solved scene.
    Solved,
    /// The grown surface.
    Grown,
}

impl ShownSurface {
    /// Name in the window.
    pub fn name(self) -> &'static str {
        match self {
            Self::Live => "Model",
            Self::Solved => "Solved",
            Self::Grown => "Grown",
        }
    }
}

/// Everything that a picture depends on; equal keys give equal pictures.
#[derive(Clone, PartialEq)]
struct FrameKey {
    orbit: OrbitCamera,
    size: [usize; 2],
    view: View,
    shown: ShownSurface,
    settings: Settings,
    colour: [u8; 3],
    lose_device: bool,
    options: SamePointer<LiveOptions>,
    layer: SamePointer<Vec<[f32; 4]>>,
    solid: Option<SamePointer<Solid>>,
}

/// Shared data, compared by address: what is computed anew counts as changed. Keeps the data alive,
/// so that no address is used twice.
#[derive(Clone)]
struct SamePointer<T>(Arc<T>);

impl<T> PartialEq for SamePointer<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// State of the painted layers: revision of the document, and number of dabs of the current stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PaintRevision {
    pub revision: u64,
    pub dabs: u64,
}

/// Data computed from the document, kept until the document changes.
struct Cached {
    options_key: Option<(PaintRevision, Settings)>,
    options: Arc<LiveOptions>,
    layer_key: Option<(PaintRevision, View)>,
    layer: Arc<Vec<[f32; 4]>>,
}

/// The picture and all that decides about it.
pub struct Viewport {
    render_thread: RenderThread,
    /// The last frame that was rendered.
    pub frame: Option<RenderedFrame>,
    pub(crate) picture: Option<TextureHandle>,
    /// The camera.
    pub orbit: OrbitCamera,
    /// Width and height of the picture (pixels).
    pub(crate) size: [usize; 2],
    /// True while the pointer moves the camera.
    pub(crate) moving: bool,
    /// The view of the surface.
    pub view: View,
    /// The surface that is shown.
    pub shown: ShownSurface,
    /// True while the clip plays.
    pub playing: bool,
    texture: Arc<Texture>,
    /// Colour that the texture is multiplied with (sRGB).
    pub colour: [u8; 3],
    /// Pictures that are still needed until the phases have settled.
    unsettled: usize,
    lose_device: bool,
    /// File to write the next picture to.
    pub(crate) picture_path: Option<PathBuf>,
    cached: Cached,
    requested: Option<FrameKey>,
}

impl Viewport {
    /// A viewport on `document`, drawn by `graphics`. `request_repaint` is called after each frame.
    pub fn new(
        graphics: Graphics,
        request_repaint: Arc<dyn Fn() + Send + Sync>,
        document: &Document,
    ) -> Self {
        let positions = &document.subject.welded.vertices.positions;
        Self {
            render_thread: RenderThread::new(graphics, move || request_repaint()),
            frame: None,
            picture: None,
            orbit: OrbitCamera::fit(positions, 0.35, 0.1, 1.3),
            size: [640, 480],
            moving: false,
            view: View::Wrinkled,
            shown: ShownSurface::Live,
            playing: true,
            texture: Arc::new(Texture::checked()),
            colour: [255; 3],
            unsettled: SETTLE,
            lose_device: false,
            picture_path: None,
            cached: Cached {
                options_key: None,
                options: Arc::new(LiveOptions::new(0.1)),
                layer_key: None,
                layer: Arc::new(Vec::new()),
            },
            requested: None,
        }
    }

    /// Shows another document, from which nothing is rendered yet.
    pub(crate) fn reset(&mut self, document: &Document, messages: &mut Messages) {
        let (texture, problem) = texture_of(&document.subject);
        self.texture = Arc::new(texture);
        if let Some(problem) = problem {
            messages.problem(problem);
        }
        if matches!(self.view, View::Painted(_) | View::Expansion) {
            self.view = View::Wrinkled;
        }
        let has_clips = !document.subject.model.clips.is_empty();
        (self.shown, self.playing) = (ShownSurface::Live, has_clips);
        self.cached.options_key = None;
        self.cached.layer_key = None;
        self.frame = None;
        self.unsettle();
        self.fit(document);
    }

    /// Moves the camera so that the whole surface is seen.
    pub fn fit(&mut self, document: &Document) {
        let aspect = self.size[0] as f32 / self.size[1].max(1) as f32;
        let positions: Vec<Vec3> = match &self.frame {
            Some(frame) => frame.posed.positions.clone(),
            None => {
                let (subject, settings) = (&document.subject, &document.settings);
                let clip = settings.clip.as_deref().and_then(|c| subject.model.clip(Some(c)));
                let pose = pose(&subject.model, clip, settings.time_s);
                skin(&subject.welded.vertices, &pose).positions
            }
        };
        self.orbit = OrbitCamera::fit(&positions, self.orbit.yaw_rad, self.orbit.pitch_rad, aspect);
    }

    /// Shows `layer` if the view shows what is painted.
    pub(crate) fn follow_layer(&mut self, layer: Layer) {
        if let View::Painted(_) | View::Expansion = self.view {
            self.view =
                if layer == Layer::Expansion { View::Expansion } else { View::Painted(layer) };
        }
    }

    /// `[U]` posed vertices of the last frame; the rest pose before the first.
    pub fn posed(&self, subject: &Subject) -> Arc<PosedVertices> {
        match &self.frame {
            Some(frame) => Arc::clone(&frame.posed),
            None => {
                let v = &subject.welded.vertices;
                Arc::new(PosedVertices {
                    positions: v.positions.clone(),
                    normals: v.normals.clone(),
                })
            }
        }
    }

    /// Replaces the texture of the model.
    pub(crate) fn set_texture(&mut self, texture: Texture) {
        self.texture = Arc::new(texture);
        self.unsettled = self.unsettled.max(2);
    }

    /// Notes that something changed: pictures are rendered until the phases have settled.
    pub(crate) fn unsettle(&mut self) {
        self.unsettled = SETTLE;
    }

    /// True while a picture is on its way or phases have yet to settle.
    pub(crate) fn is_busy(&self) -> bool {
        self.render_thread.is_busy() || self.unsettled > 0
    }

    /// True if frames should follow each other at once.
    pub(crate) fn is_animated(&self) -> bool {
        self.playing || self.unsettled > 0
    }

    /// Advances the clip by `passed_s`, no faster than pictures come.
    pub(crate) fn play(&mut self, document: &mut Document, passed_s: f32) {
        if !self.playing || self.shown != ShownSurface::Live {
            return;
        }
        let settings = &mut document.settings;
        let duration_s = settings
            .clip
            .as_deref()
            .and_then(|c| document.subject.model.clip(Some(c)))
            .map_or(0.0, |c| c.duration_s());
        if duration_s <= 0.0 {
            self.playing = false;
            return;
        }
        if !self.render_thread.is_busy() {
            settings.time_s =
                (settings.time_s + passed_s.max(1.0 / 60.0) * settings.speed) % duration_s;
        }
    }

    /// Takes the newest frame from the render thread; true if one came.
    pub(crate) fn take_frame(&mut self, ctx: &egui::Context, messages: &mut Messages) -> bool {
        let Some(mut frame) = self.render_thread.take() else { return false };
        if let Some(message) = frame.message.take() {
            messages.problem(message);
        }
        if frame.texture.is_none() {
            let size = [frame.image.width, frame.image.height];
            let image = ColorImage::from_rgb(size, &frame.image.pixels);
            match &mut self.picture {
                Some(picture) => picture.set(image, TextureOptions::LINEAR),
                None => {
                    self.picture = Some(ctx.load_texture("picture", image, TextureOptions::LINEAR))
                }
            }
        }
        self.frame = Some(frame);
        true
    }

    /// Notes that a frame came: the phases have settled by one picture more.
    pub(crate) fn settle(&mut self) {
        self.unsettled = self.unsettled.saturating_sub(1);
    }

    /// The options of the stages, computed anew only when something changed.
    fn options(&mut self, document: &Document, painted: PaintRevision) -> Arc<LiveOptions> {
        // Time and clip are no options of the stages.
        let settings = Settings { time_s: 0.0, clip: None, ..document.settings.clone() };
        let key = (painted, settings);
        if self.cached.options_key.as_ref() != Some(&key) {
            self.cached.options = Arc::new(document.live_options());
            self.cached.options_key = Some(key);
            self.unsettled = self.unsettled.max(SETTLE);
        }
        Arc::clone(&self.cached.options)
    }

    /// `[U]` numbers of the layer that the view shows, or empty.
    fn layer_of_view(&mut self, document: &Document, painted: PaintRevision) -> Arc<Vec<[f32; 4]>> {
        let key = (painted, self.view);
        if self.cached.layer_key != Some(key) {
            let layer = match self.view {
                View::Expansion => Some(Layer::Expansion),
                View::Painted(layer) => Some(layer),
                _ => None,
            };
            self.cached.layer =
                Arc::new(layer.map_or_else(Vec::new, |l| document.layers.of(l).to_vec()));
            self.cached.layer_key = Some(key);
        }
        Arc::clone(&self.cached.layer)
    }

    /// Requests a picture if the last one is outdated and none is on its way. `solid` is the
    /// surface that [`Viewport::shown`] names, if it is there; `paints`: true while a stroke is
    /// painted.
    pub(crate) fn request(
        &mut self,
        document: &Document,
        solid: Option<Arc<Solid>>,
        painted: PaintRevision,
        paints: bool,
    ) {
        if self.render_thread.is_busy() || self.size[0] == 0 || self.size[1] == 0 {
            return;
        }
        let options = self.options(document, painted);
        let layer = self.layer_of_view(document, painted);
        let size = self.picture_size(paints);
        let key = FrameKey {
            orbit: self.orbit,
            size,
            view: self.view,
            shown: self.shown,
            settings: document.settings.clone(),
            colour: self.colour,
            lose_device: self.lose_device,
            options: SamePointer(Arc::clone(&options)),
            layer: SamePointer(Arc::clone(&layer)),
            solid: solid.clone().map(SamePointer),
        };
        if solid.is_some() {
            self.unsettled = 0;
        }
        let is_same = self.requested.as_ref() == Some(&key);
        if is_same && self.unsettled == 0 && self.picture_path.is_none() {
            return;
        }
        let settings = &document.settings;
        let surface = match solid {
            Some(solid) => RenderedSurface::Solid(solid),
            None => RenderedSurface::Live(LiveSurface {
                subject: Arc::clone(&document.subject),
                options,
                clip: settings.clip.clone(),
                time_s: settings.time_s,
            }),
        };
        self.render_thread.request(RenderRequest {
            surface,
            view: self.view,
            camera: self.orbit.camera(size[0] as f32 / size[1] as f32),
            size,
            profile: settings.profile.profile(),
            parallax: settings.parallax,
            colour: Vec3::from(self.colour.map(plisse_live::shade::from_srgb)),
            texture: Arc::clone(&self.texture),
            layer,
            steps: if self.unsettled > 0 && !self.playing { SETTLE_STEPS } else { 1 },
            to_memory: self.picture_path.is_some(),
            lose_device: std::mem::take(&mut self.lose_device),
        });
        self.requested = Some(key);
    }

    /// Size of the next picture (pixels): half of it while things move on a slow machine.
    fn picture_size(&self, paints: bool) -> [usize; 2] {
        let moves = self.moving || self.playing || paints || self.unsettled > 1;
        let slow = self.frame.as_ref().is_some_and(|f| {
            f.stage_ms[Stage::Render] > SLOW_MS || f.image.width * 2 < self.size[0] + 2
        });
        if moves && slow { self.size.map(|s| (s / 2).max(1)) } else { self.size }
    }

    /// Destroys the GPU device, as if it had been lost; for tests.
    pub fn lose_device(&mut self) {
        self.lose_device = true;
        self.requested = None;
    }
}

/// The texture of `subject`: its own, a checked cloth, or one colour if it has no texture
/// coordinates. With a message if its own could not be read.
pub fn texture_of(subject: &Subject) -> (Texture, Option<String>) {
    let (texture, problem) = Texture::of(&subject.model);
    (texture, problem.map(|error| format!("{error}; drawn without it")))
}
