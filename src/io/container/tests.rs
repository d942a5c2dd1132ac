mod adjacency;
mod octree;
mod polyhedra;
mod whole;

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::directory::{Directory, Header, Span};
use super::*;
use crate::columns::{
    Array, Association, BlockIds, CellCounts, CellSource, Component, FieldSelection, NumericColumn, Points,
    StructuredCells, TetMesh,
};
use crate::generate::{Kind, Scheme, Settings, generate, source};
use crate::{Dataset, Error};

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes `source` with `memory_bytes` and opens it.
    fn container(&self, source: &dyn CellSource, memory_bytes: u64) -> Dataset {
        let path = self.path("mesh.cells");
        write(source, &path, &WriteOptions { memory_bytes, ..WriteOptions::default() }, &|_, _, _| {}).unwrap();
        open(&path, true).unwrap()
    }

    /// Writes structured blocks and opens them.
    fn structured(&self, cells: StructuredCells) -> Dataset {
        let path = self.path("mesh.cells");
        write_structured(cells, &path, &|_, _, _| {}).unwrap();
        open(&path, true).unwrap()
    }
}

/// Both hold the same mesh in the same order, to the bit; arrays may stand in different orders.
fn assert_same(container: &Dataset, expected: &Dataset) {
    assert_eq!(container.origin, expected.origin);
    assert_eq!(container.bounds, expected.bounds);
    assert_eq!(container.counts, expected.counts);
    assert!(container.positions[..] == expected.positions[..]);
    assert!(container.tets.iter().eq(expected.tets.iter()));
    let (a, b) = (container.hexahedra.view(), expected.hexahedra.view());
    assert_eq!((a.len(), container.hexahedra.absent()), (b.len(), expected.hexahedra.absent()));
    assert!((0..a.len()).all(|cell| (a.get(cell), a.shape(cell)) == (b.get(cell), b.shape(cell))));
    let (a, b) = (container.polyhedra.view(), expected.polyhedra.view());
    assert_eq!((a.len(), container.polyhedra.most()), (b.len(), expected.polyhedra.most()));
    assert!((0..a.len()).all(|cell| a.corners(cell) == b.corners(cell) && a.faces(cell).eq(b.faces(cell))));
    let bits = |dataset: &Dataset| (0..dataset.tets.len()).map(|i| dataset.positive.get(i)).collect::<Vec<_>>();
    assert!(bits(container) == bits(expected));
    let blocks = |dataset: &Dataset| dataset.blocks.iter().map(|b| (b.cells.clone(), b.bounds)).collect::<Vec<_>>();
    assert_eq!(blocks(container), blocks(expected));
    for array in &expected.arrays {
        let components = (0..array.components).map(Component::Index);
        for component in components.chain([Component::Magnitude]) {
            let (name, association) = (array.name.clone(), Some(array.association));
            let selection = FieldSelection { name, association, component };
            let (a, b) = (container.field(&selection), expected.field(&selection));
            let (Ok(a), Ok(b)) = (&a, &b) else {
                assert_eq!(a.unwrap_err().to_string(), b.unwrap_err().to_string());
                continue;
            };
            assert_eq!(
                (&a.name, a.range, a.offset, a.invalid),
                (&b.name, b.range, b.offset, b.invalid),
                "{selection:?}"
            );
            assert_eq!(a.block_ranges, b.block_ranges, "{selection:?}");
            let same = a.values.iter().zip(&b.values[..]).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same && a.values.len() == b.values.len(), "{selection:?}");
        }
    }
}

fn settings(cells: u64) -> Settings {
    Settings { cells, ..Settings::default() }
}

#[test]
fn a_container_is_what_the_mesh_becomes_in_memory() {
    let folder = Folder::new();
    for kind in [Kind::Tets, Kind::Delaunay, Kind::Orbital] {
        let mesh = generate(kind, &settings(30_000)).unwrap();
        let expected = Dataset::from_tets(mesh.clone()).unwrap();
        assert_same(&folder.container(&mesh, 1 << 30), &expected);
        let streamed = source(kind, &settings(30_000)).unwrap();
        assert_same(&folder.container(streamed.as_ref(), 1 << 30), &expected);
        assert!(check(&folder.path("mesh.cells"), true).is_ok());
    }
    let five = Settings { scheme: Scheme::Five, jitter: 0.35, ..settings(20_000) };
    let expected = Dataset::from_tets(generate(Kind::Buckyball, &five).unwrap()).unwrap();
    assert_same(&folder.container(source(Kind::Buckyball, &five).unwrap().as_ref(), 0), &expected);
}

/// Three cells of six points far from the origin, one inverted, one flat, one point unused; arrays of many types.
fn odd_mesh() -> TetMesh {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [9.0; 3], [1.0; 3]];
    let array = |name: &str, association, components, values: NumericColumn| Array {
        name: name.to_owned(),
        association,
        components,
        values,
    };
    TetMesh {
        points: Points::F64(points.map(|p| p.map(|x| x + 1e6)).to_vec()),
        tets: vec![[0, 1, 2, 3], [1, 2, 3, 5], [0, 1, 2, 1]].into(),
        file_from_tet: vec![0, 2, 3].into(),
        arrays: vec![
            array("u8", Association::Point, 1, vec![1_u8, 2, 3, 4, 5, 255].into()),
            array("i64", Association::Cell, 1, vec![-1_i64 << 60, 0, 1 << 60, 5].into()),
            array("v", Association::Point, 3, (0..18).map(|i| f32::from(i as u8)).collect::<Vec<_>>().into()),
            array("hole", Association::Point, 1, vec![0.5, f64::NAN, 1e300, 2.0, 3.0, f64::INFINITY].into()),
            array("cell_hole", Association::Cell, 2, vec![f32::NAN, 0.0, 9.0, 9.0, 1.0, 2.0, 3.0, 4.0].into()),
            array("none", Association::Cell, 1, vec![f32::NAN; 4].into()),
            array("constant", Association::Point, 1, vec![1e9 + 0.25; 6].into()),
        ],
        counts: CellCounts { in_file: 4, lower_dimensional: 1, ..CellCounts::default() },
    }
}

#[test]
fn arrays_of_any_type_and_odd_cells_come_back() {
    let folder = Folder::new();
    let expected = Dataset::from_tets(odd_mesh()).unwrap();
    assert_eq!((expected.counts.degenerate, expected.tets.len()), (1, 2));
    let dataset = folder.container(&odd_mesh(), 1 << 30);
    assert_same(&dataset, &expected);
    assert_same(&open(&folder.path("mesh.cells"), false).unwrap(), &expected);
    assert_eq!(check(&folder.path("mesh.cells"), false).unwrap().columns, 5 + 7 + 12);
}

#[test]
fn blocks_with_far_vertices_keep_wide_numbers() {
    // 70,001 cells at one corner that share their first vertex: numbers more than 16 bits apart.
    let around = 70_000_u32;
    let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(around);
    let mut points = vec![[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
    points.extend((0..around).map(|i| [angle(i).cos(), angle(i).sin(), 0.0]));
    let mesh = TetMesh {
        points: Points::F64(points),
        tets: (0..around).map(|i| [0, 1, 2 + i, 2 + (i + 1) % around]).collect(),
        file_from_tet: (0..around).collect(),
        arrays: vec![],
        counts: CellCounts { in_file: around.into(), ..CellCounts::default() },
    };
    let folder = Folder::new();
    let path = folder.path("wheel.cells");
    let written = write(&mesh, &path, &WriteOptions::default(), &|_, _, _| {}).unwrap();
    let (narrow, blocks) = written.narrow_blocks;
    assert!(0 < narrow && narrow < blocks, "{narrow} of {blocks}");
    assert_same(&open(&path, true).unwrap(), &Dataset::from_tets(mesh).unwrap());
    check(&path, true).unwrap();
}

#[test]
fn what_cannot_be_drawn_leaves_no_file() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    let refused = |mesh: TetMesh| write(&mesh, &path, &WriteOptions::default(), &|_, _, _| {}).unwrap_err().to_string();
    for (change, part) in [
        ((|mesh| mesh.tets.to_mut()[1][2] = 6) as fn(&mut TetMesh), "cell 2 refers to point 6"),
        (|mesh| mesh.counts.in_file = 3, "has 4 entries where 3 are needed"),
        (|mesh| mesh.file_from_tet.to_mut().truncate(2), "file_from_tet: has 2"),
        (|mesh| (mesh.tets, mesh.file_from_tet) = (vec![].into(), vec![].into()), "no cell with a volume"),
        (|mesh| mesh.points = Points::F32(vec![[f32::NAN; 3]; 6]), "not finite"),
        (|mesh| mesh.tets = vec![[0, 0, 1, 2]; 3].into(), "flat"),
    ] {
        let mut mesh = odd_mesh();
        change(&mut mesh);
        let error = refused(mesh);
        assert!(error.contains(part), "{error}");
    }
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 0);
}

/// Bytes of a container, and its directory to be changed.
fn bytes_and_directory(path: &Path) -> (Vec<u8>, Directory) {
    let bytes = fs::read(path).unwrap();
    let directory = Directory::read(&bytes, path).unwrap();
    (bytes, directory)
}

/// The container with another directory, which it vouches for.
fn with_directory(path: &Path, bytes: &[u8], text: &[u8]) {
    let offset = u64::from_le_bytes(bytes[24..32].try_into().unwrap());
    let mut file = bytes[..offset as usize].to_vec();
    file.extend_from_slice(text);
    let header = Header {
        version: u32::from_le_bytes(bytes[8..12].try_into().unwrap()),
        file_bytes: file.len() as u64,
        directory_offset: offset,
        directory_bytes: text.len() as u64,
        directory_checksum: twox_hash::XxHash3_64::oneshot(text),
    };
    file[..64].copy_from_slice(&header.to_bytes());
    fs::write(path, file).unwrap();
}

fn small_container(folder: &Folder) -> PathBuf {
    let mesh = generate(Kind::Tets, &settings(5000)).unwrap();
    let path = folder.path("mesh.cells");
    write(&mesh, &path, &WriteOptions::default(), &|_, _, _| {}).unwrap();
    path
}

#[test]
fn directories_that_lie_are_refused_with_the_column() {
    let folder = Folder::new();
    let path = small_container(&folder);
    let (bytes, directory) = bytes_and_directory(&path);
    for (lie, part) in [
        ((|d| d.positions.offset += 8) as fn(&mut Directory), "column positions: it begins at byte"),
        (|d| d.positions.offset = 1 << 62, "column positions: it lies outside"),
        (|d| d.orientation.bytes = u64::MAX, "column orientation: "),
        (|d| d.tetrahedra.bytes = 1 << 40, "column tetrahedra: it lies outside"),
        (|d| d.tetrahedra.bytes -= 64, "column tetrahedra"),
        (|d| d.block_bounds = d.block_ids, "block_bounds"),
        (|d| d.arrays[0].values.offset = d.positions.offset, "overlaps"),
        (|d| d.arrays[0].components = 0, "components"),
        (|d| d.arrays[0].components = u64::MAX, "components"),
        (|d| d.arrays[0].number_type = "f16".to_owned(), "unknown type"),
        (|d| d.arrays[0].ranges[0].range = Some([1.0, 0.0]), "range"),
        (|d| d.arrays[0].association = Association::Cell, "bytes where"),
        (|d| d.cells = 0, "0 cells"),
        (|d| d.cells = u64::MAX, "cells of"),
        (|d| d.cells *= 2, "bytes where"),
        (|d| d.vertices = 1 << 33, "vertices"),
        (|d| d.cells_per_block = 0, "blocks of 0"),
        (|d| d.counts.ghost = u64::MAX, "counts"),
        (|d| d.cell_kind = "hexahedron".to_owned(), "hexahedron"),
    ] {
        let mut changed = directory.clone();
        lie(&mut changed);
        with_directory(&path, &bytes, &serde_json::to_vec(&changed).unwrap());
        let error = open(&path, true).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }), "{error:?}");
        assert!(error.to_string().contains(part), "{error} says nothing of {part:?}");
    }
    let deep = [vec![b'['; 1 << 20], vec![b']'; 1 << 20]].concat();
    for text in [&b"{}"[..], b"", b"null", &deep] {
        with_directory(&path, &bytes, text);
        assert!(matches!(open(&path, true), Err(Error::Malformed { .. })));
    }
}

#[test]
fn truncated_and_flipped_files_are_refused_or_drawn_but_never_a_panic() {
    let folder = Folder::new();
    let path = small_container(&folder);
    let bytes = fs::read(&path).unwrap();
    for len in [0, 7, 8, 63, 64, 65, bytes.len() / 2, bytes.len() - 1] {
        fs::write(&path, &bytes[..len]).unwrap();
        let error = open(&path, len % 2 == 0).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. } | Error::Io { .. }), "{len}: {error:?}");
    }
    let mut unnoticed = 0;
    for i in 0..400 {
        let mut flipped = bytes.clone();
        let at = if i < 64 { i } else { i * 7919 % bytes.len() };
        flipped[at] ^= 1 << (i % 8);
        fs::write(&path, &flipped).unwrap();
        if let Ok(dataset) = open(&path, false) {
            // Everything that reads cells: no index may leave its column.
            let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays));
            assert!(field.is_err() || dataset.tets.iter().all(|tet| tet[3] < dataset.positions.len() as u32));
            let is_padding = check(&path, false).is_ok();
            unnoticed += usize::from(is_padding);
        }
    }
    // Reserved bytes of the header and the gaps between columns.
    assert!(unnoticed < 30, "{unnoticed} of 400 flips were not noticed");
}

#[test]
fn check_finds_what_opening_leaves_unread() {
    let folder = Folder::new();
    let path = small_container(&folder);
    let (bytes, directory) = bytes_and_directory(&path);
    let problem = |change: &dyn Fn(&mut [u8])| {
        let mut changed = bytes.clone();
        change(&mut changed);
        fs::write(&path, &changed).unwrap();
        assert!(open(&path, true).is_ok());
        check(&path, true).unwrap_err().to_string()
    };
    let error = problem(&|bytes| bytes[directory.positions.offset as usize] ^= 1);
    assert!(error.contains("column positions: its checksum is wrong"), "{error}");

    // Wrong, but with the right checksum: what a bad writer would do.
    let vouched = |change: &dyn Fn(&mut [u8])| {
        let (mut changed, mut directory) = (bytes.clone(), directory.clone());
        change(&mut changed);
        for span in [&mut directory.positions, &mut directory.orientation, &mut directory.tetrahedra] {
            let column = &changed[span.offset as usize..][..span.bytes as usize];
            span.xxh3 = twox_hash::XxHash3_64::oneshot(column);
        }
        with_directory(&path, &changed, &serde_json::to_vec(&directory).unwrap());
        check(&path, true).unwrap_err().to_string()
    };
    let at = |span: super::directory::Span| span.offset as usize;
    let error = vouched(&|bytes| bytes[at(directory.tetrahedra)..][..8].fill(0xff));
    assert!(error.contains("cell 0: its vertices"), "{error}");
    let error = vouched(&|bytes| bytes[at(directory.orientation)] ^= 1);
    assert!(error.contains("cell 0: its orientation"), "{error}");
    let error = vouched(&|bytes| bytes[at(directory.positions)..][..4].copy_from_slice(&f32::NAN.to_le_bytes()));
    assert!(error.contains("vertex 0 is not at a finite place"), "{error}");
    let error = vouched(&|bytes| bytes[at(directory.positions)..][..4].copy_from_slice(&9_f32.to_le_bytes()));
    assert!(error.contains("outside its block's box"), "{error}");
}

#[test]
fn a_file_that_changes_is_noticed_and_one_that_is_replaced_is_not_touched() {
    let folder = Folder::new();
    let path = small_container(&folder);
    let dataset = open(&path, true).unwrap();
    let backing = dataset.backing.clone().unwrap();
    backing.check().unwrap();

    let mesh = generate(Kind::Tets, &settings(100)).unwrap();
    write(&mesh, &path, &WriteOptions::default(), &|_, _, _| {}).unwrap();
    backing.check().unwrap();
    assert!(dataset.tets.len() > 4000 && dataset.tets.get(4000)[3] > 0, "the old file lives on");

    let backing = open(&path, true).unwrap().backing.unwrap();
    fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(b"x").unwrap();
    assert!(backing.check().unwrap_err().to_string().contains("was written to"));
    let len = fs::metadata(&path).unwrap().len();
    fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(len - 100).unwrap();
    assert!(backing.check().unwrap_err().to_string().contains("was shortened"));
    assert!(open(&path, false).is_err());
}

#[test]
fn block_ids_have_the_layout_of_the_format() {
    assert_eq!((size_of::<BlockIds>(), BlockIds::UNIT_BYTES), (8, 64));
}
