//! `GpuGeometry`: opaque geometry drawn to colour and depth, before the volume.
//!
//! In: the layers of a frame, an external picture. Out: a texture of linear RGB and inverse depth, at which fans end and behind which they show
//! it. A list is sent once and stays in buffers as long as frames draw it; what changes from frame to frame is a uniform for each layer.

use std::sync::Arc;

use wgpu::{BufferUsages, TextureFormat, TextureUsages};

use super::Gpu;
use super::external::GpuExternal;
use super::layout::GeometryUniform;
use super::pipelines::buffer_of;
use super::shaders;
use crate::backends::{Frame, Opaque};
use crate::geometry::{List, Looks, Primitive};

/// Primitives in a buffer at most.
const CHUNK: usize = 1 << 20;

/// Bytes of device memory for each pixel: colour with inverse depth, and what is compared.
pub(super) const BYTES_PER_PIXEL: u64 = 16 + 4;

pub(super) const FORMAT: TextureFormat = TextureFormat::Rgba32Float;
const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// A list in buffers.
struct Sent {
    /// Kept, so that no other list can be taken for it.
    list: Arc<List>,
    chunks: Vec<Chunk>,
    uniform: wgpu::Buffer,
    binding: wgpu::BindGroup,
}

/// Some primitives of a list.
struct Chunk {
    primitives: u32,
    corners: wgpu::Buffer,
    looks: Option<wgpu::Buffer>,
}

/// What a pipeline draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Primitives(Primitive),
    /// Triangles whose corners have looks of their own.
    WithLooks,
}

/// Pipelines of each kind: where they begin in the shaders, and end.
const KINDS: [(Kind, [&str; 2]); 4] = [
    (Kind::Primitives(Primitive::Triangles), ["triangle", "of_triangle"]),
    (Kind::Primitives(Primitive::Lines), ["line", "of_line"]),
    (Kind::Primitives(Primitive::Points), ["point", "of_point"]),
    (Kind::WithLooks, ["triangle_with_looks", "of_triangle_with_looks"]),
];

impl Kind {
    fn of(list: &List) -> Self {
        if list.looks().is_some() { Self::WithLooks } else { Self::Primitives(list.primitive()) }
    }

    fn primitive(self) -> Primitive {
        match self {
            Self::Primitives(primitive) => primitive,
            Self::WithLooks => Primitive::Triangles,
        }
    }
}

/// Textures of one size.
struct Targets {
    size_px: [u32; 2],
    texture: wgpu::Texture,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// The colour, for fans and pictures.
    binding: wgpu::BindGroup,
}

/// Lists, textures and pipelines; what stays the same between frames is kept.
pub(super) struct GpuGeometry {
    layout: wgpu::BindGroupLayout,
    module: wgpu::ShaderModule,
    pipelines: [wgpu::RenderPipeline; 4],
    sent: Vec<Sent>,
    targets: Option<Targets>,
    /// With what draws it; made when a frame first has one.
    external: Option<(GpuExternal, wgpu::RenderPipeline)>,
    has_external: bool,
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
        let pipelines = KINDS.map(|(kind, entry_points)| {
            let buffers = buffers(kind);
            let buffers: Vec<_> = buffers.iter().map(|buffer| Some(buffer.clone())).collect();
            pipeline(gpu, &[Some(&layout)], &module, &buffers, entry_points)
        });
        Self { layout, module, pipelines, sent: Vec::new(), targets: None, external: None, has_external: false }
    }

    /// Bytes of device memory that lists and textures of a frame take.
    pub(super) fn device_bytes(opaque: &Opaque, [width, height]: [u32; 2]) -> u64 {
        let lists: u64 = opaque.layers().iter().map(|layer| layer.list.bytes()).sum();
        let external = if opaque.external().is_some() { 16 } else { 0 };
        lists + u64::from(width) * u64::from(height) * (BYTES_PER_PIXEL + external)
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
            let uniform = GeometryUniform::new(frame, opaque, Some(layer));
            gpu.queue.write_buffer(&sent.uniform, 0, bytemuck::bytes_of(&uniform));
            self.sent.push(sent);
        }
        let size_px = frame.view.region.size_px();
        if self.targets.as_ref().is_none_or(|targets| targets.size_px != size_px) {
            self.targets = None;
            self.targets = Some(Targets::new(gpu, size_px, texture));
        }
        self.has_external = opaque.external().is_some();
        if let Some(picture) = opaque.external() {
            let known = self.external.take().filter(|(external, _)| external.is_of(size_px));
            let (external, _) = self.external.insert(known.unwrap_or_else(|| {
                let layouts = [Some(&self.layout), Some(texture)];
                let pipeline = pipeline(gpu, &layouts, &self.module, &[], ["whole_picture", "of_external"]);
                (GpuExternal::new(gpu, size_px, texture, &self.layout), pipeline)
            }));
            sent_bytes += external.send(gpu, frame, opaque, picture);
        }
        sent_bytes
    }

    fn send(&self, gpu: &Gpu, list: &Arc<List>) -> Sent {
        let corners_each = list.primitive().corners();
        let looks = list.looks().map(interleaved);
        let buffer =
            |values: &[[f32; 3]]| buffer_of(gpu, "geometry", BufferUsages::VERTEX, bytemuck::cast_slice(values));
        let chunks = list.corners().chunks(CHUNK * corners_each).enumerate().map(|(i, corners)| {
            let primitives = corners.len() / corners_each;
            let of_chunk = |looks: &Vec<[[f32; 3]; 6]>| buffer(looks[i * CHUNK..][..primitives].as_flattened());
            Chunk { primitives: primitives as u32, corners: buffer(corners), looks: looks.as_ref().map(of_chunk) }
        });
        let chunks = chunks.collect();
        let (uniform, binding) = uniform(gpu, &self.layout);
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
        if let Some((external, pipeline)) = self.external.as_ref().filter(|_| self.has_external) {
            pass.set_pipeline(pipeline);
            external.draw(&mut pass);
        }
        for Sent { list, chunks, binding, .. } in &self.sent {
            let kind = Kind::of(list);
            let known = KINDS.iter().position(|(known, _)| *known == kind).unwrap_or_default();
            pass.set_pipeline(&self.pipelines[known]);
            pass.set_bind_group(0, binding, &[]);
            for Chunk { primitives, corners, looks } in chunks {
                pass.set_vertex_buffer(0, corners.slice(..));
                if let Some(looks) = looks {
                    pass.set_vertex_buffer(1, looks.slice(..));
                }
                pass.draw(0..vertices(kind.primitive()), 0..*primitives);
            }
        }
    }

    /// Colour and inverse depth as they were drawn; none before a frame had any.
    pub(super) fn drawn(&self) -> Option<&wgpu::Texture> {
        self.targets.as_ref().map(|targets| &targets.texture)
    }

    /// What binds colour and inverse depth, for fans and pictures.
    pub(super) fn binding(&self) -> Option<&wgpu::BindGroup> {
        self.targets.as_ref().map(|targets| &targets.binding)
    }
}

/// Colours of three corners, then their normals, zero where there are none.
fn interleaved(Looks { colors, normals }: &Looks) -> Vec<[[f32; 3]; 6]> {
    let three = |each: &[[f32; 3]], i: usize, k: usize| each.get(3 * i + k).copied().unwrap_or_default();
    let triangles = colors.len().max(normals.len()) / 3;
    let of = |i| std::array::from_fn(|k| if k < 3 { three(colors, i, k) } else { three(normals, i, k - 3) });
    (0..triangles).map(of).collect()
}

/// A uniform for a layer, and what binds it.
pub(super) fn uniform(gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> (wgpu::Buffer, wgpu::BindGroup) {
    let (label, size) = (Some("geometry"), size_of::<GeometryUniform>() as u64);
    let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
    let uniform = gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false });
    let binding = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label,
        layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
    });
    (uniform, binding)
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
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            (texture, view)
        };
        let (texture, color) = view(FORMAT, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC);
        let binding = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("geometry"),
            layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&color) }],
        });
        let (_, depth) = view(DEPTH_FORMAT, TextureUsages::empty());
        Self { size_px, texture, color, depth, binding }
    }
}

/// What an instance of a kind reads: corners, and their looks.
fn buffers(kind: Kind) -> Vec<wgpu::VertexBufferLayout<'static>> {
    const CORNERS: [wgpu::VertexAttribute; 3] =
        wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];
    const LOOKS: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
        3 => Float32x3, 4 => Float32x3, 5 => Float32x3, 6 => Float32x3, 7 => Float32x3, 8 => Float32x3
    ];
    let of = |attributes: &'static [wgpu::VertexAttribute]| wgpu::VertexBufferLayout {
        array_stride: (attributes.len() * size_of::<[f32; 3]>()) as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes,
    };
    let corners = of(&CORNERS[..kind.primitive().corners()]);
    if kind == Kind::WithLooks { vec![corners, of(&LOOKS)] } else { vec![corners] }
}

/// A pipeline that draws an instance for each primitive: nearer, or as near, as what is there.
fn pipeline(
    gpu: &Gpu,
    layouts: &[Option<&wgpu::BindGroupLayout>],
    module: &wgpu::ShaderModule,
    buffers: &[Option<wgpu::VertexBufferLayout>],
    [vertex, fragment]: [&str; 2],
) -> wgpu::RenderPipeline {
    let label = Some(vertex);
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: layouts,
        immediate_size: 0,
    });
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers,
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
