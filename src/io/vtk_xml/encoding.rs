//! `Encoding`: how a file writes its arrays, and the values of one.

use std::borrow::Cow;
use std::cell::Cell;
use std::iter;

use super::super::expansion::Expansion;
use super::super::mapping::Mapped;
use super::super::numbers::{ByteOrder, NumberType};
use super::super::source::{Source, quote};
use super::base64::Base64;
use super::blocks::{BlockSizes, Compressor};
use super::document::Element;
use super::stream::Stream;
use crate::columns::NumericColumn;
use crate::error::Result;

/// What the attributes of `VTKFile` and `AppendedData` say about all arrays of a file.
#[derive(Debug)]
pub(in crate::io) struct Encoding<'a> {
    source: Source<'a>,
    order: ByteOrder,
    /// Bytes of a word in the headers of binary arrays.
    word: usize,
    compressor: Option<Compressor>,
    appended: Option<Stream<'a>>,
    /// The file, where arrays may be used in place of it.
    mapped: Option<&'a Mapped>,
    /// Bytes that arrays may still take. Arrays may share appended bytes, but not so often that a small file becomes
    /// a large mesh.
    budget: Cell<usize>,
    /// What compressed arrays, and points that are given by three axes, may still become.
    pub(in crate::io) expansion: Expansion,
}

/// Bytes of an array that are read at once, not counting what is larger because its compressed block is.
const BYTES_AT_ONCE: u64 = 4 << 20;

impl<'a> Encoding<'a> {
    /// The encoding of a file of `file_len` bytes with root element `root` and `appended` bytes.
    pub(in crate::io) fn new(
        root: &Element<'_>,
        appended: Option<&'a [u8]>,
        file_len: usize,
        source: Source<'a>,
    ) -> Result<Self> {
        let unknown = |name: &str, value: &str| {
            source.malformed(root.place(), format!("{name}={} is not known", quote(value.as_bytes())))
        };
        let order = match root.attribute("byte_order") {
            None | Some("LittleEndian") => ByteOrder::Little,
            Some("BigEndian") => ByteOrder::Big,
            Some(other) => return Err(unknown("byte_order", other)),
        };
        let word = match root.attribute("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => return Err(unknown("header_type", other)),
        };
        let compressor = match root.attribute("compressor") {
            None | Some("") => None,
            Some(name) => Some(Compressor::by_name(name).ok_or_else(|| {
                let what = format!("compressor {}", quote(name.as_bytes()));
                source.unsupported(what, "write the file with zlib, LZ4, LZMA or no compression")
            })?),
        };
        let encoding = root.child("AppendedData").and_then(|element| element.attribute("encoding"));
        let appended = match (appended, encoding) {
            (None, _) => None,
            (Some(bytes), Some("raw")) => Some(Stream::Raw(bytes)),
            (Some(bytes), None | Some("base64")) => Some(Stream::Base64(Base64::new(bytes))),
            (Some(_), Some(other)) => return Err(unknown("encoding", other)),
        };
        let budget = Cell::new(file_len.saturating_mul(4));
        let expansion = Expansion::of(file_len);
        Ok(Self { source, order, word, compressor, appended, mapped: None, budget, expansion })
    }

    /// The same of a file that is mapped: appended arrays are used in place where they stand there as memory has them.
    pub(in crate::io) fn in_place(self, mapped: Option<&'a Mapped>) -> Self {
        Self { mapped, ..self }
    }

    /// The values of the `DataArray` element `array`: as many as `expected`, where that is known.
    pub(in crate::io) fn values(&self, array: &Element<'_>, expected: Option<usize>) -> Result<NumericColumn> {
        let malformed = |problem: String| self.source.malformed(array.place(), problem);
        let name = array.attribute("type").unwrap_or_default();
        let number = number_type(name)
            .ok_or_else(|| malformed(format!("type={} is no numeric type", quote(name.as_bytes()))))?;
        let scratch = self.source.scratch;
        if expected == Some(0) {
            return number.decode(0, iter::empty::<Result<&[u8]>>(), self.order, scratch);
        }
        let decode = |stream| {
            let (bytes, chunks) = self.chunks(stream).map_err(malformed)?;
            number.decode(bytes, chunks.map(|chunk| chunk.map_err(malformed)), self.order, scratch)
        };
        let values = match (array.attribute("format"), array.attribute("offset")) {
            (Some("ascii"), _) | (None, None) => {
                let tokens = array.text.as_bytes().split(u8::is_ascii_whitespace).filter(|token| !token.is_empty());
                number.parse(tokens, scratch, |_, token| malformed(format!("{} is no {name} value", quote(token))))?
            }
            (Some("binary"), _) => decode(Stream::Base64(Base64::new(array.text.as_bytes())))?,
            (Some("appended") | None, Some(_)) => {
                let offset = array.count("offset", None, self.source)?;
                let stream = self.appended_at(offset).map_err(malformed)?;
                match self.shared(&stream, number, expected) {
                    Some(shared) => shared,
                    None => decode(stream)?,
                }
            }
            (Some("appended"), None) => return Err(malformed("has no attribute \"offset\"".to_owned())),
            (Some(other), _) => {
                return Err(malformed(format!("format={} is not known", quote(other.as_bytes()))));
            }
        };
        match expected {
            Some(expected) if values.len() != expected => {
                let found = values.len();
                Err(malformed(format!("has {found} values where {expected} are needed: damaged or truncated")))
            }
            _ => Ok(values),
        }
    }

    /// The `expected` values of an array that is appended as it is, in place.
    fn shared(&self, stream: &Stream<'a>, number: NumberType, expected: Option<usize>) -> Option<NumericColumn> {
        let (Some(mapped), Stream::Raw(bytes), None) = (self.mapped, stream, self.compressor) else { return None };
        let (word, values) = bytes.split_at_checked(self.word)?;
        let size = expected?.checked_mul(number.size()).filter(|&size| size as u64 == self.word_from(word))?;
        mapped.column(number, self.order, values.get(..size)?)
    }

    fn appended_at(&self, offset: usize) -> Result<Stream<'a>, String> {
        let beyond = || format!("offset {offset} lies beyond the end of the appended data: damaged or truncated");
        match &self.appended {
            None => Err("refers to appended data, but the file has none: damaged or truncated".to_owned()),
            Some(Stream::Raw(bytes)) => Ok(Stream::Raw(bytes.get(offset..).ok_or_else(beyond)?)),
            Some(Stream::Base64(stream)) => Ok(Stream::Base64(stream.skipping(offset).ok_or_else(beyond)?)),
        }
    }

    /// How many bytes a binary array has uncompressed, and the bytes, some megabytes at once.
    fn chunks<'s>(&'s self, mut stream: Stream<'s>) -> Result<(usize, Box<Chunks<'s>>), String> {
        let Some(compressor) = self.compressor else {
            let size = self.word(&mut stream)?;
            let total = usize::try_from(size).ok().filter(|&size| size <= stream.at_most());
            let total = total.ok_or_else(|| too_few(size, &stream))?;
            let mut left = size;
            let chunks = iter::from_fn(move || {
                let bytes = left.min(BYTES_AT_ONCE);
                left -= bytes;
                (bytes > 0).then(|| self.take(&mut stream, bytes))
            });
            return Ok((total, Box::new(chunks)));
        };
        let mut word = || self.word(&mut stream);
        let sizes = BlockSizes { blocks: word()?, block: word()?, last: word()? };
        let table = self.take(&mut stream, sizes.blocks.saturating_mul(self.word as u64))?;
        let compressed_sizes: Vec<u64> = table.chunks_exact(self.word).map(|word| self.word_from(word)).collect();
        let compressed = compressed_sizes.iter().fold(0_u64, |sum, &size| sum.saturating_add(size));
        if compressed > stream.at_most() as u64 {
            return Err(too_few(compressed, &stream));
        }
        let bytes = compressor.total_bytes(sizes, compressed as usize)?;
        self.expansion.take(bytes)?;
        let total = usize::try_from(bytes).map_err(|_| "is larger than the address space")?;
        let blocks_at_once = usize::try_from((BYTES_AT_ONCE / sizes.block.max(1)).max(1)).unwrap_or(usize::MAX);
        let mut first = 0_usize;
        let chunks = iter::from_fn(move || {
            let group = &compressed_sizes[first..compressed_sizes.len().min(first.saturating_add(blocks_at_once))];
            let block_sizes = (first as u64..).map(|block| sizes.of(block) as usize);
            let group: Vec<(usize, usize)> = group.iter().map(|&size| size as usize).zip(block_sizes).collect();
            let (group_first, compressed) = (first, group.iter().map(|&(size, _)| size as u64).sum());
            first += group.len();
            let expand =
                |compressed: Cow<'_, [u8]>| compressor.expand(group_first, &group, &compressed).map(Cow::Owned);
            (!group.is_empty()).then(|| self.take(&mut stream, compressed).and_then(expand))
        });
        Ok((total, Box::new(chunks)))
    }

    fn word(&self, stream: &mut Stream<'_>) -> Result<u64, String> {
        Ok(self.word_from(&self.take(stream, self.word as u64)?))
    }

    fn word_from(&self, bytes: &[u8]) -> u64 {
        let mut word = [0; 8];
        match self.order {
            ByteOrder::Little => word[..bytes.len()].copy_from_slice(bytes),
            ByteOrder::Big => word[8 - bytes.len()..].copy_from_slice(bytes),
        }
        if self.order == ByteOrder::Little { u64::from_le_bytes(word) } else { u64::from_be_bytes(word) }
    }

    fn take<'s>(&self, stream: &mut Stream<'s>, count: u64) -> Result<Cow<'s, [u8]>, String> {
        let taken = usize::try_from(count).ok().and_then(|count| {
            let left = self.budget.get().checked_sub(count)?;
            self.budget.set(left);
            stream.take(count)
        });
        taken.ok_or_else(|| too_few(count, stream))
    }
}

/// The bytes of an array, in sequence.
type Chunks<'a> = dyn Iterator<Item = Result<Cow<'a, [u8]>, String>> + 'a;

fn too_few(count: u64, stream: &Stream<'_>) -> String {
    let at_most = stream.at_most();
    format!("needs {count} bytes where at most {at_most} follow, or they are no base64: damaged or truncated")
}

/// The type that the attribute `type` names.
fn number_type(name: &str) -> Option<NumberType> {
    match name {
        "Int8" => Some(NumberType::I8),
        "UInt8" => Some(NumberType::U8),
        "Int16" => Some(NumberType::I16),
        "UInt16" => Some(NumberType::U16),
        "Int32" => Some(NumberType::I32),
        "UInt32" => Some(NumberType::U32),
        "Int64" => Some(NumberType::I64),
        "UInt64" => Some(NumberType::U64),
        "Float32" => Some(NumberType::F32),
        "Float64" => Some(NumberType::F64),
        _ => None,
    }
}

/// Whether a `DataArray` holds numbers.
pub(in crate::io) fn is_numeric(array: &Element<'_>) -> bool {
    array.attribute("type").is_some_and(|name| number_type(name).is_some())
}
