//! The triangles of cells' faces.

use arrayvec::ArrayVec;

use crate::columns::Dataset;
use crate::stages::classify::{FACES, OUTWARD_IF_POSITIVE};

/// The triangles of face `k` of `cell`: their vertices, counterclockwise seen from outside. One of a tetrahedron, two of a hexahedron,
/// which share their first two vertices.
pub(super) fn triangles(dataset: &Dataset, cell: usize, k: usize) -> ArrayVec<[u32; 3], 2> {
    let mut triangles = ArrayVec::new();
    if let Some(cell) = cell.checked_sub(dataset.tets.len()) {
        let hexahedra = dataset.hexahedra.view();
        let vertex = hexahedra.get(cell);
        triangles.extend(hexahedra.shape(cell).triangles(k).map(|triangle| triangle.map(|i| vertex[usize::from(i)])));
    } else {
        let tet = dataset.tets.get(cell);
        let [a, b, c] = FACES[k].map(|i| tet[i]);
        let is_outward = dataset.positive.get(cell) == OUTWARD_IF_POSITIVE[k];
        triangles.push(if is_outward { [a, b, c] } else { [a, c, b] });
    }
    triangles
}
