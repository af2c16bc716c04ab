//! Test automation: scripts ([`script`]) and the driver that runs them ([`driver`]), and timings of
//! every view without a window ([`measure`]).

pub mod driver;
#[cfg(not(target_arch = "wasm32"))]
pub mod measure;
pub mod script;
