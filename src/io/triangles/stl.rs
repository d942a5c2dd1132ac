//! STL: triangles without anything shared, binary or as text.

use std::io::Cursor;

use super::super::source::Source;
use crate::error::Result;
use crate::geometry::TriangleMesh;

/// Bytes before the triangles of a binary file, and of each.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Whether a file has the length that its number of triangles says: text begins with `solid`, and so do some binary files.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let count = bytes.get(80..HEADER).map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]));
    count.is_some_and(|count| bytes.len() as u64 == HEADER as u64 + TRIANGLE as u64 * u64::from(count))
}

pub(super) fn read(bytes: &[u8], source: Source) -> Result<TriangleMesh> {
    let is_text =
        !is_binary(bytes) && bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let mut reader = Cursor::new(if is_text { one_solid(bytes, source)? } else { unnamed(bytes) });
    let triangles =
        stl_io::create_stl_reader(&mut reader).map_err(|error| source.malformed("header", error.to_string()))?;
    let mut mesh = TriangleMesh::default();
    for (i, triangle) in triangles.enumerate() {
        let triangle = triangle.map_err(|error| source.malformed(format!("triangle {i}"), error.to_string()))?;
        let first = u32::try_from(mesh.positions.len()).ok().filter(|first| *first < u32::MAX - 2);
        let first = first.ok_or_else(|| source.malformed(format!("triangle {i}"), "more than 2^32 corners"))?;
        mesh.positions.extend(triangle.vertices.map(|corner| corner.0.map(f64::from)));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Ok(mesh)
}

/// A binary file whose header does not begin as text does.
fn unnamed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes.iter_mut().take(5).for_each(|byte| *byte = b' ');
    bytes
}

/// The facets of all solids of a text as one, in lower case.
fn one_solid(bytes: &[u8], source: Source) -> Result<Vec<u8>> {
    let mut one = b"solid \n".to_vec();
    let mut is_open = false;
    for (number, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let line = line.trim_ascii().to_ascii_lowercase();
        if line.starts_with(b"solid") {
            is_open = true;
        } else if line.starts_with(b"endsolid") || line.starts_with(b"end solid") {
            is_open = false;
        } else if is_open {
            one.extend_from_slice(&line);
            one.push(b'\n');
        } else if !line.is_empty() {
            return Err(source.malformed(format!("line {}", number + 1), "text outside of a solid"));
        }
    }
    if is_open {
        return Err(source.malformed("end", "there is no endsolid; the file is truncated"));
    }
    one.extend_from_slice(b"endsolid\n");
    Ok(one)
}
