//! Models to test with.

use plisse_gpu::Character;
use plisse_live::Vec3;
use plisse_live::live::LiveOptions;
use plisse_live::model::Model;
use plisse_live::skin::{Pose, pose};
use plisse_live::weld::{WeldedMesh, fill_normals};

/// A model with its welded vertices and a wavelength that suits it.
pub(crate) struct Subject {
    pub(crate) model: Model,
    pub(crate) welded: WeldedMesh,
    pub(crate) wavelength_m: f32,
}

impl Subject {
    pub(crate) fn new(mut model: Model) -> Self {
        let welded = WeldedMesh::new(&model, 1e-5);
        fill_normals(&mut model, &welded);
        let low =
            welded.vertices.positions.iter().fold(Vec3::repeat(f32::INFINITY), |a, p| a.inf(p));
        let high =
            welded.vertices.positions.iter().fold(Vec3::repeat(f32::NEG_INFINITY), |a, p| a.sup(p));
        Self { wavelength_m: 0.06 * (high - low).norm(), model, welded }
    }

    pub(crate) fn character(&self) -> Character<'_> {
        Character {
            model: &self.model,
            welded: &self.welded,
            wavelength_m: std::slice::from_ref(&self.wavelength_m),
            bias: &[],
        }
    }

    pub(crate) fn pose(&self, time_s: f32) -> Pose {
        pose(&self.model, self.model.clip(None), time_s)
    }

    pub(crate) fn size(&self) -> f32 {
        self.wavelength_m / 0.06
    }
}

/// Options with few rounds and without propagation, which would wait for the GPU.
pub(crate) fn options(subject: &Subject) -> LiveOptions {
    LiveOptions {
        rounds: 1,
        first_rounds: 20,
        propagate_new: false,
        ..LiveOptions::new(subject.wavelength_m)
    }
}
