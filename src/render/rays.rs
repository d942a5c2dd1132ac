//! Rays followed from cell to cell: when they are, and what becomes of tiles in which cells overlap.

use super::scene::SceneBands;
use super::{CpuMethod, Renderer, Scene};
use crate::backends::cpu::{FollowedRays, Mates};
use crate::backends::{Counts, Frame, TileGrid};
use crate::error::Result;
use crate::image::Image;
use crate::optics::Optics;
use crate::profile::Profile;

impl Renderer {
    /// What rays need to be followed through a scene, where that is asked for and can be.
    pub(super) fn mates<'a>(&self, scene: &'a Scene, has_geometry: bool, profile: &mut Profile) -> Option<&'a Mates> {
        #[cfg(feature = "gpu")]
        if self.gpu.is_some() {
            return None;
        }
        let options = &self.options;
        let fits = !has_geometry && options.memory_bytes.is_none() && scene.field.invalid == 0;
        let has_band_arrays = matches!(&scene.bands, Some(SceneBands::Arrays(_)));
        // Light and arrays of bands are looked up by cell, of which sixteen rays meet several at once.
        let needs_cells = has_band_arrays || self.lighting.is_some();
        if options.cpu_method != CpuMethod::Rays || !fits || needs_cells {
            return None;
        }
        scene.mates(&self.control, profile)
    }

    /// Draws the tiles again in which rays found cells that overlap: footprints put every fragment in order.
    pub(super) fn with_overlaps<O: Optics>(
        &mut self,
        frame: &Frame,
        optics: &O,
        FollowedRays { mut image, mut counts, is_out_of_order }: FollowedRays,
        profile: &mut Profile,
    ) -> Result<(Image, Counts)> {
        counts.tiles_redone = is_out_of_order.iter().filter(|&&is_redone| is_redone).count() as u64;
        if counts.tiles_redone > 0 {
            let frame = Frame { tiles: Some(&is_out_of_order), ..*frame };
            let (again, _) = self.tiles.draw(&frame, optics, profile)?;
            put_tiles(&mut image, &again, &frame, &is_out_of_order);
        }
        Ok((image, counts))
    }
}

/// Copies the tiles that `are_put` from one picture of the frame to another.
fn put_tiles(to: &mut Image, from: &Image, frame: &Frame, are_put: &[bool]) {
    let (region, grid) = (frame.view.region, TileGrid::new(frame.view));
    for tile in (0..grid.len()).filter(|&tile| are_put[tile]) {
        let of_tile = grid.pixels_in(region, tile);
        for y in of_tile.y0..of_tile.y1 {
            let first = ((y - region.y0) * to.width + of_tile.x0 - region.x0) as usize;
            let row = first..first + (of_tile.x1 - of_tile.x0) as usize;
            to.pixels[row.clone()].copy_from_slice(&from.pixels[row]);
        }
    }
}
