//! `FrameSort`: sorts the pairs of frame after frame; after a small step of the view, in half the time.
//!
//! In: pairs in ascending order of index, in parts that several threads fill. Out: all of them by key, equal keys by index, whatever
//! the last frame was.
//!
//! A step of a degree leaves next to no cell where it stood in the order: of ten million it moves a typical one by a hundred
//! thousand places. So the last order is a poor start: to look pairs up in it costs what a pass of the sort does, and cells
//! then no longer stand by index. But *how many* cells lie at a depth hardly changes. So what is kept is how the keys were spread:
//! the pairs go straight from the key to a bucket with room for them, while the next block's keys are made, and the sort
//! only has to settle the buckets. For a view that is new it counts and spreads them first, as [`super::sort`] does.

use rayon::prelude::*;

use super::settle::{Settler, order_ties};
use super::spread::{BUCKETS, SAMPLE, Spread, split_by};
use super::{CHUNK, Pair};

pub use super::part::Part;

/// Keys that moved by more than this share of their range are not foreseen.
const LARGEST_STEP: f64 = 1.0 / 16.0;
/// If more than one pair in so many finds no room, all are spread anew. Chosen, not measured.
const PAIRS_PER_HOMELESS: usize = 8;

/// Sorts frames; keeps its memory, and how the last one's keys were spread.
#[derive(Debug, Default)]
pub struct FrameSort {
    parts: Vec<Part>,
    spread: Option<Spread>,
    /// Whether the parts have rooms by that spread.
    is_foreseen: bool,
    scratch: Vec<Pair>,
}

impl FrameSort {
    /// Parts to put the next frame's pairs into, those of the first part with the lowest indices, and so on. `moved` is the largest
    /// step of a key since the last frame, as a share of the range of all keys, roughly; `None` for a view that is new. It
    /// changes the time that the sort takes, not its result.
    pub fn begin(&mut self, parts: usize, moved: Option<f64>) -> &mut [Part] {
        let moved = moved.filter(|&moved| moved <= LARGEST_STEP && self.parts.len() == parts);
        self.parts.resize_with(parts, Part::default);
        // Keys are not quite linear in depth.
        let reach = |moved: f64| (1.5 * moved * BUCKETS as f64) as usize + 2;
        let is_sensible = |moved: f64| self.parts.par_iter_mut().all(|part| part.plan(reach(moved)));
        self.is_foreseen = self.spread.is_some() && moved.is_some_and(is_sensible);
        let spread = self.spread.filter(|_| self.is_foreseen);
        self.parts.par_iter_mut().for_each(|part| part.begin(spread));
        &mut self.parts
    }

    /// All pairs, part after part, as they came.
    pub fn finish_unsorted(&mut self, pairs: &mut Vec<Pair>) {
        self.spread = None;
        pairs.clear();
        for part in &mut self.parts {
            part.take_back();
            pairs.extend_from_slice(part.rest());
        }
    }

    /// Sorts all pairs by key and index into `pairs`.
    pub fn finish(&mut self, pairs: &mut Vec<Pair>) {
        let n: usize = self.parts.iter().map(Part::len).sum();
        let was_foreseen = self.is_foreseen && self.homeless() <= n / PAIRS_PER_HOMELESS;
        // Pairs that are taken back out of buckets are not.
        let is_in_index_order = was_foreseen || !self.is_foreseen;
        if was_foreseen {
            self.parts.par_iter_mut().for_each(Part::close);
        } else {
            self.parts.par_iter_mut().for_each(Part::take_back);
            let sample = self.parts.iter().flat_map(Part::rest).step_by(n.div_ceil(SAMPLE).max(1));
            self.spread = if n < 2 * CHUNK { None } else { Spread::over(sample) };
            if let Some(spread) = self.spread {
                self.parts.par_iter_mut().for_each(|part| part.spread_all(spread));
            }
        }
        let Some(spread) = self.spread else {
            // Few, or none.
            self.finish_unsorted(pairs);
            super::sort(pairs, &mut self.scratch);
            return;
        };
        pairs.resize(n, 0);
        let lens = (0..BUCKETS).map(|bucket| self.parts.iter().map(|part| part.counts()[bucket] as usize).sum());
        split_by(pairs, lens).into_par_iter().enumerate().for_each_init(Settler::default, |settler, (bucket, out)| {
            let runs = self.parts.iter().flat_map(|part| part.runs(bucket));
            let runs: Vec<&[Pair]> = runs.filter(|run| !run.is_empty()).collect();
            settler.settle(&runs, out, spread.keys_of(bucket));
            if !is_in_index_order {
                order_ties(out);
            }
        });
    }

    /// How many pairs wait without a room.
    pub(super) fn homeless(&self) -> usize {
        self.parts.iter().map(|part| part.rest().len()).sum()
    }
}
