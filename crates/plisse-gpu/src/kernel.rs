//! Compute passes: a stage's pipeline with the buffers it runs on.

use plisse::Result;
use plisse_live::stage::Stage;

use crate::device::Gpu;
use crate::timer::Timer;

/// Threads of a workgroup, as the WGSL texts have it.
pub(crate) const GROUP: u32 = 64;

/// The buffers of one dispatch, in the order of their bindings, and its number of threads.
pub(crate) struct Dispatch<'a> {
    pub(crate) threads: usize,
    pub(crate) buffers: Vec<&'a wgpu::Buffer>,
}

/// A stage with as many dispatches as it may be run with.
pub(crate) struct Kernel {
    stage: Stage,
    pipeline: wgpu::ComputePipeline,
    arguments: Vec<wgpu::BindGroup>,
    /// Workgroups of each dispatch.
    groups: Vec<u32>,
}

impl Kernel {
    /// The kernel of `stage`, whose WGSL is `text`.
    pub(crate) fn new(gpu: &Gpu, stage: Stage, text: &str, dispatches: &[Dispatch<'_>]) -> Self {
        let name = stage.name();
        let source = wgpu::ShaderSource::Wgsl(text.into());
        let module = gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module: &module,
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        let layout = pipeline.get_bind_group_layout(0);
        let bind_group = |dispatch: &Dispatch<'_>| {
            let entries: Vec<wgpu::BindGroupEntry<'_>> = dispatch
                .buffers
                .iter()
                .enumerate()
                .map(|(b, buffer)| wgpu::BindGroupEntry {
                    binding: b as u32,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(name),
                layout: &layout,
                entries: &entries,
            })
        };
        let groups = dispatches.iter().map(|d| (d.threads as u32).div_ceil(GROUP)).collect();
        Self { stage, arguments: dispatches.iter().map(bind_group).collect(), pipeline, groups }
    }

    /// Runs one timed pass over the dispatches with these numbers.
    pub(crate) fn run(
        &self,
        gpu: &Gpu,
        timer: &mut Timer,
        numbers: impl IntoIterator<Item = usize>,
    ) -> Result<()> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let timestamp_writes = timer.compute(self.stage);
        let descriptor = wgpu::ComputePassDescriptor { label: None, timestamp_writes };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        for number in numbers {
            pass.set_bind_group(0, &self.arguments[number], &[]);
            pass.dispatch_workgroups(self.groups[number], 1, 1);
        }
        drop(pass);
        timer.submit(gpu, self.stage, encoder)
    }
}
