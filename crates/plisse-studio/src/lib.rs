//! Plissé Studio: see wrinkles, paint them, tune them, export them.
//!
//! From the bottom up: [`document`] and [`brush`] are the work itself, and know no window, no GPU
//! and no file system. [`open`] reads and writes files. [`work`] computes what takes long, and
//! [`view`] renders pictures in a thread of its own.
//!
//! The program's state is split by data: [`session`] (document and file), [`viewport`] (picture),
//! [`tools`] (brush), [`jobs`] (long work) and [`shell`] (the window around them). [`panels`] show
//! these parts and return [`commands`]; [`studio`] holds the parts and runs the commands.
//! [`window`] is the program as eframe runs it, [`page`] the program in a browser, and
//! [`automation`] drives it by scripts.

pub mod automation;
pub mod brush;
pub mod commands;
pub mod document;
pub mod fabrics;
pub mod file_chooser;
pub mod guard;
pub mod jobs;
pub mod messages;
pub mod open;
pub mod page;
pub mod panels;
pub mod session;
pub mod shell;
pub mod studio;
pub mod threads;
pub mod tools;
pub mod view;
pub mod viewport;
pub mod window;
pub mod work;

pub use shell::Tab;
pub use studio::{Start, Studio};
pub use viewport::ShownSurface;
