//! Wrinkles and folds on coarse triangle meshes.
//!
//! A surface knows its **rest metric** (what length every edge wants to have) and its **pose**
//! (what length it has). Where the pose is shorter than the rest, the surface must leave its own
//! plane: it wrinkles. Data flows one way:
//! [`mesh`] and [`io`] → [`rest`] → [`strain`] (from a pose that [`shell`] solved, or a file) → [`field`] → [`surface`]
//! → [`bake`], [`picture`] and the files of [`wrinkled`]. [`scene`] describes such a road in a file; [`linalg`] lies under all of them.
//!
//! Units are SI everywhere: metre, pascal, radian, joule.
//!
//! ```
//! use plisse::progress::Silent;
//! use plisse::scene::{self, SolveOptions};
//!
//! let text = r#"
//!     title = "A sheet pulled along x"
//!     [material]
//!     young_pa = 1e6
//!     poisson = 0.5
//!     thickness_m = 1e-4
//!     [[panel]]
//!     name = "sheet"
//!     shape = "rectangle"
//!     width_m = 0.25
//!     height_m = 0.1
//!     edge_length_m = 0.015
//!     [[clamp]]
//!     side = "sheet.left"
//!     [[clamp]]
//!     side = "sheet.right"
//!     move_m = [0.0125, 0.0, 0.0]
//! "#;
//! let scene = scene::parse("sheet.toml", text)?;
//! let solved = scene::solve(&scene, &SolveOptions::default(), &Silent)?;
//! assert!(solved.field.amplitude_m.iter().any(|&a| a > 1e-5));
//!
//! let surface = solved.surface(Some(2));
//! assert_eq!(surface.positions.len(), surface.fine.topology.vertex_count);
//! # Ok::<(), plisse::Error>(())
//! ```

pub mod adjacency;
pub mod bake;
pub mod error;
pub mod field;
pub mod growth;
pub mod io;
pub mod linalg;
pub mod material;
pub mod mesh;
pub mod obstacle;
pub mod picture;
pub mod progress;
pub mod random;
pub mod relief;
pub mod remesh;
pub mod rest;
pub mod scene;
pub mod self_contact;
pub mod sheet;
pub mod shell;
pub mod strain;
pub mod surface;
pub mod wrinkled;

pub use error::{At, Error, Result};
pub use material::Material;
pub use mesh::{Chart, RestShape};
pub use sheet::Sheet;
