//! `Tets`: the vertices of all tetrahedra, as a slice, or in blocks of 16-bit and of 32-bit numbers as a container holds them.

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
        Ok(Self { wide, narrow, blocks, len, last_vertex: (vertices - 1) as u32 })
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
        TetsView { wide: &self.wide, narrow: &self.narrow, blocks: &self.blocks, last_vertex: self.last_vertex }
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
        self.wide.owned_bytes() + self.blocks.owned_bytes()
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
        Self { wide: tets.into(), narrow: Vec::new().into(), blocks: Vec::new().into(), len, last_vertex: u32::MAX }
    }
}

/// [`Tets`] as slices.
#[derive(Clone, Copy, Debug)]
pub struct TetsView<'a> {
    wide: &'a [[u32; 4]],
    narrow: &'a [[u16; 4]],
    blocks: &'a [BlockIds],
    last_vertex: u32,
}

/// A cell's vertices as they stand in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TetRow<'a> {
    /// Those of vertices, all of them.
    Whole(&'a [u32; 4]),
    /// Not checked yet.
    Wide(&'a [u32; 4]),
    /// Counted from a base.
    Narrow(&'a [u16; 4], u32),
}

impl TetRow<'_> {
    /// Its first byte, for what needs to know where it is.
    #[inline]
    pub(crate) fn first_byte(&self) -> &u8 {
        match *self {
            Self::Whole(row) | Self::Wide(row) => &bytemuck::bytes_of(row)[0],
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
        let last_vertex = self.last_vertex;
        if self.blocks.is_empty() {
            let first = block * Dataset::BLOCK_CELLS;
            return BlockTets {
                wide: &self.wide[first..first + cells],
                narrow: &[],
                base: BlockIds::WIDE,
                last_vertex,
            };
        }
        let BlockIds { start, base } = self.blocks[block];
        let first = start as usize * BlockIds::UNIT_BYTES;
        if base == BlockIds::WIDE {
            BlockTets { wide: &self.wide[first / 16..], narrow: &[], base, last_vertex }
        } else {
            BlockTets { wide: &[], narrow: &self.narrow[first / 8..], base, last_vertex }
        }
    }
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
    base: u32,
    last_vertex: u32,
}

impl<'a> BlockTets<'a> {
    pub(super) fn new(tets: &'a Tets, block: usize, cells: usize) -> Self {
        let all = tets.view().block(block, cells);
        let first = |len: usize| cells.min(len);
        Self { wide: &all.wide[..first(all.wide.len())], narrow: &all.narrow[..first(all.narrow.len())], ..all }
    }

    /// How many cells there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.wide.len().max(self.narrow.len())
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
        if self.base == BlockIds::WIDE {
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
