//! `adjacency`: which cell lies across each face, and which faces have none: the exterior ones. Once a mesh.
//!
//! In: the cells, and what a container says of them. Out: [`Adjacency`]. Faces go to the bucket of their lowest vertex (count,
//! scan, write), where the two sides of one are found by sorting some twenty-four. O(cells), in parallel; 16 bytes for each face of
//! as many vertices as fit into the scratch at once.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::columns::{BlockCells, Column, Dataset};
use crate::stages::classify::{FACES, OUTWARD_IF_POSITIVE};
use crate::stages::scatter::as_atomic;

/// Faces in the scratch at once, 16 bytes each: all of them up to eight million cells.
const SCRATCH_FACES: usize = 1 << 25;
/// Vertices whose buckets one thread takes at a time.
const VERTICES: usize = 1 << 12;

/// A face of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// The cell.
    pub cell: u32,
    /// Which of its faces: the one opposite to this vertex.
    pub index: u32,
}

/// The cells across all faces of a mesh.
#[derive(Clone, Debug)]
pub struct Adjacency {
    neighbours_from_cell: Column<[u32; 4]>,
    exterior: Vec<Face>,
}

impl Adjacency {
    /// No cell lies across the face.
    pub const NONE: u32 = u32::MAX;

    /// That of `dataset`: its own column where it is right, which is looked at face by face, and otherwise made from the cells.
    pub fn new(dataset: &Dataset) -> Self {
        let neighbours_from_cell = match &dataset.adjacency {
            Some(column) if is_of(column, dataset) => column.clone(),
            _ => build(dataset, SCRATCH_FACES).into(),
        };
        let exterior_of = |(cell, row): (usize, &[u32; 4])| {
            let row = *row;
            (0..4).filter(move |&k| row[k] == Self::NONE).map(move |k| Face { cell: cell as u32, index: k as u32 })
        };
        let exterior = neighbours_from_cell.par_iter().enumerate().flat_map_iter(exterior_of).collect();
        Self { neighbours_from_cell, exterior }
    }

    /// The cell across the face opposite to each vertex of each cell; [`Adjacency::NONE`] where there is none.
    pub fn neighbours_from_cell(&self) -> &[[u32; 4]] {
        &self.neighbours_from_cell
    }

    /// The faces without a cell across, by cell.
    pub fn exterior(&self) -> &[Face] {
        &self.exterior
    }

    /// Bytes of memory that it takes; a column that is used in place counts nothing.
    pub fn owned_bytes(&self) -> u64 {
        self.neighbours_from_cell.owned_bytes() + size_of_val(&self.exterior[..]) as u64
    }
}

/// Whether the canonical normal of face `k` points out of the cell.
pub(super) fn is_outward(dataset: &Dataset, cell: usize, k: usize) -> bool {
    dataset.positive.get(cell) == OUTWARD_IF_POSITIVE[k]
}

/// Whether `column` names, across each face, a cell that has this face, lies on its other side and names the first.
fn is_of(column: &[[u32; 4]], dataset: &Dataset) -> bool {
    let tets = dataset.tets.view();
    let is_right = |cell: usize, k: usize, other: u32| {
        let Some(row) = column.get(other as usize) else { return other == Adjacency::NONE };
        let face = |cell: usize, k: usize| FACES[k].map(|i| tets.get(cell)[i]);
        let sides = (cell, other as usize);
        (0..4).any(|j| {
            row[j] as usize == cell
                && face(sides.0, k) == face(sides.1, j)
                && is_outward(dataset, sides.0, k) != is_outward(dataset, sides.1, j)
        })
    };
    let row_is_right = |(cell, row): (usize, &[u32; 4])| (0..4).all(|k| is_right(cell, k, row[k]));
    column.len() == dataset.tets.len() && column.par_iter().enumerate().all(row_is_right)
}

/// One side of a face in the bucket of its lowest vertex: the other two vertices; cell, face and whether its normal points outwards.
type Side = [u64; 2];

fn cell_and_face(side: Side) -> (usize, usize) {
    ((side[1] >> 3) as usize, (side[1] >> 1 & 3) as usize)
}

fn points_outwards(side: Side) -> bool {
    side[1] & 1 == 1
}

/// Makes the column with at most `scratch_faces` faces at once, those of one vertex at least.
fn build(dataset: &Dataset, scratch_faces: usize) -> Vec<[u32; 4]> {
    let atomics = |len: usize| -> Vec<AtomicU32> { (0..len).map(|_| AtomicU32::new(0)).collect() };
    let faces_from_vertex = atomics(dataset.positions.len());
    for_each_side(dataset, |vertex, _| {
        faces_from_vertex[vertex as usize].fetch_add(1, Ordering::Relaxed);
    });
    let faces_from_vertex: Vec<u32> = faces_from_vertex.into_iter().map(AtomicU32::into_inner).collect();
    let across: Vec<[AtomicU32; 4]> =
        (0..dataset.tets.len()).map(|_| [(); 4].map(|()| AtomicU32::new(Adjacency::NONE))).collect();

    let mut words = Vec::new();
    let mut first = 0;
    while first < faces_from_vertex.len() {
        let (mut starts, mut end, mut faces) = (Vec::new(), first, 0);
        while let Some(&more) = faces_from_vertex.get(end)
            && (end == first || faces + more as usize <= scratch_faces)
        {
            starts.push(faces);
            faces += more as usize;
            end += 1;
        }
        starts.push(faces);
        words.resize(2 * faces, 0);
        write(dataset, first..end, &starts, &mut words);
        join(&starts, bytemuck::cast_slice_mut(&mut words), &across);
        first = end;
    }
    across.into_iter().map(|row| row.map(AtomicU32::into_inner)).collect()
}

/// Calls `work` with the lowest vertex of every face of every cell, and the side.
fn for_each_side(dataset: &Dataset, work: impl Fn(u32, Side) + Sync) {
    (0..dataset.blocks.len()).into_par_iter().for_each(|block| {
        let block = dataset.block(block);
        let BlockCells::Tets(tets) = &block.cells else { return };
        for (i, tet) in tets.iter().enumerate() {
            let cell = block.base + i;
            for (k, face) in FACES.iter().enumerate() {
                let [a, b, c] = face.map(|i| tet[i]);
                let code = (cell as u64) << 3 | (k as u64) << 1 | u64::from(is_outward(dataset, cell, k));
                work(a, [u64::from(b) << 32 | u64::from(c), code]);
            }
        }
    });
}

/// Writes the sides with a lowest vertex in `vertices` to its bucket, which begins at `starts`.
fn write(dataset: &Dataset, vertices: Range<usize>, starts: &[usize], words: &mut [u64]) {
    let taken: Vec<AtomicU32> = vertices.clone().map(|_| AtomicU32::new(0)).collect();
    let out = as_atomic(words);
    for_each_side(dataset, |vertex, side| {
        if vertices.contains(&(vertex as usize)) {
            let bucket = vertex as usize - vertices.start;
            let place = starts[bucket] + taken[bucket].fetch_add(1, Ordering::Relaxed) as usize;
            for (i, word) in side.into_iter().enumerate() {
                out[2 * place + i].store(word, Ordering::Relaxed);
            }
        }
    });
}

/// Finds the two sides of each face among those of its bucket. Which thread wrote first is left to chance: buckets are sorted.
fn join(starts: &[usize], sides: &mut [Side], across: &[[AtomicU32; 4]]) {
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
            for face in bucket.chunk_by(|a, b| a[0] == b[0]).filter(|face| face.len() > 1) {
                // Two, as a rule. Where more cells meet, those on either side are taken in order; one left over has no neighbour.
                let outwards = face.iter().filter(|side| points_outwards(**side));
                let inwards = face.iter().filter(|side| !points_outwards(**side));
                for (&one, &other) in outwards.zip(inwards) {
                    for (from, to) in [(one, other), (other, one)] {
                        let (cell, k) = cell_and_face(from);
                        across[cell][k].store(cell_and_face(to).0 as u32, Ordering::Relaxed);
                    }
                }
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Settings, delaunay, tets};
    use crate::stages::sort::neighbours::neighbours;
    use crate::stages::testing::{Random, random_cells};

    /// The slow twin: all faces sorted at once.
    fn twin(dataset: &Dataset) -> Vec<[u32; 4]> {
        let mut rows = vec![[Adjacency::NONE; 4]; dataset.tets.len()];
        for pair in neighbours(dataset, (0..dataset.tets.len() as u32).into_par_iter()) {
            for (cell, other) in [(pair.ahead, pair.behind), (pair.behind, pair.ahead)] {
                let apex = dataset.tets.get(cell as usize).iter().position(|v| !pair.face.contains(v)).unwrap();
                rows[cell as usize][apex] = other;
            }
        }
        rows
    }

    fn meshes() -> Vec<Dataset> {
        let settings = Settings { cells: 20_000, ..Settings::default() };
        let grid = tets(&Settings { jitter: 0.3, ..settings }).unwrap();
        let mut meshes = vec![
            Dataset::from_tets(delaunay(&settings).unwrap()).unwrap(),
            Dataset::from_tets(grid).unwrap(),
            random_cells(500, 0.2, &mut Random::new(3)),
        ];
        // Every second cell again: three or four cells at a face, some on the same side of it.
        let mut doubled = delaunay(&settings).unwrap();
        let again: Vec<[u32; 4]> = doubled.tets.iter().chain(doubled.tets.iter().step_by(2)).copied().collect();
        doubled.file_from_tet = again.iter().map(|_| 0).collect();
        doubled.tets = again.into();
        meshes.push(Dataset::from_tets(doubled).unwrap());
        meshes
    }

    #[test]
    fn neighbours_are_those_of_a_sort_of_all_faces_in_any_scratch_and_on_any_threads() {
        for (i, mesh) in meshes().iter().enumerate() {
            let expected = build(mesh, usize::MAX);
            assert!(is_of(&expected, mesh), "mesh {i}");
            if i < 3 {
                assert!(expected == twin(mesh), "mesh {i}");
            }
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                for scratch in [0, 1000, 30_000] {
                    assert!(pool.install(|| build(mesh, scratch)) == expected, "mesh {i}, scratch {scratch}");
                }
            }
        }
    }

    #[test]
    fn a_column_is_used_where_it_is_right_and_made_anew_where_it_is_not() {
        let mut mesh = meshes().swap_remove(0);
        let right = build(&mesh, usize::MAX);
        mesh.adjacency = Some(right.clone().into());
        let used = Adjacency::new(&mesh);
        assert!(used.neighbours_from_cell() == right);
        let holes = right.iter().flatten().filter(|&&other| other == Adjacency::NONE).count();
        assert!(holes > 100 && used.exterior().len() == holes);
        for wrong in [0, 7, right.len() as u32, u32::MAX - 1] {
            let mut damaged = right.clone();
            damaged[100][2] = wrong;
            assert!(right[100][2] != wrong && !is_of(&damaged, &mesh), "{wrong}");
            mesh.adjacency = Some(damaged.into());
            assert!(Adjacency::new(&mesh).neighbours_from_cell() == right);
        }
        mesh.adjacency = Some(right[1..].to_vec().into());
        assert!(Adjacency::new(&mesh).neighbours_from_cell() == right);
    }
}
