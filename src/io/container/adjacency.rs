//! Which cells share a face, in bounded memory.
//!
//! In: the written cells. Out: a column, for each cell and each of its vertices the cell across the face opposite to it.
//! Most faces are shared within a block and found there. The rest are sorted by their vertices, those that are equal are
//! two sides of one face; what they found is sorted by cell and merged with what the blocks know.

use std::path::Path;

use rayon::prelude::*;

use super::directory::Span;
use super::external_sort::ExternalSort;
use super::order::Tell;
use super::sink::Sink;
use super::write::Phase;
use crate::columns::{Dataset, Tets};
use crate::error::Result;

/// No cell lies across the face.
pub(super) const NONE: u32 = u32::MAX;

/// Blocks that are handled at once.
const BLOCKS_AT_ONCE: usize = 64;

/// Writes the column, sorting in `memory_bytes`.
pub(super) fn write(tets: &Tets, path: &Path, memory_bytes: u64, sink: &mut Sink, tell: Tell) -> Result<Span> {
    let blocks = tets.len().div_ceil(Dataset::BLOCK_CELLS);
    // Faces that have no other side in their block: three vertices, cell, which of its faces.
    let mut open = ExternalSort::<5>::new(path, memory_bytes / 2);
    for first in (0..blocks).step_by(BLOCKS_AT_ONCE) {
        let end = (first + BLOCKS_AT_ONCE).min(blocks);
        let faces: Vec<[u32; 5]> = (first..end).into_par_iter().flat_map_iter(|b| Faces::of(tets, b).open).collect();
        open.push_all(&faces)?;
        tell(Phase::Neighbours, end as u64, 2 * blocks as u64);
    }
    let mut open = open.sorted()?;
    let mut found = ExternalSort::<3>::new(path, memory_bytes / 2);
    let (mut pairs, mut last) = (Vec::new(), None);
    while let Some(side) = open.next()? {
        last = match last {
            Some(other) if face_of(other) == face_of(side) => {
                pairs.extend(both_sides(other, side));
                // A third cell at a face is left without a neighbour there, in the order of the cells.
                None
            }
            _ => Some(side),
        };
        if pairs.len() >= Dataset::BLOCK_CELLS * BLOCKS_AT_ONCE {
            found.push_all(&pairs)?;
            pairs.clear();
        }
    }
    found.push_all(&pairs)?;

    let mut found = found.sorted()?;
    let mut next = found.next()?;
    let mut column = sink.column(Some(tets.len() as u64 * 16));
    for first in (0..blocks).step_by(BLOCKS_AT_ONCE) {
        let end = (first + BLOCKS_AT_ONCE).min(blocks);
        let mut known: Vec<[u32; 4]> =
            (first..end).into_par_iter().flat_map_iter(|b| Faces::of(tets, b).neighbours).collect();
        let base = first * Dataset::BLOCK_CELLS;
        while let Some([cell, face, neighbour]) = next
            && (cell as usize) < base + known.len()
        {
            known[cell as usize - base][face as usize] = neighbour;
            next = found.next()?;
        }
        sink.append(&mut column, bytemuck::cast_slice(&known))?;
        tell(Phase::Neighbours, (blocks + end) as u64, 2 * blocks as u64);
    }
    sink.finish(column)
}

fn face_of([a, b, c, _, _]: [u32; 5]) -> [u32; 3] {
    [a, b, c]
}

fn both_sides([.., cell, face]: [u32; 5], [.., other_cell, other_face]: [u32; 5]) -> [[u32; 3]; 2] {
    [[cell, face, other_cell], [other_cell, other_face, cell]]
}

/// What a block knows of its faces.
struct Faces {
    neighbours: Vec<[u32; 4]>,
    open: Vec<[u32; 5]>,
}

impl Faces {
    fn of(tets: &Tets, block: usize) -> Self {
        let (view, first) = (tets.view(), block * Dataset::BLOCK_CELLS);
        let cells = first..(first + Dataset::BLOCK_CELLS).min(tets.len());
        let mut sides: Vec<[u32; 5]> = cells
            .clone()
            .flat_map(|cell| {
                let [a, b, c, d] = view.get(cell);
                let faces = [[b, c, d], [a, c, d], [a, b, d], [a, b, c]];
                (0..4).map(move |k| [faces[k][0], faces[k][1], faces[k][2], cell as u32, k as u32])
            })
            .collect();
        sides.sort_unstable();
        let mut found = Self { neighbours: vec![[NONE; 4]; cells.len()], open: Vec::new() };
        let mut rest = &sides[..];
        while let Some((&side, after)) = rest.split_first() {
            rest = after;
            match after.split_first() {
                Some((&other, after)) if face_of(other) == face_of(side) => {
                    for [cell, face, neighbour] in both_sides(side, other) {
                        found.neighbours[cell as usize - first][face as usize] = neighbour;
                    }
                    rest = after;
                }
                _ => found.open.push(side),
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::generate::{Kind, Settings, generate};
    use crate::io::container::{WriteOptions, open, write as write_container};

    #[test]
    fn neighbours_are_those_of_a_hash_map_in_any_memory() {
        let mesh = generate(Kind::Delaunay, &Settings { cells: 30_000, ..Settings::default() }).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.cells");
        for memory_bytes in [0, 1 << 30] {
            let options = WriteOptions { memory_bytes, adjacency: true };
            write_container(&mesh, &path, &options, &|_, _, _| {}).unwrap();
            let dataset = open(&path, true).unwrap();
            let adjacency = dataset.adjacency.as_ref().unwrap();
            let mut cells_at = HashMap::<Vec<u32>, Vec<usize>>::new();
            let face = |tet: [u32; 4], k: usize| (0..4).filter(|&i| i != k).map(|i| tet[i]).collect::<Vec<_>>();
            for (cell, tet) in dataset.tets.iter().enumerate() {
                (0..4).for_each(|k| cells_at.entry(face(tet, k)).or_default().push(cell));
            }
            let mut inner = 0;
            for (cell, tet) in dataset.tets.iter().enumerate() {
                for k in 0..4 {
                    let other = cells_at[&face(tet, k)].iter().find(|&&other| other != cell);
                    assert_eq!(adjacency[cell][k], other.map_or(NONE, |&other| other as u32));
                    inner += usize::from(other.is_some());
                }
            }
            assert!(inner > 3 * dataset.tets.len());
            crate::io::container::check(&path, true).unwrap();
        }
    }
}
