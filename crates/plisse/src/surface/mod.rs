//! From a coarse base surface and a wrinkle field to fine geometry (E.5 of [Chen 2021]):
//! [`mod@upsample`] subdivides both as often as [`levels`] says, [`mod@displace`] moves the fine
//! vertices by eq. 19, [`mod@keep_out`] moves vertices that then are inside a body to its surface.

pub mod displace;
pub mod keep_out;
pub mod levels;
pub mod upsample;

pub use displace::{Displacement, FirstCorrection, displace};
pub use keep_out::keep_out;
pub use levels::{MOST_FACES, MOST_LEVELS, levels_within, suggest_levels};
pub use upsample::{Upsampled, upsample};
