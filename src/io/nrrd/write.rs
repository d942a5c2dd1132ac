//! Writes NRRD: one array of a volume, little-endian, the header before the samples; the same bytes for the same volume.

use std::io::Write;
use std::path::Path;

use flate2::write::GzEncoder;
use glam::DVec3;

use crate::atomic::{io_at, write_atomically};
use crate::columns::{Association, FieldSelection, Lattice, Volume};
use crate::error::{Error, Result};
use crate::io::Compression;
use crate::io::numbers::{NumberType, little_endian, type_of};

/// Samples begin at a multiple of this, so that they are aligned for every type in a map of the file.
const ALIGNMENT: usize = 64;

/// Values that are converted at once.
const VALUES_AT_ONCE: usize = 1 << 20;

/// Writes the array called `name` of `volume` as `.nrrd`; the file appears whole or not at all. Uncompressed it can be read in place.
///
/// Values at cells become samples in their middle. A tuple is an axis of its own.
///
/// # Errors
/// [`Error::UnknownArray`]; [`Error::Io`].
///
/// ```
/// use cellfan::{columns::{Array, Association, Lattice, Volume}, io};
/// let values: Vec<i16> = (0..12).collect();
/// let array = Array { name: "density".into(), association: Association::Point, components: 1, values: values.into() };
/// let volume = Volume::new([3, 2, 2], Lattice::default(), vec![array])?;
/// # let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("density.nrrd");
/// io::write_nrrd(&path, &volume, "density", io::Compression::None)?;
/// let io::Mesh::Volume(read) = io::open_mesh(&path)? else { panic!("a volume") };
/// assert_eq!((read.arrays[0].values.get(11), read.owned_bytes()), (11.0, 0));
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn write_nrrd(path: &Path, volume: &Volume, name: &str, compression: Compression) -> Result<()> {
    let selection = FieldSelection::parse(name, &volume.arrays);
    let array = volume.arrays.iter().find(|array| {
        array.name == selection.name && selection.association.is_none_or(|found| found == array.association)
    });
    let array = array.ok_or_else(|| Error::UnknownArray {
        name: name.to_owned(),
        available: volume.arrays.iter().map(|array| array.name.clone()).collect(),
    })?;
    let (dims, lattice) = match array.association {
        Association::Point => (volume.dims, volume.lattice),
        Association::Cell => (volume.cell_dims(), volume.lattice.from_point(DVec3::splat(0.5))),
    };
    let header = header(dims, &lattice, array.components, type_of(&array.values), compression);
    write_atomically(path, |writer| {
        let at = io_at(path);
        writer.write_all(header.as_bytes()).map_err(&at)?;
        let mut encoder = GzEncoder::new(Vec::new(), flate2::Compression::default());
        let len = array.values.len();
        for first in (0..len).step_by(VALUES_AT_ONCE) {
            let bytes = little_endian(&array.values, first..len.min(first + VALUES_AT_ONCE));
            match compression {
                Compression::None => writer.write_all(&bytes).map_err(&at)?,
                Compression::Zlib => {
                    encoder.write_all(&bytes).map_err(&at)?;
                    writer.write_all(encoder.get_ref()).map_err(&at)?;
                    encoder.get_mut().clear();
                }
            }
        }
        match compression {
            Compression::None => Ok(()),
            Compression::Zlib => writer.write_all(&encoder.finish().map_err(&at)?).map_err(&at),
        }
    })
}

fn header(
    dims: [usize; 3],
    lattice: &Lattice,
    components: usize,
    number: NumberType,
    compression: Compression,
) -> String {
    let vector = |v: DVec3| format!("({},{},{})", v.x, v.y, v.z);
    let steps = lattice.steps();
    let mut sizes = dims.map(|size| size.to_string()).to_vec();
    let mut directions = vec![vector(steps.x_axis), vector(steps.y_axis), vector(steps.z_axis)];
    let mut kinds = vec!["space"; 3];
    if components > 1 {
        sizes.insert(0, components.to_string());
        directions.insert(0, "none".to_owned());
        kinds.insert(0, "vector");
    }
    let number = match number.name() {
        "f32" => "float".to_owned(),
        "f64" => "double".to_owned(),
        name if name.starts_with('u') => format!("uint{}", &name[1..]),
        name => format!("int{}", &name[1..]),
    };
    let encoding = if compression == Compression::None { "raw" } else { "gzip" };
    let fields = [
        "NRRD0004".to_owned(),
        format!("type: {number}"),
        format!("dimension: {}", sizes.len()),
        "space dimension: 3".to_owned(),
        format!("sizes: {}", sizes.join(" ")),
        format!("space directions: {}", directions.join(" ")),
        format!("kinds: {}", kinds.join(" ")),
        format!("space origin: {}", vector(lattice.origin())),
        "endian: little".to_owned(),
        format!("encoding: {encoding}"),
    ];
    let text = fields.join("\n") + "\n";
    // A comment fills up to where samples may begin: "#" and two ends of lines besides.
    let filled = (text.len() + 3).next_multiple_of(ALIGNMENT);
    let blanks = " ".repeat(filled - text.len() - 3);
    format!("{text}#{blanks}\n\n")
}
