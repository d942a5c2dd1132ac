//! The memory that a frame takes, and what a budget leaves of it for the bins.
//!
//! In: a frame, a number of threads. Out: bytes. Columns that a map lends count nothing.

use super::bands::Census;
use super::bins::LargeCell;
use super::grid::TileGrid;
use crate::backends::{Frame, scene_bytes};
use crate::error::{Error, Result};
use crate::stages::ScreenVertex;
use crate::stages::sort::radix::Pair;

/// What an allocator keeps beyond what it was asked for; chosen.
const SLACK: u64 = 4 << 20;
/// Stack, heap and kernel memory of a thread (a `Worker`: 0.4 MB), whatever it draws.
const THREAD: u64 = 1 << 20;
/// A pixel that is drawn, and what encoding it takes: eight bits a channel twice.
const PIXEL: u64 = 16 + 8;
/// What a tile's pairs take in the worker that draws it: a copy, and room to sort.
const PAIR_DRAWN: u64 = 2 * size_of::<Pair>() as u64;
/// A collected fragment of 24 bytes in a list that doubles, and its place in the order.
const FRAGMENT: u64 = 2 * 24 + 4;
/// A large cell in the list of its chunk and in that of all, which double.
const LARGE: u64 = 4 * size_of::<LargeCell>() as u64;
/// Where a tile's pairs begin, and where the next one goes.
const TILE_OF_BAND: u64 = 16;

/// Fragments that a worker can collect at least: of 4,096 cells for each pixel of a block.
pub(super) const FRAGMENTS: usize = 1 << 16;

/// How the bins of a frame share what the budget leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plan {
    /// Tiles that are drawn at once.
    pub(super) workers: usize,
    /// Pairs of a band at most.
    pub(super) pairs: u64,
    /// Pairs of a tile at most.
    pub(super) tile_pairs: usize,
    /// Fragments that a worker collects at most.
    pub(super) fragments: usize,
}

/// What the bins take for each pair.
const PAIR: u64 = size_of::<Pair>() as u64;

/// What a frame takes before a cell is looked at.
pub(super) fn fixed_bytes(frame: &Frame, threads: usize) -> u64 {
    let screen = frame.vertices.len() * size_of::<ScreenVertex>();
    let [width, height] = frame.view.region.size_px().map(u64::from);
    let census = TileGrid::new(frame.view).len() * 4 + frame.dataset.blocks.len() * 16;
    SLACK
        + THREAD * threads as u64
        + scene_bytes(frame.dataset, frame.field, frame.vertices)
        + (screen + census) as u64
        + PIXEL * width * height
}

/// Whether a frame can begin.
///
/// # Errors
/// [`Error::Memory`] where it cannot.
pub(super) fn check(frame: &Frame, budget_bytes: u64, threads: usize) -> Result<()> {
    let needed_bytes = fixed_bytes(frame, threads);
    if needed_bytes <= budget_bytes {
        return Ok(());
    }
    let what = "the frame, before its cells are counted,";
    Err(Error::Memory { budget_bytes, needed_bytes, what, advice: "a smaller picture, or parts of it by --region" })
}

impl Plan {
    /// Shares what `budget_bytes` leaves; fewer workers where all of the threads' cannot be had.
    ///
    /// # Errors
    /// [`Error::Memory`] where one row of tiles and one worker are too much.
    pub(super) fn new(
        frame: &Frame,
        census: &Census,
        budget_bytes: u64,
        threads: usize,
        fragments: usize,
    ) -> Result<Self> {
        let grid = TileGrid::new(frame.view);
        let fixed = fixed_bytes(frame, threads) + LARGE * census.large + TILE_OF_BAND * grid.len() as u64;
        let tile_pairs = census.largest_tile() + census.large;
        let worker = PAIR_DRAWN * tile_pairs + FRAGMENT * fragments as u64;
        let smallest = PAIR * census.largest_row();
        let rest = budget_bytes.saturating_sub(fixed);
        let fits = |workers: &u64| worker * workers + smallest <= rest;
        let Some(workers) = (1..=threads as u64).rev().find(fits) else {
            let (needed_bytes, what) = (fixed + worker + smallest, "the frame, in bands of 32 rows of pixels,");
            return Err(Error::Memory {
                budget_bytes,
                needed_bytes,
                what,
                advice: "a smaller or narrower picture, or parts of it by --region",
            });
        };
        Ok(Self {
            workers: workers as usize,
            pairs: (rest - worker * workers) / PAIR,
            tile_pairs: tile_pairs as usize,
            fragments,
        })
    }
}
