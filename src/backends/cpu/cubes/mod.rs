//! Cubes of a volume by footprints: tiles, and in each a ray's way through boxes whose planes are a grid's.
//!
//! In: a [`Frame`] with [`CubesInView`](crate::stages::CubesInView), farthest first. Out: the picture. `bins`: the tiles of each cube's
//! pixel box, in the order of the cubes. `tile`: a ray in grid coordinates crosses plane x = i at the depth (i − o)/d, o its origin and d
//! its direction along x: six such depths a cube and ray, no set-up, no case, no cut at the near plane, the eye anywhere. Planes that
//! cubes share give both the same bits, so that segments meet. Cubes come in order: nothing is sorted or checked; nearest first, a
//! block ends when nothing shows through. `linear`: values between points along a ray.

mod bins;
mod linear;
mod tile;

use std::sync::Mutex;
use std::time::Instant;

use rayon::prelude::*;

pub(super) use self::bins::BinnedCube;
use self::bins::CubeBins;
use self::tile::CubeRays;
pub(super) use self::tile::CubeTile;
use super::bins::lock;
use super::dispatch::{InstructionSet, Kernels};
use super::grid::TileGrid;
use super::tile::place_of;
use super::tile_source::{LentTile, TileSource};
use crate::backends::{Counts, Frame};
use crate::image::Image;
use crate::optics::Optics;
use crate::profile::Profile;

/// Composites cubes tile by tile; keeps its memory between frames.
#[derive(Default)]
pub struct CubeCompositor {
    bins: CubeBins,
    instruction_set: Option<InstructionSet>,
}

impl CubeCompositor {
    /// Draws with the kernels of `set` where the processor has it; the picture is the same.
    pub fn set_instruction_set(&mut self, set: Option<InstructionSet>) {
        self.instruction_set = set;
    }

    /// Draws the cubes of one frame, which has some.
    pub fn draw<O: Optics>(&mut self, frame: &Frame, optics: &O, profile: &mut Profile) -> (Image, Counts) {
        let region = frame.view.region;
        let [width, height] = region.size_px();
        let mut image = Image::filled(width, height, optics.pixel(O::CLEAR));
        let Some(cubes) = &frame.cubes else { return (image, Counts::default()) };

        let start = Instant::now();
        let grid = TileGrid::new(frame.view);
        let drawn = self.bins.fill(cubes, frame.view, &grid);
        profile.add("footprints", start.elapsed(), size_of_val(cubes.cubes) as u64);

        let start = Instant::now();
        let kernels = Kernels::new(self.instruction_set);
        let bins = &self.bins;
        let rays = CubeRays::new(cubes, frame.view);
        let tiles = Mutex::new(TileSource::new(region, &grid, &grid.rows, &mut image.pixels, &mut []));
        let next = || lock(&tiles).next();
        (0..rayon::current_num_threads()).into_par_iter().with_max_len(1).for_each(|_| {
            let mut tile = CubeTile::default();
            let mut nearest_first = Vec::new();
            while let Some(LentTile { tile: number, first, rows, .. }) = next() {
                bins.cubes_of(number, &mut nearest_first);
                if nearest_first.is_empty() {
                    continue;
                }
                let _span = tracing::trace_span!("composite", tile = number).entered();
                tile.begin::<O>(&rays, grid.origin_px(number));
                kernels.cubes(&mut tile, frame, optics, &nearest_first);
                for (y, row) in rows.into_iter().enumerate() {
                    for (x, pixel) in row.iter_mut().enumerate() {
                        *pixel = optics.pixel(tile.contribution(place_of(first[0] + x, first[1] + y)));
                    }
                }
            }
        });
        drop(tiles);
        profile.add("composite", start.elapsed(), bins.entries() * size_of::<BinnedCube>() as u64);
        let all = cubes.cubes.len() as u64;
        (image, Counts { drawn, culled_outside: all - drawn, ..Counts::default() })
    }
}
