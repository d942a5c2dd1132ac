//! `layers`: the cells of a visibility graph in layers that do not overlap (Laney et al. 2002, Max 2006).
//!
//! In: a [`Graph`]. Out: the layer of each cell: 0 where nothing comes before it, otherwise one more than the largest of those
//! right before it. Cells of one layer hide nothing of each other, and every cell comes after all that hide it.
//!
//! Kahn's algorithm with a first-in-first-out queue, as in Williams (1992): what one layer releases is the next, so that a cell needs
//! a count and no look at those before it. The counts are made in parallel; the queue is one thread's. Threads with a stack each
//! and shared counts took twice the processor time: the work is in branches that cannot be foretold and in waiting for memory.
//! O(cells + relations), 8 bytes a cell beside the layers.

use rayon::prelude::*;

use super::graph::{Graph, Sides, farther};
use crate::stages::sort::adjacency::{Across, Face};

/// Cells that one thread counts in one go.
const RUN: usize = 1 << 14;

/// What is known of all cells while they are placed; keeps its memory between frames.
#[derive(Default)]
pub(super) struct Layering {
    /// How many of those right before each cell are not placed yet.
    waits_for: Vec<u32>,
    /// Cells in the order in which they are placed, and one more place.
    queue: Vec<u32>,
}

impl Layering {
    /// Places all cells but those that wait for each other, and writes their layers to `layer_from_cell`; how many layers there are, and
    /// whether these are all cells.
    pub(super) fn place<A: Across>(
        &mut self,
        graph: &Graph<A>,
        exterior: &[Face],
        layer_from_cell: &mut Vec<u32>,
    ) -> (u32, bool) {
        self.count(graph, exterior);
        let Self { waits_for, queue } = self;
        layer_from_cell.resize(waits_for.len(), 0);
        queue.resize(waits_for.len() + 1, 0);
        // A cell that may be ready is written to the end, which moves on if it is: no branch can foretell that.
        let (mut first, mut end) = (0, 0);
        for (cell, &waits) in waits_for.iter().enumerate() {
            queue[end] = cell as u32;
            end += usize::from(waits == 0);
        }
        let mut layer = 0;
        while first < end {
            let next = end;
            while first < next {
                let cell = queue[first];
                first += 1;
                layer_from_cell[cell as usize] = layer;
                let mut release = |after: u32| {
                    let waits = &mut waits_for[after as usize];
                    *waits -= 1;
                    queue[end] = after;
                    end += usize::from(*waits == 0);
                };
                graph.neighbours_after(cell).for_each(&mut release);
                graph.relations_after(cell).iter().for_each(|&relation| release(farther(relation)));
            }
            layer += 1;
        }
        (layer, end == waits_for.len())
    }

    /// Counts what each cell waits for: what lies across the faces before it, but where that is the open, and what rays relate.
    fn count<A: Across>(&mut self, graph: &Graph<A>, exterior: &[Face]) {
        let waits_for = &mut self.waits_for;
        let before = |sides: &Sides| sides.only_before().count_ones();
        graph.sides_from_cell.par_iter().with_min_len(RUN).map(before).collect_into_vec(waits_for);
        for &Face { cell, index } in exterior {
            waits_for[cell as usize] -= u32::from(graph.sides_from_cell[cell as usize].only_before() >> index & 1);
        }
        for &relation in graph.relations.iter() {
            waits_for[farther(relation) as usize] += 1;
        }
    }

    /// The cells that were not placed, ascending.
    pub(super) fn waiting(&self) -> Vec<u32> {
        self.waits_for.iter().zip(0..).filter(|&(&waits, _)| waits > 0).map(|(_, cell)| cell).collect()
    }
}
