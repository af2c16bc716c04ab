//! Wrinkles and folds on coarse triangle meshes.
//!
//! A thin sheet that is shorter in its pose than it is at rest must leave its own plane: it
//! wrinkles. From a coarse mesh at rest, its pose and a material this library solves for the
//! amplitude, the frequency and the phase of those wrinkles, and makes fine surfaces, maps and
//! files of them. It also solves for the pose itself, under clamps, loads and contact, and folds
//! surfaces that grow.
//!
//! # From arrays to a wrinkled surface
//!
//! `rest` and `pose` hold a position (m) for each vertex, `faces` three vertices for each triangle.
//!
//! ```
//! use plisse::prelude::*;
//! # // A strip of 20 × 4 squares of 1 cm, pressed together by 2 % along x.
//! # let at = |v: usize| Vec3::new(0.01 * (v % 21) as f64, 0.01 * (v / 21) as f64, 0.0);
//! # let rest: Vec<Vec3> = (0..105).map(at).collect();
//! # let squares = (0..84).filter(|v| v % 21 != 20);
//! # let faces: Vec<[usize; 3]> =
//! #     squares.flat_map(|v| [[v, v + 1, v + 22], [v, v + 22, v + 21]]).collect();
//! # let pose: Vec<Vec3> = rest.iter().map(|p| Vec3::new(0.98 * p.x, p.y, 0.0)).collect();
//! // Young's modulus (Pa), Poisson's ratio, thickness (m)
//! let material = Material::new(1e6, 0.3, 1e-4)?;
//! let sheet = Sheet::from_rest(rest, faces, material)?;
//! let wrinkles = sheet.wrinkle(&pose)?;
//! let surface = wrinkles.surface(None);
//! println!("{} vertices, {:?}", surface.positions.len(), wrinkles.field.wavelengths(&sheet));
//! # assert!(wrinkles.field.largest_amplitude_m() > 1e-4);
//! # Ok::<(), plisse::Error>(())
//! ```
//!
//! [`Wrinkles`] also bakes height and normal maps and saves OBJ, GLB and JSON files.
//!
//! # From clamps to a pose
//!
//! ```
//! use plisse::prelude::*;
//! # let at = |v: usize| Vec3::new(0.02 * (v % 11) as f64, 0.02 * (v / 11) as f64, 0.0);
//! # let rest: Vec<Vec3> = (0..66).map(at).collect();
//! # let squares = (0..55).filter(|v| v % 11 != 10);
//! # let faces: Vec<[usize; 3]> =
//! #     squares.flat_map(|v| [[v, v + 1, v + 12], [v, v + 12, v + 11]]).collect();
//! # let sheet = Sheet::from_rest(rest.clone(), faces, Material::new(1e6, 0.5, 1e-4)?)?;
//! // Both short sides are held, one of them is pulled 1 cm along x.
//! let mut clamps = Clamps::none(rest.len());
//! for (v, p) in rest.iter().enumerate().filter(|(_, p)| p.x == 0.0 || p.x == 0.2) {
//!     clamps.hold(v, if p.x == 0.0 { *p } else { p + Vec3::x() * 0.01 });
//! }
//! let setup = Setup::new(&sheet, &clamps);
//! let (pose, _) = solve_base(&setup, &rest, &BaseOptions::default(), &Silent)?;
//! let wrinkles = sheet.wrinkle_with(&pose, &clamps.held(), &FieldOptions::default(), &Silent)?;
//! # assert_eq!(wrinkles.field.amplitude_m.len(), rest.len());
//! # Ok::<(), plisse::Error>(())
//! ```
//!
//! # From a scene file
//!
//! ```
//! use plisse::prelude::*;
//!
//! let text = r#"
//!     title = "A sheet pulled along x"
//!     material = { young_pa = 1e6, poisson = 0.5, thickness_m = 1e-4 }
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
//! let surface = solved.surface(Some(2));
//! # assert!(solved.field.largest_amplitude_m() > 1e-5 && !surface.positions.is_empty());
//! # Ok::<(), plisse::Error>(())
//! ```
//!
//! # Modules
//!
//! Data flows one way: [`mesh`] and [`io`] → [`rest`] and [`sheet`] → [`strain`] of a pose (from a
//! file, or solved by [`shell`]) → [`field`] → [`surface`] and [`bake`] → [`wrinkles`]. [`growth`]
//! folds the mesh itself. [`scene`] describes all of it in a file, [`picture`] draws it, and
//! [`linalg`] lies under the solves.
//!
//! # Units and notation
//!
//! Units are SI everywhere (m, Pa, N, J, kg/m³, rad, s) and stand in names: `thickness_m`,
//! `young_pa`. A vertex, edge or face is its number, from 0. The same input gives the same bytes
//! for any number of threads.
//!
//! | sign | array with one entry |
//! |---|---|
//! | `[V]` | per vertex of the surface |
//! | `[E]` | per edge, which runs from its lower to its higher vertex |
//! | `[F]` | per face; `[F][3]` per corner of each face |
//! | `[R]` | per vertex of the rest shape: R ≥ V, since seams double vertices |
//! | `[T]` | per point of a chart |
//! | `[U]`, `[P]` | per welded vertex and per palette entry of a model (in `plisse-live`) |
//! | `[n]` | per unknown of a solve |
//! | `[b₁]` | per independent loop of the wrinkled faces (first Betti number) |
//!
//! "eq. 22", "4.1" or "appendix E" without a name is of [Chen 2021]. `docs/notation.md` explains
//! the letters of the formulas, too.
//!
//! # References
//!
//! - [Chen 2021]: Chen et al., *Fine Wrinkling on Coarsely Meshed Thin Shells*: the wrinkle field
//! - [Loviscach 2006]: *Wrinkling Coarse Meshes on the GPU*: `plisse-live`, normal maps
//! - [Combaz & Neyret 2002]: *Painting Folds using Expansion Textures*: [`growth`]
//! - [Li et al. 2020]: *Incremental Potential Contact*: the barrier of contact
//! - [Bertsekas 1982], [Schnorr & Euchner 1994], [George 1973], [Liu 1992]: [`linalg`]
//!
//! [Chen 2021]: https://doi.org/10.1145/3462758
//! [Loviscach 2006]: https://doi.org/10.1111/j.1467-8659.2006.00966.x
//! [Combaz & Neyret 2002]: https://doi.org/10.1109/PCCGA.2002.1167853
//! [Li et al. 2020]: https://doi.org/10.1145/3386569.3392425
//! [Bertsekas 1982]: https://doi.org/10.1137/0320018
//! [Schnorr & Euchner 1994]: https://doi.org/10.1007/BF01581144
//! [George 1973]: https://doi.org/10.1137/0710032
//! [Liu 1992]: https://doi.org/10.1137/1034004

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
pub mod prelude;
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
pub mod wrinkles;

pub use error::{At, Error, Result};
pub use material::Material;
pub use mesh::{Chart, RestShape};
pub use sheet::Sheet;
pub use wrinkles::Wrinkles;
