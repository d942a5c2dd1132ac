//! `sides`: for each face of each cell, whether what lies across comes before or after it.
//!
//! In: cells, vertices, the view. Out: [`Sides`] of every cell. Exact, so that both cells at a face say the same. O(cells), in
//! parallel; another kind of cell joins the graph with a function like these.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::graph::Sides;
use crate::columns::{BlockCells, BlockTets, Dataset, HEX_FACES, HexShape, HexahedraView};
use crate::control::Control;
use crate::stages::SceneVertex;
use crate::stages::classify::OUTWARD_IF_POSITIVE;
use crate::stages::sort::Toward;
use crate::stages::sort::side::{sides_of_eye, sides_of_fold};

/// A bit for each face of a positive cell whose canonical normal points outwards.
const OUTWARD: u8 = {
    let (mut bits, mut k) = (0, 0);
    while k < 4 {
        bits |= (OUTWARD_IF_POSITIVE[k] as u8) << k;
        k += 1;
    }
    bits
};

/// Fills `sides_from_cell`, which has a place for each cell, until the end is asked for.
pub(super) fn sides(
    control: &Control,
    dataset: &Dataset,
    vertices: &[SceneVertex],
    toward: Toward,
    sides_from_cell: &mut [Sides],
) {
    // Blocks are of one kind, so that those of hexahedra begin anew.
    let (of_tets, of_hexahedra) = sides_from_cell.split_at_mut(dataset.tets.len());
    let [of_tets, of_hexahedra] = [of_tets, of_hexahedra].map(|sides| sides.par_chunks_mut(Dataset::BLOCK_CELLS));
    let corner = |v: u32| Vec3::from_array(vertices[v as usize].position).as_dvec3();
    of_tets.chain(of_hexahedra).enumerate().for_each(|(block, sides)| {
        if control.is_cancelled() {
            return;
        }
        let block = dataset.block(block);
        match &block.cells {
            BlockCells::Tets(tets) => {
                of_tets_in_block(tets, |cell| dataset.positive.get(block.base + cell), corner, toward, sides);
            }
            BlockCells::Hexahedra(hexahedra) => of_hexahedra_in_block(hexahedra, corner, toward, sides),
            // They are in no graph.
            BlockCells::Polyhedra(_) => {}
        }
    });
}

#[inline]
fn of_tets_in_block(
    tets: &BlockTets,
    is_positive: impl Fn(usize) -> bool,
    corner: impl Fn(u32) -> DVec3,
    toward: Toward,
    sides: &mut [Sides],
) {
    for (i, (sides, tet)) in sides.iter_mut().zip(tets.iter()).enumerate() {
        let [a, b, c, d] = tet;
        let side_from_face = sides_of_eye([corner(a), corner(b), corner(c), corner(d)], toward);
        let (mut along_normal, mut against_normal) = (0, 0);
        for (k, side) in side_from_face.into_iter().enumerate() {
            along_normal |= u8::from(side < 0.0) << k;
            against_normal |= u8::from(side > 0.0) << k;
        }
        // Rays leave where they run along with an outward normal, or against an inward one.
        let outward = if is_positive(i) { OUTWARD } else { !OUTWARD };
        sides.after = along_normal & outward | against_normal & !outward;
        sides.before = along_normal & !outward | against_normal & outward;
    }
}

fn of_hexahedra_in_block(
    hexahedra: &HexahedraView,
    corner: impl Fn(u32) -> DVec3,
    toward: Toward,
    sides: &mut [Sides],
) {
    for (i, sides) in sides.iter_mut().enumerate() {
        let shape = hexahedra.shape(i);
        *sides = if shape.is_absent() {
            Sides::default()
        } else {
            of_hexahedron(hexahedra.get(i).map(&corner), shape, toward)
        };
    }
}

#[inline]
fn of_hexahedron(corners: [DVec3; 8], shape: HexShape, toward: Toward) -> Sides {
    let mut sides = Sides::default();
    for k in 0..HEX_FACES {
        let [[p, q, r], [.., s]] = shape.triangles(k);
        // Normals point outwards.
        let [first, second] = sides_of_fold([p, q, r, s].map(|i| corners[usize::from(i & 7)]), toward);
        sides.before |= u8::from(first > 0.0 || second > 0.0) << k;
        sides.after |= u8::from(first < 0.0 || second < 0.0) << k;
    }
    sides
}
