//! Canonical points: coincident points of a file under one number, so that a face has the same corners on both sides.

use glam::DVec3;
use rayon::prelude::*;

use super::Points;

/// For each point the lowest point with the same coordinates; 0 and −0 are the same, everything else must be bit-equal.
///
/// O(n log n), 32 bytes a point while it runs.
///
/// # Panics
/// If there are more points than `u32` can name.
///
/// ```
/// # use cellfan::columns::{Points, canonical_from_point};
/// let points = Points::F32(vec![[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, -0.0, 0.0]]);
/// assert_eq!(canonical_from_point(&points), [0, 1, 0]);
/// ```
pub fn canonical_from_point(points: &Points) -> Vec<u32> {
    // Adding 0 turns −0 into 0 and leaves every other value as it is.
    canonical_by(points.len(), |point| (points.get(point) + DVec3::ZERO).to_array().map(f64::to_bits))
}

/// The same for vertices, of which a mesh has fewer bits: 16 bytes each while it runs.
pub(crate) fn canonical_from_vertex(positions: &[[f32; 3]]) -> Vec<u32> {
    canonical_by(positions.len(), |vertex| place(positions[vertex]))
}

/// The same for all vertices at one place, and for no others.
#[inline]
pub(crate) fn place(position: [f32; 3]) -> [u32; 3] {
    position.map(|x| (x + 0.0).to_bits())
}

fn canonical_by<K: Ord + Send>(points: usize, key: impl Fn(usize) -> K + Sync) -> Vec<u32> {
    let len = u32::try_from(points).expect("the number of points was checked against u32");
    let mut keyed: Vec<(K, u32)> = (0..len).into_par_iter().map(|point| (key(point as usize), point)).collect();
    keyed.par_sort_unstable();
    let mut canonical_from_point = vec![0; keyed.len()];
    for group in keyed.chunk_by(|a, b| a.0 == b.0) {
        for &(_, point) in group {
            canonical_from_point[point as usize] = group[0].1;
        }
    }
    canonical_from_point
}
