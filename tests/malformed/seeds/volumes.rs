//! Regular grids.

use std::io::Write;
use std::path::Path;

use super::{Seeds, pieces, shared};

pub(crate) const NRRD_WORDS: &[&str] = &[
    "NRRD0005\n",
    "type: ",
    "uint8",
    "long long int",
    "double",
    "block",
    "dimension: 16",
    "sizes: 18446744073709551615 1 1\n",
    "sizes: 0 1 1\n",
    "spacings: nan 0 1e308\n",
    "axis mins: ",
    "axis maxs: inf -inf 0\n",
    "centers: cell node ???\n",
    "kinds: RGB-color list vector\n",
    "space directions: none (1,0,0) (0,1",
    "(1e308,1e308,1e308)",
    "space origin: (",
    "encoding: gzip\n",
    "encoding: ascii\n",
    "endian: big\n",
    "byte skip: -1\n",
    "byte skip: 18446744073709551615\n",
    "line skip: 7\n",
    "data file: a.raw\n",
    "datafile: ../../../../dev/zero\n",
    "data file: self.nhdr\n",
    "data file: LIST\n",
    "key:=value\n",
    "# \n",
    "\n\n",
];

pub(crate) const RAW_WORDS: &[&str] = &[
    "u8",
    "i16",
    "f64",
    "be",
    "le",
    "@",
    "x",
    "x0x",
    "18446744073709551615",
    "4294967296x",
    "@18446744073709551615",
    "\n",
];

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

pub(crate) fn vti() -> Seeds {
    let numbers = |count: usize| (0..count).map(|i| format!("{} ", i * 7 % 256)).collect::<Vec<_>>().concat();
    let piece = |first: usize| {
        format!(
            "<Piece Extent='{first} {} 0 2 0 2'><PointData><DataArray type='UInt8' Name='p' format='ascii'>{}</DataArray></PointData>\
             <CellData><DataArray type='Float32' Name='c' NumberOfComponents='3' format='ascii'>{}</DataArray></CellData></Piece>\n",
            first + 2,
            numbers(27),
            numbers(3 * 8)
        )
    };
    let file = |attributes: &str, pieces: &str| {
        format!(
            "<?xml version='1.0'?>\n<VTKFile type='ImageData' byte_order='LittleEndian'>\n<ImageData WholeExtent='0 9 0 2 0 2' \
             {attributes}>\n{pieces}</ImageData></VTKFile>\n"
        )
        .into_bytes()
    };
    let sheared = "Origin='1 -2 3e5' Spacing='0.5 1 2' Direction='1 0.5 0 0 1 0 0 0 -1'";
    let mut seeds = vec![file("", &piece(0)), file(sheared, &(piece(0) + &piece(2) + &piece(3)))];
    seeds.extend(shared(&["vti"], 60_000));
    seeds
}

pub(crate) fn nrrd() -> Seeds {
    let folder = pieces();
    std::fs::write(folder.join("a.raw"), [7; 48]).unwrap();
    let file = |fields: &str, samples: &[u8]| [format!("NRRD0004\n{fields}\n").as_bytes(), samples].concat();
    let detached = "type: float\ndimension: 3\nsizes: 2 2 3\nencoding: raw\nendian: little\ndata file: a.raw\n";
    std::fs::write(folder.join("self.nhdr"), detached.replace("a.raw", "self.nhdr")).unwrap();
    let plain = "# made\ntype: unsigned short\ndimension: 3\nsizes: 3 2 2\nspacings: 1 0.5 2\naxis mins: 0 nan 1\ncenters: cell node cell\n\
                 encoding: raw\nendian: big\nname:=any\n";
    let slanted = "type: int8\ndimension: 4\nsizes: 2 2 2 2\nspace: left-posterior-superior\nspace directions: none (1,0,0) (0.5,1,0) (0,0,2)\n\
                   space origin: (1,2,3)\nkinds: vector space space space\nencoding: gzip\nbyte skip: 3\n";
    let text = "type: double\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\nline skip: 1\n";
    let list =
        "type: uchar\ndimension: 4\nsizes: 2 2 2 3\nkinds: space space space list\nencoding: raw\nbyte skip: -1\n";
    let mut seeds = vec![
        file(plain, &[5; 24]),
        file(slanted, &gzip(&[9; 19])),
        file(text, b"a line\n1 2 3e5, nan 5 -6 7 8\n"),
        file(list, &[1; 30]),
        file(detached, b""),
    ];
    seeds.extend(shared(&["nrrd"], 60_000));
    seeds
}

/// A layout on the first line, samples behind it.
pub(crate) fn raw() -> Seeds {
    let mut seeds = vec![
        [b"3x2x2:i16be@4\n".as_slice(), &[3; 28]].concat(),
        [b"2x2x2:f64\n".as_slice(), &[0x40; 64]].concat(),
        [b"8x4x4:u8@2\n".as_slice(), &gzip(&[6; 130])].concat(),
    ];
    seeds.extend(shared(&["raw"], 40_000).into_iter().map(|file| [b"32x32x32:u8\n".as_slice(), &file].concat()));
    seeds
}

/// Legacy structured points.
pub(super) fn legacy() -> Vec<u8> {
    let numbers = (0..27).map(|i| format!("{i} ")).collect::<Vec<_>>().concat();
    format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 3\nSPACING 1 0.5 2\nORIGIN 0 -1 1e5\n\
         POINT_DATA 27\nSCALARS p unsigned_char 1\nLOOKUP_TABLE default\n{numbers}\n"
    )
    .into_bytes()
}

/// As the readers take it: the header's folder holds `a.raw`.
pub(crate) fn nrrd_path() -> std::path::PathBuf {
    pieces().join(Path::new("a.nhdr"))
}
