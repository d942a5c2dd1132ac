//! Writes `.vtu`: appended raw data, little-endian, 64-bit headers; the same bytes for the same mesh.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use flate2::write::ZlibEncoder;
use rayon::prelude::*;

use super::UnstructuredMesh;
use super::face_streams::streams_of;
use super::numbers::{NumberType, little_endian, type_of};
use crate::atomic::{io_at, write_atomically};
use crate::columns::{Association, NumericColumn, Points};
use crate::error::Result;

/// Whether arrays are compressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// As they are: fastest to write and to read.
    None,
    /// In blocks by zlib, which every reader of VTK files knows.
    #[default]
    Zlib,
}

/// Bytes of a block that is compressed by itself; large enough to cost nothing, small enough for many threads.
const BLOCK_BYTES: usize = 1 << 18;

/// Writes `mesh` as a `.vtu` file; the file appears whole or not at all.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io).
///
/// ```
/// # use cellfan::{columns::Points, io::{self, Compression, UnstructuredMesh}};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("tet.vtu");
/// let mut mesh = UnstructuredMesh::empty();
/// mesh.points = Points::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
/// (mesh.types, mesh.offsets, mesh.connectivity) = (vec![10].into(), vec![0, 4].into(), vec![0, 1, 2, 3].into());
/// io::write_vtu(&path, &mesh, Compression::Zlib)?;
/// assert_eq!(io::open(&path)?.tets.len(), 1);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn write_vtu(path: &Path, mesh: &UnstructuredMesh, compression: Compression) -> Result<()> {
    let mut arrays = Vec::new();
    for section in ["PointData", "CellData"] {
        let association = if section == "PointData" { Association::Point } else { Association::Cell };
        for array in mesh.arrays.iter().filter(|array| array.association == association) {
            arrays.push((section, array.name.clone(), array.components, Payload::new(array.values.clone())));
        }
    }
    arrays.push(("Points", "Points".to_owned(), 3, Payload::new(points(&mesh.points))));
    for (name, column) in cells(mesh) {
        arrays.push(("Cells", name.to_owned(), 1, Payload::new(column)));
    }
    if !mesh.faces.is_empty() {
        let (streams, ends) = streams_of(&mesh.faces, mesh.cells());
        for (name, values) in [("faces", streams), ("faceoffsets", ends)] {
            arrays.push(("Cells", name.to_owned(), 1, Payload::new(values.into())));
        }
    }
    if compression == Compression::Zlib {
        for (.., payload) in &mut arrays {
            payload.compress();
        }
    }

    let write = |out: &mut BufWriter<File>| -> io::Result<()> {
        out.write_all(head(mesh, compression, &arrays).as_bytes())?;
        for (.., payload) in &arrays {
            payload.write(out)?;
        }
        out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    };
    write_atomically(path, |out| write(out).map_err(io_at(path)))
}

/// The XML before the data.
fn head(mesh: &UnstructuredMesh, compression: Compression, arrays: &[(&str, String, usize, Payload)]) -> String {
    let compressor = match compression {
        Compression::None => "",
        Compression::Zlib => " compressor=\"vtkZLibDataCompressor\"",
    };
    let (point_count, cell_count) = (mesh.points.len(), mesh.cells());
    let mut lines = vec![
        "<?xml version=\"1.0\"?>".to_owned(),
        format!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\"{compressor}>"
        ),
        "  <UnstructuredGrid>".to_owned(),
        format!("    <Piece NumberOfPoints=\"{point_count}\" NumberOfCells=\"{cell_count}\">"),
    ];
    let mut offset = 0;
    for section in ["PointData", "CellData", "Points", "Cells"] {
        lines.push(format!("      <{section}>"));
        for (_, name, components, payload) in arrays.iter().filter(|(of, ..)| *of == section) {
            let (number, name) = (type_name(type_of(&payload.values)), escape(name));
            lines.push(format!(
                "        <DataArray type=\"{number}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
                 format=\"appended\" offset=\"{offset}\"/>"
            ));
            offset += payload.size();
        }
        lines.push(format!("      </{section}>"));
    }
    let end = "    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n   _";
    lines.join("\n") + "\n" + end
}

/// `text` as an attribute's value; control characters, which XML cannot hold, become spaces.
fn escape(text: &str) -> String {
    let printable: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    quick_xml::escape::escape(&printable).into_owned()
}

fn points(points: &Points) -> NumericColumn {
    match points {
        Points::F32(points) => points.as_flattened().to_vec().into(),
        Points::F64(points) => points.as_flattened().to_vec().into(),
    }
}

/// Connectivity, offsets and types; 32-bit integers where they are enough.
fn cells(mesh: &UnstructuredMesh) -> [(&'static str, NumericColumn); 3] {
    let small = |largest: u64| i32::try_from(largest).is_ok();
    let connectivity = if small(mesh.points.len() as u64) {
        mesh.connectivity.iter().map(|&point| point as i32).collect::<Vec<_>>().into()
    } else {
        mesh.connectivity.iter().map(|&point| i64::from(point)).collect::<Vec<_>>().into()
    };
    let ends = mesh.offsets.get(1..).unwrap_or_default();
    let offsets = if small(ends.last().copied().unwrap_or(0)) {
        ends.iter().map(|&end| end as i32).collect::<Vec<_>>().into()
    } else {
        ends.iter().map(|&end| end as i64).collect::<Vec<_>>().into()
    };
    [("connectivity", connectivity), ("offsets", offsets), ("types", mesh.types.clone().into())]
}

/// The values of an array, and its compressed blocks if they are.
struct Payload {
    values: NumericColumn,
    blocks: Option<Vec<Vec<u8>>>,
}

impl Payload {
    fn new(values: NumericColumn) -> Self {
        Self { values, blocks: None }
    }

    fn value_bytes(&self) -> usize {
        self.values.len() * type_of(&self.values).size()
    }

    /// The values of each block.
    fn ranges(&self) -> Vec<std::ops::Range<usize>> {
        let len = self.values.len();
        let step = BLOCK_BYTES / type_of(&self.values).size();
        (0..len).step_by(step).map(|start| start..(start + step).min(len)).collect()
    }

    fn compress(&mut self) {
        let compress = |range| {
            let mut encoder = ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            // A vector takes everything.
            let _ = encoder.write_all(&little_endian(&self.values, range));
            encoder.finish().unwrap_or_default()
        };
        self.blocks = Some(self.ranges().into_par_iter().map(compress).collect());
    }

    /// Bytes in the file, header included.
    fn size(&self) -> usize {
        match &self.blocks {
            None => 8 + self.value_bytes(),
            Some(blocks) => 24 + blocks.iter().map(|block| 8 + block.len()).sum::<usize>(),
        }
    }

    fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        let mut word = |value: usize| out.write_all(&(value as u64).to_le_bytes());
        match &self.blocks {
            None => {
                word(self.value_bytes())?;
                self.ranges().into_iter().try_for_each(|range| out.write_all(&little_endian(&self.values, range)))
            }
            Some(blocks) => {
                word(blocks.len())?;
                word(BLOCK_BYTES)?;
                word(self.value_bytes() % BLOCK_BYTES)?;
                blocks.iter().try_for_each(|block| word(block.len()))?;
                blocks.iter().try_for_each(|block| out.write_all(block))
            }
        }
    }
}

/// VTK's name of a type.
fn type_name(number: NumberType) -> &'static str {
    match number {
        NumberType::I8 => "Int8",
        NumberType::U8 => "UInt8",
        NumberType::I16 => "Int16",
        NumberType::U16 => "UInt16",
        NumberType::I32 => "Int32",
        NumberType::U32 => "UInt32",
        NumberType::I64 => "Int64",
        NumberType::U64 => "UInt64",
        NumberType::F32 => "Float32",
        NumberType::F64 => "Float64",
    }
}
