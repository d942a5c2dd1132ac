//! `Cursor`: words, lines and arrays of a legacy file, in sequence.

use std::cell::Cell;

use super::super::numbers::{ByteOrder, NumberType, whole_numbers};
use super::super::scratch::collect;
use super::super::source::{Source, quote};
use crate::columns::{Column, NumericColumn};
use crate::error::{Error, Result, without_controls};

/// Where the reader is in a file.
#[derive(Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Whether arrays are binary.
    pub(super) binary: bool,
    pub(super) source: Source<'a>,
}

/// The type of a legacy array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DataType {
    Number(NumberType),
    /// One bit a value, most significant first; in text, one number a value.
    Bit,
    /// Integers of 32 bits in binary files, which index arrays are.
    Id,
    /// Text; skipped.
    Text,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8], source: Source<'a>) -> Self {
        Self { bytes, position: 0, binary: false, source }
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.position..).unwrap_or_default()
    }

    /// An error at the present byte.
    pub(super) fn malformed(&self, problem: impl Into<String>) -> Error {
        self.source.malformed(format!("byte {}", self.position), problem)
    }

    /// The rest of the line, without its end.
    pub(super) fn line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.position += (length + 1).min(rest.len());
        rest[..length].strip_suffix(b"\r").unwrap_or(&rest[..length])
    }

    /// Goes to the next line: binary values begin there.
    pub(super) fn end_line(&mut self) {
        self.line();
    }

    /// The next word, on this line or a later one.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.position += start + length;
        Some(&rest[start..start + length])
    }

    /// The next word of this line.
    pub(super) fn word_of_line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        if rest[..start].contains(&b'\n') { None } else { self.word() }
    }

    /// The next word in upper case; `None` at the end of the file.
    pub(super) fn next_keyword(&mut self) -> Option<String> {
        Some(String::from_utf8_lossy(self.word()?).to_ascii_uppercase())
    }

    /// Whether the next word is `keyword`, in any case; the cursor stays.
    pub(super) fn next_is(&self, keyword: &str) -> bool {
        let rest = self.rest().trim_ascii_start();
        rest.get(..keyword.len()).is_some_and(|word| word.eq_ignore_ascii_case(keyword.as_bytes()))
            && rest.get(keyword.len()).is_none_or(u8::is_ascii_whitespace)
    }

    /// The next word as a count, of what is said.
    pub(super) fn count(&mut self, of: &str) -> Result<usize> {
        let word = self.word().ok_or_else(|| self.malformed(format!("the file ends before {of}")))?;
        let count = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        count.ok_or_else(|| self.malformed(format!("{} is not {of}", quote(word))))
    }

    /// The next three words as numbers, of what is said.
    pub(super) fn coordinates(&mut self, of: &str) -> Result<[f64; 3]> {
        let mut coordinates = [0.0; 3];
        for coordinate in &mut coordinates {
            let word = self.word().ok_or_else(|| self.malformed(format!("the file ends before {of}")))?;
            let number = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
            *coordinate = number.ok_or_else(|| self.malformed(format!("{} is no number of {of}", quote(word))))?;
        }
        Ok(coordinates)
    }

    /// A name, with `%20` and the like decoded; characters that a terminal would obey are replaced.
    pub(super) fn name(&mut self) -> Result<String> {
        let word = self.word().ok_or_else(|| self.malformed("the file ends before a name"))?;
        let mut name = Vec::with_capacity(word.len());
        let mut at = 0;
        while at < word.len() {
            let code = (word[at] == b'%').then(|| word.get(at + 1..at + 3)).flatten();
            let code = code.and_then(|hex| u8::from_str_radix(std::str::from_utf8(hex).ok()?, 16).ok());
            name.push(code.unwrap_or(word[at]));
            at += if code.is_some() { 3 } else { 1 };
        }
        Ok(without_controls(String::from_utf8_lossy(&name).into_owned()))
    }

    /// The next word as a type.
    pub(super) fn data_type(&mut self) -> Result<DataType> {
        let word = self.word().ok_or_else(|| self.malformed("the file ends before a data type"))?;
        Ok(match word.to_ascii_lowercase().as_slice() {
            b"bit" => DataType::Bit,
            b"char" | b"signed_char" | b"vtktypeint8" => DataType::Number(NumberType::I8),
            b"unsigned_char" | b"vtktypeuint8" => DataType::Number(NumberType::U8),
            b"short" | b"vtktypeint16" => DataType::Number(NumberType::I16),
            b"unsigned_short" | b"vtktypeuint16" => DataType::Number(NumberType::U16),
            b"int" | b"vtktypeint32" => DataType::Number(NumberType::I32),
            b"unsigned_int" | b"vtktypeuint32" => DataType::Number(NumberType::U32),
            b"long" | b"long_long" | b"vtktypeint64" => DataType::Number(NumberType::I64),
            b"unsigned_long" | b"unsigned_long_long" | b"vtktypeuint64" => DataType::Number(NumberType::U64),
            b"float" | b"vtktypefloat32" => DataType::Number(NumberType::F32),
            b"double" | b"vtktypefloat64" => DataType::Number(NumberType::F64),
            b"vtkidtype" => DataType::Id,
            b"string" | b"utf8_string" => DataType::Text,
            _ => return Err(self.malformed(format!("{} is no data type", quote(word)))),
        })
    }

    /// The next word as a numeric type.
    pub(super) fn number_type(&mut self) -> Result<DataType> {
        match self.data_type()? {
            DataType::Text => Err(self.malformed("these values must be numbers, not text")),
            number => Ok(number),
        }
    }

    /// `count` tuples of `components` values each, from the next line on where they are binary.
    pub(super) fn tuples(&mut self, data: DataType, count: usize, components: usize) -> Result<NumericColumn> {
        let overflow = self.malformed(format!("{count} tuples of {components} values cannot be"));
        let Some(values) = count.checked_mul(components) else { return Err(overflow) };
        if !self.binary {
            let number = match data {
                DataType::Number(number) => number,
                DataType::Id => NumberType::I64,
                DataType::Bit | DataType::Text => NumberType::U8,
            };
            return self.text_values(number, values);
        }
        self.end_line();
        match data {
            DataType::Number(number) => {
                let Some(size) = values.checked_mul(number.size()) else { return Err(overflow) };
                self.decode(number, size)
            }
            DataType::Id => {
                let Some(size) = values.checked_mul(4) else { return Err(overflow) };
                self.decode(NumberType::I32, size)
            }
            DataType::Bit | DataType::Text => {
                let bytes = self.take(values.div_ceil(8))?;
                let bits = (0..values).map(|i| Ok(bytes[i / 8] >> (7 - i % 8) & 1));
                Ok(NumericColumn::U8(collect(self.source.scratch, bits)?))
            }
        }
    }

    fn decode(&mut self, number: NumberType, size: usize) -> Result<NumericColumn> {
        number.decode(size, [Ok(self.take(size)?)], ByteOrder::Big, self.source.scratch)
    }

    fn text_values(&mut self, number: NumberType, count: usize) -> Result<NumericColumn> {
        // A value takes a digit and a space, the last one perhaps no space.
        if count > self.rest().len().div_ceil(2) {
            return Err(self.truncated(count, "values"));
        }
        let mut ahead = Self { ..*self };
        let position = Cell::new(self.position);
        let words = std::iter::from_fn(|| {
            let word = ahead.word();
            position.set(ahead.position);
            word
        });
        let column = number.parse(words.take(count), self.source.scratch, |i, word| {
            let problem = format!("{} where value {i} of {count} is expected", quote(word));
            self.source.malformed(format!("byte {}", position.get()), problem)
        })?;
        self.position = position.get();
        if column.len() == count { Ok(column) } else { Err(self.truncated(count, "values")) }
    }

    /// `count` whole numbers of 32 bits.
    pub(super) fn integers(&mut self, count: usize) -> Result<NumericColumn> {
        self.tuples(DataType::Number(NumberType::I32), count, 1)
    }

    /// The next `count` bytes.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let taken = self.rest().get(..count).ok_or_else(|| self.truncated(count, "bytes"))?;
        self.position += count;
        Ok(taken)
    }

    fn truncated(&self, count: usize, of: &str) -> Error {
        let left = self.rest().len();
        self.malformed(format!("{count} {of} are declared, but {left} bytes are left: damaged or truncated"))
    }

    /// Skips a METADATA section: it ends at an empty line.
    pub(super) fn skip_metadata(&mut self) {
        self.end_line();
        while !self.rest().is_empty() {
            if self.line().trim_ascii().is_empty() {
                break;
            }
        }
    }

    /// Skips `count` strings: one a line, percent-encoded, or each after its length.
    pub(super) fn skip_strings(&mut self, count: usize) -> Result<()> {
        self.end_line();
        for _ in 0..count {
            if self.rest().is_empty() {
                return Err(self.truncated(count, "strings"));
            }
            if !self.binary {
                self.line();
                continue;
            }
            // The two highest bits of the first byte give the size of the length: 3, 2, 1, 0 for 1, 2, 4, 8 bytes.
            let size = match self.rest()[0] >> 6 {
                3 => 1,
                2 => 2,
                1 => 4,
                _ => 8,
            };
            let length = self
                .take(size)?
                .iter()
                .enumerate()
                .fold(0_u64, |length, (i, &byte)| length << 8 | u64::from(if i == 0 { byte & 0x3f } else { byte }));
            self.take(usize::try_from(length).unwrap_or(usize::MAX))?;
        }
        Ok(())
    }

    /// Indices out of a column; the first that is none is an error.
    pub(super) fn whole_numbers(&self, column: &NumericColumn, what: &str) -> Result<Column<u64>> {
        whole_numbers(column, i64::MAX as u64, self.source.scratch, |i, found| {
            self.malformed(format!("{what}: value {i} is {found}, which is no index"))
        })
    }
}
