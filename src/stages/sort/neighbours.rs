//! Which cells share a face. O(n log n): faces are sorted by their vertices.

use rayon::prelude::*;

use crate::columns::Dataset;
use crate::stages::classify::{FACES, OUTWARD_IF_POSITIVE};

/// Two cells and the face they share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Neighbours {
    /// The face's vertices, ascending.
    pub(super) face: [u32; 3],
    /// The cell on the side that the face's canonical normal points to.
    pub(super) ahead: u32,
    /// The cell on the other side.
    pub(super) behind: u32,
}

/// All pairs among `cells` that share a face.
pub(super) fn neighbours(dataset: &Dataset, cells: impl ParallelIterator<Item = u32>) -> Vec<Neighbours> {
    let mut faces: Vec<([u32; 3], u32, bool)> = cells
        .flat_map_iter(|cell| {
            let tet = dataset.tets.get(cell as usize);
            let positive = dataset.positive.get(cell as usize);
            (0..4).map(move |k| (FACES[k].map(|i| tet[i]), cell, positive == OUTWARD_IF_POSITIVE[k]))
        })
        .collect();
    faces.par_sort_unstable();
    faces
        .windows(2)
        .filter(|two| two[0].0 == two[1].0 && two[0].2 != two[1].2)
        .map(|two| {
            // A face's normal points out of one cell into the other.
            let (behind, ahead) = if two[0].2 { (two[0].1, two[1].1) } else { (two[1].1, two[0].1) };
            Neighbours { face: two[0].0, ahead, behind }
        })
        .collect()
}
