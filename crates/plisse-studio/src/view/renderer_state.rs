//! Renderer state: the real-time stages and the renderer, kept from picture to picture.

use std::sync::Arc;

use plisse_live::Vec3;
use plisse_live::gather::gather;
use plisse_live::live::{Frame, LiveState};
use plisse_live::render::Corner;
use plisse_live::skin::{PosedVertices, pose, skin};
use plisse_live::stage::{PerStage, Stage};
use plisse_live::texture::Texture;
use web_time::Instant;

use super::corners::{ViewedSurface, faces};
use super::frame::{LiveSurface, RenderRequest, RenderedFrame, RenderedSurface, Solid};
use super::kind::View;
use super::marks::{Mark, crests, ellipses};
use super::renderer::{Appearance, Graphics, RenderTarget, Renderer};
use crate::document::Subject;

/// Least rate of the stages while a clip plays (frames per second of clip time).
const RATE: f32 = 60.0;
/// Most steps of the stages in one picture.
const MOST_STEPS: usize = 8;

/// The renderer, and the state of the stages between two pictures.
pub struct RendererState {
    renderer: Renderer,
    texture: Option<Arc<Texture>>,
    subject: Option<Arc<Subject>>,
    live: LiveState,
    time_s: f32,
}

impl RendererState {
    /// The state before the first picture.
    pub fn new(graphics: Graphics) -> Self {
        Self {
            renderer: Renderer::new(graphics),
            texture: None,
            subject: None,
            live: LiveState::default(),
            time_s: 0.0,
        }
    }

    /// Renders one picture.
    pub fn render(&mut self, request: &RenderRequest) -> RenderedFrame {
        if request.lose_device {
            self.renderer.destroy_device();
        }
        if self.texture.as_ref().is_none_or(|t| !Arc::ptr_eq(t, &request.texture)) {
            self.renderer.set_base(&request.texture);
            self.texture = Some(Arc::clone(&request.texture));
        }
        match &request.surface {
            RenderedSurface::Live(live) => self.render_live(request, live),
            RenderedSurface::Solid(solid) => self.render_solid(request, solid),
        }
    }

    fn render_live(&mut self, request: &RenderRequest, live: &LiveSurface) -> RenderedFrame {
        let subject = &live.subject;
        let mut ms = PerStage::default();
        let drawn = self.step(live, request.steps, &mut ms);
        let begun = Instant::now();
        let frame = Frame { state: &self.live, drawn: &drawn };
        let wrinkled = gather(&subject.model, &subject.welded, &frame);
        ms[Stage::Gather] = milliseconds(begun);
        let state = Arc::new(self.live.clone());
        let surface = ViewedSurface {
            wrinkled: &wrinkled,
            welded: &subject.welded,
            strain: None,
            posed: &Arc::new(state.posed.clone()),
            amplitude_m: &state.waves.amplitude_m,
            layer: &request.layer,
            eye: request.camera.eye,
        };
        let phase_error = state.mean_phase_error(&subject.welded);
        let marks = marks(request, &surface, &state.waves.wave, &state.waves.strength);
        let frame = self.render_faces(request, &surface, None);
        ms[Stage::Render] = frame.stage_ms[Stage::Render];
        RenderedFrame { phase_error, marks, state: Some(state), stage_ms: ms, ..frame }
    }

    fn render_solid(&mut self, request: &RenderRequest, solid: &Solid) -> RenderedFrame {
        let surface = ViewedSurface {
            wrinkled: &solid.coarse,
            welded: &solid.welded,
            strain: Some(&solid.strain),
            posed: &solid.posed,
            amplitude_m: &solid.amplitude_m,
            layer: &request.layer,
            eye: request.camera.eye,
        };
        let most = solid.amplitude_m.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        let strength: Vec<f32> = solid.amplitude_m.iter().map(|a| a / most).collect();
        let marks = marks(request, &surface, &solid.wave, &strength);
        let frame = self.render_faces(request, &surface, solid.fine.as_deref());
        RenderedFrame { marks, ..frame }
    }

    /// Runs the stages up to the surface's time, at least `least` steps; the posed draw vertices.
    /// Adds each stage's milliseconds to `ms`.
    fn step(&mut self, live: &LiveSurface, least: usize, ms: &mut PerStage<f32>) -> PosedVertices {
        let LiveSurface { subject, options, clip, time_s } = live;
        let time_s = *time_s;
        if self.subject.as_ref().is_none_or(|s| !Arc::ptr_eq(s, subject)) {
            self.subject = Some(Arc::clone(subject));
            self.live = LiveState::default();
            self.time_s = time_s;
        }
        let clip = clip.as_deref().and_then(|name| subject.model.clip(Some(name)));
        let passed_s = time_s - self.time_s;
        let steps = if passed_s > 0.0 {
            ((passed_s * RATE - 1e-3).ceil() as usize).clamp(1, MOST_STEPS)
        } else {
            1
        }
        .max(least);
        let from = if passed_s > 0.0 { self.time_s } else { time_s };
        let mut begun = Instant::now();
        for k in 1..=steps {
            let at = from + (time_s - from) * k as f32 / steps as f32;
            self.live.step_watched(
                &subject.welded,
                &pose(&subject.model, clip, at),
                options,
                |stage| {
                    ms[stage] += milliseconds(begun);
                    begun = Instant::now();
                },
            );
        }
        self.time_s = time_s;
        let drawn = skin(&subject.model.draw, &pose(&subject.model, clip, time_s));
        ms[Stage::Skin] += milliseconds(begun);
        drawn
    }

    /// Renders the faces of a surface, or its `fine` faces in the wrinkled view.
    fn render_faces(
        &mut self,
        request: &RenderRequest,
        surface: &ViewedSurface<'_>,
        fine: Option<&[[Corner; 3]]>,
    ) -> RenderedFrame {
        let (coarse, scale, legend) = faces(surface, request.view);
        let list = fine.filter(|_| request.view == View::Wrinkled).unwrap_or(&coarse);
        let appearance = Appearance {
            profile: &request.profile,
            parallax: request.parallax,
            colour: request.colour,
        };
        let target = RenderTarget {
            camera: &request.camera,
            size: request.size,
            to_memory: request.to_memory,
        };
        let begun = Instant::now();
        let drawn = self.renderer.draw(list, scale, &appearance, &target);
        let mut stage_ms = PerStage::default();
        stage_ms[Stage::Render] = milliseconds(begun);
        RenderedFrame {
            image: drawn.image,
            texture: drawn.texture,
            camera: request.camera,
            posed: Arc::clone(surface.posed),
            state: None,
            marks: Vec::new(),
            legend,
            device: self.renderer.name().to_owned(),
            stage_ms,
            phase_error: 0.0,
            message: self.renderer.take_message(),
        }
    }
}

fn marks(
    request: &RenderRequest,
    surface: &ViewedSurface<'_>,
    wave: &[Vec3],
    strength: &[f32],
) -> Vec<Mark> {
    match request.view {
        View::Direction => crests(surface.welded, surface.posed, wave, strength, &request.camera),
        View::Expansion if request.layer.len() == surface.welded.count() => {
            ellipses(surface.welded, surface.posed, &request.layer, &request.camera)
        }
        _ => Vec::new(),
    }
}

fn milliseconds(begun: Instant) -> f32 {
    begun.elapsed().as_secs_f32() * 1e3
}
