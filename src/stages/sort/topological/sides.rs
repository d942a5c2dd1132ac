//! `sides`: for each face of each tetrahedron, whether what lies across comes before or after it.
//!
//! In: cells, vertices, the view. Out: [`Sides`] of every cell. Exact, so that both cells at a face say the same. O(cells), in
//! parallel; another kind of cell joins the graph with a function like this one.

use glam::Vec3;
use rayon::prelude::*;

use super::graph::Sides;
use crate::columns::{BlockCells, Dataset};
use crate::stages::SceneVertex;
use crate::stages::classify::OUTWARD_IF_POSITIVE;
use crate::stages::sort::Toward;
use crate::stages::sort::side::sides_of_eye;

/// A bit for each face of a positive cell whose canonical normal points outwards.
const OUTWARD: u8 = {
    let (mut bits, mut k) = (0, 0);
    while k < 4 {
        bits |= (OUTWARD_IF_POSITIVE[k] as u8) << k;
        k += 1;
    }
    bits
};

/// Fills `sides_from_cell`, which has a place for each cell.
pub(super) fn sides(dataset: &Dataset, vertices: &[SceneVertex], toward: Toward, sides_from_cell: &mut [Sides]) {
    sides_from_cell.par_chunks_mut(Dataset::BLOCK_CELLS).enumerate().for_each(|(block, sides)| {
        let block = dataset.block(block);
        let BlockCells::Tets(tets) = &block.cells else { return };
        for (i, (sides, tet)) in sides.iter_mut().zip(tets.iter()).enumerate() {
            let corner = |v: u32| Vec3::from_array(vertices[v as usize].position).as_dvec3();
            let [a, b, c, d] = tet;
            let side_from_face = sides_of_eye([corner(a), corner(b), corner(c), corner(d)], toward);
            let (mut along_normal, mut against_normal) = (0, 0);
            for (k, side) in side_from_face.into_iter().enumerate() {
                along_normal |= u8::from(side < 0.0) << k;
                against_normal |= u8::from(side > 0.0) << k;
            }
            // Rays leave where they run along with an outward normal, or against an inward one.
            let outward = if dataset.positive.get(block.base + i) { OUTWARD } else { !OUTWARD };
            sides.after = along_normal & outward | against_normal & !outward;
            sides.before = along_normal & !outward | against_normal & outward;
        }
    });
}
