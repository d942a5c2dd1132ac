//! The tile compositor: one frame from footprints.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use rayon::prelude::*;

use super::bins::{Bins, TILE, TileGrid};
use super::dispatch::{InstructionSet, Kernels};
use super::tile::{PIXELS, place_of};
use super::worker::{Drawn, TileTask, Worker};
use crate::backends::{Counts, Frame};
use crate::image::Image;
use crate::optics::Optics;
use crate::profile::Profile;
use crate::stages::project::project;
use crate::stages::sort::{KeyMaker, SortKey};
use crate::stages::{ScreenVertex, View};

/// Composites footprints tile by tile; keeps its memory between frames.
#[derive(Default)]
pub struct TileCompositor {
    screen: Vec<ScreenVertex>,
    bins: Bins,
    /// One per thread that ever drew at once.
    workers: Mutex<Vec<Worker>>,
    /// Tile by tile, block by block, lane by lane.
    tile_pixels: Vec<[[f32; 4]; PIXELS]>,
    instruction_set: Option<InstructionSet>,
}

impl TileCompositor {
    /// Draws with the kernels of `set` where the processor has it; the picture is the same.
    pub fn set_instruction_set(&mut self, set: Option<InstructionSet>) {
        self.instruction_set = set;
    }

    /// Draws one frame.
    pub fn draw<O: Optics>(&mut self, frame: &Frame, optics: &O, profile: &mut Profile) -> (Image, Counts) {
        let start = Instant::now();
        project(frame.view, frame.vertices, &mut self.screen);
        profile.add("project", start.elapsed(), frame.vertices.len() as u64 * 32);

        let key = if O::IS_ORDERED { frame.sort_key } else { SortKey::None };
        let start = Instant::now();
        let filled = self.bins.fill(frame, &self.screen, &KeyMaker::new(key, frame.view));
        let elapsed = start.elapsed();
        // Stages interleave block by block on all threads: the wall time is shared out by the time each took.
        let total = filled.stage_secs.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let cells = frame.dataset.tets.len() as u64;
        let pairs = self.bins.len() as u64;
        let bytes = [cells * 32, pairs * 8, 0];
        for ((name, secs), bytes) in ["cull", "footprints", "sort"].into_iter().zip(filled.stage_secs).zip(bytes) {
            profile.add(name, elapsed.mul_f64(secs / total), bytes);
        }

        let start = Instant::now();
        let drawn = self.draw_tiles(frame, optics, key);
        let elapsed = start.elapsed();
        let total = (drawn.sort_secs + drawn.draw_secs).max(f64::MIN_POSITIVE);
        profile.add("sort", elapsed.mul_f64(drawn.sort_secs / total), pairs * 16);
        profile.add("composite", elapsed.mul_f64(drawn.draw_secs / total), pairs * 80);

        let start = Instant::now();
        let image = self.resolve(frame.view);
        profile.add("resolve", start.elapsed(), image.pixels.len() as u64 * 32);
        let mut counts = filled.counts;
        counts += drawn.counts;
        (image, counts)
    }

    fn draw_tiles<O: Optics>(&mut self, frame: &Frame, optics: &O, key: SortKey) -> Drawn {
        let grid = TileGrid::new(frame.view);
        self.tile_pixels.resize(grid.len(), [[0.0; 4]; PIXELS]);
        let kernels = Kernels::new(self.instruction_set);
        let task = TileTask { frame, optics, bins: &self.bins, grid, kernels, is_sorted: key != SortKey::None };
        let workers = &self.workers;
        let draw = |(tile, out): (usize, &mut [[f32; 4]; PIXELS])| {
            let mut worker = lock(workers).pop().unwrap_or_default();
            let drawn = worker.draw(&task, tile, out);
            lock(workers).push(worker);
            drawn
        };
        self.tile_pixels.par_iter_mut().enumerate().with_max_len(1).map(draw).reduce(Drawn::default, Drawn::sum)
    }

    /// Copies the tiles to the rows of a picture.
    fn resolve(&self, view: &View) -> Image {
        let [width, height] = view.size_px;
        let columns = TileGrid::new(view).columns as usize;
        let mut image = Image::filled(width, height, [0.0; 4]);
        image.pixels.par_chunks_mut(width as usize).enumerate().for_each(|(y, row)| {
            let tile = TILE as usize;
            let first_tile = y / tile * columns;
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = self.tile_pixels[first_tile + x / tile][place_of(x % tile, y % tile)];
            }
        });
        image
    }
}

/// A poisoned lock means that a thread panicked; its worker never came back, the others are whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
