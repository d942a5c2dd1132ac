//! The faces of cells: their names, which both cells at one agree on, and their triangles.
//!
//! A tetrahedron has four, face k opposite to vertex k; a hexahedron six, in the order of its kind. A hexahedron's face some of whose
//! corners coincide is a triangle, perhaps that of a tetrahedron, or has no area and no name.

use arrayvec::ArrayVec;

use crate::cells::HEXAHEDRON;
use crate::columns::{Dataset, HexahedraView, Points, TetsView, canonical_from_point};
use crate::stages::classify::{FACES, OUTWARD_IF_POSITIVE};

/// Faces of a tetrahedron.
pub(super) const TET_FACES: usize = 4;
/// Faces of a hexahedron.
pub(super) const HEX_FACES: usize = 6;

/// A face as both cells at it name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FaceName {
    /// Its lowest vertex.
    pub(super) lowest: u32,
    /// The vertices next to that one, ascending.
    pub(super) beside: [u32; 2],
    /// Twice the vertex opposite, one more where the face is cut from there; [`FaceName::TRIANGLE`] where there is none.
    pub(super) opposite: u64,
}

impl FaceName {
    /// The face has three corners.
    pub(super) const TRIANGLE: u64 = u64::MAX;

    /// The triangle with corners `around` it, and whether they run from the lowest to the next one.
    fn of_triangle(around: [u32; 3]) -> (Self, bool) {
        let first = (0..3).min_by_key(|&i| around[i]).unwrap_or(0);
        let [after, before] = [1, 2].map(|i| around[(first + i) % 3]);
        let beside = [after.min(before), after.max(before)];
        (Self { lowest: around[first], beside, opposite: Self::TRIANGLE }, after < before)
    }

    /// The same for four corners, cut from the first to the third or from the second to the fourth.
    fn of_quadrilateral(around: [u32; 4], is_cut_from_first: bool) -> (Self, bool) {
        let first = (0..4).min_by_key(|&i| around[i]).unwrap_or(0);
        let [after, opposite, before] = [1, 2, 3].map(|i| around[(first + i) % 4]);
        let is_cut_from_lowest = (first % 2 == 0) == is_cut_from_first;
        let opposite = u64::from(opposite) << 1 | u64::from(is_cut_from_lowest);
        (Self { lowest: around[first], beside: [after.min(before), after.max(before)], opposite }, after < before)
    }
}

/// Names the faces of the cells of a dataset.
pub(super) struct Faces<'a> {
    dataset: &'a Dataset,
    tets: TetsView<'a>,
    hexahedra: HexahedraView<'a>,
    /// The lowest vertex at the place of each; empty where each has a place of its own, or counts as if it had.
    canonical_from_vertex: Vec<u32>,
}

impl<'a> Faces<'a> {
    /// Those of `dataset`. Where hexahedra are listed, faces are named by places: cells may adjoin by vertices of their own.
    pub(super) fn new(dataset: &'a Dataset) -> Self {
        let hexahedra = &dataset.hexahedra;
        let are_listed = !hexahedra.is_empty() && hexahedra.structured_blocks().is_empty();
        let positions = || Points::F32(dataset.positions.to_vec());
        let canonical_from_vertex = if are_listed { canonical_from_point(&positions()) } else { Vec::new() };
        Self { dataset, tets: dataset.tets.view(), hexahedra: hexahedra.view(), canonical_from_vertex }
    }

    /// Calls `with` with the number of each face of `cell`, its name, and whether its vertices, counterclockwise seen from outside,
    /// run from the lowest to the lower one beside it: the opposite of what its other cell says.
    #[inline]
    pub(super) fn for_each(&self, cell: usize, with: impl FnMut(usize, FaceName, bool)) {
        match cell.checked_sub(self.dataset.tets.len()) {
            None => self.of_tet(cell, with),
            Some(cell) => self.of_hexahedron(cell, with),
        }
    }

    #[inline]
    fn of_tet(&self, cell: usize, mut with: impl FnMut(usize, FaceName, bool)) {
        let tet = self.tets.get(cell);
        for (k, face) in FACES.iter().enumerate() {
            let [a, b, c] = face.map(|i| tet[i]);
            let is_outward = is_outward(self.dataset, cell, k);
            if self.canonical_from_vertex.is_empty() {
                with(k, FaceName { lowest: a, beside: [b, c], opposite: FaceName::TRIANGLE }, is_outward);
            } else {
                let around = if is_outward { [a, b, c] } else { [a, c, b] };
                let (name, ascends) = FaceName::of_triangle(around.map(|v| self.canonical(v)));
                with(k, name, ascends);
            }
        }
    }

    fn of_hexahedron(&self, cell: usize, mut with: impl FnMut(usize, FaceName, bool)) {
        let shape = self.hexahedra.shape(cell);
        if shape.is_absent() {
            return;
        }
        let vertex = self.hexahedra.get(cell).map(|v| self.canonical(v));
        for (k, face) in HEXAHEDRON.faces.iter().enumerate() {
            let corner = |i: usize| vertex[usize::from(face[i % 4])];
            let around: ArrayVec<u32, 4> = (0..4).filter(|&i| corner(i) != corner(i + 1)).map(corner).collect();
            let (name, ascends) = match around[..] {
                [a, b, c, d] if a != c && b != d => {
                    let [[end, other, _], _] = shape.triangles(k);
                    FaceName::of_quadrilateral([a, b, c, d], [end, other].contains(&face[0]))
                }
                [a, b, c] => FaceName::of_triangle([a, b, c]),
                _ => continue,
            };
            with(k, name, ascends);
        }
    }

    #[inline]
    fn canonical(&self, vertex: u32) -> u32 {
        self.canonical_from_vertex.get(vertex as usize).copied().unwrap_or(vertex)
    }
}

/// Whether the canonical normal of face `k` of a tetrahedron points out of it.
#[inline]
pub(super) fn is_outward(dataset: &Dataset, tet: usize, k: usize) -> bool {
    dataset.positive.get(tet) == OUTWARD_IF_POSITIVE[k]
}

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
        triangles.push(if is_outward(dataset, cell, k) { [a, b, c] } else { [a, c, b] });
    }
    triangles
}
