//! A small mesh, and writers of it in every encoding, independent of the room's own.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::*;

/// A tetrahedron and a pyramid with a point vector and a cell scalar.
pub(super) fn mesh() -> UnstructuredMesh {
    let point = |i: u8| [f32::from(i), f32::from(i * i), f32::from(i % 3) - 0.5];
    let array =
        |name: &str, association, components, values| Array { name: name.to_owned(), association, components, values };
    UnstructuredMesh {
        points: Points::F32((0..6).map(point).collect()),
        types: vec![10, 14].into(),
        offsets: vec![0, 4, 9].into(),
        connectivity: vec![0, 1, 2, 5, 1, 2, 3, 4, 5].into(),
        arrays: vec![
            array(
                "a \"wind\" <m/s>",
                Association::Point,
                3,
                (0..18).map(|i| f64::from(i) / 7.0).collect::<Vec<_>>().into(),
            ),
            array("id", Association::Cell, 1, vec![-3_i16, 300].into()),
        ],
        ..UnstructuredMesh::empty()
    }
}

/// How a sample is encoded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Style {
    pub(super) place: &'static str,
    pub(super) compressor: Option<&'static str>,
    pub(super) big: bool,
    pub(super) wide: bool,
}

/// All styles that there are.
pub(super) fn styles() -> Vec<Style> {
    let mut styles = Vec::new();
    for place in ["ascii", "inline", "base64", "raw"] {
        for compressor in
            [None, Some("vtkZLibDataCompressor"), Some("vtkLZ4DataCompressor"), Some("vtkLZMADataCompressor")]
        {
            for (big, wide) in [(false, false), (false, true), (true, false), (true, true)] {
                styles.push(Style { place, compressor, big, wide });
            }
        }
    }
    styles
}

impl Style {
    fn word(self, value: usize) -> Vec<u8> {
        match (self.wide, self.big) {
            (true, true) => (value as u64).to_be_bytes().to_vec(),
            (true, false) => (value as u64).to_le_bytes().to_vec(),
            (false, true) => (value as u32).to_be_bytes().to_vec(),
            (false, false) => (value as u32).to_le_bytes().to_vec(),
        }
    }

    /// Header and data, which base64 encodes one by one.
    fn parts(self, bytes: &[u8]) -> (Vec<u8>, Vec<u8>) {
        const BLOCK: usize = 16;
        let Some(compressor) = self.compressor else {
            return (self.word(bytes.len()), bytes.to_vec());
        };
        let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(|block| compress(compressor, block)).collect();
        let sizes = [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(blocks.iter().map(Vec::len));
        (sizes.flat_map(|size| self.word(size)).collect(), blocks.concat())
    }

    /// The sample mesh as a `.vtu` file.
    pub(super) fn write(self) -> Vec<u8> {
        let mesh = mesh();
        let mut appended = Vec::new();
        let mut array = |name: &str, components: usize, column: &NumericColumn| {
            let vtk_type = match column {
                NumericColumn::F32(_) => "Float32",
                NumericColumn::F64(_) => "Float64",
                NumericColumn::I16(_) => "Int16",
                NumericColumn::U8(_) => "UInt8",
                _ => "Int64",
            };
            let size = numbers::type_of(column).size();
            let mut bytes = numbers::little_endian(column, 0..column.len());
            if self.big {
                bytes.chunks_mut(size).for_each(<[u8]>::reverse);
            }
            let (header, data) = self.parts(&bytes);
            let head = format!(
                "<DataArray type='{vtk_type}'\n Name = '{}' NumberOfComponents='{components}'",
                quick_xml::escape::escape(name)
            );
            let base64 = || STANDARD.encode(&header) + &STANDARD.encode(&data);
            match self.place {
                "ascii" => {
                    let text: Vec<String> = values(column).iter().map(ToString::to_string).collect();
                    format!("{head} format='ascii'>\n {}\n</DataArray>", text.join("\t"))
                }
                "inline" => format!(
                    "{head} format='binary'>\n  {}\n<InformationKey><Value>5</Value></InformationKey></DataArray>",
                    base64()
                ),
                place => {
                    let offset = appended.len();
                    if place == "raw" {
                        appended.extend([header, data].concat());
                    } else {
                        appended.extend(base64().into_bytes());
                    }
                    format!("{head} format='appended' offset='{offset}'/>")
                }
            }
        };
        let Points::F32(points) = &mesh.points else { unreachable!("the sample is in single precision") };
        let points = array("", 3, &points.as_flattened().to_vec().into());
        let connectivity: Vec<i64> = mesh.connectivity.iter().map(|&point| point.into()).collect();
        let ends: Vec<i64> = mesh.offsets[1..].iter().map(|&end| end as i64).collect();
        let cells = array("connectivity", 1, &connectivity.into())
            + &array("offsets", 1, &ends.into())
            + &array("types", 1, &mesh.types.clone().into());
        let [wind, id] = [0, 1].map(|i| array(&mesh.arrays[i].name, mesh.arrays[i].components, &mesh.arrays[i].values));
        let order = if self.big { "BigEndian" } else { "LittleEndian" };
        let header = if self.wide { "UInt64" } else { "UInt32" };
        let compressor = self.compressor.map_or(String::new(), |name| format!(" compressor='{name}'"));
        let mut file = format!(
            "<?xml version='1.0'?>\n<VTKFile type='UnstructuredGrid' byte_order='{order}' header_type='{header}'{compressor}>\
             <!-- a comment --><UnstructuredGrid><FieldData><Array type='String' Name='s' format='ascii'>1 2</Array></FieldData>\
             <Piece NumberOfPoints='6' NumberOfCells='2'><Points>{points}</Points><Cells>{cells}</Cells>\
             <PointData>{wind}<DataArray type='String' Name='text' format='ascii'>65 0</DataArray></PointData>\
             <CellData>{id}</CellData></Piece></UnstructuredGrid>"
        )
        .into_bytes();
        if !appended.is_empty() {
            write!(file, "<AppendedData encoding='{}'>\n _", self.place).unwrap();
            file.extend(appended);
            file.extend(b"\n</AppendedData>");
        }
        file.extend(b"</VTKFile>\n");
        file
    }
}

fn compress(compressor: &str, block: &[u8]) -> Vec<u8> {
    match compressor {
        "vtkZLibDataCompressor" => {
            let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        }
        "vtkLZ4DataCompressor" => lz4_flex::block::compress(block),
        _ => {
            let options = lzma_rust2::XzOptions::with_preset(1);
            let mut encoder = lzma_rust2::XzWriter::new(Vec::new(), options).unwrap();
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        }
    }
}
