use glam::{DMat3, DVec3};

use super::*;
use crate::columns::Lattice;
use crate::io::{Compression, Mesh, open_mesh};

fn read(text: &str) -> Result<Volume> {
    read_nrrd(text.as_bytes(), Path::new("a.nrrd"))
}

fn problem(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

fn values(volume: &Volume, array: usize) -> Vec<f64> {
    let values = &volume.arrays[array].values;
    (0..values.len()).map(|i| values.get(i)).collect()
}

const HEAD: &str = "NRRD0004\n# a comment\r\ntype: short\nencoding: ascii\nkey:=value: more\n";

/// `HEAD`, more fields, and `count` numbers from 0.
fn counted(fields: &str, count: usize) -> String {
    let numbers: Vec<String> = (0..count).map(|number| number.to_string()).collect();
    format!("{HEAD}{fields}\n\n{}\n", numbers.join(" "))
}

#[test]
fn axes_without_directions_have_spacings_and_borders() {
    let of = |fields: &str| read(&counted(&format!("dimension: 3\nsizes: 3 2 2\n{fields}"), 12)).unwrap();
    let plain = of("content: none");
    assert_eq!((plain.dims, plain.lattice, plain.arrays[0].values.type_name()), ([3, 2, 2], Lattice::default(), "i16"));
    assert_eq!(values(&plain, 0), (0..12).map(f64::from).collect::<Vec<_>>());
    let spaced = of("spacings: 0.5 2 1e1\naxis mins: 7 8 9");
    assert_eq!(spaced.lattice, Lattice::new(DVec3::new(7.0, 8.0, 9.0), DVec3::new(0.5, 2.0, 10.0)));
    assert_eq!(of("axis mins: nan 0 nan\naxis maxs: 3 nan 1").lattice, Lattice::default(), "unknown");
    // The middle of the first of two cells from 8 to 12 is at 9; samples from 8 to 12 are 4 apart.
    let borders = of("axis mins: 0 8 8\naxis maxs: 3 12 12\ncenters: node cell node");
    assert_eq!(borders.lattice, Lattice::new(DVec3::new(0.0, 9.0, 8.0), DVec3::new(1.5, 2.0, 4.0)));
}

#[test]
fn directions_may_be_slanted_and_other_axes_make_tuples_and_arrays() {
    let fields = "dimension: 4\nsizes: 2 3 2 2\nspace: left-posterior-superior\n\
                  space directions: none (1,0,0) (0.5, 2,0) (0,0,-3)\nspace origin: (4,5,6)";
    let volume = read(&counted(fields, 24)).unwrap();
    let steps = DMat3::from_cols(DVec3::X, DVec3::new(0.5, 2.0, 0.0), DVec3::new(0.0, 0.0, -3.0));
    assert_eq!((volume.dims, volume.lattice), ([3, 2, 2], Lattice::sheared(DVec3::new(4.0, 5.0, 6.0), steps)));
    assert_eq!((volume.arrays[0].components, volume.arrays[0].tuples()), (2, 12));
    let colors = read(&counted("dimension: 4\nsizes: 3 2 2 2\nkinds: RGB-color domain domain space", 24)).unwrap();
    assert_eq!((colors.dims, colors.arrays[0].components), ([2, 2, 2], 3));
    let flat = read(&counted("dimension: 2\nsizes: 3 4", 12)).unwrap();
    assert_eq!((flat.dims, flat.has_volume()), ([3, 4, 1], false));
    for (fields, what) in [
        ("dimension: 4\nsizes: 2 2 2 2", "4 axes of space"),
        ("dimension: 3\nsizes: 2 2 2\nkinds: space vector space", "between"),
        ("dimension: 1\nsizes: 2\nkinds: list", "without an axis"),
    ] {
        assert!(problem(&counted(fields, 16)).contains(what), "{fields}");
    }
}

#[test]
fn axes_behind_those_of_space_are_arrays_of_a_raw_file() {
    let head = "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 2 2 2 3\nkinds: space space space list\nencoding: raw\n\n";
    let bytes = [head.as_bytes(), &(0..24).collect::<Vec<u8>>()].concat();
    let volume = read_nrrd(&bytes, Path::new("a")).unwrap();
    assert_eq!(
        volume.arrays.iter().map(|array| array.name.as_str()).collect::<Vec<_>>(),
        ["value 0", "value 1", "value 2"]
    );
    assert_eq!(values(&volume, 2)[..2], [16.0, 17.0]);
    assert!(read_nrrd(&bytes[..bytes.len() - 1], Path::new("a")).unwrap_err().to_string().contains("truncated"));
}

#[test]
fn every_type_in_every_encoding_and_order_is_read_bit_for_bit() {
    use std::io::Write;
    let types = [
        ("signed char", 1),
        ("unsigned char", 1),
        ("signed short int", 2),
        ("uint16_t", 2),
        ("signed int", 4),
        ("uint", 4),
        ("long long int", 8),
        ("unsigned long long", 8),
        ("float", 4),
        ("double", 8),
    ];
    for (name, size) in types {
        let little: Vec<u8> = (0..8 * size).map(|i| (i * 37 + 11) as u8 & 0x3f).collect();
        let big: Vec<u8> = little.chunks(size).flat_map(|value| value.iter().rev().copied()).collect();
        let gzip = |bytes: &[u8]| {
            let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        };
        let behind = |fields: &str, bytes: &[u8]| {
            let head = format!("NRRD0001\ntype: {name}\ndimension: 3\nsizes: 2 2 2\n{fields}\n\n");
            let volume = read_nrrd(&[head.as_bytes(), bytes].concat(), Path::new("a")).unwrap();
            values(&volume, 0).into_iter().map(f64::to_bits).collect::<Vec<_>>()
        };
        let expected = behind("encoding: raw\nendian: little", &little);
        let text: Vec<String> = expected.iter().map(|&bits| f64::from_bits(bits).to_string()).collect();
        let text = text.join(", ");
        assert_eq!(behind("encoding: raw\nendian: big", &big), expected, "{name}");
        assert_eq!(behind("encoding: gz\nendian: big", &gzip(&big)), expected, "{name}");
        assert_eq!(
            behind("encoding: gzip\nendian: little\nbyte skip: 2", &gzip(&[b"ab", &little[..]].concat())),
            expected
        );
        assert_eq!(
            behind("encoding: raw\nendian: little\nline skip: 2\nbyteskip: 1", &[b"a\nb\n.", &little[..]].concat()),
            expected
        );
        assert_eq!(behind("encoding: raw\nendian: little\nbyte skip: -1", &[b"any", &little[..]].concat()), expected);
        if size < 8 || name == "double" {
            assert_eq!(behind("encoding: text", text.as_bytes()), expected, "{name}");
        }
    }
}

#[test]
fn samples_are_used_in_place_where_they_are_aligned_and_changes_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let samples: Vec<u8> = (0..24_i16).flat_map(i16::to_le_bytes).collect();
    std::fs::write(path("a.raw"), [b"123".as_slice(), &samples].concat()).unwrap();
    let open = |skip: usize, endian: &str| {
        let head = format!(
            "NRRD0004\ntype: int16\ndimension: 3\nsizes: 2 3 3\nencoding: raw\nendian: {endian}\nbyte skip: {skip}\n"
        );
        std::fs::write(path("a.nhdr"), head + "data file: ./a.raw\n").unwrap();
        match open_mesh(&path("a.nhdr")).unwrap() {
            Mesh::Volume(volume) => volume,
            _ => panic!("no volume"),
        }
    };
    let (aligned, unaligned, turned) = (open(4, "little"), open(3, "little"), open(4, "big"));
    assert_eq!((aligned.owned_bytes(), unaligned.owned_bytes(), turned.owned_bytes()), (0, 36, 36));
    assert_eq!((values(&unaligned, 0)[17], values(&aligned, 0)[0], values(&turned, 0)[0]), (17.0, 256.0, 1.0));
    assert!(unaligned.backing.is_none());
    aligned.backing.as_ref().unwrap().check().unwrap();
    std::fs::write(path("a.raw"), [b"1234".as_slice(), &samples, b"5"].concat()).unwrap();
    assert!(matches!(aligned.backing.unwrap().check(), Err(crate::Error::Changed { .. })));
    // Nothing is mapped where that is not wanted.
    let whole = crate::io::open_mesh_in(&path("a.nhdr"), &Scratch::unmapped()).unwrap();
    assert!(matches!(whole, Mesh::Volume(volume) if volume.owned_bytes() == 36 && volume.backing.is_none()));
}

#[test]
fn what_is_written_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nrrd");
    let array = |name: &str, association, components, values: NumericColumn| Array {
        name: name.into(),
        association,
        components,
        values,
    };
    let steps = DMat3::from_cols(DVec3::new(0.1, 0.0, 0.0), DVec3::new(1e-7, 0.3, 0.0), DVec3::new(0.0, -1e9, 2.5));
    let arrays = vec![
        array("scalars", Association::Point, 1, (0..30_u16).collect::<Vec<_>>().into()),
        array("vectors", Association::Point, 2, (0..60).map(|i| f64::from(i) * 0.1).collect::<Vec<_>>().into()),
        array("cells", Association::Cell, 1, vec![1_i64, -2, 3, 4, 5, 6, 7, 8].into()),
    ];
    let volume = Volume::new([5, 3, 2], Lattice::sheared(DVec3::new(0.3, -4.0, 1e20), steps), arrays).unwrap();
    for compression in [Compression::None, Compression::Zlib] {
        for array in &volume.arrays {
            write_nrrd(&path, &volume, &array.name, compression).unwrap();
            let Mesh::Volume(read) = open_mesh(&path).unwrap() else { panic!("no volume") };
            let is_cell = array.association == Association::Cell;
            let (dims, first) =
                if is_cell { (volume.cell_dims(), DVec3::splat(0.5)) } else { (volume.dims, DVec3::ZERO) };
            assert_eq!((read.dims, read.lattice), (dims, volume.lattice.from_point(first)), "{}", array.name);
            assert_eq!(read.arrays[0].values.type_name(), array.values.type_name());
            assert!(
                (0..array.values.len())
                    .all(|i| read.arrays[0].values.get(i).to_bits() == array.values.get(i).to_bits())
            );
            assert_eq!(read.owned_bytes() == 0, compression == Compression::None, "{}", array.name);
        }
    }
    assert!(matches!(write_nrrd(&path, &volume, "none", Compression::None), Err(crate::Error::UnknownArray { .. })));
}

#[test]
fn damaged_headers_say_where_and_what() {
    let three = "dimension: 3\nsizes: 2 2 2";
    let cases: &[(String, &str)] = &[
        ("NRRD0009\n".into(), "version"),
        ("NRRDabcd\n".into(), "line 1"),
        ("NRRD0004\n".into(), "\"dimension\""),
        (format!("{HEAD}nonsense"), "line 6"),
        (format!("{HEAD}type: short"), "twice"),
        (counted("dimension: 17\nsizes: 2", 8), "between 1 and 16"),
        (counted("dimension: 3\nsizes: 2 2", 8), "2 entries"),
        (counted("dimension: 3\nsizes: 2 0 2", 8), "no sample"),
        (counted("dimension: 3\nsizes: 2 -1 2", 8), "whole numbers"),
        (counted("dimension: 3\nsizes: 4294967296 4294967296 4294967296", 8), "cannot be"),
        (counted("dimension: 3\nsizes: 1000000 1000000 1000000", 8), "truncated"),
        (counted(three, 7), "truncated"),
        (counted(&format!("{three}\nspacings: 1 nan 1"), 8), "not finite"),
        (counted(&format!("{three}\nspacings: 1 0 1"), 8), "one plane"),
        (counted(&format!("{three}\nspace directions: (1,0,0) (0,1,0) (1,1,0)"), 8), "one plane"),
        (counted(&format!("{three}\nspace directions: (1,0,0) (0,1,0) (1,1,0"), 8), "vectors"),
        (counted(&format!("{three}\nspace directions: (1,0,0) (0,1,0) (1,1,0,4)"), 8), "no vector of space"),
        (counted(&format!("{three}\nspace origin: 1 2 3"), 8), "no vector of space"),
        (counted(&format!("{three}\nbyte skip: -1"), 8), "raw samples only"),
        (counted(&format!("{three}\nline skip: 99"), 8), "line skip"),
        (counted(&format!("{three}\ndatafile: LIST"), 8), "several files"),
        (counted(&format!("{three}\ndata file: ../gone/away.raw"), 8), "gone/away.raw"),
        (counted(&format!("{three}\ndata file: /dev/zero"), 8), "no file"),
        (counted(three, 8).replace("ascii", "hex"), "encoding hex"),
        (counted(three, 8).replace("ascii", "bzip2"), "encoding bzip2"),
        (counted(three, 8).replace("ascii", "fancy"), "no encoding"),
        (counted(three, 8).replace("ascii", "gzip"), "endian"),
        (counted(&format!("{three}\nendian: big"), 8).replace("ascii", "gzip"), "damaged"),
        (counted(three, 8).replace("short", "block"), "blocks"),
        (counted(three, 8).replace("short", "half"), "no type"),
        (counted(three, 8).replace(" 3 ", " x "), "sample 3"),
    ];
    for (text, what) in cases {
        let found = problem(text);
        assert!(found.contains(what), "{text:?}: {found}");
    }
}
