//! From a coarse base surface and a wrinkle field to fine geometry (E.5 of [Chen 2021]): [`mod@upsample`] subdivides both,
//! [`mod@displace`] moves the fine vertices by eq. 19.

pub mod displace;
pub mod upsample;

pub use displace::{Displacement, displace};
pub use upsample::{Upsampled, suggest_levels, upsample};
