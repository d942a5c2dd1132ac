//! One block of cells on its way to the bins: `cull`, `footprints`, and `sort` keys of what is left.
//!
//! In: a block. Out: its cells that may show, the tiles each touches, their keys; what became of the others.

use std::ops::Range;
use std::time::Instant;

use super::dispatch::Kernels;
use super::grid::{TILE, TileBox, TileGrid};
use crate::backends::{Counts, Frame};
use crate::columns::{self, BlockTets, BlockView};
use crate::optics::LANES;
use crate::stages::ScreenVertex;
use crate::stages::cull::{self, Culled};
use crate::stages::footprints::planes::Corners;
use crate::stages::footprints::{BoxLanes, PixelBox, PixelBoxes};
use crate::stages::sort::KeyMaker;
use crate::stages::sort::radix::{Pair, pair};

/// What cells are projected with, for one view.
#[derive(Clone, Copy)]
pub(super) struct Projector<'a> {
    pub(super) frame: &'a Frame<'a>,
    pub(super) screen: &'a [ScreenVertex],
    pub(super) boxes: PixelBoxes,
    pub(super) kernels: Kernels,
    /// Whether cells are taken that do not show by their values.
    pub(super) takes_all: bool,
}

impl<'a> Projector<'a> {
    pub(super) fn new(frame: &'a Frame<'a>, screen: &'a [ScreenVertex], kernels: Kernels) -> Self {
        let region = TileGrid::new(frame.view).pixels(frame.view.size_px);
        Self { frame, screen, boxes: PixelBoxes::new(frame.view).within(region), kernels, takes_all: false }
    }

    /// Whether nobody wants the frame any more.
    pub(super) fn is_cancelled(&self) -> bool {
        self.frame.control.is_cancelled()
    }

    /// The rows of tiles that block `block` may touch; `None` where none of its cells can show, and then it is counted.
    /// Its cells are not read.
    pub(super) fn rows(&self, block: usize, counts: &mut Counts) -> Option<Range<u32>> {
        let frame = self.frame;
        let (low, high) = frame.field.block_ranges[block];
        // Cells with values that are not finite are counted one by one.
        let has_invalid = frame.field.invalid > 0 && !self.takes_all;
        if !has_invalid && !self.takes_all && frame.cull_table.is_transparent(frame.intervals(), low, high) {
            counts.culled_transparent += frame.dataset.cells_drawn_in(block);
            return None;
        }
        let rows = self.boxes.rows_of_bounds(frame.dataset.blocks[block].bounds, frame.view);
        match rows {
            // What is counted cell by cell is drawn cell by cell too.
            None if has_invalid => Some(TileGrid::new(frame.view).rows),
            None => {
                counts.culled_outside += frame.dataset.cells_drawn_in(block);
                None
            }
            Some(rows) => Some(u32::from(rows.start) / TILE..u32::from(rows.end).div_ceil(TILE)),
        }
    }
}

/// Batches of sixteen cells that go through each stage together: their corners stay in the cache, and clocks are seldom read.
const BATCHES: usize = 16;

/// The cells of one block; its memory is kept for the next.
#[derive(Debug, Default)]
pub(super) struct BlockCells {
    cell_from_visible: Vec<u32>,
    cell_from_projected: Vec<u32>,
    key_from_projected: Vec<u32>,
    boxes: Vec<PixelBox>,
    batches: Vec<TetLanes>,
    /// Seconds in cull, footprints, sort keys.
    pub(super) stage_secs: [f64; 3],
}

/// Sixteen tetrahedra, one a lane.
#[derive(Clone, Copy, Debug, Default)]
struct TetLanes {
    corners: Corners,
    boxes: BoxLanes,
    key: [u32; LANES],
}

impl BlockCells {
    /// Takes the cells of `block` that may show, and their keys; what became of all of them.
    pub(super) fn project(&mut self, projector: &Projector, block: &BlockView) -> Counts {
        let Projector { frame, screen, boxes, .. } = projector;
        let start = Instant::now();
        let span = tracing::trace_span!("cull").entered();
        self.cell_from_visible.clear();
        let Culled { transparent, invalid } = if projector.takes_all {
            cull::all(block, &mut self.cell_from_visible);
            Culled::default()
        } else {
            let optics = (frame.intervals(), frame.cull_table);
            cull::cull(block, frame.field, screen, optics, &mut self.cell_from_visible)
        };
        self.stage_secs[0] += start.elapsed().as_secs_f64();
        drop(span);
        self.cell_from_projected.clear();
        self.key_from_projected.clear();
        self.boxes.clear();
        match &block.cells {
            columns::BlockCells::Tets(tets) if !matches!(frame.keys, KeyMaker::Layers(_)) => {
                let visible = std::mem::take(&mut self.cell_from_visible);
                self.batches.resize(BATCHES, TetLanes::default());
                for cells in visible.chunks(BATCHES * LANES) {
                    self.project_tets(projector, (tets, block.base), cells);
                }
                self.cell_from_visible = visible;
            }
            _ => {
                let start = Instant::now();
                let span = tracing::trace_span!("footprints").entered();
                boxes.of_cells(
                    block,
                    frame.vertices,
                    screen,
                    &self.cell_from_visible,
                    &mut self.cell_from_projected,
                    &mut self.boxes,
                );
                let found = Instant::now();
                drop(span);
                let _span = tracing::trace_span!("sort_keys").entered();
                frame.keys.keys(block, frame.vertices, &self.cell_from_projected, &mut self.key_from_projected);
                self.stage_secs[1] += (found - start).as_secs_f64();
                self.stage_secs[2] += found.elapsed().as_secs_f64();
            }
        }
        Counts {
            drawn: self.boxes.len() as u64,
            culled_transparent: transparent,
            culled_outside: (self.cell_from_visible.len() - self.boxes.len()) as u64,
            invalid,
            ..Counts::default()
        }
    }

    /// The boxes and keys of some visible tetrahedra, sixteen at a time.
    fn project_tets(&mut self, projector: &Projector, (tets, base): (&BlockTets, usize), cell_from_visible: &[u32]) {
        let Projector { frame, screen, boxes, kernels, .. } = projector;
        let start = Instant::now();
        let span = tracing::trace_span!("footprints").entered();
        let batches = &mut self.batches[..cell_from_visible.len().div_ceil(LANES)];
        let cell_values = if let KeyMaker::Largest(largest) = &frame.keys { largest.cell_values() } else { None };
        for (batch, cells) in batches.iter_mut().zip(cell_from_visible.chunks(LANES)) {
            for (lane, &cell) in cells.iter().enumerate() {
                batch.corners.set(lane, tets.get(cell as usize), frame.vertices, false);
                if let Some(values) = cell_values {
                    batch.corners.set_constant(lane, values[base + cell as usize]);
                }
            }
            kernels.boxes(boxes, &batch.corners, &mut batch.boxes);
        }
        let found = Instant::now();
        drop(span);
        let span = tracing::trace_span!("sort_keys").entered();
        for batch in batches.iter_mut() {
            kernels.keys(&frame.keys, &batch.corners, &mut batch.key);
        }
        let keyed = Instant::now();
        drop(span);
        for (batch, cells) in batches.iter().zip(cell_from_visible.chunks(LANES)) {
            for (lane, &cell) in cells.iter().enumerate() {
                let pixels = if batch.boxes.crosses_near[lane] != 0 {
                    boxes.of_cell(tets.get(cell as usize), frame.vertices, screen)
                } else {
                    (batch.boxes.is_seen[lane] != 0).then(|| batch.boxes.get(lane))
                };
                if let Some(pixels) = pixels {
                    self.boxes.push(pixels);
                    self.cell_from_projected.push(cell);
                    self.key_from_projected.push(batch.key[lane]);
                }
            }
        }
        self.stage_secs[1] += (found - start).as_secs_f64() + keyed.elapsed().as_secs_f64();
        self.stage_secs[2] += (keyed - found).as_secs_f64();
    }

    /// The cells that touch a tile.
    pub(super) fn projected(&self) -> &[u32] {
        &self.cell_from_projected
    }

    /// Keeps the cells that touch some rows of tiles.
    pub(super) fn keep_rows(&mut self, rows: &Range<u32>) {
        let mut kept = 0;
        for i in 0..self.boxes.len() {
            if TileBox::around(self.boxes[i]).touches_rows(rows) {
                self.boxes[kept] = self.boxes[i];
                self.cell_from_projected[kept] = self.cell_from_projected[i];
                self.key_from_projected[kept] = self.key_from_projected[i];
                kept += 1;
            }
        }
        self.boxes.truncate(kept);
        self.cell_from_projected.truncate(kept);
        self.key_from_projected.truncate(kept);
    }

    /// The tiles that each cell touches.
    pub(super) fn tile_boxes(&self) -> impl Iterator<Item = TileBox> {
        self.boxes.iter().copied().map(TileBox::around)
    }

    /// Gives each cell with its pair and its tiles to `place`.
    pub(super) fn for_each(&mut self, block: &BlockView, mut place: impl FnMut(Pair, TileBox)) {
        let start = Instant::now();
        for ((&cell, &key), area) in self.cell_from_projected.iter().zip(&self.key_from_projected).zip(&self.boxes) {
            place(pair(key, (block.base + cell as usize) as u32), TileBox::around(*area));
        }
        self.stage_secs[1] += start.elapsed().as_secs_f64();
    }
}
