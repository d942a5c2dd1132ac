//! `Submitter`: what the thread does that hands slots to the GPU.
//!
//! In: filled slots, in draw order. Out: their fans drawn. A submission may block until the one before has been drawn, as on
//! software Vulkan: so it has a thread of its own, and fans are made meanwhile.

use std::collections::VecDeque;
use std::ops::Range;
use std::time::{Duration, Instant};

use crossbeam_channel::Receiver;

use super::Gpu;
use super::accumulate::Targets;
use super::late::LateTiles;
use super::pipelines::{Draw, Pipelines};
use super::staging::Ring;
use super::timestamps::Timestamps;
use crate::error::Result;

/// A slot that was written.
pub(super) struct Filled {
    pub(super) slot: usize,
    /// How many fans it has.
    pub(super) fans: usize,
    /// Those in which there are records.
    pub(super) records: Vec<Range<usize>>,
}

/// Submits slots in the order in which they come.
pub(super) struct Submitter<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) pipelines: &'a Pipelines,
    pub(super) targets: &'a Targets,
    pub(super) ring: &'a Ring,
    pub(super) timestamps: Option<&'a mut Timestamps>,
    pub(super) draw: Draw,
    /// What checks the order, where it is checked.
    pub(super) late: Option<&'a LateTiles>,
    /// Opaque geometry, where it ends rays.
    pub(super) opaque: Option<&'a wgpu::BindGroup>,
}

impl Submitter<'_> {
    /// Draws all slots; how long submissions took.
    pub(super) fn run(mut self, filled: &Receiver<Filled>) -> Result<Duration> {
        let result = self.draw_all(filled);
        if result.is_err() {
            self.ring.give_up();
        }
        result
    }

    fn draw_all(&mut self, filled: &Receiver<Filled>) -> Result<Duration> {
        let mut submitting = Duration::ZERO;
        let mut in_flight = VecDeque::new();
        let mut is_first = true;
        for Filled { slot, fans, records } in filled {
            let start = Instant::now();
            let _span = tracing::trace_span!("submit", fans).entered();
            let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.ring.hand_over(slot, fans, &mut encoder);
            let timestamps = self.timestamps.as_deref_mut().and_then(Timestamps::of_fans);
            self.pipelines.draw(
                self.ring.binding(slot),
                (&records, self.draw),
                (is_first, self.late, self.opaque),
                &self.targets.accumulated,
                timestamps,
                &mut encoder,
            );
            is_first = false;
            in_flight.push_back(self.gpu.queue.submit([encoder.finish()]));
            self.ring.free_when_drawn(slot);
            submitting += start.elapsed();
            // A slot becomes free when somebody polls. The last free one was just drawn: wait for the first.
            let wait = if in_flight.len() >= Ring::SLOTS {
                wgpu::PollType::Wait { submission_index: in_flight.pop_front(), timeout: None }
            } else {
                wgpu::PollType::Poll
            };
            self.gpu.device.poll(wait).map_err(|_| self.gpu.failed("does not answer"))?;
            self.gpu.check()?;
        }
        if is_first {
            let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.pipelines.clear(&self.targets.accumulated, &mut encoder);
            self.gpu.queue.submit([encoder.finish()]);
        }
        Ok(submitting)
    }
}
