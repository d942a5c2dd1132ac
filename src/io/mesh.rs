//! `UnstructuredMesh`: cells of any kinds in file order, as VTK's unstructured grids hold them.

use super::face_streams::{POLYHEDRON, points_of};
use super::scratch::Scratch;
use super::{concat, numbers};
use crate::cells::{TETRAHEDRON, hexahedron_of, kind_of_hexahedron};
use crate::columns::{Array, Association, CellMesh, Column, FaceLists, Points, TetMesh};
use crate::error::{Error, Result};

/// An unstructured grid in file order; nothing in it has been checked against anything else.
///
/// ```
/// # use cellfan::{columns::Points, io::UnstructuredMesh};
/// let mesh = UnstructuredMesh {
///     points: Points::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
///     types: vec![10].into(),
///     offsets: vec![0, 4].into(),
///     connectivity: vec![0, 1, 2, 3].into(),
///     ..UnstructuredMesh::empty()
/// };
/// assert_eq!(mesh.into_dataset().unwrap().tets.len(), 1);
/// ```
#[derive(Clone, Debug)]
pub struct UnstructuredMesh {
    /// All points of the file.
    pub points: Points,
    /// VTK's code of each cell.
    pub types: Column<u8>,
    /// Where in `connectivity` each cell begins, and the end: one entry more than there are cells.
    pub offsets: Column<u64>,
    /// The points of the cells, one cell after the other.
    pub connectivity: Column<u32>,
    /// The faces of each polyhedron (VTK's code 42); other cells have none, and those at the end need not be there.
    pub faces: FaceLists,
    /// Arrays over the points and cells.
    pub arrays: Vec<Array>,
}

impl UnstructuredMesh {
    /// A mesh without points and cells.
    pub fn empty() -> Self {
        let (types, connectivity) = (Vec::new().into(), Vec::new().into());
        let (points, faces) = (Points::F32(Vec::new()), FaceLists::default());
        Self { points, types, offsets: vec![0].into(), connectivity, faces, arrays: Vec::new() }
    }

    /// How many cells there are, of any kind.
    pub fn cells(&self) -> usize {
        self.types.len()
    }

    /// The points of cell `cell`; `None` where the offsets do not give any.
    pub fn cell(&self, cell: usize) -> Option<&[u32]> {
        let start = usize::try_from(*self.offsets.get(cell)?).ok()?;
        let end = usize::try_from(*self.offsets.get(cell.checked_add(1)?)?).ok()?;
        self.connectivity.get(start..end)
    }

    /// The array of that name and association, if there is one.
    pub fn array(&self, name: &str, association: Association) -> Option<&Array> {
        self.arrays.iter().find(|array| array.name == name && array.association == association)
    }

    /// Tetrahedra as a mesh that can be written; cell arrays are repeated where a file's cell was split.
    pub fn from_tets(mesh: &TetMesh) -> Self {
        let TetMesh { points, tets, file_from_tet, arrays, .. } = mesh;
        let array = |array: &Array| match array.association {
            Association::Point => array.clone(),
            Association::Cell => {
                let values = numbers::gather(&array.values, array.components, file_from_tet);
                Array { values, ..array.clone() }
            }
        };
        Self {
            points: points.clone(),
            types: vec![10; tets.len()].into(),
            offsets: (0..=tets.len() as u64).map(|tet| 4 * tet).collect(),
            connectivity: tets.as_flattened().to_vec().into(),
            faces: FaceLists::default(),
            arrays: arrays.iter().map(array).collect(),
        }
    }

    /// Cells as a mesh that can be written, tetrahedra first, polyhedra last; hexahedra that repeat corners as the wedges and pyramids that they are.
    /// Cell arrays are repeated where a file's cell was split.
    ///
    /// ```
    /// # use cellfan::generate::{CellShape, Phenomenon, PhenomenonSettings, phenomenon};
    /// # use cellfan::io::UnstructuredMesh;
    /// let prisms = PhenomenonSettings { shape: CellShape::Prisms, ..Default::default() };
    /// let mesh = UnstructuredMesh::from_cells(&phenomenon(Phenomenon::CampFire, &prisms)?);
    /// assert!(mesh.types.iter().all(|&code| code == 13) && mesh.cell(0).unwrap().len() == 6);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn from_cells(mesh: &CellMesh) -> Self {
        let CellMesh { points, tets, file_from_tet, hexahedra, file_from_hexahedron, polyhedra, arrays, .. } = mesh;
        let mut types = vec![TETRAHEDRON.code; tets.len()];
        let mut offsets: Vec<u64> = (0..=tets.len() as u64).map(|tet| 4 * tet).collect();
        let mut connectivity = tets.as_flattened().to_vec();
        for corners in &hexahedra[..] {
            let kind = kind_of_hexahedron(corners);
            types.push(kind.code);
            let places = hexahedron_of(kind).unwrap_or([0, 1, 2, 3, 4, 5, 6, 7]);
            let corner = |i| places.iter().position(|&place| place == i).map(|at| corners[at]);
            connectivity.extend((0..kind.corners).filter_map(corner));
            offsets.push(connectivity.len() as u64);
        }
        let mut faces = FaceLists::default();
        if polyhedra.cells() > 0 {
            faces.pad(types.len());
            faces.append(polyhedra, |point| point);
        }
        let mut points_of_cell = Vec::new();
        for cell in 0..polyhedra.cells() {
            types.push(POLYHEDRON);
            points_of(polyhedra, cell, &mut points_of_cell);
            connectivity.extend_from_slice(&points_of_cell);
            offsets.push(connectivity.len() as u64);
        }
        let of_all = [file_from_tet, file_from_hexahedron, &mesh.file_from_polyhedron];
        let tuples: Vec<u32> = of_all.into_iter().flat_map(|of| of.iter().copied()).collect();
        let array = |array: &Array| match array.association {
            Association::Point => array.clone(),
            Association::Cell => {
                let values = numbers::gather(&array.values, array.components, &tuples);
                Array { values, ..array.clone() }
            }
        };
        Self {
            points: points.clone(),
            types: types.into(),
            offsets: offsets.into(),
            connectivity: connectivity.into(),
            faces,
            arrays: arrays.iter().map(array).collect(),
        }
    }

    /// The pieces as one mesh, in order; arrays that not all pieces have are left out.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where the points are more than `u32` can name, and those of the scratch.
    pub(super) fn concat(mut pieces: Vec<Self>, scratch: &Scratch) -> Result<Self> {
        if pieces.len() > 1 {
            pieces.retain(|piece| !piece.points.is_empty() || !piece.types.is_empty());
        }
        match pieces.len() {
            0 => return Ok(Self::empty()),
            1 => return Ok(pieces.swap_remove(0)),
            _ => {}
        }
        let arrays = concat::arrays(&pieces.iter().map(|piece| &piece.arrays[..]).collect::<Vec<_>>(), scratch)?;
        Self::concat_with(pieces, arrays, scratch)
    }

    /// The pieces as one mesh, in order, with `arrays` over all their points and cells.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where the points are more than `u32` can name, and those of the scratch.
    pub(super) fn concat_with(pieces: Vec<Self>, arrays: Vec<Array>, scratch: &Scratch) -> Result<Self> {
        let len = pieces.iter().map(|piece| piece.points.len() as u64).sum();
        let limit = u64::from(u32::MAX) - 1;
        if len > limit {
            return Err(Error::TooLarge { column: "points", len, limit });
        }
        let points = concat::points(&pieces.iter().map(|piece| &piece.points).collect::<Vec<_>>());
        let (mut types, mut offsets, mut connectivity) = (scratch.column(), scratch.column(), scratch.column());
        let mut faces = FaceLists::default();
        offsets.push(0)?;
        let mut first_point = 0;
        for piece in pieces {
            let (base, entries) = (connectivity.len() as u64, piece.connectivity.len() as u64);
            if !piece.faces.is_empty() {
                faces.pad(types.len());
            }
            types.extend(piece.types.iter().copied())?;
            // An entry or index beyond its piece must not come to name one of the next.
            let place = |&offset: &u64| if offset <= entries { base + offset } else { u64::MAX };
            offsets.extend(piece.offsets.iter().skip(1).map(place))?;
            let points = piece.points.len() as u32;
            let shift = |&index: &u32| if index < points { first_point + index } else { u32::MAX };
            connectivity.extend(piece.connectivity.iter().map(shift))?;
            if !piece.faces.is_empty() {
                faces.append(&piece.faces, |index| shift(&index));
            }
            first_point += points;
        }
        let (types, offsets, connectivity) = (types.finish()?, offsets.finish()?, connectivity.finish()?);
        Ok(Self { points, types, offsets, connectivity, faces, arrays })
    }
}
