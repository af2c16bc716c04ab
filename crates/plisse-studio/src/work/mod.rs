//! What takes long: jobs in the background with progress and cancel ([`job`]), solving a scene
//! ([`solve`]), growing ([`grow`]), folding under the brush ([`fold`]), and the files that are
//! taken away ([`export`], [`scene_files`]).

pub mod export;
pub mod fold;
pub mod grow;
pub mod job;
pub mod scene_files;
pub mod solve;
