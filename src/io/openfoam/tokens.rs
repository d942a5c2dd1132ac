//! The syntax of `OpenFOAM` files: a header, words and numbers, lists in ASCII or in binary.
//!
//! A list is its length and its values in parentheses, or the length and one value in braces, which all have.

use super::super::source::{Source, quote};
use crate::columns::FaceLists;
use crate::error::{Error, Result};

/// A file, and how far it has been read.
pub(super) struct Foam<'a> {
    bytes: &'a [u8],
    at: usize,
    pub(super) source: Source<'a>,
    /// What the header says the file holds.
    pub(super) class: String,
    is_binary: bool,
    /// Bytes of a label and of a number in binary.
    label_bytes: usize,
    scalar_bytes: usize,
}

impl<'a> Foam<'a> {
    /// Reads the header.
    pub(super) fn open(bytes: &'a [u8], source: Source<'a>) -> Result<Self> {
        let class = String::new();
        let mut file = Self { bytes, at: 0, source, class, is_binary: false, label_bytes: 4, scalar_bytes: 8 };
        if file.word()? != "FoamFile" {
            return Err(file.malformed("does not begin with a FoamFile header"));
        }
        file.expect(b'{')?;
        while file.peek() != Some(b'}') {
            let key = file.word()?;
            let value = file.until_semicolon()?;
            match (key, value.as_str()) {
                ("format", "binary") => file.is_binary = true,
                ("class", class) => class.clone_into(&mut file.class),
                ("arch", arch) => {
                    if arch.contains("MSB") {
                        let advice = "write it anew with foamFormatConvert";
                        return Err(source.unsupported("a big-endian OpenFOAM file", advice));
                    }
                    let bits = |name: &str| {
                        let rest = &arch[arch.find(name)? + name.len()..];
                        rest.split(|c: char| !c.is_ascii_digit()).next()?.parse::<usize>().ok()
                    };
                    file.label_bytes = if bits("label=") == Some(64) { 8 } else { 4 };
                    file.scalar_bytes = if bits("scalar=") == Some(32) { 4 } else { 8 };
                }
                _ => {}
            }
        }
        file.expect(b'}')?;
        Ok(file)
    }

    /// The list of vectors that the file is.
    pub(super) fn vectors(&mut self) -> Result<Vec<[f64; 3]>> {
        let values = self.scalars(3, None)?;
        Ok(values.as_chunks().0.to_vec())
    }

    /// The list of labels that the file is, at most `limit` of them; −1 becomes the largest number.
    pub(super) fn labels(&mut self, limit: usize) -> Result<Vec<u32>> {
        let count = self.count()?;
        if count > limit {
            return Err(self.malformed(&format!("a list of {count} labels where {limit} are the most: damaged")));
        }
        if self.peek() == Some(b'{') {
            self.at += 1;
            let value = self.label()?;
            self.expect(b'}')?;
            return Ok(vec![value; count]);
        }
        self.list(count, self.label_bytes, Self::label, label_of)
    }

    /// The faces that the file lists, as those of one cell.
    pub(super) fn faces(&mut self) -> Result<FaceLists> {
        let mut faces = FaceLists::default();
        if self.class == "faceCompactList" {
            let starts = self.labels(self.bytes.len())?;
            let points = self.labels(self.bytes.len())?;
            for (face, two) in starts.windows(2).enumerate() {
                let around = points.get(two[0] as usize..two[1] as usize);
                let around =
                    around.ok_or_else(|| self.malformed(&format!("face {face} has no such corners: damaged")))?;
                faces.push_face(around);
            }
        } else {
            if self.is_binary {
                let advice = "write it anew with foamFormatConvert";
                return Err(self.source.unsupported(format!("a binary {}", quote(self.class.as_bytes())), advice));
            }
            let count = self.count()?;
            self.expect(b'(')?;
            for _ in 0..count {
                let corners = self.labels(self.bytes.len())?;
                faces.push_face(&corners);
            }
            self.expect(b')')?;
        }
        faces.end_cell();
        Ok(faces)
    }

    /// A list of tuples of `components` numbers, one after the other; `expected` of them where that is known.
    pub(super) fn scalars(&mut self, components: usize, expected: Option<usize>) -> Result<Vec<f64>> {
        let count = self.count()?;
        if expected.is_some_and(|expected| expected != count) {
            return Err(self.malformed(&format!(
                "a list of {count} values for {} cells: damaged, or of another mesh",
                expected.unwrap_or(0)
            )));
        }
        if self.peek() == Some(b'{') && expected.is_some() {
            self.at += 1;
            let tuple = self.tuple(components)?;
            self.expect(b'}')?;
            return Ok(tuple.repeat(count));
        }
        if self.is_binary {
            let len = count.checked_mul(components).ok_or_else(|| self.malformed("a list too long"))?;
            return self.list(len, self.scalar_bytes, |_| Ok(0.0), scalar_of);
        }
        self.expect(b'(')?;
        let mut values = Vec::with_capacity(count.saturating_mul(components).min(self.bytes.len() / 2));
        for _ in 0..count {
            values.append(&mut self.tuple(components)?);
        }
        self.expect(b')')?;
        Ok(values)
    }

    /// One number, or several in parentheses.
    pub(super) fn tuple(&mut self, components: usize) -> Result<Vec<f64>> {
        if components > 1 {
            self.expect(b'(')?;
        }
        let tuple = (0..components).map(|_| self.number()).collect::<Result<_>>()?;
        if components > 1 {
            self.expect(b')')?;
        }
        Ok(tuple)
    }

    /// `count` values in parentheses: by `read` in ASCII, by `decode` out of `size` bytes each in binary.
    fn list<T>(
        &mut self,
        count: usize,
        size: usize,
        read: impl Fn(&mut Self) -> Result<T>,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>> {
        // An empty binary list may have no parentheses.
        if count == 0 && self.peek() != Some(b'(') {
            return Ok(Vec::new());
        }
        self.expect(b'(')?;
        let values = if self.is_binary {
            let bytes = count.checked_mul(size).and_then(|size| self.bytes[self.at..].get(..size));
            let bytes =
                bytes.ok_or_else(|| self.malformed(&format!("a list of {count} values is cut off: truncated")))?;
            self.at += bytes.len();
            bytes.chunks_exact(size).map(decode).collect()
        } else {
            let mut values = Vec::with_capacity(count.min(self.bytes.len() / 2));
            for _ in 0..count {
                values.push(read(self)?);
            }
            values
        };
        self.expect(b')')?;
        Ok(values)
    }

    fn label(&mut self) -> Result<u32> {
        let word = self.word()?;
        let value: Option<i64> = word.parse().ok();
        value
            .and_then(|value| if value == -1 { Some(u32::MAX) } else { value.try_into().ok() })
            .ok_or_else(|| self.malformed(&format!("{} is no number of a point or cell", quote(word.as_bytes()))))
    }

    fn number(&mut self) -> Result<f64> {
        let word = self.word()?;
        word.parse().map_err(|_| self.malformed(&format!("{} is no number", quote(word.as_bytes()))))
    }

    /// The length of a list, after its type where that is given.
    fn count(&mut self) -> Result<usize> {
        let mut word = self.word()?;
        if word.starts_with("List<") {
            word = self.word()?;
        }
        word.parse().map_err(|_| self.malformed(&format!("{} is no length of a list", quote(word.as_bytes()))))
    }

    /// The next entry of a dictionary: its key, the file standing at its value; nothing at the end.
    pub(super) fn next_key(&mut self) -> Result<Option<&'a str>> {
        if self.peek().is_none() { Ok(None) } else { self.word().map(Some) }
    }

    /// Passes over the value of an entry: a block in braces, or all up to a semicolon.
    pub(super) fn skip_value(&mut self) -> Result<()> {
        if self.peek() != Some(b'{') {
            return self.until_semicolon().map(drop);
        }
        let mut depth = 0;
        while let Some(byte) = self.peek() {
            self.at += 1;
            match byte {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return Ok(());
            }
        }
        Err(self.malformed("a block is not closed: truncated"))
    }

    /// The text up to the next semicolon, which is passed over.
    fn until_semicolon(&mut self) -> Result<String> {
        self.peek();
        let rest = &self.bytes[self.at..];
        let mut is_quoted = false;
        let end = rest.iter().position(|&byte| {
            is_quoted ^= byte == b'"';
            byte == b';' && !is_quoted
        });
        let end = end.ok_or_else(|| self.malformed("an entry does not end in a semicolon: truncated"))?;
        self.at += end + 1;
        Ok(String::from_utf8_lossy(rest[..end].trim_ascii()).into_owned())
    }

    /// The next word: up to a space or a bracket.
    pub(super) fn word(&mut self) -> Result<&'a str> {
        self.peek();
        let rest = &self.bytes[self.at..];
        let is_end = |byte: &u8| byte.is_ascii_whitespace() || b"(){}[];".contains(byte);
        let mut len = rest.iter().position(is_end).unwrap_or(rest.len());
        if rest[..len].starts_with(b"List<") {
            // A type, which the length may follow without a space.
            len = rest[..len].iter().position(|&byte| byte == b'>').map_or(len, |end| end + 1);
        }
        let word = std::str::from_utf8(&rest[..len]).ok().filter(|word| !word.is_empty());
        let word = word.ok_or_else(|| self.malformed("a word or number is expected here: damaged or truncated"))?;
        self.at += len;
        Ok(word)
    }

    fn expect(&mut self, byte: u8) -> Result<()> {
        if self.peek() == Some(byte) {
            self.at += 1;
            return Ok(());
        }
        Err(self.malformed(&format!("'{}' is expected here: damaged or truncated", char::from(byte))))
    }

    /// The next byte that is no space and no comment.
    pub(super) fn peek(&mut self) -> Option<u8> {
        loop {
            let rest = &self.bytes[self.at..];
            let skipped = match rest {
                [b'/', b'/', ..] => rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len()),
                [b'/', b'*', ..] => rest.windows(2).position(|two| two == b"*/").map_or(rest.len(), |end| end + 2),
                [byte, ..] if byte.is_ascii_whitespace() => 1,
                [byte, ..] => return Some(*byte),
                [] => return None,
            };
            self.at += skipped;
        }
    }

    pub(super) fn malformed(&self, problem: &str) -> Error {
        self.source.malformed(format!("byte {}", self.at), problem)
    }
}

/// A label of four or eight bytes; −1, or one too large, becomes the largest number.
fn label_of(bytes: &[u8]) -> u32 {
    let value = match bytes {
        &[a, b, c, d] => i64::from(i32::from_le_bytes([a, b, c, d])),
        _ => bytes.try_into().map_or(-1, i64::from_le_bytes),
    };
    value.try_into().unwrap_or(u32::MAX)
}

/// A number of four or eight bytes.
fn scalar_of(bytes: &[u8]) -> f64 {
    match bytes {
        &[a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => bytes.try_into().map_or(f64::NAN, f64::from_le_bytes),
    }
}
