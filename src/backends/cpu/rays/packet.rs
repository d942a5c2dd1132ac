//! A packet: sixteen rays of a 4×4 block, each on its way from cell to cell.
//!
//! A ray is in a tetrahedron, into which it came by the face with corners a, b and c, counter-clockwise as it sees them. With d the cell's
//! fourth vertex, positions u relative to the ray in the picture and e(u) = d × u, it leaves by the face that has d and the two of a, b, c
//! between which it passes d: without c where e(a) ≥ 0 > e(b), without a where e(b) ≥ 0 > e(c), without b otherwise. The signed areas
//! a × b, b × c, c × a are the weights of c, a and b in the picture; of the new face one stays and two are ± an e, so that each edge is
//! decided by the same bits in all cells around it; a ray through an edge passes it as if it were a little aside. Inverse depth v and scalar over depth s·v are linear in the picture: the ray leaves
//! at w = Σ weight / Σ weight·v with s = Σ weight·s·v / Σ weight·v. One division a step.
//!
//! Garrity 1990 (from cell to cell); Marmitt and Slusallek 2006 (one vertex a step).
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::entrances::{Front, area, relative};
use super::mates::{FaceNumber, OUTSIDE};
use super::{RayMesh, RayVertex};
use crate::backends::cpu::prefetch::prefetch;
use crate::backends::cpu::simd::Simd;
use crate::optics::lanes::{mask, max, min, select, two_sum};
use crate::optics::{CellSpan, Contribution, LANES, Lanes, Mask, Optics, Segments};

/// A corner of the face by which each ray came into its cell.
#[derive(Clone, Copy)]
struct Corner {
    /// Relative to the ray.
    x: Lanes,
    y: Lanes,
    depth_weight: Lanes,
    scalar_weight: Lanes,
    /// Which of the cell's four vertices it is.
    slot: [u32; LANES],
    /// Twice the area of the triangle of the other two and the ray.
    weight: Lanes,
}

const CORNER: Corner = Corner {
    x: [0.0; LANES],
    y: [0.0; LANES],
    depth_weight: [0.0; LANES],
    scalar_weight: [0.0; LANES],
    slot: [0; LANES],
    weight: [0.0; LANES],
};

/// What a depth may be off by, relative: in a hundred million cells one is a thousandth.
pub(super) const BACK: f32 = 2e-5;

/// Steps whose segments are shaded together: what is found once for all of them costs less, and none waits for the one before.
pub(super) const PENDING: usize = 4;

/// Sixteen rays.
#[derive(Clone, Copy)]
pub(super) struct Packet {
    /// Which of them are in a cell.
    pub(super) is_inside: Mask,
    /// Which of them have just left the mesh, and where that was.
    pub(super) has_left: Mask,
    /// Which of them are too dark for what lies behind.
    pub(super) is_ended: Mask,
    pub(super) depth: Lanes,
    /// Which of them ran in a circle, or went back on their way, which no mesh of cells that do not overlap allows.
    pub(super) is_lost: Mask,
    pub(super) went_back: Mask,
    x: Lanes,
    y: Lanes,
    length_world_per_depth: Lanes,
    scalar: Lanes,
    corners: [Corner; 3],
    /// The face by which each came into its cell, and the cell's vertex opposite to it.
    face: [FaceNumber; LANES],
    apex: [u32; LANES],
    /// A face that was crossed some steps ago, and the steps until another is chosen.
    seen: [FaceNumber; LANES],
    steps: u32,
    /// The segments of the last steps, and how many steps.
    segments: [Segments; PENDING],
    pending: usize,
    sum: Contribution,
    /// What rounding took from the sum.
    lost: Contribution,
}

impl Packet {
    /// Rays at columns `x` and rows `y` of the picture that have met nothing.
    pub(super) fn new<O: Optics>(x: Lanes, y: Lanes, length_world_per_depth: Lanes) -> Self {
        Self {
            is_inside: [0; LANES],
            has_left: [0; LANES],
            is_ended: [0; LANES],
            depth: [0.0; LANES],
            is_lost: [0; LANES],
            went_back: [0; LANES],
            x,
            y,
            length_world_per_depth,
            scalar: [0.0; LANES],
            corners: [CORNER; 3],
            face: [0; LANES],
            apex: [0; LANES],
            seen: [OUTSIDE; LANES],
            steps: 0,
            segments: [Segments::NONE; PENDING],
            pending: 0,
            sum: O::CLEAR.map(|clear| [clear; LANES]),
            lost: [[0.0; LANES]; 4],
        }
    }

    /// Brings the ray in `lane` into the mesh.
    pub(super) fn enter(&mut self, lane: usize, front: &Front, vertices: &[RayVertex], is_perspective: bool) {
        let corners = front.vertices.map(|vertex| vertices[vertex as usize]);
        let at = relative(&corners, [self.x[lane], self.y[lane]]);
        let weights = [area(at[1], at[2]), area(at[2], at[0]), area(at[0], at[1])];
        let (mut all, mut by_depth, mut by_scalar) = (0.0, 0.0, 0.0);
        for k in 0..3 {
            let corner = &mut self.corners[k];
            [corner.x[lane], corner.y[lane]] = at[k];
            (corner.depth_weight[lane], corner.scalar_weight[lane]) =
                (corners[k].depth_weight, corners[k].scalar_weight);
            (corner.slot[lane], corner.weight[lane]) = (front.slots[k], weights[k]);
            all += weights[k];
            by_depth += weights[k] * corners[k].depth_weight;
            by_scalar += weights[k] * corners[k].scalar_weight;
        }
        let (depth, base) = if is_perspective { (all / by_depth, by_depth) } else { (by_depth / all, all) };
        (self.depth[lane], self.scalar[lane]) = (depth, by_scalar / base);
        (self.face[lane], self.apex[lane], self.seen[lane]) = (front.face, front.apex, OUTSIDE);
        self.is_inside[lane] = u32::MAX;
    }

    /// What the ray in `lane` has met.
    pub(super) fn contribution(&self, lane: usize) -> [f32; 4] {
        std::array::from_fn(|c| self.sum[c][lane] + self.lost[c][lane])
    }

    /// Brings every ray through its cell. `PERSPECTIVE`: rays leave the eye. `AHEAD`: the memory of the next cell is asked for.
    #[inline(always)]
    pub(super) fn advance<const PERSPECTIVE: bool, const AHEAD: bool>(&mut self, mesh: &RayMesh, simd: impl Simd) {
        let inside = self.is_inside;
        let [dx, dy, d_depth, d_scalar] = simd.rows(bytemuck::cast_slice(mesh.vertices), &self.apex);
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        let mut e = [[0.0; LANES]; 3];
        let [mut a, mut b, mut c] = self.corners;
        for i in 0..LANES {
            (x[i], y[i]) = (dx[i] - self.x[i], dy[i] - self.y[i]);
            e[0][i] = x[i] * a.y[i] - y[i] * a.x[i];
            e[1][i] = x[i] * b.y[i] - y[i] * b.x[i];
            e[2][i] = x[i] * c.y[i] - y[i] * c.x[i];
        }
        let mut is_on_edge = [0; LANES];
        for i in 0..LANES {
            is_on_edge[i] = inside[i] & (mask(e[0][i] == 0.0) | mask(e[1][i] == 0.0) | mask(e[2][i] == 0.0));
        }
        if simd.bits(&is_on_edge) != 0 {
            step_aside(&mut e, [&x, &y], [&a, &b, &c]);
        }
        // The corner that the apex replaces.
        let (mut is_a, mut is_b, mut is_c) = ([0; LANES], [0; LANES], [0; LANES]);
        let (mut dropped, mut across) = ([0; LANES], [0; LANES]);
        for i in 0..LANES {
            let (after_a, after_b, after_c) = (mask(e[0][i] < 0.0), mask(e[1][i] < 0.0), mask(e[2][i] < 0.0));
            is_c[i] = !after_a & after_b;
            is_a[i] = !after_b & after_c;
            is_b[i] = !(is_a[i] | is_c[i]);
            dropped[i] = is_a[i] & a.slot[i] | is_b[i] & b.slot[i] | is_c[i] & c.slot[i];
            across[i] = (self.face[i] & !3 | dropped[i]) & inside[i];
        }
        let left_cell = self.face;
        let [face, apex] = simd.pairs(mesh.mates, &across);
        for i in 0..LANES {
            self.has_left[i] = inside[i] & mask(face[i] == OUTSIDE);
            self.is_lost[i] = inside[i] & mask(face[i] == self.seen[i]) & !self.has_left[i];
            self.is_inside[i] = inside[i] & !self.has_left[i] & !self.is_lost[i];
            self.face[i] = face[i] & self.is_inside[i];
            self.apex[i] = apex[i] & self.is_inside[i];
        }
        if AHEAD {
            self.ask_for_next(mesh);
        }
        // A circle comes back to a face that was looked at again and again: Brent's way to find it.
        self.steps += 1;
        if self.steps.is_power_of_two() {
            self.seen = self.face;
        }
        for i in 0..LANES {
            let [e_a, e_b, e_c] = [e[0][i], e[1][i], e[2][i]];
            let of_a = select(is_c[i], -e_b, e_c);
            let of_b = select(is_c[i], e_a, -e_c);
            let of_c = select(is_a[i], e_b, -e_a);
            a.weight[i] = max(select(is_a[i], a.weight[i], of_a), 0.0);
            b.weight[i] = max(select(is_b[i], b.weight[i], of_b), 0.0);
            c.weight[i] = max(select(is_c[i], c.weight[i], of_c), 0.0);
        }
        let apex = Apex { x, y, depth_weight: d_depth, scalar_weight: d_scalar, left_cell, dropped, face };
        apex.replace(&mut a, &is_a);
        apex.replace(&mut b, &is_b);
        apex.replace(&mut c, &is_c);
        let mut segments = Segments::NONE;
        for i in 0..LANES {
            let all = a.weight[i] + b.weight[i] + c.weight[i];
            let by_depth =
                a.weight[i] * a.depth_weight[i] + b.weight[i] * b.depth_weight[i] + c.weight[i] * c.depth_weight[i];
            let by_scalar =
                a.weight[i] * a.scalar_weight[i] + b.weight[i] * b.scalar_weight[i] + c.weight[i] * c.scalar_weight[i];
            let base = if PERSPECTIVE { by_depth } else { all };
            let reciprocal = 1.0 / base;
            // Where the face is seen edge-on the ray stays where it is; rounding never brings it back.
            let is_seen = inside[i] & mask(base > f32::MIN_POSITIVE);
            let depth = select(is_seen, if PERSPECTIVE { all } else { by_depth } * reciprocal, self.depth[i]);
            self.went_back[i] |= mask(depth < self.depth[i] - BACK * self.depth[i].abs());
            let depth = max(depth, self.depth[i]);
            let scalar = select(is_seen, by_scalar * reciprocal, self.scalar[i]);
            segments.enter[i] = self.scalar[i];
            segments.leave[i] = scalar;
            segments.length_world[i] = (depth - self.depth[i]) * self.length_world_per_depth[i];
            (self.depth[i], self.scalar[i]) = (depth, scalar);
        }
        self.corners = [a, b, c];
        if let Some(values) = mesh.cell_values {
            for i in 0..LANES {
                let value = values[(left_cell[i] & inside[i]) as usize / 4];
                (segments.enter[i], segments.leave[i]) = (value, value);
            }
        }
        self.segments[self.pending % PENDING] = segments;
        self.pending += 1;
    }

    /// Whether there is no room for another step's segments.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.pending == PENDING
    }

    /// Asks for what the next step looks up.
    #[inline(always)]
    fn ask_for_next(&self, mesh: &RayMesh) {
        for i in 0..LANES {
            if let Some(mate) = mesh.mates.get(self.face[i] as usize) {
                prefetch(mate);
            }
        }
        for i in 0..LANES {
            if let Some(vertex) = mesh.vertices.get(self.apex[i] as usize) {
                prefetch(vertex);
            }
        }
    }

    /// Adds what the segments contribute that have not been shaded yet.
    #[inline(always)]
    pub(super) fn shade<O: Optics>(&mut self, mesh: &RayMesh, optics: &O) {
        let segments = &mut self.segments[..self.pending.min(PENDING)];
        self.pending = 0;
        let [s_min, s_max, length_max] = extremes(segments);
        if length_max <= 0.0 {
            return;
        }
        for segments in segments.iter_mut() {
            for i in 0..LANES {
                let is_any = mask(segments.length_world[i] > 0.0);
                segments.enter[i] = select(is_any, segments.enter[i], s_min);
                segments.leave[i] = select(is_any, segments.leave[i], s_min);
            }
        }
        let span = CellSpan::new(mesh.intervals, s_min, s_max).within(length_max);
        let mut contributions = [[[0.0; LANES]; 4]; PENDING];
        let contributions = &mut contributions[..segments.len()];
        optics.contributions(span, segments, contributions);
        let sum = &mut self.sum;
        for added in contributions {
            if O::IS_SUM {
                for c in 0..4 {
                    for i in 0..LANES {
                        let (rounded, error) = two_sum(sum[c][i], added[c][i]);
                        sum[c][i] = rounded;
                        self.lost[c][i] += error;
                    }
                }
                continue;
            }
            for i in 0..LANES {
                let front = [sum[0][i], sum[1][i], sum[2][i], sum[3][i]];
                let both = O::over(front, [added[0][i], added[1][i], added[2][i], added[3][i]]);
                for c in 0..4 {
                    sum[c][i] = both[c];
                }
            }
        }
        if O::IS_ORDERED {
            for i in 0..LANES {
                let so_far = [sum[0][i], sum[1][i], sum[2][i], sum[3][i]];
                let shows_through = mask(O::transmittance(so_far) >= mesh.frame.stop_transmittance);
                self.is_inside[i] &= shows_through;
                self.is_ended[i] = !shows_through;
            }
        }
    }
}

/// Decides for rays that run through an edge from the apex d to a corner u, where d × u is 0: as if the ray were a little to the right, and
/// less down. So do entrances, and all cells around the edge.
#[inline(never)]
fn step_aside(e: &mut [Lanes; 3], [x, y]: [&Lanes; 2], corners: [&Corner; 3]) {
    for (e, corner) in e.iter_mut().zip(corners) {
        for i in 0..LANES {
            let (right, down) = (y[i] - corner.y[i], corner.x[i] - x[i]);
            let aside = if right == 0.0 { down } else { right };
            // Of points at one place neither is to a side of the other: no other corner is.
            if e[i] == 0.0 && aside != 0.0 {
                e[i] = f32::MIN_POSITIVE.copysign(aside);
            }
        }
    }
}

/// The vertex that is new to each ray, and what brings the corners' slots from the cell that it leaves to the next one.
struct Apex {
    x: Lanes,
    y: Lanes,
    depth_weight: Lanes,
    scalar_weight: Lanes,
    /// The face by which the ray came: the apex is the vertex opposite to it.
    left_cell: [FaceNumber; LANES],
    /// The slot of the vertex opposite to the face by which it leaves.
    dropped: [u32; LANES],
    /// That face among the next cell's.
    face: [FaceNumber; LANES],
}

impl Apex {
    /// Takes the place of a corner where it `is_dropped`. Vertices of a cell ascend, so those of the shared face stand in the same order
    /// in both cells: one place earlier from the dropped one on, one later from the next apex on.
    #[inline(always)]
    fn replace(&self, corner: &mut Corner, is_dropped: &Mask) {
        for i in 0..LANES {
            corner.x[i] = select(is_dropped[i], self.x[i], corner.x[i]);
            corner.y[i] = select(is_dropped[i], self.y[i], corner.y[i]);
        }
        for i in 0..LANES {
            corner.depth_weight[i] = select(is_dropped[i], self.depth_weight[i], corner.depth_weight[i]);
            corner.scalar_weight[i] = select(is_dropped[i], self.scalar_weight[i], corner.scalar_weight[i]);
        }
        for i in 0..LANES {
            let slot = is_dropped[i] & self.left_cell[i] & 3 | !is_dropped[i] & corner.slot[i];
            let without = slot.wrapping_add(mask(slot > self.dropped[i]));
            corner.slot[i] = without.wrapping_sub(mask(without >= self.face[i] & 3));
        }
    }
}

/// The least and the greatest value, and the greatest length, of segments that have a length; by halves, which becomes vector code.
#[inline(always)]
fn extremes(segments: &[Segments]) -> [f32; 3] {
    let (mut low, mut high, mut length) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES], [0.0; LANES]);
    for segments in segments {
        for i in 0..LANES {
            let (enter, leave) = (segments.enter[i], segments.leave[i]);
            let is_any = mask(segments.length_world[i] > 0.0);
            low[i] = min(low[i], select(is_any, min(enter, leave), f32::INFINITY));
            high[i] = max(high[i], select(is_any, max(enter, leave), f32::NEG_INFINITY));
            length[i] = max(length[i], segments.length_world[i]);
        }
    }
    let mut half = LANES / 2;
    while half > 0 {
        for i in 0..half {
            low[i] = min(low[i], low[i + half]);
            high[i] = max(high[i], high[i + half]);
            length[i] = max(length[i], length[i + half]);
        }
        half /= 2;
    }
    [low[0], high[0], length[0]]
}
