//! CELLS in its two forms: counts between the indices, or (from version 5) OFFSETS and CONNECTIVITY.

use super::super::offsets;
use super::super::scratch::collect;
use super::super::source::Source;
use super::cursor::Cursor;
use crate::columns::Column;
use crate::error::{Error, Result};

/// The cells as the file has them.
#[derive(Debug)]
pub(super) struct Cells {
    offsets: Column<u64>,
    indices: Column<u64>,
}

impl Cells {
    pub(super) fn none() -> Self {
        Self { offsets: vec![0].into(), indices: Vec::new().into() }
    }

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
            return Ok(Self::none());
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
        let scratch = cursor.source.scratch;
        let (mut offsets, mut indices) = (scratch.column(), scratch.column());
        offsets.reserve(cell_count + 1);
        indices.reserve(size);
        offsets.push(0)?;
        let value = |entry: usize| list.get(entry) as i64;
        let mut end = 0;
        for cell in 0..cell_count {
            let corners = (end < list.len()).then(|| {
                let count = usize::try_from(value(end)).ok()?;
                (count < list.len() - end).then_some(end + 1..end + 1 + count)
            });
            let corners = corners.flatten().ok_or_else(|| {
                let problem = format!("cell {cell} goes beyond the list of {size} values: damaged or truncated");
                cursor.source.malformed("CELLS", problem)
            })?;
            end = corners.end;
            for index in corners.map(value) {
                let index = u64::try_from(index)
                    .map_err(|_| cursor.source.malformed("CELLS", format!("cell {cell} refers to point {index}")))?;
                indices.push(index)?;
            }
            offsets.push(indices.len() as u64)?;
        }
        if end < list.len() {
            let problem = format!("{} of {size} values are left after {cell_count} cells: damaged", list.len() - end);
            return Err(cursor.source.malformed("CELLS", problem));
        }
        Ok(Self { offsets: offsets.finish()?, indices: indices.finish()? })
    }

    /// Offsets and connectivity; whether the points exist is checked with the cells' kinds, since the list of a
    /// polyhedron is not one of points.
    pub(super) fn into_columns(self, points: u64, source: Source<'_>) -> Result<(Column<u64>, Column<u32>)> {
        let connectivity = self.indices.iter().enumerate().map(|(entry, &index)| {
            u32::try_from(index).map_err(|_| {
                let cell = offsets::cell_of(&self.offsets, entry);
                let index = index as i64;
                Error::IndexOutOfRange { column: "CELLS", cell, index, len: points }.in_file(source.path)
            })
        });
        let connectivity = collect(source.scratch, connectivity)?;
        Ok((self.offsets, connectivity))
    }
}
