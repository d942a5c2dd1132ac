//! [`LentMesh`]: a mesh in NumPy arrays, which are held.

use cellfan::cells::{CellKind, KINDS};
use cellfan::session::{Cells, MeshView};
use pyo3::prelude::*;

use crate::arrays::{Lent, LentIndices, LentPositions, lent_types};
use crate::error::refused;

enum LentCells {
    OfKind(&'static CellKind, LentIndices),
    Mixed { types: Lent<u8>, offsets: LentIndices, points: LentIndices },
    Structured([usize; 3]),
}

/// Points and cells in arrays that are held.
pub(crate) struct LentMesh {
    positions: LentPositions,
    cells: LentCells,
}

/// Positions, connectivity, offsets, types, VTK's code of all cells, points along the axes of a structured grid; each as Python gives it.
pub(crate) type Parts<'py> = (
    Bound<'py, PyAny>,
    Option<Bound<'py, PyAny>>,
    Option<Bound<'py, PyAny>>,
    Option<Bound<'py, PyAny>>,
    Option<u8>,
    Option<[usize; 3]>,
);

impl LentMesh {
    /// Takes the arrays of a mesh.
    pub(crate) fn new((positions, connectivity, offsets, types, kind, dims): &Parts<'_>) -> PyResult<Self> {
        let cells = match (connectivity, offsets, types, kind, dims) {
            (None, None, None, None, Some(dims)) => LentCells::Structured(*dims),
            (Some(points), None, None, Some(code), None) => {
                let kind = KINDS.into_iter().find(|kind| kind.code == *code);
                let kind = kind.ok_or_else(|| refused(format!("kind: {code} is no cell with a volume of VTK's")))?;
                LentCells::OfKind(kind, LentIndices::new("connectivity", points)?)
            }
            (Some(points), Some(offsets), Some(types), None, None) => LentCells::Mixed {
                types: lent_types(types)?,
                offsets: LentIndices::new("offsets", offsets)?,
                points: LentIndices::new("connectivity", points)?,
            },
            _ => {
                let problem = "give connectivity and kind, or connectivity, offsets and types, or dims alone";
                return Err(refused(format!("a mesh of what cells? {problem}")));
            }
        };
        Ok(Self { positions: LentPositions::new(positions)?, cells })
    }

    /// The same as slices.
    pub(crate) fn view(&self) -> cellfan::Result<MeshView<'_, 'static>> {
        let cells = match &self.cells {
            LentCells::OfKind(kind, points) => Cells::OfKind { kind, points: points.get() },
            LentCells::Mixed { types, offsets, points } => {
                Cells::Mixed { types: types.get(), offsets: offsets.get(), points: points.get() }
            }
            LentCells::Structured(dims) => Cells::Structured { dims: *dims },
        };
        Ok(MeshView::new(self.positions.get()?, cells))
    }
}
