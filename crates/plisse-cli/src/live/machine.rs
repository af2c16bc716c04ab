//! What makes the frames: the GPU, or the twins of its stages on the processor.

use std::time::Instant;

use plisse::Result;
use plisse_gpu::{Character, Gpu, Live, Painter, STAGES, StageTimes};
use plisse_live::camera::Camera;
use plisse_live::crush::{CrushInput, crush};
use plisse_live::draw::{Look, Picture, SAMPLES, draw};
use plisse_live::gather::gather;
use plisse_live::live::LiveState;
use plisse_live::skin::{Pose, skin};
use plisse_live::texture::Texture;

use crate::animated::Animated;

/// The GPU with everything on it.
pub(super) struct Device {
    gpu: Gpu,
    live: Live,
    painter: Painter,
    frame: usize,
}

/// The twins' state.
pub(super) struct Twins {
    state: LiveState,
    times: StageTimes,
    size: [usize; 2],
}

pub(super) enum Machine {
    Gpu(Box<Device>),
    Processor(Box<Twins>),
}

fn character(animated: &Animated) -> Character<'_> {
    let Animated { model, unified, options, .. } = animated;
    Character { model, unified, wavelength_m: &options.wavelength_m, bias: &options.bias }
}

impl Machine {
    /// Ready for the first frame of `animated`.
    pub(super) fn new(
        on_processor: bool,
        animated: &Animated,
        size: [usize; 2],
        texture: &Texture,
    ) -> Result<Self> {
        if on_processor {
            return Ok(Self::Processor(Box::new(Twins {
                state: LiveState::default(),
                times: [None; 5],
                size,
            })));
        }
        let gpu = Gpu::new()?;
        let live = Live::new(&gpu, &[character(animated)])?;
        let painter = Painter::new(&gpu, size, SAMPLES, &[texture])?;
        Ok(Self::Gpu(Box::new(Device { gpu, live, painter, frame: 0 })))
    }

    /// The adapter's name.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Gpu(device) => device.gpu.adapter.clone(),
            Self::Processor(_) => format!("processor ({} threads)", rayon::current_num_threads()),
        }
    }

    /// Goes on to the next frame.
    pub(super) fn step(&mut self, animated: &Animated, pose: &Pose) -> Result<()> {
        match self {
            Self::Gpu(device) => {
                let Device { gpu, live, frame, .. } = &mut **device;
                if *frame == 0 {
                    live.begin(gpu, &[character(animated)], &[pose], &animated.options)?;
                } else {
                    live.step(gpu, &[pose], &animated.options)?;
                }
                *frame += 1;
            }
            Self::Processor(twins) => {
                let Twins { state, times, .. } = &mut **twins;
                *times = [None; 5];
                let mut begun = Instant::now();
                state.step_watched(&animated.unified, pose, &animated.options, |stage| {
                    let number = STAGES
                        .iter()
                        .position(|s| *s == stage)
                        .expect("the stages have these names");
                    times[number] = Some(begun.elapsed().as_secs_f64() * 1e3);
                    begun = Instant::now();
                });
            }
        }
        Ok(())
    }

    /// The waves of this frame.
    pub(super) fn state(&self) -> Result<LiveState> {
        match self {
            Self::Gpu(device) => {
                let waves = device.live.read(&device.gpu)?;
                Ok(LiveState {
                    frame: device.frame,
                    posed: waves.posed,
                    crushed: waves.crushed,
                    phase: waves.phase,
                })
            }
            Self::Processor(twins) => Ok(twins.state.clone()),
        }
    }

    /// A picture of this frame.
    pub(super) fn draw(
        &mut self,
        animated: &Animated,
        pose: &Pose,
        camera: &Camera,
        look: &Look<'_>,
    ) -> Result<Picture> {
        match self {
            Self::Gpu(device) => {
                device.painter.draw(&device.gpu, &mut device.live, camera, look)?;
                device.painter.read(&device.gpu)
            }
            Self::Processor(twins) => {
                let Twins { state, times, size } = &mut **twins;
                let begun = Instant::now();
                let drawn = skin(&animated.model.draw, pose);
                let faces = gather(
                    &animated.model,
                    &animated.unified,
                    &state.posed,
                    &drawn,
                    &state.crushed,
                    &state.phase,
                );
                times[3] = Some(begun.elapsed().as_secs_f64() * 1e3);
                let begun = Instant::now();
                let picture = draw(&faces, look, camera, *size);
                times[4] = Some(begun.elapsed().as_secs_f64() * 1e3);
                Ok(picture)
            }
        }
    }

    /// Adds this frame's milliseconds to the lists of each stage.
    pub(super) fn take_times(&self, lists: &mut [Vec<f64>; 5], drawn: bool) -> Result<()> {
        let times = match self {
            Self::Gpu(device) => device.live.times_ms(&device.gpu, drawn)?,
            Self::Processor(twins) => twins.times,
        };
        for (list, time) in lists.iter_mut().zip(times) {
            list.extend(time);
        }
        Ok(())
    }

    /// Vertices that can never wrinkle, because no direction can be told there.
    pub(super) fn singular(&self, animated: &Animated, pose: &Pose) -> usize {
        let posed = skin(&animated.unified.vertices, pose);
        let input = CrushInput {
            wavelength_m: &animated.options.wavelength_m,
            bias: &[],
            last_direction: &[],
        };
        crush(&animated.unified, &posed, &input).singular
    }
}
