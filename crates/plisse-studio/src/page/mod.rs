//! The program in a web page (`web/index.html`). Files are in memory ([`plisse::io::disk`]),
//! exports become downloads, and autosaves go to the browser's local storage. The page's own script
//! does what only scripts can.

pub mod asked;
#[cfg(target_arch = "wasm32")]
pub(crate) mod bindings;
#[cfg(target_arch = "wasm32")]
pub(crate) mod files;
#[cfg(target_arch = "wasm32")]
mod run;

#[cfg(target_arch = "wasm32")]
pub use run::start;
