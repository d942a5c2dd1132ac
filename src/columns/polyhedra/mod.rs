//! `Polyhedra`: cells with any faces, which cells share.
//!
//! In: [`FaceLists`]. Out: [`Polyhedra`]: where each cell's faces stand in a list of signed faces, where each face's vertices stand in
//! a list of vertices. Each face is a fan of triangles around its vertex of lowest number in the file, the same for both cells at it.

mod build;
mod in_file;
mod lists;
mod skin;
mod split;

pub(crate) use build::Built;
pub use lists::FaceLists;
pub(super) use split::fan;

use glam::{DVec3, Vec3};

use super::Column;

/// Polyhedra, closed by their faces.
#[derive(Clone, Debug)]
pub struct Polyhedra {
    columns: PolyhedraColumns,
    /// What the cells have at most.
    most: Most,
}

/// Polyhedra as lists in lists.
#[derive(Clone, Debug)]
pub(crate) struct PolyhedraColumns {
    /// Where in `sides` and in `corners` each cell begins, and where the last one ends.
    pub(crate) starts: Column<[u32; 2]>,
    /// The faces of each cell: twice the face's number, and 1 where it is seen from its back.
    pub(crate) sides: Column<u32>,
    /// The vertices of each cell, each once, ascending.
    pub(crate) corners: Column<u32>,
    /// Where in `around` each face begins, and where the last one ends.
    pub(crate) face_starts: Column<u32>,
    /// The vertices around each face, counterclockwise seen from outside the first cell that has it.
    pub(crate) around: Column<u32>,
}

/// What a cell has at most, each of it perhaps another cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Most {
    /// Triangles of its faces.
    pub triangles: usize,
    /// Corners, each once.
    pub corners: usize,
    /// Corners, those of several faces more than once.
    pub around: usize,
}

impl Most {
    fn of_cell(faces: usize, corners: usize, around: usize) -> Self {
        Self { triangles: around - 2 * faces, corners, around }
    }

    fn max(self, other: Self) -> Self {
        Self {
            triangles: self.triangles.max(other.triangles),
            corners: self.corners.max(other.corners),
            around: self.around.max(other.around),
        }
    }
}

impl Polyhedra {
    /// No cell.
    pub fn none() -> Self {
        let [sides, corners, around] = [(); 3].map(|()| Vec::new().into());
        let (starts, face_starts) = (vec![[0; 2]].into(), vec![0].into());
        Self { columns: PolyhedraColumns { starts, sides, corners, face_starts, around }, most: Most::default() }
    }

    /// The lists that they are.
    pub(crate) fn columns(&self) -> &PolyhedraColumns {
        &self.columns
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.columns.starts.len() - 1
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many faces the cells have, those that two share counted once.
    pub fn faces(&self) -> usize {
        self.columns.face_starts.len() - 1
    }

    /// What the cells have at most.
    pub fn most(&self) -> Most {
        self.most
    }

    /// All cells as slices, for repeated access.
    pub fn view(&self) -> PolyhedraView<'_> {
        let PolyhedraColumns { starts, sides, corners, face_starts, around } = &self.columns;
        PolyhedraView { starts, sides, corners, face_starts, around }
    }

    /// The faces that one cell alone has, as that cell sees them.
    pub fn exterior(&self) -> impl Iterator<Item = PolyFace<'_>> {
        let mut sides = vec![0_u8; self.faces()];
        for &side in &self.columns.sides[..] {
            let seen = &mut sides[side as usize / 2];
            *seen = seen.saturating_add(1);
        }
        let view = self.view();
        self.columns.sides.iter().filter(move |&&side| sides[side as usize / 2] == 1).map(move |&side| view.face(side))
    }

    /// Bytes of memory that the cells take.
    pub fn owned_bytes(&self) -> u64 {
        let PolyhedraColumns { starts, sides, corners, face_starts, around } = &self.columns;
        starts.owned_bytes() + [sides, corners, face_starts, around].map(Column::owned_bytes).iter().sum::<u64>()
    }
}

/// [`Polyhedra`], or a run of them, as slices.
#[derive(Clone, Copy, Debug)]
pub struct PolyhedraView<'a> {
    starts: &'a [[u32; 2]],
    sides: &'a [u32],
    corners: &'a [u32],
    face_starts: &'a [u32],
    around: &'a [u32],
}

/// A face as one of its cells sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PolyFace<'a> {
    /// Its number among the faces of all cells.
    pub number: u32,
    /// The vertices around it, that of lowest number in the file first.
    pub around: &'a [u32],
    /// Whether they run clockwise seen from outside the cell.
    pub is_reversed: bool,
}

impl<'a> PolyFace<'a> {
    /// Its triangles, counterclockwise seen from outside the cell.
    ///
    /// ```
    /// # use cellfan::columns::PolyFace;
    /// let face = PolyFace { number: 0, around: &[3, 5, 8, 6], is_reversed: true };
    /// assert_eq!(face.triangles().collect::<Vec<_>>(), [[3, 8, 5], [3, 6, 8]]);
    /// ```
    pub fn triangles(self) -> impl Iterator<Item = [u32; 3]> + 'a {
        let first = self.around[0];
        self.around[1..]
            .windows(2)
            .map(move |two| if self.is_reversed { [first, two[1], two[0]] } else { [first, two[0], two[1]] })
    }
}

impl<'a> PolyhedraView<'a> {
    /// The run of cells `cells`.
    pub(super) fn run(self, cells: std::ops::Range<usize>) -> Self {
        Self { starts: &self.starts[cells.start..=cells.end], ..self }
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices of cell `cell`, ascending.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn corners(&self, cell: usize) -> &'a [u32] {
        &self.corners[self.starts[cell][1] as usize..self.starts[cell + 1][1] as usize]
    }

    /// The faces of cell `cell`.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn faces(self, cell: usize) -> impl ExactSizeIterator<Item = PolyFace<'a>> + Clone {
        let sides = &self.sides[self.starts[cell][0] as usize..self.starts[cell + 1][0] as usize];
        sides.iter().map(move |&side| self.face(side))
    }

    #[inline]
    fn face(&self, side: u32) -> PolyFace<'a> {
        let number = side / 2;
        let [start, end] = [self.face_starts[number as usize], self.face_starts[number as usize + 1]];
        PolyFace { number, around: &self.around[start as usize..end as usize], is_reversed: side & 1 == 1 }
    }

    /// The volume of cell `cell`, whose vertices stand at `position`.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn volume(&self, cell: usize, position: impl Fn(u32) -> Vec3) -> f64 {
        let first = position(self.corners(cell)[0]).as_dvec3();
        let at = |vertex: u32| -> DVec3 { position(vertex).as_dvec3() - first };
        let of_triangle = |triangle: [u32; 3]| {
            let [a, b, c] = triangle.map(at);
            a.dot(b.cross(c))
        };
        self.faces(cell).flat_map(PolyFace::triangles).map(of_triangle).sum::<f64>() / 6.0
    }
}
