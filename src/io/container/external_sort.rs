//! Sorting more than memory holds: sorted runs in a nameless temporary file, merged as they are read.
//!
//! In: (key, cell) pairs in any order. Out: the cells by ascending key, equal keys by ascending cell. Memory: the budget given.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use rayon::prelude::*;

use crate::atomic::io_at;
use crate::error::Result;

/// Where a cell belongs, and which it is.
pub(super) type Keyed = (u64, u32);

/// Bytes of a pair in the file.
const PAIR_BYTES: usize = 12;

/// Pairs that are read at once from each run while merging, at least.
const PAIRS_AT_ONCE: usize = 1 << 12;

/// Takes pairs; then [`sorted`](Self::sorted) gives the cells.
pub(super) struct ExternalSort<'a> {
    /// Near which file the temporary one is made.
    path: &'a Path,
    pairs: Vec<Keyed>,
    pairs_max: usize,
    file: Option<File>,
    /// Pairs in each run, one after the other in the file.
    runs: Vec<u64>,
}

impl<'a> ExternalSort<'a> {
    /// A sort that keeps to `memory_bytes`; where more is needed it writes a file into the folder of `path`.
    pub(super) fn new(path: &'a Path, memory_bytes: u64) -> Self {
        let pairs_max = (memory_bytes / size_of::<Keyed>() as u64).max(PAIRS_AT_ONCE as u64) as usize;
        Self { path, pairs: Vec::new(), pairs_max, file: None, runs: Vec::new() }
    }

    /// How many pairs fit into memory yet.
    pub(super) fn room(&self) -> usize {
        self.pairs_max - self.pairs.len()
    }

    /// Takes pairs, at most [`room`](Self::room) of them; afterwards there is room again.
    pub(super) fn push(&mut self, pairs: impl ParallelIterator<Item = Keyed>) -> Result<()> {
        self.pairs.par_extend(pairs);
        if self.room() == 0 { self.write_run() } else { Ok(()) }
    }

    /// Sorts what is in memory and moves it to the file.
    fn write_run(&mut self) -> Result<()> {
        let at = io_at(self.path);
        self.pairs.par_sort_unstable();
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(tempfile::tempfile_in(folder_of(self.path)).map_err(&at)?),
        };
        let mut bytes = Vec::with_capacity(PAIRS_AT_ONCE * PAIR_BYTES);
        for some in self.pairs.chunks(PAIRS_AT_ONCE) {
            bytes.clear();
            for (key, cell) in some {
                bytes.extend_from_slice(&key.to_le_bytes());
                bytes.extend_from_slice(&cell.to_le_bytes());
            }
            file.write_all(&bytes).map_err(&at)?;
        }
        self.runs.push(self.pairs.len() as u64);
        self.pairs.clear();
        Ok(())
    }

    /// The cells in order.
    pub(super) fn sorted(mut self) -> Result<Sorted<'a>> {
        if self.file.is_none() {
            self.pairs.par_sort_unstable();
            let cells = self.pairs.into_iter();
            return Ok(Sorted {
                path: self.path,
                memory: cells,
                file: None,
                runs: Vec::new(),
                heap: BinaryHeap::new(),
            });
        }
        if !self.pairs.is_empty() {
            self.write_run()?;
        }
        self.pairs = Vec::new();
        let at_once = (self.pairs_max / self.runs.len()).max(PAIRS_AT_ONCE);
        let mut begin = 0;
        let mut sorted = Sorted {
            path: self.path,
            memory: Vec::new().into_iter(),
            file: self.file,
            runs: Vec::new(),
            heap: BinaryHeap::new(),
        };
        for (run, &pairs) in self.runs.iter().enumerate() {
            sorted.runs.push(Run { begin, pairs, buffer: Vec::new(), next: 0, at_once });
            begin += pairs * PAIR_BYTES as u64;
            if let Some(pair) = sorted.next_of(run)? {
                sorted.heap.push(Reverse((pair, run)));
            }
        }
        Ok(sorted)
    }
}

/// A sorted run in the file, read in parts.
struct Run {
    begin: u64,
    /// Pairs not yet read from the file.
    pairs: u64,
    buffer: Vec<u8>,
    next: usize,
    at_once: usize,
}

/// Cells in order.
pub(super) struct Sorted<'a> {
    path: &'a Path,
    /// All of them, where they fitted into memory.
    memory: std::vec::IntoIter<Keyed>,
    file: Option<File>,
    runs: Vec<Run>,
    heap: BinaryHeap<Reverse<(Keyed, usize)>>,
}

impl Sorted<'_> {
    /// Fills `cells` with the next cells, as many as it can hold; none at the end.
    pub(super) fn next_cells(&mut self, count: usize, cells: &mut Vec<u32>) -> Result<()> {
        cells.clear();
        if self.file.is_none() {
            cells.extend(self.memory.by_ref().take(count).map(|(_, cell)| cell));
            return Ok(());
        }
        while cells.len() < count {
            let Some(mut least) = self.heap.peek_mut() else { break };
            let Reverse(((_, cell), run)) = *least;
            cells.push(cell);
            // The run's next pair takes the place of its last: one walk down the heap.
            match next_of(&mut self.runs[run], self.file.as_mut(), self.path)? {
                Some(pair) => *least = Reverse((pair, run)),
                None => drop(std::collections::binary_heap::PeekMut::pop(least)),
            }
        }
        Ok(())
    }

    fn next_of(&mut self, run: usize) -> Result<Option<Keyed>> {
        next_of(&mut self.runs[run], self.file.as_mut(), self.path)
    }
}

fn next_of(run: &mut Run, file: Option<&mut File>, path: &Path) -> Result<Option<Keyed>> {
    if run.next == run.buffer.len() {
        let pairs = run.pairs.min(run.at_once as u64);
        let Some(file) = file.filter(|_| pairs > 0) else { return Ok(None) };
        run.buffer.resize(pairs as usize * PAIR_BYTES, 0);
        file.seek(SeekFrom::Start(run.begin)).and_then(|_| file.read_exact(&mut run.buffer)).map_err(io_at(path))?;
        (run.begin, run.pairs, run.next) = (run.begin + pairs * PAIR_BYTES as u64, run.pairs - pairs, 0);
    }
    let pair = &run.buffer[run.next..run.next + PAIR_BYTES];
    run.next += PAIR_BYTES;
    let key = u64::from_le_bytes(std::array::from_fn(|i| pair[i]));
    Ok(Some((key, u32::from_le_bytes(std::array::from_fn(|i| pair[8 + i])))))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted_by(memory_bytes: u64, pairs: &[Keyed]) -> (Vec<u32>, usize) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.cells");
        let mut sort = ExternalSort::new(&path, memory_bytes);
        let mut rest = pairs;
        while !rest.is_empty() {
            let (now, later) = rest.split_at(sort.room().min(rest.len()));
            sort.push(now.par_iter().copied()).unwrap();
            rest = later;
        }
        let mut sorted = sort.sorted().unwrap();
        let runs = sorted.runs.len();
        let (mut all, mut some) = (Vec::new(), Vec::new());
        while {
            sorted.next_cells(1000, &mut some).unwrap();
            !some.is_empty()
        } {
            all.extend_from_slice(&some);
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "the temporary file has no name");
        (all, runs)
    }

    #[test]
    fn any_memory_gives_the_order_of_a_plain_sort() {
        let scrambled = |i: u32| (u64::from(i.wrapping_mul(2_654_435_761)) % 1000) << 40;
        let pairs: Vec<Keyed> = (0..50_000).map(|i| (scrambled(i), i)).collect();
        let mut expected = pairs.clone();
        expected.sort_unstable();
        let expected: Vec<u32> = expected.into_iter().map(|(_, cell)| cell).collect();
        for (memory_bytes, expected_runs) in [(1 << 20, 0), (1 << 18, 4), (1, 13)] {
            let (cells, runs) = sorted_by(memory_bytes, &pairs);
            assert_eq!((cells == expected, runs), (true, expected_runs), "{memory_bytes} bytes");
        }
        assert!(sorted_by(1, &[]).0.is_empty());
    }
}
