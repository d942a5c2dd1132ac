//! `Detail`: which points of a terrain a view needs, and how far each has risen to its place.
//!
//! The points of a square of 2ⁿ + 1 points a side are the midpoints of edges that longest-edge bisection splits, level by level: centres of
//! squares, then midpoints of sides, then centres of squares of half the side. A point matters as its error shows: the distance by
//! which surface and fog would be off without it and all points below it, in pixels. Errors and radii are nested (a point's hold those
//! of all below it; Röttger et al. 1998 propagate roughness for the same end, Lindstrom and Pascucci 2002 in this form), so a point that
//! is needed needs no check of those above it, and no edge is split on one side only: no cracks. A point that comes in lies where the surface
//! was without it, and rises with its error (geomorphing): nothing pops.

use glam::DVec3;
use rayon::prelude::*;

/// Nested errors and radii of all points.
#[derive(Clone, Debug)]
pub(super) struct Importance {
    side: usize,
    /// Of each point and all below it: the largest error, and the radius of the ball around it that holds them, in world units.
    error_radius: Vec<[f32; 2]>,
}

/// Which points are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// Those whose error is more than so many pixels, seen from an eye.
    Tolerance {
        /// Where the eye is, in world units.
        eye: DVec3,
        /// Pixels that a length of 1 covers at distance 1.
        px_per_unit: f64,
        /// Errors that do not show.
        tolerance_px: f64,
    },
    /// All.
    Full,
}

impl Importance {
    /// Of a terrain whose points are at `position`, with `surfaces` of heights (the ground, the top of the fog).
    pub(super) fn new(side: usize, position: impl Fn(usize) -> DVec3 + Sync, surfaces: &[&[f32]]) -> Self {
        let mut error_radius = vec![[0.0; 2]; side * side];
        let mut step = 1;
        // From the finest level to the coarsest: sides, then centres, of squares of side 2·step.
        while 2 * step < side {
            for is_center in [false, true] {
                let made: Vec<(usize, [f32; 2])> = points_of(side, step, is_center)
                    .map(|point| {
                        let ends = ends_of(side, point, step, is_center);
                        let error = surfaces.iter().map(|heights| {
                            let of = |[x, y]: [usize; 2]| f64::from(heights[x + side * y]);
                            (of(point) - 0.5 * (of(ends[0]) + of(ends[1]))).abs()
                        });
                        let mut error = error.fold(0.0, f64::max);
                        let here = position(point[0] + side * point[1]);
                        let mut radius = 0.0_f64;
                        for below in below(side, point, step, is_center) {
                            let below = below[0] + side * below[1];
                            let [of_error, of_radius] = error_radius[below].map(f64::from);
                            error = error.max(of_error);
                            radius = radius.max(here.distance(position(below)) + of_radius);
                        }
                        // Rounded up, so that what is nested stays so.
                        (
                            point[0] + side * point[1],
                            [error, radius * (1.0 + 1e-6)].map(|value| (value as f32).next_up()),
                        )
                    })
                    .collect();
                for (point, value) in made {
                    error_radius[point] = value;
                }
            }
            step *= 2;
        }
        Self { side, error_radius }
    }

    /// How far point (x, y) has risen from where the surface is without it: 0 where it is not drawn, 1 in its place.
    pub(super) fn risen(&self, detail: &Detail, [x, y]: [usize; 2], position: DVec3) -> f64 {
        match *detail {
            Detail::Full => 1.0,
            Detail::Tolerance { eye, px_per_unit, tolerance_px } => {
                let [error, radius] = self.error_radius[x + self.side * y].map(f64::from);
                let nearest = (eye.distance(position) - radius).max(1e-9);
                let error_px = error * px_per_unit / nearest;
                let t = (error_px / tolerance_px - 1.0).clamp(0.0, 1.0);
                t * t * (3.0 - 2.0 * t)
            }
        }
    }
}

/// The points of a level: centres of squares of side 2·`step`, or midpoints of their sides.
fn points_of(side: usize, step: usize, is_center: bool) -> impl ParallelIterator<Item = [usize; 2]> {
    let rows = (side - 1) / step + 1;
    (0..rows).into_par_iter().flat_map_iter(move |row| {
        // Centres have odd multiples of the step in both coordinates, midpoints in one.
        let first = usize::from(if is_center { row % 2 == 1 } else { row % 2 == 0 });
        let has_any = !is_center || row % 2 == 1;
        (first..rows).step_by(2).filter(move |_| has_any).map(move |column| [column * step, row * step])
    })
}

/// The ends of the edge that a point is the midpoint of.
fn ends_of(side: usize, [x, y]: [usize; 2], step: usize, is_center: bool) -> [[usize; 2]; 2] {
    if !is_center {
        let along_x = x / step % 2 == 1;
        return if along_x { [[x - step, y], [x + step, y]] } else { [[x, y - step], [x, y + step]] };
    }
    // The diagonal through the centre of the square that this one is a quarter of; that of the whole from corner to corner.
    let is_odd = |c: usize| c / (2 * step) % 2 == 1;
    let of = |c: usize, odd: bool| if is_odd(c - step) == odd { c - step } else { c + step };
    if 2 * step == side - 1 {
        return [[0, 0], [side - 1, side - 1]];
    }
    [[of(x, true), of(y, true)], [of(x, false), of(y, false)]]
}

/// The points of the next finer level that split the triangles which a point makes.
fn below(side: usize, [x, y]: [usize; 2], step: usize, is_center: bool) -> impl Iterator<Item = [usize; 2]> {
    let (dx, half) = (step as isize, (step / 2) as isize);
    let offsets = if is_center {
        [[-dx, 0], [dx, 0], [0, -dx], [0, dx]]
    } else {
        [[-half, -half], [half, -half], [-half, half], [half, half]]
    };
    let is_last = !is_center && step == 1;
    offsets.into_iter().filter(move |_| !is_last).filter_map(move |[dx, dy]| {
        let at = [x.checked_add_signed(dx)?, y.checked_add_signed(dy)?];
        (at[0] < side && at[1] < side).then_some(at)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_but_the_corners_is_of_one_level_and_below_one_that_is_above_it() {
        let side = 9;
        let mut seen = vec![0; side * side];
        let mut named_below = vec![0; side * side];
        for step in [1, 2, 4] {
            for is_center in [false, true] {
                for point in points_of(side, step, is_center).collect::<Vec<_>>() {
                    seen[point[0] + side * point[1]] += 1;
                    let [a, b] = ends_of(side, point, step, is_center);
                    assert_eq!([a[0] + b[0], a[1] + b[1]], [2 * point[0], 2 * point[1]], "a midpoint");
                    for [x, y] in below(side, point, step, is_center) {
                        named_below[x + side * y] += 1;
                    }
                }
            }
        }
        for (i, (&seen, &below)) in seen.iter().zip(&named_below).enumerate() {
            let [x, y] = [i % side, i / side];
            let is_corner = x % (side - 1) == 0 && y % (side - 1) == 0;
            let is_first = [x, y] == [4, 4];
            assert_eq!(seen, i32::from(!is_corner), "({x}, {y})");
            assert_eq!(below > 0, !is_corner && !is_first, "({x}, {y})");
        }
    }
}
