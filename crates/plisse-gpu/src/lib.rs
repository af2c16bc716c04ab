//! The `wgpu` host of the real-time stages: buffers, passes, timers, pictures.
//!
//! The stages themselves and their CPU references are in `plisse-live`; this crate computes nothing
//! that they do not. [`Gpu`] is the adapter, [`Live`] holds the buffers of one or several
//! characters and makes their frames, [`Painter`] draws them. [`GpuBackend`] is all three for the
//! recording of one model. [`Faces`] are faces that the processor laid out. [`Average`] leaves a
//! picture on the adapter. [`memory_speed`] is the scale for the stages' times.

mod arrays;
mod average;
mod backend;
mod buffers;
mod device;
mod faces;
mod kernel;
mod kernels;
mod live;
mod memory;
mod painter;
mod timer;

pub use arrays::Character;
pub use average::Average;
pub use backend::GpuBackend;
pub use device::Gpu;
pub use faces::Faces;
pub use live::Live;
pub use memory::memory_speed;
pub use painter::Painter;
pub use wgpu;
