//! Milliseconds of each stage: by timestamps on the device, or by the clock around each stage with
//! a software driver (such drivers stamp passes when they queue them, not when they run).

use web_time::Instant;

use plisse::Result;
use plisse_live::stage::{PerStage, Stage, StageTimes};

use crate::device::Gpu;

/// Bytes between resolved stages, as wgpu asks for.
const SLOT: u64 = wgpu::QUERY_RESOLVE_BUFFER_ALIGNMENT;

pub(crate) enum Timer {
    Stamps(Stamps),
    /// Milliseconds of the last frame.
    Clock(PerStage<f64>),
    /// The adapter cannot be timed.
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
            Self::Clock(PerStage::default())
        } else {
            Stamps::new(gpu).map_or(Self::None, Self::Stamps)
        }
    }

    pub(crate) fn compute(&self, stage: Stage) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let Self::Stamps(stamps) = self else { return None };
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &stamps.queries,
            beginning_of_pass_write_index: Some(2 * stage as u32),
            end_of_pass_write_index: Some(2 * stage as u32 + 1),
        })
    }

    pub(crate) fn render(&self, stage: Stage) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let Self::Stamps(stamps) = self else { return None };
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &stamps.queries,
            beginning_of_pass_write_index: Some(2 * stage as u32),
            end_of_pass_write_index: Some(2 * stage as u32 + 1),
        })
    }

    /// Submits the commands of `stage`; waits for them where the clock times them.
    pub(crate) fn submit(
        &mut self,
        gpu: &Gpu,
        stage: Stage,
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

    /// Milliseconds of the stages in `ran`; waits for them.
    pub(crate) fn times(&self, gpu: &Gpu, ran: &PerStage<bool>) -> Result<StageTimes> {
        match self {
            Self::Stamps(stamps) => stamps.times(gpu, ran),
            Self::Clock(ms) => Ok(PerStage::from_fn(|stage| ran[stage].then_some(ms[stage]))),
            Self::None => Ok(StageTimes::default()),
        }
    }
}

impl Stamps {
    /// `None` where the adapter has none.
    fn new(gpu: &Gpu) -> Option<Self> {
        let count = 2 * Stage::ALL.len() as u32;
        let buffer = |usage| {
            let size = SLOT * Stage::ALL.len() as u64;
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

    fn times(&self, gpu: &Gpu, ran: &PerStage<bool>) -> Result<StageTimes> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        // Only what was written: others would be waited for, forever.
        for stage in Stage::ALL.into_iter().filter(|&stage| ran[stage]) {
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
        let of = |stage: Stage| &ticks[stage as usize * SLOT as usize / 8..];
        let period_ms = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        Ok(PerStage::from_fn(|stage| {
            let stamps = of(stage);
            ran[stage].then(|| stamps[1].saturating_sub(stamps[0]) as f64 * period_ms)
        }))
    }
}
