//! A worker: what one thread needs to draw tiles, one after the other.
//!
//! Where the order must be exact, a late fragment is put where it belongs; blocks where that could not be done are drawn again, with
//! all their fragments sorted per pixel.

use std::time::{Duration, Instant};

use super::bins::Bins;
use super::bins::FILLING;
use super::blend::{Blend, Blending, OrderSlack};
use super::budget::Plan;
use super::collect::Collect;
use super::composite::Scratch;
use super::dispatch::Kernels;
use super::kept::Filter;
use super::maximum::Maximum;
use super::portions::{BlockCounts, Portion};
use super::sum::Sum;
use super::tile::{PIXELS, TileFrame, place_of};
use super::tile_source::LentTile;
use crate::backends::{Counts, Frame};
use crate::optics::{LANES, Optics};
use crate::profile::anonymous_bytes;
use crate::stages::footprints::hexahedra::TRIANGLES;
use crate::stages::sort::radix::{Pair, sort_local_while};

/// Slack of the order check in inverse depth, relative (perspective) or in scene units (parallel rays): some ulp, where
/// neighbouring cells of 10^8 differ by 1e-3.
const ORDER_SLACK: f32 = 2e-6;

/// What is the same for all tiles of a frame.
pub(super) struct TileTask<'a, O> {
    pub(super) frame: &'a Frame<'a>,
    pub(super) optics: &'a O,
    pub(super) bins: &'a Bins,
    pub(super) kernels: Kernels,
    /// How a memory budget is shared, where there is one.
    pub(super) plan: Option<&'a Plan>,
    /// Whether tiles' orders are those of the frame before, and which of their cells show.
    pub(super) is_kept: bool,
    pub(super) filter: Filter<'a>,
}

/// What drawing tiles counted and took.
#[derive(Clone, Copy, Default)]
pub(super) struct Drawn {
    pub(super) counts: Counts,
    pub(super) sort_secs: f64,
    pub(super) draw_secs: f64,
    /// Fragments of a block that were more than the plan has room for; then what was drawn is of no use.
    pub(super) fragments_lacking: usize,
    /// The most memory that was seen while drawing.
    pub(super) anonymous_bytes: Option<u64>,
}

impl Drawn {
    pub(super) fn sum(mut self, other: Self) -> Self {
        self.counts += other.counts;
        self.sort_secs += other.sort_secs;
        self.draw_secs += other.draw_secs;
        self.fragments_lacking = self.fragments_lacking.max(other.fragments_lacking);
        self.anonymous_bytes = self.anonymous_bytes.max(other.anonymous_bytes);
        self
    }
}

/// How often a worker looks at the memory; a look takes some ten microseconds.
const LOOK: Duration = Duration::from_millis(20);

/// One thread's memory.
pub(super) struct Worker {
    pixels: Box<[[f32; 4]; PIXELS]>,
    order: Vec<Pair>,
    scratch: Vec<Pair>,
    blend: Blend,
    collect: Collect,
    sum: Sum,
    maximum: Maximum,
    composite: Scratch,
}

impl Default for Worker {
    fn default() -> Self {
        Self {
            pixels: Box::new([[0.0; 4]; PIXELS]),
            order: Vec::new(),
            scratch: Vec::new(),
            blend: Blend::default(),
            collect: Collect::default(),
            sum: Sum::default(),
            maximum: Maximum::default(),
            composite: Scratch::default(),
        }
    }
}

impl Worker {
    /// Draws tiles until there is none left.
    pub(super) fn draw<'p, O: Optics>(
        &mut self,
        task: &TileTask<O>,
        mut next: impl FnMut() -> Option<LentTile<'p>>,
    ) -> Drawn {
        if let Some(plan) = task.plan {
            // At once as much as any tile takes: lists that grow are held twice for a moment.
            self.order.reserve_exact(plan.tile_pairs);
            self.scratch.reserve_exact(plan.tile_pairs);
        }
        let mut drawn = Drawn::default();
        let mut looked = Instant::now();
        let control = task.frame.control;
        while let Some(LentTile { tile, first, rows, kept }) = next().filter(|_| !control.is_cancelled()) {
            drawn = drawn.sum(self.draw_tile(task, tile, kept));
            for (y, row) in rows.into_iter().enumerate() {
                for (x, pixel) in row.iter_mut().enumerate() {
                    *pixel = self.pixels[place_of(first[0] + x, first[1] + y)];
                }
            }
            control.tell(FILLING + (1.0 - FILLING) * (tile as f64 / task.bins.grid.len() as f64));
            if looked.elapsed() > LOOK {
                looked = Instant::now();
                drawn.anonymous_bytes = drawn.anonymous_bytes.max(anonymous_bytes());
            }
        }
        drawn
    }

    /// Draws `tile` into the worker's pixels, block by block, lane by lane.
    fn draw_tile<O: Optics>(&mut self, task: &TileTask<O>, tile: usize, kept: Option<&mut Vec<u32>>) -> Drawn {
        let start = Instant::now();
        let _span = tracing::trace_span!("tile", tile).entered();
        let mut drawn = Drawn::default();
        let out = &mut *self.pixels;
        let control = task.frame.control;
        match kept {
            Some(cells) if task.is_kept => task.filter.sift(control, cells, &mut self.order),
            kept => {
                task.bins.pairs_of(control, tile, (&mut self.order, &mut self.scratch));
                if !task.frame.keys.are_none() && !self.order.is_empty() {
                    let _span = tracing::trace_span!("sort").entered();
                    sort_local_while(control, &mut self.order, &mut self.scratch);
                }
                if let Some(cells) = kept {
                    task.filter.keep(control, &mut self.order, cells);
                }
            }
        }
        if self.order.is_empty() {
            out.fill(task.optics.pixel(O::CLEAR));
            return drawn;
        }
        let sorted = Instant::now();

        let _span = tracing::trace_span!("composite").entered();
        let frame = TileFrame::new(task.frame, task.bins.grid.origin_px(tile));
        if O::IS_SUM {
            let Self { order, composite, sum, .. } = self;
            sum.reset();
            task.kernels.composite(&frame, task.optics, order, composite, sum);
            for (pixel, contribution) in out.iter_mut().zip(sum.contributions()) {
                *pixel = task.optics.pixel(contribution);
            }
        } else if O::IS_MAXIMUM {
            let Self { order, composite, maximum, .. } = self;
            maximum.reset();
            task.kernels.composite(&frame, task.optics, order, composite, maximum);
            for (pixel, contribution) in out.iter_mut().zip(maximum.contributions()) {
                *pixel = task.optics.pixel(contribution);
            }
        } else {
            let late_blocks = self.blend(task, &frame, &mut drawn.counts);
            if task.frame.is_exact && late_blocks != 0 {
                drawn.fragments_lacking = self.draw_again(task, &frame, late_blocks);
                drawn.counts.tiles_redone = 1;
            }
        }
        drawn.sort_secs = (sorted - start).as_secs_f64();
        drawn.draw_secs = sorted.elapsed().as_secs_f64();
        drawn
    }

    /// Draws `blocks` with all their fragments sorted per pixel; where those of one block are more than the plan has room for,
    /// nothing is drawn and their number returned.
    fn draw_again<O: Optics>(&mut self, task: &TileTask<O>, frame: &TileFrame, blocks: u64) -> usize {
        let _span = tracing::trace_span!("draw_again").entered();
        let Self { order, composite, collect, pixels, .. } = self;
        let mut draw = |portion: u64| -> BlockCounts {
            let mut sink = Portion::new(blocks, portion, collect);
            task.kernels.composite(frame, task.optics, order, composite, &mut sink);
            let counts = sink.into_counts();
            collect.composite(task.frame.control, task.optics, pixels);
            counts
        };
        // A tetrahedron has at most one fragment a pixel, other cells one for two of their triangles.
        let dataset = task.frame.dataset;
        let of_hexahedra = if dataset.hexahedra.is_empty() { 2 } else { TRIANGLES };
        let parts = of_hexahedra.max(dataset.polyhedra.most().triangles) / 2;
        let most = order.len().saturating_mul(parts * LANES * blocks.count_ones() as usize);
        let limit = task.plan.map_or(usize::MAX, |plan| plan.fragments);
        if most <= limit {
            draw(blocks);
            return 0;
        }
        let count = draw(0);
        if count.largest() > limit {
            return count.largest();
        }
        for portion in count.portions(limit) {
            draw(portion);
        }
        0
    }

    /// Draws the tile; one bit for each block in which a fragment came too late.
    fn blend<O: Optics>(&mut self, task: &TileTask<O>, frame: &TileFrame, counts: &mut Counts) -> u64 {
        let Self { order, composite, blend, pixels, .. } = self;
        let absolute = if task.frame.view.is_perspective { 0.0 } else { ORDER_SLACK };
        blend.reset::<O>(Blending {
            is_exact: O::IS_ORDERED && task.frame.is_exact,
            stop_transmittance: task.frame.stop_transmittance,
            slack: OrderSlack { relative: ORDER_SLACK, absolute },
        });
        task.kernels.composite(frame, task.optics, order, composite, blend);
        for (pixel, contribution) in pixels.iter_mut().zip(blend.contributions()) {
            *pixel = task.optics.pixel(contribution);
        }
        counts.violations += blend.violations();
        blend.late_blocks()
    }
}
