//! The tiles of some rows of tiles with their part of the picture, one after the other, for whoever asks next.

use std::ops::Range;

use arrayvec::ArrayVec;

use super::grid::{TILE, TileGrid};
use crate::camera::Region;

type Pixel = [f32; 4];

/// A tile and the pixels it lends.
pub(super) struct LentTile<'a> {
    pub(super) tile: usize,
    /// Column and row in the tile of the first of them.
    pub(super) first: [usize; 2],
    /// They themselves, row by row.
    pub(super) rows: ArrayVec<&'a mut [Pixel], { TILE as usize }>,
    /// Where its order is kept, if it is.
    pub(super) kept: Option<&'a mut Vec<u32>>,
}

/// Hands out tiles, left to right, top to bottom.
pub(super) struct TileSource<'a> {
    region: Region,
    grid: &'a TileGrid,
    /// The tiles to come.
    tiles: Range<usize>,
    /// Rows of pixels below the row of tiles at hand.
    below: &'a mut [Pixel],
    /// The rows of pixels of the row of tiles at hand, from the next tile on.
    rows: ArrayVec<&'a mut [Pixel], { TILE as usize }>,
    /// Where the orders of the tiles to come are kept; none where they are not.
    kept: std::slice::IterMut<'a, Vec<u32>>,
}

impl<'a> TileSource<'a> {
    /// The tiles of `rows`, some rows of those of `grid`, which are lent `pixels`: those of the region in these rows; and `kept`, one a
    /// tile or none, for their orders.
    pub(super) fn new(
        region: Region,
        grid: &'a TileGrid,
        rows: &Range<u32>,
        pixels: &'a mut [Pixel],
        kept: &'a mut [Vec<u32>],
    ) -> Self {
        Self { region, grid, tiles: grid.tiles(rows), below: pixels, rows: ArrayVec::new(), kept: kept.iter_mut() }
    }
}

impl<'a> Iterator for TileSource<'a> {
    type Item = LentTile<'a>;

    fn next(&mut self) -> Option<LentTile<'a>> {
        let tile = self.tiles.next()?;
        let [x, y] = self.grid.origin_px(tile);
        let (left, top) = (x.max(self.region.x0), y.max(self.region.y0));
        if x <= self.region.x0 {
            let width = self.region.size_px()[0] as usize;
            let height = (y + TILE).min(self.region.y1) - top;
            self.rows = (0..height).filter_map(|_| self.below.split_off_mut(..width)).collect();
        }
        let width = ((x + TILE).min(self.region.x1) - left) as usize;
        let rows = self.rows.iter_mut().filter_map(|row| row.split_off_mut(..width)).collect();
        Some(LentTile { tile, first: [(left - x) as usize, (top - y) as usize], rows, kept: self.kept.next() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_is_lent_once_to_its_tile() {
        for [x0, y0, width, height] in
            [[0, 0, 1, 1], [0, 0, 32, 32], [0, 0, 33, 31], [31, 95, 1, 1], [40, 7, 70, 65], [64, 31, 31, 96]]
        {
            let region = Region { x0, y0, x1: x0 + width, y1: y0 + height };
            let grid = TileGrid::around(region);
            let mut pixels = vec![[0.0; 4]; (width * height) as usize];
            for rows in [grid.rows.start..grid.rows.start + 1, grid.rows.start + 1..grid.rows.end] {
                let start_of = |row: u32| (row * TILE).clamp(y0, y0 + height) - y0;
                let of_rows = [rows.start, rows.end].map(|row| (start_of(row) * width) as usize);
                let source = TileSource::new(region, &grid, &rows, &mut pixels[of_rows[0]..of_rows[1]], &mut []);
                for LentTile { tile, first, rows, .. } in source {
                    for (y, row) in rows.into_iter().enumerate() {
                        for (x, pixel) in row.iter_mut().enumerate() {
                            let [column, row] = [x + first[0], y + first[1]];
                            assert!(column < TILE as usize && row < TILE as usize);
                            let place = (row * TILE as usize + column) as f32;
                            *pixel = [tile as f32, place, pixel[2] + 1.0, 0.0];
                        }
                    }
                }
            }
            for (i, pixel) in pixels.iter().enumerate() {
                let (x, y) = (x0 + i as u32 % width, y0 + i as u32 / width);
                let expected = [grid.number(x / TILE, y / TILE) as f32, (y % TILE * TILE + x % TILE) as f32, 1.0];
                assert_eq!(pixel[..3], expected, "{region}, pixel {i}");
            }
        }
    }
}
