//! The `wgpu` host of the real-time stages: buffers, passes, timers, pictures.
//!
//! The stages themselves and their twins are in `plisse-live`; nothing here computes anything that
//! they do not. [`Gpu`] is the adapter, [`Live`] the buffers of one or several characters whose
//! frames it makes, [`Painter`] draws them.
//! [`Faces`] are faces that come from the processor instead. [`Average`] leaves a picture on the adapter. [`memory_speed`] is what
//! the stages' times are measured against.

mod arrays;
mod average;
mod device;
mod faces;
mod live;
mod memory;
mod painter;
mod timer;

pub use arrays::Character;
pub use average::Average;
pub use device::Gpu;
pub use faces::Faces;
pub use live::{Live, Waves};
pub use memory::memory_speed;
pub use painter::Painter;
pub use timer::{STAGES, StageTimes};
pub use wgpu;
