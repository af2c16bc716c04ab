//! The stages Skin, Crush, Relax and Gather on the GPU, frame by frame, for all characters in one
//! pass.

use plisse::{Error, Result};
use plisse_live::crush::PlaneWaves;
use plisse_live::live::{LiveOptions, LiveState};
use plisse_live::model::Vertices;
use plisse_live::relax::{propagate_phases, visible};
use plisse_live::skin::{Pose, PosedVertices};
use plisse_live::stage::{PerStage, Stage, StageTimes};
use plisse_live::weld::WeldedMesh;
use plisse_live::{Vec3, field};

use crate::arrays::{Arrays, Character, CharacterRanges, Vertex, frame};
use crate::buffers::{Buffers, FACE_FLOATS, FaceBatch, Round};
use crate::device::Gpu;
use crate::kernel::GROUP;
use crate::kernels::Kernels;
use crate::timer::Timer;

/// The buffers of some characters and the kernels that run on them.
pub struct Live {
    kernels: Kernels,
    buffers: Buffers,
    pub(crate) batches: Vec<FaceBatch>,
    pub(crate) ranges: Vec<CharacterRanges>,
    wavelength_m: Vec<f32>,
    /// The welded meshes of all characters, for their neighbours alone.
    mesh: WeldedMesh,
    /// `[U]` true where wrinkles were visible when phases were propagated last.
    visible: Vec<bool>,
    /// Number of the buffer that holds the phases now.
    current: usize,
    frame: usize,
    /// Stages that ran in the last frame.
    ran: PerStage<bool>,
    pub(crate) timer: Timer,
}

impl Live {
    /// Buffers for `characters`, which stand in no pose yet: [`Live::begin`] is next.
    ///
    /// # Errors
    /// [`Error::Numeric`] if they do not fit on the adapter.
    pub fn new(gpu: &Gpu, characters: &[Character<'_>]) -> Result<Self> {
        let arrays = Arrays::new(characters)?;
        check_counts(gpu, &arrays)?;
        let (skinned, welded) = (arrays.rest.len(), arrays.welded_count);
        let buffers = Buffers::new(gpu, &arrays)?;
        let (batches, batch_counts) = Buffers::face_batches(gpu, &arrays)?;
        let live = Self {
            kernels: Kernels::new(gpu, &buffers, &batches, &batch_counts, [skinned, welded]),
            wavelength_m: arrays.rest[..welded].iter().map(|r| r.wavelength_m).collect(),
            visible: vec![false; welded],
            mesh: neighbours_only(&arrays),
            current: 0,
            frame: 0,
            ran: PerStage::default(),
            timer: Timer::new(gpu),
            ranges: arrays.ranges,
            batches,
            buffers,
        };
        gpu.wait()?;
        Ok(live)
    }

    /// Makes the first frame. Its phases come from the CPU reference, which can propagate them over
    /// the mesh; the rest runs on the GPU.
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
        self.visible.clear();
        for (character, pose) in characters.iter().zip(poses) {
            let mut state = LiveState::default();
            let own = LiveOptions {
                wavelength_m: character.wavelength_m.to_vec(),
                bias: character.bias.to_vec(),
                ..options.clone()
            };
            state.step(character.welded, pose, &own);
            self.visible.extend(visible(&state.waves));
            direction.extend(state.waves.direction);
            phase.extend(state.phase);
        }
        self.set(gpu, &direction, &phase);
        self.frame = 0;
        self.step(gpu, poses, &LiveOptions { rounds: 0, ..options.clone() })
    }

    /// Makes the next frame. With [`LiveOptions::propagate_new`] waves are read back, and the CPU
    /// reference propagates phases to new ones; without it, nothing is waited for.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn step(&mut self, gpu: &Gpu, poses: &[&Pose], options: &LiveOptions) -> Result<()> {
        let (palette, weights) = frame(poses);
        gpu.write(&self.buffers.palette, &palette);
        if !weights.is_empty() {
            gpu.write(&self.buffers.morph_weights, &weights);
        }
        let round = Round { vertices: self.wavelength_m.len() as u32, rate: options.rate };
        gpu.write(&self.buffers.round, &[round]);
        let moves_waves = self.frame.is_multiple_of(options.every.max(1));
        let relaxes = moves_waves && options.rounds > 0;
        self.ran = PerStage::from_fn(|stage| match stage {
            Stage::Skin | Stage::Gather => true,
            Stage::Crush => moves_waves,
            Stage::Relax => relaxes,
            Stage::Render => false,
        });
        self.kernels.skin.run(gpu, &mut self.timer, [0])?;
        if moves_waves {
            self.kernels.crush.run(gpu, &mut self.timer, [0])?;
            if options.propagate_new && self.frame > 0 {
                self.propagate_new(gpu)?;
            }
            let first = self.current;
            if relaxes {
                let numbers = (0..options.rounds).map(|r| (first + r) % 2);
                self.kernels.relax.run(gpu, &mut self.timer, numbers)?;
            }
            self.current = (first + options.rounds) % 2;
        }
        self.gather(gpu)?;
        self.frame += 1;
        gpu.check()
    }

    fn gather(&mut self, gpu: &Gpu) -> Result<()> {
        let numbers = (0..self.batches.len()).map(|b| 2 * b + self.current);
        self.kernels.gather.run(gpu, &mut self.timer, numbers)
    }

    /// Propagates phases from the wrinkles that were visible to new ones.
    fn propagate_new(&mut self, gpu: &Gpu) -> Result<()> {
        let state = self.read(gpu)?;
        let phase = propagate_phases(&state.coupling(&self.mesh), &state.phase, &self.visible);
        gpu.write(&self.buffers.phase[self.current], &phase);
        self.visible = visible(&state.waves);
        Ok(())
    }

    /// Shows `waves` over vertices `posed` (`[U]`) instead of a frame's own, for example those of a
    /// solved wrinkle field ([`plisse_live::field::from_field`]); `draw_normals` (`[V]`) are those
    /// of the draw vertices. The next [`Live::step`] goes on from its own.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn show(
        &mut self,
        gpu: &Gpu,
        posed: &PosedVertices,
        draw_normals: &[Vec3],
        waves: &field::Waves,
    ) -> Result<()> {
        let welded = posed.positions.iter().zip(&posed.normals).zip(&self.wavelength_m);
        let welded = welded.map(|((p, n), &wavelength_m)| Vertex {
            position: (*p).into(),
            wavelength_m,
            normal: (*n).into(),
            unused: 0.0,
        });
        let drawn =
            draw_normals.iter().map(|n| Vertex { normal: (*n).into(), ..Vertex::default() });
        gpu.write(&self.buffers.posed, &welded.chain(drawn).collect::<Vec<_>>());
        // Gather takes the amplitude as a share of W/4, which a solved one may well exceed.
        let share = |v: usize| 4.0 * waves.amplitude_m[v] / self.wavelength_m[v];
        let wave: Vec<[f32; 4]> = (0..waves.wave.len())
            .map(|v| [waves.wave[v].x, waves.wave[v].y, waves.wave[v].z, share(v)])
            .collect();
        gpu.write(&self.buffers.wave, &wave);
        gpu.write(&self.buffers.phase[self.current], &waves.phase);
        self.ran = PerStage::from_fn(|stage| stage == Stage::Gather);
        self.gather(gpu)?;
        gpu.check()
    }

    /// Replaces the directions of the last frame and the phases.
    pub fn set(&mut self, gpu: &Gpu, direction: &[Vec3], phase: &[f32]) {
        let direction: Vec<[f32; 4]> = direction.iter().map(|k| [k.x, k.y, k.z, 0.0]).collect();
        gpu.write(&self.buffers.direction, &direction);
        gpu.write(&self.buffers.phase[self.current], phase);
    }

    /// Reads the last frame back, of all characters together. `singular` of its waves is not
    /// counted.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn read(&self, gpu: &Gpu) -> Result<LiveState> {
        let vector = |v: &[f32; 4]| Vec3::new(v[0], v[1], v[2]);
        let posed: Vec<Vertex> = gpu.read(&self.buffers.posed)?;
        let wave: Vec<[f32; 4]> = gpu.read(&self.buffers.wave)?;
        let direction: Vec<[f32; 4]> = gpu.read(&self.buffers.direction)?;
        let posed = &posed[..wave.len()];
        let strength: Vec<f32> = wave.iter().map(|w| w[3]).collect();
        let amplitude_m =
            strength.iter().zip(&self.wavelength_m).map(|(s, w)| 0.25 * w * s).collect();
        Ok(LiveState {
            frame: self.frame,
            posed: PosedVertices {
                positions: posed.iter().map(|p| p.position.into()).collect(),
                normals: posed.iter().map(|p| p.normal.into()).collect(),
            },
            waves: PlaneWaves {
                amplitude_m,
                strength,
                wave: wave.iter().map(vector).collect(),
                direction: direction.iter().map(vector).collect(),
                singular: 0,
            },
            phase: gpu.read(&self.buffers.phase[self.current])?,
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

    /// Milliseconds of the last frame's stages on the device; waits for them. `is_drawn` if a
    /// [`crate::Painter`] drew it, too.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn times_ms(&self, gpu: &Gpu, is_drawn: bool) -> Result<StageTimes> {
        let mut ran = self.ran;
        ran[Stage::Render] = is_drawn;
        self.timer.times(gpu, &ran)
    }
}

/// Checks that the characters are not empty and fit into one dispatch.
fn check_counts(gpu: &Gpu, arrays: &Arrays) -> Result<()> {
    let (skinned, faces) = (arrays.rest.len(), arrays.corners.len() / 3);
    let most = gpu.device.limits().max_compute_workgroups_per_dimension as usize * GROUP as usize;
    if arrays.welded_count == 0 || faces == 0 || skinned.max(faces) > most {
        let message = format!(
            "{skinned} vertices and {faces} faces cannot be drawn in one pass; give between 1 and \
             {most}"
        );
        return Err(Error::numeric("GPU", message));
    }
    Ok(())
}

/// The welded meshes of all characters as far as phases are propagated on them.
fn neighbours_only(arrays: &Arrays) -> WeldedMesh {
    let rest = &arrays.rest[..arrays.welded_count];
    WeldedMesh {
        vertices: Vertices {
            positions: rest.iter().map(|r| r.position.into()).collect(),
            ..Vertices::default()
        },
        vertex_of_draw: Vec::new(),
        faces: Vec::new(),
        starts: arrays.starts.clone(),
        neighbours: arrays.neighbours.clone(),
    }
}
