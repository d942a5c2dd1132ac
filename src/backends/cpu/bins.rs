//! Bins: which cells each tile draws.
//!
//! In: blocks of cells. Out: per tile, (key, cell) pairs in memory order; cells that span many tiles are listed once, aside.
//! Count, scan, write: chunks of blocks run `cull`, `footprints` and `sort` in parallel and count their pairs per tile, a
//! prefix sum over (tile, chunk) gives each its places, a second pass writes them. Under a memory budget the same bins are
//! filled for a few rows of tiles at a time, by `bands`.

use std::ops::Range;
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::block::{BlockCells, Projector};
pub(super) use super::grid::TILE;
use super::grid::{SmallTileBox, TileBox, TileGrid};
use super::kept::bits_of;
use crate::backends::Counts;
use crate::control::Control;
use crate::stages::scatter::as_atomic;
use crate::stages::sort::radix::{Pair, sort_indices_while};

/// A cell on more tiles than this is listed once instead of once a tile; chosen: few cells are so large.
pub(super) const MANY_TILES: usize = SmallTileBox::MAX_TILES;
/// Chunks of blocks; enough for work stealing, few enough for the counts of all tiles.
const CHUNKS: usize = 64;
/// Cells that are put into tiles between two looks at whether the frame is still wanted.
const SCATTER: usize = 1 << 14;
/// Share of a frame that filling the bins is said to be.
pub(super) const FILLING: f64 = 0.2;

/// A cell on many tiles.
#[derive(Clone, Copy, Debug)]
pub(super) struct LargeCell {
    pub(super) pair: Pair,
    pub(super) tiles: TileBox,
}

/// One chunk's scratch, kept between frames.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    /// Cells in memory order, and the tiles of each.
    binned: Vec<Pair>,
    tiles_from_binned: Vec<SmallTileBox>,
    pub(super) large: Vec<LargeCell>,
    /// Pairs per tile, then where the chunk's next pair goes among those of the tile.
    places: Vec<u32>,
    pub(super) filled: Filled,
    /// Where the order is kept: a bit for each cell that touches a tile, block by block.
    pub(super) projected: Vec<u64>,
    /// For a census: how many large cells, and the rows of tiles that each block touches.
    pub(super) large_cells: u64,
    pub(super) rows_from_block: Vec<Range<u32>>,
}

/// The cells of every tile of some rows of tiles.
#[derive(Debug, Default)]
pub(super) struct Bins {
    pub(super) grid: TileGrid,
    /// The rows of tiles that are filled.
    pub(super) rows: Range<u32>,
    /// Those of all tiles, in memory that is as long as they ever were.
    pub(super) pairs: Vec<Pair>,
    /// Where each tile's pairs begin, and where the last one's end.
    pub(super) starts: Vec<usize>,
    pub(super) large: Vec<LargeCell>,
    /// Whether no key orders the cells: those of a tile are drawn as they stand in memory.
    pub(super) has_no_keys: bool,
    /// Whether the pairs of a tile stand in any order.
    pub(super) is_shuffled: bool,
    pub(super) chunks: Vec<Chunk>,
    /// One per thread that ever filled at once.
    blocks: Mutex<Vec<BlockCells>>,
}

/// What filling the bins found and took, in seconds of one thread: cull, footprints, sort keys.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Filled {
    pub(super) counts: Counts,
    pub(super) stage_secs: [f64; 3],
}

impl Bins {
    /// Fills the bins of the whole picture.
    pub(super) fn fill(&mut self, projector: &Projector) -> Filled {
        let grid = &TileGrid::new(projector.frame.view);
        (self.grid, self.rows, self.is_shuffled) = (grid.clone(), grid.rows.clone(), false);
        self.has_no_keys = projector.frame.keys.are_none();
        self.for_each_chunk(projector, |chunk, cells, blocks| {
            chunk.places.clear();
            chunk.places.resize(grid.len(), 0);
            for block in blocks {
                if projector.is_cancelled() {
                    return;
                }
                chunk.add_block(projector, cells, grid, block);
            }
        });
        if projector.is_cancelled() {
            return Filled::default();
        }
        self.scan();
        let (out, starts) = (as_atomic(&mut self.pairs), &self.starts);
        self.chunks.par_iter_mut().for_each(|chunk| {
            let _span = tracing::trace_span!("scatter").entered();
            let Chunk { binned, tiles_from_binned, places, .. } = chunk;
            for (pairs, tiles) in binned.chunks(SCATTER).zip(tiles_from_binned.chunks(SCATTER)) {
                if projector.is_cancelled() {
                    return;
                }
                for (&pair, tiles) in pairs.iter().zip(tiles) {
                    for tile in tiles.get().tiles(grid) {
                        let place = &mut places[tile];
                        out[starts[tile] + *place as usize].store(pair, Ordering::Relaxed);
                        *place += 1;
                    }
                }
            }
        });
        self.gather()
    }

    /// Empties the chunks and runs `work` on each with its range of blocks, in parallel.
    pub(super) fn for_each_chunk(
        &mut self,
        projector: &Projector,
        work: impl Fn(&mut Chunk, &mut BlockCells, Range<usize>) + Sync,
    ) {
        let blocks = projector.frame.dataset.blocks.len();
        let per_chunk = blocks.div_ceil(CHUNKS).max(1);
        self.chunks.resize_with(blocks.div_ceil(per_chunk), Chunk::default);
        self.chunks.par_iter_mut().enumerate().for_each(|(i, chunk)| {
            let _span = tracing::trace_span!("chunk", chunk = i).entered();
            chunk.reset();
            let mut cells = lock(&self.blocks).pop().unwrap_or_default();
            work(chunk, &mut cells, i * per_chunk..((i + 1) * per_chunk).min(blocks));
            chunk.filled.stage_secs = std::mem::take(&mut cells.stage_secs);
            projector.frame.control.tell(FILLING * i as f64 / CHUNKS as f64);
            lock(&self.blocks).push(cells);
        });
    }

    /// Turns counts per chunk and tile into places.
    fn scan(&mut self) {
        self.starts.clear();
        let mut next = 0;
        for tile in 0..self.grid.len() {
            self.starts.push(next);
            let mut of_tile = 0;
            for chunk in &mut self.chunks {
                of_tile += std::mem::replace(&mut chunk.places[tile], of_tile);
            }
            next += of_tile as usize;
        }
        self.starts.push(next);
        self.make_room(next);
    }

    /// Room for so many pairs. What stood there is written over.
    pub(super) fn make_room(&mut self, pairs: usize) {
        if self.pairs.len() < pairs {
            // What it held is not copied: it goes before memory is asked for that the system clears when it is first written to, by the
            // threads that write.
            self.pairs = Vec::new();
            self.pairs = vec![0; pairs];
        }
    }

    /// How many pairs all tiles have.
    pub(super) fn pairs(&self) -> u64 {
        self.starts.last().map_or(0, |&end| end as u64)
    }

    /// Sums up what the chunks found.
    pub(super) fn gather(&mut self) -> Filled {
        self.large.clear();
        let mut filled = Filled::default();
        for chunk in &self.chunks {
            self.large.extend_from_slice(&chunk.large);
            filled.counts += chunk.filled.counts;
            for (sum, secs) in filled.stage_secs.iter_mut().zip(chunk.filled.stage_secs) {
                *sum += secs;
            }
        }
        filled
    }

    /// Copies the pairs of `tile`, one of the rows that are filled, to `order`, in memory order of the cells.
    #[expect(
        clippy::stable_sort_primitive,
        reason = "it merges two runs that are in order, and does not sort them anew"
    )]
    pub(super) fn pairs_of(&self, control: &Control, tile: usize, (order, scratch): (&mut Vec<Pair>, &mut Vec<Pair>)) {
        let place = tile - self.grid.tiles(&self.rows).start;
        let pairs = &self.pairs[self.starts[place]..self.starts[place + 1]];
        let [column, row] = self.grid.place(tile);
        order.clear();
        order.extend_from_slice(pairs);
        order.extend(self.large.iter().filter(|cell| cell.tiles.touches(column, row)).map(|cell| cell.pair));
        // Without keys the order is that of memory. Which cells are listed aside depends on the region: they go where they belong,
        // by a merge of two runs.
        if self.has_no_keys && self.is_shuffled {
            sort_indices_while(control, order, scratch);
        } else if self.has_no_keys && order.len() > pairs.len() {
            order.sort();
        }
    }
}

/// A poisoned lock means that a thread panicked; what it took never came back, the rest is whole.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Chunk {
    fn reset(&mut self) {
        self.binned.clear();
        self.tiles_from_binned.clear();
        self.large.clear();
        self.large_cells = 0;
        self.rows_from_block.clear();
        self.filled = Filled::default();
        self.projected.clear();
    }

    fn add_block(&mut self, projector: &Projector, cells: &mut BlockCells, grid: &TileGrid, block: usize) {
        let is_seen = projector.rows(block, &mut self.filled.counts).is_some();
        let Self { binned, tiles_from_binned, large, places, filled, projected, .. } = self;
        let block = projector.frame.dataset.block(block);
        if is_seen {
            filled.counts += cells.project(projector, &block);
        }
        if projector.frame.still.is_some() {
            projected.extend(bits_of(if is_seen { cells.projected() } else { &[] }));
        }
        if !is_seen {
            return;
        }
        cells.for_each(&block, |pair, tiles| {
            if tiles.len() > MANY_TILES {
                large.push(LargeCell { pair, tiles });
                return;
            }
            binned.push(pair);
            tiles_from_binned.push(SmallTileBox::new(tiles));
            for tile in tiles.tiles(grid) {
                places[tile] += 1;
            }
        });
    }
}
