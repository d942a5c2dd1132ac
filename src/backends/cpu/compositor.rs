//! The tile compositor: one frame from footprints.

use std::ops::Range;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::bins::{Bins, Filled, lock};
use super::block::Projector;
use super::budget::{self, Plan};
use super::dispatch::{InstructionSet, Kernels};
use super::grid::{TILE, TileGrid};
use super::kept::{Kept, Source};
use super::tile_source::{LentTile, TileSource};
use super::worker::{Drawn, TileTask, Worker};
use crate::backends::{Counts, Frame};
use crate::camera::Region;
use crate::error::Result;
use crate::image::Image;
use crate::optics::Optics;
use crate::profile::Profile;
use crate::stages::ScreenVertex;
use crate::stages::project::project_while;
use crate::stages::sort::KeyMaker;
use crate::stages::sort::largest::Largest;

/// Composites footprints tile by tile; keeps its memory between frames.
#[derive(Default)]
pub struct TileCompositor {
    screen: Vec<ScreenVertex>,
    bins: Bins,
    /// One for each tile that is drawn at once.
    workers: Vec<Worker>,
    kept: Kept,
    instruction_set: Option<InstructionSet>,
}

impl TileCompositor {
    /// Draws with the kernels of `set` where the processor has it; the picture is the same.
    pub fn set_instruction_set(&mut self, set: Option<InstructionSet>) {
        self.instruction_set = set;
    }

    /// Draws one frame.
    ///
    /// # Errors
    /// [`Error::Memory`](crate::Error::Memory) where the frame's budget is too small, [`Error::Cancelled`](crate::Error::Cancelled).
    pub fn draw<O: Optics>(&mut self, frame: &Frame, optics: &O, profile: &mut Profile) -> Result<(Image, Counts)> {
        let threads = rayon::current_num_threads();
        // Maxima have no order along rays: the largest values first.
        let keys = if O::IS_MAXIMUM { KeyMaker::Largest(Largest::new(frame.field)) } else { frame.keys };
        let frame = &Frame { keys, ..*frame };
        if let Some(budget_bytes) = frame.memory_bytes {
            budget::check(frame, budget_bytes, threads)?;
            // As after no frame: what is kept here was not planned for this one.
            (self.bins, self.workers, self.kept) = Default::default();
        }
        let start = Instant::now();
        project_while(frame.control, frame.view, frame.vertices, &mut self.screen);
        frame.control.check()?;
        profile.add("project", start.elapsed(), frame.vertices.len() as u64 * 32);

        let [width, height] = frame.view.region.size_px();
        let mut image = Image::filled(width, height, [0.0; 4]);
        let counts = match frame.memory_bytes {
            None => self.draw_at_once(frame, optics, (&mut image, threads), profile)?,
            Some(budget_bytes) => self.draw_in_bands(frame, optics, (&mut image, threads), budget_bytes, profile)?,
        };
        frame.control.check()?;
        frame.control.tell(1.0);
        Ok((image, counts))
    }

    fn draw_at_once<O: Optics>(
        &mut self,
        frame: &Frame,
        optics: &O,
        (image, threads): (&mut Image, usize),
        profile: &mut Profile,
    ) -> Result<Counts> {
        // Passes of bands and tiles that are drawn again see other cells.
        let still = frame.still.filter(|_| frame.bands.is_none() && frame.tiles.is_none());
        let frame = &Frame { still, ..*frame };
        let source = self.kept.begin(frame);
        let start = Instant::now();
        let projector = Projector::new(frame, &self.screen, Kernels::new(self.instruction_set));
        let mut counts = Counts::default();
        if source == Source::Kept {
            self.bins.grid = TileGrid::new(frame.view);
            self.bins.rows = self.bins.grid.rows.clone();
        } else {
            let filled = self.bins.fill(&Projector { takes_all: source == Source::WholeBins, ..projector });
            frame.control.check()?;
            add_filling(profile, start.elapsed(), &filled, self.bins.pairs());
            counts = filled.counts;
            if still.is_some() {
                self.kept.take(&self.bins, source, &counts);
            }
        }
        if source != Source::Bins {
            let start = Instant::now();
            counts = self.kept.show(&projector);
            profile.add("cull", start.elapsed(), frame.dataset.cells() as u64 * 32);
        }
        self.workers.resize_with(threads, Worker::default);
        let mut kept = std::mem::take(&mut self.kept.tiles);
        let lent = if still.is_some() { &mut kept[..] } else { &mut [] };
        let drawn = self.draw_tiles(frame, optics, (image, None), (source == Source::Kept, lent), profile);
        self.kept.tiles = kept;
        frame.control.check()?;
        self.kept.end(frame);
        counts += drawn.counts;
        Ok(counts)
    }

    /// Draws some rows of tiles after the other; see [`bands`](super::bands).
    fn draw_in_bands<O: Optics>(
        &mut self,
        frame: &Frame,
        optics: &O,
        (image, threads): (&mut Image, usize),
        budget_bytes: u64,
        profile: &mut Profile,
    ) -> Result<Counts> {
        let start = Instant::now();
        let kernels = Kernels::new(self.instruction_set);
        let census = self.bins.census(&Projector::new(frame, &self.screen, kernels));
        add_filling(profile, start.elapsed(), &census.filled, 0);
        frame.control.check()?;

        let mut counts = census.filled.counts;
        let mut plan = Plan::new(frame, &census, budget_bytes, threads, budget::FRAGMENTS)?;
        let Range { start: mut row, end } = TileGrid::new(frame.view).rows;
        while row < end {
            self.workers.resize_with(plan.workers, Worker::default);
            let start = Instant::now();
            let rows = census.band(row, &plan);
            let filled = self.bins.fill_band(&Projector::new(frame, &self.screen, kernels), &census, rows);
            add_filling(profile, start.elapsed(), &filled, self.bins.pairs());
            frame.control.check()?;
            let drawn = self.draw_tiles(frame, optics, (image, Some(&plan)), (false, &mut []), profile);
            frame.control.check()?;
            if drawn.fragments_lacking > 0 {
                // More cells over a pixel than was thought: the band is drawn again with room for them.
                plan = Plan::new(frame, &census, budget_bytes, threads, drawn.fragments_lacking)?;
                self.bins.keep_within(&plan);
                self.workers.clear();
                continue;
            }
            counts += drawn.counts;
            row = self.bins.rows.end;
        }
        Ok(counts)
    }

    /// Draws the rows of tiles that the bins are filled for.
    fn draw_tiles<O: Optics>(
        &mut self,
        frame: &Frame,
        optics: &O,
        (image, plan): (&mut Image, Option<&Plan>),
        (is_kept, kept): (bool, &mut [Vec<u32>]),
        profile: &mut Profile,
    ) -> Drawn {
        profile.sample_memory();
        let start = Instant::now();
        let Bins { grid, rows, .. } = &self.bins;
        let region = frame.view.region;
        let pixels = &mut image.pixels[pixels_of(rows, region)];
        let tiles = Mutex::new(TileSource::new(region, grid, rows, pixels, kept));
        let is_wanted =
            |LentTile { tile, .. }: &LentTile| frame.tiles.is_none_or(|wanted| wanted.get(*tile) == Some(&true));
        let next = || lock(&tiles).find(is_wanted);
        let kernels = Kernels::new(self.instruction_set);
        let task = TileTask { frame, optics, bins: &self.bins, kernels, plan, is_kept, filter: self.kept.filter() };
        let workers = self.workers.par_iter_mut().with_max_len(1);
        let drawn = workers.map(|worker| worker.draw(&task, next)).reduce(Drawn::default, Drawn::sum);

        let elapsed = start.elapsed();
        let total = (drawn.sort_secs + drawn.draw_secs).max(f64::MIN_POSITIVE);
        let pairs = self.bins.pairs();
        if is_kept {
            profile.add("composite", elapsed, 0);
        } else {
            profile.add("sort", elapsed.mul_f64(drawn.sort_secs / total), pairs * 16);
            profile.add("composite", elapsed.mul_f64(drawn.draw_secs / total), pairs * 80);
        }
        profile.note_memory(drawn.anonymous_bytes);
        profile.sample_memory();
        drawn
    }
}

/// Stages interleave block by block on all threads: the wall time is shared out by the time each took.
fn add_filling(profile: &mut Profile, elapsed: Duration, filled: &Filled, pairs: u64) {
    let total = filled.stage_secs.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let Counts { drawn, culled_transparent, culled_outside, invalid, .. } = filled.counts;
    let bytes = [(drawn + culled_transparent + culled_outside + invalid) * 32, pairs * 8, 0];
    for ((name, secs), bytes) in ["cull", "footprints", "sort"].into_iter().zip(filled.stage_secs).zip(bytes) {
        profile.add(name, elapsed.mul_f64(secs / total), bytes);
    }
}

/// The pixels of some rows of tiles among those of the region.
fn pixels_of(rows: &Range<u32>, region: Region) -> Range<usize> {
    let width = region.size_px()[0] as usize;
    let start_of = |row: u32| ((row * TILE).clamp(region.y0, region.y1) - region.y0) as usize * width;
    start_of(rows.start)..start_of(rows.end)
}
