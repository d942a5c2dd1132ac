//! `Targets`: the picture that fragments are blended into, and the picture that it is resolved to.

use wgpu::{TextureFormat, TextureUsages};

use super::Gpu;

/// Textures of one size.
pub(super) struct Targets {
    pub(super) size_px: [u32; 2],
    /// Sums of contributions.
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

/// Bytes of device memory for each pixel: both textures and the buffer that is read back.
pub(super) const BYTES_PER_PIXEL: u64 = 16 + 16 + 16;

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
        let accumulated = texture("accumulated", accumulated_format(gpu), TextureUsages::TEXTURE_BINDING);
        Self {
            size_px: [width, height],
            accumulated: accumulated.create_view(&wgpu::TextureViewDescriptor::default()),
            picture: texture("picture", PICTURE_FORMAT, TextureUsages::COPY_SRC),
        }
    }
}
