//! `GpuGeometry`: opaque geometry drawn to colour and depth, before the volume.
//!
//! In: the layers of a frame. Out: a texture of linear RGB and inverse depth, at which fans end and behind which they show it. A list is sent
//! once and stays in buffers as long as frames draw it; what changes from frame to frame is a uniform for each layer.

use std::sync::Arc;

use wgpu::{BufferUsages, TextureFormat, TextureUsages};

use super::Gpu;
use super::layout::GeometryUniform;
use super::pipelines::buffer_of;
use super::shaders;
use crate::backends::{Frame, Opaque};
use crate::geometry::{List, Primitive};

/// Bytes of a buffer at most: a multiple of every primitive's.
const CHUNK_BYTES: usize = 36 << 20;

/// Bytes of device memory for each pixel: colour with inverse depth, and what is compared.
pub(super) const BYTES_PER_PIXEL: u64 = 16 + 4;

const FORMAT: TextureFormat = TextureFormat::Rgba32Float;
const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// A list in buffers.
struct Sent {
    /// Kept, so that no other list can be taken for it.
    list: Arc<List>,
    chunks: Vec<wgpu::Buffer>,
    uniform: wgpu::Buffer,
    binding: wgpu::BindGroup,
}

/// Textures of one size.
struct Targets {
    size_px: [u32; 2],
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// The colour, for fans and pictures.
    binding: wgpu::BindGroup,
}

/// Lists, textures and pipelines; what stays the same between frames is kept.
pub(super) struct GpuGeometry {
    layout: wgpu::BindGroupLayout,
    pipelines: [wgpu::RenderPipeline; 3],
    sent: Vec<Sent>,
    targets: Option<Targets>,
}

/// Vertices that are drawn of a primitive.
fn vertices(primitive: Primitive) -> u32 {
    if primitive == Primitive::Triangles { 3 } else { 6 }
}

impl GpuGeometry {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let ty = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let entry =
            wgpu::BindGroupLayoutEntry { binding: 0, visibility: wgpu::ShaderStages::VERTEX_FRAGMENT, ty, count: None };
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("geometry"), entries: &[entry] });
        let module = shaders::module(&gpu.device, "geometry", shaders::geometry_text());
        let pipelines = [
            (Primitive::Triangles, "triangle", "of_triangle"),
            (Primitive::Lines, "line", "of_line"),
            (Primitive::Points, "point", "of_point"),
        ]
        .map(|(primitive, vertex, fragment)| pipeline(gpu, &layout, &module, primitive, [vertex, fragment]));
        Self { layout, pipelines, sent: Vec::new(), targets: None }
    }

    /// Bytes of device memory that lists and textures of a frame take.
    pub(super) fn device_bytes(opaque: &Opaque, [width, height]: [u32; 2]) -> u64 {
        let lists: u64 = opaque.layers().iter().map(|layer| layer.list.bytes()).sum();
        lists + u64::from(width) * u64::from(height) * BYTES_PER_PIXEL
    }

    /// Sends the lists that are not in buffers, drops those that are not drawn; the bytes that were sent.
    pub(super) fn prepare(
        &mut self,
        gpu: &Gpu,
        frame: &Frame,
        opaque: &Opaque,
        texture: &wgpu::BindGroupLayout,
    ) -> u64 {
        let mut sent_bytes = 0;
        let mut before = std::mem::take(&mut self.sent);
        for layer in opaque.layers() {
            let known = before.iter().position(|sent| Arc::ptr_eq(&sent.list, &layer.list));
            let sent = if let Some(i) = known {
                before.swap_remove(i)
            } else {
                sent_bytes += layer.list.bytes();
                self.send(gpu, &layer.list)
            };
            let uniform = GeometryUniform::new(frame, opaque, layer);
            gpu.queue.write_buffer(&sent.uniform, 0, bytemuck::bytes_of(&uniform));
            self.sent.push(sent);
        }
        let size_px = frame.view.region.size_px();
        if self.targets.as_ref().is_none_or(|targets| targets.size_px != size_px) {
            self.targets = None;
            self.targets = Some(Targets::new(gpu, size_px, texture));
        }
        sent_bytes
    }

    fn send(&self, gpu: &Gpu, list: &Arc<List>) -> Sent {
        let bytes: &[u8] = bytemuck::cast_slice(list.corners());
        let chunks = bytes.chunks(CHUNK_BYTES).map(|chunk| buffer_of(gpu, "geometry", BufferUsages::VERTEX, chunk));
        let chunks = chunks.collect();
        let size = size_of::<GeometryUniform>() as u64;
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let label = Some("geometry");
        let uniform =
            gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false });
        let binding = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label,
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        Sent { list: list.clone(), chunks, uniform, binding }
    }

    /// Draws the layers of the frame that was prepared.
    pub(super) fn draw(&self, encoder: &mut wgpu::CommandEncoder) {
        let Some(targets) = &self.targets else { return };
        let nothing = wgpu::Color { r: 0.0, g: 0.0, b: 0.0, a: f64::from(-f32::MAX) };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("geometry"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &targets.color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(nothing), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        for Sent { list, chunks, binding, .. } in &self.sent {
            let primitive = list.primitive();
            pass.set_pipeline(&self.pipelines[primitive as usize]);
            pass.set_bind_group(0, binding, &[]);
            for chunk in chunks {
                let primitives = chunk.size() / stride(primitive);
                pass.set_vertex_buffer(0, chunk.slice(..));
                pass.draw(0..vertices(primitive), 0..primitives as u32);
            }
        }
    }

    /// What binds colour and inverse depth, for fans and pictures.
    pub(super) fn binding(&self) -> Option<&wgpu::BindGroup> {
        self.targets.as_ref().map(|targets| &targets.binding)
    }
}

/// Bytes of a primitive.
fn stride(primitive: Primitive) -> u64 {
    (primitive.corners() * size_of::<[f32; 3]>()) as u64
}

impl Targets {
    fn new(gpu: &Gpu, size_px: [u32; 2], layout: &wgpu::BindGroupLayout) -> Self {
        let [width, height] = size_px;
        let view = |format, usage| {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("geometry"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let color = view(FORMAT, TextureUsages::TEXTURE_BINDING);
        let binding = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("geometry"),
            layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&color) }],
        });
        Self { size_px, color, depth: view(DEPTH_FORMAT, TextureUsages::empty()), binding }
    }
}

/// A pipeline that draws an instance for each primitive: nearer, or as near, as what is there.
fn pipeline(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    module: &wgpu::ShaderModule,
    primitive: Primitive,
    [vertex, fragment]: [&str; 2],
) -> wgpu::RenderPipeline {
    let label = Some(vertex);
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let corners = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];
    let buffer = wgpu::VertexBufferLayout {
        array_stride: stride(primitive),
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &corners[..primitive.corners()],
    };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(buffer)],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: FORMAT,
                blend: None,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
