//! Remeshing on random meshes. What must stay is in [`checks`]; each check is shown to fail on a
//! surface that was spoilt.

mod checks;
mod driven;
mod meshes;
mod operations;
