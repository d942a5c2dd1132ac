//! `Scratch`: where the columns of a file go while it is read, in memory or, beyond a budget, in files without a name.
//!
//! In: values one after the other ([`Growing`]). Out: a [`Column`], owned or mapped; what reads it need not know which. A
//! nameless file is gone with the last column that uses it, however the process ends.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use bytemuck::Pod;

use super::mapping::bytes_of;
use crate::atomic::io_at;
use crate::columns::{Column, SharedBytes};
use crate::error::{Error, Result};
use crate::memory;

/// Bytes of a column that are in memory while the rest of it goes to a file.
const BUFFER_BYTES: usize = 4 << 20;

/// What a reader may keep in memory, and where the rest goes.
#[derive(Debug)]
pub struct Scratch {
    /// None: everything stays in memory.
    folder: Option<PathBuf>,
    /// Bytes that columns may still take.
    left: AtomicU64,
    /// Whether samples of a volume are used in place of their file.
    maps_volumes: bool,
}

impl Scratch {
    /// All columns in memory, but for the samples of a volume, which are used in place of their file where they stand in it as
    /// memory has them.
    pub fn memory() -> Self {
        Self { folder: None, left: AtomicU64::new(u64::MAX), maps_volumes: true }
    }

    /// All columns in memory, and no file mapped.
    pub fn unmapped() -> Self {
        Self { maps_volumes: false, ..Self::memory() }
    }

    /// Columns of `memory_bytes` in memory, the others in nameless files in `folder`; so is the file that is read, mapped.
    ///
    /// Not counted are the points, 12 or 24 bytes each, and 4 MiB for each column that is being read.
    pub fn in_folder(folder: &Path, memory_bytes: u64) -> Self {
        Self { folder: Some(folder.to_owned()), left: AtomicU64::new(memory_bytes), maps_volumes: true }
    }

    /// Whether a file that is read is mapped: it is no pipe, and memory is counted.
    pub(super) fn maps(&self, file: &File) -> bool {
        self.folder.is_some() && file.metadata().is_ok_and(|metadata| metadata.is_file())
    }

    /// Whether the samples of a volume may be used in place of their file: it is no pipe.
    pub(super) fn maps_volume(&self, file: &File) -> bool {
        self.maps_volumes && file.metadata().is_ok_and(|metadata| metadata.is_file())
    }

    /// `bytes` of one column can be had, in memory or in a file.
    pub(super) fn check(&self, what: impl FnOnce() -> String, bytes: u64) -> Result<()> {
        if self.folder.is_some() { Ok(()) } else { memory::check(what, Some(bytes)) }
    }

    /// The bytes of a file that is read: in memory, or mapped.
    pub(super) fn bytes_of(&self, path: &Path, file: File) -> Result<SharedBytes> {
        let map = self.maps(&file);
        Ok(bytes_of(path, file, map)?.0)
    }

    /// A column to be filled.
    pub(super) fn column<T: Pod>(&self) -> Growing<'_, T> {
        let limit = if self.folder.is_some() { Growing::<T>::BUFFER } else { usize::MAX };
        Growing { scratch: self, values: Vec::new(), limit, taken: 0, written: None }
    }

    /// Takes memory from the budget; false where too little is left.
    fn take(&self, bytes: u64) -> bool {
        self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(bytes)).is_ok()
    }

    /// What messages about nameless files name.
    fn place(&self) -> &Path {
        self.folder.as_deref().unwrap_or(Path::new("."))
    }
}

/// A column that is being filled.
pub(super) struct Growing<'a, T> {
    scratch: &'a Scratch,
    /// The values that are in memory: all, or those since the last went to the file.
    values: Vec<T>,
    /// Values that memory may hold before more is asked for.
    limit: usize,
    /// Values for which the budget has been asked.
    taken: usize,
    written: Option<Written>,
}

struct Written {
    file: File,
    values: usize,
}

impl<T: Pod> Growing<'_, T> {
    const BUFFER: usize = BUFFER_BYTES / size_of::<T>();

    /// How many values there are.
    pub(super) fn len(&self) -> usize {
        self.written.as_ref().map_or(0, |written| written.values) + self.values.len()
    }

    /// Makes room for `values` more where they stay in memory: what grows while it is filled takes up to three times as much.
    pub(super) fn reserve(&mut self, values: usize) {
        if self.scratch.folder.is_none() {
            self.values.reserve_exact(values);
        }
    }

    pub(super) fn push(&mut self, value: T) -> Result<()> {
        if self.values.len() == self.limit {
            self.make_room()?;
        }
        self.values.push(value);
        Ok(())
    }

    pub(super) fn extend(&mut self, values: impl IntoIterator<Item = T>) -> Result<()> {
        let values = values.into_iter();
        self.reserve(values.size_hint().0);
        for value in values {
            self.push(value)?;
        }
        Ok(())
    }

    /// The column.
    pub(super) fn finish(mut self) -> Result<Column<T>> {
        if self.written.is_none() && self.take(self.values.len()) {
            return Ok(self.values.into());
        }
        self.write()?;
        let Some(Written { file, values }) = self.written else { return Ok(Vec::new().into()) };
        let (bytes, _) = bytes_of(self.scratch.place(), file, true)?;
        Column::shared("scratch", bytes, 0, values)
    }

    #[cold]
    fn make_room(&mut self) -> Result<()> {
        if self.written.is_none() && self.take(self.values.len()) {
            self.limit = self.values.len() + Self::BUFFER;
            return Ok(());
        }
        self.write()?;
        self.values = Vec::with_capacity(Self::BUFFER);
        self.limit = Self::BUFFER;
        Ok(())
    }

    /// Takes memory for `values` values in all from the budget; false where too little is left.
    fn take(&mut self, values: usize) -> bool {
        let more = values.saturating_sub(self.taken);
        let taken = self.scratch.take((more * size_of::<T>()) as u64);
        self.taken += if taken { more } else { 0 };
        taken
    }

    fn write(&mut self) -> Result<()> {
        let place = self.scratch.place();
        let written = match &mut self.written {
            Some(written) => written,
            none => none.insert(Written { file: tempfile::tempfile_in(place).map_err(io_at(place))?, values: 0 }),
        };
        written.file.write_all(bytemuck::cast_slice(&self.values)).map_err(io_at(place))?;
        written.values += self.values.len();
        self.values.clear();
        Ok(())
    }
}

/// A column of all `values`, in memory or not; the first error ends it.
pub(super) fn collect<T: Pod>(
    scratch: &Scratch,
    values: impl IntoIterator<Item = Result<T, Error>>,
) -> Result<Column<T>> {
    let mut column = scratch.column();
    let values = values.into_iter();
    column.reserve(values.size_hint().0);
    for value in values {
        column.push(value?)?;
    }
    column.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(scratch: &Scratch, count: u32) -> Column<u32> {
        collect(scratch, (0..count).map(Ok)).unwrap()
    }

    #[test]
    fn columns_beyond_the_budget_are_mapped_and_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let scratch = Scratch::in_folder(folder.path(), 2 * BUFFER_BYTES as u64);
        let count = BUFFER_BYTES as u32; // four buffers
        let (small, large) = (numbers(&scratch, 7), numbers(&scratch, count));
        assert_eq!((small.owned_bytes(), large.owned_bytes()), (28, 0));
        assert_eq!(numbers(&Scratch::memory(), count).owned_bytes(), 4 * u64::from(count));
        assert!(large.iter().copied().eq(0..count) && small.iter().copied().eq(0..7));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "the files have no name");
    }

    #[test]
    fn a_folder_that_is_not_there_is_an_error_once_it_is_needed() {
        let scratch = Scratch::in_folder(Path::new("/nowhere/at/all"), 0);
        let error = collect(&scratch, [Ok(1_u8)]).unwrap_err();
        assert!(error.to_string().contains("/nowhere/at/all"), "{error}");
    }
}
