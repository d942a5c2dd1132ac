use super::*;

const HEAD: &str = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n";
const TET: &str = "POINTS 4 float\n0 0 0 1 0 0\n0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";

fn ascii(rest: &str) -> Result<UnstructuredMesh> {
    vtk(format!("{HEAD}{TET}{rest}").as_bytes())
}

#[test]
fn every_kind_of_array_is_read_from_text() {
    let mesh = ascii(
        "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n\
         CELL_DATA 1\nFIELD FieldData 3\nspaced%20name 2 1 double\n1 nan\nwords 1 1 string\nhello%20you\n\
         whole 1 3 int\n1 2 3\nPEDIGREE_IDS ids vtkIdType\n7\nTENSORS6 six float\n1 2 3 4 5 6\n\
         point_data 4\nscalars s unsigned_char\nLOOKUP_TABLE t\n1 2 3 255\nLOOKUP_TABLE t 2\n0 0 0 1 1 1 1 1\n\
         SCALARS bare float 2\n1 2 3 4 5 6 -inf 8\nVECTORS v double\n1 2 3 4 5 6 7 8 9 10 11 12\n\
         NORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\nTENSORS t float\n1 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 1\n\
         1 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 1\nTEXTURE_COORDINATES tc 2 float\n1 2 3 4 5 6 7 8\n\
         COLOR_SCALARS c 3\n0 0 0 0 0 0 0 0 0 1 1 0.5\nSCALARS b bit 1\nLOOKUP_TABLE default\n1 0 1 1\n",
    )
    .unwrap();
    let found: Vec<_> = mesh.arrays.iter().map(|a| (a.name.as_str(), a.components, a.values.type_name())).collect();
    assert_eq!(
        found,
        [
            ("spaced name", 2, "f64"),
            ("ids", 1, "i64"),
            ("six", 6, "f32"),
            ("s", 1, "u8"),
            ("bare", 2, "f32"),
            ("v", 3, "f64"),
            ("n", 3, "f32"),
            ("t", 9, "f32"),
            ("tc", 2, "f32"),
            ("c", 3, "f32"),
            ("b", 1, "u8"),
        ]
    );
    assert!(mesh.arrays[0].values.get(1).is_nan());
    assert_eq!(values(&mesh.arrays[3].values), [1.0, 2.0, 3.0, 255.0]);
    assert_eq!(mesh.arrays[4].values.get(6), f64::NEG_INFINITY);
}

/// The sample as version 5.1 or 3.0, binary.
pub(super) fn binary(version: &str) -> Vec<u8> {
    let mut file = format!("# vtk DataFile Version {version}\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\n").into_bytes();
    let mut section = |head: &str, bytes: Vec<u8>| {
        file.extend(head.as_bytes());
        file.extend(bytes);
        file.push(b'\n');
    };
    let i32s = |values: &[i32]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<_>>();
    let i64s = |values: &[i64]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<_>>();
    let f64s = |values: &[f64]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<_>>();
    section("FIELD FieldData 1\ntime 1 1 double\n", f64s(&[0.1]));
    section("POINTS 4 double\n", f64s(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]));
    section("METADATA\nINFORMATION 0\n", Vec::new());
    if version == "5.1" {
        section("CELLS 2 4\nOFFSETS vtktypeint64\n", i64s(&[0, 4]));
        section("CONNECTIVITY vtktypeint64\n", i64s(&[0, 1, 2, 3]));
    } else {
        section("CELLS 1 5\n", i32s(&[4, 0, 1, 2, 3]));
    }
    section("CELL_TYPES 1\n", i32s(&[10]));
    section("POINT_DATA 4\nSCALARS b bit\nLOOKUP_TABLE default\n", vec![0b1011_0000]);
    section("LOOKUP_TABLE other 1\n", vec![1, 2, 3, 4]);
    section("COLOR_SCALARS rgb 3\n", (0..12).collect());
    section("CELL_DATA 1\nGLOBAL_IDS gid vtkIdType\n", i32s(&[-70_000]));
    section("FIELD FieldData 2\nwords 1 1 string\n", [&[0xc0 | 5][..], b"a\nb c"].concat());
    section("last 1 1 vtktypeint64\n", i64s(&[1 << 40]));
    file
}

#[test]
fn both_forms_of_binary_cells_are_read() {
    let expected = ascii("").unwrap();
    for version in ["3.0", "5.1"] {
        let mesh = vtk(&binary(version)).unwrap();
        assert_same(&UnstructuredMesh { arrays: Vec::new(), ..mesh.clone() }, &expected, version);
        let found: Vec<_> = mesh.arrays.iter().map(|array| (array.name.as_str(), values(&array.values))).collect();
        assert_eq!(found[0], ("b", vec![1.0, 0.0, 1.0, 1.0]));
        assert_eq!(found[1].1[11], 11.0);
        assert_eq!(found[2], ("gid", vec![-70_000.0]));
        assert_eq!(found[3], ("last", vec![(1_u64 << 40) as f64]));
    }
}

#[test]
fn windows_line_ends_and_any_case_are_read() {
    let file =
        format!("{HEAD}{TET}point_data 4\nScalars s Float\nlookup_table default\n1 2 3 4\n").replace('\n', "\r\n");
    let mesh = vtk(file.as_bytes()).unwrap();
    assert_eq!(values(&mesh.arrays[0].values), [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn damage_is_named() {
    for (from, to, expected) in [
        ("ASCII", "TEXT", "line 3"),
        ("# vtk", "# xtk", "line 1"),
        ("UNSTRUCTURED_GRID", "POLYDATA", "POLYDATA"),
        ("POINTS 4", "POINTS 99999999999999", "are declared"),
        ("POINTS 4", "POINTS 18446744073709551615", "cannot be"),
        ("POINTS 4", "POINTS -4", "\"-4\""),
        ("POINTS 4", "POINTS 5", "value 12 of 15"),
        ("4 0 1 2 3", "4 0 1 2 -3", "refers to point -3"),
        ("4 0 1 2 3", "5 0 1 2 3", "beyond the list"),
        ("4 0 1 2 3", "3 0 1 2 3", "left after"),
        ("4 0 1 2 3", "-1 0 1 2 3", "beyond the list"),
        ("CELLS 1 5", "CELLS 3000000000 5", "cannot be in a list"),
        ("4 0 1 2 3", "4 0 1 2 x", "\"x\""),
        ("CELL_TYPES 1\n10\n", "", "CELL_TYPES"),
        ("CELL_TYPES 1\n10", "CELL_TYPES 1\n300", "type 300"),
        ("CELL_TYPES 1\n10\n", "CELL_TYPES 1\n10\nNONSENSE 5\n", "NONSENSE"),
        ("CELL_TYPES 1\n10\n", "CELL_TYPES 1\n10\nPOINT_DATA 5\n", "POINT_DATA"),
        ("CELL_TYPES 1\n10\n", "CELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS s half\n", "data type"),
        ("CELL_TYPES 1\n10\n", "CELL_TYPES 1\n10\nPOINT_DATA 4\nFIELD f 99999999999\n", "ends before a name"),
    ] {
        let file = format!("{HEAD}{TET}").replacen(from, to, 1);
        let error = vtk(file.as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with("sample: ") && error.contains(expected), "{to}: {error}");
    }
    let error = vtk(format!("{HEAD}{TET}").replace("0 1 2 3", "0 1 2 4").as_bytes()).unwrap().into_dataset();
    assert!(error.unwrap_err().to_string().contains("refers to point 4"));
}
