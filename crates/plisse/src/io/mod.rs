//! Files in and out: triangle meshes from OBJ text ([`obj`]) and PLY ([`ply_mesh`]), clamped
//! vertices from a list ([`clamp_file`]), a posed mesh with its rest shape ([`garment`]); meshes to
//! OBJ, binary PLY with per-vertex values ([`ply`]) and binary glTF ([`glb`]).
//!
//! All writers go to any [`std::io::Write`]. They usually go to a staged output folder
//! ([`staged`]), in which the files of a run appear together at its end or not at all. All reading
//! by path goes through [`disk`]; in a web page that is a [`store`] in memory.
//!
//! Nothing here but [`garment`] judges a mesh: connectivity, orientation and degenerate faces are
//! for [`crate::mesh`].

#[cfg_attr(target_arch = "wasm32", path = "staged_in_memory.rs")]
pub mod staged;
// The staged folder of web pages; elsewhere it is only tested.
pub mod clamp_file;
pub mod disk;
pub mod garment;
pub mod glb;
pub mod obj;
pub mod ply;
pub mod ply_mesh;
mod polygon;
#[allow(unreachable_pub)]
#[cfg(all(test, not(target_arch = "wasm32")))]
pub mod staged_in_memory;
pub mod store;
