//! `Encoding`: how a file writes its arrays, and the values of one.

use std::cell::Cell;

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
    /// Bytes that arrays may still take. Arrays may share appended bytes, but not so often that a small file becomes
    /// a large mesh.
    budget: Cell<usize>,
    /// Bytes that compressed arrays may still become.
    expansion: Cell<u64>,
}

/// All arrays of a file may become this many times its bytes. Whole meshes reach 36: a grid of hexahedra in one block of
/// LZMA (zlib, and LZMA in VTK's blocks of 32 KiB: 6 and 15).
const LARGEST_EXPANSION: u64 = 64;
/// What a file may expand to whatever its size: small files hold little but repetitions.
const SMALLEST_EXPANSION: u64 = 4 << 20;

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
        let expansion =
            Cell::new((file_len as u64).saturating_mul(LARGEST_EXPANSION).saturating_add(SMALLEST_EXPANSION));
        Ok(Self { source, order, word, compressor, appended, budget, expansion })
    }

    /// The values of the `DataArray` element `array`: as many as `expected`, where that is known.
    pub(in crate::io) fn values(&self, array: &Element<'_>, expected: Option<usize>) -> Result<NumericColumn> {
        let malformed = |problem: String| self.source.malformed(array.place(), problem);
        let name = array.attribute("type").unwrap_or_default();
        let number = number_type(name)
            .ok_or_else(|| malformed(format!("type={} is no numeric type", quote(name.as_bytes()))))?;
        if expected == Some(0) {
            return Ok(number.decode(&[], self.order));
        }
        let values = match (array.attribute("format"), array.attribute("offset")) {
            (Some("ascii"), _) | (None, None) => {
                let tokens = array.text.as_bytes().split(u8::is_ascii_whitespace).filter(|token| !token.is_empty());
                number.parse(tokens).map_err(|token| malformed(format!("{} is no {name} value", quote(token))))?
            }
            (Some("binary"), _) => {
                let mut stream = Stream::Base64(Base64::new(array.text.as_bytes()));
                number.decode(&self.bytes(&mut stream).map_err(malformed)?, self.order)
            }
            (Some("appended") | None, Some(_)) => {
                let offset = array.count("offset", None, self.source)?;
                let mut stream = self.appended_at(offset).map_err(malformed)?;
                number.decode(&self.bytes(&mut stream).map_err(malformed)?, self.order)
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

    fn appended_at(&self, offset: usize) -> Result<Stream<'a>, String> {
        let beyond = || format!("offset {offset} lies beyond the end of the appended data: damaged or truncated");
        match &self.appended {
            None => Err("refers to appended data, but the file has none: damaged or truncated".to_owned()),
            Some(Stream::Raw(bytes)) => Ok(Stream::Raw(bytes.get(offset..).ok_or_else(beyond)?)),
            Some(Stream::Base64(stream)) => Ok(Stream::Base64(stream.skipping(offset).ok_or_else(beyond)?)),
        }
    }

    /// The bytes of a binary array, uncompressed.
    fn bytes(&self, stream: &mut Stream<'_>) -> Result<Vec<u8>, String> {
        let Some(compressor) = self.compressor else {
            let size = self.word(stream)?;
            return Ok(self.take(stream, size)?.into_owned());
        };
        let sizes = BlockSizes { blocks: self.word(stream)?, block: self.word(stream)?, last: self.word(stream)? };
        let table = self.take(stream, sizes.blocks.saturating_mul(self.word as u64))?;
        let compressed_sizes: Vec<usize> = table
            .chunks_exact(self.word)
            .map(|word| usize::try_from(self.word_from(word)).unwrap_or(usize::MAX))
            .collect();
        let all = compressed_sizes.iter().fold(0_u64, |sum, &size| sum.saturating_add(size as u64));
        let compressed = self.take(stream, all)?;
        let bytes = compressor.total_bytes(sizes, compressed.len())?;
        let left = self.expansion.get().checked_sub(bytes).ok_or_else(|| {
            format!(
                "its {bytes} bytes make all arrays more than {LARGEST_EXPANSION} times the file; write it uncompressed"
            )
        })?;
        self.expansion.set(left);
        compressor.expand(sizes, &compressed_sizes, &compressed)
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

    fn take<'s>(&self, stream: &mut Stream<'s>, count: u64) -> Result<std::borrow::Cow<'s, [u8]>, String> {
        let at_most = stream.at_most();
        let taken = usize::try_from(count).ok().and_then(|count| {
            let left = self.budget.get().checked_sub(count)?;
            self.budget.set(left);
            stream.take(count)
        });
        taken.ok_or_else(|| {
            format!("needs {count} bytes where at most {at_most} follow, or they are no base64: damaged or truncated")
        })
    }
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
