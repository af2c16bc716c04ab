//! The part of a sheet on which a wrinkle field lives: the faces that are not wrinkle-free, and the
//! closed one-forms on them.

use super::closed_forms::ClosedForms;
use super::solve::FieldOptions;
use super::wrinkle_free::{wrinkle_free_faces, wrinkle_free_vertices};
use crate::mesh::Topology;
use crate::strain::FaceStrain;

/// The domain of a wrinkle field.
pub struct Domain {
    /// `[F]` true for wrinkle-free faces.
    pub wrinkle_free: Vec<bool>,
    /// `[V]` true for vertices whose amplitude is zero: they touch a wrinkle-free face or are held.
    pub still: Vec<bool>,
    /// The closed forms on the other faces.
    pub forms: ClosedForms,
}

impl Domain {
    /// The domain for this `strain` (`[F]`) with the `held` vertices (`[V]`).
    pub fn new(
        topology: &Topology,
        strain: &[FaceStrain],
        held: &[bool],
        options: &FieldOptions,
    ) -> Self {
        let wrinkle_free = if options.relaxed_integrability {
            wrinkle_free_faces(topology, strain, options.rule)
        } else {
            vec![false; topology.face_count()]
        };
        let mut still = wrinkle_free_vertices(topology, &wrinkle_free);
        for (still, &held) in still.iter_mut().zip(held) {
            *still |= held;
        }
        let forms = ClosedForms::new(topology, &wrinkle_free);
        Self { wrinkle_free, still, forms }
    }
}
