//! Parts of rays in a cell that a ray may meet more than once, ray by ray.
//!
//! In: the parts, rays in rows. Out: the n-th of each ray together, in [`Hits`].

use super::hits::Hits;
use super::tile::{BLOCK, BLOCKS_A_SIDE, TileFrame, origin_of};
use crate::optics::LANES;

/// A part of a ray inside the cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Column and row in the tile.
    pub(super) pixel: [u8; 2],
    /// Which of its ray's parts it is.
    pub(super) nth: u8,
    /// Inverse depths of its ends, and the values there.
    pub(super) v: [f32; 2],
    pub(super) s: [f32; 2],
}

/// The parts of some rays in one cell; kept between cells and frames.
#[derive(Debug, Default)]
pub(super) struct Parts {
    /// The first parts of all rays, the second ones, and so on.
    by_nth: Vec<Vec<Part>>,
    /// Parts of the ray that has most.
    most: u8,
}

impl Parts {
    pub(super) fn clear(&mut self) {
        self.by_nth.iter_mut().for_each(Vec::clear);
        self.most = 0;
    }

    /// Adds a part; those of a block come by ascending lane.
    pub(super) fn push(&mut self, part: Part) {
        self.most = self.most.max(part.nth.saturating_add(1));
        if self.by_nth.len() <= usize::from(part.nth) {
            self.by_nth.resize_with(usize::from(part.nth) + 1, Vec::new);
        }
        self.by_nth[usize::from(part.nth)].push(part);
    }

    /// How many parts the ray with most has.
    pub(super) fn most(&self) -> u8 {
        self.most
    }

    /// Puts the `nth` part of each ray into `hits`, but for the blocks in `done`.
    #[inline(never)]
    pub(super) fn put(&self, nth: u8, tile: &TileFrame, hits: &mut Hits, done: u64) {
        let parts = &self.by_nth[usize::from(nth)];
        let (mut blocks, mut rays) = (0, 0);
        for block in 0..BLOCKS_A_SIDE * BLOCKS_A_SIDE {
            let [x, y] = origin_of(block).map(|first| first as usize);
            let lane_of = |part: &Part| {
                let [column, row] = part.pixel.map(usize::from);
                let is_in = (x..x + BLOCK).contains(&column) && (y..y + BLOCK).contains(&row);
                is_in.then(|| (row - y) * BLOCK + column - x)
            };
            if done >> block & 1 == 1 || !parts.iter().any(|part| lane_of(part).is_some()) {
                continue;
            }
            let mut lanes = 0_u16;
            // Parts stand in rows: by ascending lane within a block.
            for part in parts {
                let Some(lane) = lane_of(part) else { continue };
                lanes |= 1 << lane;
                hits.put_ray(rays, part.v, part.s, tile.length_world_per_depth[block][lane], tile.is_perspective());
                rays += 1;
            }
            hits.begin_block(blocks, block, lanes);
            blocks += 1;
        }
        hits.end_parts(blocks, rays);
    }
}

const _: () = assert!(LANES == BLOCK * BLOCK);
