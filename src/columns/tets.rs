//! `Tets`: the vertices of all tetrahedra, as a slice, or in blocks of 16-bit and of 32-bit numbers as a container holds them, or as
//! another program holds them: in its order, each cell's vertices in any.

use super::{Column, Dataset};
use crate::error::Result;

/// The four vertices of each tetrahedron, ascending.
///
/// Numbers from a container are not checked one by one, which would touch every page of a file larger than memory: one
/// beyond the last vertex reads as the last, so that a damaged file gives a wrong picture and nothing worse.
#[derive(Clone, Debug)]
pub struct Tets {
    /// All cells where `blocks` is empty; else the whole column, in units of four 32-bit numbers.
    wide: Column<[u32; 4]>,
    /// The whole column, in units of four 16-bit numbers.
    narrow: Column<[u16; 4]>,
    blocks: Column<BlockIds>,
    /// The rows of `wide` are those of another program.
    is_lent: bool,
    /// Which of these rows each cell has; none where all have their own.
    row_from_cell: Option<Column<u32>>,
    len: usize,
    last_vertex: u32,
}

/// How a block of cells numbers its vertices.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BlockIds {
    /// Where its cells begin in the column, in units of 64 bytes.
    pub start: u32,
    /// Added to each 16-bit number; [`BlockIds::WIDE`] where the block has 32-bit numbers.
    pub base: u32,
}

impl BlockIds {
    /// The `base` of a block with 32-bit numbers.
    pub const WIDE: u32 = u32::MAX;
    /// The unit of `start` in bytes.
    pub const UNIT_BYTES: usize = 64;
}

impl Tets {
    /// Cells in the blocks of a container: `wide` and `narrow` are the same bytes.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`](crate::Error::LengthMismatch) where a block lies outside the column or one is missing.
    pub(crate) fn blocked(
        wide: Column<[u32; 4]>,
        narrow: Column<[u16; 4]>,
        blocks: Column<BlockIds>,
        len: usize,
        vertices: usize,
    ) -> Result<Self> {
        let mismatch = |expected: usize| crate::Error::LengthMismatch {
            column: "cells".to_owned(),
            len: narrow.len() as u64,
            expected: expected as u64,
        };
        if blocks.len() != len.div_ceil(Dataset::BLOCK_CELLS) || vertices == 0 {
            return Err(mismatch(len));
        }
        for (block, ids) in blocks.iter().enumerate() {
            let cells = (len - block * Dataset::BLOCK_CELLS).min(Dataset::BLOCK_CELLS);
            let size = if ids.base == BlockIds::WIDE { 16 } else { 8 };
            let end = ids.start as usize * BlockIds::UNIT_BYTES + cells * size;
            if end > size_of_val(&narrow[..]) {
                return Err(mismatch(end / 8));
            }
        }
        let last_vertex = (vertices - 1) as u32;
        Ok(Self { wide, narrow, blocks, is_lent: false, row_from_cell: None, len, last_vertex })
    }

    /// Cells as another program holds them, those of `row_from_cell` in its order, or all: their vertices are put into order when they are
    /// read. Every number must be that of one of `vertices` vertices; one that is changed later reads as another vertex.
    ///
    /// # Panics
    /// If there is no vertex.
    pub(crate) fn lent(rows: Column<[u32; 4]>, row_from_cell: Option<Column<u32>>, vertices: usize) -> Self {
        let len = row_from_cell.as_ref().map_or(rows.len(), |cells| cells.len());
        let last_vertex = vertices.checked_sub(1).expect("cells have vertices") as u32;
        let (narrow, blocks) = (Vec::new().into(), Vec::new().into());
        Self { wide: rows, narrow, blocks, is_lent: true, row_from_cell, len, last_vertex }
    }

    /// Which row each cell has, where rows are lent and cells are not all of them in their order.
    pub(super) fn row_from_cell(&self) -> Option<&Column<u32>> {
        self.row_from_cell.as_ref()
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// All cells as slices, for repeated access.
    pub fn view(&self) -> TetsView<'_> {
        let row_from_cell = self.row_from_cell.as_ref().map(|rows| &rows[..]);
        let Self { wide, narrow, blocks, is_lent, last_vertex, .. } = self;
        TetsView { wide, narrow, blocks, is_lent: *is_lent, row_from_cell, last_vertex: *last_vertex }
    }

    /// The vertices of cell `cell`.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn get(&self, cell: usize) -> [u32; 4] {
        self.view().get(cell)
    }

    /// Bytes of memory that the numbers take; none where they are used in place.
    pub fn owned_bytes(&self) -> u64 {
        // The narrow numbers are the same bytes as the wide ones.
        let order = self.row_from_cell.as_ref().map_or(0, Column::owned_bytes);
        self.wide.owned_bytes() + self.blocks.owned_bytes() + order
    }

    /// The vertices of every cell, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = [u32; 4]> + '_ {
        let view = self.view();
        (0..self.len).map(move |cell| view.get(cell))
    }
}

impl From<Vec<[u32; 4]>> for Tets {
    /// Every number must be that of a vertex.
    fn from(tets: Vec<[u32; 4]>) -> Self {
        let len = tets.len();
        let (narrow, blocks) = (Vec::new().into(), Vec::new().into());
        Self { wide: tets.into(), narrow, blocks, is_lent: false, row_from_cell: None, len, last_vertex: u32::MAX }
    }
}

/// [`Tets`] as slices.
#[derive(Clone, Copy, Debug)]
pub struct TetsView<'a> {
    wide: &'a [[u32; 4]],
    narrow: &'a [[u16; 4]],
    blocks: &'a [BlockIds],
    is_lent: bool,
    row_from_cell: Option<&'a [u32]>,
    last_vertex: u32,
}

/// A cell's vertices as they stand in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TetRow<'a> {
    /// Those of vertices, all of them.
    Whole(&'a [u32; 4]),
    /// Not checked yet.
    Wide(&'a [u32; 4]),
    /// Neither checked nor in order.
    Lent(&'a [u32; 4]),
    /// Counted from a base.
    Narrow(&'a [u16; 4], u32),
}

impl TetRow<'_> {
    /// Its first byte, for what needs to know where it is.
    #[inline]
    pub(crate) fn first_byte(&self) -> &u8 {
        match *self {
            Self::Whole(row) | Self::Wide(row) | Self::Lent(row) => &bytemuck::bytes_of(row)[0],
            Self::Narrow(row, _) => &bytemuck::bytes_of(row)[0],
        }
    }
}

impl<'a> TetsView<'a> {
    /// The vertices of cell `cell`.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn get(&self, cell: usize) -> [u32; 4] {
        match self.row(cell) {
            TetRow::Whole(row) => *row,
            TetRow::Wide(row) => in_range(*row, self.last_vertex),
            TetRow::Lent(row) => ascending(in_range(*row, self.last_vertex)),
            TetRow::Narrow(row, base) => from_base(*row, base, self.last_vertex),
        }
    }

    /// Where the vertices of cell `cell` stand in memory.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub(crate) fn row(&self, cell: usize) -> TetRow<'a> {
        let Some(&BlockIds { start, base }) = self.blocks.get(cell / Dataset::BLOCK_CELLS) else {
            if self.is_lent {
                return TetRow::Lent(&self.wide[self.row_from_cell.map_or(cell, |rows| rows[cell] as usize)]);
            }
            return TetRow::Whole(&self.wide[cell]);
        };
        let (first, cell) = (start as usize * BlockIds::UNIT_BYTES, cell % Dataset::BLOCK_CELLS);
        if base == BlockIds::WIDE {
            TetRow::Wide(&self.wide[first / 16 + cell])
        } else {
            TetRow::Narrow(&self.narrow[first / 8 + cell], base)
        }
    }

    /// The first `cells` cells of block `block`, or what follows them too.
    #[inline]
    fn block(&self, block: usize, cells: usize) -> BlockTets<'a> {
        let Self { is_lent, last_vertex, .. } = *self;
        if self.blocks.is_empty() {
            let of_block = block * Dataset::BLOCK_CELLS..block * Dataset::BLOCK_CELLS + cells;
            let (wide, row_from_cell) = match self.row_from_cell {
                None => (&self.wide[of_block], None),
                Some(rows) => (self.wide, Some(&rows[of_block])),
            };
            return BlockTets { wide, narrow: &[], is_lent, row_from_cell, base: BlockIds::WIDE, last_vertex };
        }
        let row_from_cell = None;
        let BlockIds { start, base } = self.blocks[block];
        let first = start as usize * BlockIds::UNIT_BYTES;
        if base == BlockIds::WIDE {
            BlockTets { wide: &self.wide[first / 16..], narrow: &[], is_lent, row_from_cell, base, last_vertex }
        } else {
            BlockTets { wide: &[], narrow: &self.narrow[first / 8..], is_lent, row_from_cell, base, last_vertex }
        }
    }
}

/// The vertices of a cell in order; a sorting network.
#[inline]
fn ascending([a, b, c, d]: [u32; 4]) -> [u32; 4] {
    let order = |a: u32, b: u32| (a.min(b), a.max(b));
    let ((a, b), (c, d)) = (order(a, b), order(c, d));
    let ((a, c), (b, d)) = (order(a, c), order(b, d));
    let (b, c) = order(b, c);
    [a, b, c, d]
}

/// The vertices of a cell, the last vertex for any number beyond.
#[inline]
fn in_range([a, b, c, d]: [u32; 4], last: u32) -> [u32; 4] {
    [a.min(last), b.min(last), c.min(last), d.min(last)]
}

/// The same of a cell whose numbers count from `base`.
#[inline]
fn from_base([a, b, c, d]: [u16; 4], base: u32, last: u32) -> [u32; 4] {
    let of = |v: u16| u32::from(v).saturating_add(base);
    in_range([of(a), of(b), of(c), of(d)], last)
}

/// The cells of one block.
#[derive(Clone, Copy, Debug)]
pub struct BlockTets<'a> {
    wide: &'a [[u32; 4]],
    narrow: &'a [[u16; 4]],
    is_lent: bool,
    /// Of the cells of the block; then `wide` is of all.
    row_from_cell: Option<&'a [u32]>,
    base: u32,
    last_vertex: u32,
}

impl<'a> BlockTets<'a> {
    pub(super) fn new(tets: &'a Tets, block: usize, cells: usize) -> Self {
        let all = tets.view().block(block, cells);
        if all.row_from_cell.is_some() {
            return all;
        }
        let first = |len: usize| cells.min(len);
        Self { wide: &all.wide[..first(all.wide.len())], narrow: &all.narrow[..first(all.narrow.len())], ..all }
    }

    /// How many cells there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.row_from_cell.map_or(self.wide.len().max(self.narrow.len()), <[u32]>::len)
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices of the block's cell `cell`.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn get(&self, cell: usize) -> [u32; 4] {
        if self.is_lent {
            let row = self.row_from_cell.map_or(cell, |rows| rows[cell] as usize);
            ascending(in_range(self.wide[row], self.last_vertex))
        } else if self.base == BlockIds::WIDE {
            in_range(self.wide[cell], self.last_vertex)
        } else {
            from_base(self.narrow[cell], self.base, self.last_vertex)
        }
    }

    /// The vertices of every cell, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = [u32; 4]> + '_ {
        (0..self.len()).map(|cell| self.get(cell))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lent_rows_are_read_in_order_whichever_way_they_run() {
        for turn in 0..24_usize {
            let (mut left, mut rest) = (vec![3, 5, 8, 13], turn);
            let row: [u32; 4] = std::array::from_fn(|i| {
                let digit = rest % (4 - i);
                rest /= 4 - i;
                left.remove(digit)
            });
            assert_eq!(ascending(row), [3, 5, 8, 13], "{row:?}");
        }
        let rows: Vec<[u32; 4]> = vec![[3, 2, 1, 0], [1, 4, 3, 9], [7, 6, 5, 4]];
        let all = Tets::lent(rows.clone().into(), None, 8);
        assert_eq!(all.iter().collect::<Vec<_>>(), [[0, 1, 2, 3], [1, 3, 4, 7], [4, 5, 6, 7]], "9 reads as the last");
        let some = Tets::lent(rows.into(), Some(vec![2, 0].into()), 8);
        assert_eq!(some.iter().collect::<Vec<_>>(), [[4, 5, 6, 7], [0, 1, 2, 3]]);
        assert_eq!((BlockTets::new(&some, 0, 2).get(1), some.owned_bytes()), ([0, 1, 2, 3], 3 * 16 + 8));
    }
}
