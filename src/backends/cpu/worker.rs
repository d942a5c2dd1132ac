//! A worker: what one thread needs to draw tiles, one after the other.
//!
//! Where the order must be exact, a tile is drawn once with fragments held back; blocks in which a fragment still came after
//! one behind it are drawn again, with all their fragments sorted per pixel.

use std::time::Instant;

use super::bins::{Bins, TileGrid};
use super::dispatch::Kernels;
use super::hits::Hits;
use super::sink::{Blend, Collect, OrderSlack};
use super::tile::{PIXELS, TileFrame};
use crate::backends::{Counts, Frame};
use crate::optics::Optics;
use crate::stages::sort::SortKey;
use crate::stages::sort::radix::{Pair, sort_local};

/// Fragments that each pixel holds back where the order must be exact and the key is `power`, which gets next to nothing
/// wrong on the meshes it is chosen for.
const HELD_BY_POWER: usize = 2;

/// The same for other keys. Of 1.36 million cells of a grid jittered by a quarter (1024², sorted by centroids), holding 2, 3, 4
/// left 13,381, 1,625 and 138 fragments out of order; a block out of order is drawn twice.
const HELD: usize = 4;

/// Slack of the order check in inverse depth, relative (perspective) or in scene units (parallel rays): some ulp, where
/// neighbouring cells of 10^8 differ by 1e-3.
const ORDER_SLACK: f32 = 2e-6;

/// What is the same for all tiles of a frame.
pub(super) struct TileTask<'a, O> {
    pub(super) frame: &'a Frame<'a>,
    pub(super) optics: &'a O,
    pub(super) bins: &'a Bins,
    pub(super) grid: TileGrid,
    pub(super) kernels: Kernels,
    pub(super) is_sorted: bool,
}

/// What drawing tiles counted and took.
#[derive(Clone, Copy, Default)]
pub(super) struct Drawn {
    pub(super) counts: Counts,
    pub(super) sort_secs: f64,
    pub(super) draw_secs: f64,
}

impl Drawn {
    pub(super) fn sum(mut self, other: Self) -> Self {
        self.counts += other.counts;
        self.sort_secs += other.sort_secs;
        self.draw_secs += other.draw_secs;
        self
    }
}

/// One thread's memory.
#[derive(Default)]
pub(super) struct Worker {
    order: Vec<Pair>,
    scratch: Vec<Pair>,
    blend: Blend<0>,
    holding_by_power: Blend<HELD_BY_POWER>,
    holding: Blend<HELD>,
    collect: Collect,
    hits: Hits,
}

impl Worker {
    /// Draws `tile` into `out`, block by block, lane by lane.
    pub(super) fn draw<O: Optics>(&mut self, task: &TileTask<O>, tile: usize, out: &mut [[f32; 4]; PIXELS]) -> Drawn {
        let start = Instant::now();
        let mut drawn = Drawn::default();
        task.bins.pairs_of(task.grid, tile, &mut self.order);
        if self.order.is_empty() {
            out.fill(task.optics.pixel(O::CLEAR));
            return drawn;
        }
        if task.is_sorted {
            sort_local(&mut self.order, &mut self.scratch);
        }
        let sorted = Instant::now();

        let frame = TileFrame::new(task.frame, task.grid.origin_px(tile));
        if O::IS_ORDERED && task.frame.is_exact {
            let late_blocks = if task.frame.sort_key == SortKey::Power {
                blend(task, &frame, (&self.order, &mut self.hits), &mut self.holding_by_power, &mut drawn.counts, out)
            } else {
                blend(task, &frame, (&self.order, &mut self.hits), &mut self.holding, &mut drawn.counts, out)
            };
            if late_blocks != 0 {
                self.collect.reset(late_blocks);
                task.kernels.composite(&frame, task.optics, &self.order, &mut self.hits, &mut self.collect);
                self.collect.composite(task.optics, out);
                drawn.counts.tiles_redone = 1;
            }
        } else {
            blend(task, &frame, (&self.order, &mut self.hits), &mut self.blend, &mut drawn.counts, out);
        }
        drawn.sort_secs = (sorted - start).as_secs_f64();
        drawn.draw_secs = sorted.elapsed().as_secs_f64();
        drawn
    }
}

/// Blends the tile; one bit for each block in which a fragment came too late.
fn blend<O: Optics, const HELD: usize>(
    task: &TileTask<O>,
    frame: &TileFrame,
    (order, hits): (&[Pair], &mut Hits),
    sink: &mut Blend<HELD>,
    counts: &mut Counts,
    out: &mut [[f32; 4]; PIXELS],
) -> u64 {
    let absolute = if task.frame.view.is_perspective { 0.0 } else { ORDER_SLACK };
    sink.reset::<O>(task.frame.stop_transmittance, OrderSlack { relative: ORDER_SLACK, absolute });
    task.kernels.composite(frame, task.optics, order, hits, sink);
    sink.finish::<O>();
    for (pixel, contribution) in out.iter_mut().zip(sink.contributions()) {
        *pixel = task.optics.pixel(contribution);
    }
    counts.violations += sink.violations();
    sink.late_blocks()
}
