//! Containers of polyhedra, alone and with cells of all other kinds.

use super::*;
use crate::columns::CellMesh;
use crate::generate::{honeycomb, voronoi};

/// Cells of all kinds: those of `whole`, every other hexahedron by its faces with one of these cut in two.
fn with_polyhedra() -> CellMesh {
    let mut mesh = whole::mixed(5);
    let (hexahedra, file_from) = (mesh.hexahedra.clone(), mesh.file_from_hexahedron.clone());
    let is_plain = |corners: &[u32; 8]| corners.iter().collect::<std::collections::BTreeSet<_>>().len() == 8;
    let as_faces: Vec<usize> = (0..hexahedra.len()).filter(|&i| i % 2 == 0 && is_plain(&hexahedra[i])).collect();
    for &i in &as_faces {
        for face in crate::cells::HEXAHEDRON.faces {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| hexahedra[i][usize::from(face[k])]);
            if face[0] == 0 && face[1] == 4 {
                mesh.polyhedra.push_face(&[a, b, c]);
                mesh.polyhedra.push_face(&[c, d, a]);
            } else {
                mesh.polyhedra.push_face(&[a, b, c, d]);
            }
        }
        mesh.polyhedra.end_cell();
    }
    mesh.file_from_polyhedron = as_faces.iter().map(|&i| file_from[i]).collect();
    let rest = || (0..hexahedra.len()).filter(|i| !as_faces.contains(i));
    mesh.hexahedra = rest().map(|i| hexahedra[i]).collect();
    mesh.file_from_hexahedron = rest().map(|i| file_from[i]).collect();
    mesh
}

#[test]
fn polyhedra_are_what_they_become_in_memory() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    let settings = |cells, jitter| Settings { cells, jitter, ..Settings::default() };
    for (mesh, kinds) in [
        (honeycomb(&settings(189, 0.3)).unwrap(), 1),
        (voronoi(&settings(5000, 0.0)).unwrap(), 1),
        (with_polyhedra(), 5),
    ] {
        let expected = Dataset::from_cells(mesh.clone()).unwrap();
        assert!(!expected.polyhedra.is_empty());
        assert_same(&folder.container(&mesh, 1 << 30), &expected);
        let bytes = fs::read(&path).unwrap();
        assert_eq!(bytes[8], 3);
        check(&path, true).unwrap();
        let of_kinds = cells_by_kind(&path, true).unwrap();
        assert_eq!((of_kinds.len(), of_kinds[kinds - 1]), (kinds, (42, expected.polyhedra.len() as u64)));
        folder.container(&mesh, 0);
        assert!(fs::read(&path).unwrap() == bytes, "any memory gives the same file");
    }
    let tetrahedra = |dataset: Dataset| dataset.into_tetrahedra().unwrap();
    let mesh = voronoi(&settings(50, 0.0)).unwrap();
    let (cut, expected) =
        (tetrahedra(folder.container(&mesh, 1 << 30)), tetrahedra(Dataset::from_cells(mesh.clone()).unwrap()));
    assert!(cut.tets.len() > 500 && cut.tets.iter().eq(expected.tets.iter()));

    let options = WriteOptions { adjacency: true, ..WriteOptions::default() };
    let error = write(&mesh, &path, &options, &|_, _, _| {}).unwrap_err();
    assert!(error.to_string().contains("--adjacency"), "{error}");
}

#[test]
fn polyhedra_that_lie_are_refused_with_the_column() {
    let folder = Folder::new();
    let path = folder.path("mesh.cells");
    folder.container(&with_polyhedra(), 1 << 30);
    let (bytes, directory) = bytes_and_directory(&path);
    let of = directory.polyhedra.unwrap();
    for (lie, part) in [
        ((|d| d.polyhedra.as_mut().unwrap().cells = 0) as fn(&mut Directory), "0 polyhedra"),
        (|d| d.polyhedra.as_mut().unwrap().cells = u64::MAX, "polyhedra of"),
        (|d| d.polyhedra.as_mut().unwrap().faces = u64::MAX, "polyhedra of"),
        (|d| d.polyhedra.as_mut().unwrap().faces += 1, "starts of faces: "),
        (|d| d.polyhedra.as_mut().unwrap().sides.bytes -= 4, "starts of polyhedra: it does not span"),
        (|d| d.polyhedra.as_mut().unwrap().around.bytes -= 1, "starts of faces: it does not span"),
        (|d| d.polyhedra.as_mut().unwrap().corners.offset = 1 << 60, "it lies outside"),
        (|d| d.adjacency = Some(Span { offset: 64, bytes: 0, xxh3: 0 }), "column adjacency"),
        (|d| d.polyhedra = None, "version 3"),
    ] {
        let mut changed = directory.clone();
        lie(&mut changed);
        with_directory(&path, &bytes, &serde_json::to_vec(&changed).unwrap());
        let error = open(&path, true).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }), "{error:?}");
        assert!(error.to_string().contains(part), "{error} says nothing of {part:?}");
    }
    // What their numbers say, with no regard to checksums: never a panic.
    for span in [of.starts, of.sides, of.corners, of.face_starts, of.around] {
        for at in (0..span.bytes).step_by(92) {
            for value in [0, 1, u32::MAX] {
                let mut changed = bytes.clone();
                let place = (span.offset + at) as usize / 4 * 4;
                changed[place..place + 4].copy_from_slice(&value.to_le_bytes());
                fs::write(&path, &changed).unwrap();
                let _ = open(&path, false).map(|dataset| dataset.volume_world(dataset.cells() - 1));
                assert!(changed == bytes || check(&path, false).is_err());
            }
        }
    }
}
