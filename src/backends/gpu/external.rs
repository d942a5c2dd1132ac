//! `GpuExternal`: an external picture, drawn to colour and depth before all geometry.
//!
//! In: the external picture of a frame. Out: its colours and inverse depths where geometry goes. It is sent for each frame, since it is
//! that of one view. A texel has room for three colours and a depth: where there is no depth its place holds the opacity of what lies behind
//! everything, as inverse depths that no other thing has (`shaders/behind.wgsl`).

use super::Gpu;
use super::layout::GeometryUniform;
use crate::backends::{Frame, Opaque, OpaquePicture};

/// The picture of a region, on the device.
pub(super) struct GpuExternal {
    size_px: [u32; 2],
    texture: wgpu::Texture,
    texture_binding: wgpu::BindGroup,
    uniform: wgpu::Buffer,
    pub(super) uniform_binding: wgpu::BindGroup,
}

/// Bytes of a texel.
const TEXEL: u32 = 16;

impl GpuExternal {
    /// A texture of the frame's size, to be read through `layout`; a uniform through that of geometry.
    pub(super) fn new(
        gpu: &Gpu,
        size_px: [u32; 2],
        layout: &wgpu::BindGroupLayout,
        uniform_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let (label, [width, height]) = (Some("external"), size_px);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: super::geometry::FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let texture_binding = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label,
            layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) }],
        });
        let (uniform, uniform_binding) = super::geometry::uniform(gpu, uniform_layout);
        Self { size_px, texture, texture_binding, uniform, uniform_binding }
    }

    pub(super) fn is_of(&self, size_px: [u32; 2]) -> bool {
        self.size_px == size_px
    }

    /// Sends `picture`, which covers the frame's region; the bytes.
    pub(super) fn send(&self, gpu: &Gpu, frame: &Frame, opaque: &Opaque, picture: &OpaquePicture) -> u64 {
        let uniform = GeometryUniform::new(frame, opaque, None);
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let texels: Vec<[f32; 4]> = picture.color.iter().zip(&picture.v).map(texel).collect();
        let bytes: &[u8] = bytemuck::cast_slice(&texels);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.size_px[0] * TEXEL),
            rows_per_image: None,
        };
        gpu.queue.write_texture(self.texture.as_image_copy(), bytes, layout, self.texture.size());
        bytes.len() as u64
    }

    /// Draws it.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass) {
        pass.set_bind_group(0, &self.uniform_binding, &[]);
        pass.set_bind_group(1, &self.texture_binding, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Colour and inverse depth; where there is none, the opacity.
fn texel((&[r, g, b, a], &v): (&[f32; 4], &f32)) -> [f32; 4] {
    let far_behind = -f32::MAX * (1.0 - 0.5 * a.clamp(0.0, 1.0));
    [r, g, b, if v > f32::NEG_INFINITY { v } else { far_behind }]
}

/// The same read back.
pub(super) fn color_and_v([r, g, b, v]: [f32; 4]) -> ([f32; 4], f32) {
    if v > -0.25 * f32::MAX {
        return ([r, g, b, 1.0], v);
    }
    ([r, g, b, (2.0 + 2.0 * (v / f32::MAX)).clamp(0.0, 1.0)], f32::NEG_INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texel_holds_a_depth_or_an_opacity() {
        for v in [1e30, 1e-30, 0.0, -1.0, -1e30] {
            assert_eq!(color_and_v(texel((&[0.25, 0.5, 0.75, 1.0], &v))), ([0.25, 0.5, 0.75, 1.0], v));
        }
        for a in [0.0, 0.25, 0.5, 1.0] {
            let (color, v) = color_and_v(texel((&[0.25, 0.5, 0.75, a], &f32::NEG_INFINITY)));
            assert_eq!((color, v), ([0.25, 0.5, 0.75, a], f32::NEG_INFINITY));
        }
    }
}
