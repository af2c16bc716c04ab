//! The render thread. It always works on the newest request; the window shows the last frame that
//! came back.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex};

use super::frame::{RenderRequest, RenderedFrame};
use super::renderer::Graphics;
use super::renderer_state::RendererState;

/// The window's end of the thread.
pub struct RenderThread {
    mailbox: Arc<Mailbox>,
    frames: Receiver<RenderedFrame>,
    in_flight: bool,
}

#[derive(Default)]
struct Mailbox {
    content: Mutex<Content>,
    changed: Condvar,
}

#[derive(Default)]
struct Content {
    /// The newest request that is not begun.
    newest: Option<RenderRequest>,
    /// True once the window is gone.
    is_closed: bool,
}

impl RenderThread {
    /// Starts the thread. `request_repaint` is called after each frame.
    pub fn new(graphics: Graphics, request_repaint: impl Fn() + Send + 'static) -> Self {
        let mailbox = Arc::new(Mailbox::default());
        let (send, frames) = channel();
        let theirs = Arc::clone(&mailbox);
        crate::threads::spawn("render", move || {
            render_all(&theirs, &send, graphics, &request_repaint)
        });
        Self { mailbox, frames, in_flight: false }
    }

    /// Asks for a picture, in place of a request that is not begun.
    pub fn request(&mut self, request: RenderRequest) {
        if let Ok(mut content) = self.mailbox.content.lock() {
            content.newest = Some(request);
            self.in_flight = true;
        }
        self.mailbox.changed.notify_one();
    }

    /// True while a picture is being rendered.
    pub fn is_busy(&self) -> bool {
        self.in_flight
    }

    /// The newest frame that came since the last call.
    pub fn take(&mut self) -> Option<RenderedFrame> {
        let newest = self.frames.try_iter().last();
        if newest.is_some() {
            let waits = self.mailbox.content.lock().is_ok_and(|content| content.newest.is_some());
            self.in_flight = waits;
        }
        newest
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        if let Ok(mut content) = self.mailbox.content.lock() {
            content.is_closed = true;
        }
        self.mailbox.changed.notify_one();
    }
}

fn render_all(
    mailbox: &Mailbox,
    send: &Sender<RenderedFrame>,
    graphics: Graphics,
    request_repaint: &(impl Fn() + Send),
) {
    let mut state = RendererState::new(graphics);
    loop {
        let Ok(mut content) = mailbox.content.lock() else { return };
        let request = loop {
            if content.is_closed {
                return;
            }
            if let Some(request) = content.newest.take() {
                break request;
            }
            match mailbox.changed.wait(content) {
                Ok(guard) => content = guard,
                Err(_) => return,
            }
        };
        drop(content);
        if send.send(state.render(&request)).is_err() {
            return;
        }
        request_repaint();
    }
}
