//! The faces of cells under names that both cells at one agree on.
//!
//! A tetrahedron has four, face k opposite to vertex k; a hexahedron six, in the order of its kind. A hexahedron's face some of whose
//! corners coincide is a triangle, perhaps that of a tetrahedron, or has no area and no name.

use arrayvec::ArrayVec;

use super::canonical::canonical_from_vertex;
use super::{BitColumn, Dataset, Hexahedra, HexahedraView, Tets, TetsView};
use crate::cells::{HEXAHEDRON, OPPOSITE_FACES, OUTWARD_IF_POSITIVE};

/// Faces of a tetrahedron.
pub(crate) const TET_FACES: usize = 4;
/// Faces of a hexahedron.
pub(crate) const HEX_FACES: usize = 6;

/// A face as both cells at it name it: the ends of the diagonal along which it is cut, then its other corners, each pair ascending; or
/// its three corners, ascending, and nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct FaceName(pub(super) [u32; 4]);

/// A face as one of its cells sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FaceSide {
    pub(crate) name: FaceName,
    /// Whether its corners, counterclockwise seen from outside, run from the first of its name to the lower one of the two beside that.
    /// The cell on the other side says the opposite.
    pub(crate) ascends: bool,
}

impl FaceSide {
    /// Stands in the name of a triangle for a fourth corner.
    const NOTHING: u32 = u32::MAX;

    /// The triangle with corners `around` it.
    #[inline]
    fn of_triangle(mut around: [u32; 3]) -> Self {
        let mut ascends = true;
        // A sorting network; each exchange reverses the way around.
        for [i, j] in [[0, 1], [1, 2], [0, 1]] {
            if around[i] > around[j] {
                around.swap(i, j);
                ascends = !ascends;
            }
        }
        let [a, b, c] = around;
        Self { name: FaceName([a, b, c, Self::NOTHING]), ascends }
    }

    /// The same for four corners, cut from the first to the third or from the second to the fourth.
    fn of_quadrilateral([a, b, c, d]: [u32; 4], is_cut_from_first: bool) -> Self {
        let (ends, others) = if is_cut_from_first { ([a, c], [b, d]) } else { ([b, d], [c, a]) };
        // Seen from the other end the others come in the other order.
        let [after, before] = if ends[0] < ends[1] { others } else { [others[1], others[0]] };
        let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        Self { name: FaceName([low, high, after.min(before), after.max(before)]), ascends: after < before }
    }

    /// Whether `other` is the same face, seen from its other side.
    #[inline]
    pub(super) fn is_across(self, other: Self) -> bool {
        self.name == other.name && self.ascends != other.ascends
    }
}

/// The columns that say where cells are.
#[derive(Clone, Copy)]
pub(crate) struct CellColumns<'a> {
    pub(crate) tets: &'a Tets,
    /// Their orientations.
    pub(crate) positive: &'a BitColumn,
    pub(crate) hexahedra: &'a Hexahedra,
    pub(crate) positions: &'a [[f32; 3]],
}

impl<'a> From<&'a Dataset> for CellColumns<'a> {
    fn from(Dataset { tets, positive, hexahedra, positions, .. }: &'a Dataset) -> Self {
        Self { tets, positive, hexahedra, positions }
    }
}

/// Names the faces of cells.
pub(crate) struct Faces<'a> {
    tets: TetsView<'a>,
    first_hexahedron: usize,
    positive: &'a BitColumn,
    hexahedra: HexahedraView<'a>,
    /// How many of the hexahedra are listed: all or none.
    listed: usize,
    /// The lowest vertex at the place of each; empty where each has a place of its own, or counts as if it had.
    canonical_from_vertex: Vec<u32>,
}

impl<'a> Faces<'a> {
    /// Named as cells adjoin: by places where hexahedra are listed, which may have vertices of their own, else by vertices.
    ///
    /// By places it takes 4 bytes a vertex if any two coincide, and 20 until that is known.
    pub(crate) fn new(cells: CellColumns<'a>) -> Self {
        let mut faces = Self::by_vertices(cells);
        if faces.listed > 0 {
            let canonical = canonical_from_vertex(cells.positions);
            let coincide = canonical.iter().zip(0..).any(|(&canonical, vertex)| canonical != vertex);
            faces.canonical_from_vertex = if coincide { canonical } else { Vec::new() };
        }
        faces
    }

    /// Named by vertices, as if no two stood at one place.
    pub(super) fn by_vertices(cells: CellColumns<'a>) -> Self {
        let CellColumns { tets, positive, hexahedra, .. } = cells;
        Self {
            tets: tets.view(),
            first_hexahedron: tets.len(),
            positive,
            hexahedra: hexahedra.view(),
            listed: if hexahedra.structured_blocks().is_empty() { hexahedra.len() } else { 0 },
            canonical_from_vertex: Vec::new(),
        }
    }

    /// How many tetrahedra there are, and how many hexahedra that are listed.
    pub(crate) fn listed(&self) -> [usize; 2] {
        [self.first_hexahedron, self.listed]
    }

    /// The vertices of `cell`: four or eight.
    pub(super) fn corners(&self, cell: usize) -> ArrayVec<u32, 8> {
        match cell.checked_sub(self.first_hexahedron) {
            None => self.tets.get(cell).into_iter().collect(),
            Some(hexahedron) => self.hexahedra.get(hexahedron).into(),
        }
    }

    /// Calls `with` with the number of each face of `cell`, and the face; of cells that are not drawn there are none.
    #[inline]
    pub(crate) fn for_each(&self, cell: usize, mut with: impl FnMut(usize, FaceSide)) {
        let canonical = |vertex: u32| self.canonical_from_vertex.get(vertex as usize).copied().unwrap_or(vertex);
        match cell.checked_sub(self.first_hexahedron) {
            None => {
                let (tet, is_positive) = (self.tets.get(cell).map(canonical), self.positive.get(cell));
                (0..TET_FACES).for_each(|k| with(k, of_tet(tet, is_positive, k)));
            }
            Some(hexahedron) => {
                let corners = self.hexahedra.get(hexahedron).map(canonical);
                for k in 0..HEX_FACES {
                    if let Some(face) = self.of_hexahedron(hexahedron, corners, k) {
                        with(k, face);
                    }
                }
            }
        }
    }

    /// Face `k` of `cell`, its vertices named by `place`; none where it has no such face.
    #[inline]
    pub(super) fn get(&self, cell: usize, k: usize, place: impl Fn(u32) -> u32) -> Option<FaceSide> {
        match cell.checked_sub(self.first_hexahedron) {
            None => (k < TET_FACES).then(|| of_tet(self.tets.get(cell).map(place), self.positive.get(cell), k)),
            Some(cell) => self.of_hexahedron(cell, self.hexahedra.get(cell).map(place), k),
        }
    }

    /// Face `k` of a hexahedron with these corners.
    #[inline]
    fn of_hexahedron(&self, hexahedron: usize, corners: [u32; 8], k: usize) -> Option<FaceSide> {
        let shape = self.hexahedra.shape(hexahedron);
        if shape.is_absent() {
            return None;
        }
        let around: [u32; 4] = std::array::from_fn(|i| corners[usize::from(HEXAHEDRON.faces[k][i])]);
        let [a, b, c, d] = around;
        if a == c || b == d {
            return None;
        }
        if a != b && b != c && c != d && d != a {
            return Some(FaceSide::of_quadrilateral(around, shape.diagonals() >> k & 1 == 0));
        }
        let different: ArrayVec<u32, 4> =
            (0..4).filter(|&i| around[i] != around[(i + 1) % 4]).map(|i| around[i]).collect();
        different.as_slice().try_into().ok().map(FaceSide::of_triangle)
    }
}

/// Face `k` of a tetrahedron; the sign of its volume is that of ascending vertices.
#[inline]
fn of_tet(tet: [u32; 4], is_positive: bool, k: usize) -> FaceSide {
    let [a, b, c] = OPPOSITE_FACES[k].map(|i| tet[i]);
    let is_outward = is_positive == OUTWARD_IF_POSITIVE[k];
    // Vertices ascend, but for those that are named by others at their places.
    if a < b && b < c {
        return FaceSide { name: FaceName([a, b, c, FaceSide::NOTHING]), ascends: is_outward };
    }
    FaceSide::of_triangle(if is_outward { [a, b, c] } else { [a, c, b] })
}

#[cfg(test)]
mod tests {
    use super::FaceSide;

    #[test]
    fn a_face_has_one_name_from_wherever_it_is_read_and_runs_the_other_way_from_behind() {
        let corners = [7, 2, 9, 4];
        let around = |first: usize, step: usize| [0, 1, 2, 3].map(|i| corners[(first + step * i) % 4]);
        // Cut from 7 to 9 or from 2 to 4.
        for is_cut_at in [0, 1] {
            let expected = FaceSide::of_quadrilateral(corners, is_cut_at == 0);
            for first in 0..4 {
                let is_cut_from_first = first % 2 == is_cut_at;
                assert_eq!(FaceSide::of_quadrilateral(around(first, 1), is_cut_from_first), expected);
                let behind = FaceSide::of_quadrilateral(around(first, 3), is_cut_from_first);
                assert!(behind.is_across(expected) && !expected.is_across(expected));
                let otherwise = FaceSide::of_quadrilateral(around(first, 3), !is_cut_from_first);
                assert!(!otherwise.is_across(expected), "cut along the other diagonal");
            }
        }
        for [a, b, c] in [[3, 5, 8], [5, 8, 3], [8, 3, 5]] {
            let front = FaceSide::of_triangle([a, b, c]);
            assert!(front.ascends && front.is_across(FaceSide::of_triangle([a, c, b])));
            assert_eq!(front, FaceSide::of_triangle([3, 5, 8]));
        }
    }
}
