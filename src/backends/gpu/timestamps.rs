//! `Timestamps`: what each pass takes on the GPU, where it has clocks.

use std::time::Duration;

use wgpu::{BufferUsages, Features};

use super::Gpu;

/// Passes that are timed, the last of them the one that makes the picture. Of a frame with more, these stand for all.
const PASSES: u32 = 1024;
/// Bytes of a timestamp.
const BYTES: u64 = 8;

/// Clocks before and after passes.
pub(super) struct Timestamps {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read: wgpu::Buffer,
    nanoseconds_per_tick: f64,
    used: u32,
    /// Passes that draw fans, timed or not.
    drawn: u32,
}

impl Timestamps {
    /// None where the device has none.
    pub(super) fn new(gpu: &Gpu) -> Option<Self> {
        if !gpu.device.features().contains(Features::TIMESTAMP_QUERY) {
            return None;
        }
        let buffer = |usage| {
            let size = u64::from(2 * PASSES) * BYTES;
            let label = Some("timestamps");
            gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
        };
        let label = Some("passes");
        let ty = wgpu::QueryType::Timestamp;
        Some(Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor { label, ty, count: 2 * PASSES }),
            resolved: buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            read: buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ),
            nanoseconds_per_tick: f64::from(gpu.queue.get_timestamp_period()),
            used: 0,
            drawn: 0,
        })
    }

    /// Begins a frame.
    pub(super) fn begin(&mut self) {
        (self.used, self.drawn) = (0, 0);
    }

    /// What times the next pass that draws fans; none beyond those that are timed.
    pub(super) fn of_fans(&mut self) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.drawn += 1;
        (self.drawn < PASSES).then(|| self.of_pass())
    }

    /// What times the pass that makes the picture.
    pub(super) fn of_picture(&mut self) -> wgpu::RenderPassTimestampWrites<'_> {
        self.of_pass()
    }

    fn of_pass(&mut self) -> wgpu::RenderPassTimestampWrites<'_> {
        let first = 2 * self.used;
        self.used += 1;
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// Makes the frame's times readable, once `encoder` has run.
    pub(super) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2 * self.used, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.read, 0, u64::from(2 * self.used) * BYTES);
    }

    /// Asks for the times; they are there after the next wait for the device.
    pub(super) fn ask(&self) {
        self.read.map_async(wgpu::MapMode::Read, .., |_| {});
    }

    /// What the frame's fans took, and its picture.
    pub(super) fn times(&self) -> Option<(Duration, Duration)> {
        let bytes = self.read.get_mapped_range(..u64::from(2 * self.used) * BYTES).ok()?;
        let (ticks, _) = bytes.as_chunks::<16>();
        let mut passes: Vec<u64> = Vec::with_capacity(ticks.len());
        for pair in ticks {
            let tick = |half: &[u8]| half.try_into().map(u64::from_le_bytes).unwrap_or_default();
            passes.push(tick(&pair[8..]).saturating_sub(tick(&pair[..8])));
        }
        let time = |ticks: u64| Duration::from_nanos((ticks as f64 * self.nanoseconds_per_tick) as u64);
        let picture = passes.pop().unwrap_or_default();
        let share = f64::from(self.drawn) / passes.len().max(1) as f64;
        drop(bytes);
        self.read.unmap();
        Some((time(passes.iter().sum()).mul_f64(share), time(picture)))
    }
}
