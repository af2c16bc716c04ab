//! A model with all that its wrinkles need: the start of every road through this crate.

use crate::live::LiveOptions;
use crate::model::Model;
use crate::profile::Profile;
use crate::wavelength;
use crate::weld::{WeldedMesh, fill_normals};

/// Vertices closer than this share of the model's size are welded.
const TOLERANCE: f32 = 1e-5;

/// A model ready to be wrinkled.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveModel {
    /// The model, with a normal at each draw vertex.
    pub model: Model,
    /// Its welded mesh.
    pub welded: WeldedMesh,
    /// Settings of the stages.
    pub options: LiveOptions,
    /// Profile of the wrinkles.
    pub profile: Profile,
    /// The wavelength (m, rest) of which vertices have shares.
    pub wavelength_m: f64,
}

impl LiveModel {
    /// Welds `model` and fills in its normals; usual options for wrinkles of this wavelength (m,
    /// rest), or of the share of it that the model's vertex colours give.
    pub fn new(mut model: Model, wavelength_m: f64, profile: Profile) -> Self {
        let welded = WeldedMesh::new(&model, TOLERANCE);
        fill_normals(&mut model, &welded);
        let options = LiveOptions::new(wavelength_m as f32);
        let mut live = Self { model, welded, options, profile, wavelength_m };
        live.set_wavelength_shares(live.model.wavelength_share.clone().as_deref());
        live
    }

    /// Sets shares of the wavelength at the draw vertices (`[V]`), or the whole of it everywhere.
    pub fn set_wavelength_shares(&mut self, shares: Option<&[f32]>) {
        self.options.wavelength_m =
            wavelength::per_vertex(&self.welded, self.wavelength_m as f32, shares);
    }
}
