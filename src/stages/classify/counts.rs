//! How many cells of each class were drawn: tetrahedra by [`ProjectionClass`], other cells by [`Case`], as Max 2006, section 6,
//! cubes by [`CubeClass`].

use super::ProjectionClass;
use super::cubes::CubeClass;
use super::polyhedra::{Case, Projections};
use crate::cells::{CellKind, HEXAHEDRON, PYRAMID, WEDGE};

/// The kinds that have cases, in the order in which these are counted.
static KINDS: [&CellKind; 3] = [&HEXAHEDRON, &WEDGE, &PYRAMID];
/// How many cases each kind has.
const CASES: [usize; 3] = [8, 5, 5];
const FIRST_CASE: usize = ProjectionClass::ALL.len();
const SPLIT: usize = FIRST_CASE + CASES[0] + CASES[1] + CASES[2];
const FIRST_CUBE: usize = SPLIT + 1;
const CLASSES: usize = FIRST_CUBE + CubeClass::ALL.len();

/// A class of a cell of any kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellClass(usize);

/// Cells of each class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClassCounts([u64; CLASSES]);

impl Default for ClassCounts {
    fn default() -> Self {
        Self([0; CLASSES])
    }
}

impl CellClass {
    /// A cell with a face that is concave or crosses itself on the picture: drawn as tetrahedra, which are counted as such.
    pub const SPLIT: Self = Self(SPLIT);
    /// A cell that covers nothing.
    pub const EDGE_ON: Self = Self(ProjectionClass::EdgeOn as usize);

    /// The class of a whole cell of `kind`; voxels have the cases of hexahedra.
    #[inline]
    pub fn of_case(kind: &CellKind, case: &Case) -> Self {
        let kind = KINDS.iter().position(|of| of.code == kind.code).unwrap_or(0);
        Self(FIRST_CASE + CASES[..kind].iter().sum::<usize>() + case.index)
    }
}

impl From<ProjectionClass> for CellClass {
    fn from(class: ProjectionClass) -> Self {
        Self(class as usize)
    }
}

impl From<CubeClass> for CellClass {
    fn from(class: CubeClass) -> Self {
        Self(FIRST_CUBE + class as usize)
    }
}

impl ClassCounts {
    /// Counts one more cell.
    #[inline]
    pub fn add(&mut self, CellClass(class): CellClass) {
        self.0[class] += 1;
    }

    /// All cells, of split ones the tetrahedra.
    pub fn cells(&self) -> u64 {
        self.0[..SPLIT].iter().sum::<u64>() + self.0[FIRST_CUBE..].iter().sum::<u64>()
    }

    /// The triangles that were drawn for them.
    pub fn triangles(&self) -> u64 {
        self.named_with_triangles().iter().map(|&(_, cells, triangles)| cells * triangles as u64).sum()
    }

    /// Name in STATS.json, cells, and triangles of a cell, for each class.
    fn named_with_triangles(&self) -> Vec<(&'static str, u64, usize)> {
        let tetrahedra = ProjectionClass::ALL.iter().map(|class| (class.name(), class.triangles()));
        let cases = KINDS.into_iter().filter_map(Projections::of).flat_map(Projections::cases);
        let cases = cases.map(|case| (case.name, case.triangles.len()));
        let cubes = CubeClass::ALL.into_iter().map(|class| (class.name(), class.triangles()));
        let classes = tetrahedra.chain(cases).chain([("split", 0)]).chain(cubes);
        classes.zip(self.0).map(|((name, triangles), cells)| (name, cells, triangles)).collect()
    }

    /// The cells of each class under its name in STATS.json: classes of tetrahedra, and of other kinds what there is.
    pub fn named(&self) -> Vec<(&'static str, u64)> {
        let all = self.named_with_triangles().into_iter().enumerate();
        all.filter(|(i, (_, cells, _))| *i < FIRST_CASE || *cells > 0)
            .map(|(_, (name, cells, _))| (name, cells))
            .collect()
    }
}

impl std::ops::AddAssign for ClassCounts {
    fn add_assign(&mut self, other: Self) {
        for (mine, its) in self.0.iter_mut().zip(other.0) {
            *mine += its;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_has_a_place_of_its_own() {
        let mut places = Vec::new();
        for kind in KINDS {
            let cases = Projections::of(kind).unwrap().cases();
            places.extend(cases.iter().map(|case| CellClass::of_case(kind, case).0));
        }
        assert_eq!(places, (FIRST_CASE..SPLIT).collect::<Vec<_>>());
        let mut counts = ClassCounts::default();
        counts.add(ProjectionClass::Class2.into());
        counts.add(CellClass(places[1]));
        counts.add(CellClass::SPLIT);
        counts.add(CubeClass::ThreeB.into());
        assert_eq!((counts.cells(), counts.triangles()), (3, 4 + 12 + 12));
        assert_eq!(counts.named()[5..], [("count1", 1), ("split", 1), ("cube_3b", 1)]);
    }
}
