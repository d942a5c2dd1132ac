//! Spatial order: cells along a Morton curve through their centroids, vertices by their first cell.
//!
//! A frame gathers four vertices a cell; in random order that is a cache miss each, in spatial order almost none.

use rayon::prelude::*;

/// Marks a point of the file that no cell uses.
pub(crate) const UNUSED: u32 = u32::MAX;

/// The file-order tetrahedron of each cell, by ascending key; equal keys keep the file's order.
pub(super) fn tet_from_cell(tets: &[[u32; 4]], key: impl Fn([u32; 4]) -> u64 + Sync) -> Vec<u32> {
    let mut keyed: Vec<(u64, u32)> =
        tets.par_iter().enumerate().map(|(tet, &corners)| (key(corners), tet as u32)).collect();
    keyed.par_sort_unstable();
    keyed.into_par_iter().map(|(_, tet)| tet).collect()
}

/// A vertex number for each point of the file, in the order in which the cells first name them.
pub(super) fn vertex_from_file(points: usize, tets: &[[u32; 4]], tet_from_cell: &[u32]) -> Vec<u32> {
    let mut vertex_from_file = vec![UNUSED; points];
    let mut next = 0;
    for &tet in tet_from_cell {
        for &point in &tets[tet as usize] {
            let vertex = &mut vertex_from_file[point as usize];
            if *vertex == UNUSED {
                *vertex = next;
                next += 1;
            }
        }
    }
    vertex_from_file
}

/// The point of the file of each vertex.
pub(super) fn invert(vertex_from_file: &[u32]) -> Vec<u32> {
    let used = vertex_from_file.iter().filter(|&&vertex| vertex != UNUSED).count();
    let mut file_from_vertex = vec![0; used];
    for (point, &vertex) in vertex_from_file.iter().enumerate() {
        if vertex != UNUSED {
            file_from_vertex[vertex as usize] = point as u32;
        }
    }
    file_from_vertex
}
