//! Pictures that stay on the adapter, for windows that draw with the same one.

use crate::device::Gpu;
use crate::painter::Painter;

/// Format of the averaged picture, which windows show.
const SHOWN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The average of the samples of each pixel in a [`Painter`]'s picture.
pub struct Average {
    pipeline: wgpu::RenderPipeline,
    samples: wgpu::BindGroup,
    picture: wgpu::TextureView,
}

impl Average {
    /// An average of the pictures of `painter`.
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
