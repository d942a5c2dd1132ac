//! `Readback`: the finished picture, from a texture to memory.

use rayon::prelude::*;

use super::Gpu;
use crate::error::Result;
use crate::image::Image;

/// A buffer that pictures of one size are copied into.
pub(super) struct Readback {
    buffer: wgpu::Buffer,
    size_px: [u32; 2],
    /// Bytes from row to row.
    row: u32,
}

impl Readback {
    /// Bytes of a pixel.
    pub(super) const PIXEL: usize = 16;

    /// Bytes from row to row of pictures `width` pixels wide.
    fn row(width: u32) -> u32 {
        (width * Self::PIXEL as u32).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
    }

    /// Bytes of a picture.
    pub(super) fn bytes([width, height]: [u32; 2]) -> u64 {
        u64::from(Self::row(width)) * u64::from(height)
    }

    pub(super) fn new(gpu: &Gpu, size_px: [u32; 2]) -> Self {
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture, read back"),
            size: Self::bytes(size_px),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { buffer, size_px, row: Self::row(size_px[0]) }
    }

    /// Copies the picture, once `encoder` has run.
    pub(super) fn copy(&self, picture: &wgpu::Texture, encoder: &mut wgpu::CommandEncoder) {
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(self.row), rows_per_image: None };
        let buffer = wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout };
        encoder.copy_texture_to_buffer(picture.as_image_copy(), buffer, picture.size());
    }

    /// Asks for the picture; it is there after the next wait for the device.
    pub(super) fn ask(&self) {
        self.buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    }

    /// The picture.
    pub(super) fn image(&self, gpu: &Gpu) -> Result<Image> {
        let [width, height] = self.size_px;
        let view = self.buffer.get_mapped_range(..).map_err(|_| gpu.failed("gave no picture back"))?;
        let mut image = Image::filled(width, height, [0.0; 4]);
        let rows = image.pixels.par_chunks_mut(width as usize).zip(view.par_chunks(self.row as usize));
        rows.for_each(|(pixels, bytes)| {
            bytemuck::cast_slice_mut(pixels).copy_from_slice(&bytes[..width as usize * Self::PIXEL]);
        });
        drop(view);
        self.buffer.unmap();
        Ok(image)
    }
}
