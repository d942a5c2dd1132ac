//! `DrawOrder`: the cells of a frame in the order in which a rasterising backend draws them, and their fans slice by slice.
//!
//! In: a [`Frame`]. Out: [`Slice`]s of the draw order, farthest cells first, each of at most so many fans.

use std::time::Instant;

use rayon::prelude::*;

use super::{Counts, Frame};
use crate::profile::Profile;
use crate::stages::ScreenVertex;
use crate::stages::classify::ClassCounts;
use crate::stages::cull;
use crate::stages::fans::{self, FanInput, FanSlot, FanStyle, PlanesFor};
use crate::stages::footprints::PixelBoxes;
use crate::stages::project::project;
use crate::stages::sort::radix::{Pair, index_of, pair, sort_coherent};

/// Cells that one thread makes fans of at a time.
const RUN: usize = 1 << 12;

/// Projected vertices and sorted cells; keeps its memory, and the last order, between frames.
#[derive(Default)]
pub(super) struct DrawOrder {
    screen: Vec<ScreenVertex>,
    pairs: Vec<Pair>,
    scratch: Vec<Pair>,
}

/// A part of the draw order.
pub(super) struct Slice {
    runs: Vec<Vec<u32>>,
    fans_of_run: Vec<usize>,
}

impl Slice {
    /// How many fans its cells have.
    pub(super) fn fans(&self) -> usize {
        self.fans_of_run.iter().sum()
    }

    /// Writes them; how many there are by class.
    pub(super) fn write<S: FanSlot>(&self, input: &FanInput, memory: S) -> ClassCounts {
        fans::write_runs(input, &self.runs, &self.fans_of_run, memory)
    }
}

impl DrawOrder {
    /// Projects, culls and sorts.
    pub(super) fn find(&mut self, frame: &Frame, is_ordered: bool, profile: &mut Profile) -> Counts {
        let start = Instant::now();
        project(frame.view, frame.vertices, &mut self.screen);
        profile.add("project", start.elapsed(), frame.vertices.len() as u64 * 32);

        let counts = self.cull_and_key(frame, is_ordered, profile);
        let start = Instant::now();
        if is_ordered {
            let _span = tracing::trace_span!("sort").entered();
            sort_coherent(&mut self.pairs, &mut self.scratch);
        }
        profile.add("sort", start.elapsed(), self.pairs.len() as u64 * 64);
        counts
    }

    /// What the fans of the frame are made from.
    pub(super) fn fan_input<'a>(&'a self, frame: &Frame<'a>, planes_for: PlanesFor) -> FanInput<'a> {
        let style = FanStyle { planes_for, faces: frame.faces };
        FanInput::new(frame.view, frame.dataset, frame.vertices, &self.screen, frame.cell_values(), style)
    }

    /// Slices of at most `fans` fans, farthest first: nearest first is the order of the keys, blending wants the farthest first.
    pub(super) fn slices<'a>(&'a self, input: &'a FanInput, fans: usize) -> impl Iterator<Item = Slice> + 'a {
        self.pairs.rchunks((fans / input.fans_per_cell_max()).max(1)).map(move |slice| {
            let cells = |run: &'_ [Pair]| run.iter().rev().map(|&pair| index_of(pair)).collect::<Vec<u32>>();
            let runs: Vec<Vec<u32>> = slice.par_rchunks(RUN).map(cells).collect();
            let fans_of_run = runs.par_iter().map(|run| fans::count(input, run)).collect();
            Slice { runs, fans_of_run }
        })
    }

    /// Fills `pairs` with the cells that can show: in the last frame's order if they are to be sorted, else in memory order.
    fn cull_and_key(&mut self, frame: &Frame, is_ordered: bool, profile: &mut Profile) -> Counts {
        let start = Instant::now();
        let boxes = PixelBoxes::new(frame.view).within(frame.view.region);
        let screen = &self.screen[..];
        let per_block: Vec<(Vec<Pair>, Counts)> = (0..frame.dataset.blocks.len())
            .into_par_iter()
            .map(|block| {
                let _span = tracing::trace_span!("cull", block).entered();
                let view = frame.dataset.block(block);
                let (mut visible, mut projected, mut areas) = (Vec::new(), Vec::new(), Vec::new());
                let culled =
                    cull::cull(&view, frame.field, screen, (frame.intervals(), frame.cull_table), &mut visible);
                boxes.of_cells(&view, frame.vertices, screen, &visible, &mut projected, &mut areas);
                let mut key_from_projected = Vec::with_capacity(projected.len());
                frame.keys.keys(&view, frame.vertices, &projected, &mut key_from_projected);
                let counts = Counts {
                    drawn: projected.len() as u64,
                    culled_transparent: culled.transparent,
                    culled_outside: (visible.len() - projected.len()) as u64,
                    invalid: culled.invalid,
                    ..Counts::default()
                };
                let of_cell = |(&cell, &key): (&u32, &u32)| pair(key, (view.base + cell as usize) as u32);
                (projected.iter().zip(&key_from_projected).map(of_cell).collect(), counts)
            })
            .collect();
        let mut counts = Counts::default();
        for (_, block) in &per_block {
            counts += *block;
        }
        let pairs = per_block.iter().flat_map(|(pairs, _)| pairs);
        if is_ordered {
            self.take_up_last_order(pairs, frame.dataset.cells());
        } else {
            self.pairs.clear();
            self.pairs.extend(pairs);
        }
        profile.add("cull", start.elapsed(), frame.dataset.cells() as u64 * 32);
        counts
    }

    /// Puts this frame's pairs where the last frame's stood; cells that were not drawn then come last.
    fn take_up_last_order<'a>(&mut self, pairs: impl Iterator<Item = &'a Pair>, cells: usize) {
        const ABSENT: u64 = u64::MAX;
        self.scratch.clear();
        self.scratch.resize(cells, ABSENT);
        for &new in pairs {
            self.scratch[index_of(new) as usize] = new;
        }
        let mut order = std::mem::take(&mut self.pairs);
        order.retain_mut(|pair| {
            let Some(new) = self.scratch.get_mut(index_of(*pair) as usize) else { return false };
            *pair = std::mem::replace(new, ABSENT);
            *pair != ABSENT
        });
        order.extend(self.scratch.iter().filter(|&&new| new != ABSENT));
        self.pairs = order;
    }
}
