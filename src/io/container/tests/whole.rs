//! Containers of hexahedra, wedges, pyramids and structured blocks.

use glam::{DVec3, Vec3};

use super::*;
use crate::cells::{HEXAHEDRON, PYRAMID, TETRAHEDRON, WEDGE};
use crate::columns::{BitColumn, CellMesh, HexShape, StructuredBlock};
use crate::io::container::directory::{HexahedraEntry, Span};
use crate::io::{StructuredMesh, UnstructuredMesh, WholeCells};

/// The points of a box of `n` cells each way, a little bent; i fastest.
fn bent(n: [usize; 3]) -> Vec<[f32; 3]> {
    let [ni, nj, nk] = n.map(|n| n + 1);
    let all = (0..nk).flat_map(|k| (0..nj).flat_map(move |j| (0..ni).map(move |i| [i, j, k])));
    let bend = |[x, y, z]: [f32; 3]| [x + 0.2 * (y + z).sin(), y + 0.2 * (2.0 * z).cos(), z + 0.1 * (x * y).sin()];
    all.map(|ijk| bend(ijk.map(|c| c as f32))).collect()
}

/// A scalar and a vector at each point, a scalar with holes and a byte in each cell.
fn arrays(points: usize, cells: usize) -> Vec<Array> {
    let array = |name: &str, association, components, values: NumericColumn| Array {
        name: name.to_owned(),
        association,
        components,
        values,
    };
    let wave = |len: usize, f: f32| (0..len).map(|i| (i as f32 * f).sin()).collect::<Vec<_>>();
    let holes = (0..cells).map(|i| if i % 11 == 3 { f64::NAN } else { i as f64 }).collect::<Vec<_>>();
    vec![
        array("value", Association::Point, 1, wave(points, 0.37).into()),
        array("flow", Association::Point, 3, wave(3 * points, 0.11).into()),
        array("holes", Association::Cell, 1, holes.into()),
        array("byte", Association::Cell, 1, (0..cells).map(|i| (i % 251) as u8).collect::<Vec<_>>().into()),
    ]
}

/// Hexahedra of a bent box, every third one cut into pyramids, every fifth into wedges, with tetrahedra in between.
pub(super) fn mixed(n: usize) -> CellMesh {
    let mut points = bent([n; 3]);
    let of = |block: &StructuredBlock| (0..block.cells()).map(|cell| block.corners(cell as u32)).collect();
    let hexahedra: Vec<[u32; 8]> = of(&StructuredBlock { dims: [n as u32 + 1; 3], first_vertex: 0, first_cell: 0 });
    let (mut types, mut offsets, mut connectivity) = (Vec::new(), vec![0], Vec::new());
    let mut push = |code: u8, corners: &[u32]| {
        types.push(code);
        connectivity.extend_from_slice(corners);
        offsets.push(connectivity.len() as u64);
    };
    for (i, corners) in hexahedra.into_iter().enumerate() {
        let [a, b, c, d, e, f, g, h] = corners;
        if i % 3 == 0 {
            let middle = corners.iter().map(|&v| Vec3::from_array(points[v as usize])).sum::<Vec3>() / 8.0;
            let tip = points.len() as u32;
            points.push(middle.to_array());
            for face in HEXAHEDRON.faces {
                let [a, b, c, d] = [3, 2, 1, 0].map(|k: usize| corners[usize::from(face[k])]);
                push(PYRAMID.code, &[a, b, c, d, tip]);
            }
        } else if i % 5 == 0 {
            push(WEDGE.code, &[a, c, b, e, g, f]);
            push(WEDGE.code, &[a, d, c, e, h, g]);
        } else if i % 7 == 0 {
            push(TETRAHEDRON.code, &[a, b, d, e]);
        } else {
            // Every other one the other way round.
            let turned = HexShape::mirrored(corners);
            push(HEXAHEDRON.code, if i % 2 == 0 { &corners } else { &turned });
        }
    }
    let arrays = arrays(points.len(), types.len());
    let (types, offsets, connectivity) = (types.into(), offsets.into(), connectivity.into());
    let points = Points::F32(points);
    let mesh = UnstructuredMesh { points, types, offsets, connectivity, arrays, ..UnstructuredMesh::empty() };
    mesh.into_cells().unwrap()
}

/// Two bent blocks side by side; `hide` hides cells.
pub(super) fn blocks(hide: impl Fn(usize) -> bool) -> StructuredCells {
    let sizes = [[20, 17, 19], [5, 17, 19]];
    let mut points = bent(sizes[0]);
    points.extend(bent(sizes[1]).into_iter().map(|[x, y, z]| [x + 20.0, y, z]));
    let cells = sizes.iter().map(|n| n.iter().product::<usize>()).sum();
    let arrays = arrays(points.len(), cells);
    let mesh = StructuredMesh::new(&sizes.map(|n| n.map(|n| n + 1)), Points::F32(points), arrays).unwrap();
    let Ok(WholeCells::Structured(structured)) = mesh.into_whole_in(&crate::io::Scratch::memory()) else {
        panic!("all have a volume")
    };
    StructuredCells { hidden: (0..cells).map(hide).collect::<BitColumn>(), ..structured }
}

#[test]
fn listed_cells_of_all_kinds_are_what_they_become_in_memory() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    for (n, blocks) in [(2, 2), (21, 8)] {
        let mesh = mixed(n);
        let expected = Dataset::from_cells(mesh.clone()).unwrap();
        assert_eq!(expected.blocks.len(), blocks);
        assert!(!expected.tets.is_empty() && expected.counts.inverted > 0);
        let whole = folder.container(&mesh, 1 << 30);
        assert_same(&whole, &expected);
        assert_eq!(whole.hexahedra.owned_bytes(), 0, "used in place");
        let bytes = fs::read(&path).unwrap();
        assert_eq!(bytes[8], 2);
        check(&path, true).unwrap();
        let kinds = cells_by_kind(&path, true).unwrap();
        let count = |code: u8| mesh_kinds(&mesh)[usize::from(code)];
        assert_eq!(kinds.len(), 4);
        assert!(kinds.iter().all(|&(kind, cells)| cells == count(kind)), "{kinds:?}");

        folder.container(&mesh, 0);
        assert!(fs::read(&path).unwrap() == bytes, "any memory gives the same file");
    }
}

/// How many cells are of each kind, by how their corners repeat.
fn mesh_kinds(mesh: &CellMesh) -> [u64; 15] {
    let mut kinds = [0; 15];
    kinds[10] = mesh.tets.len() as u64;
    for corners in &mesh.hexahedra[..] {
        let different: std::collections::BTreeSet<_> = corners.iter().collect();
        kinds[match different.len() {
            8 => 12,
            6 => 13,
            _ => 14,
        }] += 1;
    }
    kinds
}

#[test]
fn cells_without_volume_are_left_out_and_double_points_are_recentred() {
    let folder = Folder::new();
    let mut mesh = mixed(4);
    let Points::F32(points) = mesh.points.clone() else { panic!("single precision") };
    let far = |p: [f32; 3]| (Vec3::from_array(p).as_dvec3() + DVec3::splat(1e7)).to_array();
    mesh.points = Points::F64(points.into_iter().map(far).collect());
    mesh.hexahedra.to_mut()[3] = [5; 8];
    let expected = Dataset::from_cells(mesh.clone()).unwrap();
    assert_eq!(expected.counts.degenerate, 1);
    assert_same(&folder.container(&mesh, 0), &expected);

    mesh.hexahedra.to_mut().fill([5; 8]);
    mesh.tets.to_mut().fill([5; 4]);
    let refused = |mesh: &CellMesh| write(mesh, &folder.path("a.cells"), &WriteOptions::default(), &|_, _, _| {});
    assert!(matches!(refused(&mesh), Err(Error::NoCells { .. })));
    mesh.hexahedra.to_mut()[1][7] = 1 << 20;
    assert!(matches!(refused(&mesh), Err(Error::IndexOutOfRange { index: 1_048_576, .. })));
    mesh.file_from_hexahedron.to_mut().pop();
    assert!(matches!(refused(&mesh), Err(Error::LengthMismatch { .. })));
    assert!(!folder.path("a.cells").exists());
}

#[test]
fn structured_blocks_keep_their_order_and_take_two_bytes_a_cell() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    // The second case hides the whole first block of 4096 cells, and some others.
    for hide in [(|_| false) as fn(usize) -> bool, |cell| cell < 4100 || cell % 13 == 0] {
        let mesh = blocks(hide);
        let expected = Dataset::from_structured(mesh.clone()).unwrap();
        let whole = folder.structured(mesh);
        assert_same(&whole, &expected);
        assert_eq!(whole.hexahedra.structured_blocks(), expected.hexahedra.structured_blocks());
        assert!(whole.owned_bytes() < 1000, "used in place: {}", whole.owned_bytes());
        check(&path, false).unwrap();
        assert_eq!(open(&path, false).unwrap().cells_drawn_in(0), expected.cells_drawn_in(0));

        let (cells, points) = (whole.cells() as u64, whole.positions.len() as u64);
        let arrays = 16 * points + 9 * cells;
        let bytes = fs::metadata(&path).unwrap().len();
        assert!(bytes < 2 * cells + 12 * points + arrays + 8192, "{bytes} bytes for {cells} cells, {points} points");
    }
    let all_hidden = write_structured(blocks(|_| true), &path, &|_, _, _| {});
    assert!(matches!(all_hidden, Err(Error::NoCells { .. })));
}

/// Vertices by their place, which is the same however they are numbered.
fn tets_in_space(dataset: &Dataset) -> Vec<[[u32; 3]; 4]> {
    let mut tets: Vec<_> = dataset
        .tets
        .iter()
        .map(|tet| {
            let mut corners = tet.map(|v| dataset.positions[v as usize].map(f32::to_bits));
            corners.sort_unstable();
            corners
        })
        .collect();
    tets.sort_unstable();
    tets
}

#[test]
fn whole_cells_are_cut_as_the_source_is() {
    let folder = Folder::new();
    let cells = blocks(|cell| cell % 13 == 0);
    let dims = cells.dims.clone();
    let hidden: Vec<u8> = (0..cells.hidden.len()).map(|cell| u8::from(cells.hidden.get(cell))).collect();
    let name = "vtkGhostType".to_owned();
    let mut with_ghosts = cells.arrays.clone();
    with_ghosts.push(Array { name, association: Association::Cell, components: 1, values: hidden.into() });
    let source = StructuredMesh::new(&dims, cells.points.clone(), with_ghosts).unwrap();
    let expected = source.into_dataset().unwrap();
    let found = folder.structured(cells).into_tetrahedra().unwrap();
    assert!(tets_in_space(&found) == tets_in_space(&expected));
    assert_eq!((found.hexahedra.len(), found.counts.split), (0, expected.counts.split));
    assert!(found.backing.is_some(), "its arrays are still those of the file");
    for name in ["value", "byte"] {
        let of = |dataset: &Dataset| dataset.field(&FieldSelection::parse(name, &dataset.arrays)).unwrap();
        let sum = |dataset: &Dataset| of(dataset).values.iter().map(|&v| f64::from(v)).sum::<f64>();
        assert_eq!(of(&found).values.len(), of(&expected).values.len());
        assert!((sum(&found) - sum(&expected)).abs() < 1e-6 * sum(&expected).abs().max(1.0), "{name}");
    }

    let mesh = mixed(5);
    let whole = folder.container(&mesh, 1 << 30);
    let cut = crate::io::open(&folder.path("mesh.cells")).unwrap();
    let volume = |dataset: &Dataset| (0..dataset.cells()).map(|cell| dataset.volume_world(cell)).sum::<f64>();
    assert!(cut.hexahedra.is_empty() && (volume(&whole) - volume(&cut)).abs() < 1e-4 * volume(&whole));
    let value = cut.field(&FieldSelection::parse("holes", &cut.arrays)).unwrap();
    let of_file: Vec<f64> = (0..cut.cells()).map(|cell| f64::from(value.values[cell]) + value.offset).collect();
    let holes = &whole.arrays.iter().find(|array| array.name == "holes").unwrap().values;
    assert!((0..cut.cells()).all(|cell| {
        let expected = holes.get(cut.cell_tuple(cell));
        expected.is_nan() == of_file[cell].is_nan() && (expected.is_nan() || (expected - of_file[cell]).abs() < 1e-3)
    }));
}

type Lie = fn(&mut Directory);

fn entry(directory: &mut Directory) -> &mut HexahedraEntry {
    directory.hexahedra.as_mut().unwrap()
}

#[test]
fn directories_of_whole_cells_that_lie_are_refused() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    let refused = |bytes: &[u8], changed: &Directory, part: &str| {
        with_directory(&path, bytes, &serde_json::to_vec(changed).unwrap());
        let error = open(&path, true).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }), "{error:?}");
        assert!(error.to_string().contains(part), "{error} says nothing of {part:?}");
    };
    let listed: [(Lie, &str); 13] = [
        (|d| d.hexahedra = None, "version 2"),
        (|d| d.cell_kind = Directory::TETRAHEDRON.to_owned(), "tetrahedron"),
        (|d| entry(d).cells = 0, "0 hexahedra"),
        (|d| entry(d).cells = d.cells + 1, "hexahedra"),
        (|d| entry(d).cells = u64::MAX, "hexahedra"),
        (|d| entry(d).absent = u64::MAX, "absent"),
        (|d| (entry(d).wedges, entry(d).pyramids) = (u64::MAX, 2), "wedges"),
        (|d| entry(d).shapes.bytes -= 2, "column shapes"),
        (|d| entry(d).corners = entry(d).blocks, "corners or blocks"),
        (|d| entry(d).blocks = entry(d).corners, "corners or blocks"),
        (|d| (entry(d).blocks, entry(d).corners) = (entry(d).corners, None), "blocks beside other cells"),
        (|d| entry(d).corners.as_mut().unwrap().offset = d.positions.offset, "overlaps"),
        (|d| d.adjacency = Some(d.positions), "adjacency"),
    ];
    folder.container(&mixed(3), 1 << 30);
    let (bytes, directory) = bytes_and_directory(&path);
    for (lie, part) in listed {
        let mut changed = directory.clone();
        lie(&mut changed);
        refused(&bytes, &changed, part);
    }

    folder.structured(blocks(|cell| cell < 4096));
    let (bytes, directory) = bytes_and_directory(&path);
    let blocks = directory.hexahedra.as_ref().unwrap().blocks.unwrap();
    // Sides, first vertices and first cells that are not those of one block after the other.
    for (word, value) in [(0, 1), (0, u32::MAX), (1, 0), (2, 21), (3, 1), (4, 1), (5, 7), (8, 0), (9, u32::MAX)] {
        let mut changed = bytes.clone();
        changed[blocks.offset as usize + 4 * word..][..4].copy_from_slice(&value.to_le_bytes());
        refused(&changed, &directory, "hexahedra");
    }
    let cut_short = |lie: Lie, part: &str| {
        let mut changed = directory.clone();
        lie(&mut changed);
        refused(&bytes, &changed, part);
    };
    cut_short(|d| entry(d).blocks.as_mut().unwrap().bytes -= 1, "part of a block");
    cut_short(|d| entry(d).blocks.as_mut().unwrap().bytes = 20, "hexahedra");
    cut_short(|d| entry(d).blocks.as_mut().unwrap().bytes = 0, "hexahedra");
    cut_short(|d| d.vertices -= 1, "bytes where");
    // No box in any block.
    let mut changed = bytes.clone();
    let boxes = directory.block_bounds;
    let empty = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for block in changed[boxes.offset as usize..][..boxes.bytes as usize].chunks_exact_mut(24) {
        block.copy_from_slice(bytemuck::bytes_of(&empty));
    }
    refused(&changed, &directory, "nothing in any block");
}

#[test]
fn flipped_bits_of_whole_cells_are_refused_or_drawn() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    for structured in [false, true] {
        if structured {
            folder.structured(blocks(|cell| cell % 7 == 0));
        } else {
            folder.container(&mixed(4), 1 << 30);
        }
        let (bytes, directory) = bytes_and_directory(&path);
        let entry = directory.hexahedra.as_ref().unwrap();
        let spans = [Some(entry.shapes), entry.corners, entry.blocks, Some(directory.block_bounds)];
        for (i, span) in spans.into_iter().flatten().cycle().take(200).enumerate() {
            let mut flipped = bytes.clone();
            let at = span.offset as usize + i * 7919 % span.bytes as usize;
            flipped[at] ^= 1 << (i / 3 % 8);
            fs::write(&path, &flipped).unwrap();
            assert!(check(&path, false).is_err(), "byte {at}");
            if let Ok(dataset) = open(&path, false) {
                let (cells, vertices) = (dataset.hexahedra.view(), dataset.positions.len());
                assert!((0..cells.len()).all(|cell| cells.get(cell).iter().all(|&v| (v as usize) < vertices)));
                assert!(dataset.field(&FieldSelection::parse("value", &dataset.arrays)).is_ok());
                assert!(dataset.into_tetrahedra().is_ok());
            }
        }
    }
}

#[test]
fn check_finds_wrong_corners_and_shapes() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    folder.container(&mixed(3), 1 << 30);
    let (bytes, directory) = bytes_and_directory(&path);
    let entry = directory.hexahedra.clone().unwrap();
    // Wrong, but with the right checksum: what a bad writer would do.
    let vouched = |change: &dyn Fn(&mut [u8]), lie: fn(&mut Directory)| {
        let (mut changed, mut directory) = (bytes.clone(), directory.clone());
        change(&mut changed);
        let sum = |span: &mut Span| {
            span.xxh3 = twox_hash::XxHash3_64::oneshot(&changed[span.offset as usize..][..span.bytes as usize]);
        };
        let entry = directory.hexahedra.as_mut().unwrap();
        [&mut entry.shapes, entry.corners.as_mut().unwrap(), &mut directory.positions].into_iter().for_each(sum);
        lie(&mut directory);
        with_directory(&path, &changed, &serde_json::to_vec(&directory).unwrap());
        check(&path, true).unwrap_err().to_string()
    };
    let [shapes, corners] = [entry.shapes, entry.corners.unwrap()].map(|span| span.offset as usize);
    for byte in 0..2 {
        // Folds of faces, convexity, mirror, and the bit that means nothing; the diagonals are the writer's choice.
        for bit in if byte == 0 { 6..8 } else { 0..8 } {
            let error = vouched(&|bytes| bytes[shapes + byte] ^= 1 << bit, |_| {});
            assert!(error.contains("shape is not"), "bit {}: {error}", 8 * byte + bit);
        }
    }
    let error = vouched(&|bytes| bytes[shapes..][..2].copy_from_slice(&(1_u16 << 14).to_le_bytes()), |_| {});
    assert!(error.contains("1 cells are absent"), "{error}");
    let error = vouched(&|bytes| bytes[corners..][..4].fill(0xff), |_| {});
    assert!(error.contains("none of"), "{error}");
    let error = vouched(&|_| {}, |d| d.hexahedra.as_mut().unwrap().absent = 1);
    assert!(error.contains("0 cells are absent"), "{error}");
}
