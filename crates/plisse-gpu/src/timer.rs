//! Milliseconds of each stage: by timestamps on the device, or, with a driver that stands in for
//! one, by the clock around each stage (such drivers stamp passes when they queue them, not when
//! they run).

use web_time::Instant;

use plisse::Result;

use crate::device::Gpu;

/// Names of the stages that are timed, in their order.
pub const STAGES: [&str; 5] = ["skin", "crush", "relax", "gather", "render"];

/// Milliseconds of each of [`STAGES`] in the last frame; none where the stage did not run or the
/// adapter cannot tell.
pub type StageTimes = [Option<f64>; 5];

/// Bytes between resolved stages, as wgpu asks for.
const SLOT: u64 = wgpu::QUERY_RESOLVE_BUFFER_ALIGNMENT;

pub(crate) enum Timer {
    Stamps(Stamps),
    /// Milliseconds of the last frame.
    Clock([f64; 5]),
    /// The adapter cannot tell.
    None,
}

/// Timestamps on the device.
pub(crate) struct Stamps {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
}

impl Timer {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        if gpu.is_software() {
            Self::Clock([0.0; 5])
        } else {
            Stamps::new(gpu).map_or(Self::None, Self::Stamps)
        }
    }

    pub(crate) fn compute(&self, stage: usize) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let Self::Stamps(stamps) = self else { return None };
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &stamps.queries,
            beginning_of_pass_write_index: Some(2 * stage as u32),
            end_of_pass_write_index: Some(2 * stage as u32 + 1),
        })
    }

    pub(crate) fn render(&self, stage: usize) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let Self::Stamps(stamps) = self else { return None };
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &stamps.queries,
            beginning_of_pass_write_index: Some(2 * stage as u32),
            end_of_pass_write_index: Some(2 * stage as u32 + 1),
        })
    }

    /// Submits what was encoded for `stage`; waits for it where the clock is what tells.
    pub(crate) fn submit(
        &mut self,
        gpu: &Gpu,
        stage: usize,
        encoder: wgpu::CommandEncoder,
    ) -> Result<()> {
        let begun = Instant::now();
        gpu.queue.submit([encoder.finish()]);
        if let Self::Clock(ms) = self {
            gpu.wait()?;
            ms[stage] = begun.elapsed().as_secs_f64() * 1e3;
        }
        Ok(())
    }

    /// What the stages in `ran` took. Waits for them.
    pub(crate) fn times(&self, gpu: &Gpu, ran: [bool; 5]) -> Result<StageTimes> {
        match self {
            Self::Stamps(stamps) => stamps.times(gpu, ran),
            Self::Clock(ms) => Ok(std::array::from_fn(|s| ran[s].then_some(ms[s]))),
            Self::None => Ok([None; 5]),
        }
    }
}

impl Stamps {
    /// `None` where the adapter has none.
    fn new(gpu: &Gpu) -> Option<Self> {
        let count = 2 * STAGES.len() as u32;
        let buffer = |usage| {
            let size = SLOT * STAGES.len() as u64;
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("times"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        gpu.has_timestamps.then(|| Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readable: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
        })
    }

    fn times(&self, gpu: &Gpu, ran: [bool; 5]) -> Result<StageTimes> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        // Only what was written: others would be waited for, forever.
        for stage in (0..STAGES.len()).filter(|&s| ran[s]) {
            let first = 2 * stage as u32;
            encoder.resolve_query_set(
                &self.queries,
                first..first + 2,
                &self.resolved,
                stage as u64 * SLOT,
            );
        }
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.readable.size());
        gpu.queue.submit([encoder.finish()]);
        let ticks: Vec<u64> = gpu.map(&self.readable)?;
        self.readable.unmap();
        let of = |stage: usize| &ticks[stage * SLOT as usize / 8..];
        let period_ms = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        Ok(std::array::from_fn(|s| {
            ran[s].then(|| of(s)[1].saturating_sub(of(s)[0]) as f64 * period_ms)
        }))
    }
}
