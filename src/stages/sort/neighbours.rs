//! Which cells share a face. O(n log n): faces are sorted by their names.

use arrayvec::ArrayVec;
use rayon::prelude::*;

use super::faces::triangles;
use crate::columns::{Dataset, FaceName, Faces, HEX_FACES};

/// Two cells and the face they share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Neighbours {
    /// The vertices of the face's triangles, one or two, counterclockwise seen from `ahead`; of two tetrahedra ascending.
    pub(super) triangles: ArrayVec<[u32; 3], 2>,
    /// The cell on the side that the triangles' normals point to.
    pub(super) ahead: u32,
    /// The cell on the other side.
    pub(super) behind: u32,
}

/// All pairs among `cells` that share a face.
pub(super) fn neighbours(dataset: &Dataset, cells: impl ParallelIterator<Item = u32>) -> Vec<Neighbours> {
    let faces = Faces::new(dataset.into());
    let mut sides: Vec<(FaceName, u32, bool, u8)> = cells
        .flat_map_iter(|cell| {
            let mut sides = ArrayVec::<_, HEX_FACES>::new();
            faces.for_each(cell as usize, |k, face| sides.push((face.name, cell, face.ascends, k as u8)));
            sides
        })
        .collect();
    sides.par_sort_unstable();
    sides
        .windows(2)
        .filter(|two| two[0].0 == two[1].0 && two[0].1 != two[1].1 && two[0].2 != two[1].2)
        .map(|two| {
            // A face's normal points out of one cell into the other.
            let (behind, ahead) = if two[0].2 { (two[0], two[1]) } else { (two[1], two[0]) };
            let triangles = triangles(dataset, behind.1 as usize, behind.3.into());
            Neighbours { triangles, ahead: ahead.1, behind: behind.1 }
        })
        .collect()
}
