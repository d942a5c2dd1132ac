//! Corners of a tile's cells: of tetrahedra sixteen at a time, of hexahedra one by one.
//!
//! In: the tile's cells in order, which is any order in memory. Out: their corners and values; memory that is needed soon is asked for.

use super::prefetch::prefetch;
use crate::backends::Frame;
use crate::columns::{BitView, HexahedraView, TetsView};
use crate::optics::LANES;
use crate::stages::SceneVertex;
use crate::stages::footprints::planes::Corners;
use crate::stages::sort::radix::{Pair, index_of};

/// Cells after those at hand whose vertex numbers are asked for: three times sixteen are drawn while memory answers.
const AHEAD: usize = 3 * LANES;

/// Walks through the cells of a tile.
pub(super) struct Gather<'a> {
    order: &'a [Pair],
    /// Cells from this number on are no tetrahedra.
    end: usize,
    tets: TetsView<'a>,
    positive: BitView<'a>,
    vertices: &'a [SceneVertex],
    values: Option<&'a [f32]>,
    /// The first of the next sixteen cells, and their vertices.
    at: usize,
    next: [[u32; 4]; LANES],
    hexahedra: HexahedraView<'a>,
    /// A hexahedron that was looked up.
    ahead: (usize, [u32; 8]),
}

impl<'a> Gather<'a> {
    pub(super) fn new(frame: &Frame<'a>, order: &'a [Pair]) -> Self {
        let dataset = frame.dataset;
        let mut gather = Self {
            order,
            end: dataset.tets.len(),
            tets: dataset.tets.view(),
            positive: dataset.positive.view(),
            vertices: frame.vertices,
            values: frame.cell_values(),
            at: 0,
            next: [[0; 4]; LANES],
            hexahedra: dataset.hexahedra.view(),
            ahead: (usize::MAX, [0; 8]),
        };
        gather.look_up();
        gather
    }

    /// Sixteen cells from place `from` on, or as many as there are.
    #[inline]
    fn cells(&self, from: usize) -> &'a [Pair] {
        let order = self.order;
        &order[from.min(order.len())..(from + LANES).min(order.len())]
    }

    /// Looks up the vertices of the next cells, and asks for these and for the cells after them.
    #[inline]
    fn look_up(&mut self) {
        for (lane, &pair) in self.cells(self.at).iter().enumerate() {
            let cell = index_of(pair) as usize;
            if cell < self.end {
                let tet = self.tets.get(cell);
                self.next[lane] = tet;
                for v in tet {
                    prefetch(&self.vertices[v as usize]);
                }
            }
        }
        for &pair in self.cells(self.at + AHEAD) {
            let cell = index_of(pair) as usize;
            if cell < self.end {
                prefetch(self.tets.row(cell).first_byte());
            }
        }
    }

    /// Puts the corners of the next sixteen cells into `corners`; how many of them are tetrahedra.
    #[inline(never)]
    pub(super) fn next(&mut self, corners: &mut Corners) -> usize {
        let mut tets = 0;
        for (lane, &pair) in self.cells(self.at).iter().enumerate() {
            let cell = index_of(pair) as usize;
            if cell < self.end {
                tets += 1;
                corners.set(lane, self.next[lane], self.vertices, self.positive.get(cell));
                if let Some(values) = self.values {
                    corners.set_constant(lane, values[cell]);
                }
            }
        }
        self.at += LANES;
        self.look_up();
        tets
    }

    /// The vertices of hexahedron `hexahedron`, the cell at place `place`; those of the cell after it are asked for.
    pub(super) fn hexahedron(&mut self, hexahedron: usize, place: usize) -> [u32; 8] {
        let vertex = if self.ahead.0 == hexahedron { self.ahead.1 } else { self.hexahedra.get(hexahedron) };
        let next = self.order.get(place + 1).and_then(|&pair| (index_of(pair) as usize).checked_sub(self.end));
        if let Some(next) = next.filter(|&next| next < self.hexahedra.len()) {
            self.ahead = (next, self.hexahedra.get(next));
            for v in self.ahead.1 {
                prefetch(&self.vertices[v as usize]);
            }
        }
        vertex
    }
}
