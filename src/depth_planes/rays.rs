//! `Screen`: from screen points to grid points by one matrix; [`Rays`]: those of sixteen pixels, and where they meet the grid.
//!
//! A screen point (x, y) at view depth w is made homogeneous, scaled by its depth in perspective, and multiplied by a matrix of 3×4: grid
//! from world times world from view times view from screen. So along a ray the grid point is a straight function of depth, for sheared
//! grids too. Rays start at the near limit, in double precision, so that a far eye costs no digit.

use glam::{DMat3, DVec3};

use crate::camera::Frame;
use crate::columns::Volume;
use crate::optics::lanes::{LANES, Lanes};

/// The matrix from the screen to the grid, for the pixels of one picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    is_perspective: bool,
    /// Columns of the matrix: of x, y, view depth, and 1.
    x: DVec3,
    y: DVec3,
    depth: DVec3,
    one: DVec3,
    /// The grid's last point along each axis.
    upper: DVec3,
    near: f64,
    /// World from view, for lengths and directions.
    world: Frame,
    size_px: [u32; 2],
}

/// Rays of sixteen pixels; depths count from the near limit.
#[derive(Clone, Debug)]
pub(super) struct Rays {
    /// Grid point at depth 0.
    pub(super) origin: [Lanes; 3],
    /// Its change per unit of depth.
    pub(super) step: [Lanes; 3],
    /// Depths between which the ray is in the grid; the other way round where it never is.
    pub(super) enter: Lanes,
    pub(super) exit: Lanes,
    /// World length per unit of depth.
    pub(super) length: Lanes,
    /// Unit vector towards the eye, in the world.
    pub(super) toward_eye: [Lanes; 3],
}

impl Rays {
    pub(super) const NONE: Self = Self {
        origin: [[0.0; LANES]; 3],
        step: [[0.0; LANES]; 3],
        enter: [0.0; LANES],
        exit: [-1.0; LANES],
        length: [0.0; LANES],
        toward_eye: [[0.0; LANES]; 3],
    };
}

impl Screen {
    /// The matrix for the pixels of `frame`, whose steps are those of its picture.
    pub(super) fn new(volume: &Volume, frame: &Frame, near: f64) -> Self {
        let grid_from_world = volume.lattice.grid_from_world();
        let linear: DMat3 = grid_from_world.matrix3;
        let [width, height] = frame.size_px.map(f64::from);
        let corner = frame.step_x * (0.5 - 0.5 * width) + frame.step_y * (0.5 - 0.5 * height);
        let eye = grid_from_world.transform_point3(frame.eye);
        let (depth, one) = if frame.is_perspective {
            (linear * (frame.forward + corner), eye)
        } else {
            (linear * frame.forward, eye + linear * corner)
        };
        Self {
            is_perspective: frame.is_perspective,
            x: linear * frame.step_x,
            y: linear * frame.step_y,
            depth,
            one,
            upper: volume.dims.map(|side| (side - 1) as f64).into(),
            near,
            world: *frame,
            size_px: frame.size_px,
        }
    }

    /// The grid point of pixel (x, y) at view depth `w`, and its change per unit of depth.
    fn grid(&self, x: f64, y: f64, w: f64) -> (DVec3, DVec3) {
        let aside = self.x * x + self.y * y;
        if self.is_perspective {
            (self.one + (self.depth + aside) * w, self.depth + aside)
        } else {
            (self.one + aside + self.depth * w, self.depth)
        }
    }

    /// The rays of the pixels in four columns from `x0` and four rows from `y0` on, between depths from the near limit; each ends at its
    /// own `end`, a view depth. Pixels outside the picture have none.
    pub(super) fn rays(&self, [x0, y0]: [u32; 2], between: [f64; 2], end: impl Fn(u32, u32) -> f64) -> Rays {
        let mut rays = Rays::NONE;
        for lane in 0..LANES {
            let (x, y) = (x0 + lane as u32 % 4, y0 + lane as u32 / 4);
            if x >= self.size_px[0] || y >= self.size_px[1] {
                continue;
            }
            let (origin, step) = self.grid(x.into(), y.into(), self.near);
            let (mut enter, mut exit) = (between[0], between[1].min(end(x, y) - self.near));
            for axis in 0..3 {
                let [to_low, to_high] = [-origin[axis], self.upper[axis] - origin[axis]].map(|to| to / step[axis]);
                if step[axis] == 0.0 {
                    if origin[axis] < 0.0 || origin[axis] > self.upper[axis] {
                        exit = f64::NEG_INFINITY;
                    }
                } else {
                    enter = enter.max(to_low.min(to_high));
                    exit = exit.min(to_low.max(to_high));
                }
            }
            // A ray that misses stays as it was: without a length.
            if enter < exit {
                let direction = self.world.ray(x.into(), y.into()).direction;
                let length = direction.length();
                for axis in 0..3 {
                    rays.origin[axis][lane] = origin[axis] as f32;
                    rays.step[axis][lane] = step[axis] as f32;
                    rays.toward_eye[axis][lane] = (-direction[axis] / length) as f32;
                }
                (rays.enter[lane], rays.exit[lane], rays.length[lane]) = (enter as f32, exit as f32, length as f32);
            }
        }
        rays
    }
}
