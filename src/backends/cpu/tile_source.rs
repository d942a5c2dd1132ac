//! The tiles of some rows of tiles with their part of the picture, one after the other, for whoever asks next.

use std::slice::ChunksMut;

use arrayvec::ArrayVec;

use super::grid::TILE;

type Pixel = [f32; 4];

/// A tile and the pixels it lends, row by row.
pub(super) type LentTile<'a> = (usize, ArrayVec<&'a mut [Pixel], { TILE as usize }>);

/// Hands out tiles, left to right, top to bottom.
pub(super) struct TileSource<'a> {
    width: usize,
    /// Rows of tiles to come.
    below: ChunksMut<'a, Pixel>,
    /// The rows of pixels of the row at hand, from the next tile on.
    rows: ArrayVec<ChunksMut<'a, Pixel>, { TILE as usize }>,
    next: usize,
}

impl<'a> TileSource<'a> {
    /// The tiles from `first_tile` on, which begins a row, of the pixels from its first row on.
    pub(super) fn new(pixels: &'a mut [Pixel], width: usize, first_tile: usize) -> Self {
        let below = pixels.chunks_mut((width * TILE as usize).max(1));
        Self { width, below, rows: ArrayVec::new(), next: first_tile }
    }
}

impl<'a> Iterator for TileSource<'a> {
    type Item = LentTile<'a>;

    fn next(&mut self) -> Option<LentTile<'a>> {
        loop {
            let lent: ArrayVec<_, { TILE as usize }> = self.rows.iter_mut().filter_map(Iterator::next).collect();
            if !lent.is_empty() {
                self.next += 1;
                return Some((self.next - 1, lent));
            }
            let row_of_tiles = self.below.next()?;
            self.rows = row_of_tiles.chunks_mut(self.width).map(|row| row.chunks_mut(TILE as usize)).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_is_lent_once_to_its_tile() {
        for (width, height) in [(1, 1), (32, 32), (33, 31), (70, 65), (31, 96)] {
            let mut pixels = vec![[0.0; 4]; width * height];
            for (tile, rows) in TileSource::new(&mut pixels, width, 100) {
                for row in rows {
                    for pixel in row {
                        pixel[0] += tile as f32;
                        pixel[1] += 1.0;
                    }
                }
            }
            let columns = width.div_ceil(32);
            for (i, pixel) in pixels.iter().enumerate() {
                let tile = 100 + i / width / 32 * columns + i % width / 32;
                assert_eq!(pixel[..2], [tile as f32, 1.0], "{width}x{height}, pixel {i}");
            }
        }
    }
}
