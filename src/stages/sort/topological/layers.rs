//! `layers`: the cells of a visibility graph in layers that do not overlap (Laney et al. 2002, Max 2006).
//!
//! In: a [`Graph`]. Out: the layer of each cell: 0 where nothing comes before it, otherwise one more than the largest of those
//! right before it. Cells of one layer hide nothing of each other, and every cell comes after all that hide it.
//!
//! Kahn's algorithm: a cell is placed when the last of those before it has been. Threads place cells in whatever order they find
//! them, each from a stack, whose top still is in cache: the layer is that of the longest way from the eye, whoever walks it. A
//! first-in-first-out queue, as in Williams (1992), gives the same layers, reads the whole mesh for each and has threads wait there.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use rayon::Scope;
use rayon::prelude::*;

use super::graph::{Graph, farther};
use crate::stages::sort::adjacency::Across;

/// Cells on a thread's stack from which on it gives half of them away. Chosen: a thousand cells take some tens of microseconds.
const SHARED: usize = 2048;
/// Cells that one thread looks at in one go.
const RUN: usize = 1 << 14;

/// What is known of all cells while they are placed; keeps its memory between frames.
#[derive(Default)]
pub(super) struct Layering {
    places: Vec<Place>,
}

/// What is known of one cell.
struct Place {
    /// How many of those right before it are not placed yet.
    waits_for: AtomicU32,
    /// Its layer once it is placed; before that, what relations ask for.
    layer: AtomicU32,
}

impl Layering {
    /// Counts what each cell waits for.
    pub(super) fn begin<A: Across>(&mut self, graph: &Graph<A>) {
        let place = |cell: usize| {
            let waits_for = graph.neighbours_before(cell as u32).count() as u32;
            Place { waits_for: AtomicU32::new(waits_for), layer: AtomicU32::new(0) }
        };
        (0..graph.len()).into_par_iter().with_min_len(RUN).map(place).collect_into_vec(&mut self.places);
        graph.relations.par_iter().for_each(|&r| {
            self.places[farther(r) as usize].waits_for.fetch_add(1, Ordering::Relaxed);
        });
    }

    /// Takes `relations` off what `cell` waits for.
    pub(super) fn release(&mut self, cell: u32, relations: u32) {
        *self.places[cell as usize].waits_for.get_mut() -= relations;
    }

    /// The cells among `cells` that wait for others, or those that wait for none.
    pub(super) fn waiting(&self, cells: impl IndexedParallelIterator<Item = u32>, is_waiting: bool) -> Vec<u32> {
        let waits = |cell: &u32| self.places[*cell as usize].waits_for.load(Ordering::Relaxed) > 0;
        cells.with_min_len(RUN).filter(|cell| waits(cell) == is_waiting).collect()
    }

    /// Places `ready`, cells that wait for none, and all that come to be so; how many these are.
    pub(super) fn place<A: Across>(&self, graph: &Graph<A>, ready: &[u32]) -> u64 {
        let walk = Walk { graph, layering: self, placed: AtomicU64::new(0) };
        rayon::scope(|scope| {
            for some in ready.chunks(SHARED) {
                scope.spawn(|scope| walk.place(scope, some.to_vec()));
            }
        });
        walk.placed.into_inner()
    }

    /// Writes the layers to `layer_from_cell`; how many there are.
    pub(super) fn finish(&self, layer_from_cell: &mut Vec<u32>) -> u32 {
        let layers = self.places.par_iter().with_min_len(RUN).map(|place| place.layer.load(Ordering::Relaxed));
        layers.collect_into_vec(layer_from_cell);
        layer_from_cell.par_iter().with_min_len(RUN).max().map_or(0, |&last| last + 1)
    }
}

/// What the threads share.
struct Walk<'a, A> {
    graph: &'a Graph<'a, A>,
    layering: &'a Layering,
    placed: AtomicU64,
}

impl<A: Across> Walk<'_, A> {
    fn place<'s>(&'s self, scope: &Scope<'s>, mut ready: Vec<u32>) {
        let mut placed = 0;
        while let Some(cell) = ready.pop() {
            self.place_cell(cell, &mut ready);
            placed += 1;
            if ready.len() > SHARED {
                // The older half goes: what was found last is in this thread's cache.
                let newer = ready.split_off(ready.len() / 2);
                let older = std::mem::replace(&mut ready, newer);
                scope.spawn(move |scope| self.place(scope, older));
            }
        }
        self.placed.fetch_add(placed, Ordering::Relaxed);
    }

    #[inline]
    fn place_cell(&self, cell: u32, ready: &mut Vec<u32>) {
        let Self { graph, layering: Layering { places }, .. } = self;
        let layer_of = |cell: u32| &places[cell as usize].layer;
        let mut layer = layer_of(cell).load(Ordering::Relaxed);
        for before in graph.neighbours_before(cell) {
            layer = layer.max(1 + layer_of(before).load(Ordering::Relaxed));
        }
        layer_of(cell).store(layer, Ordering::Relaxed);
        let mut release = |after: u32| {
            // Whoever releases a cell sees the layers of all that did before.
            if places[after as usize].waits_for.fetch_sub(1, Ordering::AcqRel) == 1 {
                ready.push(after);
            }
        };
        for after in graph.neighbours_after(cell) {
            release(after);
        }
        for &relation in graph.relations_after(cell) {
            let after = farther(relation);
            layer_of(after).fetch_max(layer + 1, Ordering::Relaxed);
            release(after);
        }
    }
}
