//! Files in and out: triangle meshes from OBJ text ([`obj`]) and PLY ([`ply_mesh`]), clamped vertices from a list ([`clamp_file`]), a worn mesh with its
//! rest shape ([`worn`]); meshes to OBJ,
//! binary PLY with per-vertex values ([`ply`]) and binary glTF ([`glb`]). All writers go to any [`std::io::Write`];
//! [`aside`] is the folder they usually go to, in which a run's files appear together at its end or not at all.
//!
//! Nothing here but [`worn`] judges a mesh: connectivity, orientation and degenerate faces are for [`crate::mesh`].

pub mod aside;
pub mod clamp_file;
pub mod glb;
pub mod obj;
pub mod ply;
pub mod ply_mesh;
mod polygon;
pub mod worn;
