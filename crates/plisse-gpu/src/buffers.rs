//! The buffers of some characters on the adapter.

use bytemuck::{Pod, Zeroable};
use plisse::Result;
use wgpu::BufferUsages as Use;

use crate::arrays::{Arrays, Vertex};
use crate::device::Gpu;

/// Floats of a gathered face.
pub(crate) const FACE_FLOATS: usize = 40;

/// Uses of a buffer that never changes.
const FIXED: Use = Use::STORAGE;
/// Uses of a buffer that the stages or the host write.
const MOVING: Use = Use::STORAGE.union(Use::COPY_DST).union(Use::COPY_SRC);

/// The uniform of a stage: a count, and another number as the stage needs it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Counts {
    count: u32,
    other: u32,
    first: u32,
    unused: u32,
}

/// The uniform of a round of Relax.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct Round {
    pub(crate) vertices: u32,
    pub(crate) rate: f32,
}

/// Gathered faces, as many as the adapter takes in one buffer.
pub(crate) struct FaceBatch {
    pub(crate) faces: wgpu::Buffer,
    /// First face and the one after the last.
    pub(crate) range: [usize; 2],
}

/// The inputs, the state and the uniforms of the stages; see the WGSL texts.
pub(crate) struct Buffers {
    pub(crate) rest: wgpu::Buffer,
    pub(crate) joints: wgpu::Buffer,
    pub(crate) weights: wgpu::Buffer,
    pub(crate) palette: wgpu::Buffer,
    pub(crate) shift_starts: wgpu::Buffer,
    pub(crate) shifts: wgpu::Buffer,
    pub(crate) morph_weights: wgpu::Buffer,
    pub(crate) posed: wgpu::Buffer,
    pub(crate) starts: wgpu::Buffer,
    pub(crate) neighbours: wgpu::Buffer,
    pub(crate) bias: wgpu::Buffer,
    pub(crate) direction: wgpu::Buffer,
    pub(crate) wave: wgpu::Buffer,
    pub(crate) phase: [wgpu::Buffer; 2],
    pub(crate) corners: wgpu::Buffer,
    pub(crate) vertex_of_draw: wgpu::Buffer,
    pub(crate) uvs: wgpu::Buffer,
    pub(crate) skin_counts: wgpu::Buffer,
    pub(crate) crush_counts: wgpu::Buffer,
    pub(crate) round: wgpu::Buffer,
}

impl Buffers {
    /// The buffers of `arrays`; characters stand in no pose yet.
    pub(crate) fn new(gpu: &Gpu, arrays: &Arrays) -> Result<Self> {
        let (skinned, welded) = (arrays.rest.len(), arrays.welded_count);
        let phases = || gpu.buffer("phases", &vec![0f32; welded], MOVING);
        Ok(Self {
            rest: gpu.buffer("rest vertices", &arrays.rest, FIXED)?,
            joints: gpu.buffer("joints", &arrays.joints, FIXED)?,
            weights: gpu.buffer("joint weights", &arrays.weights, FIXED)?,
            palette: gpu.buffer("palettes", &vec![[0f32; 12]; arrays.palette_count], MOVING)?,
            shift_starts: gpu.buffer("starts of morph shifts", &arrays.shift_starts, FIXED)?,
            shifts: gpu.buffer("morph shifts", &arrays.shifts, FIXED)?,
            morph_weights: gpu.buffer("morph weights", &vec![0f32; arrays.target_count], MOVING)?,
            posed: gpu.buffer("posed vertices", &vec![Vertex::default(); skinned], MOVING)?,
            starts: gpu.buffer("starts of neighbours", &arrays.starts, FIXED)?,
            neighbours: gpu.buffer("neighbours", &arrays.neighbours, FIXED)?,
            bias: gpu.buffer("biases", &arrays.bias, FIXED)?,
            direction: gpu.buffer("directions", &vec![[0f32; 4]; welded], MOVING)?,
            wave: gpu.buffer("waves", &vec![[0f32; 4]; welded], MOVING)?,
            phase: [phases()?, phases()?],
            corners: gpu.buffer("corners", &arrays.corners, FIXED)?,
            vertex_of_draw: gpu.buffer(
                "vertices of draw vertices",
                &arrays.vertex_of_draw,
                FIXED,
            )?,
            uvs: gpu.buffer("texture coordinates", &arrays.uvs, FIXED)?,
            skin_counts: counts(gpu, skinned, arrays.groups, 0)?,
            crush_counts: counts(gpu, welded, usize::from(!arrays.bias.is_empty()), 0)?,
            round: gpu.buffer(
                "round",
                &[Round { vertices: welded as u32, rate: 0.0 }],
                Use::UNIFORM | Use::COPY_DST,
            )?,
        })
    }

    /// Room for the gathered faces in batches, each with its uniform.
    pub(crate) fn face_batches(
        gpu: &Gpu,
        arrays: &Arrays,
    ) -> Result<(Vec<FaceBatch>, Vec<wgpu::Buffer>)> {
        let faces = arrays.corners.len() / 3;
        let most = (gpu.most_bytes(Use::STORAGE) / (4 * FACE_FLOATS as u64)) as usize;
        let (mut batches, mut uniforms) = (Vec::new(), Vec::new());
        for first in (0..faces).step_by(most) {
            let end = faces.min(first + most);
            let room = vec![[0f32; FACE_FLOATS]; end - first];
            let buffer = gpu.buffer("faces", &room, MOVING | Use::VERTEX)?;
            batches.push(FaceBatch { faces: buffer, range: [first, end] });
            uniforms.push(counts(gpu, end - first, arrays.welded_count, first)?);
        }
        Ok((batches, uniforms))
    }
}

fn counts(gpu: &Gpu, count: usize, other: usize, first: usize) -> Result<wgpu::Buffer> {
    let [count, other, first] = [count, other, first].map(|n| n as u32);
    gpu.buffer("counts", &[Counts { count, other, first, unused: 0 }], Use::UNIFORM)
}
