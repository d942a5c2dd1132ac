//! Structured and rectilinear grids of legacy files.

use super::*;

const HEAD: &str = "# vtk DataFile Version 3.0\ntitle\nASCII\n";
const CURVED: &str = "DATASET STRUCTURED_GRID\nDIMENSIONS 3 2 2\nPOINTS 12 float\n\
                      0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0\n0 0 1 1 0 1 2 0 1 0 1 1 1 1 1 2 1 1\n";
const AXES: &str = "DATASET RECTILINEAR_GRID\nFIELD FieldData 1\ntime 1 1 double\n0.5\nDIMENSIONS 3 2 2\n\
                    X_COORDINATES 3 float\n0 1 2\nY_COORDINATES 2 float\n0 1\nZ_COORDINATES 2 float\n0 1\n";

fn read(rest: &str) -> Result<Mesh> {
    read_vtk(format!("{HEAD}{rest}").as_bytes(), Path::new(NAME))
}

/// Both kinds, binary, with data over points and cells.
pub(super) fn binary() -> [(&'static str, Vec<u8>); 2] {
    let f32s = |values: &[f32]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<_>>();
    let data = [b"\nCELL_DATA 2\nSCALARS s short\nLOOKUP_TABLE default\n".to_vec(), vec![0, 7, 255, 255]].concat();
    let points: Vec<f32> = (0_u8..12).flat_map(|i| [i % 3, i / 3 % 2, i / 6].map(f32::from)).collect();
    let head = "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET ";
    let curved = [format!("{head}STRUCTURED_GRID\nDIMENSIONS 3 2 2\nPOINTS 12 float\n").into_bytes(), f32s(&points)];
    let mut axes = format!("{head}RECTILINEAR_GRID\nDIMENSIONS 3 2 2").into_bytes();
    for (axis, values) in [("X", &[0.0, 1.0, 2.0][..]), ("Y", &[0.0, 1.0]), ("Z", &[0.0, 1.0])] {
        axes.extend(format!("\n{axis}_COORDINATES {} float\n", values.len()).into_bytes());
        axes.extend(f32s(values));
    }
    [("structured", [curved.concat(), data.clone()].concat()), ("rectilinear", [axes, data].concat())]
}

#[test]
fn text_and_binary_of_both_kinds_give_the_same_mesh() {
    let data = "CELL_DATA 2\nSCALARS s short\nLOOKUP_TABLE default\n7 -1\n";
    let mut meshes = vec![read(&format!("{CURVED}{data}")).unwrap(), read(&format!("{AXES}{data}")).unwrap()];
    meshes.extend(binary().map(|(_, file)| read_vtk(&file, Path::new(NAME)).unwrap()));
    for mesh in meshes {
        let mesh = structured(mesh);
        assert_eq!(mesh.blocks()[0].dims(), [3, 2, 2]);
        let expected = (0_u8..12).map(|i| [i % 3, i / 3 % 2, i / 6].map(f32::from));
        assert!(matches!(mesh.points(), Points::F32(points) if points.iter().copied().eq(expected)));
        assert_eq!((mesh.arrays()[0].values.type_name(), values(&mesh.arrays()[0].values)), ("i16", vec![7.0, -1.0]));
        assert_eq!(mesh.into_dataset().unwrap().tets.len(), 12);
    }
}

#[test]
fn blanked_points_hide_their_cells() {
    let mesh = read(&format!("{CURVED}BLANKING 12 unsigned_char\n1 1 1 1 1 1 1 1 0 1 1 1\n")).unwrap();
    let counts = mesh.into_dataset().unwrap().counts;
    assert_eq!((counts.ghost, counts.split), (1, 1));
}

#[test]
fn damage_is_named() {
    for (text, from, to, expected) in [
        (CURVED, "DIMENSIONS 3 2 2\n", "", "DIMENSIONS"),
        (CURVED, "DIMENSIONS 3 2 2", "DIMENSIONS 3 2 3", "[3, 2, 3], but there are 12 points"),
        (CURVED, "DIMENSIONS 3 2 2", "DIMENSIONS 3 2 -2", "\"-2\""),
        (CURVED, "DIMENSIONS 3 2 2", "DIMENSIONS 4294967296 4294967296 4294967296", "but there are 12"),
        (CURVED, "POINTS 12", "POINTS 13", "value 36 of 39"),
        (CURVED, "POINTS 12", "DOTS 12", "DOTS"),
        (CURVED, "CELL_DATA 2\nSCALARS", "CELL_DATA 1\nVECTORS", "value 0 of 3"),
        (CURVED, "POINT_DATA 12", "CELL_DATA 12", "CELL_DATA: is for 12, but the mesh has 2"),
        (CURVED, "POINT_DATA 12", "POINT_DATA 11", "is for 11"),
        (AXES, "DIMENSIONS 3 2 2", "DIMENSIONS 3 2 1", "[3, 2, 2] coordinates"),
        (AXES, "Y_COORDINATES 2 float\n0 1\n", "", "no Y_COORDINATES"),
        (AXES, "Z_COORDINATES 2", "Z_COORDINATES 99999999999999", "are declared"),
    ] {
        let data = "CELL_DATA 2\nSCALARS s short\nLOOKUP_TABLE default\n7 -1\nPOINT_DATA 12\n";
        let file = format!("{text}{data}").replacen(from, to, 1);
        let error = read(&file).unwrap_err().to_string();
        assert!(error.starts_with("sample: ") && error.contains(expected), "{to}: {error}");
    }
    let error = read("DATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\n").unwrap_err().to_string();
    assert!(error.contains("no POINTS"), "{error}");
    let axes: String =
        ["X", "Y", "Z"].map(|axis| format!("{axis}_COORDINATES 3000 char\n{}\n", "0 ".repeat(3000))).concat();
    let error = read(&format!("DATASET RECTILINEAR_GRID\nDIMENSIONS 3000 3000 3000\n{axes}")).unwrap_err().to_string();
    assert!(error.contains("64 times the file"), "{error}");
}
