//! Finds the two sides of every face. Faces go to the bucket of their lowest vertex (count, scan, write), where the two sides of one
//! are found by sorting some twenty-four.
//!
//! O(cells), in parallel; 16 bytes for each face of as many vertices as fit into the scratch at once, 24 where there are hexahedra.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::Adjacency;
use crate::columns::Dataset;
use crate::stages::scatter::as_atomic;
use crate::stages::sort::faces::{FaceName, Faces, HEX_FACES, TET_FACES};

/// Faces in the scratch at once, 16 or 24 bytes each: all of them up to eight million tetrahedra.
pub(super) const SCRATCH_FACES: usize = 1 << 25;
/// Vertices whose buckets one thread takes at a time.
const VERTICES: usize = 1 << 12;

/// The rows of tetrahedra and of listed hexahedra.
pub(super) type Rows = (Vec<[u32; TET_FACES]>, Vec<[u32; HEX_FACES]>);

/// Makes the rows with at most `scratch_faces` faces at once, those of one vertex at least. Structured blocks have none.
pub(super) fn build(dataset: &Dataset, scratch_faces: usize) -> Rows {
    let are_listed = dataset.hexahedra.structured_blocks().is_empty();
    let hexahedra = if are_listed { dataset.hexahedra.len() } else { 0 };
    if hexahedra == 0 {
        build_with::<TetSide>(dataset, hexahedra, scratch_faces)
    } else {
        build_with::<CellSide>(dataset, hexahedra, scratch_faces)
    }
}

/// One side of a face in the bucket of its lowest vertex, as words that sort by face: the rest of its name, then cell, face and whether
/// its vertices ascend.
trait Side: bytemuck::Pod + Ord + Send + Sync {
    fn new(name: FaceName, code: u64) -> Self;
    fn words(&self) -> &[u64];

    fn code(&self) -> u64 {
        self.words().last().copied().unwrap_or_default()
    }

    fn is_of_same_face(&self, other: &Self) -> bool {
        let (words, others) = (self.words(), other.words());
        words[..words.len() - 1] == others[..others.len() - 1]
    }
}

/// Tetrahedra alone: faces have no fourth corner.
type TetSide = [u64; 2];
type CellSide = [u64; 3];

impl Side for TetSide {
    fn new(FaceName { beside: [a, b], .. }: FaceName, code: u64) -> Self {
        [u64::from(a) << 32 | u64::from(b), code]
    }

    fn words(&self) -> &[u64] {
        self
    }
}

impl Side for CellSide {
    fn new(FaceName { beside: [a, b], opposite, .. }: FaceName, code: u64) -> Self {
        [u64::from(a) << 32 | u64::from(b), opposite, code]
    }

    fn words(&self) -> &[u64] {
        self
    }
}

fn code(cell: usize, k: usize, ascends: bool) -> u64 {
    (cell as u64) << 4 | (k as u64) << 1 | u64::from(ascends)
}

fn cell_and_face(code: u64) -> (usize, usize) {
    ((code >> 4) as usize, (code >> 1 & 7) as usize)
}

fn ascends(code: u64) -> bool {
    code & 1 == 1
}

/// The rows while threads write them.
struct Table {
    tets: Vec<[AtomicU32; TET_FACES]>,
    hexahedra: Vec<[AtomicU32; HEX_FACES]>,
}

impl Table {
    fn set(&self, (cell, k): (usize, usize), other: usize) {
        let place = match cell.checked_sub(self.tets.len()) {
            None => &self.tets[cell][k],
            Some(cell) => &self.hexahedra[cell][k],
        };
        place.store(other as u32, Ordering::Relaxed);
    }
}

fn build_with<S: Side>(dataset: &Dataset, hexahedra: usize, scratch_faces: usize) -> Rows {
    let faces = Faces::new(dataset);
    let cells = dataset.tets.len() + hexahedra;
    let faces_from_vertex: Vec<AtomicU32> = (0..dataset.positions.len()).map(|_| AtomicU32::new(0)).collect();
    for_each_side(&faces, cells, |vertex, _: S| {
        faces_from_vertex[vertex as usize].fetch_add(1, Ordering::Relaxed);
    });
    let faces_from_vertex: Vec<u32> = faces_from_vertex.into_iter().map(AtomicU32::into_inner).collect();
    let table = Table {
        tets: (0..dataset.tets.len()).map(|_| none()).collect(),
        hexahedra: (0..hexahedra).map(|_| none()).collect(),
    };

    let mut words = Vec::new();
    let mut first = 0;
    while first < faces_from_vertex.len() {
        let (mut starts, mut end, mut count) = (Vec::new(), first, 0);
        while let Some(&more) = faces_from_vertex.get(end)
            && (end == first || count + more as usize <= scratch_faces)
        {
            starts.push(count);
            count += more as usize;
            end += 1;
        }
        starts.push(count);
        words.resize(size_of::<S>() / 8 * count, 0);
        write::<S>(&faces, cells, first..end, &starts, &mut words);
        join::<S>(&starts, bytemuck::cast_slice_mut(&mut words), &table);
        first = end;
    }
    (rows(table.tets), rows(table.hexahedra))
}

fn none<const N: usize>() -> [AtomicU32; N] {
    [(); N].map(|()| AtomicU32::new(Adjacency::NONE))
}

fn rows<const N: usize>(rows: Vec<[AtomicU32; N]>) -> Vec<[u32; N]> {
    rows.into_iter().map(|row| row.map(AtomicU32::into_inner)).collect()
}

/// Calls `work` with the lowest vertex of every face of the first `cells` cells, and the side.
fn for_each_side<S: Side>(faces: &Faces, cells: usize, work: impl Fn(u32, S) + Sync) {
    (0..cells).into_par_iter().with_min_len(Dataset::BLOCK_CELLS).for_each(|cell| {
        faces.for_each(cell, |k, name, ascends| work(name.lowest, S::new(name, code(cell, k, ascends))));
    });
}

/// Writes the sides with a lowest vertex in `vertices` to its bucket, which begins at `starts`.
fn write<S: Side>(faces: &Faces, cells: usize, vertices: Range<usize>, starts: &[usize], words: &mut [u64]) {
    let taken: Vec<AtomicU32> = vertices.clone().map(|_| AtomicU32::new(0)).collect();
    let out = as_atomic(words);
    for_each_side(faces, cells, |vertex, side: S| {
        if vertices.contains(&(vertex as usize)) {
            let bucket = vertex as usize - vertices.start;
            let place = starts[bucket] + taken[bucket].fetch_add(1, Ordering::Relaxed) as usize;
            let side = side.words();
            for (i, &word) in side.iter().enumerate() {
                out[side.len() * place + i].store(word, Ordering::Relaxed);
            }
        }
    });
}

/// Finds the two sides of each face among those of its bucket. Which thread wrote first is left to chance: buckets are sorted.
fn join<S: Side>(starts: &[usize], sides: &mut [S], table: &Table) {
    let mut runs = Vec::new();
    let mut rest = sides;
    for starts in starts.windows(2).collect::<Vec<_>>().chunks(VERTICES) {
        let (run, after) = rest.split_at_mut(starts.iter().map(|two| two[1] - two[0]).sum());
        runs.push((starts.to_vec(), run));
        rest = after;
    }
    runs.into_par_iter().for_each(|(starts, run)| {
        let mut rest = run;
        for two in starts {
            let (bucket, after) = rest.split_at_mut(two[1] - two[0]);
            rest = after;
            bucket.sort_unstable();
            for face in bucket.chunk_by(S::is_of_same_face).filter(|face| face.len() > 1) {
                // Two, as a rule. Where more cells meet, those on either side are taken in order; one left over has no neighbour.
                let codes = || face.iter().map(S::code);
                let (one_side, other_side) =
                    (codes().filter(|&code| ascends(code)), codes().filter(|&code| !ascends(code)));
                for (one, other) in one_side.zip(other_side) {
                    let (one, other) = (cell_and_face(one), cell_and_face(other));
                    // A cell that is folded upon itself is not its own neighbour.
                    if one.0 != other.0 {
                        table.set(one, other.0);
                        table.set(other, one.0);
                    }
                }
            }
        }
    });
}
