//! Spatial order: cells along a Morton curve through their centroids, vertices by their first cell.
//!
//! A frame gathers four vertices a cell; in random order that is a cache miss each, in spatial order almost none.

use rayon::prelude::*;

/// Marks a point of the file that no cell uses.
pub(crate) const UNUSED: u32 = u32::MAX;

/// The file-order cell of each cell, by ascending key; equal keys keep the file's order.
pub(super) fn file_from_cell<const N: usize>(cells: &[[u32; N]], key: impl Fn([u32; N]) -> u64 + Sync) -> Vec<u32> {
    let mut keyed: Vec<(u64, u32)> =
        cells.par_iter().enumerate().map(|(cell, &corners)| (key(corners), cell as u32)).collect();
    keyed.par_sort_unstable();
    keyed.into_par_iter().map(|(_, cell)| cell).collect()
}

/// A vertex number for each point of the file, in the order in which the cells first name them.
pub(super) struct Numbering {
    vertex_from_file: Vec<u32>,
    next: u32,
}

impl Numbering {
    /// No point has a number.
    pub(super) fn new(points: usize) -> Self {
        Self { vertex_from_file: vec![UNUSED; points], next: 0 }
    }

    /// Numbers the points of cells in the order that `file_from_cell` says.
    pub(super) fn number<const N: usize>(&mut self, cells: &[[u32; N]], file_from_cell: &[u32]) {
        self.number_points(file_from_cell.iter().flat_map(|&cell| cells[cell as usize]));
    }

    /// Numbers points in their order.
    pub(super) fn number_points(&mut self, points: impl Iterator<Item = u32>) {
        for point in points {
            let vertex = &mut self.vertex_from_file[point as usize];
            if *vertex == UNUSED {
                *vertex = self.next;
                self.next += 1;
            }
        }
    }

    /// `vertex_from_file`, and the point of the file of each vertex.
    pub(super) fn finish(self) -> (Vec<u32>, Vec<u32>) {
        let mut file_from_vertex = vec![0; self.next as usize];
        for (point, &vertex) in self.vertex_from_file.iter().enumerate() {
            if vertex != UNUSED {
                file_from_vertex[vertex as usize] = point as u32;
            }
        }
        (self.vertex_from_file, file_from_vertex)
    }
}
