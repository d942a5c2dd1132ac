//! `LateTiles`: the tiles in which a cell was drawn after one in front of it.
//!
//! In: what pipelines that check the order leave behind. Out: a flag for each tile, and how many fragments were late.
//! A depth buffer holds the middle of the nearest segment that each pixel has drawn. Cells come from far to near, so a segment
//! that lies behind it comes too late: it fails the depth test, which the stencil counts, and is not drawn. A ray that meets a
//! cell twice has other cells in between: of these the shader (`shaders/order.wgsl`) marks the tile.

use rayon::prelude::*;
use wgpu::{BufferUsages, TextureFormat};

use super::Gpu;
use crate::backends::tiles::TileGrid;
use crate::camera::Region;
use crate::error::Result;

/// Depth buffer, stencil and marks for pictures of one region.
pub(super) struct LateTiles {
    region: Region,
    depth_stencil: wgpu::Texture,
    view: wgpu::TextureView,
    /// A word for each tile; read by what checks the order.
    marks: wgpu::Buffer,
    pub(super) binding: wgpu::BindGroup,
    /// The stencil, row by row, then the marks.
    read_back: wgpu::Buffer,
}

/// Which tiles have to be drawn again.
pub(super) struct Late {
    /// One for each tile, row by row.
    pub(super) tiles: Vec<bool>,
    /// Fragments that came too late, 255 at most of a pixel.
    pub(super) fragments: u64,
}

/// What the depth test runs in: at least 24 bits on every device.
pub(super) fn depth_format(gpu: &Gpu) -> TextureFormat {
    if gpu.device.features().contains(wgpu::Features::DEPTH32FLOAT_STENCIL8) {
        TextureFormat::Depth32FloatStencil8
    } else {
        TextureFormat::Depth24PlusStencil8
    }
}

/// Bytes of device memory for each pixel: depth and stencil, and the stencil that is read back.
pub(super) const BYTES_PER_PIXEL: u64 = 8 + 1;

/// The depth test: nearer, or as near, as what the pixel has drawn. The stencil counts those that fail.
pub(super) fn depth_stencil_state(gpu: &Gpu) -> wgpu::DepthStencilState {
    use wgpu::{CompareFunction, StencilOperation};
    let face = wgpu::StencilFaceState {
        compare: CompareFunction::Always,
        fail_op: StencilOperation::Keep,
        depth_fail_op: StencilOperation::IncrementClamp,
        pass_op: StencilOperation::Keep,
    };
    wgpu::DepthStencilState {
        format: depth_format(gpu),
        depth_write_enabled: Some(true),
        depth_compare: Some(CompareFunction::GreaterEqual),
        stencil: wgpu::StencilState { front: face, back: face, read_mask: 0xff, write_mask: 0xff },
        bias: wgpu::DepthBiasState::default(),
    }
}

impl LateTiles {
    pub(super) fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, region: Region) -> Self {
        let size_px = region.size_px();
        let [width, height] = size_px;
        let depth_stencil = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("order"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: depth_format(gpu),
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let buffer = |label, size, usage| {
            let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
            gpu.device.create_buffer(&descriptor)
        };
        let marks_bytes = 4 * TileGrid::around(region).len() as u64;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let marks = buffer("late tiles", marks_bytes, usage);
        let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        let read_back = buffer("late tiles, read back", stencil_bytes(size_px) + marks_bytes, usage);
        let binding = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("late tiles"),
            layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: marks.as_entire_binding() }],
        });
        let view = depth_stencil.create_view(&wgpu::TextureViewDescriptor::default());
        Self { region, depth_stencil, view, marks, binding, read_back }
    }

    /// Whether it is for this region.
    pub(super) fn is_for(&self, region: Region) -> bool {
        self.region == region
    }

    /// Forgets the last frame's marks.
    pub(super) fn begin(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.marks, 0, None);
    }

    /// What a pass tests against: nothing in the first, then what those before have left.
    pub(super) fn attachment(&self, is_first: bool) -> wgpu::RenderPassDepthStencilAttachment<'_> {
        let (depth, stencil) = if is_first {
            (wgpu::LoadOp::Clear(0.0), wgpu::LoadOp::Clear(0))
        } else {
            (wgpu::LoadOp::Load, wgpu::LoadOp::Load)
        };
        wgpu::RenderPassDepthStencilAttachment {
            view: &self.view,
            depth_ops: Some(wgpu::Operations { load: depth, store: wgpu::StoreOp::Store }),
            stencil_ops: Some(wgpu::Operations { load: stencil, store: wgpu::StoreOp::Store }),
        }
    }

    /// Waits for the frame's passes and finds the tiles.
    pub(super) fn find(&self, gpu: &Gpu) -> Result<Late> {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let bytes_per_row = Some(stencil_row(self.region.size_px()));
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                aspect: wgpu::TextureAspect::StencilOnly,
                ..self.depth_stencil.as_image_copy()
            },
            wgpu::TexelCopyBufferInfo { buffer: &self.read_back, layout },
            self.depth_stencil.size(),
        );
        let at = stencil_bytes(self.region.size_px());
        encoder.copy_buffer_to_buffer(&self.marks, 0, &self.read_back, at, self.marks.size());
        gpu.queue.submit([encoder.finish()]);
        self.read_back.map_async(wgpu::MapMode::Read, .., |_| {});
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|_| gpu.failed("does not answer"))?;
        gpu.check()?;
        let view = self.read_back.get_mapped_range(..).map_err(|_| gpu.failed("gave no order back"))?;
        let (stencil, marks) = view.split_at(at as usize);
        let late = self.late(stencil, marks);
        drop(view);
        self.read_back.unmap();
        Ok(late)
    }

    fn late(&self, stencil: &[u8], marks: &[u8]) -> Late {
        let grid = TileGrid::around(self.region);
        let row_bytes = stencil_row(self.region.size_px()) as usize;
        let of_tile = |tile: usize| -> u64 {
            let Region { x0, y0, x1, y1 } = grid.pixels_in(self.region, tile);
            let columns = (x0 - self.region.x0) as usize..(x1 - self.region.x0) as usize;
            let row = |y: u32| &stencil[(y - self.region.y0) as usize * row_bytes..][columns.clone()];
            (y0..y1).flat_map(row).map(|&late| u64::from(late)).sum()
        };
        let fragments: Vec<u64> = (0..grid.len()).into_par_iter().map(of_tile).collect();
        let marks = marks.chunks_exact(4).map(|word| word != [0; 4]);
        let tiles = fragments.iter().zip(marks).map(|(&late, is_marked)| late > 0 || is_marked);
        Late { tiles: tiles.collect(), fragments: fragments.iter().sum() }
    }
}

/// Bytes from row to row of the stencil that is read back, and of all of it.
fn stencil_row([width, _]: [u32; 2]) -> u32 {
    width.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

fn stencil_bytes(size_px: [u32; 2]) -> u64 {
    u64::from(stencil_row(size_px)) * u64::from(size_px[1])
}
