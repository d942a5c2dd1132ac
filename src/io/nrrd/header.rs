//! `Header`: the fields of a NRRD header, line by line.

use crate::error::{Error, Result};
use crate::io::source::{Source, quote};

/// Bytes that a header may have: it holds a line a field.
const LONGEST: usize = 1 << 20;

/// The fields, and where they end.
#[derive(Debug)]
pub(super) struct Header<'a> {
    fields: Vec<Field<'a>>,
    /// The byte behind the empty line that ends it.
    pub(super) end: usize,
}

/// A line `name: value`.
#[derive(Clone, Debug)]
pub(super) struct Field<'a> {
    /// In lower case, without spaces: `data file` and `datafile` are one.
    name: String,
    pub(super) value: &'a str,
    line: usize,
}

impl<'a> Header<'a> {
    /// Reads lines up to the first empty one, or to the end of a file that is all header.
    pub(super) fn parse(bytes: &'a [u8], source: Source<'_>) -> Result<Self> {
        let mut rest = &bytes[..bytes.len().min(LONGEST)];
        let mut header = Self { fields: Vec::new(), end: bytes.len() };
        for number in 1.. {
            if rest.is_empty() {
                break;
            }
            let length = rest.iter().position(|&byte| byte == b'\n');
            if length.is_none() && bytes.len() > LONGEST {
                let problem = format!("does not end within {LONGEST} bytes: this is no NRRD header");
                return Err(source.malformed(format!("line {number}"), problem));
            }
            let (line, behind) = rest.split_at(length.unwrap_or(rest.len()));
            rest = behind.get(1..).unwrap_or_default();
            let line = line.strip_suffix(b"\r").unwrap_or(line);
            if number == 1 {
                check_magic(line, source)?;
                continue;
            }
            if line.is_empty() {
                header.end = bytes.len().min(LONGEST) - rest.len();
                break;
            }
            header.add(line, number, source)?;
        }
        Ok(header)
    }

    fn add(&mut self, line: &'a [u8], number: usize, source: Source<'_>) -> Result<()> {
        if line.starts_with(b"#") {
            return Ok(());
        }
        let bad = |problem: &str| source.malformed(format!("line {number}"), format!("{} {problem}", quote(line)));
        let text = std::str::from_utf8(line).map_err(|_| bad("is no text"))?;
        let (name, value) = text.split_once(':').ok_or_else(|| bad("is no field (NAME: VALUE): damaged"))?;
        // KEY:=VALUE may hold anything.
        if value.starts_with('=') {
            return Ok(());
        }
        let name: String = name.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_lowercase).collect();
        if self.field(&name).is_some() {
            return Err(bad("is there twice"));
        }
        self.fields.push(Field { name, value: value.trim(), line: number });
        Ok(())
    }

    /// The field of that name (in lower case, without spaces).
    pub(super) fn field(&self, name: &str) -> Option<Field<'a>> {
        self.fields.iter().find(|field| field.name == name).cloned()
    }

    /// The same, which has to be there.
    pub(super) fn required(&self, name: &str, source: Source<'_>) -> Result<Field<'a>> {
        self.field(name).ok_or_else(|| source.malformed("the header", format!("has no field {name:?}: truncated?")))
    }
}

fn check_magic(line: &[u8], source: Source<'_>) -> Result<()> {
    match line.strip_prefix(b"NRRD000") {
        Some([b'1'..=b'5']) => Ok(()),
        Some([b'6'..=b'9']) => {
            let what = format!("NRRD of version {}", quote(line));
            Err(source.unsupported(what, "write version 5 or older"))
        }
        _ => Err(source.malformed("line 1", format!("is {}, not NRRD0001 to NRRD0005", quote(line)))),
    }
}

impl Field<'_> {
    /// What is wrong with it.
    pub(super) fn malformed(&self, problem: impl AsRef<str>, source: Source<'_>) -> Error {
        source.malformed(format!("line {}, {}", self.line, quote(self.name.as_bytes())), problem.as_ref())
    }

    /// A whole number.
    pub(super) fn count(&self, source: Source<'_>) -> Result<usize> {
        self.value.parse().map_err(|_| self.malformed(format!("{} is no whole number", self.shown()), source))
    }

    /// `count` words.
    pub(super) fn words(&self, count: usize, source: Source<'_>) -> Result<Vec<&str>> {
        let words: Vec<&str> = self.value.split_ascii_whitespace().collect();
        self.check_len(words.len(), count, source)?;
        Ok(words)
    }

    /// `count` whole numbers.
    pub(super) fn counts(&self, count: usize, source: Source<'_>) -> Result<Vec<usize>> {
        let parse = |word: &str| word.parse().ok();
        let numbers: Option<Vec<usize>> = self.words(count, source)?.into_iter().map(parse).collect();
        numbers.ok_or_else(|| self.malformed(format!("{} are not {count} whole numbers", self.shown()), source))
    }

    /// `count` numbers, which may be NaN.
    pub(super) fn numbers(&self, count: usize, source: Source<'_>) -> Result<Vec<f64>> {
        let parse = |word: &str| word.parse().ok();
        let numbers: Option<Vec<f64>> = self.words(count, source)?.into_iter().map(parse).collect();
        numbers.ok_or_else(|| self.malformed(format!("{} are not {count} numbers", self.shown()), source))
    }

    /// `count` vectors `(x,y,z)`, some of which may be `none`.
    pub(super) fn vectors(&self, count: usize, source: Source<'_>) -> Result<Vec<Option<[f64; 3]>>> {
        let bad = || self.malformed(format!("{} are not {count} vectors (x,y,z) or none", self.shown()), source);
        let (mut vectors, mut rest) = (Vec::new(), self.value.trim());
        while !rest.is_empty() {
            let length = if rest.starts_with('(') {
                rest.find(')').ok_or_else(bad)? + 1
            } else {
                rest.find(|c: char| c.is_whitespace() || c == '(').unwrap_or(rest.len())
            };
            let (word, behind) = rest.split_at(length);
            vectors.push(if word == "none" { None } else { Some(self.vector(word, source)?) });
            rest = behind.trim_start();
        }
        self.check_len(vectors.len(), count, source)?;
        Ok(vectors)
    }

    /// A vector of up to three numbers.
    pub(super) fn vector(&self, text: &str, source: Source<'_>) -> Result<[f64; 3]> {
        let inner = text.trim().strip_prefix('(').and_then(|text| text.strip_suffix(')'));
        let parse = |inner: &str| inner.split(',').map(|word| word.trim().parse().ok()).collect::<Option<Vec<f64>>>();
        let numbers = inner.and_then(parse).filter(|numbers| numbers.len() <= 3);
        let numbers = numbers
            .ok_or_else(|| self.malformed(format!("{} is no vector of space", quote(text.as_bytes())), source))?;
        Ok([0, 1, 2].map(|axis| numbers.get(axis).copied().unwrap_or(0.0)))
    }

    fn shown(&self) -> String {
        quote(self.value.as_bytes())
    }

    fn check_len(&self, found: usize, count: usize, source: Source<'_>) -> Result<()> {
        if found == count {
            return Ok(());
        }
        Err(self.malformed(format!("{} are {found} entries where the dimension is {count}", self.shown()), source))
    }
}
