//! Errors of boxes between points: how far samples are from the trilinear interpolation of a box's corners.
//!
//! Over a child, both its own interpolation and its parent's are trilinear; so is their difference, which is largest at a corner of the
//! child. So a parent's error is at most that of a child and the largest difference of a sample at the child's corners from the parent's
//! interpolation: 27 samples a node, whatever its size.

use super::leaves::Leaves;
use super::level::Node;
use crate::columns::Sample;

/// What lies at `at`, from 0 to 1 along each axis, between the values at the corners of a box: corner i has x = bit 0, y = bit 1,
/// z = bit 2 of i.
#[inline]
pub(crate) fn between(corners: &[f32; 8], at: [f32; 3]) -> f32 {
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |first: usize| mix(corners[first], corners[first + 1], at[0]);
    mix(mix(row(0), row(2), at[1]), mix(row(4), row(6), at[1]), at[2])
}

/// The bound for a node from `first` to `end` (samples), parted at `middle` where that is less than `end`; `children` of it, by their
/// octant. NaN where a child has none.
pub(super) fn error_of<T: Sample>(
    leaves: &Leaves<T>,
    [first, middle, end]: [[u32; 3]; 3],
    children: impl Iterator<Item = (usize, Node)>,
) -> f32 {
    let place = |corner: usize, axis: usize| if corner >> axis & 1 == 1 { end[axis] } else { first[axis] };
    let corners: [f32; 8] = std::array::from_fn(|corner| leaves.value([0, 1, 2].map(|axis| place(corner, axis))));
    // The differences at three places along each axis: first, middle, end.
    let mut off = [0.0_f32; 27];
    for (number, off) in off.iter_mut().enumerate() {
        let at = [number % 3, number / 3 % 3, number / 9];
        let sample: [u32; 3] = std::array::from_fn(|axis| [first, middle, end][at[axis]][axis]);
        let share = |axis: usize| (sample[axis] - first[axis]) as f32 / (end[axis] - first[axis]) as f32;
        // What the corners are is exact; what rounding does elsewhere is no error of the samples.
        *off =
            if at.contains(&1) { (leaves.value(sample) - between(&corners, [0, 1, 2].map(share))).abs() } else { 0.0 };
    }
    let mut largest = 0.0_f32;
    for (octant, child) in children {
        if child.error().is_nan() {
            return f32::NAN;
        }
        let mut at_corners = 0.0_f32;
        for corner in 0..8 {
            // A child that has no other beside it along an axis reaches from first to end there: `middle` is `end`.
            let along = |axis: usize| (octant >> axis & 1) + (corner >> axis & 1);
            at_corners = at_corners.max(off[along(0) + 3 * along(1) + 9 * along(2)]);
        }
        largest = largest.max(child.error() + at_corners);
    }
    largest
}
