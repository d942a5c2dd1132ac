//! Which cells share a face, in bounded memory.
//!
//! In: the written cells. Out: columns, for each cell and each of its faces the cell across: those of [`Neighbours`](crate::columns::Neighbours),
//! found in the same way. What blocks leave over is sorted by face; what that finds is sorted by cell and merged with what the blocks know,
//! which are looked at again: nothing is kept for each cell.

use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;

use super::directory::Span;
use super::external_sort::{ExternalSort, Sorted};
use super::order::{CELLS_AT_ONCE, Tell};
use super::sink::Sink;
use super::write::Phase;
use crate::columns::{CellColumns, Faces, HEX_FACES, Joiner, Neighbours, Side, TET_FACES, within_blocks};
use crate::control::Control;
use crate::error::Result;

/// Words of what is found: a cell, which of its faces, and the cell across.
const FOUND_WORDS: usize = 3;

/// Writes the columns of tetrahedra and of hexahedra, sorting in `memory_bytes`.
pub(super) fn write(
    cells: CellColumns,
    path: &Path,
    memory_bytes: u64,
    sink: &mut Sink,
    tell: Tell,
) -> Result<[Span; 2]> {
    let faces = Faces::new(cells);
    let [tets, hexahedra] = faces.listed();
    let (of_tets, of_hexahedra) = (0..tets, tets..tets + hexahedra);
    let mut pass = Pass { faces: &faces, tell, done: 0, cells_of_passes: 2 * (tets + hexahedra) as u64 };
    let mut open = ExternalSort::new(path, memory_bytes / 2);
    pass.leave_over::<TET_FACES>(of_tets.clone(), &mut open)?;
    pass.leave_over::<HEX_FACES>(of_hexahedra.clone(), &mut open)?;
    let mut found = Found::new(join(open, path, memory_bytes / 2)?)?;
    Ok([
        pass.write_rows::<TET_FACES>(of_tets, &mut found, sink)?,
        pass.write_rows::<HEX_FACES>(of_hexahedra, &mut found, sink)?,
    ])
}

/// Finds the two sides of each face among those that blocks left over; by cell.
fn join<'a>(
    open: ExternalSort<'a, { Side::WORDS }>,
    path: &'a Path,
    memory_bytes: u64,
) -> Result<Sorted<'a, FOUND_WORDS>> {
    let mut found = ExternalSort::new(path, memory_bytes);
    let (mut joiner, mut some) = (Joiner::default(), Vec::new());
    let mut open = open.sorted()?;
    while let Some(side) = open.next()? {
        if let Some([one, other]) = joiner.join(bytemuck::cast(side)) {
            let across = |side: Side, other: Side| [side.cell(), side.face(), other.cell()].map(|word| word as u32);
            some.extend([across(one, other), across(other, one)]);
        }
        if some.len() >= CELLS_AT_ONCE {
            found.push_all(&some)?;
            some.clear();
        }
    }
    found.push_all(&some)?;
    found.sorted()
}

/// What was found, cell by cell.
struct Found<'a> {
    sorted: Sorted<'a, FOUND_WORDS>,
    next: Option<[u32; FOUND_WORDS]>,
}

impl<'a> Found<'a> {
    fn new(mut sorted: Sorted<'a, FOUND_WORDS>) -> Result<Self> {
        let next = sorted.next()?;
        Ok(Self { sorted, next })
    }

    /// Fills in what was found of the cells from `first` on that `rows` has, if all before them have been asked for.
    fn fill<const N: usize>(&mut self, first: usize, rows: &mut [[u32; N]]) -> Result<()> {
        while let Some([cell, face, across]) = self.next
            && let Some(row) = rows.get_mut(cell as usize - first)
        {
            row[face as usize] = across;
            self.next = self.sorted.next()?;
        }
        Ok(())
    }
}

/// One look at all blocks, or two.
struct Pass<'a> {
    faces: &'a Faces<'a>,
    tell: Tell<'a>,
    done: u64,
    cells_of_passes: u64,
}

impl Pass<'_> {
    /// Takes the sides of `cells`, all of one kind, whose other is not in the same block.
    fn leave_over<const N: usize>(
        &mut self,
        cells: Range<usize>,
        open: &mut ExternalSort<{ Side::WORDS }>,
    ) -> Result<()> {
        self.each(cells, |faces, first, rows: &mut [[u32; N]]| {
            let sides: Vec<Side> = within_blocks(&Control::default(), faces, first, rows).flatten_iter().collect();
            open.push_all(bytemuck::cast_slice(&sides))
        })
    }

    /// Writes the rows of `cells`, all of one kind.
    fn write_rows<const N: usize>(&mut self, cells: Range<usize>, found: &mut Found, sink: &mut Sink) -> Result<Span> {
        let mut column = sink.column(Some((cells.len() * size_of::<[u32; N]>()) as u64));
        self.each(cells, |faces, first, rows: &mut [[u32; N]]| {
            within_blocks(&Control::default(), faces, first, rows).for_each(drop);
            found.fill(first, rows)?;
            sink.append(&mut column, bytemuck::cast_slice(rows.as_flattened()))
        })?;
        sink.finish(column)
    }

    /// Calls `work` with some blocks of `cells` at a time: their first cell, and rows without a neighbour.
    fn each<const N: usize>(
        &mut self,
        cells: Range<usize>,
        mut work: impl FnMut(&Faces, usize, &mut [[u32; N]]) -> Result<()>,
    ) -> Result<()> {
        for first in cells.clone().step_by(CELLS_AT_ONCE) {
            let end = (first + CELLS_AT_ONCE).min(cells.end);
            work(self.faces, first, &mut vec![[Neighbours::NONE; N]; end - first])?;
            self.done += (end - first) as u64;
            (self.tell)(Phase::Neighbours, self.done, self.cells_of_passes);
        }
        Ok(())
    }
}
