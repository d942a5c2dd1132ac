//! Writing several columns of one file side by side.
//!
//! In: bytes per column, in any alternation. Out: columns that are each in one piece, aligned, with their checksums.

use std::fs::File;
use std::hash::Hasher;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use twox_hash::XxHash3_64;

use super::directory::{ALIGNMENT, HEADER_BYTES, Span};
use crate::atomic::io_at;
use crate::error::Result;

/// Bytes that a column gathers before it is written to its place.
const GATHERED_BYTES: usize = 1 << 20;

/// A file whose columns are being written.
pub(super) struct Sink<'a> {
    writer: &'a mut BufWriter<File>,
    path: &'a Path,
    /// Where the next column begins.
    end: u64,
}

/// A column that is being written.
pub(super) struct ColumnWriter {
    offset: u64,
    bytes: u64,
    gathered: Vec<u8>,
    checksum: XxHash3_64,
}

impl<'a> Sink<'a> {
    pub(super) fn new(writer: &'a mut BufWriter<File>, path: &'a Path) -> Self {
        Self { writer, path, end: HEADER_BYTES as u64 }
    }

    /// Begins a column after all others, and leaves room for `bytes` bytes. One of unknown length takes no room: it must be
    /// finished before the next begins.
    pub(super) fn column(&mut self, bytes: Option<u64>) -> ColumnWriter {
        let offset = self.end.next_multiple_of(ALIGNMENT);
        self.end = offset + bytes.unwrap_or(0);
        ColumnWriter { offset, bytes: 0, gathered: Vec::new(), checksum: XxHash3_64::with_seed(0) }
    }

    /// Appends to a column.
    pub(super) fn append(&mut self, column: &mut ColumnWriter, bytes: &[u8]) -> Result<()> {
        column.gathered.extend_from_slice(bytes);
        if column.gathered.len() >= GATHERED_BYTES { self.put(column) } else { Ok(()) }
    }

    fn put(&mut self, column: &mut ColumnWriter) -> Result<()> {
        column.checksum.write(&column.gathered);
        let place = SeekFrom::Start(column.offset + column.bytes);
        self.writer.seek(place).and_then(|_| self.writer.write_all(&column.gathered)).map_err(io_at(self.path))?;
        column.bytes += column.gathered.len() as u64;
        column.gathered.clear();
        Ok(())
    }

    /// Writes what is left of a column.
    pub(super) fn finish(&mut self, mut column: ColumnWriter) -> Result<Span> {
        self.put(&mut column)?;
        self.end = self.end.max(column.offset + column.bytes);
        Ok(Span { offset: column.offset, bytes: column.bytes, xxh3: column.checksum.finish() })
    }

    /// A whole column at once.
    pub(super) fn whole(&mut self, bytes: &[u8]) -> Result<Span> {
        let mut column = self.column(Some(bytes.len() as u64));
        for some in bytes.chunks(GATHERED_BYTES) {
            self.append(&mut column, some)?;
        }
        self.finish(column)
    }

    /// Writes the header in front of everything; the file ends where the last column does.
    pub(super) fn header(&mut self, header: &[u8; HEADER_BYTES]) -> Result<()> {
        let written = self.writer.rewind().and_then(|()| self.writer.write_all(header));
        written.and_then(|()| self.writer.flush()).map_err(io_at(self.path))
    }

    /// The file so far, to read from.
    pub(super) fn written(&mut self) -> Result<File> {
        self.writer.flush().and_then(|()| self.writer.get_ref().try_clone()).map_err(io_at(self.path))
    }

    /// Where the last column ends.
    pub(super) fn end(&self) -> u64 {
        self.end
    }
}
