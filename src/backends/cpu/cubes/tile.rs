//! One tile of cubes: its rays in grid coordinates, and what is composited along them.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use glam::{DVec3, Vec3};

use super::bins::BinnedCube;
use super::linear::{LinearCube, TOLERANCE};
use crate::backends::Frame;
use crate::backends::cpu::tile::{BLOCK, BLOCKS, BLOCKS_A_SIDE};
use crate::columns::GridEye;
use crate::optics::lanes::{max, min, two_sum};
use crate::optics::{CellSpan, Contribution, LANES, Lanes, Optics, Segments};
use crate::stages::{CubesInView, View};

/// The rays of a view in grid coordinates: place and direction (per unit of view depth) of the ray at picture position (x, y).
pub(super) struct CubeRays {
    origin: [DVec3; 3],
    direction: [DVec3; 3],
    view: View,
    dims: [u32; 3],
    /// The longest diagonal of a sample, in world units.
    diagonal_world: f32,
}

impl CubeRays {
    pub(super) fn new(cubes: &CubesInView, view: &View) -> Self {
        let scene_from_grid = cubes.scene_from_grid();
        let to_grid = scene_from_grid.inverse().matrix3;
        let [step_x, step_y, corner] = [view.step_x, view.step_y, view.corner].map(|v| to_grid * v);
        let (origin, direction) = match cubes.eye {
            GridEye::At(eye) => ([eye, DVec3::ZERO, DVec3::ZERO], [to_grid * view.forward + corner, step_x, step_y]),
            GridEye::Along(_) => {
                let eye = scene_from_grid.inverse().transform_point3(view.eye);
                ([eye + corner, step_x, step_y], [to_grid * view.forward, DVec3::ZERO, DVec3::ZERO])
            }
        };
        let diagonals =
            [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0), DVec3::new(1.0, 1.0, -1.0)];
        let longest = diagonals.map(|diagonal| (scene_from_grid.matrix3 * diagonal).length());
        let diagonal_world = longest.into_iter().fold(0.0, f64::max) * view.world_per_scene * (1.0 + 1e-4);
        Self { origin, direction, view: *view, dims: cubes.dims, diagonal_world: diagonal_world as f32 }
    }
}

/// The rays of a 4×4 block of pixels.
#[derive(Clone, Copy)]
pub(super) struct BlockRays {
    /// Where they start, along each axis of the grid.
    pub(super) origin: [Lanes; 3],
    /// Steps along each axis per unit of view depth.
    pub(super) step: [Lanes; 3],
    /// View depth per step along each axis.
    depth_per_step: [Lanes; 3],
    /// World length per unit of view depth.
    length_world: Lanes,
}

/// The ways of rays through a box.
pub(super) struct Crossing {
    /// View depths; where a ray misses the box, in any order.
    pub(super) enter: Lanes,
    pub(super) leave: Lanes,
    /// 0 where it does.
    pub(super) length_world: Lanes,
}

/// A tile at work.
pub(in crate::backends::cpu) struct CubeTile {
    rays: Vec<BlockRays>,
    sums: Box<[Contribution; BLOCKS]>,
    /// What rounding took from them, where contributions add up.
    lost: Box<[Contribution; BLOCKS]>,
    first_px: [u32; 2],
    dims: [u32; 3],
    diagonal_world: f32,
}

impl Default for CubeTile {
    fn default() -> Self {
        let nothing = [0.0; LANES];
        let rays =
            BlockRays { origin: [nothing; 3], step: [nothing; 3], depth_per_step: [nothing; 3], length_world: nothing };
        Self {
            rays: vec![rays; BLOCKS],
            sums: Box::new([[nothing; 4]; BLOCKS]),
            lost: Box::new([[nothing; 4]; BLOCKS]),
            first_px: [0; 2],
            dims: [0; 3],
            diagonal_world: 0.0,
        }
    }
}

/// A direction of this along an axis counts as none: its inverse is still a number, and so is that times any grid coordinate.
const STEP_MIN: f32 = 1e-25;

impl CubeTile {
    /// Starts the tile whose first pixel is `first_px`.
    pub(super) fn begin<O: Optics>(&mut self, rays: &CubeRays, first_px: [u32; 2]) {
        let [x, y] = first_px.map(f64::from);
        let at_first =
            |[base, per_x, per_y]: [DVec3; 3]| [base + per_x * x + per_y * y, per_x, per_y].map(DVec3::as_vec3);
        let (origin, direction) = (at_first(rays.origin), at_first(rays.direction));
        let length = |x: f64, y: f64| rays.view.length_world_per_depth(x, y) as f32;
        for (block, of_block) in self.rays.iter_mut().enumerate() {
            for lane in 0..LANES {
                let column = (block % BLOCKS_A_SIDE * BLOCK + lane % BLOCK) as f32;
                let row = (block / BLOCKS_A_SIDE * BLOCK + lane / BLOCK) as f32;
                let at = |[base, per_x, per_y]: [Vec3; 3]| base + per_x * column + per_y * row;
                let (from, along) = (at(origin), at(direction));
                for axis in 0..3 {
                    let step = if along[axis].abs() < STEP_MIN { STEP_MIN } else { along[axis] };
                    of_block.origin[axis][lane] = from[axis];
                    of_block.step[axis][lane] = along[axis];
                    of_block.depth_per_step[axis][lane] = 1.0 / step;
                }
                of_block.length_world[lane] = length(x + f64::from(column), y + f64::from(row));
            }
        }
        self.sums.fill(O::CLEAR.map(|clear| [clear; LANES]));
        self.lost.fill([[0.0; LANES]; 4]);
        (self.first_px, self.dims, self.diagonal_world) = (first_px, rays.dims, rays.diagonal_world);
    }

    /// What has been composited at a place, block by block, lane by lane.
    pub(super) fn contribution(&self, place: usize) -> [f32; 4] {
        let (block, lane) = (place / LANES, place % LANES);
        std::array::from_fn(|c| self.sums[block][c][lane] + self.lost[block][c][lane])
    }

    /// Composites cubes, nearest first.
    #[inline(always)]
    pub(in crate::backends::cpu) fn composite<O: Optics>(
        &mut self,
        frame: &Frame,
        optics: &O,
        nearest_first: &[BinnedCube],
    ) {
        let (near, far) = (frame.view.near, frame.view.far);
        let corners = frame.cubes.and_then(|cubes| cubes.corners);
        let (low, high) = frame.field.range;
        let tolerance = TOLERANCE * (high - low) as f32;
        // Blocks through which nothing shows any more, a bit each.
        let mut done = 0_u64;
        for &BinnedCube { cube, number, pixels } in nearest_first {
            if done == u64::MAX {
                break;
            }
            let ends = cube.samples(self.dims).map(|end| end.map(|end| end as f32));
            let length_max = self.diagonal_world * (1_u32 << cube.level) as f32;
            let linear = corners.map(|corners| LinearCube::new(corners.of(&cube), ends, tolerance));
            let [least, greatest] = linear.as_ref().map_or([cube.value; 2], |linear| linear.range);
            let span = CellSpan::new(frame.intervals(), least, greatest).within(length_max).of_cell(number as usize);
            let blocks = |first: u16, end: u16, origin: u32| {
                let side = (BLOCKS_A_SIDE * BLOCK) as u32;
                let (first, end) = (u32::from(first).max(origin) - origin, u32::from(end).min(origin + side) - origin);
                first as usize / BLOCK..(end as usize).div_ceil(BLOCK)
            };
            let columns = blocks(pixels.x0, pixels.x1, self.first_px[0]);
            for row in blocks(pixels.y0, pixels.y1, self.first_px[1]) {
                for column in columns.clone() {
                    let block = row * BLOCKS_A_SIDE + column;
                    if done >> block & 1 == 1 {
                        continue;
                    }
                    let rays = self.rays[block];
                    let Some(crossing) = rays.through(ends, [near, far]) else { continue };
                    let mut add = |segments: Segments| {
                        let mut added = [[[0.0; LANES]; 4]];
                        optics.contributions(span, &[segments], &mut added);
                        let [added] = added;
                        if self.add::<O>(block, &added, frame.stop_transmittance) {
                            done |= 1 << block;
                        }
                    };
                    let Some(linear) = &linear else {
                        let value = [cube.value; LANES];
                        add(Segments { enter: value, leave: value, length_world: crossing.length_world });
                        continue;
                    };
                    let ends = linear.ends(&rays, &crossing);
                    let mut enter = linear.values(&ends, 0.0);
                    for part in 0..linear.parts {
                        let segments = linear.segments(&ends, &crossing, (part, enter));
                        enter = segments.leave;
                        add(segments);
                    }
                }
            }
        }
    }

    /// Puts contributions behind those of a block; whether nothing shows through any more.
    #[inline(always)]
    fn add<O: Optics>(&mut self, block: usize, added: &Contribution, stop_transmittance: f32) -> bool {
        let sum = &mut self.sums[block];
        if O::IS_SUM {
            let lost = &mut self.lost[block];
            for c in 0..4 {
                for i in 0..LANES {
                    let (rounded, error) = two_sum(sum[c][i], added[c][i]);
                    sum[c][i] = rounded;
                    lost[c][i] += error;
                }
            }
            return false;
        }
        let mut most = 0.0;
        for i in 0..LANES {
            let front = [sum[0][i], sum[1][i], sum[2][i], sum[3][i]];
            let whole = O::over(front, [added[0][i], added[1][i], added[2][i], added[3][i]]);
            for c in 0..4 {
                sum[c][i] = whole[c];
            }
            most = max(O::transmittance(whole), most);
        }
        O::IS_ORDERED && most < stop_transmittance
    }
}

impl BlockRays {
    /// The ways of the rays through a box between two grid points, from the near to the far plane; none where all miss it.
    #[inline(always)]
    fn through(&self, [low, high]: [[f32; 3]; 2], [near, far]: [f32; 2]) -> Option<Crossing> {
        let (mut enter, mut leave) = ([near; LANES], [far; LANES]);
        for axis in 0..3 {
            for i in 0..LANES {
                let (origin, per_step) = (self.origin[axis][i], self.depth_per_step[axis][i]);
                let (a, b) = ((low[axis] - origin) * per_step, (high[axis] - origin) * per_step);
                enter[i] = max(min(a, b), enter[i]);
                leave[i] = min(max(a, b), leave[i]);
            }
        }
        let mut longest = 0.0;
        let mut length_world = [0.0; LANES];
        for i in 0..LANES {
            length_world[i] = max(leave[i] - enter[i], 0.0) * self.length_world[i];
            longest = max(length_world[i], longest);
        }
        (longest > 0.0).then_some(Crossing { enter, leave, length_world })
    }
}
