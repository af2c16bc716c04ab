//! From a coarse base surface and a wrinkle field to fine geometry (E.5 of [Chen 2021]): [`mod@upsample`] subdivides both,
//! [`mod@displace`] moves the fine vertices by eq. 19, [`mod@keep_out`] lays what then is inside a body on its surface.

pub mod displace;
pub mod keep_out;
pub mod upsample;

pub use displace::{Displacement, displace};
pub use keep_out::keep_out;
pub use upsample::{Upsampled, suggest_levels, upsample};
