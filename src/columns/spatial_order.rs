//! Spatial order: cells along a Morton curve through their centroids, vertices by their first cell.
//!
//! A frame gathers four vertices a cell; in random order that is a cache miss each, in spatial order almost none.

use glam::Vec3;
use rayon::prelude::*;

use super::Bounds;

/// Marks a point of the file that no cell uses.
pub(super) const UNUSED: u32 = u32::MAX;

/// The file-order tetrahedron of each cell, along the Morton curve; equal keys keep the file's order.
pub(super) fn tet_from_cell(tets: &[[u32; 4]], position: impl Fn(u32) -> Vec3 + Sync, bounds: Bounds) -> Vec<u32> {
    let scale = ((1 << 21) - 1) as f32 / (bounds.max - bounds.min).max_element().max(f32::MIN_POSITIVE);
    let mut keyed: Vec<(u64, u32)> = tets
        .par_iter()
        .enumerate()
        .map(|(tet, &corners)| {
            let [a, b, c, d] = corners.map(&position);
            let cell = ((a + b + c + d) * 0.25 - bounds.min) * scale;
            (morton(cell.x as u32, cell.y as u32, cell.z as u32), tet as u32)
        })
        .collect();
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

/// Interleaves the low 21 bits of x, y and z.
fn morton(x: u32, y: u32, z: u32) -> u64 {
    spread(x) | spread(y) << 1 | spread(z) << 2
}

/// Moves bit i to bit 3 i, by halving the groups that stay together.
fn spread(v: u32) -> u64 {
    let mut v = u64::from(v) & 0x1f_ffff;
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::morton;

    #[test]
    fn morton_interleaves_bit_by_bit() {
        let slow = |x: u32, y: u32, z: u32| {
            (0..21).fold(0_u64, |key, i| {
                let bit = |v: u32| u64::from(v >> i & 1);
                key | bit(x) << (3 * i) | bit(y) << (3 * i + 1) | bit(z) << (3 * i + 2)
            })
        };
        for (x, y, z) in [(0, 0, 0), (1, 2, 4), (0x1f_ffff, 0, 0x15_5555), (12345, 67890, 999_999)] {
            assert_eq!(morton(x, y, z), slow(x, y, z));
        }
    }
}
