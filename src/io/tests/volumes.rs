//! `.vti`, `.pvti` and legacy structured points: extents, pieces, directions, and the way to meshes.

use glam::{DMat3, DVec3};

use super::*;
use crate::columns::{Lattice, Volume};

/// Values i + 10 j + 100 k of the points of a piece, and of its cells.
fn piece([i0, i1, j0, j1, k0, k1]: [i32; 6]) -> String {
    let at = |i: i32, j: i32, k: i32| format!("{} ", i + 10 * j + 100 * k);
    let rows = |i1: i32, j1: i32, k1: i32| -> String {
        (k0..=k1).flat_map(|k| (j0..=j1).flat_map(move |j| (i0..=i1).map(move |i| at(i, j, k)))).collect()
    };
    format!(
        "<Piece Extent='{i0} {i1} {j0} {j1} {k0} {k1}'><PointData><DataArray type='Int16' Name='p'>{}</DataArray></PointData>\
         <CellData><DataArray type='Float32' Name='c'>{}</DataArray></CellData></Piece>",
        rows(i1, j1, k1),
        rows(i1 - 1, j1 - 1, k1 - 1)
    )
}

fn file(whole: &str, attributes: &str, pieces: &str) -> String {
    format!("<VTKFile type='ImageData'><ImageData WholeExtent='{whole}' {attributes}>{pieces}</ImageData></VTKFile>")
}

/// Three by two by two cells in two pieces.
pub(super) fn two_pieces() -> Vec<u8> {
    let pieces = piece([0, 2, 0, 2, 0, 2]) + &piece([2, 3, 0, 2, 0, 2]);
    file("0 3 0 2 0 2", "Origin='1 0 0' Spacing='0.5 1 2'", &pieces).into_bytes()
}

fn vti(text: impl AsRef<[u8]>) -> Result<Volume> {
    read_vti(text.as_ref(), Path::new(NAME))
}

fn problem(text: impl AsRef<[u8]>) -> String {
    vti(text).unwrap_err().to_string()
}

/// The points and cells of the whole have their own values.
fn assert_whole(volume: &Volume, [i0, j0, k0]: [usize; 3]) {
    for array in &volume.arrays {
        let is_cell = array.association == Association::Cell;
        let [ni, nj, nk] = if is_cell { volume.cell_dims() } else { volume.dims };
        let row = |j: usize, k: usize| (0..ni).map(move |i| ((i0 + i) + 10 * (j0 + j) + 100 * (k0 + k)) as f64);
        let expected = (0..nk).flat_map(|k| (0..nj).flat_map(move |j| row(j, k)));
        assert_eq!(values(&array.values), expected.collect::<Vec<_>>(), "{}", array.name);
    }
}

#[test]
fn pieces_become_one_volume() {
    let volume = vti(two_pieces()).unwrap();
    assert_eq!((volume.dims, volume.points(), volume.cells()), ([4, 3, 3], 36, 12));
    assert_eq!(volume.lattice, Lattice::new(DVec3::X, DVec3::new(0.5, 1.0, 2.0)));
    let kinds: Vec<_> = volume.arrays.iter().map(|array| (&array.name[..], array.values.type_name())).collect();
    assert_eq!(kinds, [("p", "i16"), ("c", "f32")]);
    assert_whole(&volume, [0; 3]);
    // Layers that two pieces share, in an order of their own, of a part of the whole.
    let pieces = piece([3, 5, 1, 2, 1, 3]) + &piece([1, 4, 1, 2, 1, 3]);
    let part = vti(file("0 9 0 9 0 9", "Spacing='2 2 2'", &pieces)).unwrap();
    assert_eq!((part.dims, part.lattice.origin()), ([5, 2, 3], DVec3::splat(2.0)));
    assert_whole(&part, [1; 3]);
    let missing = piece([0, 2, 0, 2, 0, 2]) + &piece([3, 4, 0, 2, 0, 1]);
    assert!(problem(file("0 4 0 2 0 2", "", &missing)).contains("leave out"));
    assert!(problem(file("0 4 0 2 0 2", "", &piece([0, 5, 0, 2, 0, 2]))).contains("WholeExtent"));
    assert!(problem(file("0 4 0 2 0 2", "", "")).contains("no point"));
}

#[test]
fn directions_shear_and_turn() {
    let by_row = "Direction='0 -1 0  1 0.5 0  0 0 1'";
    let volume = vti(file("0 1 0 1 0 1", &format!("Spacing='2 3 4' {by_row}"), &piece([0, 1, 0, 1, 0, 1]))).unwrap();
    let steps = DMat3::from_cols(DVec3::new(0.0, 2.0, 0.0), DVec3::new(-3.0, 1.5, 0.0), DVec3::new(0.0, 0.0, 4.0));
    assert_eq!(volume.lattice, Lattice::sheared(DVec3::ZERO, steps));
    for (bad, what) in [
        ("Direction='1 0 0 0 1 0 0 0'", "9 numbers"),
        ("Direction='1 0 0 1 0 0 0 0 1'", "one plane"),
        ("Spacing='1 0 1'", "one plane"),
        ("Spacing='1 nan 1'", "not finite"),
        ("Origin='inf 0 0'", "not finite"),
        ("Origin='a b c'", "3 numbers"),
    ] {
        let error = problem(file("0 1 0 1 0 1", bad, &piece([0, 1, 0, 1, 0, 1])));
        assert!(error.contains(what) && error.starts_with(NAME), "{bad}: {error}");
    }
}

#[test]
fn parallel_images_are_read_from_their_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("all.pvti");
    let write = |name: &str, extent, spacing: &str| {
        let text = file("0 4 0 1 0 1", &format!("Spacing='{spacing}'"), &piece(extent));
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    write("a.vti", [0, 3, 0, 1, 0, 1], "1 1 1");
    write("b.vti", [2, 4, 0, 1, 0, 1], "1 1 1");
    let parallel = "<VTKFile type='PImageData'><PImageData WholeExtent='0 4 0 1 0 1' GhostLevel='1'>\
                    <Piece Extent='0 3 0 1 0 1' Source='a.vti'/><Piece Extent='2 4 0 1 0 1' Source='b.vti'/>\
                    </PImageData></VTKFile>";
    std::fs::write(&path, parallel).unwrap();
    let Mesh::Volume(volume) = open_mesh(&path).unwrap() else { panic!("no volume") };
    assert_whole(&volume, [0; 3]);
    assert_eq!(read_pvti(parallel.as_bytes(), &path).unwrap().dims, [5, 2, 2]);
    write("b.vti", [2, 4, 0, 1, 0, 1], "1 2 1");
    assert!(open_mesh(&path).unwrap_err().to_string().contains("different"));
}

#[test]
fn appended_arrays_are_used_in_place_where_they_are_aligned() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vti");
    let numbers: Vec<u8> = (0..8_u8).flat_map(|i| f32::from(i).to_le_bytes()).collect();
    let mut places = Vec::new();
    for blanks in 0..4 {
        let head = format!(
            "<VTKFile type='ImageData' byte_order='LittleEndian'><ImageData WholeExtent='0 1 0 1 0 1'><Piece Extent='0 1 0 1 0 1'>\
             <PointData><DataArray type='Float32' Name='p' format='appended' offset='0'/></PointData></Piece></ImageData>\
             {}<AppendedData encoding='raw'>_",
            " ".repeat(blanks)
        );
        let bytes = [head.as_bytes(), &32_u32.to_le_bytes(), &numbers, b"</AppendedData></VTKFile>"].concat();
        std::fs::write(&path, bytes).unwrap();
        let Mesh::Volume(volume) = open_mesh(&path).unwrap() else { panic!("no volume") };
        assert_eq!(values(&volume.arrays[0].values), (0..8).map(f64::from).collect::<Vec<_>>());
        assert_eq!(volume.backing.is_some(), volume.owned_bytes() == 0);
        places.push(volume.owned_bytes());
    }
    places.sort_unstable();
    assert_eq!(places, [0, 32, 32, 32], "one of four places is aligned");
}

/// Three by one by one cells.
pub(super) fn structured_points(is_binary: bool) -> Vec<u8> {
    let mut file = format!(
        "# vtk DataFile Version 3.0\nsample\n{}\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 2 2\nASPECT_RATIO 1 .5 2\nORIGIN 0 -1 1e1\n\
         POINT_DATA 16\nSCALARS p short 1\nLOOKUP_TABLE default\n",
        if is_binary { "BINARY" } else { "ASCII" }
    )
    .into_bytes();
    let push = |file: &mut Vec<u8>, numbers: &[i16]| {
        for number in numbers {
            if is_binary { file.extend(number.to_be_bytes()) } else { file.extend(format!("{number} ").bytes()) }
        }
        file.push(b'\n');
    };
    push(&mut file, &(0..16).map(|i| i * 1000 - 7000).collect::<Vec<_>>());
    file.extend(b"CELL_DATA 3\nFIELD f 1\nc 2 3 short\n");
    push(&mut file, &[1, 2, 3, 4, 5, 6]);
    file
}

#[test]
fn legacy_structured_points_are_read() {
    for is_binary in [false, true] {
        let Mesh::Volume(volume) = read_vtk(&structured_points(is_binary), Path::new(NAME)).unwrap() else {
            panic!("no volume")
        };
        let lattice = Lattice::new(DVec3::new(0.0, -1.0, 10.0), DVec3::new(1.0, 0.5, 2.0));
        assert_eq!((volume.dims, volume.lattice), ([4, 2, 2], lattice));
        let [p, c] = &volume.arrays[..] else { panic!("{} arrays", volume.arrays.len()) };
        assert_eq!(values(&p.values), (0..16).map(|i| f64::from(i * 1000 - 7000)).collect::<Vec<_>>());
        assert_eq!((c.association, c.components, values(&c.values)[5]), (Association::Cell, 2, 6.0));
    }
    let text = String::from_utf8(structured_points(false)).unwrap();
    for (from, to, what) in [
        ("4 2 2", "4 2 3", "POINT_DATA"),
        ("4 2 2", "4294967296 4294967296 4294967296", "cannot be"),
        ("4 2 2", "0 2 2", "POINT_DATA"),
        ("1 .5 2", "1 0 2", "one plane"),
        ("1 .5 2", "1 nan 2", "not finite"),
        ("1 .5 2", "1 x 2", "no number"),
        ("CELL_DATA 3", "CELL_DATA 4", "CELL_DATA"),
    ] {
        let error = read_vtk(text.replacen(from, to, 1).as_bytes(), Path::new(NAME)).unwrap_err().to_string();
        assert!(error.contains(what), "{to}: {error}");
    }
}

#[test]
fn volumes_become_meshes_and_are_joined() {
    let volume = || Mesh::from(vti(two_pieces()).unwrap());
    assert_eq!((volume().point_count(), volume().cells(), volume().cells_by_code()[11]), (36, 12, 12));
    assert!(volume().points().is_none());
    let tets = volume().into_tets().unwrap();
    assert_eq!((tets.tets.len(), tets.counts.split), (72, 12));
    let whole = volume().into_whole_dataset().unwrap();
    assert_eq!((whole.cells(), whole.hexahedra.len(), whole.counts.degenerate), (12, 12, 0));
    assert!((0..12).all(|cell| (whole.volume_world(cell) - 1.0).abs() < 1e-6));
    let other = structured(read_vtk(&legacy_grids::binary()[0].1, Path::new(NAME)).unwrap());
    let joined = Mesh::join(vec![("a".into(), volume()), ("b".into(), other.into())]).unwrap();
    assert_eq!(structured(joined).blocks()[0].dims(), [4, 3, 3]);
    let listed = Mesh::join(vec![("a".into(), volume()), ("b".into(), UnstructuredMesh::empty().into())]).unwrap();
    assert_eq!(unstructured(listed).cells(), 12);
    // Cells that ghosts hide are not drawn.
    let ghosts = "<CellData><DataArray type='UInt8' Name='vtkGhostType'>0 1</DataArray></CellData>";
    let hidden = vti(file("0 2 0 1 0 1", "", &format!("<Piece Extent='0 2 0 1 0 1'>{ghosts}</Piece>"))).unwrap();
    assert_eq!(Mesh::from(hidden).into_whole_dataset().unwrap().counts.ghost, 1);
}
