//! Polyhedra in a tile: where rays cross their triangles.
//!
//! In: a [`PolyFootprint`]. Out: rays and segments in [`Hits`], as other cells have them.
//! Where all that counts is how long a ray is in the cell, its length is the sum of the depths at which it leaves less the sum of those
//! at which it enters: in one pass, for any closed cell, convex or not (Roettger and Ertl 2003, without their classes of faces: a
//! triangle's sign says what it adds). Otherwise a ray that enters once and leaves once has one segment; one that crosses more
//! triangles has [`Parts`].
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::hits::{Hits, NO_RAYS, Packed, get, put};
use super::parts::{Part, Parts};
use super::simd::Simd;
use super::tile::{BLOCK, BLOCKS, BLOCKS_A_SIDE, TileFrame, origin_of};
use crate::optics::lanes::{is_any, mask, max, min, select};
use crate::optics::{LANES, Lanes, Segments};
use crate::stages::footprints::polyhedra::PolyFootprint;

/// What of a polyhedron's rays is kept until they are cut; kept between cells and frames.
pub(super) struct PolyHits {
    /// The side functions at the rays of a block.
    sides: Vec<Lanes>,
    /// Per ray: depths at entry and exit from the cell's middle, the values there, and where it ends.
    w_enter: Box<Packed>,
    w_leave: Box<Packed>,
    s_enter: Box<Packed>,
    s_leave: Box<Packed>,
    w_end: Box<Packed>,
    /// The rays that cross more than two triangles.
    pub(super) parts: Parts,
    events: Vec<Event>,
}

impl Default for PolyHits {
    fn default() -> Self {
        let [w_enter, w_leave, s_enter, s_leave, w_end] = [(); 5].map(|()| Box::new(NO_RAYS));
        let (sides, parts, events) = (Vec::new(), Parts::default(), Vec::new());
        Self { sides, w_enter, w_leave, s_enter, s_leave, w_end, parts, events }
    }
}

/// A ray crosses a triangle.
#[derive(Clone, Copy, Debug)]
struct Event {
    w: f32,
    s: f32,
    leaves: bool,
}

/// What the rays of a block have crossed.
struct Crossings {
    /// How often they entered and left; of sums the difference alone.
    entries: [u32; LANES],
    exits: [u32; LANES],
    w_enter: Lanes,
    w_leave: Lanes,
    s_enter: Lanes,
    s_leave: Lanes,
    /// The sum of signed depths.
    length: Lanes,
}

impl Crossings {
    const NONE: Self = Self {
        entries: [0; LANES],
        exits: [0; LANES],
        w_enter: [f32::INFINITY; LANES],
        w_leave: [f32::NEG_INFINITY; LANES],
        s_enter: [0.0; LANES],
        s_leave: [0.0; LANES],
        length: [0.0; LANES],
    };
}

/// Finds the rays that meet a polyhedron and cuts them to segments, but for the blocks in `done`. `IS_SUM`: the cell has one value, and no
/// order counts.
#[inline(always)]
pub(super) fn meet<const IS_SUM: bool>(
    hits: &mut Hits,
    tile: &TileFrame,
    cell: &PolyFootprint,
    simd: impl Simd,
    done: u64,
) {
    let [x0, x1, y0, y1] = cell.sides;
    let near = tile.frame.view.near - cell.w_middle;
    let far = tile.frame.view.far - cell.w_middle;
    hits.of_polyhedron.parts.clear();
    hits.of_polyhedron.sides.resize(cell.edges.len(), [0.0; LANES]);
    let (mut blocks, mut rays) = (0, 0);
    for block_y in y0 / BLOCK..y1.div_ceil(BLOCK) {
        for block_x in x0 / BLOCK..x1.div_ceil(BLOCK) {
            let block = (block_y * BLOCKS_A_SIDE + block_x) % BLOCKS;
            if done >> block & 1 == 1 {
                continue;
            }
            let mut end = [far; LANES];
            if let Some(limits) = &tile.limits {
                for i in 0..LANES {
                    end[i] = min(far, depth_of(limits[block][i], tile.is_perspective()) - cell.w_middle);
                }
            }
            let found = cross::<IS_SUM>(tile, cell, &mut hits.of_polyhedron.sides, block, (near, &end));
            let (mut is_hit, mut is_many) = ([0; LANES], [0; LANES]);
            for i in 0..LANES {
                let (entries, exits) = (found.entries[i], found.exits[i]);
                if IS_SUM {
                    is_many[i] = mask(entries != exits);
                    is_hit[i] = mask(found.length[i] > cell.w_least) & !is_many[i];
                } else {
                    let is_one = mask(entries == 1) & mask(exits == 1);
                    is_many[i] = mask(entries + exits > 0) & !is_one;
                    let (w_enter, w_leave) = (max(found.w_enter[i], near), min(found.w_leave[i], end[i]));
                    is_hit[i] = is_one & mask(w_leave - w_enter > cell.w_least);
                }
            }
            if is_any(&is_many) {
                let of = &mut hits.of_polyhedron;
                for i in (0..LANES).filter(|&i| is_many[i] != 0) {
                    of.find_parts(tile, cell, (block, i), [near, end[i]]);
                }
            }
            let hit = simd.bits(&is_hit);
            if hit == 0 {
                continue;
            }
            hits.begin_block(blocks, block, hit);
            put(&mut hits.length_world_per_depth, rays, &simd.compress(hit, &tile.length_world_per_depth[block]));
            let of = &mut hits.of_polyhedron;
            if IS_SUM {
                put(&mut of.w_leave, rays, &simd.compress(hit, &found.length));
            } else {
                put(&mut of.w_enter, rays, &simd.compress(hit, &found.w_enter));
                put(&mut of.w_leave, rays, &simd.compress(hit, &found.w_leave));
                put(&mut of.w_end, rays, &simd.compress(hit, &end));
                if cell.s_min < cell.s_max {
                    put(&mut of.s_enter, rays, &simd.compress(hit, &found.s_enter));
                    put(&mut of.s_leave, rays, &simd.compress(hit, &found.s_leave));
                }
            }
            blocks += 1;
            rays += hit.count_ones() as usize;
        }
    }
    hits.end_blocks(blocks, rays, cell.v_max);
    if IS_SUM {
        hits.cut_sums(cell);
    } else {
        hits.cut_polyhedron(cell, near, tile.is_perspective());
    }
}

/// The depth of an inverse depth; infinite where a ray goes on.
#[inline(always)]
fn depth_of(v: f32, is_perspective: bool) -> f32 {
    let depth = if is_perspective { 1.0 / v } else { -v };
    if v > f32::NEG_INFINITY { depth } else { f32::INFINITY }
}

/// All triangles against the rays of a block; depths of sums are cut to `range`.
#[inline(always)]
fn cross<const IS_SUM: bool>(
    tile: &TileFrame,
    cell: &PolyFootprint,
    sides: &mut [Lanes],
    block: usize,
    (near, end): (f32, &Lanes),
) -> Crossings {
    let [x, y] = origin_of(block);
    for (side, &[c, dx, dy]) in sides.iter_mut().zip(&cell.edges) {
        let at_block = c + dx * x + dy * y;
        for ((side, x), y) in side.iter_mut().zip(&tile.lanes.x).zip(&tile.lanes.y) {
            *side = at_block + (dx * x + dy * y);
        }
    }
    let mut found = Crossings::NONE;
    for triangle in &cell.triangles {
        let [a, b, c] = triangle.edges;
        let [Some(a), Some(b), Some(c)] = [sides.get(a as usize), sides.get(b as usize), sides.get(c as usize)] else {
            continue;
        };
        let turned = triangle.is_turned;
        let (mut enters, mut leaves, mut meets) = ([0; LANES], [0; LANES], [0; LANES]);
        for i in 0..LANES {
            let (p, q) = (mask(a[i] >= 0.0) ^ turned[0], mask(b[i] >= 0.0) ^ turned[1]);
            let r = mask(c[i] >= 0.0) ^ turned[2];
            leaves[i] = p & q & r;
            enters[i] = !(p | q | r);
            meets[i] = leaves[i] | enters[i];
        }
        if !is_any(&meets) {
            continue;
        }
        let sign = turned.map(|turned| if turned == 0 { 1.0 } else { -1.0 });
        let mut w = [0.0; LANES];
        let mut weights = [[0.0; LANES]; 3];
        for i in 0..LANES {
            let (p, q, r) = (a[i] * sign[0], b[i] * sign[1], c[i] * sign[2]);
            let sum = p + q + r;
            let scale = 1.0 / select(mask(sum == 0.0), 1.0, sum);
            (weights[0][i], weights[1][i], weights[2][i]) = (p * scale, q * scale, r * scale);
            w[i] = weights[0][i] * triangle.w[0] + weights[1][i] * triangle.w[1] + weights[2][i] * triangle.w[2];
        }
        if IS_SUM {
            for i in 0..LANES {
                // A mask is −1. The sign of an entry's depth is turned.
                found.entries[i] = found.entries[i].wrapping_add(leaves[i]).wrapping_sub(enters[i]);
                let w = min(max(w[i], near), end[i]);
                found.length[i] += f32::from_bits((w.to_bits() & meets[i]) ^ (enters[i] & 1 << 31));
            }
            continue;
        }
        for i in 0..LANES {
            found.entries[i] += enters[i] & 1;
            found.exits[i] += leaves[i] & 1;
        }
        for i in 0..LANES {
            found.w_enter[i] = select(enters[i], w[i], found.w_enter[i]);
            found.w_leave[i] = select(leaves[i], w[i], found.w_leave[i]);
        }
        if cell.s_min < cell.s_max {
            for i in 0..LANES {
                let s = weights[0][i] * triangle.s[0] + weights[1][i] * triangle.s[1] + weights[2][i] * triangle.s[2];
                found.s_enter[i] = select(enters[i], s, found.s_enter[i]);
                found.s_leave[i] = select(leaves[i], s, found.s_leave[i]);
            }
        }
    }
    found
}

/// Where a ray runs into a corner or along an edge, rounding may let it enter a cell that it does not leave. So much aside, in pixels, it
/// is seen which of the cells there it meets.
const ASIDE_PX: [f32; 2] = [3e-4, 2e-4];

impl PolyHits {
    /// The parts of the ray in a lane of a block, between depths `range` from the cell's middle.
    fn find_parts(
        &mut self,
        tile: &TileFrame,
        cell: &PolyFootprint,
        (block, lane): (usize, usize),
        [near, far]: [f32; 2],
    ) {
        let [x, y] = origin_of(block);
        let (x, y) = (x + tile.lanes.x[lane], y + tile.lanes.y[lane]);
        self.find_events(cell, [x, y]);
        if self.events.iter().filter(|event| event.leaves).count() * 2 != self.events.len() {
            self.find_events(cell, [x + ASIDE_PX[0], y + ASIDE_PX[1]]);
        }
        let (mut inside, mut nth) = (0_i32, 0);
        for two in self.events.windows(2) {
            inside += if two[0].leaves { -1 } else { 1 };
            let (w0, w1) = (max(two[0].w, near), min(two[1].w, far));
            if inside == 0 || w1 - w0 <= cell.w_least || nth == u8::MAX {
                continue;
            }
            let along = |w: f32| {
                let share = (w - two[0].w) / (two[1].w - two[0].w);
                (two[0].s + (two[1].s - two[0].s) * share).clamp(cell.s_min, cell.s_max)
            };
            let v = [w0, w1].map(|w| {
                let w = w + cell.w_middle;
                if tile.is_perspective() { 1.0 / w } else { -w }
            });
            self.parts.push(Part { pixel: [x as u8, y as u8], nth, v, s: [along(w0), along(w1)] });
            nth += 1;
        }
    }

    /// The triangles that the line of the ray at a position crosses, nearest first.
    fn find_events(&mut self, cell: &PolyFootprint, [x, y]: [f32; 2]) {
        self.events.clear();
        for triangle in &cell.triangles {
            let d: [f32; 3] = std::array::from_fn(|k| {
                let [c, dx, dy] = cell.edges[triangle.edges[k] as usize];
                c + dx * x + dy * y
            });
            let [p, q, r] = [0, 1, 2].map(|k| (d[k] >= 0.0) != (triangle.is_turned[k] != 0));
            if p != q || q != r {
                continue;
            }
            let d: [f32; 3] = std::array::from_fn(|k| if triangle.is_turned[k] == 0 { d[k] } else { -d[k] });
            let sum = d[0] + d[1] + d[2];
            let scale = if sum == 0.0 { 1.0 } else { 1.0 / sum };
            let mean = |of: [f32; 3]| (d[0] * of[0] + d[1] * of[1] + d[2] * of[2]) * scale;
            self.events.push(Event { w: mean(triangle.w), s: mean(triangle.s), leaves: p });
        }
        self.events.sort_by(|a, b| a.w.total_cmp(&b.w));
    }
}

impl Hits {
    /// Lengths that are known.
    #[inline(always)]
    fn cut_sums(&mut self, cell: &PolyFootprint) {
        for vector in 0..self.rays.div_ceil(LANES) {
            let length = get(&self.of_polyhedron.w_leave, vector * LANES);
            let length_world_per_depth = get(&self.length_world_per_depth, vector * LANES);
            let mut cut =
                Segments { enter: [cell.s_min; LANES], leave: [cell.s_min; LANES], length_world: [0.0; LANES] };
            for i in 0..LANES {
                cut.length_world[i] = length[i] * length_world_per_depth[i];
            }
            self.segments[vector] = cut;
            put(&mut self.v_enter, vector * LANES, &[cell.v_max; LANES]);
        }
        self.mask_last();
    }

    #[inline(always)]
    fn cut_polyhedron(&mut self, cell: &PolyFootprint, near: f32, is_perspective: bool) {
        for vector in 0..self.rays.div_ceil(LANES) {
            let of = |packed: &Packed| get(packed, vector * LANES);
            let poly = &self.of_polyhedron;
            let (w_enter, w_leave, w_end) = (of(&poly.w_enter), of(&poly.w_leave), of(&poly.w_end));
            let length_world_per_depth = of(&self.length_world_per_depth);
            let mut cut =
                Segments { enter: [cell.s_min; LANES], leave: [cell.s_min; LANES], length_world: [0.0; LANES] };
            let mut v_enter = [0.0; LANES];
            for i in 0..LANES {
                let (w0, w1) = (max(w_enter[i], near), min(w_leave[i], w_end[i]));
                cut.length_world[i] = (w1 - w0) * length_world_per_depth[i];
                let w = w0 + cell.w_middle;
                v_enter[i] = if is_perspective { 1.0 / w } else { -w };
            }
            if cell.s_min < cell.s_max {
                let (s_enter, s_leave) = (of(&poly.s_enter), of(&poly.s_leave));
                for i in 0..LANES {
                    let (w0, w1) = (max(w_enter[i], near), min(w_leave[i], w_end[i]));
                    let slope = (s_leave[i] - s_enter[i]) / (w_leave[i] - w_enter[i]);
                    // Unchanged where nothing is cut off.
                    let enter = s_enter[i] + slope * (w0 - w_enter[i]);
                    let leave = s_leave[i] + slope * (w1 - w_leave[i]);
                    cut.enter[i] = min(max(enter, cell.s_min), cell.s_max);
                    cut.leave[i] = min(max(leave, cell.s_min), cell.s_max);
                }
            }
            self.segments[vector] = cut;
            put(&mut self.v_enter, vector * LANES, &v_enter);
        }
        self.mask_last();
    }

    /// Gives what is left of the last sixteen rays no length and nothing infinite.
    #[inline(always)]
    fn mask_last(&mut self) {
        let (vector, rest) = (self.rays / LANES, self.rays % LANES);
        if rest == 0 {
            return;
        }
        let segments = &mut self.segments[vector % BLOCKS];
        let v_enter = self.v_enter[0];
        for i in rest..LANES {
            (segments.enter[i], segments.leave[i]) = (segments.enter[0], segments.leave[0]);
            segments.length_world[i] = 0.0;
            self.v_enter[vector * LANES + i] = v_enter;
        }
    }
}
