//! Samples one after the other with nothing between them: what raw and NRRD files hold.
//!
//! In: bytes, raw, compressed or as text. Out: a column: in place of a mapped file where its bytes stand as memory has them, else
//! converted some megabytes at a time.

use std::io::Read;
use std::iter;

use flate2::read::MultiGzDecoder;

use super::mapping::Mapped;
use super::numbers::{ByteOrder, NumberType};
use super::source::{Source, quote};
use crate::columns::NumericColumn;
use crate::error::{Error, Result};

/// Bytes that are converted at once.
const BYTES_AT_ONCE: usize = 4 << 20;

/// Deflate makes no more than this of a byte (zlib's documentation, "Maximum Compression Factor": 1032).
const MOST_INFLATED: u64 = 1032;

/// How many samples there are, and of what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Samples {
    pub(super) number: NumberType,
    pub(super) order: ByteOrder,
    pub(super) count: usize,
}

/// Bytes that begin as gzip does.
pub(super) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x1f\x8b")
}

impl Samples {
    /// Bytes that all take.
    pub(super) fn size(&self, source: Source<'_>) -> Result<usize> {
        let size = self.count.checked_mul(self.number.size()).filter(|&size| isize::try_from(size).is_ok());
        let too_many = || source.malformed("its sizes", format!("{} samples cannot be: damaged", self.count));
        size.ok_or_else(too_many)
    }

    /// Those at the beginning of `bytes`, which may be a part of `mapped`.
    pub(super) fn plain(&self, bytes: &[u8], mapped: Option<&Mapped>, source: Source<'_>) -> Result<NumericColumn> {
        let size = self.size(source)?;
        let bytes = bytes.get(..size).ok_or_else(|| self.too_few(size, bytes.len(), source))?;
        if let Some(shared) = mapped.and_then(|mapped| mapped.column(self.number, self.order, bytes)) {
            return Ok(shared);
        }
        self.check(size, source)?;
        self.number.decode(size, bytes.chunks(BYTES_AT_ONCE).map(Ok), self.order, source.scratch)
    }

    /// Those that gzip made smaller, behind `skip` bytes that come out before them.
    pub(super) fn gzip(&self, bytes: &[u8], skip: usize, source: Source<'_>) -> Result<NumericColumn> {
        let size = self.size(source)?;
        let most = (bytes.len() as u64).saturating_mul(MOST_INFLATED);
        if (size as u64).saturating_add(skip as u64) > most {
            let problem = format!("{size} bytes of samples cannot come out of {} compressed ones", bytes.len());
            return Err(source.malformed("its compressed data", problem + ": wrong sizes, damaged or truncated"));
        }
        self.check(size, source)?;
        let broken = |error: std::io::Error| source.malformed("its compressed data", format!("{error}: damaged"));
        let mut inflated = MultiGzDecoder::new(bytes);
        std::io::copy(&mut inflated.by_ref().take(skip as u64), &mut std::io::sink()).map_err(broken)?;
        let mut left = size;
        let chunks = iter::from_fn(|| {
            let mut chunk = Vec::new();
            let read = inflated.by_ref().take(left.min(BYTES_AT_ONCE) as u64).read_to_end(&mut chunk);
            left -= chunk.len();
            match read {
                Ok(0) => None,
                Ok(_) => Some(Ok(chunk)),
                Err(error) => Some(Err(broken(error))),
            }
        });
        let column = self.number.decode(size, chunks, self.order, source.scratch)?;
        let found = column.len() * self.number.size();
        if column.len() == self.count { Ok(column) } else { Err(self.too_few(size, found, source)) }
    }

    /// Those that are text, with space or commas between them.
    pub(super) fn text(&self, bytes: &[u8], source: Source<'_>) -> Result<NumericColumn> {
        let too_few = |found| {
            let problem = format!("{} numbers are declared, but {found} follow: damaged or truncated", self.count);
            source.malformed("its samples", problem)
        };
        // A number takes a digit and what stands before the next.
        if self.count > bytes.len().div_ceil(2) {
            return Err(too_few(bytes.len().div_ceil(2)));
        }
        let is_between = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
        let tokens = bytes.split(is_between).filter(|token| !token.is_empty()).take(self.count);
        let column = self.number.parse(tokens, source.scratch, |i, token| {
            let problem = format!("{} is no value of type {}", quote(token), self.number.name());
            source.malformed(format!("sample {i}"), problem)
        })?;
        if column.len() == self.count { Ok(column) } else { Err(too_few(column.len())) }
    }

    fn check(&self, size: usize, source: Source<'_>) -> Result<()> {
        let what = || format!("{}: the volume's {} samples", source.path.display(), self.count);
        source.scratch.check(what, size as u64)
    }

    fn too_few(&self, size: usize, found: usize, source: Source<'_>) -> Error {
        let (count, name) = (self.count, self.number.name());
        let problem = format!("{count} samples of type {name} take {size} bytes, but {found} are there");
        source.malformed("its samples", problem + ": wrong sizes or type, damaged or truncated")
    }
}
