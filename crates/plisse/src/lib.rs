//! Wrinkles and folds on coarse triangle meshes.
//!
//! A surface knows its **rest metric** (what length every edge wants to have) and its **pose** (what length it has).
//! Where the pose is shorter than the rest, the surface must leave its own plane: it wrinkles. Data flows one way:
//! [`mesh`] and [`io`] → [`rest`] → [`strain`] (from a pose that [`shell`] solved, or a file) → [`field`] → [`surface`]
//! → [`picture`] and files. [`scene`] describes such a road in a file; [`linalg`] lies under all of them.
//!
//! Units are SI everywhere: metre, pascal, radian, joule.

pub mod error;
pub mod field;
pub mod io;
pub mod linalg;
pub mod material;
pub mod mesh;
pub mod picture;
pub mod progress;
pub mod rest;
pub mod scene;
pub mod shell;
pub mod strain;
pub mod surface;

pub use error::{Error, Result};
