//! The stages Skin, Crush, Relax and Gather on the GPU, frame by frame, for all characters in one
//! pass.

use bytemuck::{Pod, Zeroable};
use plisse::{Error, Result};
use plisse_live::crush::Crushed;
use plisse_live::live::{LiveOptions, LiveState};
use plisse_live::model::Vertices;
use plisse_live::relax::{VISIBLE, spread};
use plisse_live::skin::{Pose, Skinned};
use plisse_live::unify::Unified;
use plisse_live::{Vec3, field, wgsl};

use crate::arrays::{Arrays, Character, Part, Placed, frame};
use crate::device::Gpu;
use crate::timer::{StageTimes, Timer};

/// Threads of a workgroup, as the WGSL texts say.
const GROUP: u32 = 64;
/// Floats of a gathered face.
pub(crate) const FACE_FLOATS: usize = 40;

/// The first uniform of each stage: a count and whatever else it needs.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Counts {
    count: u32,
    other: u32,
    first: u32,
    unused: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Round {
    vertices: u32,
    rate: f32,
}

/// A stage with its arguments, in as many variants as it is run with.
struct Stage {
    pipeline: wgpu::ComputePipeline,
    arguments: Vec<wgpu::BindGroup>,
    /// Workgroups of each variant.
    groups: Vec<u32>,
}

/// Gathered faces, as many as the adapter takes in one buffer.
pub(crate) struct Batch {
    pub(crate) faces: wgpu::Buffer,
    pub(crate) range: [usize; 2],
}

/// What a frame has made, read back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waves {
    /// Posed unified vertices of all characters.
    pub posed: Skinned,
    /// Their waves.
    pub crushed: Crushed,
    /// `[U]` phases (rad).
    pub phase: Vec<f32>,
}

/// The buffers of some characters and what runs on them.
pub struct Live {
    skin: Stage,
    crush: Stage,
    relax: Stage,
    gather: Stage,
    palette: wgpu::Buffer,
    morph_weights: wgpu::Buffer,
    round: wgpu::Buffer,
    posed: wgpu::Buffer,
    direction: wgpu::Buffer,
    wave: wgpu::Buffer,
    phase: [wgpu::Buffer; 2],
    pub(crate) batches: Vec<Batch>,
    pub(crate) parts: Vec<Part>,
    wavelength_m: Vec<f32>,
    /// Who neighbours whom, of all characters; what [`spread`] walks.
    joined: Unified,
    /// `[U]` whose wrinkles could be seen when [`spread`] last looked.
    seen: Vec<bool>,
    current: usize,
    frame: usize,
    ran: [bool; 5],
    pub(crate) timer: Timer,
}

impl Live {
    /// Buffers for `characters`, which stand in no pose yet: [`Live::begin`] is next.
    ///
    /// # Errors
    /// [`Error::Numeric`] if they do not fit on the adapter.
    pub fn new(gpu: &Gpu, characters: &[Character<'_>]) -> Result<Self> {
        let arrays = Arrays::new(characters)?;
        let (skinned, unified, faces) =
            (arrays.rest.len(), arrays.unified_count, arrays.corners.len() / 3);
        let most =
            gpu.device.limits().max_compute_workgroups_per_dimension as usize * GROUP as usize;
        if unified == 0 || faces == 0 || skinned.max(faces) > most {
            let message = format!(
                "{skinned} vertices and {faces} faces cannot be drawn in one pass; give between 1 \
                 and {most}"
            );
            return Err(Error::numeric("GPU", message));
        }
        use wgpu::BufferUsages as Use;
        let (fixed, moving) = (Use::STORAGE, Use::STORAGE | Use::COPY_DST | Use::COPY_SRC);
        let rest = gpu.buffer("rest vertices", &arrays.rest, fixed)?;
        let joints = gpu.buffer("joints", &arrays.joints, fixed)?;
        let weights = gpu.buffer("joint weights", &arrays.weights, fixed)?;
        let palette = gpu.buffer("palettes", &vec![[0f32; 12]; arrays.palette_count], moving)?;
        let shift_starts = gpu.buffer("starts of morph shifts", &arrays.shift_starts, fixed)?;
        let shifts = gpu.buffer("morph shifts", &arrays.shifts, fixed)?;
        let morph_weights =
            gpu.buffer("morph weights", &vec![0f32; arrays.target_count], moving)?;
        let posed = gpu.buffer("posed vertices", &vec![Placed::default(); skinned], moving)?;
        let starts = gpu.buffer("starts of neighbours", &arrays.starts, fixed)?;
        let neighbours = gpu.buffer("neighbours", &arrays.neighbours, fixed)?;
        let bias = gpu.buffer("biases", &arrays.bias, fixed)?;
        let direction = gpu.buffer("directions", &vec![[0f32; 4]; unified], moving)?;
        let wave = gpu.buffer("waves", &vec![[0f32; 4]; unified], moving)?;
        let phase = [
            gpu.buffer("phases", &vec![0f32; unified], moving)?,
            gpu.buffer("phases", &vec![0f32; unified], moving)?,
        ];
        let corners = gpu.buffer("corners", &arrays.corners, fixed)?;
        let vertex_of_draw =
            gpu.buffer("vertices of draw vertices", &arrays.vertex_of_draw, fixed)?;
        let uvs = gpu.buffer("texture coordinates", &arrays.uvs, fixed)?;
        let counts = |count: usize, other: usize, first: usize| -> Result<wgpu::Buffer> {
            let counts =
                Counts { count: count as u32, other: other as u32, first: first as u32, unused: 0 };
            gpu.buffer("counts", &[counts], Use::UNIFORM)
        };
        let most_faces =
            (gpu.most_bytes(wgpu::BufferUsages::STORAGE) / (4 * FACE_FLOATS as u64)) as usize;
        let mut batches = Vec::new();
        for first in (0..faces).step_by(most_faces) {
            let range = [first, faces.min(first + most_faces)];
            let faces = gpu.buffer(
                "faces",
                &vec![[0f32; FACE_FLOATS]; range[1] - range[0]],
                moving | Use::VERTEX,
            )?;
            batches.push((Batch { faces, range }, counts(range[1] - range[0], unified, first)?));
        }
        let round = gpu.buffer(
            "round",
            &[Round { vertices: unified as u32, rate: 0.0 }],
            Use::UNIFORM | Use::COPY_DST,
        )?;
        let of_skin = counts(skinned, arrays.groups, 0)?;
        let of_crush = counts(unified, usize::from(!arrays.bias.is_empty()), 0)?;
        let stage = |name: &str, text: &str, count: usize, arguments: &[&[&wgpu::Buffer]]| {
            let variants: Vec<(usize, &[&wgpu::Buffer])> =
                arguments.iter().map(|a| (count, *a)).collect();
            Stage::new(gpu, name, text, &variants)
        };
        // Each batch in two variants, one for each of the phase buffers.
        let gathering: Vec<(usize, [&wgpu::Buffer; 8])> = batches
            .iter()
            .flat_map(|(batch, counts)| {
                let of = |phase| {
                    [counts, &corners, &vertex_of_draw, &uvs, &posed, &wave, phase, &batch.faces]
                };
                phase.each_ref().map(|phase| (batch.range[1] - batch.range[0], of(phase)))
            })
            .collect();
        let gathering: Vec<(usize, &[&wgpu::Buffer])> =
            gathering.iter().map(|(count, a)| (*count, &a[..])).collect();
        let wavelength_m = arrays.rest[..unified].iter().map(|r| r.wavelength_m).collect();
        let joined = Unified {
            vertices: Vertices {
                positions: arrays.rest[..unified].iter().map(|r| r.position.into()).collect(),
                ..Vertices::default()
            },
            vertex_of_draw: Vec::new(),
            faces: Vec::new(),
            starts: arrays.starts,
            neighbours: arrays.neighbours,
        };
        let live = Self {
            skin: stage(
                "skin",
                wgsl::SKIN,
                skinned,
                &[&[
                    &of_skin,
                    &rest,
                    &joints,
                    &weights,
                    &palette,
                    &shift_starts,
                    &shifts,
                    &morph_weights,
                    &posed,
                ]],
            ),
            crush: stage(
                "crush",
                wgsl::CRUSH,
                unified,
                &[&[&of_crush, &rest, &posed, &starts, &neighbours, &bias, &direction, &wave]],
            ),
            relax: stage(
                "relax",
                wgsl::RELAX,
                unified,
                &[
                    &[&round, &posed, &wave, &starts, &neighbours, &phase[0], &phase[1]],
                    &[&round, &posed, &wave, &starts, &neighbours, &phase[1], &phase[0]],
                ],
            ),
            gather: Stage::new(gpu, "gather", wgsl::GATHER, &gathering),
            palette,
            morph_weights,
            round,
            posed,
            direction,
            wave,
            phase,
            batches: batches.into_iter().map(|(batch, _)| batch).collect(),
            parts: arrays.parts,
            wavelength_m,
            seen: vec![false; unified],
            joined,
            current: 0,
            frame: 0,
            ran: [false; 5],
            timer: Timer::new(gpu),
        };
        gpu.wait()?;
        Ok(live)
    }

    /// Makes the first frame: phases come from the twins, which can spread them over the mesh; the
    /// rest runs here.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn begin(
        &mut self,
        gpu: &Gpu,
        characters: &[Character<'_>],
        poses: &[&Pose],
        options: &LiveOptions,
    ) -> Result<()> {
        let (mut direction, mut phase) = (Vec::new(), Vec::new());
        self.seen.clear();
        for (character, pose) in characters.iter().zip(poses) {
            let mut state = LiveState::default();
            let own = LiveOptions {
                wavelength_m: character.wavelength_m.to_vec(),
                bias: character.bias.to_vec(),
                ..options.clone()
            };
            state.step(character.unified, pose, &own);
            self.seen.extend(state.crushed.strength.iter().map(|&s| s >= VISIBLE));
            direction.extend(state.crushed.direction);
            phase.extend(state.phase);
        }
        self.set(gpu, &direction, &phase);
        self.frame = 0;
        self.step(gpu, poses, &LiveOptions { rounds: 0, ..options.clone() })
    }

    /// Makes the next frame. With [`LiveOptions::spread_new`] waves are read back, and where new
    /// ones appeared, their phases are spread by the twin; without, nothing is waited for.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn step(&mut self, gpu: &Gpu, poses: &[&Pose], options: &LiveOptions) -> Result<()> {
        let (palette, weights) = frame(poses);
        gpu.write(&self.palette, &palette);
        if !weights.is_empty() {
            gpu.write(&self.morph_weights, &weights);
        }
        gpu.write(
            &self.round,
            &[Round { vertices: self.wavelength_m.len() as u32, rate: options.rate }],
        );
        let whole = self.frame.is_multiple_of(options.every.max(1));
        self.ran = [true, whole, whole && options.rounds > 0, true, false];
        self.skin.run(gpu, &mut self.timer, 0, [0])?;
        if whole {
            self.crush.run(gpu, &mut self.timer, 1, [0])?;
            if options.spread_new && self.frame > 0 {
                self.spread_new(gpu)?;
            }
            let first = self.current;
            if options.rounds > 0 {
                self.relax.run(
                    gpu,
                    &mut self.timer,
                    2,
                    (0..options.rounds).map(|r| (first + r) % 2),
                )?;
            }
            self.current = (first + options.rounds) % 2;
        }
        self.gather.run(
            gpu,
            &mut self.timer,
            3,
            (0..self.batches.len()).map(|b| 2 * b + self.current),
        )?;
        self.frame += 1;
        gpu.check()
    }

    /// Phases for wrinkles that nobody has seen yet, from those that were seen.
    fn spread_new(&mut self, gpu: &Gpu) -> Result<()> {
        let waves = self.read(gpu)?;
        let phase =
            spread(&self.joined, &waves.posed.positions, &waves.crushed, &waves.phase, &self.seen);
        gpu.write(&self.phase[self.current], &phase);
        self.seen = waves.crushed.strength.iter().map(|&s| s >= VISIBLE).collect();
        Ok(())
    }

    /// Shows `waves` over vertices `posed` (`[U]`) instead of a frame's own, e.g. those of a solved
    /// wrinkle field ([`plisse_live::field::from_field`]); `draw_normals` (`[V]`) are those of the
    /// draw vertices. The next [`Live::step`] goes on from its own.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn show(
        &mut self,
        gpu: &Gpu,
        posed: &Skinned,
        draw_normals: &[Vec3],
        waves: &field::Waves,
    ) -> Result<()> {
        let unified = posed.positions.iter().zip(&posed.normals).zip(&self.wavelength_m);
        let unified = unified.map(|((p, n), &wavelength_m)| Placed {
            position: (*p).into(),
            wavelength_m,
            normal: (*n).into(),
            unused: 0.0,
        });
        let drawn =
            draw_normals.iter().map(|n| Placed { normal: (*n).into(), ..Placed::default() });
        gpu.write(&self.posed, &unified.chain(drawn).collect::<Vec<_>>());
        // Gather takes the amplitude as a share of W/4, which a solved one may well exceed.
        let share = |v: usize| 4.0 * waves.amplitude_m[v] / self.wavelength_m[v];
        let wave: Vec<[f32; 4]> = (0..waves.wave.len())
            .map(|v| [waves.wave[v].x, waves.wave[v].y, waves.wave[v].z, share(v)])
            .collect();
        gpu.write(&self.wave, &wave);
        gpu.write(&self.phase[self.current], &waves.phase);
        self.ran = [false, false, false, true, false];
        self.gather.run(
            gpu,
            &mut self.timer,
            3,
            (0..self.batches.len()).map(|b| 2 * b + self.current),
        )?;
        gpu.check()
    }

    /// Replaces the directions of the last frame and the phases.
    pub fn set(&mut self, gpu: &Gpu, direction: &[Vec3], phase: &[f32]) {
        let direction: Vec<[f32; 4]> = direction.iter().map(|k| [k.x, k.y, k.z, 0.0]).collect();
        gpu.write(&self.direction, &direction);
        gpu.write(&self.phase[self.current], phase);
    }

    /// Reads the last frame back. `singular` of its waves is not counted.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn read(&self, gpu: &Gpu) -> Result<Waves> {
        let vector = |v: &[f32; 4]| Vec3::new(v[0], v[1], v[2]);
        let placed: Vec<Placed> = gpu.read(&self.posed)?;
        let wave: Vec<[f32; 4]> = gpu.read(&self.wave)?;
        let direction: Vec<[f32; 4]> = gpu.read(&self.direction)?;
        let placed = &placed[..wave.len()];
        let strength: Vec<f32> = wave.iter().map(|w| w[3]).collect();
        Ok(Waves {
            posed: Skinned {
                positions: placed.iter().map(|p| p.position.into()).collect(),
                normals: placed.iter().map(|p| p.normal.into()).collect(),
            },
            crushed: Crushed {
                amplitude_m: strength
                    .iter()
                    .zip(&self.wavelength_m)
                    .map(|(s, w)| 0.25 * w * s)
                    .collect(),
                strength,
                wave: wave.iter().map(vector).collect(),
                direction: direction.iter().map(vector).collect(),
                singular: 0,
            },
            phase: gpu.read(&self.phase[self.current])?,
        })
    }

    /// The gathered faces as Render reads them, 40 numbers each: see gather.wgsl.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn read_faces(&self, gpu: &Gpu) -> Result<Vec<[f32; FACE_FLOATS]>> {
        let mut faces = Vec::new();
        for batch in &self.batches {
            let floats: Vec<f32> = gpu.read(&batch.faces)?;
            faces.extend(
                floats
                    .chunks_exact(FACE_FLOATS)
                    .map(|c| -> [f32; FACE_FLOATS] { c.try_into().expect("of that length") }),
            );
        }
        Ok(faces)
    }

    /// Milliseconds of the last frame's stages on the device; waits for them. `drawn`: whether a
    /// [`crate::Painter`] drew it, too.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn times_ms(&self, gpu: &Gpu, drawn: bool) -> Result<StageTimes> {
        let mut ran = self.ran;
        ran[4] = drawn;
        self.timer.times(gpu, ran)
    }
}

impl Stage {
    /// `variants`: how many threads and which buffers.
    fn new(gpu: &Gpu, name: &str, text: &str, variants: &[(usize, &[&wgpu::Buffer])]) -> Self {
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
        let bound = |(_, buffers): &(usize, &[&wgpu::Buffer])| {
            let entries: Vec<wgpu::BindGroupEntry<'_>> = buffers
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
        let groups = variants.iter().map(|(count, _)| (*count as u32).div_ceil(GROUP)).collect();
        Self { arguments: variants.iter().map(bound).collect(), pipeline, groups }
    }

    /// One pass, timed as stage number `index`, with a dispatch for each of the `variants`.
    fn run(
        &self,
        gpu: &Gpu,
        timer: &mut Timer,
        index: usize,
        variants: impl IntoIterator<Item = usize>,
    ) -> Result<()> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let descriptor =
            wgpu::ComputePassDescriptor { label: None, timestamp_writes: timer.compute(index) };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        for variant in variants {
            pass.set_bind_group(0, &self.arguments[variant], &[]);
            pass.dispatch_workgroups(self.groups[variant], 1, 1);
        }
        drop(pass);
        timer.submit(gpu, index, encoder)
    }
}
