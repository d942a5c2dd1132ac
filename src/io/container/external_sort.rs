//! Sorting more than memory holds: sorted runs in a nameless temporary file, merged as they are read.
//!
//! In: records of N words in any order. Out: the records in lexicographic order. Memory: the budget given.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use rayon::prelude::*;

use crate::atomic::io_at;
use crate::error::Result;

/// Records that are read at once from each run while merging, at least.
const AT_ONCE: usize = 1 << 12;

/// Takes records; then [`sorted`](Self::sorted) gives them in order.
pub(super) struct ExternalSort<'a, const N: usize> {
    /// Near which file the temporary one is made.
    path: &'a Path,
    records: Vec<[u32; N]>,
    records_max: usize,
    file: Option<File>,
    /// Records in each run, one after the other in the file.
    runs: Vec<u64>,
}

impl<'a, const N: usize> ExternalSort<'a, N> {
    /// A sort that keeps to `memory_bytes`; where more is needed it writes a file into the folder of `path`.
    pub(super) fn new(path: &'a Path, memory_bytes: u64) -> Self {
        let records_max = (memory_bytes / (4 * N as u64)).max(AT_ONCE as u64) as usize;
        Self { path, records: Vec::new(), records_max, file: None, runs: Vec::new() }
    }

    /// How many records fit into memory yet; never 0.
    pub(super) fn room(&self) -> usize {
        self.records_max - self.records.len()
    }

    /// Takes records, at most [`room`](Self::room) of them.
    pub(super) fn push(&mut self, records: impl ParallelIterator<Item = [u32; N]>) -> Result<()> {
        self.records.par_extend(records);
        if self.room() == 0 { self.write_run() } else { Ok(()) }
    }

    /// Takes records, however many.
    pub(super) fn push_all(&mut self, mut records: &[[u32; N]]) -> Result<()> {
        while !records.is_empty() {
            let (now, later) = records.split_at(self.room().min(records.len()));
            self.push(now.par_iter().copied())?;
            records = later;
        }
        Ok(())
    }

    /// Sorts what is in memory and moves it to the file.
    fn write_run(&mut self) -> Result<()> {
        let at = io_at(self.path);
        self.records.par_sort_unstable();
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(tempfile::tempfile_in(folder_of(self.path)).map_err(&at)?),
        };
        file.write_all(bytemuck::cast_slice(self.records.as_flattened())).map_err(&at)?;
        self.runs.push(self.records.len() as u64);
        self.records.clear();
        Ok(())
    }

    /// The records in order.
    pub(super) fn sorted(mut self) -> Result<Sorted<'a, N>> {
        if self.file.is_none() {
            self.records.par_sort_unstable();
            let memory = self.records.into_iter();
            return Ok(Sorted { path: self.path, memory, file: None, runs: Vec::new(), heap: BinaryHeap::new() });
        }
        if !self.records.is_empty() {
            self.write_run()?;
        }
        self.records = Vec::new();
        let at_once = (self.records_max / self.runs.len()).max(AT_ONCE);
        let (mut begin, mut runs, mut heap) = (0, Vec::new(), BinaryHeap::new());
        for (i, &records) in self.runs.iter().enumerate() {
            let mut run = Run { begin, records, buffer: Vec::new(), next: 0, at_once };
            if let Some(record) = run.next(self.file.as_mut(), self.path)? {
                heap.push(Reverse((record, i)));
            }
            runs.push(run);
            begin += records * 4 * N as u64;
        }
        Ok(Sorted { path: self.path, memory: Vec::new().into_iter(), file: self.file, runs, heap })
    }
}

/// A sorted run in the file, read in parts.
struct Run<const N: usize> {
    begin: u64,
    /// Records not yet read from the file.
    records: u64,
    buffer: Vec<[u32; N]>,
    next: usize,
    at_once: usize,
}

impl<const N: usize> Run<N> {
    fn next(&mut self, file: Option<&mut File>, path: &Path) -> Result<Option<[u32; N]>> {
        if self.next == self.buffer.len() {
            let records = self.records.min(self.at_once as u64);
            let Some(file) = file.filter(|_| records > 0) else { return Ok(None) };
            self.buffer.resize(records as usize, [0; N]);
            let bytes: &mut [u8] = bytemuck::cast_slice_mut(self.buffer.as_flattened_mut());
            let len = bytes.len() as u64;
            file.seek(SeekFrom::Start(self.begin)).and_then(|_| file.read_exact(bytes)).map_err(io_at(path))?;
            (self.begin, self.records, self.next) = (self.begin + len, self.records - records, 0);
        }
        self.next += 1;
        Ok(Some(self.buffer[self.next - 1]))
    }
}

/// Records in order.
pub(super) struct Sorted<'a, const N: usize> {
    path: &'a Path,
    /// All of them, where they fitted into memory.
    memory: std::vec::IntoIter<[u32; N]>,
    file: Option<File>,
    runs: Vec<Run<N>>,
    heap: BinaryHeap<Reverse<([u32; N], usize)>>,
}

impl<const N: usize> Sorted<'_, N> {
    /// The next record; none at the end.
    pub(super) fn next(&mut self) -> Result<Option<[u32; N]>> {
        if self.file.is_none() {
            return Ok(self.memory.next());
        }
        let Some(mut least) = self.heap.peek_mut() else { return Ok(None) };
        let Reverse((record, run)) = *least;
        // The run's next record takes the place of its last: one walk down the heap.
        match self.runs[run].next(self.file.as_mut(), self.path)? {
            Some(next) => *least = Reverse((next, run)),
            None => drop(PeekMut::pop(least)),
        }
        Ok(Some(record))
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted_by(memory_bytes: u64, records: &[[u32; 3]]) -> (Vec<[u32; 3]>, usize) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.cells");
        let mut sort = ExternalSort::new(&path, memory_bytes);
        sort.push_all(records).unwrap();
        let mut sorted = sort.sorted().unwrap();
        let runs = sorted.runs.len();
        let all = std::iter::from_fn(|| sorted.next().unwrap()).collect();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "the temporary file has no name");
        (all, runs)
    }

    #[test]
    fn any_memory_gives_the_order_of_a_plain_sort() {
        let scrambled = |i: u32| i.wrapping_mul(2_654_435_761) % 1000;
        let records: Vec<[u32; 3]> = (0..50_000).map(|i| [scrambled(i) / 7, scrambled(i), i]).collect();
        let mut expected = records.clone();
        expected.sort_unstable();
        for (memory_bytes, expected_runs) in [(1 << 20, 0), (150_000, 4), (1, 13)] {
            let (sorted, runs) = sorted_by(memory_bytes, &records);
            assert_eq!((sorted == expected, runs), (true, expected_runs), "{memory_bytes} bytes");
        }
        assert!(sorted_by(1, &[]).0.is_empty());
    }
}
