//! Speed of the adapter's memory, measured by a copy: the scale for stages that only move bytes.

use plisse::Result;
use plisse_live::stage::{PerStage, Stage};

use crate::device::Gpu;
use crate::timer::Timer;

/// Size of the copy (bytes), if the adapter takes so many at once: more than caches hold.
const COPIED: u64 = 128 << 20;
/// Bytes that a workgroup of memory.wgsl copies.
const OF_A_GROUP: u64 = 256 * 16;
/// Number of copies, of which the median counts.
const RUNS: usize = 9;
/// The stage in whose place the copy is timed; any will do.
const SLOT: Stage = Stage::Skin;

/// Bytes read and written per second; `None` where the adapter cannot be timed.
///
/// # Errors
/// [`plisse::Error::Numeric`] if the device fails.
pub fn memory_speed(gpu: &Gpu) -> Result<Option<f64>> {
    use wgpu::BufferUsages as Use;
    let groups = COPIED.min(gpu.most_bytes(Use::STORAGE)) / OF_A_GROUP;
    let groups = (groups as u32).min(gpu.device.limits().max_compute_workgroups_per_dimension);
    let bytes = u64::from(groups) * OF_A_GROUP;
    let buffer = |label| {
        let descriptor = wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage: Use::STORAGE,
            mapped_at_creation: false,
        };
        gpu.device.create_buffer(&descriptor)
    };
    let (source, copy) = (buffer("source"), buffer("copy"));
    let text = wgpu::ShaderSource::Wgsl(include_str!("memory.wgsl").into());
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("memory"), source: text });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("memory"),
        layout: None,
        module: &module,
        entry_point: Some("copy_memory"),
        compilation_options: Default::default(),
        cache: None,
    });
    let arguments = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("memory"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: source.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: copy.as_entire_binding() },
        ],
    });
    let mut timer = Timer::new(gpu);
    let ran = PerStage::from_fn(|stage| stage == SLOT);
    let mut seconds = Vec::with_capacity(RUNS);
    for _ in 0..RUNS {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: timer.compute(SLOT),
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &arguments, &[]);
        pass.dispatch_workgroups(groups, 1, 1);
        drop(pass);
        timer.submit(gpu, SLOT, encoder)?;
        seconds.extend(timer.times(gpu, &ran)?[SLOT].map(|ms| ms * 1e-3).filter(|&s| s > 0.0));
    }
    gpu.check()?;
    seconds.sort_by(f64::total_cmp);
    Ok(seconds.get(seconds.len() / 2).map(|s| 2.0 * bytes as f64 / s))
}
