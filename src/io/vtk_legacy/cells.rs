//! CELLS in its two forms: counts between the indices, or (from version 5) OFFSETS and CONNECTIVITY.

use super::super::offsets;
use super::super::source::Source;
use super::cursor::Cursor;
use crate::error::{Error, Result};

/// The cells as the file has them.
#[derive(Debug)]
pub(super) struct Cells {
    offsets: Vec<u64>,
    indices: Vec<u64>,
}

impl Default for Cells {
    fn default() -> Self {
        Self { offsets: vec![0], indices: Vec::new() }
    }
}

impl Cells {
    /// How many cells there are.
    pub(super) fn count(&self) -> usize {
        self.offsets.len() - 1
    }

    pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<Self> {
        let first = cursor.count("the number of cells")?;
        let second = cursor.count("the size of the list of cells")?;
        if cursor.next_is("OFFSETS") {
            Self::read_offsets(cursor, first, second)
        } else {
            Self::read_inline(cursor, first, second)
        }
    }

    fn read_offsets(cursor: &mut Cursor<'_>, offset_count: usize, index_count: usize) -> Result<Self> {
        let mut column = |keyword: &str, count: usize| {
            if cursor.next_keyword().as_deref() != Some(keyword) {
                return Err(cursor.malformed(format!("{keyword} is expected here")));
            }
            let number = cursor.number_type()?;
            let column = cursor.tuples(number, count, 1)?;
            cursor.whole_numbers(&column, keyword)
        };
        let offsets = column("OFFSETS", offset_count)?;
        let indices = column("CONNECTIVITY", index_count)?;
        if offsets.is_empty() {
            return Ok(Self::default());
        }
        offsets::check(&offsets, indices.len()).map_err(|problem| cursor.source.malformed("OFFSETS", problem))?;
        Ok(Self { offsets, indices })
    }

    fn read_inline(cursor: &mut Cursor<'_>, cell_count: usize, size: usize) -> Result<Self> {
        let list = cursor.integers(size)?;
        // Every cell has its count in the list.
        if cell_count > list.len() {
            return Err(cursor.malformed(format!("CELLS: {cell_count} cells cannot be in a list of {size}")));
        }
        let mut cells = Self { offsets: Vec::with_capacity(cell_count + 1), indices: Vec::with_capacity(size) };
        cells.offsets.push(0);
        let mut rest = &list[..];
        for cell in 0..cell_count {
            let taken =
                rest.split_first().and_then(|(&count, rest)| rest.split_at_checked(usize::try_from(count).ok()?));
            let (corners, after) = taken.ok_or_else(|| {
                let problem = format!("cell {cell} goes beyond the list of {size} values: damaged or truncated");
                cursor.source.malformed("CELLS", problem)
            })?;
            rest = after;
            for &index in corners {
                let index = u64::try_from(index)
                    .map_err(|_| cursor.source.malformed("CELLS", format!("cell {cell} refers to point {index}")))?;
                cells.indices.push(index);
            }
            cells.offsets.push(cells.indices.len() as u64);
        }
        if !rest.is_empty() {
            let problem = format!("{} of {size} values are left after {cell_count} cells: damaged", rest.len());
            return Err(cursor.source.malformed("CELLS", problem));
        }
        Ok(cells)
    }

    /// Offsets and connectivity; whether the points exist is checked with the cells' kinds, since the list of a
    /// polyhedron is not one of points.
    pub(super) fn into_columns(self, points: u64, source: Source<'_>) -> Result<(Vec<u64>, Vec<u32>)> {
        let too_large = self.indices.iter().position(|&index| index > u64::from(u32::MAX));
        if let Some(entry) = too_large {
            let cell = offsets::cell_of(&self.offsets, entry);
            let index = self.indices[entry] as i64;
            return Err(Error::IndexOutOfRange { column: "CELLS", cell, index, len: points }.in_file(source.path));
        }
        Ok((self.offsets, self.indices.into_iter().map(|index| index as u32).collect()))
    }
}
