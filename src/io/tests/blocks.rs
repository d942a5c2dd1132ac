//! `.vts` and `.vtr`: extents, pieces, parallel files.

use super::*;

/// A piece of the grid whose point (i, j, k) lies at i, j, k + `lift`; `i0 i1 j0 j1 k0 k1`.
fn piece(extent: [i32; 6], lift: f32, arrays: &str) -> String {
    let [i0, i1, j0, j1, k0, k1] = extent;
    let row = |j: i32, k: i32| (i0..=i1).map(move |i| format!("{i} {j} {} ", k as f32 + lift));
    let points: String = (k0..=k1).flat_map(|k| (j0..=j1).flat_map(move |j| row(j, k))).collect();
    format!(
        "<Piece Extent='{i0} {i1} {j0} {j1} {k0} {k1}'><Points><DataArray type='Float32' NumberOfComponents='3'>{points}\
         </DataArray></Points>{arrays}</Piece>"
    )
}

fn file(whole: &str, pieces: &str) -> String {
    format!("<VTKFile type='StructuredGrid'><StructuredGrid WholeExtent='{whole}'>{pieces}</StructuredGrid></VTKFile>")
}

fn cell_array(kind: &str, name: &str, values: &str) -> String {
    format!("<CellData><DataArray type='{kind}' Name='{name}'>{values}</DataArray></CellData>")
}

/// Four cells along i in two pieces.
pub(super) fn two_pieces() -> Vec<u8> {
    let left = piece([0, 2, 0, 1, 0, 1], 0.0, &cell_array("Int8", "id", "1 2"));
    let right = piece([2, 4, 0, 1, 0, 1], 0.0, &cell_array("Int8", "id", "3 4"));
    file("0 4 0 1 0 1", &(left + &right)).into_bytes()
}

/// Three cells along x.
pub(super) fn rectilinear() -> Vec<u8> {
    let axis = |kind: &str, values: &str| format!("<DataArray type='{kind}'>{values}</DataArray>");
    let axes = axis("Float32", "0 1 3 6") + &axis("Float64", "-1 1") + &axis("Int32", "5 7");
    format!(
        "<VTKFile type='RectilinearGrid'><RectilinearGrid WholeExtent='-1 2 0 1 7 8'><Piece Extent='-1 2 0 1 7 8'>{}\
         <Coordinates>{axes}</Coordinates></Piece></RectilinearGrid></VTKFile>",
        cell_array("Float64", "p", "1 2 3")
    )
    .into_bytes()
}

fn vts(text: impl AsRef<[u8]>) -> Result<StructuredMesh> {
    read_vts(text.as_ref(), Path::new(NAME))
}

#[test]
fn every_piece_is_a_block() {
    let mesh = vts(two_pieces()).unwrap();
    assert_eq!(mesh.blocks().iter().map(StructuredBlock::dims).collect::<Vec<_>>(), [[3, 2, 2], [3, 2, 2]]);
    assert_eq!((mesh.points().len(), mesh.points().get(12).x), (24, 2.0));
    assert_eq!(values(&mesh.arrays()[0].values), [1.0, 2.0, 3.0, 4.0]);
    let data = mesh.into_dataset().unwrap();
    assert_eq!((data.counts.in_file, data.counts.split, data.tets.len()), (4, 4, 24));
}

#[test]
fn axes_make_the_points() {
    let mesh = read_vtr(&rectilinear(), Path::new(NAME)).unwrap();
    assert_eq!(mesh.blocks()[0].dims(), [4, 2, 2]);
    assert_eq!(mesh.points().get(3).to_array(), [6.0, -1.0, 5.0]);
    assert_eq!(mesh.points().get(13).to_array(), [1.0, 1.0, 7.0]);
    let data = mesh.into_dataset().unwrap();
    assert_eq!((data.tets.len(), data.counts.in_file), (18, 3));
}

#[test]
fn empty_pieces_are_left_out_and_arrays_of_some_pieces_too() {
    let empty = "<Piece Extent='0 -1 0 -1 0 -1'><Points/></Piece>";
    let one = piece([0, 1, 0, 1, 0, 1], 0.0, &cell_array("Int8", "only here", "1"));
    let other = piece([1, 2, 0, 1, 0, 1], 0.0, "");
    let mesh = vts(file("0 2 0 1 0 1", &format!("{empty}{one}{empty}{other}"))).unwrap();
    assert_eq!((mesh.blocks().len(), mesh.arrays().len(), mesh.cells()), (2, 0, 2));
    let none = vts(file("0 -1 0 -1 0 -1", empty)).unwrap();
    assert!(none.blocks().is_empty());
    assert!(vts(file("0 -1 0 -1 0 -1", "")).unwrap().blocks().is_empty());
}

#[test]
fn cells_of_two_pieces_are_drawn_once() {
    // Three pieces of 3 x 2 x 2 cells with a layer of each other, in an order that the sweep does not have.
    let extents = [[4, 7, 0, 2, 0, 2], [0, 3, 0, 2, 0, 2], [2, 5, 0, 2, 0, 2]];
    let with = |array: &dyn Fn(usize) -> String| {
        let pieces = extents.iter().enumerate().map(|(i, &extent)| piece(extent, 0.0, &array(i)));
        vts(file("0 7 0 2 0 2", &pieces.collect::<String>())).unwrap()
    };
    let counts = |mesh: StructuredMesh| mesh.into_dataset().unwrap().counts;
    let plain = counts(with(&|_| String::new()));
    assert_eq!((plain.in_file, plain.ghost, plain.split), (36, 8, 7 * 2 * 2));
    // Ghosts that the file marks itself stay so.
    let mesh = with(&|_| cell_array("UInt8", "vtkGhostType", "32 0 0 0 0 0 0 0 0 0 0 0"));
    let types = values(&mesh.arrays()[0].values);
    assert_eq!((types[0], types[12], types[24], types[26]), (32.0, 32.0, 33.0, 1.0));
    assert_eq!(counts(mesh).ghost, 8 + 2);
    // The same piece many times.
    let same = piece([0, 1, 0, 1, 0, 1], 0.0, "").repeat(129);
    assert_eq!(counts(vts(file("0 1 0 1 0 1", &same)).unwrap()).ghost, 128);
    let error = vts(file("0 1 0 1 0 1", &(same + &piece([0, 1, 0, 1, 0, 1], 0.0, "")))).unwrap_err().to_string();
    assert!(error.contains("overlap"), "{error}");
}

#[test]
fn parallel_files_are_read_from_their_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("all.pvts");
    let whole = "0 4 0 1 0 1";
    std::fs::write(folder.path().join("a.vts"), file(whole, &piece([0, 3, 0, 1, 0, 1], 0.0, ""))).unwrap();
    std::fs::write(folder.path().join("b.vts"), file(whole, &piece([2, 4, 0, 1, 0, 1], 0.0, ""))).unwrap();
    let parallel = "<VTKFile type='PStructuredGrid'><PStructuredGrid WholeExtent='0 4 0 1 0 1' GhostLevel='1'>\
                    <Piece Extent='0 3 0 1 0 1' Source='a.vts'/><Piece Extent='2 4 0 1 0 1' Source='b.vts'/>\
                    </PStructuredGrid></VTKFile>";
    std::fs::write(&path, parallel).unwrap();
    let data = open(&path).unwrap();
    assert_eq!((data.counts.in_file, data.counts.ghost, data.counts.split), (5, 1, 4));

    std::fs::write(&path, parallel.replace("b.vts", "a.vts")).unwrap();
    assert!(open(&path).unwrap_err().to_string().contains("earlier piece"));
    std::fs::write(&path, parallel.replace("b.vts", "all.pvts")).unwrap();
    assert!(open(&path).unwrap_err().to_string().contains("PStructuredGrid"));

    let path = folder.path().join("all.pvtr");
    std::fs::write(folder.path().join("c.vtr"), rectilinear()).unwrap();
    std::fs::write(
        &path,
        parallel.replace("PStructured", "PRectilinear").replace("a.vts", "c.vtr").replace("b.vts", "d.vtr"),
    )
    .unwrap();
    std::fs::write(
        folder.path().join("d.vtr"),
        String::from_utf8(rectilinear()).unwrap().replace("-1 2 0 1", "2 5 0 1"),
    )
    .unwrap();
    assert_eq!(structured(open_mesh(&path).unwrap()).blocks().len(), 2);
}

#[test]
fn damage_is_named() {
    let whole = String::from_utf8(two_pieces()).unwrap();
    for (from, to, expected) in [
        ("WholeExtent='0 4 0 1 0 1'", "", "WholeExtent"),
        ("WholeExtent='0 4 0 1 0 1'", "WholeExtent='0 4 0 1 0'", "six whole numbers"),
        ("WholeExtent='0 4 0 1 0 1'", "WholeExtent='0 4 0 1 0 1.5'", "six whole numbers"),
        ("WholeExtent='0 4 0 1 0 1'", "WholeExtent='0 3 0 1 0 1'", "outside the WholeExtent"),
        ("Piece Extent='0 2 0 1 0 1'", "Piece Extent='0 3 0 1 0 1'", "48 are needed"),
        ("Piece Extent='0 2 0 1 0 1'", "Piece", "\"Extent\""),
        ("NumberOfComponents='3'", "NumberOfComponents='2'", "coordinates, not 3"),
        ("<Points>", "<Dots>", "not well-formed"),
        ("Name='id'>1 2<", "Name='id'>1 2 3<", "2 are needed"),
        ("<StructuredGrid ", "<ImageData ", "not well-formed"),
        ("type='StructuredGrid'", "type='PolyData'", "PolyData"),
    ] {
        let error = vts(whole.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.starts_with("sample: ") && error.contains(expected), "{to}: {error}");
    }
    let huge = "-2147483648 2147483647 -2147483648 2147483647 -2147483648 2147483647";
    let error = vts(file(huge, &format!("<Piece Extent='{huge}'/>"))).unwrap_err().to_string();
    assert!(error.contains("cannot be"), "{error}");

    let axes = String::from_utf8(rectilinear()).unwrap();
    for (from, to, expected) in [
        ("<DataArray type='Int32'>5 7</DataArray>", "", "fewer than three"),
        ("0 1 3 6", "0 1 3", "4 are needed"),
        ("'>1 2 3<", "'>1 2<", "3 are needed"),
    ] {
        let error = read_vtr(axes.replacen(from, to, 1).as_bytes(), Path::new(NAME)).unwrap_err().to_string();
        assert!(error.contains(expected), "{to}: {error}");
    }
}

#[test]
fn axes_of_a_small_file_do_not_become_a_large_mesh() {
    let zeros = "0 ".repeat(3000);
    let axis = format!("<DataArray type='Int8'>{zeros}</DataArray>");
    let extent = "0 2999 0 2999 0 2999";
    let file = format!(
        "<VTKFile type='RectilinearGrid'><RectilinearGrid WholeExtent='{extent}'><Piece Extent='{extent}'>\
         <Coordinates>{axis}{axis}{axis}</Coordinates></Piece></RectilinearGrid></VTKFile>"
    );
    let error = read_vtr(file.as_bytes(), Path::new(NAME)).unwrap_err().to_string();
    assert!(error.contains("<Coordinates>") && error.contains("64 times the file"), "{error}");
}
