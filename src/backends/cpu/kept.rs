//! `Kept`: the cells of each tile in order, for a frame that sees the same cells from the same place.
//!
//! In: the bins of a frame, the tiles' cells once they are sorted. Out: the same for the next frame, where shape, view and key are the
//! same and only scalars or colours have changed: no box, no key, no sort. Which cells show is found anew, and the others are passed
//! over. Where cells that did not show were left out of what is kept, the next such frame puts them in, once. 4 bytes a pair.

use std::sync::Arc;

use rayon::prelude::*;

use super::bins::Bins;
use super::block::Projector;
use crate::backends::{Counts, Frame};
use crate::columns::Dataset;
use crate::control::Control;
use crate::stages::View;
use crate::stages::cull;
use crate::stages::sort::SortKey;
use crate::stages::sort::radix::{Pair, index_of, pair};

/// Words of the bits of a block.
const WORDS: usize = Dataset::BLOCK_CELLS / 64;

/// Cells of a tile that are looked at between two looks at the token.
const LOOK: usize = 1 << 15;

/// How a frame comes to its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// Bins, of the cells that show, which are sorted.
    Bins,
    /// The same of all cells, so that any may show in the next frame.
    WholeBins,
    /// The last frame's.
    Kept,
}

/// What an order is of.
struct Seen {
    shape: Arc<()>,
    view: View,
    key: SortKey,
}

/// The order of a frame, tile by tile.
#[derive(Default)]
pub(super) struct Kept {
    seen: Option<Seen>,
    /// Whether all cells that touch a tile are there, and not only those that showed.
    is_whole: bool,
    pub(super) tiles: Vec<Vec<u32>>,
    /// A bit for each cell that touches a tile, block by block; for each of these that shows.
    projected: Vec<u64>,
    shown: Vec<u64>,
    /// Whether all of them show.
    all_show: bool,
    tets: usize,
}

impl Kept {
    /// Where the order of `frame` comes from; until [`Kept::end`] nothing is kept.
    pub(super) fn begin(&mut self, frame: &Frame) -> Source {
        let Some(still) = &frame.still else { return Source::Bins };
        self.tets = frame.dataset.tets.len();
        let is_kept = self.seen.take().is_some_and(|seen| {
            Arc::ptr_eq(&seen.shape, still.shape) && seen.view == *frame.view && seen.key == frame.keys.key()
        });
        match is_kept {
            true if self.is_whole => Source::Kept,
            is_kept if is_kept || still.is_live => Source::WholeBins,
            _ => Source::Bins,
        }
    }

    /// Takes over which cells the bins, filled from `source`, hold.
    pub(super) fn take(&mut self, bins: &Bins, source: Source, counts: &Counts) {
        self.is_whole = source == Source::WholeBins || counts.culled_transparent + counts.invalid == 0;
        self.all_show = true;
        self.projected.clear();
        self.projected.extend(bins.chunks.iter().flat_map(|chunk| &chunk.projected));
        self.tiles.resize_with(bins.grid.len(), Vec::new);
    }

    /// Finds the cells that show, as bins would; what became of all.
    pub(super) fn show(&mut self, projector: &Projector) -> Counts {
        let Self { projected, shown, .. } = self;
        let frame = projector.frame;
        shown.clear();
        shown.resize(projected.len(), 0);
        let of_block = |visible: &mut Vec<u32>, (number, shown): (usize, &mut [u64])| {
            let mut counts = Counts::default();
            if frame.control.is_cancelled() || projector.rows(number, &mut counts).is_none() {
                return counts;
            }
            let _span = tracing::trace_span!("cull", block = number).entered();
            let block = frame.dataset.block(number);
            visible.clear();
            let optics = (frame.intervals(), frame.cull_table);
            let culled = cull::cull(&block, frame.field, projector.screen, optics, visible);
            for &cell in visible.iter() {
                shown[cell as usize / 64] |= 1 << (cell % 64);
            }
            for (shown, projected) in shown.iter_mut().zip(&projected[number * WORDS..]) {
                *shown &= projected;
            }
            let drawn = ones(shown);
            let culled_outside = visible.len() as u64 - drawn;
            let (culled_transparent, invalid) = (culled.transparent, culled.invalid);
            Counts { drawn, culled_transparent, culled_outside, invalid, ..counts }
        };
        let of_blocks = shown.par_chunks_mut(WORDS).enumerate().map_init(Vec::new, of_block);
        let counts = of_blocks.reduce(Counts::default, |mut a, b| {
            a += b;
            a
        });
        self.all_show = counts.drawn == ones(&self.projected);
        counts
    }

    /// The frame was drawn.
    pub(super) fn end(&mut self, frame: &Frame) {
        self.seen = frame.still.as_ref().map(|still| Seen {
            shape: Arc::clone(still.shape),
            view: *frame.view,
            key: frame.keys.key(),
        });
    }

    /// What passes over cells that do not show.
    pub(super) fn filter(&self) -> Filter<'_> {
        Filter { shown: (!self.all_show).then_some(&self.shown[..]), tets: self.tets }
    }
}

fn ones(words: &[u64]) -> u64 {
    words.iter().map(|word| u64::from(word.count_ones())).sum()
}

/// The words of a block with a bit for each of `cells`.
pub(super) fn bits_of(cells: &[u32]) -> [u64; WORDS] {
    let mut words = [0; WORDS];
    for &cell in cells {
        words[cell as usize / 64] |= 1 << (cell % 64);
    }
    words
}

/// The cells that show.
#[derive(Clone, Copy)]
pub(super) struct Filter<'a> {
    /// None where all do.
    shown: Option<&'a [u64]>,
    tets: usize,
}

impl Filter<'_> {
    /// Takes over those of `cells` that show, in their order, until the end is asked for.
    pub(super) fn sift(self, control: &Control, cells: &[u32], order: &mut Vec<Pair>) {
        order.clear();
        let Some(shown) = self.shown else {
            order.extend(cells.iter().map(|&cell| pair(0, cell)));
            return;
        };
        // Blocks are of one kind: the first of hexahedra does not fill up the last of tetrahedra.
        let first_hexahedron = self.tets.next_multiple_of(Dataset::BLOCK_CELLS);
        let bit_of = |cell: usize| cell.checked_sub(self.tets).map_or(cell, |hexahedron| first_hexahedron + hexahedron);
        let shows = |&&cell: &&u32| {
            let bit = bit_of(cell as usize);
            shown[bit / 64] >> (bit % 64) & 1 == 1
        };
        for cells in cells.chunks(LOOK).take_while(|_| !control.is_cancelled()) {
            order.extend(cells.iter().filter(shows).map(|&cell| pair(0, cell)));
        }
    }

    /// Keeps `order` in `cells`, and passes over what does not show.
    pub(super) fn keep(self, control: &Control, order: &mut Vec<Pair>, cells: &mut Vec<u32>) {
        cells.clear();
        cells.extend(order.iter().map(|&pair| index_of(pair)));
        if self.shown.is_some() {
            self.sift(control, cells, order);
        }
    }
}
