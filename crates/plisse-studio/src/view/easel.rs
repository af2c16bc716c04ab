//! What is ordered, what draws it ([`Bench`]: the real-time stages, then the [`Pencil`]), and the
//! sheet that comes back. [`Easel`] is the thread on which that is done, so that no frame of the
//! window ever waits for it; where there are no threads it is done at once.

use std::sync::Arc;

use plisse::picture::Image;
use plisse_live::camera::Camera;
use plisse_live::gather::gather;
use plisse_live::live::{LiveOptions, LiveState};
use plisse_live::profile::Profile;
use plisse_live::relax::mean_phase_error;
use plisse_live::render::Corner;
use plisse_live::skin::{Skinned, pose, skin};
use plisse_live::texture::Texture;
use plisse_live::unify::Unified;
use plisse_live::{Vec3, bake};
use web_time::Instant;

use super::corners::{Scene, faces};
use super::marks::{Mark, crests, ellipses};
use super::pencil::{Graphics, Looks, Pencil};
use super::{Legend, View};
use crate::document::Subject;

#[cfg(target_arch = "wasm32")]
pub use super::at_once::Easel;
#[cfg(not(target_arch = "wasm32"))]
pub use super::on_a_thread::Easel;

/// Frames a second at which the stages run through a clip at least.
const RATE: f32 = 60.0;
/// Most steps of the stages in one picture.
const MOST_STEPS: usize = 8;

/// A surface that stands still: solved, or grown.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Faces with their waves, one for each of the mesh's.
    pub coarse: Vec<[Corner; 3]>,
    /// Faces of the wrinkled surface itself, where there is one.
    pub fine: Option<Vec<[Corner; 3]>>,
    /// The posed vertices.
    pub posed: Arc<Skinned>,
    /// The mesh that is shown: for faces and neighbours.
    pub unified: Arc<Unified>,
    /// `[U]` amplitude (m).
    pub amplitude_m: Vec<f32>,
    /// `[U]` wave vectors (rad/m).
    pub wave: Vec<Vec3>,
    /// `[F]` principal strain, the lesser first.
    pub strain: Vec<[f32; 2]>,
}

/// What is shown.
#[derive(Clone)]
pub enum Shown {
    /// The stages, at a time of a clip.
    Live {
        /// The model.
        subject: Arc<Subject>,
        /// How its wrinkles are made.
        options: Arc<LiveOptions>,
        /// Name of the clip; none: the pose its nodes stand in.
        clip: Option<String>,
        /// Time in the clip (s).
        time_s: f32,
    },
    /// A surface that stands still.
    Solid(Arc<Solid>),
}

/// What to draw.
#[derive(Clone)]
pub struct Order {
    /// What is shown.
    pub shown: Shown,
    /// How.
    pub view: View,
    /// From where.
    pub camera: Camera,
    /// Width and height (pixels).
    pub size: [usize; 2],
    /// The wrinkles' profile.
    pub profile: Profile,
    /// Whether the texture shifts with the wrinkles.
    pub parallax: bool,
    /// Linear colour that the texture is multiplied with.
    pub colour: Vec3,
    /// The model's own colours, if they are to change.
    pub texture: Arc<Texture>,
    /// `[U]` numbers of the layer that the view shows, or empty.
    pub layer: Arc<Vec<[f32; 4]>>,
    /// Steps of the stages at least, for phases that have yet to settle.
    pub steps: usize,
    /// Whether the picture's pixels have to come into memory.
    pub to_memory: bool,
    /// Takes the GPU away first, as if it had been lost; for tests.
    pub lose_device: bool,
}

/// A picture that was drawn.
#[derive(Clone)]
pub struct Sheet {
    /// The picture; without pixels if it is in `texture`.
    pub image: Image,
    /// The window's texture in which the picture is, if it stayed on the window's adapter.
    pub texture: Option<egui::TextureId>,
    /// The camera it was drawn by.
    pub camera: Camera,
    /// Where the unified vertices are in it.
    pub posed: Arc<Skinned>,
    /// The waves, if the stages made them.
    pub state: Option<Arc<LiveState>>,
    /// Lines over it.
    pub marks: Vec<Mark>,
    /// What its colours mean.
    pub legend: Option<Legend>,
    /// What drew it.
    pub device: String,
    /// Milliseconds of skin, crush, relax, gather and render.
    pub stage_ms: [f32; 5],
    /// Mean phase error over visible edges (waves).
    pub phase_error: f32,
    /// What went wrong.
    pub message: Option<String>,
}

/// What the thread keeps from picture to picture.
pub struct Bench {
    pencil: Pencil,
    texture: Option<Arc<Texture>>,
    subject: Option<Arc<Subject>>,
    state: LiveState,
    time_s: f32,
}

impl Bench {
    /// Before the first picture.
    pub fn new(graphics: Graphics) -> Self {
        Self {
            pencil: Pencil::new(graphics),
            texture: None,
            subject: None,
            state: LiveState::default(),
            time_s: 0.0,
        }
    }

    /// Draws one picture.
    pub fn draw(&mut self, order: &Order) -> Sheet {
        if order.lose_device {
            self.pencil.destroy_device();
        }
        if self.texture.as_ref().is_none_or(|t| !Arc::ptr_eq(t, &order.texture)) {
            self.pencil.set_base(&order.texture);
            self.texture = Some(Arc::clone(&order.texture));
        }
        let mut ms = [0.0; 5];
        match &order.shown {
            Shown::Live { subject, options, clip, time_s } => {
                let drawn = self.step(order, (subject, options, clip.as_deref(), *time_s), &mut ms);
                let begun = Instant::now();
                let wrinkled = gather(
                    &subject.model,
                    &subject.unified,
                    &self.state.posed,
                    &drawn,
                    &self.state.crushed,
                    &self.state.phase,
                );
                ms[3] = milliseconds(begun);
                let state = Arc::new(self.state.clone());
                let scene = Scene {
                    wrinkled: &wrinkled,
                    unified: &subject.unified,
                    strain: None,
                    posed: &state.posed,
                    amplitude_m: &state.crushed.amplitude_m,
                    layer: &order.layer,
                    eye: order.camera.eye,
                };
                let error = mean_phase_error(
                    &subject.unified,
                    &state.posed.positions,
                    &state.crushed,
                    &state.phase,
                );
                let marks = marks(order, &scene, &state.crushed.wave, &state.crushed.strength);
                let mut sheet = self.paint(order, &scene, None, Arc::new(state.posed.clone()), ms);
                (sheet.phase_error, sheet.marks, sheet.state) =
                    (error, marks, Some(Arc::clone(&state)));
                sheet
            }
            Shown::Solid(solid) => {
                let scene = Scene {
                    wrinkled: &solid.coarse,
                    unified: &solid.unified,
                    strain: Some(&solid.strain),
                    posed: &solid.posed,
                    amplitude_m: &solid.amplitude_m,
                    layer: &order.layer,
                    eye: order.camera.eye,
                };
                let most = solid.amplitude_m.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
                let strength: Vec<f32> = solid.amplitude_m.iter().map(|a| a / most).collect();
                let marks = marks(order, &scene, &solid.wave, &strength);
                let mut sheet =
                    self.paint(order, &scene, solid.fine.as_deref(), Arc::clone(&solid.posed), ms);
                sheet.marks = marks;
                sheet
            }
        }
    }

    /// Runs the stages up to a time of a clip; the posed draw vertices.
    fn step(
        &mut self,
        order: &Order,
        live: (&Arc<Subject>, &LiveOptions, Option<&str>, f32),
        ms: &mut [f32; 5],
    ) -> Skinned {
        let (subject, options, clip, time_s) = live;
        if self.subject.as_ref().is_none_or(|s| !Arc::ptr_eq(s, subject)) {
            self.subject = Some(Arc::clone(subject));
            self.state = LiveState::default();
            self.time_s = time_s;
        }
        let clip = clip.and_then(|name| subject.model.clip(Some(name)));
        let way = time_s - self.time_s;
        let steps =
            if way > 0.0 { ((way * RATE - 1e-3).ceil() as usize).clamp(1, MOST_STEPS) } else { 1 }
                .max(order.steps);
        let from = if way > 0.0 { self.time_s } else { time_s };
        let mut begun = Instant::now();
        for k in 1..=steps {
            let at = from + (time_s - from) * k as f32 / steps as f32;
            self.state.step_watched(
                &subject.unified,
                &pose(&subject.model, clip, at),
                options,
                |stage| {
                    let index =
                        ["skin", "crush", "relax"].iter().position(|s| *s == stage).unwrap_or(0);
                    ms[index] += milliseconds(begun);
                    begun = Instant::now();
                },
            );
        }
        self.time_s = time_s;
        let drawn = skin(&subject.model.draw, &pose(&subject.model, clip, time_s));
        ms[0] += milliseconds(begun);
        drawn
    }

    fn paint(
        &mut self,
        order: &Order,
        scene: &Scene<'_>,
        fine: Option<&[[Corner; 3]]>,
        posed: Arc<Skinned>,
        ms: [f32; 5],
    ) -> Sheet {
        let (made, scale, legend) = faces(scene, order.view);
        let list = fine.filter(|_| order.view == View::Wrinkled).unwrap_or(&made);
        let looks =
            Looks { profile: &order.profile, parallax: order.parallax, colour: order.colour };
        let begun = Instant::now();
        let drawn =
            self.pencil.draw(list, scale, &looks, &order.camera, (order.size, order.to_memory));
        let stage_ms = [ms[0], ms[1], ms[2], ms[3], milliseconds(begun)];
        Sheet {
            image: drawn.image,
            texture: drawn.texture,
            camera: order.camera,
            posed,
            state: None,
            marks: Vec::new(),
            legend,
            device: self.pencil.name().to_owned(),
            stage_ms,
            phase_error: 0.0,
            message: self.pencil.take_message(),
        }
    }
}

fn marks(order: &Order, scene: &Scene<'_>, wave: &[Vec3], strength: &[f32]) -> Vec<Mark> {
    match order.view {
        View::Direction => crests(scene.unified, scene.posed, wave, strength, &order.camera),
        View::Expansion if order.layer.len() == scene.unified.count() => {
            ellipses(scene.unified, scene.posed, &order.layer, &order.camera)
        }
        _ => Vec::new(),
    }
}

fn milliseconds(begun: Instant) -> f32 {
    begun.elapsed().as_secs_f32() * 1e3
}

/// The image that `subject` is drawn with: its own, a checked cloth, or one colour where it has no
/// texture coordinates. With a sentence if its own could not be read.
pub fn texture_of(subject: &Subject) -> (Texture, Option<String>) {
    match subject
        .model
        .base_colour
        .as_ref()
        .map(|bytes| Texture::decode(&subject.model.name, bytes))
    {
        Some(Ok(texture)) => (texture, None),
        Some(Err(error)) => (Texture::checked(), Some(format!("{error}; drawn without it"))),
        None if bake::check(&subject.model).is_ok() => (Texture::checked(), None),
        None => (Texture::plain([214, 176, 158]), None),
    }
}
