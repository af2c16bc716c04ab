//! The parts of the window: the menu and the status line, the panel of each tab, the picture, and
//! questions. A panel changes the data that it is given, and returns commands for what reaches
//! further.

pub mod canvas;
pub mod export;
pub mod grow;
pub mod live;
pub mod menu;
pub mod paint;
pub mod physics;
pub mod plots;
pub mod questions;
pub mod widgets;
