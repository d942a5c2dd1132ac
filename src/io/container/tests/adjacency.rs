//! Containers that say which cells share a face.

use super::whole::{blocks, mixed};
use super::*;
use crate::columns::{CellMesh, Neighbours};
use crate::io::container::directory::Span;
use crate::stages::sort::adjacency::Adjacency;

fn write_with(source: &dyn CellSource, path: &Path, memory_bytes: u64) -> Vec<u8> {
    write(source, path, &WriteOptions { memory_bytes, adjacency: true }, &|_, _, _| {}).unwrap();
    fs::read(path).unwrap()
}

/// The same cells, each with points of its own.
fn apart(mut mesh: CellMesh) -> CellMesh {
    let points: Vec<[f64; 3]> =
        mesh.hexahedra.iter().flatten().map(|&v| mesh.points.get(v as usize).to_array()).collect();
    let hexahedra = mesh.hexahedra.len() as u32;
    mesh.hexahedra = (0..hexahedra).map(|cell| std::array::from_fn(|i| 8 * cell + i as u32)).collect();
    (mesh.tets, mesh.file_from_tet) = (Vec::new().into(), Vec::new().into());
    (mesh.points, mesh.arrays) = (Points::F64(points), Vec::new());
    mesh.counts = CellCounts { in_file: mesh.counts.in_file, ..CellCounts::default() };
    mesh
}

#[test]
fn neighbours_are_those_found_in_memory_in_any_budget_and_on_any_threads() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    let delaunay = generate(Kind::Delaunay, &settings(30_000)).unwrap();
    for (name, mesh) in [
        ("tetrahedra", delaunay.into()),
        ("one block of each kind", mixed(2)),
        ("several blocks", mixed(21)),
        ("hexahedra apart", apart(mixed(9))),
    ] {
        let expected = Neighbours::new(&Dataset::from_cells(mesh.clone()).unwrap());
        let bytes = write_with(&mesh, &path, 1 << 30);
        let dataset = open(&path, true).unwrap();
        assert!(dataset.adjacency.as_ref() == Some(&expected), "{name}");
        let shared = expected.from_tet.as_flattened().iter().chain(expected.from_hexahedron.as_flattened());
        let shared = shared.filter(|&&other| other != Neighbours::NONE).count();
        assert!(shared > 2 * dataset.cells(), "{name}: {shared}");
        let (used, exterior) = (Adjacency::new(&dataset), size_of_val(Adjacency::new(&dataset).exterior()) as u64);
        assert_eq!((used.is_stored(), used.owned_bytes()), (true, exterior), "{name}: used in place");
        check(&path, true).unwrap();
        assert_eq!(bytes[8], if mesh.hexahedra.is_empty() { 1 } else { 2 });
        for threads in [1, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| write_with(&mesh, &path, 0)) == bytes, "{name}, {threads} threads");
        }
        // Without them the file is shorter by just these columns, to alignment and directory.
        let without = folder.container(&mesh, 1 << 30);
        assert!(without.adjacency.is_none());
        let less = bytes.len() as u64 - fs::metadata(&path).unwrap().len();
        assert!(less.abs_diff(expected.owned_bytes()) < 512, "{name}: {less}");
    }
}

#[test]
fn structured_blocks_imply_their_neighbours() {
    let folder = Folder::new();
    let cells = blocks(|cell| cell % 13 == 0);
    let (stored, made) = (folder.structured(cells.clone()), Dataset::from_structured(cells).unwrap());
    let (a, b) = (Adjacency::new(&stored), Adjacency::new(&made));
    assert!((0..made.cells() as u32).all(|cell| a.neighbours(&stored, cell) == b.neighbours(&made, cell)));
    assert_eq!((a.exterior(), a.is_stored()), (b.exterior(), false));
    assert_eq!(a.owned_bytes(), size_of_val(a.exterior()) as u64, "nothing is stored");

    let path = folder.path("mesh.cells");
    let (bytes, mut directory) = bytes_and_directory(&path);
    directory.adjacency = Some(Span { bytes: 0, ..directory.positions });
    directory.hexahedra.as_mut().unwrap().adjacency = directory.adjacency;
    with_directory(&path, &bytes, &serde_json::to_vec(&directory).unwrap());
    assert!(open(&path, true).unwrap_err().to_string().contains("column adjacency: structured blocks imply it"));
}

#[test]
fn damaged_neighbours_are_refused_or_made_anew_and_check_says_where() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    let bytes = write_with(&mixed(3), &path, 0);
    // Read, as the file is going to be written over.
    let dataset = open(&path, false).unwrap();
    let expected = dataset.adjacency.clone().unwrap();
    let directory = Directory::read(&bytes, &path).unwrap();
    let of_hexahedra = |directory: &mut Directory, change: fn(&mut Option<Span>)| {
        change(&mut directory.hexahedra.as_mut().unwrap().adjacency);
    };
    for (lie, part) in [
        (&|d: &mut Directory| d.adjacency = None as Option<Span>, "of one kind and not of the other"),
        (&|d: &mut Directory| of_hexahedra(d, |span| *span = None), "of one kind and not of the other"),
        (&|d: &mut Directory| of_hexahedra(d, |span| span.as_mut().unwrap().bytes -= 24), "adjacency of hexahedra: "),
        (&|d: &mut Directory| of_hexahedra(d, |span| span.as_mut().unwrap().offset += 4), "adjacency of hexahedra: "),
        (&|d: &mut Directory| d.adjacency.as_mut().unwrap().bytes += 16, "column adjacency: "),
    ] as [(&dyn Fn(&mut Directory), &str); 5]
    {
        let mut changed = directory.clone();
        lie(&mut changed);
        with_directory(&path, &bytes, &serde_json::to_vec(&changed).unwrap());
        let error = open(&path, true).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }) && error.to_string().contains(part), "{error}: {part}");
    }

    // Wrong, but with the right checksum: what a bad writer would do. The first cell that is wrong may be the neighbour's.
    let entry = directory.hexahedra.as_ref().unwrap();
    let [of_tets, of_hexahedra] = [directory.adjacency.unwrap(), entry.adjacency.unwrap()];
    let cells = dataset.cells() as u32;
    for (span, word) in [(of_tets, 0), (of_tets, 7), (of_hexahedra, 3), (of_hexahedra, 6 * 40 + 1)] {
        let at = span.offset as usize + 4 * word;
        let right = u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        for wrong in [0, 5, cells, u32::MAX - 1].into_iter().filter(|&wrong| wrong != right) {
            let (mut changed, mut directory) = (bytes.clone(), directory.clone());
            changed[at..at + 4].copy_from_slice(&wrong.to_le_bytes());
            with_directory(&path, &changed, &serde_json::to_vec(&directory).unwrap());
            let error = check(&path, true).unwrap_err().to_string();
            assert!(error.contains("column adjacency") && error.contains("checksum is wrong"), "{error}");
            for span in [directory.adjacency.as_mut(), directory.hexahedra.as_mut().unwrap().adjacency.as_mut()] {
                let span = span.unwrap();
                span.xxh3 = twox_hash::XxHash3_64::oneshot(&changed[span.offset as usize..][..span.bytes as usize]);
            }
            with_directory(&path, &changed, &serde_json::to_vec(&directory).unwrap());
            let error = check(&path, true).unwrap_err().to_string();
            assert!(error.contains("names a cell that does not lie there"), "{wrong} for {right}: {error}");
            let opened = open(&path, true).unwrap();
            let anew = Adjacency::new(&opened);
            assert!(!anew.is_stored() && anew.neighbours_from_tet() == &expected.from_tet[..]);
        }
    }
}
