//! NRRD: a text header, and samples behind it or in another file (teem.sourceforge.net/nrrd/format.html, versions 1 to 5).
//!
//! In: the bytes of a header. Out: [`Volume`]. `header.rs` reads the fields, `axes.rs` makes a grid of what they say of the axes,
//! `write.rs` writes. Read are the encodings raw, gzip and text, all integer and floating-point types, and data in one file.
//! To add an encoding: its line in [`Encoding::of`] and in [`read_samples`].

mod axes;
mod header;
mod write;

#[cfg(test)]
mod tests;

use std::fs::File;
use std::path::{Path, PathBuf};

use self::axes::Axes;
use self::header::Header;
pub use self::write::write_nrrd;
use super::mapping::Mapped;
use super::numbers::{ByteOrder, NumberType};
use super::raw::UNNAMED;
use super::samples::Samples;
use super::scratch::Scratch;
use super::source::{Source, quote};
use super::{MOST_ARRAYS, volume};
use crate::atomic::io_at;
use crate::columns::{Array, Association, NumericColumn, Volume};
use crate::error::Result;

/// Bytes of the longest path of a file of samples: Linux opens none that is longer.
const LONGEST_NAME: usize = 4096;

/// Reads a NRRD header that is in memory, and the samples behind it or in the file that it names relative to the folder of `path`.
///
/// The samples are values at points. Axes before those of space (`kinds`, or `none` among `space directions`) make tuples, colours or
/// vectors; axes behind them make arrays of their own. The names of spaces, such as `left-posterior-superior`, turn nothing.
///
/// # Errors
/// [`Error::Malformed`](crate::Error::Malformed); [`Error::Unsupported`](crate::Error::Unsupported) for other encodings and types, and data
/// in several files; [`Error::Io`](crate::Error::Io) where the file of samples cannot be read.
pub fn read_nrrd(bytes: &[u8], path: &Path) -> Result<Volume> {
    read_nrrd_in(bytes, None, path, &Scratch::memory())
}

/// As [`read_nrrd`], the columns where `scratch` says, or in place of a mapped file: `mapped`, whose bytes these are, or the file that
/// they name.
pub(super) fn read_nrrd_in(bytes: &[u8], mapped: Option<&Mapped>, path: &Path, scratch: &Scratch) -> Result<Volume> {
    let source = Source { path, scratch };
    let header = Header::parse(bytes, source)?;
    let axes = Axes::of(&header, source)?;
    let volume = volume::of_file(axes.dims, axes.lattice, Vec::new(), "sizes, spacings and directions", source)?;
    let count = [volume.points(), axes.components, axes.arrays];
    let count = count.into_iter().try_fold(1_usize, usize::checked_mul);
    let count = count.ok_or_else(|| source.malformed("sizes", "are more samples than there can be: damaged"))?;
    let data = Data::of(&header, count, source)?;

    let Some(file_path) = &data.file else {
        let bytes = bytes.get(header.end..).unwrap_or_default();
        return Ok(volume::watched(with_arrays(volume, &axes, bytes, mapped, &data, source)?, mapped));
    };
    let file = File::open(file_path).map_err(io_at(file_path))?;
    let at_file = Source { path: file_path, scratch };
    if scratch.maps_volume(&file) {
        let mapped = Mapped::open(file_path, file)?;
        let volume = with_arrays(volume, &axes, mapped.bytes(), Some(&mapped), &data, at_file)?;
        return Ok(volume::watched(volume, Some(&mapped)));
    }
    let bytes = scratch.bytes_of(file_path, file)?;
    with_arrays(volume, &axes, (*bytes).as_ref(), None, &data, at_file)
}

/// How samples are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Raw,
    Gzip,
    Text,
}

impl Encoding {
    fn of(header: &Header<'_>, source: Source<'_>) -> Result<Self> {
        let field = header.required("encoding", source)?;
        match field.value.to_ascii_lowercase().as_str() {
            "raw" => Ok(Self::Raw),
            "gz" | "gzip" => Ok(Self::Gzip),
            "txt" | "text" | "ascii" => Ok(Self::Text),
            "hex" | "bz2" | "bzip2" | "zrl" => {
                let what = format!("a NRRD file with encoding {}", field.value);
                Err(source.unsupported(what, "write it raw or with gzip (unu save -f nrrd -e gzip)"))
            }
            _ => Err(field.malformed(format!("{} is no encoding", quote(field.value.as_bytes())), source)),
        }
    }
}

/// What comes before the samples of a raw file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Skip {
    Bytes(usize),
    /// Everything: the samples are the last bytes.
    AllBefore,
}

/// Where the samples are, and how they are written.
#[derive(Debug)]
struct Data {
    samples: Samples,
    encoding: Encoding,
    skip_lines: usize,
    skip: Skip,
    /// None: behind the header.
    file: Option<PathBuf>,
}

impl Data {
    fn of(header: &Header<'_>, count: usize, source: Source<'_>) -> Result<Self> {
        let number = number_type(header, source)?;
        let encoding = Encoding::of(header, source)?;
        let order = match header.field("endian") {
            None if number.size() == 1 || encoding == Encoding::Text => ByteOrder::Little,
            None => {
                let problem = format!("names no endian, which {} samples need: add \"endian: little\"", number.name());
                return Err(source.malformed("the header", problem));
            }
            Some(field) => match field.value.to_ascii_lowercase().as_str() {
                "little" => ByteOrder::Little,
                "big" => ByteOrder::Big,
                _ => return Err(field.malformed("is neither little nor big", source)),
            },
        };
        let skip_lines = header.field("lineskip").map_or(Ok(0), |field| field.count(source))?;
        let skip = match header.field("byteskip") {
            Some(field) if field.value == "-1" && encoding == Encoding::Raw => Skip::AllBefore,
            Some(field) if field.value == "-1" => {
                return Err(field.malformed("-1 is for raw samples only", source));
            }
            Some(field) => Skip::Bytes(field.count(source)?),
            None => Skip::Bytes(0),
        };
        let file = header.field("datafile").map(|field| data_path(&field, source)).transpose()?;
        Ok(Self { samples: Samples { number, order, count }, encoding, skip_lines, skip, file })
    }
}

/// The type of the samples, by any of its names.
fn number_type(header: &Header<'_>, source: Source<'_>) -> Result<NumberType> {
    let field = header.required("type", source)?;
    let words: Vec<String> = field.value.split_ascii_whitespace().map(str::to_ascii_lowercase).collect();
    Ok(match words.join(" ").as_str() {
        "signed char" | "int8" | "int8_t" => NumberType::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => NumberType::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => NumberType::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => NumberType::U16,
        "int" | "signed int" | "int32" | "int32_t" => NumberType::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => NumberType::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => NumberType::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => NumberType::U64,
        "float" => NumberType::F32,
        "double" => NumberType::F64,
        "block" => {
            return Err(source.unsupported("a NRRD file of blocks", "write its samples as numbers (unu convert)"));
        }
        _ => return Err(field.malformed(format!("{} is no type", quote(field.value.as_bytes())), source)),
    })
}

/// The one file that holds the samples.
fn data_path(field: &header::Field<'_>, source: Source<'_>) -> Result<PathBuf> {
    let name = field.value;
    if name.eq_ignore_ascii_case("LIST") || name.to_ascii_uppercase().starts_with("LIST ") || name.contains('%') {
        let advice = "join them first (unu save -f nrrd -e raw)";
        return Err(source.unsupported("a NRRD file with samples in several files", advice));
    }
    if name.len() > LONGEST_NAME || name.is_empty() || name.contains(char::is_control) {
        return Err(field.malformed(format!("{} is no name of a file", quote(name.as_bytes())), source));
    }
    let path = source.path.parent().unwrap_or(Path::new("")).join(name);
    // A device or a pipe may never end.
    if path.exists() && !path.is_file() {
        return Err(field.malformed(format!("{} is no file", quote(name.as_bytes())), source));
    }
    Ok(path)
}

/// The volume with the samples in `bytes`, which stand in the file of `source`.
fn with_arrays(
    volume: Volume,
    axes: &Axes,
    bytes: &[u8],
    mapped: Option<&Mapped>,
    data: &Data,
    source: Source<'_>,
) -> Result<Volume> {
    if axes.arrays == 1 {
        let values = read_samples(bytes, mapped, data, source)?;
        return Ok(Volume { arrays: vec![array(UNNAMED.to_owned(), axes, values)], ..volume });
    }
    if axes.arrays > MOST_ARRAYS {
        let problem = format!("make {} arrays, more than {MOST_ARRAYS}; leave some out", axes.arrays);
        return Err(source.malformed("the axes behind those of space", problem));
    }
    if data.encoding != Encoding::Raw {
        let what = "a NRRD file of several volumes that is not raw";
        return Err(source.unsupported(what, "write it raw (unu save -f nrrd -e raw)"));
    }
    let samples = Samples { count: data.samples.count / axes.arrays, ..data.samples };
    let bytes = behind_skip(bytes, data, source)?;
    let step = samples.size(source)?;
    let one = |i: usize| {
        let values = samples.plain(bytes.get(i * step..).unwrap_or_default(), mapped, source)?;
        Ok(array(format!("{UNNAMED} {i}"), axes, values))
    };
    Ok(Volume { arrays: (0..axes.arrays).map(one).collect::<Result<_>>()?, ..volume })
}

fn array(name: String, axes: &Axes, values: NumericColumn) -> Array {
    Array { name, association: Association::Point, components: axes.components, values }
}

fn read_samples(bytes: &[u8], mapped: Option<&Mapped>, data: &Data, source: Source<'_>) -> Result<NumericColumn> {
    match (data.encoding, data.skip) {
        (Encoding::Raw, _) => data.samples.plain(behind_skip(bytes, data, source)?, mapped, source),
        (Encoding::Gzip, Skip::Bytes(skip)) => data.samples.gzip(behind_lines(bytes, data, source)?, skip, source),
        (Encoding::Text, Skip::Bytes(skip)) => {
            let lines = behind_lines(bytes, data, source)?;
            data.samples.text(lines.get(skip..).unwrap_or_default(), source)
        }
        (Encoding::Gzip | Encoding::Text, Skip::AllBefore) => {
            Err(source.malformed("byte skip", "-1 is for raw samples"))
        }
    }
}

/// What follows the lines and bytes that are to be skipped.
fn behind_skip<'a>(bytes: &'a [u8], data: &Data, source: Source<'_>) -> Result<&'a [u8]> {
    match data.skip {
        Skip::Bytes(skip) => Ok(behind_lines(bytes, data, source)?.get(skip..).unwrap_or_default()),
        Skip::AllBefore => Ok(&bytes[bytes.len().saturating_sub(data.samples.size(source)?)..]),
    }
}

fn behind_lines<'a>(bytes: &'a [u8], data: &Data, source: Source<'_>) -> Result<&'a [u8]> {
    let mut rest = bytes;
    for line in 0..data.skip_lines {
        let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
            let problem = format!("is {}, but there are {line} lines: damaged or truncated", data.skip_lines);
            return Err(source.malformed("line skip", problem));
        };
        rest = &rest[end + 1..];
    }
    Ok(rest)
}
