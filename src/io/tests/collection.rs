//! `.vtm` and `.pvd`: blocks in blocks, parts of a time step, and references that lead back.

use std::path::PathBuf;

use super::*;

/// A folder with `a.vtu` (two cells, a tetrahedron and a pyramid), `b.vts` (four hexahedra in two blocks) and `c.vtr` (three).
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let style = samples::styles()[0];
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    for (name, bytes) in [
        ("parts/a.vtu", style.write()),
        ("b.vts", super::blocks::two_pieces()),
        ("c.vtr", super::blocks::rectilinear()),
    ] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

fn file(kind: &str, contents: &str) -> Vec<u8> {
    format!("<VTKFile type='{kind}' version='1.0'><{kind}>{contents}</{kind}></VTKFile>").into_bytes()
}

fn vtm(folder: &Path, contents: &str) -> Result<Mesh> {
    read_vtm(&file("vtkMultiBlockDataSet", contents), &folder.join("all.vtm"))
}

fn pvd(folder: &Path, contents: &str) -> Result<Mesh> {
    read_pvd(&file("Collection", contents), &folder.join("all.pvd"))
}

const NESTED: &str = "<FieldData><DataArray type='Float64' Name='t'>0.5</DataArray></FieldData><Block index='0' name='zone'>\
                      <DataSet index='0' name='x' file='b.vts'/><DataSet index='1'/><Piece index='2'>\
                      <DataSet index='0' file='c.vtr'/></Piece></Block><DataSet index='1' file='wall.VTP'/>";

#[test]
fn blocks_in_blocks_are_one_mesh() {
    let folder = folder();
    let mesh = structured(vtm(folder.path(), NESTED).unwrap());
    let dims: Vec<_> = mesh.blocks().iter().map(StructuredBlock::dims).collect();
    assert_eq!(dims, [[3, 2, 2], [3, 2, 2], [4, 2, 2]]);
    assert_eq!(mesh.arrays().iter().map(|array| array.name.as_str()).collect::<Vec<_>>(), ["id", "p"]);
    let mixed = NESTED.to_owned() + "<DataSet index='2' file='parts/a.vtu'/>";
    let mesh = unstructured(vtm(folder.path(), &mixed).unwrap());
    assert_eq!((mesh.cells(), mesh.types[..7].to_vec(), mesh.types[8]), (9, vec![12; 7], 14));
    assert_eq!(values(&mesh.array("id", Association::Cell).unwrap().values)[7..], [-3.0, 300.0]);
    assert!(vtm(folder.path(), "").unwrap().point_count() == 0);
    // Found from its content, and from its name.
    for name in ["all.vtm", "all.xml"] {
        let path = folder.path().join(name);
        std::fs::write(&path, file("vtkMultiBlockDataSet", &mixed)).unwrap();
        assert_eq!(open(&path).unwrap().counts.split, 8, "all but the tetrahedron");
    }
}

#[test]
fn the_first_time_step_is_the_earliest() {
    let folder = folder();
    std::fs::write(folder.path().join("all.vtm"), file("vtkMultiBlockDataSet", NESTED)).unwrap();
    let later = "<DataSet timestep='2.5' part='0' file='none.vtu'/>";
    let first =
        "<DataSet timestep='-1e-3' part='0' file='all.vtm'/><DataSet timestep='-0.001' part='1' file='parts/a.vtu'/>";
    assert_eq!(pvd(folder.path(), &format!("{later}{first}{later}")).unwrap().cells(), 9);
    assert_eq!(pvd(folder.path(), &format!("<DataSet file='b.vts'/>{later}")).unwrap().cells(), 4, "without a time");
    let error = pvd(folder.path(), "<DataSet timestep='nan' file='b.vts'/>").unwrap_err().to_string();
    assert!(error.contains("all.pvd") && error.contains("timestep=\"nan\""), "{error}");
}

#[test]
fn references_that_are_not_to_be_followed_are_refused() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("all.vtm"), file("vtkMultiBlockDataSet", "<DataSet file='all.vtm'/>")).unwrap();
    std::fs::write(path("all.pvd"), file("Collection", "<DataSet file='all.pvd'/>")).unwrap();
    std::fs::write(path("vtm-of-pvd.vtm"), file("vtkMultiBlockDataSet", "<DataSet file='all.pvd'/>")).unwrap();
    std::fs::write(path("image.vti"), "<VTKFile type='ImageData'/>").unwrap();
    for name in ["all.vtm", "all.pvd", "vtm-of-pvd.vtm"] {
        let error = open_mesh(&path(name)).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("only meshes can stand here"), "{error}");
    }
    let long = "a".repeat(5000);
    let absolute: PathBuf = path("b.vts");
    let outside = format!("<DataSet file='{}'/><DataSet file='parts/../c.vtr'/>", absolute.display());
    assert_eq!(
        vtm(folder.path(), &outside).unwrap().cells(),
        7,
        "as pieces of parallel files, blocks may lie anywhere"
    );
    for (contents, expected) in [
        ("<DataSet file='b.vts'/><DataSet file='parts/../b.vts'/>".to_owned(), "earlier piece"),
        ("<DataSet file='parts'/>".to_owned(), "is no file"),
        ("<DataSet file=''/>".to_owned(), "is no file"),
        ("<DataSet file='a&#10;b'/>".to_owned(), "no name of a file"),
        (format!("<DataSet file='{long}'/>"), "no name of a file"),
        ("<DataSet file='gone.vtu'/>".to_owned(), "gone.vtu"),
        ("<DataSet file='image.vti'/>".to_owned(), "image.vti"),
        ("<Block>".to_owned(), "not well-formed"),
        ("<Block>".repeat(40) + &"</Block>".repeat(40), "nested more than"),
    ] {
        let error = vtm(folder.path(), &contents).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let error = read_vtm(&file("Collection", ""), &path("a.vtm")).unwrap_err().to_string();
    assert!(error.contains("Collection"), "{error}");
    let error = open_mesh(&path("nothing.vtpc")).unwrap_err().to_string();
    assert!(error.contains("nothing.vtpc"), "{error}");
}
