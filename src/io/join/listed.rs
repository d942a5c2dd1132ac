//! Lists the cells of structured blocks, and of datasets that are drawn from.

use arrayvec::ArrayVec;

use crate::cells::{HEXAHEDRON, TETRAHEDRON};
use crate::columns::{Array, Association, Dataset, Points};
use crate::error::Result;
use crate::io::numbers::gather;
use crate::io::{Scratch, StructuredBlock, StructuredMesh, UnstructuredMesh};

/// The cells of all blocks, of any dimension, each with its corners.
pub(super) fn of_blocks(mesh: StructuredMesh, scratch: &Scratch) -> Result<UnstructuredMesh> {
    let blocks = mesh.blocks().to_vec();
    let (points, arrays) = mesh.into_columns();
    let cells =
        blocks.iter().flat_map(|block| (0..block.cells()).map(move |cell| (block.code(), corners_of(block, cell))));
    list(points, cells, arrays, scratch)
}

/// The cells that a dataset draws; its columns are copied.
pub(super) fn of_dataset(dataset: &Dataset, scratch: &Scratch) -> Result<UnstructuredMesh> {
    let (tets, hexahedra) = (dataset.tets.len(), dataset.hexahedra.view());
    let is_drawn = |cell: &u32| {
        let hexahedron = (*cell as usize).checked_sub(tets);
        hexahedron.is_none_or(|hexahedron| !hexahedra.shape(hexahedron).is_absent())
    };
    let drawn: Vec<u32> = (0..dataset.cells() as u32).filter(is_drawn).collect();
    let cell = |&cell: &u32| {
        let mut corners: ArrayVec<u32, 8> = dataset.corners(cell as usize).iter().copied().collect();
        if corners.len() == HEXAHEDRON.corners {
            return (HEXAHEDRON.code, corners);
        }
        if !dataset.positive.get(cell as usize) {
            corners.swap(2, 3);
        }
        (TETRAHEDRON.code, corners)
    };
    let cell_tuples: Vec<u32> = drawn.iter().map(|&cell| dataset.cell_tuple(cell as usize) as u32).collect();
    let point_tuples: Vec<u32> = (0..dataset.positions.len()).map(|v| dataset.point_tuple(v) as u32).collect();
    let array = |array: &Array| {
        let tuples = if array.association == Association::Point { &point_tuples } else { &cell_tuples };
        Array { values: gather(&array.values, array.components, tuples), ..array.clone() }
    };
    let arrays = dataset.arrays.iter().map(array).collect();
    let points = if dataset.origin == glam::DVec3::ZERO {
        Points::F32(dataset.positions.to_vec())
    } else {
        let world = |p: &[f32; 3]| (dataset.origin + glam::Vec3::from_array(*p).as_dvec3()).to_array();
        Points::F64(dataset.positions.iter().map(world).collect())
    };
    list(points, drawn.iter().map(cell), arrays, scratch)
}

/// A mesh of cells given by code and corners.
fn list(
    points: Points,
    cells: impl Iterator<Item = (u8, ArrayVec<u32, 8>)>,
    arrays: Vec<Array>,
    scratch: &Scratch,
) -> Result<UnstructuredMesh> {
    let (mut types, mut offsets, mut connectivity) = (scratch.column(), scratch.column(), scratch.column());
    offsets.push(0)?;
    for (code, corners) in cells {
        types.push(code)?;
        connectivity.extend(corners)?;
        offsets.push(connectivity.len() as u64)?;
    }
    let (types, offsets, connectivity) = (types.finish()?, offsets.finish()?, connectivity.finish()?);
    Ok(UnstructuredMesh { points, types, offsets, connectivity, arrays, ..UnstructuredMesh::empty() })
}

/// The corners of a cell of any dimension, in VTK's order: from a vertex, each axis with more than one point doubles them.
fn corners_of(block: &StructuredBlock, cell: usize) -> ArrayVec<u32, 8> {
    let [ni, nj, nk] = block.dims();
    let along = [ni, nj, nk].map(|points| (points - 1).max(1));
    let (i, j, k) = (cell % along[0], cell / along[0] % along[1], cell / along[0] / along[1]);
    let first = (block.first_point() + i + ni * (j + nj * k)) as u32;
    let mut corners = ArrayVec::from_iter([first]);
    for (step, _) in [(1, ni), (ni, nj), (ni * nj, nk)].into_iter().filter(|&(_, points)| points > 1) {
        let mut next: ArrayVec<u32, 4> = corners.iter().map(|corner| corner + step as u32).collect();
        if next.len() == 2 {
            // Around the face, not across it.
            next.reverse();
        }
        corners.extend(next);
    }
    corners
}
