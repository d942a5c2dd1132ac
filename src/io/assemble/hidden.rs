//! `Hidden`: the cells that a mesh's ghost arrays leave out.

use crate::columns::{Array, Association};

/// The name of VTK's array of such bits.
pub(in crate::io) const GHOST_TYPE: &str = "vtkGhostType";
/// The name of the older array: how many cells away the piece is that owns the cell.
pub(in crate::io) const GHOST_LEVELS: &str = "vtkGhostLevels";
/// The bit of a cell that another piece owns.
pub(in crate::io) const DUPLICATE_CELL: u8 = 1;
/// The bit of a cell that is hidden.
pub(in crate::io) const HIDDEN_CELL: u8 = 32;
/// The bit of a point that is hidden: every cell that uses it is left out.
pub(in crate::io) const HIDDEN_POINT: u8 = 2;

/// What the ghost arrays of a mesh hide.
pub(super) struct Hidden<'a> {
    types: Option<&'a Array>,
    levels: Option<&'a Array>,
    points: Option<&'a Array>,
}

impl<'a> Hidden<'a> {
    pub(super) fn of(arrays: &'a [Array]) -> Self {
        let find = |name: &str, association| {
            arrays.iter().find(|a| a.name == name && a.association == association && a.components == 1)
        };
        Self {
            types: find(GHOST_TYPE, Association::Cell),
            levels: find(GHOST_LEVELS, Association::Cell),
            points: find(GHOST_TYPE, Association::Point),
        }
    }

    pub(super) fn cell(&self, cell: usize) -> bool {
        self.types.is_some_and(|array| array.values.get(cell) as u8 & (DUPLICATE_CELL | HIDDEN_CELL) != 0)
            || self.levels.is_some_and(|array| array.values.get(cell) > 0.0)
    }

    pub(super) fn point(&self, point: u32) -> bool {
        self.points.is_some_and(|array| array.values.get(point as usize) as u8 & HIDDEN_POINT != 0)
    }
}
