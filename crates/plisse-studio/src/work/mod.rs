//! Long work: background jobs with progress and cancel ([`job`]), the solve of a scene ([`solve`]),
//! growth ([`grow`]), folding under the brush ([`fold`]), and export ([`export`], [`scene_files`]).

pub mod export;
pub mod fold;
pub mod grow;
pub mod job;
pub mod scene_files;
pub mod solve;
