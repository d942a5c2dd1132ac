//! Raw volumes: nothing but samples, so that someone has to say how many there are and of what type.

use std::fs::File;
use std::path::Path;
use std::str::FromStr;

use glam::DVec3;

use super::mapping::Mapped;
use super::numbers::{ByteOrder, NumberType};
use super::samples::{Samples, is_gzip};
use super::scratch::Scratch;
use super::source::Source;
use super::volume;
use crate::atomic::io_at;
use crate::columns::{Array, Association, Lattice, NumericColumn, Volume};
use crate::error::{Error, Result, presentable};

/// What the array of a volume without a name is called.
pub(super) const UNNAMED: &str = "value";

/// How samples stand in a raw file: i fastest, then j, then k.
///
/// As text it is `SIZES:TYPE`: three sizes with `x` between them; `u8`, `i8`, `u16` … `u64`, `f32` or `f64`, followed by `le` (the default) or
/// `be` for the order of bytes; and `@BYTES` where that many bytes stand before the samples.
///
/// ```
/// use cellfan::io::{RawLayout, read_raw};
/// let layout: RawLayout = "3x2x2:i16be@4".parse()?;
/// assert_eq!((layout.dims, layout.type_name(), layout.skip_bytes), ([3, 2, 2], "i16", 4));
/// let volume = read_raw(&[[0; 4].as_slice(), &[0, 7].repeat(12)].concat(), "a.raw".as_ref(), &layout)?;
/// assert_eq!(volume.arrays[0].values.get(11), 7.0);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawLayout {
    /// Samples along i, j and k.
    pub dims: [usize; 3],
    /// From sample to sample along x, y and z, in world units; 1 unless it is set.
    pub spacing: [f64; 3],
    /// Bytes before the first sample; of a file that gzip made, of what comes out.
    pub skip_bytes: usize,
    number: NumberType,
    order: ByteOrder,
}

impl RawLayout {
    /// The type of the samples, as in Rust.
    pub fn type_name(&self) -> &'static str {
        self.number.name()
    }
}

impl FromStr for RawLayout {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        parse(text).ok_or_else(|| Error::Option {
            option: "--raw",
            problem: presentable(format!(
                "{text:?}: expected sizes and type, such as 256x256x110:u8, 64x64x64:i16be or 64x64x64:f32@512"
            )),
        })
    }
}

fn parse(text: &str) -> Option<RawLayout> {
    let (sizes, samples) = text.split_once(':')?;
    let sizes: Vec<usize> = sizes.split(['x', 'X']).map(|size| size.trim().parse().ok()).collect::<Option<_>>()?;
    let (samples, skip) = samples.split_once('@').unwrap_or((samples, "0"));
    let (name, order) = match samples {
        _ if samples.ends_with("be") => (samples.strip_suffix("be")?, ByteOrder::Big),
        _ => (samples.strip_suffix("le").unwrap_or(samples), ByteOrder::Little),
    };
    let dims: [usize; 3] = sizes.try_into().ok().filter(|sizes: &[usize; 3]| !sizes.contains(&0))?;
    let (number, skip_bytes) = (NumberType::by_name(name)?, skip.parse().ok()?);
    Some(RawLayout { dims, spacing: [1.0; 3], skip_bytes, number, order })
}

/// Opens a raw volume, used in place where its samples are aligned and in this machine's order of bytes; one that gzip made is
/// uncompressed.
///
/// # Errors
/// [`Error::Io`]; [`Error::Malformed`] where the file is shorter than its layout, or the layout no grid; [`Error::OutOfMemory`].
pub fn open_raw(path: &Path, layout: &RawLayout) -> Result<Volume> {
    open_raw_in(path, layout, &Scratch::memory())
}

/// As [`open_raw`], the column where `scratch` says.
///
/// # Errors
/// Those of [`open_raw`], and [`Error::Io`] where a nameless file cannot be written.
pub fn open_raw_in(path: &Path, layout: &RawLayout, scratch: &Scratch) -> Result<Volume> {
    let file = File::open(path).map_err(io_at(path))?;
    if !scratch.maps_volume(&file) {
        return read(scratch.bytes_of(path, file)?.as_ref().as_ref(), None, path, layout, scratch);
    }
    let mapped = Mapped::open(path, file)?;
    read(mapped.bytes(), Some(&mapped), path, layout, scratch)
}

/// Reads a raw volume that is in memory; `path` is its name in messages.
///
/// # Errors
/// Those of [`open_raw`].
pub fn read_raw(bytes: &[u8], path: &Path, layout: &RawLayout) -> Result<Volume> {
    read(bytes, None, path, layout, &Scratch::memory())
}

fn read(bytes: &[u8], mapped: Option<&Mapped>, path: &Path, layout: &RawLayout, scratch: &Scratch) -> Result<Volume> {
    let &RawLayout { dims, spacing, skip_bytes, number, order } = layout;
    let source = Source { path, scratch };
    let volume = volume::of_file(dims, Lattice::new(DVec3::ZERO, spacing.into()), Vec::new(), "--raw", source)?;
    let samples = Samples { number, order, count: volume.points() };
    let is_compressed =
        is_gzip(bytes) && path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    let values = if is_compressed {
        samples.gzip(bytes, skip_bytes, source)?
    } else {
        let (taken, found) = (samples.size(source)?.saturating_add(skip_bytes), bytes.len());
        if taken < found {
            let file = path.display();
            tracing::warn!("{file}: {} bytes follow the samples: the sizes or the type may be wrong", found - taken);
        }
        samples.plain(bytes.get(skip_bytes..).unwrap_or_default(), mapped, source)?
    };
    Ok(volume::watched(Volume { arrays: vec![scalars(values)], ..volume }, mapped))
}

/// The only array of a volume: a sample a point.
fn scalars(values: NumericColumn) -> Array {
    Array { name: UNNAMED.to_owned(), association: Association::Point, components: 1, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_read() {
        let of = |text: &str| text.parse::<RawLayout>();
        let layout = of("256x256x110:u8").unwrap();
        assert_eq!(
            (layout.dims, layout.type_name(), layout.skip_bytes, layout.order),
            ([256, 256, 110], "u8", 0, ByteOrder::Little)
        );
        let layout = of("1X2x3:f64be@77").unwrap();
        assert_eq!(
            (layout.dims, layout.type_name(), layout.skip_bytes, layout.order),
            ([1, 2, 3], "f64", 77, ByteOrder::Big)
        );
        assert_eq!(of("2x2x2:i16le").unwrap(), of("2x2x2:i16").unwrap());
        for bad in [
            "",
            "2x2x2",
            "2x2:u8",
            "2x2x2x2:u8",
            "0x2x2:u8",
            "2x2x2:u9",
            "2x2x2:",
            "-1x2x2:u8",
            "2x2x2:u8@",
            "2x2x2:u8@-1",
        ] {
            assert!(of(bad).unwrap_err().to_string().contains("256x256x110:u8"), "{bad}");
        }
    }

    #[test]
    fn both_orders_and_gzip_give_the_same_and_short_files_are_refused() {
        use std::io::Write;
        let numbers: Vec<i16> = (0..12).map(|i| i * 700 - 4000).collect();
        let little: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let big: Vec<u8> = numbers.iter().flat_map(|number| number.to_be_bytes()).collect();
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(&[&[1, 2, 3], &big[..]].concat()).unwrap();
        let compressed = encoder.finish().unwrap();
        let cases = [
            (&little, "a.raw", "3x2x2:i16"),
            (&big, "b", "3x2x2:i16be"),
            (&[&[9; 5], &little[..]].concat(), "c.raw", "3x2x2:i16@5"),
            (&compressed, "d.raw.gz", "3x2x2:i16be@3"),
        ];
        for (bytes, name, layout) in cases {
            let layout: RawLayout = layout.parse().unwrap();
            let volume = read_raw(bytes, Path::new(name), &layout).unwrap();
            assert!(matches!(&volume.arrays[0].values, NumericColumn::I16(values) if values[..] == numbers), "{name}");
            let error = read_raw(&bytes[..bytes.len() / 2], Path::new(name), &layout).unwrap_err().to_string();
            assert!(error.starts_with(name) && (error.contains("truncated") || error.contains("damaged")), "{error}");
        }
        let spaced = |spacing| RawLayout { spacing, ..cases[0].2.parse().unwrap() };
        assert!(
            read_raw(&little, Path::new("a"), &spaced([1.0, f64::NAN, 1.0]))
                .unwrap_err()
                .to_string()
                .contains("finite")
        );
        let huge: RawLayout = format!("{0}x{0}x{0}:f64", u64::MAX).parse().unwrap();
        assert!(read_raw(&little, Path::new("a"), &huge).unwrap_err().to_string().contains("cannot be"));
    }
}
