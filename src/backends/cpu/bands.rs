//! Bands: the bins of a few rows of tiles at a time, within a memory budget.
//!
//! In: blocks of cells. Out: a [`Census`] of the pairs of each tile; then, band by band, the same bins as those of the whole
//! picture. The census runs `cull` and `footprints` and keeps nothing of a cell, so that it is known what a band takes before
//! its memory is asked for. A band then looks at the blocks that touch it and writes each pair where the next of its tile goes.
//! Which thread comes first is left to chance: tiles order their pairs, by key and cell, so that the picture is not.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

use super::bins::{Bins, Filled, LargeCell, MANY_TILES};
use super::block::Projector;
use super::budget::Plan;
use super::grid::TileGrid;
use crate::stages::scatter::as_atomic;

/// What the cells of a picture put into its tiles.
#[derive(Debug)]
pub(super) struct Census {
    grid: TileGrid,
    pairs_from_tile: Vec<u32>,
    /// Rows of tiles that each block touches; none where it does not show.
    rows_from_block: Vec<Range<u32>>,
    /// Cells that are listed aside.
    pub(super) large: u64,
    /// What became of all cells of the frame.
    pub(super) filled: Filled,
}

impl Census {
    /// The pairs of the fullest tile.
    pub(super) fn largest_tile(&self) -> u64 {
        self.pairs_from_tile.iter().copied().max().map_or(0, u64::from)
    }

    /// The pairs of the fullest row of tiles.
    pub(super) fn largest_row(&self) -> u64 {
        self.grid.rows.clone().map(|row| self.pairs_of_row(row)).max().unwrap_or(0)
    }

    fn pairs_of_row(&self, row: u32) -> u64 {
        self.pairs_from_tile[self.grid.tiles(&(row..row + 1))].iter().map(|&n| u64::from(n)).sum()
    }

    /// The band that begins at row `first`: as many rows as the plan has pairs for, one at least.
    pub(super) fn band(&self, first: u32, plan: &Plan) -> Range<u32> {
        let (mut end, mut pairs) = (first, 0);
        while end < self.grid.rows.end {
            pairs += self.pairs_of_row(end);
            if end > first && pairs > plan.pairs {
                break;
            }
            end += 1;
        }
        first..end
    }
}

impl Bins {
    /// Counts the pairs of every tile; writes none.
    pub(super) fn census(&mut self, projector: &Projector) -> Census {
        let grid = TileGrid::new(projector.frame.view);
        let pairs_from_tile: Vec<AtomicU32> = (0..grid.len()).map(|_| AtomicU32::new(0)).collect();
        self.for_each_chunk(projector, |chunk, cells, blocks| {
            for block in blocks {
                if projector.is_cancelled() {
                    return;
                }
                let Some(rows) = projector.rows(block, &mut chunk.filled.counts) else {
                    chunk.rows_from_block.push(0..0);
                    continue;
                };
                chunk.rows_from_block.push(rows);
                chunk.filled.counts += cells.project(projector, &projector.frame.dataset.block(block));
                for tiles in cells.tile_boxes() {
                    if tiles.len() > MANY_TILES {
                        chunk.large_cells += 1;
                        continue;
                    }
                    for tile in tiles.tiles(&grid) {
                        pairs_from_tile[tile].fetch_add(1, Ordering::Relaxed);
                    }
                }
            }
        });
        Census {
            grid,
            pairs_from_tile: pairs_from_tile.into_iter().map(AtomicU32::into_inner).collect(),
            rows_from_block: self.chunks.iter().flat_map(|chunk| chunk.rows_from_block.iter().cloned()).collect(),
            large: self.chunks.iter().map(|chunk| chunk.large_cells).sum(),
            filled: self.gather(),
        }
    }

    /// Fills the bins of some rows of tiles; what it looked at, and the seconds of its stages.
    pub(super) fn fill_band(&mut self, projector: &Projector, census: &Census, rows: Range<u32>) -> Filled {
        let grid = &census.grid;
        let band = grid.tiles(&rows);
        (self.grid, self.rows, self.is_shuffled) = (grid.clone(), rows.clone(), true);
        self.has_no_keys = projector.frame.keys.are_none();
        self.starts.clear();
        let mut next = 0;
        for &pairs in &census.pairs_from_tile[band.clone()] {
            self.starts.push(next);
            next += pairs as usize;
        }
        self.starts.push(next);
        let places: Vec<AtomicUsize> = self.starts.iter().map(|&start| AtomicUsize::new(start)).collect();

        self.make_room(next);
        let mut pairs = std::mem::take(&mut self.pairs);
        let out = as_atomic(&mut pairs);
        self.for_each_chunk(projector, |chunk, cells, blocks| {
            for block in blocks {
                if projector.is_cancelled() {
                    return;
                }
                let touched = &census.rows_from_block[block];
                if touched.start >= rows.end || touched.end <= rows.start {
                    continue;
                }
                let block = projector.frame.dataset.block(block);
                chunk.filled.counts += cells.project(projector, &block);
                cells.keep_rows(&rows);
                let large = &mut chunk.large;
                cells.for_each(&block, |pair, tiles| {
                    if tiles.len() > MANY_TILES {
                        large.push(LargeCell { pair, tiles });
                        return;
                    }
                    for tile in tiles.in_rows(&rows).tiles(grid) {
                        let place = places[tile - band.start].fetch_add(1, Ordering::Relaxed);
                        out[place].store(pair, Ordering::Relaxed);
                    }
                });
            }
        });
        self.pairs = pairs;
        self.gather()
    }

    /// Gives back what bins hold beyond a plan.
    pub(super) fn keep_within(&mut self, plan: &Plan) {
        if self.pairs.capacity() as u64 > plan.pairs {
            self.pairs = Vec::new();
        }
    }
}
