//! Pictures: the camera ([`orbit_camera`]), the faces of each view ([`corners`], [`colours`]),
//! lines over them ([`marks`]), what is requested and what comes back ([`frame`]), and the thread
//! that renders ([`RenderThread`]).

pub mod colours;
pub mod corners;
pub mod frame;
pub mod kind;
pub mod marks;
pub mod orbit_camera;
#[cfg(target_arch = "wasm32")]
mod render_at_once;
#[cfg(not(target_arch = "wasm32"))]
mod render_thread;
pub mod renderer;
pub mod renderer_state;

pub use frame::{LiveSurface, RenderRequest, RenderedFrame, RenderedSurface, Solid};
pub use kind::{Legend, View};
pub use orbit_camera::OrbitCamera;
#[cfg(target_arch = "wasm32")]
pub use render_at_once::RenderThread;
#[cfg(not(target_arch = "wasm32"))]
pub use render_thread::RenderThread;
pub use renderer::Graphics;
