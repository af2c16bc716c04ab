//! Faces that the processor laid out, ready to be drawn: an editor shows them besides the frames of
//! [`crate::Live`], for example a solved surface, or colours that stand for numbers.

use plisse::Result;
use plisse_live::render::Corner;

use crate::buffers::{FACE_FLOATS, FaceBatch};
use crate::device::Gpu;

/// Gathered faces from the processor.
pub struct Faces {
    pub(crate) batches: Vec<FaceBatch>,
    count: usize,
}

impl Faces {
    /// Uploads `faces` to the adapter.
    ///
    /// # Errors
    /// [`plisse::Error::Numeric`] if the device fails.
    pub fn new(gpu: &Gpu, faces: &[[Corner; 3]]) -> Result<Self> {
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let most = ((gpu.most_bytes(usage) / (4 * FACE_FLOATS as u64)) as usize).max(1);
        let mut batches = Vec::new();
        for (i, part) in faces.chunks(most).enumerate() {
            let buffer = gpu.buffer("faces", &packed(part), usage)?;
            batches.push(FaceBatch { faces: buffer, range: [i * most, i * most + part.len()] });
        }
        gpu.check()?;
        Ok(Self { batches, count: faces.len() })
    }

    /// Replaces the faces. Buffers are kept if there are as many faces as before.
    ///
    /// # Errors
    /// As [`Faces::new`].
    pub fn set(&mut self, gpu: &Gpu, faces: &[[Corner; 3]]) -> Result<()> {
        if faces.len() != self.count {
            *self = Self::new(gpu, faces)?;
        } else {
            self.batches
                .iter()
                .for_each(|b| gpu.write(&b.faces, &packed(&faces[b.range[0]..b.range[1]])));
        }
        gpu.check()
    }
}

/// The faces in the layout of gather.wgsl.
fn packed(faces: &[[Corner; 3]]) -> Vec<[f32; FACE_FLOATS]> {
    let one = |corners: &[Corner; 3]| {
        let mut face = [0.0; FACE_FLOATS];
        for (c, corner) in corners.iter().enumerate() {
            let mut put = |at: usize, v: &plisse_live::Vec3, w: f32| {
                face[at + 4 * c..at + 4 * c + 4].copy_from_slice(&[v.x, v.y, v.z, w]);
            };
            put(0, &corner.position, corner.amplitude_m);
            put(12, &corner.normal, corner.phase);
            put(24, &corner.wave, corner.uv.x);
            face[36 + c] = corner.uv.y;
        }
        face
    };
    faces.iter().map(one).collect()
}
