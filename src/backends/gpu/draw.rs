//! `GpuCompositor`: fans drawn slice by slice, and the picture made of what they add up to.
//!
//! In: a [`Frame`] and its [`Shading`]. Out: the picture in memory, or in a caller's texture. The calling thread finds the draw
//! order and fills slots of the ring; a thread of its own submits them, since a submission may block; bounded channels lie between.

use std::time::Instant;

use crossbeam_channel::bounded;

use super::Gpu;
use super::accumulate::{BYTES_PER_PIXEL, PICTURE_FORMAT, Targets};
use super::external::color_and_v;
use super::geometry::GpuGeometry;
use super::late::{Late, LateTiles};
use super::pipelines::{Draw, Pipelines};
use super::readback::Readback;
use super::staging::Ring;
use super::submit::{Filled, Submitter};
use super::timestamps::Timestamps;
use crate::backends::draw_order::DrawOrder;
use crate::backends::{Counts, Frame, OpaquePicture};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::optics::Shading;
use crate::profile::{Profile, Track};
use crate::stages::View;
use crate::stages::fans::Fan;

/// Draws triangle fans on a GPU; keeps its buffers, and the last draw order, between frames.
pub struct GpuCompositor {
    gpu: Gpu,
    order: DrawOrder,
    memory_bytes: u64,
    pipelines: Option<Pipelines>,
    targets: Option<(Targets, Readback, Ring)>,
    late: Option<LateTiles>,
    geometry: Option<GpuGeometry>,
    /// Device memory that geometry takes beside the targets.
    geometry_bytes: u64,
    timestamps: Option<Timestamps>,
}

/// Draws some tiles of the frame at hand on the processor, one flag each, in an exact order; the rest of the picture is nothing.
pub trait Redo: FnOnce(&[bool], &mut Profile) -> Result<Image> {}

impl<F: FnOnce(&[bool], &mut Profile) -> Result<Image>> Redo for F {}

/// Whether fragments that come too late are looked for.
fn is_checked(frame: &Frame, shading: Shading) -> bool {
    frame.is_exact && !shading.model.is_order_free()
}

/// What binds the geometry of a frame that has some.
fn bound<'a>(geometry: Option<&'a GpuGeometry>, frame: &Frame) -> Option<&'a wgpu::BindGroup> {
    geometry.filter(|_| frame.opaque.is_some()).and_then(GpuGeometry::binding)
}

/// Bytes of the ring below which a slice is not worth its submission.
const RING_BYTES_MIN: u64 = 1 << 16;

impl GpuCompositor {
    /// Device memory that is used unless another amount is named.
    pub const MEMORY_BYTES: u64 = 256 << 20;

    /// Draws on `gpu` with at most `memory_bytes` of device memory.
    pub fn new(gpu: Gpu, memory_bytes: u64) -> Self {
        let timestamps = Timestamps::new(&gpu);
        Self {
            gpu,
            order: DrawOrder::default(),
            memory_bytes,
            pipelines: None,
            targets: None,
            late: None,
            geometry: None,
            geometry_bytes: 0,
            timestamps,
        }
    }

    /// The device it draws on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Draws one frame and reads it back; `redo` draws the tiles of a frame in which the order must be exact and was not.
    ///
    /// # Errors
    /// [`Error::NoDevice`] where the device fails, [`Error::Memory`] where its memory budget is too small for the picture; those of
    /// `redo`.
    pub fn draw(
        &mut self,
        frame: &Frame,
        shading: Shading,
        redo: impl Redo,
        profile: &mut Profile,
    ) -> Result<(Image, Counts)> {
        let counts = self.accumulate(frame, shading, redo, profile)?;
        let (Some(pipelines), Some((targets, readback, _))) = (&self.pipelines, &self.targets) else {
            return Err(self.gpu.failed("has no picture"));
        };
        let view = targets.picture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        pipelines.resolve(
            &self.gpu,
            PICTURE_FORMAT,
            (&targets.accumulated, bound(self.geometry.as_ref(), frame)),
            &view,
            self.timestamps.as_mut(),
            &mut encoder,
        );
        readback.copy(&targets.picture, &mut encoder);
        self.submit_and_time(encoder, |_| readback.ask(), profile)?;
        let start = Instant::now();
        let _span = tracing::trace_span!("read_back").entered();
        let image = readback.image(&self.gpu)?;
        self.gpu.check()?;
        profile.add("read_back", start.elapsed(), image.pixels.len() as u64 * 16);
        Ok((image, counts))
    }

    /// Draws one frame into a texture of the size of what the view draws, premultiplied and linear (absorption: not premultiplied).
    ///
    /// # Errors
    /// As [`GpuCompositor::draw`], and [`Error::Option`] where the texture does not fit.
    pub fn draw_to_texture(
        &mut self,
        frame: &Frame,
        shading: Shading,
        texture: &wgpu::Texture,
        redo: impl Redo,
        profile: &mut Profile,
    ) -> Result<Counts> {
        let size = [texture.width(), texture.height()];
        if size != frame.view.region.size_px() || !texture.usage().contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
            let [width, height] = frame.view.region.size_px();
            let problem = format!("a texture of {size:?}; a render attachment of {width}x{height} pixels is needed");
            return Err(Error::Option { option: "texture", problem });
        }
        let counts = self.accumulate(frame, shading, redo, profile)?;
        let (Some(pipelines), Some((targets, ..))) = (&mut self.pipelines, &self.targets) else {
            return Err(self.gpu.failed("has no picture"));
        };
        self.gpu.make(|| {
            pipelines.prepare_resolve(&self.gpu, texture.format(), frame.opaque.is_some());
            Ok(())
        })?;
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let timestamps = self.timestamps.as_mut();
        let accumulated = (&targets.accumulated, bound(self.geometry.as_ref(), frame));
        pipelines.resolve(&self.gpu, texture.format(), accumulated, &view, timestamps, &mut encoder);
        self.submit_and_time(encoder, |_| {}, profile)?;
        Ok(counts)
    }

    /// What was opaque in the frame that was drawn last, the one of `view`, as fans saw it.
    ///
    /// # Errors
    /// [`Error::NoDevice`] where the device fails.
    pub fn opaque_picture(&self, view: &View) -> Result<OpaquePicture> {
        let area = view.region;
        let drawn = self.geometry.as_ref().and_then(GpuGeometry::drawn);
        let texture = drawn.ok_or_else(|| self.gpu.failed("has drawn nothing opaque"))?;
        let readback = Readback::new(&self.gpu, area.size_px());
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        readback.copy(texture, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        readback.ask();
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|_| self.gpu.failed("does not answer"))?;
        let texels = readback.image(&self.gpu)?.pixels;
        self.gpu.check()?;
        let (color, v) = texels.into_iter().map(color_and_v).unzip();
        Ok(OpaquePicture { area, color, v })
    }

    /// Submits the last commands of a frame, waits for them, and notes what the passes took.
    fn submit_and_time(
        &self,
        mut encoder: wgpu::CommandEncoder,
        ask: impl Fn(&Gpu),
        profile: &mut Profile,
    ) -> Result<()> {
        if let Some(timestamps) = &self.timestamps {
            timestamps.resolve(&mut encoder);
        }
        let start = Instant::now();
        let _span = tracing::trace_span!("wait_for_gpu").entered();
        self.gpu.queue.submit([encoder.finish()]);
        ask(&self.gpu);
        if let Some(timestamps) = &self.timestamps {
            timestamps.ask();
        }
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|_| self.gpu.failed("does not answer"))?;
        profile.add("wait_for_gpu", start.elapsed(), 0);
        self.gpu.check()?;
        if let Some((draw, resolve)) = self.timestamps.as_ref().and_then(Timestamps::times) {
            profile.add_beside(Track::Gpu, "gpu_draw", draw, 0);
            profile.add_beside(Track::Gpu, "gpu_resolve", resolve, 0);
        }
        Ok(())
    }

    /// Blends all fans of a frame, and puts in place of late tiles what `redo` draws there.
    fn accumulate(
        &mut self,
        frame: &Frame,
        shading: Shading,
        redo: impl Redo,
        profile: &mut Profile,
    ) -> Result<Counts> {
        self.gpu.check()?;
        let start = Instant::now();
        let gpu = self.gpu.clone();
        gpu.make(|| self.prepare(frame, shading))?;
        profile.add("prepare", start.elapsed(), 0);
        let uploaded_bytes = self.draw_geometry(frame, profile)?;
        let mut counts = self.order.find(frame, !shading.model.is_order_free(), profile);
        counts.uploaded_bytes = uploaded_bytes;
        let opaque = bound(self.geometry.as_ref(), frame);
        let (Some(pipelines), Some((targets, _, ring))) = (&mut self.pipelines, &self.targets) else {
            return Err(self.gpu.failed("has no picture"));
        };
        let (gpu, order, mut timestamps) = (&self.gpu, &self.order, self.timestamps.as_mut());
        let input = order.fan_input(frame, pipelines.planes_for());
        let late = self.late.as_ref().filter(|_| is_checked(frame, shading));
        ring.check_room(input.fans_per_cell_max())?;
        let draw = Draw { contents: input.contents(), is_checked: late.is_some(), is_ended: opaque.is_some() };
        gpu.make(|| {
            pipelines.prepare_draw(gpu, draw);
            Ok(())
        })?;
        let pipelines = &*pipelines;
        if let Some(timestamps) = &mut timestamps {
            timestamps.begin();
        }
        let (filled, to_submit) = bounded(1);
        let drawn = std::thread::scope(|scope| {
            let submitter = scope.spawn(move || {
                Submitter { gpu, pipelines, targets, ring, timestamps, draw, late, opaque }.run(&to_submit)
            });
            let mut is_whole = true;
            for slice in order.slices(&input, ring.capacity) {
                let start = Instant::now();
                let span = tracing::trace_span!("wait_for_gpu").entered();
                let Some(slot) = ring.next() else {
                    is_whole = false;
                    break;
                };
                profile.add("wait_for_gpu", start.elapsed(), 0);
                drop(span);
                let start = Instant::now();
                let fans = slice.fans();
                counts.add_classes(slice.write(&input, ring.memory(slot, fans)));
                profile.add("fans", start.elapsed(), (fans * size_of::<Fan>()) as u64);
                if filled.send(Filled { slot, fans, records: slice.records(&input) }).is_err() {
                    break;
                }
            }
            drop(filled);
            let drawn = submitter.join().unwrap_or_else(|_| Err(gpu.failed("could not be fed")));
            if is_whole { drawn } else { Err(gpu.failed("gave no memory to write to")) }
        });
        // A ring that was left in the middle has slots that nobody frees.
        if drawn.is_err() {
            self.targets = None;
        }
        profile.add_beside(Track::Thread, "submit", drawn?, 0);
        self.gpu.check()?;
        if let (Some(late), Some((targets, ..))) = (late, &self.targets) {
            let start = Instant::now();
            let Late { tiles, fragments } = late.find(&self.gpu)?;
            profile.add("check_order", start.elapsed(), 0);
            counts.violations = fragments;
            counts.tiles_redone = tiles.iter().filter(|is_late| **is_late).count() as u64;
            if counts.tiles_redone > 0 {
                targets.replace_tiles(&self.gpu, &redo(&tiles, profile)?, frame.view.region, &tiles);
            }
        }
        Ok(counts)
    }

    /// Sends the frame's geometry where it is new, and has it drawn before the volume; the bytes that were sent.
    fn draw_geometry(&mut self, frame: &Frame, profile: &mut Profile) -> Result<u64> {
        let Some(opaque) = frame.opaque else { return Ok(0) };
        let start = Instant::now();
        let gpu = self.gpu.clone();
        let mut sent_bytes = 0;
        gpu.make(|| {
            let Some(pipelines) = &self.pipelines else { return Ok(()) };
            let geometry = self.geometry.get_or_insert_with(|| GpuGeometry::new(&gpu));
            sent_bytes = geometry.prepare(&gpu, frame, opaque, &pipelines.texture_layout);
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            geometry.draw(&mut encoder);
            gpu.queue.submit([encoder.finish()]);
            Ok(())
        })?;
        profile.add("geometry", start.elapsed(), sent_bytes);
        Ok(sent_bytes)
    }

    /// Makes what the frame needs and the last one did not have.
    fn prepare(&mut self, frame: &Frame, shading: Shading) -> Result<()> {
        let gpu = &self.gpu;
        if self.pipelines.as_ref().is_none_or(|pipelines| !pipelines.are_for(shading)) {
            self.pipelines = Some(Pipelines::new(gpu, shading));
        }
        let Some(pipelines) = &mut self.pipelines else { return Ok(()) };
        pipelines.write_frame(gpu, frame)?;
        pipelines.prepare_resolve(gpu, PICTURE_FORMAT, frame.opaque.is_some());
        let region = frame.view.region;
        let size_px = region.size_px();
        let geometry_bytes = frame.opaque.map_or(0, |opaque| GpuGeometry::device_bytes(opaque, size_px));
        let is_of_size = self.targets.as_ref().is_some_and(|(targets, ..)| targets.size_px == size_px);
        if !is_of_size || geometry_bytes != self.geometry_bytes {
            let [width, height] = size_px;
            let limits = gpu.device.limits();
            let side = limits.max_texture_dimension_2d;
            if width.max(height) > side || Readback::bytes(size_px) > limits.max_buffer_size {
                let problem = format!(
                    "{width}x{height}; {} draws at most {side} pixels a side, {} in all; draw it in parts, by --region",
                    gpu.adapter(),
                    limits.max_buffer_size / Readback::PIXEL as u64
                );
                return Err(Error::Option { option: "--size", problem });
            }
            let picture = u64::from(width) * u64::from(height) * BYTES_PER_PIXEL + geometry_bytes;
            let left = self.memory_bytes.saturating_sub(picture);
            if left < RING_BYTES_MIN {
                let needed = picture + RING_BYTES_MIN;
                let problem = format!("{} bytes; this picture takes {needed}", self.memory_bytes);
                return Err(Error::Option { option: "--gpu-memory", problem });
            }
            self.targets = None;
            let ring = Ring::new(gpu, &pipelines.fans_layout, left)?;
            self.targets = Some((Targets::new(gpu, size_px), Readback::new(gpu, size_px), ring));
            self.geometry_bytes = geometry_bytes;
        }
        if is_checked(frame, shading) && self.late.as_ref().is_none_or(|late| !late.is_for(region)) {
            self.late = Some(LateTiles::new(gpu, &pipelines.late_layout, region));
        }
        Ok(())
    }
}
