//! `Targets`: the picture that fragments are blended into, and the picture that it is resolved to.

use half::f16;
use wgpu::{TextureFormat, TextureUsages};

use super::{Gpu, late};
use crate::backends::tiles::TileGrid;
use crate::camera::Region;
use crate::image::Image;

/// Textures of one size.
pub(super) struct Targets {
    pub(super) size_px: [u32; 2],
    /// Sums of contributions.
    accumulated_texture: wgpu::Texture,
    pub(super) accumulated: wgpu::TextureView,
    /// The finished picture.
    pub(super) picture: wgpu::Texture,
}

/// What contributions are blended in.
pub(super) fn accumulated_format(gpu: &Gpu) -> TextureFormat {
    if gpu.blends_in_32_bits() { TextureFormat::Rgba32Float } else { TextureFormat::Rgba16Float }
}

/// What the picture is read back from.
pub(super) const PICTURE_FORMAT: TextureFormat = TextureFormat::Rgba32Float;

/// Bytes of device memory for each pixel: both textures and the buffer that is read back, and what checks the order.
pub(super) const BYTES_PER_PIXEL: u64 = 16 + 16 + 16 + late::BYTES_PER_PIXEL;

impl Targets {
    pub(super) fn new(gpu: &Gpu, [width, height]: [u32; 2]) -> Self {
        let texture = |label, format, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let accumulated = texture("accumulated", accumulated_format(gpu), usage);
        Self {
            size_px: [width, height],
            accumulated: accumulated.create_view(&wgpu::TextureViewDescriptor::default()),
            accumulated_texture: accumulated,
            picture: texture("picture", PICTURE_FORMAT, TextureUsages::COPY_SRC),
        }
    }

    /// Puts some tiles of `image`, which shows `region`, in the place of what was accumulated.
    pub(super) fn replace_tiles(&self, gpu: &Gpu, image: &Image, region: Region, tiles: &[bool]) {
        let [width, _] = self.size_px;
        let grid = TileGrid::around(region);
        for tile in (0..).zip(tiles).filter(|(_, is_late)| **is_late).map(|(tile, _)| tile) {
            let of_tile = grid.pixels_in(region, tile);
            let [x, y] = [of_tile.x0 - region.x0, of_tile.y0 - region.y0];
            let [width_of, height_of] = of_tile.size_px();
            let row = |row: u32| &image.pixels[row as usize * width as usize + x as usize..][..width_of as usize];
            let pixels: Vec<[f32; 4]> = (y..y + height_of).flat_map(row).copied().collect();
            let bytes = match self.accumulated_texture.format() {
                TextureFormat::Rgba16Float => {
                    let halves: Vec<[u16; 4]> =
                        pixels.iter().map(|pixel| pixel.map(|channel| f16::from_f32(channel).to_bits())).collect();
                    bytemuck::cast_slice(&halves).to_vec()
                }
                _ => bytemuck::cast_slice(&pixels).to_vec(),
            };
            let origin = wgpu::Origin3d { x, y, z: 0 };
            let bytes_per_row = Some((bytes.len() / height_of as usize) as u32);
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo { origin, ..self.accumulated_texture.as_image_copy() },
                &bytes,
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None },
                wgpu::Extent3d { width: width_of, height: height_of, depth_or_array_layers: 1 },
            );
        }
    }
}
