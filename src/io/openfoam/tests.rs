#![expect(clippy::float_cmp, reason = "numbers are read bit for bit")]

use std::fs;

use super::*;
use crate::columns::{Array, Dataset};

/// A case of a cube from 0 to 1 and a prism over a pentagon on it; with a field at times 0 and 2, the mesh twice as high at 2.
fn write_case(folder: &Path, format: &str) {
    let header = |class: &str| {
        let arch = "arch \"LSB;label=32;scalar=64\";";
        format!("/* a\n comment */ FoamFile {{ version 2.0; format {format}; {arch} class {class}; object x; }} // *\n")
    };
    let file = |path: &str, class: &str, body: Vec<u8>| {
        let path = folder.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, [header(class).into_bytes(), body].concat()).unwrap();
    };
    let is_binary = format == "binary";
    let labels = |values: &[i32]| -> Vec<u8> {
        if is_binary {
            let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
            [format!("{}(", values.len()).into_bytes(), bytes, b")".to_vec()].concat()
        } else {
            let text = values.iter().map(i32::to_string).collect::<Vec<_>>().join("\n");
            format!("{}\n(\n{text}\n)\n", values.len()).into_bytes()
        }
    };
    let vectors = |values: &[[f64; 3]]| -> Vec<u8> {
        if is_binary {
            let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
            [format!("{}\n(", values.len()).into_bytes(), bytes, b")".to_vec()].concat()
        } else {
            let text = values.iter().map(|[x, y, z]| format!("({x} {y} {z})")).collect::<Vec<_>>().join("\n");
            format!("{}\n(\n{text}\n)\n", values.len()).into_bytes()
        }
    };
    let points = |height: f64| -> Vec<[f64; 3]> {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let level = |z: f64| square.map(|[x, y]| [x, y, z * height]);
        // Two more corners split a side of the upper cell.
        [&level(0.0)[..], &level(1.0), &level(2.0), &[[1.0, 0.5, height], [1.0, 0.5, 2.0 * height]]].concat()
    };
    // The first is between the cells; the cube has the corner 12 too, and is no hexahedron to be recognised.
    let faces: [&[i32]; 12] = [
        &[4, 5, 12, 6, 7],
        &[0, 3, 2, 1],
        &[0, 1, 5, 4],
        &[1, 2, 6, 12, 5],
        &[2, 3, 7, 6],
        &[3, 0, 4, 7],
        &[8, 9, 13, 10, 11],
        &[4, 5, 9, 8],
        &[5, 12, 13, 9],
        &[12, 6, 10, 13],
        &[6, 7, 11, 10],
        &[7, 4, 8, 11],
    ];
    file("case/constant/polyMesh/points", "vectorField", vectors(&points(1.0)));
    if is_binary {
        let mut starts = vec![0];
        starts.extend(faces.iter().scan(0, |end, face| {
            *end += face.len() as i32;
            Some(*end)
        }));
        let body = [labels(&starts), labels(&faces.concat())].concat();
        file("case/constant/polyMesh/faces", "faceCompactList", body);
    } else {
        let body: Vec<u8> = faces.iter().flat_map(|face| labels(face)).collect();
        file("case/constant/polyMesh/faces", "faceList", [b"12(".to_vec(), body, b")".to_vec()].concat());
    }
    file("case/constant/polyMesh/owner", "labelList", labels(&[0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1]));
    file("case/constant/polyMesh/neighbour", "labelList", labels(&[1]));
    file("case/2/polyMesh/points", "vectorField", vectors(&points(2.0)));
    let field = |values: [[f64; 3]; 2]| {
        let list = [b"internalField nonuniform List<vector> ".to_vec(), vectors(&values)].concat();
        [b"dimensions [0 1 -1 0 0 0 0];\n".to_vec(), list, b";\nboundaryField { a { type b; } }".to_vec()].concat()
    };
    file("case/0/U", "volVectorField", field([[1.0, 0.0, 0.0], [0.0, 3.0, 4.0]]));
    file("case/2/U", "volVectorField", field([[2.0, 0.0, 0.0], [0.0, 6.0, 8.0]]));
    file("case/2/p", "volScalarField", b"internalField uniform 7.5; boundaryField {}".to_vec());
    file("case/2/q", "volScalarField", b"internalField #calc \"7\"; boundaryField {}".to_vec());
    file("case/2/phi", "surfaceScalarField", b"internalField uniform 0;".to_vec());
    fs::write(folder.join("case/case.foam"), b"").unwrap();
}

fn volumes(mesh: UnstructuredMesh) -> Vec<f64> {
    let dataset = Dataset::from_cells(mesh.into_cells().unwrap()).unwrap();
    let mut volumes: Vec<f64> = (0..dataset.cells()).map(|cell| dataset.volume_world(cell)).collect();
    volumes.sort_by(f64::total_cmp);
    volumes
}

#[test]
fn a_case_is_read_at_its_last_time_or_another_in_ascii_and_binary() {
    for format in ["ascii", "binary"] {
        let folder = tempfile::tempdir().unwrap();
        write_case(folder.path(), format);
        let case = folder.path().join("case");
        let value = |array: &Array, i: usize| array.values.get(i);
        let last = read_openfoam(&case).unwrap();
        assert_eq!((last.cells(), last.points.len()), (2, 14));
        assert_eq!(last.arrays.iter().map(|a| a.name.as_str()).collect::<Vec<_>>(), ["U", "p"]);
        assert_eq!([value(&last.arrays[0], 4), value(&last.arrays[1], 1)], [6.0, 7.5]);
        assert_eq!(volumes(last), [2.0, 2.0], "{format}");
        let first = read_openfoam(&openfoam_time(&case.join("case.foam"), 0.0).unwrap()).unwrap();
        assert_eq!(value(&first.arrays[0], 4), 3.0);
        assert_eq!(volumes(first), [1.0, 1.0]);
        let by_file = crate::io::open_mesh(&case.join("case.foam")).unwrap();
        assert_eq!((by_file.cells(), crate::io::open_mesh(&case).unwrap().cells()), (2, 2));
        let error = openfoam_time(&case, 1.0).unwrap_err().to_string();
        assert!(error.contains("no time 1") && error.contains("0, 2"), "{error}");
    }
}

#[test]
fn cut_off_files_are_refused_with_their_names() {
    for format in ["ascii", "binary"] {
        let folder = tempfile::tempdir().unwrap();
        write_case(folder.path(), format);
        let case = folder.path().join("case");
        for name in ["constant/polyMesh/faces", "constant/polyMesh/owner", "2/polyMesh/points", "2/U"] {
            let (path, bytes) = (case.join(name), fs::read(case.join(name)).unwrap());
            // Behind the list of values nothing is read.
            let whole = bytes.len() - if name.ends_with('U') { 40 } else { 2 };
            for len in (0..whole).step_by(7) {
                fs::write(&path, &bytes[..len]).unwrap();
                match read_openfoam(&case).and_then(UnstructuredMesh::into_cells) {
                    Ok(mesh) => assert!(name.ends_with('U') && mesh.arrays.len() < 2, "{name} of {len} bytes"),
                    Err(error) => {
                        let error = error.to_string();
                        assert!(error.contains(name.rsplit('/').next().unwrap()), "{format}, {len} bytes: {error}");
                    }
                }
            }
            fs::write(&path, &bytes).unwrap();
        }
        fs::remove_file(case.join("constant/polyMesh/neighbour")).unwrap();
        assert!(read_openfoam(&case).unwrap_err().to_string().contains("neighbour"));
    }
}
