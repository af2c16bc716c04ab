//! The thread that draws. It always works on the newest order; what the window shows is the last
//! sheet that came back.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex};

use super::easel::{Bench, Order, Sheet};
use super::pencil::Graphics;

/// The window's end of the thread.
pub struct Easel {
    mailbox: Arc<Mailbox>,
    sheets: Receiver<Sheet>,
    in_flight: bool,
}

#[derive(Default)]
struct Mailbox {
    /// The newest order, and whether the window is gone.
    newest: Mutex<(Option<Order>, bool)>,
    changed: Condvar,
}

impl Easel {
    /// Starts the thread, which draws by `graphics`. `wake` is called after each sheet.
    pub fn new(graphics: Graphics, wake: impl Fn() + Send + 'static) -> Self {
        let mailbox = Arc::new(Mailbox::default());
        let (send, sheets) = channel();
        let theirs = Arc::clone(&mailbox);
        crate::work::thread::spawn("easel", move || draw_all(&theirs, &send, graphics, &wake));
        Self { mailbox, sheets, in_flight: false }
    }

    /// Asks for a picture; one that was asked for and not begun is left out.
    pub fn order(&mut self, order: Order) {
        if let Ok(mut newest) = self.mailbox.newest.lock() {
            newest.0 = Some(order);
            self.in_flight = true;
        }
        self.mailbox.changed.notify_one();
    }

    /// Whether a picture is on its way.
    pub fn is_busy(&self) -> bool {
        self.in_flight
    }

    /// The newest sheet that came since the last call.
    pub fn take(&mut self) -> Option<Sheet> {
        let newest = self.sheets.try_iter().last();
        if newest.is_some() {
            let waits = self.mailbox.newest.lock().is_ok_and(|newest| newest.0.is_some());
            self.in_flight = waits;
        }
        newest
    }
}

impl Drop for Easel {
    fn drop(&mut self) {
        if let Ok(mut newest) = self.mailbox.newest.lock() {
            newest.1 = true;
        }
        self.mailbox.changed.notify_one();
    }
}

fn draw_all(
    mailbox: &Mailbox,
    send: &Sender<Sheet>,
    graphics: Graphics,
    wake: &(impl Fn() + Send),
) {
    let mut bench = Bench::new(graphics);
    loop {
        let Ok(mut newest) = mailbox.newest.lock() else { return };
        let order = loop {
            if newest.1 {
                return;
            }
            if let Some(order) = newest.0.take() {
                break order;
            }
            match mailbox.changed.wait(newest) {
                Ok(guard) => newest = guard,
                Err(_) => return,
            }
        };
        drop(newest);
        if send.send(bench.draw(&order)).is_err() {
            return;
        }
        wake();
    }
}
