//! Damaged files: every truncation, seeded changes of bytes, counts and tables that lie. Nothing may panic.

use super::samples::{Style, styles};
use super::*;

type Reader = fn(&[u8]) -> Result<Mesh>;

/// Reads and, if that succeeds, assembles: what comes back does not matter, that something does.
fn survive(bytes: &[u8], read: Reader) -> bool {
    read(bytes).and_then(Mesh::into_dataset).is_ok()
}

/// One style of each place and compressor, with orders and headers in turn.
fn some_styles() -> Vec<Style> {
    styles().into_iter().enumerate().filter(|(i, _)| i % 4 == i / 4 % 4).map(|(_, style)| style).collect()
}

/// A generator of numbers: splitmix64.
fn random(state: &mut u64) -> usize {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ z >> 31) as usize
}

fn files() -> Vec<(String, Vec<u8>, Reader)> {
    let vtu: Reader = |bytes| vtu(bytes).map(Mesh::from);
    let vtk: Reader = |bytes| read_vtk(bytes, Path::new(NAME));
    let mut files: Vec<(String, Vec<u8>, Reader)> =
        some_styles().into_iter().map(|style| (format!("{style:?}"), style.write(), vtu)).collect();
    for version in ["3.0", "5.1"] {
        files.push((version.to_owned(), legacy::binary(version), vtk));
    }
    files.extend(legacy_grids::binary().map(|(name, file)| (name.to_owned(), file, vtk)));
    files.push(("vts".to_owned(), blocks::two_pieces(), |bytes| read_vts(bytes, Path::new(NAME)).map(Mesh::from)));
    files.push(("vtr".to_owned(), blocks::rectilinear(), |bytes| read_vtr(bytes, Path::new(NAME)).map(Mesh::from)));
    files.push(("vti".to_owned(), volumes::two_pieces(), |bytes| read_vti(bytes, Path::new(NAME)).map(Mesh::from)));
    for is_binary in [false, true] {
        files.push(("structured points".to_owned(), volumes::structured_points(is_binary), vtk));
    }
    files
}

#[test]
fn every_truncation_is_survived() {
    for (name, file, read) in files() {
        assert!(survive(&file, read), "{name}: the sample itself");
        for length in 0..file.len() {
            survive(&file[..length], read);
        }
        // Half a file is never a mesh.
        assert!(read(&file[..file.len() / 2]).is_err(), "{name}");
    }
}

#[test]
fn changed_bytes_are_survived() {
    let mut state = 20_260_101;
    for (_, file, read) in files() {
        for _ in 0..400 {
            let mut damaged = file.clone();
            for _ in 0..=random(&mut state) % 4 {
                let at = random(&mut state) % damaged.len();
                match random(&mut state) % 4 {
                    0 => damaged[at] ^= 1 << (random(&mut state) % 8),
                    1 => damaged[at] = random(&mut state) as u8,
                    2 => drop(damaged.remove(at)),
                    _ => damaged[at] = [b'9', b'-', b'<', b'"', 0xff, 0, b' ', b'='][random(&mut state) % 8],
                }
            }
            survive(&damaged, read);
        }
    }
}

fn ascii_style() -> Style {
    Style { place: "ascii", compressor: None, big: false, wide: false }
}

#[test]
fn counts_that_lie_are_named() {
    let file = String::from_utf8(ascii_style().write()).unwrap();
    let huge = u64::MAX.to_string();
    for (from, to, expected) in [
        ("NumberOfPoints='6'", "NumberOfPoints='7'".to_owned(), "21 are needed"),
        ("NumberOfPoints='6'", format!("NumberOfPoints='{huge}'"), "cannot be"),
        ("NumberOfPoints='6'", "NumberOfPoints='4294967296'".to_owned(), "are needed"),
        ("NumberOfPoints='6'", "NumberOfPoints='-6'".to_owned(), "no whole number"),
        ("NumberOfCells='2'", "NumberOfCells='3'".to_owned(), "3 are needed"),
        ("NumberOfCells='2'", format!("NumberOfCells='{huge}'"), "are needed"),
        ("NumberOfComponents='3'", format!("NumberOfComponents='{huge}'"), "coordinates, not 3"),
        ("type='Float64'", "type='Float128'".to_owned(), ""),
        ("type='Float32'", "type='Float128'".to_owned(), "no numeric type"),
        ("='3' format='ascii'", "='3' format='morse'".to_owned(), "morse"),
        ("='3' format='ascii'", "='3' format='appended' offset='5'".to_owned(), "the file has none"),
        ("'connectivity'", "'connections'".to_owned(), "\"connectivity\""),
        ("LittleEndian", "MiddleEndian".to_owned(), "MiddleEndian"),
        ("UInt32'", "UInt128'".to_owned(), "UInt128"),
        ("<Points>", "<Dots>".to_owned(), "not well-formed"),
        ("</VTKFile>", String::new(), "truncated"),
        ("byte_order", "compressor='vtkMagic' byte_order".to_owned(), "vtkMagic"),
    ] {
        let result = vtu(file.replacen(from, &to, 1).as_bytes());
        match result {
            Ok(_) => assert!(expected.is_empty(), "{to} was read"),
            Err(error) => assert!(!expected.is_empty() && error.to_string().contains(expected), "{to}: {error}"),
        }
    }
    let index = |bad: &str| vtu(file.replacen("0\t1\t2\t5", bad, 1).as_bytes()).unwrap_err().to_string();
    assert!(index("0\t1\t2\t6").contains("cell 0 refers to point 6"));
    assert!(index("0\t-1\t2\t5").contains("cell 0 refers to point -1"));
    let ends = |bad: &str| vtu(file.replacen("4\t9", bad, 1).as_bytes()).unwrap_err().to_string();
    assert!(ends("10\t9").contains("before it begins"));
    assert!(ends("4\t10").contains("connectivity has 9"));
    assert!(ends("-4\t9").contains("is -4"));
}

/// A raw file whose points (the first array) have this header and nothing behind it.
fn with_header(compressor: &'static str, words: &[u64]) -> Vec<u8> {
    let style = Style { place: "raw", compressor: Some(compressor), big: false, wide: true };
    let mut file = style.write();
    let start = file.windows(3).position(|window| window == b"\n _").unwrap() + 3;
    for (i, word) in words.iter().enumerate() {
        file[start + 8 * i..start + 8 * i + 8].copy_from_slice(&word.to_le_bytes());
    }
    file
}

#[test]
fn block_tables_that_lie_are_refused_before_anything_is_allocated() {
    for compressor in ["vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor"] {
        for (words, expected) in [
            (&[u64::MAX][..], "bytes where at most"),
            (&[1 << 60], "bytes where at most"),
            (&[5, 1 << 50], "cannot be"),
            (&[5, u64::MAX, 0], "beyond 64 bits"),
            (&[5, 16, 17], "beyond 64 bits"),
            (&[5, 16, 8, u64::MAX], "bytes where at most"),
            (&[5, 16, 8, 1], "compressed block"),
            (&[5, 15, 8], "compressed block"),
            (&[0, 16, 0], "0 values where 18 are needed"),
        ] {
            let error = vtu(&with_header(compressor, words)).unwrap_err().to_string();
            assert!(error.contains(expected) && error.contains("<DataArray>"), "{compressor} {words:?}: {error}");
        }
    }
}

#[test]
fn deep_and_shared_elements_are_bounded() {
    let deep = "<a>".repeat(100_000);
    assert!(vtu(deep.as_bytes()).unwrap_err().to_string().contains("nested"));
    let inside = format!("<VTKFile><DataArray>{}", "<a>".repeat(100_000));
    assert!(vtu(inside.as_bytes()).unwrap_err().to_string().contains("truncated"));

    // Many arrays over the same appended bytes: a small file must not become a large mesh.
    let file = |points: u32, arrays: usize| {
        let array = |i| format!("<DataArray type='Float32' Name='{i}' offset='0'/>");
        let mut file = format!(
            "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='{points}'><Points>
            <DataArray type='Float32' offset='{}'/></Points><PointData>{}</PointData></Piece></UnstructuredGrid>
            <AppendedData encoding='raw'>_",
            4 + 4 * points,
            (0..arrays).map(array).collect::<String>()
        )
        .into_bytes();
        for size in [4 * points, 12 * points] {
            file.extend(size.to_le_bytes());
            file.resize(file.len() + size as usize, 0);
        }
        file
    };
    assert_eq!(vtu(&file(5000, 3)).unwrap().arrays.len(), 3);
    let error = vtu(&file(5000, 500)).unwrap_err().to_string();
    assert!(error.contains("damaged"), "{error}");
}
