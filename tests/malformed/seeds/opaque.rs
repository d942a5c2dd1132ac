//! Triangle meshes, and pictures with depth.

use std::fmt::Write;

use cellfan::image::{ByteOrder, DepthImage, Image, ZBuffer};

use super::Seeds;

pub(crate) const PLY_WORDS: &[&str] = &[
    "ply\n",
    "format ascii 1.0\n",
    "format binary_little_endian 1.0\n",
    "format binary_big_endian 1.0\n",
    "element vertex 4000000000\n",
    "element face 18446744073709551615\n",
    "element nothing 1000000000\n",
    "property float x\n",
    "property list uchar int vertex_indices\n",
    "property list double double vertex_index\n",
    "property uchar red\n",
    "end_header\n",
    "comment ",
];

pub(crate) const OBJ_WORDS: &[&str] = &[
    "v ",
    "vn ",
    "vt ",
    "f ",
    "1//1",
    "-1",
    "0",
    "9223372036854775807",
    "-9223372036854775808",
    "1e999",
    "nan",
    "\\\n",
    "#",
];

pub(crate) const EXR_WORDS: &[&str] = &["Z", "R", "channels", "chlist", "dataWindow", "compression", "tiles"];
pub(crate) const STL_WORDS: &[&str] =
    &["solid ", "facet normal", "outer loop", "vertex", "endloop", "endfacet", "endsolid", "1e999", "nan"];

const SQUARE: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]];

pub(crate) fn stl() -> Seeds {
    let mut binary = vec![b' '; 80];
    binary.extend(2_u32.to_le_bytes());
    let mut text = "solid a\n".to_owned();
    for triangle in [[0, 1, 2], [0, 2, 3]] {
        binary.extend([0; 12]);
        triangle.iter().flat_map(|&i: &usize| SQUARE[i]).for_each(|x| binary.extend(x.to_le_bytes()));
        binary.extend([0; 2]);
        text += "facet normal 0 0 1\nouter loop\n";
        for [x, y, z] in triangle.map(|i| SQUARE[i]) {
            let _ = writeln!(text, "vertex {x} {y} {z}");
        }
        text += "endloop\nendfacet\n";
    }
    vec![binary, (text + "endsolid a\n").into_bytes()]
}

pub(crate) fn ply() -> Seeds {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n"
        )
    };
    let mut text = header("ascii");
    for [x, y, z] in SQUARE {
        let _ = writeln!(text, "{x} {y} {z} 255 0 7");
    }
    let binary = [("binary_little_endian", false), ("binary_big_endian", true)].map(|(format, is_big)| {
        let mut bytes = header(format).into_bytes();
        for corner in SQUARE {
            for x in corner {
                bytes.extend(if is_big { x.to_be_bytes() } else { x.to_le_bytes() });
            }
            bytes.extend([255, 0, 7]);
        }
        bytes.push(4);
        (0..4_i32).for_each(|i| bytes.extend(if is_big { i.to_be_bytes() } else { i.to_le_bytes() }));
        bytes
    });
    let [little, big] = binary;
    vec![(text + "4 0 1 2 3\n").into_bytes(), little, big]
}

pub(crate) fn obj() -> Seeds {
    let text = "v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\no a\nf 1//1 2//1 3/1/1 -1\nf 1 2 3\n";
    vec![text.as_bytes().to_vec()]
}

pub(crate) fn depth_images() -> Seeds {
    let (width, height) = (7, 5);
    let depth_world: Vec<f32> = (0..35).map(|i| if i % 5 == 0 { f32::INFINITY } else { i as f32 }).collect();
    let [little, big] = [ByteOrder::Little, ByteOrder::Big].map(|order| {
        let matrix = [[1.0; 4]; 4];
        let depths = ZBuffer {
            width,
            height,
            screen_from_world: matrix,
            view_from_world: matrix,
            depth_world: depth_world.clone(),
        };
        let mut bytes = Vec::new();
        depths.write(&mut bytes, order).unwrap();
        bytes
    });
    let pixels = (0..35).map(|i| [i as f32 / 35.0, 0.5, 0.0, 1.0]).collect();
    let path = super::pieces().join("depth.exr");
    DepthImage::new(Image { width, height, pixels }, depth_world).unwrap().save(&path, None).unwrap();
    vec![little, big, std::fs::read(path).unwrap()]
}
