//! `Pipelines`: the state in which fans are drawn and pictures resolved, for one model, and what all passes of a frame read.

use std::ops::Range;

use wgpu::{BufferUsages, ShaderStages, TextureFormat};

use super::Gpu;
use super::accumulate::accumulated_format;
use super::late::{LateTiles, depth_stencil_state};
use super::layout::{FrameUniform, Texels, piece_bytes};
use super::shaders::{self, Blend, ModelShaders};
use super::timestamps::Timestamps;
use crate::backends::Frame;
use crate::columns::Field;
use crate::error::Result;
use crate::optics::texture::OpacityTexture;
use crate::optics::{Integral, Model, Shading, Textured};
use crate::stages::fans::{CaseFan, Contents, Faces, Fan, PlanesFor};

/// Fans that one draw takes: their vertices have 16-bit numbers, relative to the draw's first.
const FANS_PER_DRAW: usize = 1 << 13;

/// What a pipeline draws, and whether it checks the order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Draw {
    pub(super) contents: Contents,
    pub(super) is_checked: bool,
    /// Whether opaque geometry ends rays.
    pub(super) is_ended: bool,
}

/// Everything but textures and fans.
pub(super) struct Pipelines {
    of: Shading,
    shaders: ModelShaders,
    /// For what there may be among the fans.
    draw: Vec<(Draw, wgpu::RenderPipeline)>,
    /// Indices of [`FANS_PER_DRAW`] fans.
    indices: wgpu::Buffer,
    frame: wgpu::Buffer,
    frame_layout: wgpu::BindGroupLayout,
    frame_binding: Option<wgpu::BindGroup>,
    /// What pieces and opacity texture in `frame_binding` were made of.
    bound: Option<Bound>,
    pub(super) fans_layout: wgpu::BindGroupLayout,
    pub(super) late_layout: wgpu::BindGroupLayout,
    /// A texture that is read pixel by pixel.
    pub(super) texture_layout: wgpu::BindGroupLayout,
    /// By format, and whether there is opaque geometry behind the picture.
    resolve: Vec<((TextureFormat, bool), wgpu::RenderPipeline)>,
}

/// A transfer function that is bound.
struct Bound {
    pieces: Vec<u8>,
    diagonal_world: f64,
    texels: Texels,
}

fn buffer_entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    let ty = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    wgpu::BindGroupLayoutEntry { binding, visibility: ShaderStages::VERTEX_FRAGMENT, ty, count: None }
}

fn entry(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }
}

const STORAGE: wgpu::BufferBindingType = wgpu::BufferBindingType::Storage { read_only: true };

impl Pipelines {
    pub(super) fn new(gpu: &Gpu, shading: Shading) -> Self {
        let device = &gpu.device;
        let shaders = shaders::of(shading);
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let frame_layout =
            layout("frame", &[buffer_entry(0, uniform), buffer_entry(1, STORAGE), buffer_entry(2, STORAGE)]);
        let fans_layout = layout("fans", &[buffer_entry(0, STORAGE)]);
        let written = wgpu::BufferBindingType::Storage { read_only: false };
        let late_layout = layout(
            "late tiles",
            &[wgpu::BindGroupLayoutEntry { visibility: ShaderStages::FRAGMENT, ..buffer_entry(0, written) }],
        );
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let texture_layout = layout(
            "texture",
            &[wgpu::BindGroupLayoutEntry { binding: 0, visibility: ShaderStages::FRAGMENT, ty: texture, count: None }],
        );
        let frame = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<FrameUniform>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            of: shading,
            shaders,
            draw: Vec::new(),
            indices: buffer_of(gpu, "indices", BufferUsages::INDEX, bytemuck::cast_slice(&indices())),
            frame,
            frame_layout,
            frame_binding: None,
            bound: None,
            fans_layout,
            late_layout,
            texture_layout,
            resolve: Vec::new(),
        }
    }

    pub(super) fn are_for(&self, shading: Shading) -> bool {
        self.of == shading
    }

    /// Which cells the model wants as planes.
    pub(super) fn planes_for(&self) -> PlanesFor {
        self.shaders.planes_for
    }

    /// Writes what all passes of the frame read.
    pub(super) fn write_frame(&mut self, gpu: &Gpu, frame: &Frame) -> Result<()> {
        let (pieces, diagonal_world) = (piece_bytes(frame), frame.dataset.diagonal_world());
        let is_bound = self
            .bound
            .as_ref()
            .is_some_and(|bound| bound.pieces == pieces && bound.diagonal_world.total_cmp(&diagonal_world).is_eq());
        if !is_bound {
            let textured = match (self.of.model, self.of.integral) {
                (Model::EmissionAbsorption, Integral::Texture) => Some(Textured::new(frame.pieces, diagonal_world)?),
                _ => None,
            };
            let texture = textured.as_ref().map(Textured::texture);
            self.bind(gpu, &pieces, texture.map_or(&[0.0], OpacityTexture::texels));
            self.bound = Some(Bound { pieces, diagonal_world, texels: texture.map(Texels::of).unwrap_or_default() });
        }
        let texels = self.bound.as_ref().map_or(Texels::default(), |bound| bound.texels);
        let s_middle_scale = if gpu.blends_in_32_bits() { (0.0, 1.0) } else { to_unit_interval(frame.field) };
        let uniform = FrameUniform::new(frame, texels, s_middle_scale);
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&uniform));
        Ok(())
    }

    /// Binds pieces and texels; neither is empty.
    fn bind(&mut self, gpu: &Gpu, pieces: &[u8], texels: &[f32]) {
        let pieces = buffer_of(gpu, "pieces", BufferUsages::STORAGE, pieces);
        let texels = buffer_of(gpu, "opacity texture", BufferUsages::STORAGE, bytemuck::cast_slice(texels));
        self.frame_binding = Some(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &self.frame_layout,
            entries: &[entry(0, &self.frame), entry(1, &pieces), entry(2, &texels)],
        }));
    }

    /// Makes sure that fans can be drawn like this.
    pub(super) fn prepare_draw(&mut self, gpu: &Gpu, draw: Draw) {
        if self.draw.iter().any(|(known, _)| *known == draw) {
            return;
        }
        let Draw { contents, is_checked, is_ended } = draw;
        let fragment = if is_checked { "fragment_in_order" } else { "fragment" };
        let layouts = [
            Some(&self.frame_layout),
            Some(&self.fans_layout),
            is_checked.then_some(&self.late_layout),
            is_ended.then_some(&self.texture_layout),
        ];
        let target = (accumulated_format(gpu), Some(blend_state(self.shaders.blend)));
        let has_hexahedra = contents.whole_cells == Some(Faces::Exact);
        let constants = [("HAS_HEXAHEDRA", has_hexahedra), ("HAS_POLYHEDRA", contents.has_polyhedra)]
            .map(|(name, has)| (name, f64::from(u8::from(has))));
        let vertex = if contents.whole_cells == Some(Faces::Fan) { "vertex_of_triangle" } else { "vertex" };
        let module = shaders::module(&gpu.device, "fans", self.shaders.draw_text(contents, is_ended));
        let shader = Shader { module: &module, vertex, fragment, constants: &constants };
        let depth = is_checked.then(|| depth_stencil_state(gpu));
        self.draw.push((draw, pipeline(gpu, &layouts, shader, target, depth)));
    }

    /// Draws the records that stand in the room of these fans of a slot.
    pub(super) fn draw(
        &self,
        slot: &wgpu::BindGroup,
        (records, draw): (&[Range<usize>], Draw),
        (is_first, late, opaque): (bool, Option<&LateTiles>, Option<&wgpu::BindGroup>),
        accumulated: &wgpu::TextureView,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let load = if is_first { self.clear_color() } else { wgpu::LoadOp::Load };
        if let (true, Some(late)) = (is_first, late) {
            late.begin(encoder);
        }
        let depth = late.map(|late| late.attachment(is_first));
        let mut pass = begin(encoder, "fans", (accumulated, load), depth, timestamps);
        let Some((_, pipeline)) = self.draw.iter().find(|(known, _)| *known == draw) else { return };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, self.frame_binding.as_ref(), &[]);
        pass.set_bind_group(1, slot, &[]);
        if let Some(late) = late {
            pass.set_bind_group(2, &late.binding, &[]);
        }
        if opaque.is_some() {
            pass.set_bind_group(3, opaque, &[]);
        }
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        let contents = draw.contents;
        let per_record = contents.fans_per_record();
        let parts = records.iter().map(|fans| fans.start / per_record..fans.end / per_record).flat_map(|run| {
            let end = run.end;
            run.step_by(FANS_PER_DRAW).map(move |first| (first, FANS_PER_DRAW.min(end - first)))
        });
        for (first, count) in parts {
            if contents.whole_cells == Some(Faces::Fan) {
                let vertices = 3 * CaseFan::TRIANGLES_MAX;
                pass.draw((first * vertices) as u32..((first + count) * vertices) as u32, 0..1);
                continue;
            }
            pass.draw_indexed(0..(count * INDICES_PER_FAN) as u32, (first * VERTICES_PER_FAN) as i32, 0..1);
        }
    }

    fn clear_color(&self) -> wgpu::LoadOp<wgpu::Color> {
        let [r, g, b, a] = self.shaders.clear;
        wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a })
    }

    /// A picture without any fan.
    pub(super) fn clear(&self, accumulated: &wgpu::TextureView, encoder: &mut wgpu::CommandEncoder) {
        drop(begin(encoder, "no fans", (accumulated, self.clear_color()), None, None));
    }

    /// Makes sure that pictures of `format` can be resolved.
    pub(super) fn prepare_resolve(&mut self, gpu: &Gpu, format: TextureFormat, has_behind: bool) {
        if self.resolve.iter().any(|(known, _)| *known == (format, has_behind)) {
            return;
        }
        let layouts =
            [Some(&self.frame_layout), Some(&self.texture_layout), has_behind.then_some(&self.texture_layout)];
        let module = &shaders::module(&gpu.device, "resolve", shaders::resolve_text(has_behind));
        let fragment = self.shaders.resolve;
        let shader = Shader { module, vertex: "whole_picture", fragment, constants: &[] };
        self.resolve.push(((format, has_behind), pipeline(gpu, &layouts, shader, (format, None), None)));
    }

    /// Makes the picture of what was accumulated.
    pub(super) fn resolve(
        &self,
        gpu: &Gpu,
        format: TextureFormat,
        (accumulated, behind): (&wgpu::TextureView, Option<&wgpu::BindGroup>),
        picture: &wgpu::TextureView,
        timestamps: Option<&mut Timestamps>,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let Some((_, pipeline)) = self.resolve.iter().find(|(known, _)| *known == (format, behind.is_some())) else {
            return;
        };
        let binding = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("accumulated"),
            layout: &self.texture_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(accumulated) }],
        });
        let load = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let mut pass = begin(encoder, "resolve", (picture, load), None, timestamps.map(Timestamps::of_picture));
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, self.frame_binding.as_ref(), &[]);
        pass.set_bind_group(1, &binding, &[]);
        if behind.is_some() {
            pass.set_bind_group(2, behind, &[]);
        }
        pass.draw(0..3, 0..1);
    }
}

/// Middle and scale that map the stored values of `field` to −1..1.
fn to_unit_interval(field: &Field) -> (f32, f32) {
    let (low, high) = field
        .block_ranges
        .iter()
        .fold((f32::MAX, f32::MIN), |(low, high), range| (low.min(range.0), high.max(range.1)));
    let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
    if half > f32::MIN_POSITIVE { (middle, half.recip()) } else { (middle, 1.0) }
}

/// Vertices of a fan: the thick one and the ring.
const VERTICES_PER_FAN: usize = 5;
/// Indices of a fan.
const INDICES_PER_FAN: usize = 3 * Fan::TRIANGLES.len();

/// The triangles of [`FANS_PER_DRAW`] fans, one after the other.
fn indices() -> Vec<u16> {
    let of_fan =
        |fan: usize| Fan::TRIANGLES.into_iter().flatten().map(move |vertex| (fan * VERTICES_PER_FAN) as u16 + vertex);
    (0..FANS_PER_DRAW).flat_map(of_fan).collect()
}

/// A buffer with `contents`, whose length is a multiple of 4. (The library's own function panics on a device that is gone.)
pub(super) fn buffer_of(gpu: &Gpu, label: &str, usage: BufferUsages, contents: &[u8]) -> wgpu::Buffer {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: contents.len() as u64,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, contents);
    buffer
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    label: &str,
    (view, load): (&wgpu::TextureView, wgpu::LoadOp<wgpu::Color>),
    depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment,
        timestamp_writes,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

fn blend_state(blend: Blend) -> wgpu::BlendState {
    use wgpu::{BlendComponent, BlendFactor, BlendOperation};
    let (operation, dst_factor) = match blend {
        Blend::Over => (BlendOperation::Add, BlendFactor::OneMinusSrcAlpha),
        Blend::OverByChannel => (BlendOperation::Add, BlendFactor::Src1),
        Blend::Add => (BlendOperation::Add, BlendFactor::One),
        Blend::Max => (BlendOperation::Max, BlendFactor::One),
    };
    let component = |dst_factor| BlendComponent { src_factor: BlendFactor::One, dst_factor, operation };
    let alpha_factor = if dst_factor == BlendFactor::Src1 { BlendFactor::Src1Alpha } else { dst_factor };
    wgpu::BlendState { color: component(dst_factor), alpha: component(alpha_factor) }
}

/// Entry points of a module, with values for its constants.
struct Shader<'a> {
    module: &'a wgpu::ShaderModule,
    vertex: &'a str,
    fragment: &'a str,
    constants: &'a [(&'a str, f64)],
}

/// A pipeline that draws triangles into `(format, blend)`.
fn pipeline(
    gpu: &Gpu,
    layouts: &[Option<&wgpu::BindGroupLayout>],
    Shader { module, vertex, fragment, constants }: Shader<'_>,
    (format, blend): (TextureFormat, Option<wgpu::BlendState>),
    depth_stencil: Option<wgpu::DepthStencilState>,
) -> wgpu::RenderPipeline {
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(fragment),
        bind_group_layouts: layouts,
        immediate_size: 0,
    });
    let compilation_options =
        wgpu::PipelineCompilationOptions { constants, ..wgpu::PipelineCompilationOptions::default() };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: compilation_options.clone(),
            targets: &[Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
