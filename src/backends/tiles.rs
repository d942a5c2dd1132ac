//! `TileGrid`: the tiles of a picture that its region touches.
//!
//! In: a view. Out: tiles as numbers, row by row, from 0 on. Columns and rows of tiles are counted in the whole picture, so that
//! a tile of a region is drawn to the bits that it has there; only those that the region touches have a number, and take memory.

use std::ops::Range;

use crate::camera::Region;
use crate::stages::View;

/// Side of a tile in pixels: what the tile compositor draws at once, and what is drawn again.
pub(crate) const TILE_PX: u32 = 32;

/// Columns and rows of tiles, both in the whole picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct TileGrid {
    pub(crate) columns: Range<u32>,
    pub(crate) rows: Range<u32>,
}

impl TileGrid {
    /// The tiles that the region of `view` touches.
    pub(crate) fn new(view: &View) -> Self {
        Self::around(view.region)
    }

    /// The tiles that `region` touches.
    pub(crate) fn around(Region { x0, y0, x1, y1 }: Region) -> Self {
        let tiles = |first: u32, end: u32| first / TILE_PX..end.div_ceil(TILE_PX);
        Self { columns: tiles(x0, x1), rows: tiles(y0, y1) }
    }

    /// How many tiles there are.
    pub(crate) fn len(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// The tiles of some rows of tiles.
    pub(crate) fn tiles(&self, rows: &Range<u32>) -> Range<usize> {
        self.number(self.columns.start, rows.start)..self.number(self.columns.start, rows.end)
    }

    /// The number of the tile in a column and row, which the region touches.
    #[inline]
    pub(crate) fn number(&self, column: u32, row: u32) -> usize {
        (row - self.rows.start) as usize * self.columns.len() + (column - self.columns.start) as usize
    }

    /// Column and row of a tile.
    pub(crate) fn place(&self, tile: usize) -> [u32; 2] {
        let columns = self.columns.len();
        [self.columns.start + (tile % columns) as u32, self.rows.start + (tile / columns) as u32]
    }

    /// Column and row of the tile's first pixel.
    pub(crate) fn origin_px(&self, tile: usize) -> [u32; 2] {
        self.place(tile).map(|place| place * TILE_PX)
    }

    /// The pixels of a tile that lie in `region`, around which the grid is.
    pub(crate) fn pixels_in(&self, region: Region, tile: usize) -> Region {
        let [x, y] = self.origin_px(tile);
        let (x1, y1) = ((x + TILE_PX).min(region.x1), (y + TILE_PX).min(region.y1));
        Region { x0: x.max(region.x0), y0: y.max(region.y0), x1, y1 }
    }

    /// All pixels of all tiles, as far as the picture reaches.
    pub(crate) fn pixels(&self, [width, height]: [u32; 2]) -> Region {
        let [x0, y0, x1, y1] =
            [self.columns.start, self.rows.start, self.columns.end, self.rows.end].map(|place| place * TILE_PX);
        Region { x0, y0, x1: x1.min(width), y1: y1.min(height) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_numbered_within_the_region_and_placed_in_the_picture() {
        let grid = TileGrid::around(Region { x0: 33, y0: 64, x1: 129, y1: 66 });
        assert_eq!((grid.columns.clone(), grid.rows.clone(), grid.len()), (1..5, 2..3, 4));
        assert_eq!((grid.place(3), grid.origin_px(3), grid.number(4, 2)), ([4, 2], [128, 64], 3));
        assert_eq!((grid.tiles(&(2..3)), grid.tiles(&(2..2))), (0..4, 0..0));
        assert_eq!(grid.pixels([130, 70]), Region { x0: 32, y0: 64, x1: 130, y1: 70 });
        let whole = TileGrid::around(Region::whole([32_768, 32_768]));
        assert_eq!((whole.len(), whole.place(whole.len() - 1)), (1 << 20, [1023, 1023]));
    }

    #[cfg(feature = "gpu")]
    #[test]
    fn pixels_of_tiles_cover_the_region_once() {
        let region = Region { x0: 40, y0: 31, x1: 70, y1: 97 };
        let grid = TileGrid::around(region);
        let of = |tile| grid.pixels_in(region, tile).size_px().map(u64::from);
        assert_eq!((0..grid.len()).map(of).map(|[w, h]| w * h).sum::<u64>(), 30 * 66);
        assert_eq!(grid.pixels_in(region, 1), Region { x0: 64, y0: 31, x1: 70, y1: 32 });
    }
}
