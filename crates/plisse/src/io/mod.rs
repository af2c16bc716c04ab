//! Files in and out: triangle meshes from OBJ text ([`obj`]) and PLY ([`ply_mesh`]), clamped
//! vertices from a list ([`clamp_file`]), a worn mesh with its rest shape ([`worn`]); meshes to
//! OBJ, binary PLY with per-vertex values ([`ply`]) and binary glTF ([`glb`]). All writers go to
//! any [`std::io::Write`];
//! [`aside`] is the folder they usually go to, in which a run's files appear together at its end or not at all;
//! [`disk`] is where files are, in a web page a [`store`] in memory.
//!
//! Nothing here but [`worn`] judges a mesh: connectivity, orientation and degenerate faces are for
//! [`crate::mesh`].

#[cfg_attr(target_arch = "wasm32", path = "aside_in_memory.rs")]
pub mod aside;
// Public where it is the one; here it is only tested.
#[allow(unreachable_pub)]
#[cfg(all(test, not(target_arch = "wasm32")))]
pub mod aside_in_memory;
pub mod clamp_file;
pub mod disk;
pub mod glb;
pub mod obj;
pub mod ply;
pub mod ply_mesh;
mod polygon;
pub mod store;
pub mod worn;
