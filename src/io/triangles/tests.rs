//! The same square from every format, and what is refused.

use super::*;

const PLY: &str = "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n\
                   property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
                   element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                   0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 255 0 0\n1 1 0 0 0 1 0 255 0\n0 1 0 0 0 1 0 0 188\n4 0 1 2 3\n";

fn read(text: impl AsRef<[u8]>, name: &str) -> Result<TriangleMesh> {
    read_triangles(text.as_ref(), Path::new(name))
}

#[track_caller]
fn refused(text: impl AsRef<[u8]>, name: &str, parts: &[&str]) {
    let message = read(text, name).expect_err(name).to_string();
    assert!(parts.iter().all(|part| message.contains(part)), "{parts:?} in {message:?}");
}

fn corners(mesh: &TriangleMesh) -> Vec<[f64; 3]> {
    mesh.triangles.iter().flatten().map(|&corner| mesh.positions[corner as usize]).collect()
}

const SQUARE: [[f64; 3]; 6] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn text_stl(name: &str) -> String {
    let facet = |corners: &[[f64; 3]]| {
        let vertex = |[x, y, z]: &[f64; 3]| format!("vertex {x} {y} {z:e}\n");
        let vertices = corners.iter().map(vertex).collect::<Vec<_>>().concat();
        format!("facet normal 0 0 1\n outer loop\n{vertices} endloop\nendfacet\n")
    };
    format!("solid{name}\n{}{}endsolid{name}\n", facet(&SQUARE[..3]), facet(&SQUARE[3..]))
}

fn binary_stl(header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend(2_u32.to_le_bytes());
    for triangle in SQUARE.chunks(3) {
        let numbers = [[0.0, 0.0, 1.0]].iter().chain(triangle).flatten().copied().collect::<Vec<f64>>();
        bytes.extend(numbers.iter().flat_map(|&number| (number as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// The square with 64-bit indices of faces' lengths, binary.
fn binary_ply(is_big: bool) -> Vec<u8> {
    let order = if is_big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty uchar material\nproperty list uchar uint vertex_index\nend_header\n"
    )
    .into_bytes();
    let mut push = |number: [u8; 4]| {
        let mut number = number;
        if is_big {
            number.reverse();
        }
        bytes.extend(number);
    };
    for corner in [0, 1, 2, 5] {
        SQUARE[corner].iter().for_each(|x| push((*x as f32).to_le_bytes()));
    }
    bytes.extend([7, 4]);
    for corner in 0..4_u32 {
        bytes.extend(if is_big { corner.to_be_bytes() } else { corner.to_le_bytes() });
    }
    bytes
}

#[test]
fn every_format_gives_the_same_square() {
    let ply = read(PLY, "a.ply").unwrap();
    assert_eq!(corners(&ply), SQUARE);
    assert_eq!((ply.normals[3], ply.colors[0], ply.colors[2]), ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    assert!((ply.colors[3][2] - 0.5029).abs() < 1e-3);
    for is_big in [false, true] {
        let mesh = read(binary_ply(is_big), "any").unwrap();
        assert_eq!((corners(&mesh), mesh.colors.len()), (SQUARE.to_vec(), 0));
    }
    for stl in [text_stl(" a square"), text_stl(""), text_stl(" x").to_uppercase().replace('\n', "\r\n")] {
        assert_eq!(corners(&read(&stl, "a.stl").unwrap()), SQUARE, "{stl}");
    }
    assert_eq!(read(text_stl("") + &text_stl(" b"), "a.stl").unwrap().triangles.len(), 4);
    for header in [&b"made by"[..], b"solid and binary"] {
        assert_eq!(corners(&read(binary_stl(header), "any").unwrap()), SQUARE);
    }
    let obj = "# a\nmtllib b.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\ng x\nusemtl y\nf 1//1 2//1 3/1/1 -1\n";
    let obj = read(obj, "a.OBJ").unwrap();
    assert_eq!(corners(&obj), SQUARE);
    assert_eq!((obj.normals[0], obj.normals[3]), ([0.0, 0.0, 1.0], [0.0; 3]));
    assert_eq!((obj.colors[0], obj.colors[1]), ([1.0, 0.0, 0.0], [1.0; 3]));
}

#[test]
fn damaged_files_are_refused_with_their_place() {
    refused("", "a.obj", &["a.obj", "no triangle"]);
    refused("v 0 0\n", "a.obj", &["line 1", "three coordinates", "v 0 0"]);
    refused("v 0 0 0 2 0 0\n", "a.obj", &["line 1", "from 0 to 1"]);
    refused("v 0 0 0\nf 1 1\n", "a.obj", &["line 2", "three corners"]);
    for index in ["0", "2", "-2", "9223372036854775807", "-9223372036854775808", "x", ""] {
        refused(format!("v 0 0 0\n\nf 1 1 {index}/\n"), "a.obj", &["line 3", "no such position"]);
        if !index.is_empty() {
            refused(format!("v 0 0 0\nvn 0 0 1\nf 1 1 1//{index}\n"), "a.obj", &["line 3", "no such normal"]);
        }
    }
    refused("v nan 0 0\nf 1 1 1\n", "a.obj", &["a.obj", "not finite"]);
    refused("anything", "a.dat", &["no STL, PLY or OBJ"]);
    refused(text_stl("").replace("endsolid", ""), "a.stl", &["truncated"]);
    refused(text_stl("").replace("vertex 1 1 0e0", "vertex 1 1"), "a.stl", &["triangle 0", "vertex"]);
    let whole = binary_stl(b"");
    refused(&whole[..whole.len() - 1], "a.stl", &["triangle 1"]);
    refused(&whole[..50], "a.stl", &["header"]);
    refused(PLY.replace("4 0 1 2 3", "4 0 1 2 4"), "a.ply", &["refers to point 4"]);
    refused(PLY.replace("4 0 1 2 3", "4 0 1 2 -1"), "a.ply", &["refers to point -1"]);
    refused(PLY.replace("element vertex 4", "element vertex 4000000000"), "a.ply", &["element vertex", "do not fit"]);
    refused(PLY.replace("property float x\n", ""), "a.ply", &["a.ply"]);
    refused(
        PLY.replace("element face 1\n", "element edge 1000000000\nelement face 1\n"),
        "a.ply",
        &["element edge", "do not fit"],
    );
    refused(PLY.replace("end_header", "end"), "a.ply", &["a.ply", "line"]);
    let whole = binary_ply(true);
    refused(&whole[..whole.len() - 1], "a.ply", &["face"]);
}
