//! `FaceLists`: the faces of polyhedra as files have them, cell by cell.

/// For each cell the points around each of its faces; in any way round, in any order.
///
/// ```
/// # use cellfan::columns::FaceLists;
/// let mut lists = FaceLists::default();
/// for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
///     lists.push_face(&face);
/// }
/// lists.end_cell();
/// assert_eq!((lists.cells(), lists.faces(0).count()), (1, 4));
/// assert_eq!(lists.faces(0).nth(1), Some(&[0, 1, 3][..]));
/// assert_eq!(lists.faces(7).count(), 0);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaceLists {
    /// Where the faces of each cell end.
    face_ends: Vec<usize>,
    /// Where the points of each face end.
    point_ends: Vec<usize>,
    points: Vec<u32>,
}

impl FaceLists {
    /// Adds a face to the cell at hand.
    pub fn push_face(&mut self, points: &[u32]) {
        self.points.extend_from_slice(points);
        self.point_ends.push(self.points.len());
    }

    /// Ends the cell at hand: faces pushed from now on are those of the next.
    pub fn end_cell(&mut self) {
        self.face_ends.push(self.point_ends.len());
    }

    /// Adds cells without faces until there are `cells`.
    pub fn pad(&mut self, cells: usize) {
        let end = self.face_ends.last().copied().unwrap_or(0);
        self.face_ends.resize(cells.max(self.face_ends.len()), end);
    }

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.face_ends.len()
    }

    /// Whether no cell has a face.
    pub fn is_empty(&self) -> bool {
        self.point_ends.is_empty()
    }

    /// The points around each face of cell `cell`; none of a cell that is not there.
    pub fn faces(&self, cell: usize) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        let before = |ends: &[usize], i: usize| i.checked_sub(1).map_or(0, |last| ends[last]);
        let faces = self.face_ends.get(cell).map_or(0..0, |&end| before(&self.face_ends, cell)..end);
        faces.map(move |face| &self.points[before(&self.point_ends, face)..self.point_ends[face]])
    }

    /// The points of all faces of all cells.
    pub fn points(&self) -> &[u32] {
        &self.points
    }

    /// Adds the cells of `other`, each point as `place` has it.
    pub fn append(&mut self, other: &Self, place: impl Fn(u32) -> u32) {
        let (faces, points) = (self.point_ends.len(), self.points.len());
        self.face_ends.extend(other.face_ends.iter().map(|end| end + faces));
        self.point_ends.extend(other.point_ends.iter().map(|end| end + points));
        self.points.extend(other.points.iter().map(|&point| place(point)));
    }

    /// Adds cell `cell` of `other`.
    pub fn push_cell(&mut self, other: &Self, cell: usize) {
        other.faces(cell).for_each(|face| self.push_face(face));
        self.end_cell();
    }
}
