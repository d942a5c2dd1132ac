//! `Timestamps`: what each pass takes on the GPU, where it has clocks.

use std::time::Duration;

use wgpu::{BufferUsages, Features};

use super::Gpu;
use crate::profile::{GPU_PASS, clock_ns};

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
    /// When each timed pass was prepared, on the process's clock: none begins earlier.
    prepared_ns: Vec<u64>,
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
            prepared_ns: Vec::new(),
        })
    }

    /// Begins a frame.
    pub(super) fn begin(&mut self) {
        (self.used, self.drawn) = (0, 0);
        self.prepared_ns.clear();
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
        self.prepared_ns.push(clock_ns());
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

    /// What the frame's fans took, and its picture; each pass is told to whoever traces.
    pub(super) fn times(&self) -> Option<(Duration, Duration)> {
        let bytes = self.read.get_mapped_range(..u64::from(2 * self.used) * BYTES).ok()?;
        let (ticks, _) = bytes.as_chunks::<16>();
        let ns = |half: &[u8]| {
            let ticks = half.try_into().map(u64::from_le_bytes).unwrap_or_default();
            (ticks as f64 * self.nanoseconds_per_tick) as u64
        };
        let mut passes: Vec<[u64; 2]> = ticks.iter().map(|pair| [ns(&pair[..8]), ns(&pair[8..])]).collect();
        drop(bytes);
        self.read.unmap();
        self.trace(&passes);
        let time = |[begin, end]: [u64; 2]| end.saturating_sub(begin);
        let picture = passes.pop().map_or(0, time);
        let share = f64::from(self.drawn) / passes.len().max(1) as f64;
        let fans = passes.into_iter().map(time).sum();
        Some((Duration::from_nanos(fans).mul_f64(share), Duration::from_nanos(picture)))
    }

    /// Tells the begin and end of each pass on the process's clock. The GPU's clock has another zero: passes are moved together,
    /// as early as keeps each behind its preparation. They may have run later, if the GPU never had nothing to wait for.
    fn trace(&self, passes: &[[u64; 2]]) {
        if !tracing::event_enabled!(target: GPU_PASS, tracing::Level::TRACE) {
            return;
        }
        let Some(shift_ns) = earliest_shift_ns(passes, &self.prepared_ns) else { return };
        let here = |ns: u64| u64::try_from(i128::from(ns) + shift_ns).unwrap_or_default();
        for (i, &[begin, end]) in passes.iter().enumerate() {
            let name = if i + 1 == passes.len() { "gpu_resolve" } else { "gpu_draw" };
            tracing::trace!(target: GPU_PASS, name, begin_ns = here(begin), end_ns = here(end.max(begin)));
        }
    }
}

/// What to add to the GPU's clock so that no pass begins before it was prepared, and one as it was.
fn earliest_shift_ns(passes: &[[u64; 2]], prepared_ns: &[u64]) -> Option<i128> {
    passes.iter().zip(prepared_ns).map(|(&[begin, _], &prepared)| i128::from(prepared) - i128::from(begin)).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_moved_behind_their_preparation() {
        // The second pass waited for the first, the third was prepared late.
        let (passes, prepared) = ([[1000, 1500], [1500, 1600], [2000, 2100]], [50, 60, 1090]);
        let shift = earliest_shift_ns(&passes, &prepared).unwrap();
        assert_eq!(shift, -910);
        assert!(
            passes
                .iter()
                .zip(prepared)
                .all(|(&[begin, _], prepared)| i128::from(begin) + shift >= i128::from(prepared))
        );
        assert_eq!(earliest_shift_ns(&[], &[]), None);
    }
}
