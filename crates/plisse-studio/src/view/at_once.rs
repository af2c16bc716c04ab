//! The easel where there are no threads: what is ordered is drawn at once.

use super::easel::{Bench, Order, Sheet};
use super::pencil::Graphics;

/// What draws.
pub struct Easel {
    bench: Bench,
    wake: Box<dyn Fn()>,
    sheet: Option<Sheet>,
}

impl Easel {
    /// Draws by `graphics`. `wake` is called after each sheet.
    pub fn new(graphics: Graphics, wake: impl Fn() + 'static) -> Self {
        Self { bench: Bench::new(graphics), wake: Box::new(wake), sheet: None }
    }

    /// Draws a picture.
    pub fn order(&mut self, order: Order) {
        self.sheet = Some(self.bench.draw(&order));
        (self.wake)();
    }

    /// Whether a picture waits to be taken.
    pub fn is_busy(&self) -> bool {
        self.sheet.is_some()
    }

    /// The sheet that came since the last call.
    pub fn take(&mut self) -> Option<Sheet> {
        self.sheet.take()
    }
}
