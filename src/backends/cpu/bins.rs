//! Bins: which cells each tile draws.
//!
//! In: blocks of cells. Out: per tile, (key, cell) pairs in memory order; cells that span many tiles are listed once, aside.
//! Count, scan, write: chunks of blocks run `cull`, `footprints` and `sort` in parallel and count their pairs per tile, a
//! prefix sum over (tile, chunk) gives each its places, a second pass writes them.

use std::sync::atomic::Ordering;
use std::time::Instant;

use rayon::prelude::*;

use crate::backends::{Counts, Frame};
use crate::stages::cull::{self, Culled};
use crate::stages::footprints::{PixelBox, PixelBoxes};
use crate::stages::scatter::as_atomic;
use crate::stages::sort::KeyMaker;
use crate::stages::sort::radix::{Pair, pair};
use crate::stages::{ScreenVertex, View};

/// Side of a tile in pixels.
pub(super) const TILE: u32 = 32;
/// A cell on more tiles than this is listed once instead of once a tile; chosen: few cells are so large.
const MANY_TILES: usize = 64;
/// Chunks of blocks; enough for work stealing, few enough for the counts of all tiles.
const CHUNKS: usize = 64;

/// The tiles of a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileGrid {
    pub(super) columns: u32,
    pub(super) rows: u32,
}

impl TileGrid {
    pub(super) fn new(view: &View) -> Self {
        let [columns, rows] = view.size_px.map(|side| side.div_ceil(TILE));
        Self { columns, rows }
    }

    pub(super) fn len(self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Column and row of the tile's first pixel.
    pub(super) fn origin_px(self, tile: usize) -> [u32; 2] {
        [tile as u32 % self.columns * TILE, tile as u32 / self.columns * TILE]
    }
}

/// A cell with its key and the tiles its box touches.
#[derive(Clone, Copy, Debug)]
struct Binned {
    pair: Pair,
    /// Tile columns `x0..x1` and rows `y0..y1`.
    tiles: PixelBox,
}

impl Binned {
    fn tiles(&self, grid: TileGrid) -> impl Iterator<Item = usize> {
        let PixelBox { x0, x1, y0, y1 } = self.tiles;
        (y0..y1).flat_map(move |y| (x0..x1).map(move |x| y as usize * grid.columns as usize + x as usize))
    }

    fn touches(&self, column: u32, row: u32) -> bool {
        let PixelBox { x0, x1, y0, y1 } = self.tiles;
        (u32::from(x0)..u32::from(x1)).contains(&column) && (u32::from(y0)..u32::from(y1)).contains(&row)
    }
}

/// One chunk's scratch, kept between frames.
#[derive(Debug, Default)]
struct Chunk {
    binned: Vec<Binned>,
    large: Vec<Binned>,
    /// Pairs per tile, then where the chunk's next pair of the tile goes.
    places: Vec<u64>,
    counts: Counts,
    stage_secs: [f64; 3],
    cell_from_visible: Vec<u32>,
    cell_from_projected: Vec<u32>,
    key_from_projected: Vec<u32>,
    boxes: Vec<PixelBox>,
}

/// The cells of every tile.
#[derive(Debug, Default)]
pub(super) struct Bins {
    pairs: Vec<Pair>,
    /// Where each tile's pairs begin, and where the last one's end.
    starts: Vec<usize>,
    large: Vec<Binned>,
    chunks: Vec<Chunk>,
}

/// What filling the bins found and took, in seconds of one thread: cull, footprints, sort keys.
pub(super) struct Filled {
    pub(super) counts: Counts,
    pub(super) stage_secs: [f64; 3],
}

impl Bins {
    /// Fills the bins for one frame.
    pub(super) fn fill(&mut self, frame: &Frame, screen: &[ScreenVertex], keys: &KeyMaker) -> Filled {
        let grid = TileGrid::new(frame.view);
        let boxes = PixelBoxes::new(frame.view);
        let blocks = frame.dataset.blocks.len();
        let per_chunk = blocks.div_ceil(CHUNKS).max(1);
        self.chunks.resize_with(blocks.div_ceil(per_chunk), Chunk::default);
        self.chunks.par_iter_mut().enumerate().for_each(|(i, chunk)| {
            chunk.reset(grid);
            for block in i * per_chunk..((i + 1) * per_chunk).min(blocks) {
                chunk.add_block(frame, screen, &boxes, keys, grid, block);
            }
        });

        self.scan(grid);
        let out = as_atomic(&mut self.pairs);
        self.chunks.par_iter_mut().for_each(|chunk| {
            for binned in &chunk.binned {
                for tile in binned.tiles(grid) {
                    let place = &mut chunk.places[tile];
                    out[*place as usize].store(binned.pair, Ordering::Relaxed);
                    *place += 1;
                }
            }
        });

        self.large.clear();
        let mut filled = Filled { counts: Counts::default(), stage_secs: [0.0; 3] };
        for chunk in &self.chunks {
            self.large.extend_from_slice(&chunk.large);
            filled.counts += chunk.counts;
            for (sum, secs) in filled.stage_secs.iter_mut().zip(chunk.stage_secs) {
                *sum += secs;
            }
        }
        filled
    }

    /// Turns counts per chunk and tile into places.
    fn scan(&mut self, grid: TileGrid) {
        self.starts.clear();
        let mut next = 0;
        for tile in 0..grid.len() {
            self.starts.push(next as usize);
            for chunk in &mut self.chunks {
                next += std::mem::replace(&mut chunk.places[tile], next);
            }
        }
        self.starts.push(next as usize);
        self.pairs.resize(next as usize, 0);
    }

    /// Copies the pairs of `tile` to `order`, in memory order of the cells.
    pub(super) fn pairs_of(&self, grid: TileGrid, tile: usize, order: &mut Vec<Pair>) {
        order.clear();
        order.extend_from_slice(&self.pairs[self.starts[tile]..self.starts[tile + 1]]);
        let (column, row) = (tile as u32 % grid.columns, tile as u32 / grid.columns);
        order.extend(self.large.iter().filter(|binned| binned.touches(column, row)).map(|binned| binned.pair));
    }

    /// How many pairs were written.
    pub(super) fn len(&self) -> usize {
        self.pairs.len()
    }
}

impl Chunk {
    fn reset(&mut self, grid: TileGrid) {
        self.binned.clear();
        self.large.clear();
        self.places.clear();
        self.places.resize(grid.len(), 0);
        self.counts = Counts::default();
        self.stage_secs = [0.0; 3];
    }

    fn add_block(
        &mut self,
        frame: &Frame,
        screen: &[ScreenVertex],
        boxes: &PixelBoxes,
        keys: &KeyMaker,
        grid: TileGrid,
        block: usize,
    ) {
        let view = frame.dataset.block(block);
        let cells = view.tets.len() as u64;
        let (low, high) = frame.field.block_ranges[block];
        let has_invalid = frame.field.invalid > 0;
        if !has_invalid && frame.cull_table.is_transparent(frame.pieces, low, high) {
            self.counts.culled_transparent += cells;
            return;
        }
        if !has_invalid && boxes.misses(view.bounds, frame.view) {
            self.counts.culled_outside += cells;
            return;
        }

        let start = Instant::now();
        self.cell_from_visible.clear();
        let Culled { transparent, invalid } =
            cull::cull(&view, frame.field, screen, (frame.pieces, frame.cull_table), &mut self.cell_from_visible);
        self.counts.culled_transparent += transparent;
        self.counts.invalid += invalid;

        let culled = Instant::now();
        self.cell_from_projected.clear();
        self.boxes.clear();
        boxes.of_cells(
            &view,
            frame.vertices,
            screen,
            &self.cell_from_visible,
            &mut self.cell_from_projected,
            &mut self.boxes,
        );
        self.counts.drawn += self.boxes.len() as u64;
        self.counts.culled_outside += (self.cell_from_visible.len() - self.boxes.len()) as u64;

        let projected = Instant::now();
        self.key_from_projected.clear();
        keys.keys(&view, frame.vertices, &self.cell_from_projected, &mut self.key_from_projected);

        let keyed = Instant::now();
        for ((&cell, &key), area) in self.cell_from_projected.iter().zip(&self.key_from_projected).zip(&self.boxes) {
            let tile = TILE as u16;
            let tiles = PixelBox {
                x0: area.x0 / tile,
                x1: area.x1.div_ceil(tile),
                y0: area.y0 / tile,
                y1: area.y1.div_ceil(tile),
            };
            let binned = Binned { pair: pair(key, (view.base + cell as usize) as u32), tiles };
            if (tiles.x1 - tiles.x0) as usize * (tiles.y1 - tiles.y0) as usize > MANY_TILES {
                self.large.push(binned);
            } else {
                self.binned.push(binned);
                for tile in binned.tiles(grid) {
                    self.places[tile] += 1;
                }
            }
        }
        let spans = [culled - start, projected - culled + keyed.elapsed(), keyed - projected];
        for (sum, span) in self.stage_secs.iter_mut().zip(spans) {
            *sum += span.as_secs_f64();
        }
    }
}
