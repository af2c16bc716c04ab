//! Plissé Studio: see wrinkles, paint them, tune them, take them away.
//!
//! [`document`] is what is worked on and [`brush`] what paints on it; neither knows a window, a GPU or a file system. [`work`] does what takes long in
//! the background, [`view`] makes pictures on a thread of its own, [`panels`] is the window,
//! [`studio`] the program's state, [`window`] what eframe runs of it, [`page`] what is different in
//! a browser. [`open`] reads and writes files, [`guard`] keeps the work through kills, [`script`]
//! drives the program without anybody before it.

pub mod brush;
pub mod commands;
pub mod document;
pub mod driver;
pub mod fabrics;
pub mod guard;
#[cfg(not(target_arch = "wasm32"))]
pub mod measure;
pub mod messages;
pub mod open;
pub mod page;
pub mod panels;
mod reading;
pub mod script;
mod strokes;
pub mod studio;
pub mod view;
pub mod window;
pub mod work;

pub use studio::{Looking, Start, Studio, Tab};
