//! The renderer on a GPU: into memory, or into a caller's texture.

use super::{RenderOptions, Rendered, Renderer, Scene};
use crate::backends::Frame;
use crate::backends::gpu::{Gpu, GpuCompositor};
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::optics::Shading;
use crate::profile::Profile;

impl Renderer {
    /// A renderer that draws on `gpu`, in at most `memory_bytes` of its memory
    /// ([`GpuCompositor::MEMORY_BYTES`] is a good amount); a mesh of any size flows through them.
    ///
    /// Cells are drawn as triangle fans, with [`SortMethod::Auto`](crate::SortMethod::Auto) in their topological order, which is
    /// exact where it finds no cycle: `cpu_method` and `stop_transmittance` have no effect.
    ///
    /// ```no_run
    /// use cellfan::{RenderOptions, Renderer, backends::gpu::{Gpu, GpuCompositor}};
    /// let gpu = Gpu::open(None)?;
    /// println!("drawing on {}", gpu.adapter());
    /// let renderer = Renderer::on_gpu(RenderOptions::default(), gpu, GpuCompositor::MEMORY_BYTES);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn on_gpu(options: RenderOptions, gpu: Gpu, memory_bytes: u64) -> Self {
        Self { gpu: Some(GpuCompositor::new(gpu, memory_bytes)), ..Self::new(options) }
    }

    /// The GPU that draws; none where the processor does.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.gpu.as_ref().map(GpuCompositor::gpu)
    }

    /// Whether what draws can dim each channel on its own.
    pub(super) fn check_blends_by_channel(&self) -> Result<()> {
        match self.gpu() {
            Some(gpu) if !gpu.blends_by_channel() => {
                let adapter = gpu.adapter();
                let problem = format!("{adapter} cannot dim each channel on its own, as --bands asks; draw on the CPU");
                Err(Error::Option { option: "--backend gpu", problem })
            }
            _ => Ok(()),
        }
    }

    /// Some tiles of a frame, exact in their order, drawn on the processor.
    pub(super) fn redo(&mut self, frame: &Frame, tiles: &[bool], profile: &mut Profile) -> Result<Image> {
        let (image, _) = self.draw_on_cpu(&Frame { tiles: Some(tiles), ..*frame }, profile)?;
        Ok(image)
    }

    /// Draws one frame into `texture`, a render attachment of the size of what the camera draws (its region, if it has one) on the renderer's own device
    /// ([`Gpu::from_device`]), and waits for it. Pixels are those of [`Renderer::render`], as linear values; the image that comes
    /// back is empty.
    ///
    /// # Errors
    /// Those of [`Renderer::render`]; [`Error::Option`] where the renderer is on no GPU or the texture does not fit.
    pub fn render_to_texture(&mut self, scene: &Scene, camera: &Camera, texture: &wgpu::Texture) -> Result<Rendered> {
        self.run(scene, camera, |renderer, frame, profile| {
            let RenderOptions { model, integral, output, .. } = renderer.options;
            let shading = Shading { model, integral, output, has_bands: false };
            if scene.bands.is_some() {
                let problem = "a texture holds no bands of their own; take them from Renderer::render".to_owned();
                return Err(Error::Option { option: "texture", problem });
            }
            let Some(mut gpu) = renderer.gpu.take() else {
                let problem = "this renderer draws on the processor; make it with Renderer::on_gpu".to_owned();
                return Err(Error::Option { option: "texture", problem });
            };
            let redo = |tiles: &[bool], profile: &mut Profile| renderer.redo(frame, tiles, profile);
            let counts = gpu.draw_to_texture(frame, shading, texture, redo, profile);
            renderer.gpu = Some(gpu);
            let counts = counts?;
            Ok((Image::filled(0, 0, [0.0; 4]), None, counts))
        })
    }
}
