use super::samples::{mesh, styles};
use super::*;

#[test]
fn every_encoding_reads_the_same() {
    let expected = mesh();
    for style in styles() {
        let found = vtu(&style.write()).unwrap_or_else(|error| panic!("{style:?}: {error}"));
        assert_same(&found, &expected, &format!("{style:?}"));
        assert_eq!(found.arrays[0].values.type_name(), "f64");
        assert_eq!(found.arrays[1].values.type_name(), "i16");
    }
}

fn text(piece: &str) -> String {
    format!("<VTKFile type='UnstructuredGrid'><UnstructuredGrid>{piece}</UnstructuredGrid></VTKFile>")
}

fn tet_piece(at: f32, extra: &str) -> String {
    format!(
        "<Piece NumberOfPoints='4' NumberOfCells='1'><Points><DataArray type='Float32' NumberOfComponents='3'>
        {at} 0 0 {} 0 0 {at} 1 0 {at} 0 1 </DataArray></Points><Cells>
        <DataArray type='Int32' Name='connectivity'>0 1 2 3</DataArray><DataArray type='UInt64' Name='offsets'>4</DataArray>
        <DataArray type='UInt8' Name='types'>10</DataArray></Cells>{extra}</Piece>",
        at + 1.0
    )
}

#[test]
fn pieces_follow_each_other_and_share_their_common_arrays() {
    let data = |kind: &str, more: &str| {
        format!("<PointData><DataArray type='{kind}' Name='p'>1 2 3 4</DataArray>{more}</PointData>")
    };
    let more = "<DataArray type='Int8' Name='only here'>1 2 3 4</DataArray>";
    let empty = "<Piece NumberOfPoints='0' NumberOfCells='0'></Piece>";
    let file = text(&(tet_piece(0.0, &data("Int8", more)) + empty + &tet_piece(5.0, &data("Float32", ""))));
    let mesh = vtu(file.as_bytes()).unwrap();
    assert_eq!(mesh.offsets[..], [0, 4, 8]);
    assert_eq!(mesh.connectivity[..], [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(mesh.points.get(4).x, 5.0);
    assert_eq!(mesh.arrays.len(), 1);
    assert_eq!(values(&mesh.arrays[0].values), [1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn parallel_files_are_read_from_their_folder_and_ghosts_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("all.pvtu");
    let ghost =
        |value: u8| format!("<CellData><DataArray type='UInt8' Name='vtkGhostType'>{value}</DataArray></CellData>");
    for (name, ghost) in [("a.vtu", ghost(0)), ("b.vtu", ghost(1))] {
        std::fs::write(folder.path().join(name), text(&tet_piece(0.0, &ghost))).unwrap();
    }
    let parallel = "<VTKFile type='PUnstructuredGrid'><PUnstructuredGrid><Piece Source='a.vtu'/><Piece Source='b.vtu'/>\
                    </PUnstructuredGrid></VTKFile>";
    std::fs::write(&path, parallel).unwrap();
    let data = open(&path).unwrap();
    assert_eq!((data.tets.len(), data.counts.in_file, data.counts.ghost), (1, 2, 1));

    std::fs::remove_file(folder.path().join("b.vtu")).unwrap();
    assert!(open(&path).unwrap_err().to_string().contains("b.vtu"));
    for source in ["/dev/zero", "."] {
        std::fs::write(&path, parallel.replace("b.vtu", source)).unwrap();
        assert!(matches!(open(&path), Err(Error::Malformed { .. })), "{source}");
    }
}

#[test]
fn formats_are_found_by_their_first_bytes_and_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.dat");
    std::fs::write(&path, text(&tet_piece(0.0, ""))).unwrap();
    assert_eq!(open_mesh(&path).unwrap().cells(), 1);
    for (name, bytes, expected) in [
        ("a.ex2", &b"CDF\x01"[..], "Exodus"),
        ("a.nii.gz", b"\x1f\x8b", "NIfTI"),
        ("a.vtu", b"\x1f\x8b", "gzip"),
        ("a.dat", b"CDF\x02", "NetCDF"),
        ("a.vtp", b"<?xml?><VTKFile type=\"PolyData\">", "surface"),
        ("a.vtu", b"<?xml?><VTKFile type=\"PolyData\"></VTKFile>", "PolyData"),
        ("a.what", b"", "no mesh"),
    ] {
        let error = read_mesh(bytes, name.as_ref()).unwrap_err();
        assert!(matches!(error, Error::Unsupported { .. }) && error.to_string().contains(expected), "{name}: {error}");
    }
    assert!(open(folder.path()).unwrap_err().to_string().contains("folder"));
    assert!(matches!(open(&folder.path().join("none.vtu")), Err(Error::Io { .. })));
    assert!(read_mesh(b"", "a.vtu".as_ref()).unwrap_err().to_string().contains("no XML element"));
}
