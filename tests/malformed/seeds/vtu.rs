//! A writer of `.vtu` in every encoding; what cellfan itself writes is only one of them.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// How a file holds its arrays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Style {
    /// "ascii", "inline", "base64" or "raw"; the last two appended.
    pub(crate) place: &'static str,
    pub(crate) compressor: Option<&'static str>,
    /// Headers of eight bytes.
    pub(crate) wide: bool,
}

const COMPRESSORS: [Option<&str>; 4] =
    [None, Some("vtkZLibDataCompressor"), Some("vtkLZ4DataCompressor"), Some("vtkLZMADataCompressor")];

impl Style {
    pub(crate) fn all() -> Vec<Self> {
        let mut styles = vec![Self { place: "ascii", compressor: None, wide: false }];
        for place in ["inline", "base64", "raw"] {
            for compressor in COMPRESSORS {
                styles.extend([false, true].map(|wide| Self { place, compressor, wide }));
            }
        }
        styles
    }

    fn word(self, value: usize) -> Vec<u8> {
        if self.wide { (value as u64).to_le_bytes().to_vec() } else { (value as u32).to_le_bytes().to_vec() }
    }

    /// The header of an array, and its bytes.
    pub(crate) fn parts(self, bytes: &[u8], block: usize) -> (Vec<u8>, Vec<u8>) {
        let Some(compressor) = self.compressor else { return (self.word(bytes.len()), bytes.to_vec()) };
        let mut blocks: Vec<Vec<u8>> = Vec::new();
        let mut before = None;
        for block in bytes.chunks(block) {
            // Bombs repeat themselves, and LZMA takes its time.
            let same = blocks.last().filter(|_| before == Some(block)).cloned();
            blocks.push(same.unwrap_or_else(|| compress(compressor, block)));
            before = Some(block);
        }
        let sizes = [blocks.len(), block, bytes.len() % block].into_iter().chain(blocks.iter().map(Vec::len));
        (sizes.flat_map(|size| self.word(size)).collect(), blocks.concat())
    }
}

/// A tetrahedron, a hexahedron and a triangle, with an array over points and two over cells.
pub(crate) fn write(style: Style) -> Vec<u8> {
    let points = (0..9).flat_map(|i| [i & 1, i >> 1 & 1, i >> 2]).map(f64::from);
    let mut file = File { style, appended: Vec::new() };
    let f32s = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value as f32).collect::<Vec<f32>>();
    let points = file.array("Points", "Float32", 3, &f32s(&mut points.into_iter()), |v| v.to_le_bytes().to_vec());
    let corners = [0_i64, 1, 2, 8, 0, 1, 3, 2, 4, 5, 7, 6, 0, 1, 2];
    let cells = file.array("connectivity", "Int64", 1, &corners, |v| v.to_le_bytes().to_vec())
        + &file.array("offsets", "Int32", 1, &[4, 12, 15], |v: &i32| v.to_le_bytes().to_vec())
        + &file.array("types", "UInt8", 1, &[10, 12, 5], |v: &u8| vec![*v]);
    let s = file
        .array("s", "Float64", 1, &[0.5, 1.0, f64::NAN, -2.0, 3e9, 0.0, 1.0, 2.0, 4.0], |v| v.to_le_bytes().to_vec());
    let n = file.array("n &lt;m&gt;", "Int16", 1, &[-1, 2, 3], |v: &i16| v.to_le_bytes().to_vec())
        + &file.array("vtkGhostType", "UInt8", 1, &[0, 0, 1], |v: &u8| vec![*v]);
    let header = if style.wide { "UInt64" } else { "UInt32" };
    let compressor = style.compressor.map_or(String::new(), |name| format!(" compressor='{name}'"));
    let mut bytes = format!(
        "<?xml version='1.0'?>\n<VTKFile type='UnstructuredGrid' byte_order='LittleEndian' header_type='{header}'{compressor}>\n\
         <UnstructuredGrid><Piece NumberOfPoints='9' NumberOfCells='3'>\n<Points>{points}</Points>\n<Cells>{cells}</Cells>\n\
         <PointData Scalars='s'>{s}</PointData>\n<CellData>{n}</CellData></Piece></UnstructuredGrid>\n"
    )
    .into_bytes();
    if !file.appended.is_empty() {
        write!(bytes, "<AppendedData encoding='{}'>\n_", style.place).unwrap();
        bytes.append(&mut file.appended);
        bytes.extend(b"\n</AppendedData>\n");
    }
    bytes.extend(b"</VTKFile>\n");
    bytes
}

/// Nothing but points, all of them 0: `bytes` of them, in blocks of `block`.
pub(crate) fn write_zeros(style: Style, bytes: usize, block: usize) -> Vec<u8> {
    let (header, data) = style.parts(&vec![0; bytes], block);
    let header_type = if style.wide { "UInt64" } else { "UInt32" };
    let compressor = style.compressor.unwrap_or_default();
    let array = "<DataArray type='Float32' NumberOfComponents='3'";
    let (array, appended) = match style.place {
        "inline" => {
            let base64 = STANDARD.encode(&header) + &STANDARD.encode(&data);
            (format!("{array} format='binary'>{base64}</DataArray>"), Vec::new())
        }
        _ => (
            format!("{array} format='appended' offset='0'/>"),
            [&b"<AppendedData encoding='raw'>_"[..], &header, &data].concat(),
        ),
    };
    let head = format!(
        "<VTKFile type='UnstructuredGrid' header_type='{header_type}' compressor='{compressor}'><UnstructuredGrid>\
         <Piece NumberOfPoints='{}'><Points>{array}</Points></Piece></UnstructuredGrid>",
        bytes / 12
    );
    let end = if appended.is_empty() { "</VTKFile>" } else { "</AppendedData></VTKFile>" };
    [head.into_bytes(), appended, end.as_bytes().to_vec()].concat()
}

struct File {
    style: Style,
    appended: Vec<u8>,
}

impl File {
    fn array<T: ToString>(
        &mut self,
        name: &str,
        kind: &str,
        components: usize,
        values: &[T],
        bytes_of: impl Fn(&T) -> Vec<u8>,
    ) -> String {
        let head = format!("<DataArray type='{kind}' Name='{name}' NumberOfComponents='{components}'");
        if self.style.place == "ascii" {
            let text: Vec<String> = values.iter().map(ToString::to_string).collect();
            return format!("{head} format='ascii'>\n{}\n</DataArray>", text.join(" "));
        }
        let bytes: Vec<u8> = values.iter().flat_map(bytes_of).collect();
        let (header, data) = self.style.parts(&bytes, 32);
        let base64 = STANDARD.encode(&header) + &STANDARD.encode(&data);
        let offset = self.appended.len();
        match self.style.place {
            "inline" => return format!("{head} format='binary'>\n{base64}\n</DataArray>"),
            "raw" => self.appended.extend([header, data].concat()),
            _ => self.appended.extend(base64.into_bytes()),
        }
        format!("{head} format='appended' offset='{offset}'/>\n")
    }
}

fn compress(compressor: &str, block: &[u8]) -> Vec<u8> {
    match compressor {
        "vtkZLibDataCompressor" => {
            let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        }
        "vtkLZ4DataCompressor" => lz4_flex::block::compress(block),
        _ => {
            let options = lzma_rust2::XzOptions::with_preset(6);
            let mut encoder = lzma_rust2::XzWriter::new(Vec::new(), options).unwrap();
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        }
    }
}
