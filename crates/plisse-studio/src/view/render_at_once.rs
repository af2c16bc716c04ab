//! The render thread's stand-in for systems without threads: each request is rendered at once.

use super::frame::{RenderRequest, RenderedFrame};
use super::renderer::Graphics;
use super::renderer_state::RendererState;

/// Renders in the caller's thread.
pub struct RenderThread {
    state: RendererState,
    request_repaint: Box<dyn Fn()>,
    frame: Option<RenderedFrame>,
}

impl RenderThread {
    /// A renderer on `graphics`. `request_repaint` is called after each frame.
    pub fn new(graphics: Graphics, request_repaint: impl Fn() + 'static) -> Self {
        Self {
            state: RendererState::new(graphics),
            request_repaint: Box::new(request_repaint),
            frame: None,
        }
    }

    /// Renders a picture.
    pub fn request(&mut self, request: RenderRequest) {
        self.frame = Some(self.state.render(&request));
        (self.request_repaint)();
    }

    /// True while a frame waits to be taken.
    pub fn is_busy(&self) -> bool {
        self.frame.is_some()
    }

    /// The frame that came since the last call.
    pub fn take(&mut self) -> Option<RenderedFrame> {
        self.frame.take()
    }
}
