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
use super::{LOOK, set_len};
use crate::control::Control;
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
    /// whether these are all cells. It stops where the end is asked for.
    pub(super) fn place<A: Across>(
        &mut self,
        control: &Control,
        graph: &Graph<A>,
        exterior: &[Face],
        layer_from_cell: &mut Vec<u32>,
    ) -> (u32, bool) {
        set_len(&mut self.waits_for, graph.len());
        self.count(control, graph, exterior);
        let Self { waits_for, queue } = self;
        set_len(layer_from_cell, waits_for.len());
        set_len(queue, waits_for.len() + 1);
        // A cell that may be ready is written to the end, which moves on if it is: no branch can foretell that.
        let (mut first, mut end) = (0, 0);
        for (cell, &waits) in waits_for.iter().enumerate() {
            if cell % LOOK == 0 && control.is_cancelled() {
                return (0, false);
            }
            queue[end] = cell as u32;
            end += usize::from(waits == 0);
        }
        let mut layer = 0;
        while first < end {
            let next = end;
            while first < next {
                if first % LOOK == 0 && control.is_cancelled() {
                    return (0, false);
                }
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
    fn count<A: Across>(&mut self, control: &Control, graph: &Graph<A>, exterior: &[Face]) {
        let waits_for = &mut self.waits_for;
        let count = |(waits, sides): (&mut [u32], &[Sides])| {
            if !control.is_cancelled() {
                waits.iter_mut().zip(sides).for_each(|(waits, sides)| *waits = sides.only_before().count_ones());
            }
        };
        waits_for.par_chunks_mut(RUN).zip(graph.sides_from_cell.par_chunks(RUN)).for_each(count);
        for faces in exterior.chunks(LOOK).take_while(|_| !control.is_cancelled()) {
            for &Face { cell, index } in faces {
                waits_for[cell as usize] -= u32::from(graph.sides_from_cell[cell as usize].only_before() >> index & 1);
            }
        }
        for relations in graph.relations.chunks(LOOK).take_while(|_| !control.is_cancelled()) {
            for &relation in relations {
                waits_for[farther(relation) as usize] += 1;
            }
        }
    }

    /// The cells that were not placed, ascending.
    pub(super) fn waiting(&self) -> Vec<u32> {
        self.waits_for.iter().zip(0..).filter(|&(&waits, _)| waits > 0).map(|(_, cell)| cell).collect()
    }
}
