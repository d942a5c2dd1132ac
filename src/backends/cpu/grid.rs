//! The tiles that a cell's box touches.
//!
//! In: pixel boxes. Out: boxes of tiles, packed in a word where they are small; the numbers of their tiles.

use std::ops::Range;

use crate::backends::tiles::TILE_PX;
pub(super) use crate::backends::tiles::TileGrid;
use crate::stages::footprints::PixelBox;

/// Side of a tile in pixels.
pub(super) const TILE: u32 = TILE_PX;

/// Columns `x0..x1` and rows `y0..y1` of tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TileBox {
    pub(super) x0: u16,
    pub(super) x1: u16,
    pub(super) y0: u16,
    pub(super) y1: u16,
}

impl TileBox {
    /// The tiles that a box of pixels touches.
    #[inline]
    pub(super) fn around(pixels: PixelBox) -> Self {
        let side = TILE as u16;
        Self { x0: pixels.x0 / side, x1: pixels.x1.div_ceil(side), y0: pixels.y0 / side, y1: pixels.y1.div_ceil(side) }
    }

    /// How many tiles it holds.
    #[inline]
    pub(super) fn len(self) -> usize {
        (self.x1 - self.x0) as usize * (self.y1 - self.y0) as usize
    }

    /// Their numbers, row by row.
    #[inline]
    pub(super) fn tiles(self, grid: &TileGrid) -> impl Iterator<Item = usize> {
        let Self { x0, x1, y0, y1 } = self;
        (y0..y1).flat_map(move |y| (x0..x1).map(move |x| grid.number(x.into(), y.into())))
    }

    #[inline]
    pub(super) fn touches(self, column: u32, row: u32) -> bool {
        (u32::from(self.x0)..u32::from(self.x1)).contains(&column) && self.touches_rows(&(row..row + 1))
    }

    #[inline]
    pub(super) fn touches_rows(self, rows: &Range<u32>) -> bool {
        u32::from(self.y0) < rows.end && u32::from(self.y1) > rows.start
    }

    /// The part of it in some rows, which it touches.
    #[inline]
    pub(super) fn in_rows(self, rows: &Range<u32>) -> Self {
        // A picture has at most 1,024 rows of tiles.
        Self { y0: self.y0.max(rows.start as u16), y1: self.y1.min(rows.end as u16), ..self }
    }
}

/// A box of at most 64 tiles: first column and row in ten bits each (a picture has at most 1,024 of both), one less than
/// width and height in six bits each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SmallTileBox(u32);

impl SmallTileBox {
    /// Most tiles that one holds.
    pub(super) const MAX_TILES: usize = 64;

    /// Packs a box of at least one and at most [`Self::MAX_TILES`] tiles.
    #[inline]
    pub(super) fn new(tiles: TileBox) -> Self {
        debug_assert!((1..=Self::MAX_TILES).contains(&tiles.len()) && tiles.x1 <= 1024 && tiles.y1 <= 1024);
        let [x, y, width, height] =
            [tiles.x0, tiles.y0, tiles.x1 - tiles.x0 - 1, tiles.y1 - tiles.y0 - 1].map(u32::from);
        Self(x | y << 10 | width << 20 | height << 26)
    }

    /// The box.
    #[inline]
    pub(super) fn get(self) -> TileBox {
        let bits = |from: u32, n: u32| (self.0 >> from & ((1 << n) - 1)) as u16;
        let (x0, y0) = (bits(0, 10), bits(10, 10));
        TileBox { x0, x1: x0 + bits(20, 6) + 1, y0, y1: y0 + bits(26, 6) + 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_boxes_come_back() {
        for (x0, y0) in [(0, 0), (1023, 1023), (3, 959), (700, 1)] {
            for (width, height) in [(1, 1), (64, 1), (1, 64), (8, 8), (9, 7)] {
                let tiles = TileBox { x0, x1: x0 + width, y0, y1: y0 + height };
                if tiles.x1 <= 1024 && tiles.y1 <= 1024 {
                    assert_eq!(SmallTileBox::new(tiles).get(), tiles);
                }
            }
        }
    }

    #[test]
    fn boxes_in_rows() {
        let tiles = TileBox { x0: 2, x1: 4, y0: 3, y1: 6 };
        let touched: Vec<_> = (0..8).map(|row| tiles.touches_rows(&(row..row + 1))).collect();
        assert_eq!(touched, [false, false, false, true, true, true, false, false]);
        assert_eq!(tiles.in_rows(&(4..9)), TileBox { y0: 4, ..tiles });
        let grid = TileGrid { columns: 0..5, rows: 0..8 };
        assert_eq!(tiles.in_rows(&(0..4)).tiles(&grid).collect::<Vec<_>>(), [17, 18]);
        assert_eq!(grid.tiles(&(3..5)), 15..25);
        let grid = TileGrid { columns: 2..4, rows: 3..8 };
        assert_eq!(tiles.in_rows(&(0..5)).tiles(&grid).collect::<Vec<_>>(), [0, 1, 2, 3]);
    }
}
