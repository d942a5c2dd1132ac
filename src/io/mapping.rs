//! A file's bytes: mapped, or read whole where maps are not wanted.
//!
//! In: a path. Out: [`SharedBytes`], aligned for every column type, and the [`Backing`] that notices changes.
//!
//! What a map means: another process that shortens the file takes pages away, and reading one ends this process (SIGBUS on
//! Unix, an in-page error on Windows). No check can rule that out, since it may happen between check and read; length and
//! time of modification are compared before every frame, so that it is usually found first.
#![expect(unsafe_code, reason = "a memory map is bytes that another process may change")]

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use memmap2::Mmap;

use super::numbers::{ByteOrder, NumberType};
use crate::columns::{Backing, NumericColumn, SharedBytes};
use crate::error::{Error, Result};

/// The bytes of the file, in place or read whole.
///
/// # Errors
/// [`Error::Io`] where the system refuses; out of memory is one of these.
pub(super) fn bytes_of(path: &Path, mut file: File, use_map: bool) -> Result<(SharedBytes, Option<Arc<Backing>>)> {
    let at = |source| Error::Io { path: path.to_owned(), source };
    if use_map {
        // SAFETY: the map is only read, and only as plain numbers, for which every bit pattern is a value. Writers in other
        // processes are the caller's concern as the head of this file says; `Backing` looks for them.
        let map = unsafe { Mmap::map(&file) }.map_err(at)?;
        return Ok((Arc::new(map), Some(Arc::new(Backing::new(path, file)?))));
    }
    let len = file.metadata().map_err(at)?.len() as usize;
    let mut words: Vec<Line> = Vec::new();
    let out_of_memory = |_| at(std::io::Error::from(std::io::ErrorKind::OutOfMemory));
    words.try_reserve_exact(len.div_ceil(size_of::<Line>())).map_err(out_of_memory)?;
    words.resize(len.div_ceil(size_of::<Line>()), Line([0; 8]));
    file.read_exact(&mut bytemuck::cast_slice_mut(&mut words)[..len]).map_err(at)?;
    Ok((Arc::new(Whole { words, len }), None))
}

/// A file that is mapped: its bytes, which columns may share, and what watches it.
#[derive(Clone)]
pub(super) struct Mapped {
    bytes: SharedBytes,
    backing: Arc<Backing>,
}

impl Mapped {
    /// Maps the file.
    ///
    /// # Errors
    /// [`Error::Io`] where the system refuses.
    pub(super) fn open(path: &Path, file: File) -> Result<Self> {
        let (bytes, backing) = bytes_of(path, file, true)?;
        let unwatched = || Error::Io { path: path.to_owned(), source: std::io::ErrorKind::Unsupported.into() };
        Ok(Self { bytes, backing: backing.ok_or_else(unwatched)? })
    }

    /// All bytes of the file.
    pub(super) fn bytes(&self) -> &[u8] {
        (*self.bytes).as_ref()
    }

    /// What watches the file.
    pub(super) fn backing(&self) -> &Arc<Backing> {
        &self.backing
    }

    /// The values in `part` of the bytes, in place; none where they are not aligned for their type or in another order than
    /// this machine's.
    pub(super) fn column(&self, number: NumberType, order: ByteOrder, part: &[u8]) -> Option<NumericColumn> {
        let is_native = number.size() == 1 || (order == ByteOrder::Little) == cfg!(target_endian = "little");
        let offset = part.as_ptr().addr().checked_sub(self.bytes().as_ptr().addr())?;
        let len = part.len() / number.size();
        let shared = || NumericColumn::shared(number.name(), "samples", Arc::clone(&self.bytes), offset, len);
        if is_native { shared().ok().flatten() } else { None }
    }
}

impl fmt::Debug for Mapped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Mapped({} bytes)", self.bytes().len())
    }
}

/// 64 bytes, aligned as columns are.
#[repr(C, align(64))]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Line([u64; 8]);

/// A file in memory.
struct Whole {
    words: Vec<Line>,
    len: usize,
}

impl AsRef<[u8]> for Whole {
    fn as_ref(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.words)[..self.len]
    }
}
