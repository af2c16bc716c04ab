//! The kernels of the stages Skin, Crush, Relax and Gather, bound to their buffers.

use plisse_live::stage::Stage;
use plisse_live::wgsl;

use crate::buffers::{Buffers, FaceBatch};
use crate::device::Gpu;
use crate::kernel::{Dispatch, Kernel};

/// One kernel for each stage that computes.
pub(crate) struct Kernels {
    pub(crate) skin: Kernel,
    pub(crate) crush: Kernel,
    /// Dispatch 0 reads the first buffer of phases and writes the second; dispatch 1 goes back.
    pub(crate) relax: Kernel,
    /// Dispatches 2b and 2b + 1 make batch b from the first and from the second buffer of phases.
    pub(crate) gather: Kernel,
}

impl Kernels {
    /// The kernels for these numbers of skinned and welded vertices. `batches` have their uniforms
    /// in `batch_counts`.
    pub(crate) fn new(
        gpu: &Gpu,
        b: &Buffers,
        batches: &[FaceBatch],
        batch_counts: &[wgpu::Buffer],
        [skinned, welded]: [usize; 2],
    ) -> Self {
        let skin = vec![
            &b.skin_counts,
            &b.rest,
            &b.joints,
            &b.weights,
            &b.palette,
            &b.shift_starts,
            &b.shifts,
            &b.morph_weights,
            &b.posed,
        ];
        let crush = vec![
            &b.crush_counts,
            &b.rest,
            &b.posed,
            &b.starts,
            &b.neighbours,
            &b.bias,
            &b.direction,
            &b.wave,
        ];
        // From either buffer of phases to the other.
        let relax = [[0, 1], [1, 0]].map(|[from, to]| {
            let (from, to) = (&b.phase[from], &b.phase[to]);
            let buffers = vec![&b.round, &b.posed, &b.wave, &b.starts, &b.neighbours, from, to];
            Dispatch { threads: welded, buffers }
        });
        // Each batch from either buffer of phases.
        let gather: Vec<Dispatch<'_>> = batches
            .iter()
            .zip(batch_counts)
            .flat_map(|(batch, counts)| {
                b.phase.each_ref().map(|phase| Dispatch {
                    threads: batch.range[1] - batch.range[0],
                    buffers: vec![
                        counts,
                        &b.corners,
                        &b.vertex_of_draw,
                        &b.uvs,
                        &b.posed,
                        &b.wave,
                        phase,
                        &batch.faces,
                    ],
                })
            })
            .collect();
        let one = |stage, text, threads, buffers| {
            Kernel::new(gpu, stage, text, &[Dispatch { threads, buffers }])
        };
        Self {
            skin: one(Stage::Skin, wgsl::SKIN, skinned, skin),
            crush: one(Stage::Crush, wgsl::CRUSH, welded, crush),
            relax: Kernel::new(gpu, Stage::Relax, wgsl::RELAX, &relax),
            gather: Kernel::new(gpu, Stage::Gather, wgsl::GATHER, &gather),
        }
    }
}
