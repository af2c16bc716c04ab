//! The program in a web page (`web/index.html`): files are in memory ([`plisse::io::disk`]), what
//! is written is handed to the browser as downloads, autosaves go to its local storage. The page's
//! own script does what only scripts can.

pub mod asked;

#[cfg(target_arch = "wasm32")]
mod run;
#[cfg(target_arch = "wasm32")]
pub(crate) use run::after_frame;
#[cfg(target_arch = "wasm32")]
pub use run::{choose, later, read_dropped, start};
