//! The nouns that most programs use: `use plisse::prelude::*;`

pub use crate::field::{FieldOptions, WrinkleField};
pub use crate::growth::{Expansion, GrowingSurface, GrowthMaps, GrowthOptions};
pub use crate::material::Material;
pub use crate::mesh::{Chart, RestShape, Vec2, Vec3};
pub use crate::progress::Silent;
pub use crate::scene::{self, SolveOptions};
pub use crate::sheet::Sheet;
pub use crate::shell::{BaseOptions, Clamps, Setup, solve_base};
pub use crate::wrinkles::Wrinkles;
