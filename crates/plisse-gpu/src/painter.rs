//! Stage "Render" on the GPU: pictures of gathered faces.

use bytemuck::{Pod, Zeroable};
use plisse::picture::Image;
use plisse::{Error, Result};
use plisse_live::camera::Camera;
use plisse_live::draw::{BACKGROUND, Look, Picture};
use plisse_live::shade::{from_srgb, to_srgb};
use plisse_live::stage::Stage;
use plisse_live::texture::Texture;
use plisse_live::wgsl;

use crate::buffers::{FACE_FLOATS, FaceBatch};
use crate::device::Gpu;
use crate::faces::Faces;
use crate::live::Live;

const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Scene {
    clip_from_world: [f32; 16],
    eye: [f32; 4],
    light: [f32; 4],
    up: [f32; 4],
    colour: [f32; 4],
    profile: [f32; 64],
}

impl Scene {
    fn new(camera: &Camera, look: &Look<'_>) -> Self {
        let light = camera.light();
        let four = |v: &plisse_live::Vec3, w: f32| [v.x, v.y, v.z, w];
        Self {
            clip_from_world: camera.clip_from_world().as_slice().try_into().expect("16 numbers"),
            eye: four(&camera.eye, f32::from(u8::from(look.parallax))),
            light: four(&light.lamp, 0.0),
            up: four(&light.up, 0.0),
            colour: four(&look.colour, 1.0),
            profile: std::array::from_fn(|i| {
                if i % 2 == 0 { look.profile.f[i / 2] } else { look.profile.df[i / 2] }
            }),
        }
    }
}

/// A range of faces (first and the one after the last) with the texture they are drawn with.
struct Part<'a> {
    faces: [usize; 2],
    arguments: &'a wgpu::BindGroup,
}

/// Draws pictures of one size.
pub struct Painter {
    pub(crate) size: [usize; 2],
    /// Samples of a pixel along each side.
    pub(crate) samples: usize,
    pipeline: wgpu::RenderPipeline,
    scene: wgpu::Buffer,
    /// One for each character.
    arguments: Vec<wgpu::BindGroup>,
    pub(crate) colour: wgpu::Texture,
    depth: wgpu::TextureView,
    readable: wgpu::Buffer,
    row_bytes: u32,
}

impl Painter {
    /// A painter for pictures of `size` (width, height) pixels, with the base colour of each
    /// character. `samples`: of each pixel along each side; pictures are as those of the CPU
    /// reference with
    /// [`plisse_live::draw::SAMPLES`].
    ///
    /// # Errors
    /// [`Error::Value`] if the pictures are too large for the adapter.
    pub fn new(gpu: &Gpu, size: [usize; 2], samples: usize, textures: &[&Texture]) -> Result<Self> {
        let fine = size.map(|s| (s * samples) as u32);
        let most = gpu.device.limits().max_texture_dimension_2d;
        if fine.iter().any(|&s| s == 0 || s > most) {
            let message = format!(
                "pictures of {} x {} pixels cannot be drawn; give 1 to {} for each",
                size[0],
                size[1],
                most as usize / samples
            );
            return Err(Error::value("size", message));
        }
        let pipeline = pipeline(gpu);
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let scene = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("scene"),
            size: size_of::<Scene>() as u64,
            usage,
            mapped_at_creation: false,
        });
        let arguments = bind_groups(gpu, &pipeline, &scene, textures);
        let texture = |format, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size: extent(fine),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::TEXTURE_BINDING;
        let colour = texture(COLOUR, usage);
        let depth =
            texture(DEPTH, wgpu::TextureUsages::RENDER_ATTACHMENT).create_view(&Default::default());
        let row_bytes = (4 * fine[0]).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let readable = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(row_bytes) * u64::from(fine[1]),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.check()?;
        Ok(Self { size, samples, pipeline, scene, arguments, colour, depth, readable, row_bytes })
    }

    /// Draws the last frame of `live`, whose characters are those the painter was made for, without
    /// waiting for it (but see [`Live::times_ms`]).
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn draw(&self, gpu: &Gpu, live: &mut Live, camera: &Camera, look: &Look<'_>) -> Result<()> {
        let parts: Vec<Part<'_>> = live
            .ranges
            .iter()
            .zip(&self.arguments)
            .map(|(ranges, arguments)| Part { faces: ranges.faces, arguments })
            .collect();
        gpu.write(&self.scene, &[Scene::new(camera, look)]);
        let timestamps = live.timer.render(Stage::Render);
        let encoder = self.encode(gpu, &live.batches, &parts, timestamps);
        live.timer.submit(gpu, Stage::Render, encoder)?;
        gpu.check()
    }

    /// Draws `faces` with texture number `texture` of those that the painter was made with, without
    /// waiting for it.
    ///
    /// # Errors
    /// [`Error::Value`] if there is no such texture; [`Error::Numeric`] if the device fails.
    pub fn draw_faces(
        &self,
        gpu: &Gpu,
        faces: &Faces,
        texture: usize,
        camera: &Camera,
        look: &Look<'_>,
    ) -> Result<()> {
        let Some(arguments) = self.arguments.get(texture) else {
            return Err(Error::value(
                "texture",
                format!("there is no number {texture}; give one below {}", self.arguments.len()),
            ));
        };
        gpu.write(&self.scene, &[Scene::new(camera, look)]);
        let whole = Part { faces: [0, usize::MAX], arguments };
        let encoder = self.encode(gpu, &faces.batches, &[whole], None);
        gpu.queue.submit([encoder.finish()]);
        gpu.check()
    }

    /// One pass over all `batches`.
    fn encode(
        &self,
        gpu: &Gpu,
        batches: &[FaceBatch],
        parts: &[Part<'_>],
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::CommandEncoder {
        let [r, g, b] = BACKGROUND.map(|c| f64::from(from_srgb(c)));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let view = self.colour.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("render"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(&self.pipeline);
        for batch in batches {
            pass.set_vertex_buffer(0, batch.faces.slice(..));
            for Part { faces, arguments } in parts {
                let [from, to] = faces
                    .map(|f| (f.clamp(batch.range[0], batch.range[1]) - batch.range[0]) as u32);
                if from < to {
                    pass.set_bind_group(0, *arguments, &[]);
                    pass.draw(0..3, from..to);
                }
            }
        }
        drop(pass);
        encoder
    }

    /// The picture that was drawn last.
    ///
    /// # Errors
    /// [`Error::Numeric`] if the device fails.
    pub fn read(&self, gpu: &Gpu) -> Result<Picture> {
        let fine = self.size.map(|s| s * self.samples);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.colour.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.readable,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(self.row_bytes),
                    rows_per_image: None,
                },
            },
            extent(fine.map(|s| s as u32)),
        );
        gpu.queue.submit([encoder.finish()]);
        let bytes: Vec<u8> = gpu.map(&self.readable)?;
        self.readable.unmap();
        let linear: [f32; 256] = std::array::from_fn(|b| from_srgb(b as u8));
        let (mut pixels, mut covered) = (Vec::with_capacity(3 * self.size[0] * self.size[1]), 0);
        for y in 0..self.size[1] {
            for x in 0..self.size[0] {
                let (mut sum, mut any) = ([0f32; 3], false);
                for s in 0..self.samples * self.samples {
                    let row = y * self.samples + s / self.samples;
                    let first =
                        row * self.row_bytes as usize + 4 * (x * self.samples + s % self.samples);
                    let sample = &bytes[first..first + 3];
                    any |= sample != BACKGROUND;
                    (0..3).for_each(|c| sum[c] += linear[usize::from(sample[c])]);
                }
                covered += usize::from(any);
                pixels.extend(sum.map(|s| to_srgb(s / (self.samples * self.samples) as f32)));
            }
        }
        Ok(Picture { image: Image { width: self.size[0], height: self.size[1], pixels }, covered })
    }
}

fn extent(size: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 }
}

fn pipeline(gpu: &Gpu) -> wgpu::RenderPipeline {
    let source = wgpu::ShaderSource::Wgsl(wgsl::RENDER.into());
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("render"), source });
    let attributes: [wgpu::VertexAttribute; FACE_FLOATS / 4] =
        std::array::from_fn(|a| wgpu::VertexAttribute {
            format: wgpu::VertexFormat::Float32x4,
            offset: 16 * a as u64,
            shader_location: a as u32,
        });
    let layout = wgpu::VertexBufferLayout {
        array_stride: 4 * FACE_FLOATS as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &attributes,
    };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("render"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("render_vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(layout)],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("render_pixel"),
            compilation_options: Default::default(),
            targets: &[Some(COLOUR.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// The arguments of the pipeline with each texture.
fn bind_groups(
    gpu: &Gpu,
    pipeline: &wgpu::RenderPipeline,
    scene: &wgpu::Buffer,
    textures: &[&Texture],
) -> Vec<wgpu::BindGroup> {
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let layout = pipeline.get_bind_group_layout(0);
    textures
        .iter()
        .map(|texture| {
            let view = upload(gpu, texture);
            let entries = [
                wgpu::BindGroupEntry { binding: 0, resource: scene.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(&view),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::Sampler(&sampler),
                },
            ];
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("look"),
                layout: &layout,
                entries: &entries,
            })
        })
        .collect()
}

fn upload(gpu: &Gpu, texture: &Texture) -> wgpu::TextureView {
    let size = extent([texture.width as u32, texture.height as u32]);
    let uploaded = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("base colour"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: COLOUR,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let rows = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * size.width),
        rows_per_image: None,
    };
    gpu.queue.write_texture(
        uploaded.as_image_copy(),
        bytemuck::cast_slice(&texture.rgba),
        rows,
        size,
    );
    uploaded.create_view(&Default::default())
}
