//! A request for a picture, and the rendered frame that answers it.

use std::sync::Arc;

use plisse::picture::Image;
use plisse_live::Vec3;
use plisse_live::camera::Camera;
use plisse_live::live::{LiveOptions, LiveState};
use plisse_live::profile::Profile;
use plisse_live::render::Corner;
use plisse_live::skin::PosedVertices;
use plisse_live::stage::PerStage;
use plisse_live::texture::Texture;
use plisse_live::weld::WeldedMesh;

use super::kind::{Legend, View};
use super::marks::Mark;
use crate::document::Subject;

/// A surface that stands still: solved, or grown.
#[derive(Clone, Debug)]
pub struct Solid {
    /// `[F]` faces of the mesh, with their waves.
    pub coarse: Vec<[Corner; 3]>,
    /// Faces of the fine wrinkled surface, if there is one.
    pub fine: Option<Vec<[Corner; 3]>>,
    /// `[U]` posed vertices.
    pub posed: Arc<PosedVertices>,
    /// The mesh that is shown.
    pub welded: Arc<WeldedMesh>,
    /// `[U]` amplitude (m).
    pub amplitude_m: Vec<f32>,
    /// `[U]` wave vectors (rad/m).
    pub wave: Vec<Vec3>,
    /// `[F]` principal strain (no unit), the lesser first.
    pub strain: Vec<[f32; 2]>,
}

/// A model that the real-time stages wrinkle, at a time of a clip.
#[derive(Clone)]
pub struct LiveSurface {
    /// The model.
    pub subject: Arc<Subject>,
    /// The options of the stages.
    pub options: Arc<LiveOptions>,
    /// Name of the clip; `None`: the rest pose.
    pub clip: Option<String>,
    /// Time in the clip (s).
    pub time_s: f32,
}

/// The surface of a picture.
#[derive(Clone)]
pub enum RenderedSurface {
    /// Wrinkles from the real-time stages.
    Live(LiveSurface),
    /// A surface that stands still.
    Solid(Arc<Solid>),
}

/// A request for a picture.
#[derive(Clone)]
pub struct RenderRequest {
    /// The surface.
    pub surface: RenderedSurface,
    /// The view of it.
    pub view: View,
    /// The camera.
    pub camera: Camera,
    /// Width and height (pixels).
    pub size: [usize; 2],
    /// The wrinkles' profile.
    pub profile: Profile,
    /// True if the texture shifts with the wrinkles.
    pub parallax: bool,
    /// Linear colour that the texture is multiplied with.
    pub colour: Vec3,
    /// The model's own colours.
    pub texture: Arc<Texture>,
    /// `[U]` numbers of the layer that the view shows, or empty.
    pub layer: Arc<Vec<[f32; 4]>>,
    /// Least number of steps of the stages, so that phases settle.
    pub steps: usize,
    /// True if the pixels must come back into memory.
    pub to_memory: bool,
    /// Destroys the GPU device first, as if it had been lost; for tests.
    pub lose_device: bool,
}

/// A rendered picture.
#[derive(Clone)]
pub struct RenderedFrame {
    /// The picture; without pixels if it is in `texture`.
    pub image: Image,
    /// The window's texture that holds the picture, if it stayed on the window's adapter.
    pub texture: Option<egui::TextureId>,
    /// The camera it was rendered with.
    pub camera: Camera,
    /// `[U]` posed vertices.
    pub posed: Arc<PosedVertices>,
    /// The waves, if the stages made them.
    pub state: Option<Arc<LiveState>>,
    /// Lines over the picture.
    pub marks: Vec<Mark>,
    /// The meaning of its colours.
    pub legend: Option<Legend>,
    /// Name of the adapter, or of the processor, that rendered it.
    pub device: String,
    /// Milliseconds of each stage.
    pub stage_ms: PerStage<f32>,
    /// Mean phase error over visible edges (waves).
    pub phase_error: f32,
    /// A message about what went wrong.
    pub message: Option<String>,
}
