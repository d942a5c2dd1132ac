//! Hexahedra in a tile: which rays meet one, and the segments they have in it.
//!
//! In: a [`HexFootprint`]. Out: rays and segments in [`Hits`], as a tetrahedron has them, which are shaded and sent the same way.
//! A first pass over the blocks finds entry and exit and through which triangles they go; a second, over the rays alone, takes
//! the scalar from these triangles: the field of neighbours agrees on their face.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::hits::{Hits, NO_RAYS, Packed, get, put};
use super::simd::Simd;
use super::tile::{BLOCK, BLOCKS, BLOCKS_A_SIDE, LaneGrid, TileFrame, origin_of};
use crate::optics::lanes::{mask, max, min, select};
use crate::optics::{LANES, Lanes, Segments};
use crate::stages::footprints::hexahedra::{HexFootprint, Surface, TRIANGLES};

/// What of a hexahedron's rays its triangles need to know; kept between cells and frames.
pub(super) struct HexHits {
    /// Per ray: the triangles met at entry and exit, column and row in the tile.
    enter_through: Box<Packed>,
    leave_through: Box<Packed>,
    x: Box<Packed>,
    y: Box<Packed>,
    /// The surfaces of the cell at hand.
    fronts: Box<[SurfaceLanes; TRIANGLES]>,
    backs: Box<[SurfaceLanes; TRIANGLES]>,
}

impl Default for HexHits {
    fn default() -> Self {
        let [enter_through, leave_through, x, y] = [(); 4].map(|()| Box::new(NO_RAYS));
        let [fronts, backs] = [(); 2].map(|()| Box::new([SurfaceLanes::default(); TRIANGLES]));
        Self { enter_through, leave_through, x, y, fronts, backs }
    }
}

/// A surface with what its planes add in each lane of a block.
#[derive(Clone, Copy, Default)]
struct SurfaceLanes {
    triangles: [f32; 2],
    planes: [[f32; 3]; 2],
    side: [f32; 3],
    plane_offsets: [Lanes; 2],
    side_offsets: Lanes,
}

impl SurfaceLanes {
    #[inline(always)]
    fn set(&mut self, lanes: &LaneGrid, cell: &HexFootprint, surface: &Surface) {
        for (k, triangle) in surface.triangles.into_iter().enumerate() {
            let lane = usize::from(triangle) % LANES;
            let [c, x, y] = [cell.planes[0][lane], cell.planes[1][lane], cell.planes[2][lane]];
            self.triangles[k] = f32::from(triangle);
            self.planes[k] = [c, x, y];
            self.plane_offsets[k] = lanes.offsets(x, y);
        }
        self.side = surface.side;
        self.side_offsets = lanes.offsets(surface.side[1], surface.side[2]);
    }

    /// Inverse depth along the rays of the block at `origin`, and the triangle that has it.
    #[inline(always)]
    fn at(&self, origin: [f32; 2]) -> (Lanes, Lanes) {
        let at_block = |[c, x, y]: [f32; 3]| c + x * origin[0] + y * origin[1];
        let (side, first, second) = (at_block(self.side), at_block(self.planes[0]), at_block(self.planes[1]));
        let (mut v, mut triangle) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let is_second = mask(side + self.side_offsets[i] >= 0.0);
            v[i] = select(is_second, second + self.plane_offsets[1][i], first + self.plane_offsets[0][i]);
            triangle[i] = select(is_second, self.triangles[1], self.triangles[0]);
        }
        (v, triangle)
    }
}

/// Finds the rays that meet a hexahedron with a simple outline and cuts them to segments, but for the blocks in `done`.
#[inline(always)]
pub(super) fn meet(hits: &mut Hits, tile: &TileFrame, cell: &HexFootprint, simd: impl Simd, done: u64) {
    hits.find_hexahedron(tile, cell, simd, done);
    if tile.is_perspective() {
        hits.cut_hexahedron::<true>(cell);
    } else {
        hits.cut_hexahedron::<false>(cell);
    }
}

impl Hits {
    #[inline(always)]
    fn find_hexahedron(&mut self, tile: &TileFrame, cell: &HexFootprint, simd: impl Simd, done: u64) {
        let lanes = &tile.lanes;
        let [x0, x1, y0, y1] = cell.sides;
        let HexHits { fronts, backs, .. } = &mut self.of_hexahedron;
        for (of, surface) in fronts.iter_mut().zip(&cell.fronts).chain(backs.iter_mut().zip(&cell.backs)) {
            of.set(lanes, cell, surface);
        }
        let (mut blocks, mut rays) = (0, 0);
        for block_y in y0 / BLOCK..y1.div_ceil(BLOCK) {
            for block_x in x0 / BLOCK..x1.div_ceil(BLOCK) {
                let block = (block_y * BLOCKS_A_SIDE + block_x) % BLOCKS;
                if done >> block & 1 == 1 {
                    continue;
                }
                let origin = origin_of(block);
                let (mut v_enter, mut enter_through) = ([f32::INFINITY; LANES], [0.0; LANES]);
                for surface in &self.of_hexahedron.fronts[..cell.fronts.len()] {
                    let (v, triangle) = surface.at(origin);
                    for i in 0..LANES {
                        enter_through[i] = select(mask(v[i] < v_enter[i]), triangle[i], enter_through[i]);
                        v_enter[i] = min(v[i], v_enter[i]);
                    }
                }
                let (mut v_leave, mut leave_through) = ([f32::NEG_INFINITY; LANES], [0.0; LANES]);
                for surface in &self.of_hexahedron.backs[..cell.backs.len()] {
                    let (v, triangle) = surface.at(origin);
                    for i in 0..LANES {
                        leave_through[i] = select(mask(v[i] > v_leave[i]), triangle[i], leave_through[i]);
                        v_leave[i] = max(v[i], v_leave[i]);
                    }
                }
                let mut is_hit = [0; LANES];
                for i in 0..LANES {
                    v_enter[i] = min(v_enter[i], cell.v_max);
                    v_leave[i] = max(v_leave[i], cell.v_min);
                    is_hit[i] = mask(v_enter[i] > v_leave[i]);
                }
                let hit = simd.bits(&is_hit);
                self.begin_block(blocks, block, hit);
                put(&mut self.v_enter, rays, &simd.compress(hit, &v_enter));
                put(&mut self.v_leave, rays, &simd.compress(hit, &v_leave));
                put(&mut self.length_world_per_depth, rays, &simd.compress(hit, &tile.length_world_per_depth[block]));
                if cell.s_min < cell.s_max {
                    let at = |axis: &Lanes, first: f32| axis.map(|offset| first + offset);
                    let of = &mut self.of_hexahedron;
                    put(&mut of.enter_through, rays, &simd.compress(hit, &enter_through));
                    put(&mut of.leave_through, rays, &simd.compress(hit, &leave_through));
                    put(&mut of.x, rays, &simd.compress(hit, &at(&lanes.x, origin[0])));
                    put(&mut of.y, rays, &simd.compress(hit, &at(&lanes.y, origin[1])));
                }
                blocks += usize::from(hit != 0);
                rays += hit.count_ones() as usize;
            }
        }
        self.end_blocks(blocks, rays, cell.v_max);
    }

    #[inline(always)]
    fn cut_hexahedron<const PERSPECTIVE: bool>(&mut self, cell: &HexFootprint) {
        for vector in 0..self.rays.div_ceil(LANES) {
            let of = |packed: &Packed| get(packed, vector * LANES);
            let (v_enter, v_leave) = (of(&self.v_enter), of(&self.v_leave));
            let length_world_per_depth = of(&self.length_world_per_depth);
            let mut cut =
                Segments { enter: [cell.s_min; LANES], leave: [cell.s_min; LANES], length_world: [0.0; LANES] };
            let (mut w_enter, mut w_leave) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                let (v0, v1) = (v_enter[i], v_leave[i]);
                // w1 − w0 = (v0 − v1) / (v0 v1): a difference of reciprocals would cancel.
                let reciprocal = if PERSPECTIVE { 1.0 / (v0 * v1) } else { 1.0 };
                (w_enter[i], w_leave[i]) = if PERSPECTIVE { (v1 * reciprocal, v0 * reciprocal) } else { (-v0, -v1) };
                cut.length_world[i] = (v0 - v1) * reciprocal * length_world_per_depth[i];
            }
            if cell.s_min < cell.s_max {
                let hex = &self.of_hexahedron;
                let at = [of(&hex.x), of(&hex.y)];
                scalars::<PERSPECTIVE>(cell, &cell.fronts, &of(&hex.enter_through), at, &w_enter, &mut cut.enter);
                scalars::<PERSPECTIVE>(cell, &cell.backs, &of(&hex.leave_through), at, &w_leave, &mut cut.leave);
            }
            self.segments[vector] = cut;
        }
    }
}

/// The values on the triangles `through` of `surfaces`, at columns and rows `at` and depths `w`.
#[inline(always)]
fn scalars<const PERSPECTIVE: bool>(
    cell: &HexFootprint,
    surfaces: &[Surface],
    through: &Lanes,
    [x, y]: [Lanes; 2],
    w: &Lanes,
    s: &mut Lanes,
) {
    let mut of_triangle = |triangle: u8| {
        let lane = usize::from(triangle) % LANES;
        let [c, dx, dy] = [cell.varying[0][lane], cell.varying[1][lane], cell.varying[2][lane]];
        let constant = cell.constant[lane];
        for i in 0..LANES {
            let varying = c + dx * x[i] + dy * y[i];
            let value = if PERSPECTIVE { constant + varying * w[i] } else { varying + constant * w[i] };
            // A needle's gradient is steep: rounding must not leave the cell's range.
            let value = min(max(value, cell.s_min), cell.s_max);
            s[i] = select(mask(through[i].to_bits() == f32::from(triangle).to_bits()), value, s[i]);
        }
    };
    for surface in surfaces {
        let [first, second] = surface.triangles;
        of_triangle(first);
        if second != first {
            of_triangle(second);
        }
    }
}
