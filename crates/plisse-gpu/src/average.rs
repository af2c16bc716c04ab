//! Pictures that stay on the adapter, for windows that draw by the same one.

use crate::device::Gpu;
use crate::painter::Painter;

const SHOWN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Makes each pixel of a [`Painter`]'s picture of its samples.
pub struct Average {
    pipeline: wgpu::RenderPipeline,
    samples: wgpu::BindGroup,
    picture: wgpu::TextureView,
}

impl Average {
    /// For the pictures of `painter`.
    pub fn new(gpu: &Gpu, painter: &Painter) -> Self {
        let source = wgpu::ShaderSource::Wgsl(include_str!("average.wgsl").into());
        let module = gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("average"), source });
        let constants = [("side", painter.samples as f64)];
        let options =
            wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("average"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("average_vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("average_pixel"),
                compilation_options: options,
                targets: &[Some(SHOWN.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let view = painter.colour.create_view(&Default::default());
        let samples = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("average"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&view),
            }],
        });
        let [width, height] = painter.size.map(|s| s as u32);
        let picture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("average"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: SHOWN,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Self { pipeline, samples, picture: picture.create_view(&Default::default()) }
    }

    /// The picture that the painter drew last: sRGB numbers, opaque, in a texture that the next
    /// call draws over.
    pub fn picture(&self, gpu: &Gpu) -> &wgpu::TextureView {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("average"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.picture,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.samples, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        &self.picture
    }
}

#[cfg(test)]
mod tests {
    use plisse_live::Vec3;
    use plisse_live::camera::Camera;
    use plisse_live::draw::{Look, SAMPLES};
    use plisse_live::profile::Profile;
    use plisse_live::render::Corner;
    use plisse_live::texture::Texture;

    use super::*;
    use crate::Faces;

    #[test]
    fn the_picture_that_stays_is_the_one_that_is_read() {
        let gpu = match Gpu::new() {
            Ok(gpu) => gpu,
            Err(e) if std::env::var_os("PLISSE_NEED_GPU").is_some() => panic!("{e}"),
            Err(e) => return eprintln!("not run: {e}"),
        };
        let places = [Vec3::zeros(), Vec3::x(), Vec3::new(0.3, 0.9, 0.2)];
        let corner = |position| Corner {
            position,
            normal: Vec3::z(),
            uv: plisse_live::Vec2::zeros(),
            amplitude_m: 0.01,
            wave: Vec3::x() * 40.0,
            phase: 40.0 * position.x,
        };
        let (texture, profile) = (Texture::plain([214, 176, 158]), Profile::sine());
        // Rows of 64 pixels can be read as they are.
        let size = [64, 48];
        let painter = Painter::new(&gpu, size, SAMPLES, &[&texture]).unwrap();
        let faces = Faces::new(&gpu, &[places.map(corner)]).unwrap();
        let camera = Camera::fit(places.iter(), 0.2, 0.1, size[0] as f32 / size[1] as f32);
        let look = Look {
            profile: &profile,
            texture: &texture,
            colour: Vec3::repeat(1.0),
            parallax: false,
        };
        painter.draw_faces(&gpu, &faces, 0, &camera, &look).unwrap();
        let read = painter.read(&gpu).unwrap();
        let average = Average::new(&gpu, &painter);
        let texture = average.picture(&gpu).texture();
        let buffer = gpu
            .buffer(
                "read",
                &vec![0u8; 4 * size[0] * size[1]],
                wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            )
            .unwrap();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * size[0] as u32),
            rows_per_image: None,
        };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let into = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), into, texture.size());
        gpu.queue.submit([encoder.finish()]);
        let stays: Vec<u8> = gpu.map(&buffer).unwrap();
        assert!(read.covered > 200, "{} pixels are covered", read.covered);
        for (i, (a, b)) in stays.chunks(4).zip(read.image.pixels.chunks(3)).enumerate() {
            assert!(
                (0..3).all(|c| a[c].abs_diff(b[c]) <= 1) && a[3] == 255,
                "pixel {i}: {a:?} {b:?}"
            );
        }
    }
}
