//! The faces of polyhedra in `.vtu` files, in the two forms they have.

use super::super::face_streams::{POLYHEDRON, push_stream};
use super::super::numbers::whole_numbers;
use super::super::source::Source;
use super::{Element, Encoding};
use crate::columns::{Column, FaceLists};
use crate::error::Result;

/// The faces of the cells of `types`, which the element `cells` lists.
pub(in crate::io) fn faces(
    cells: &Element<'_>,
    types: &[u8],
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<FaceLists> {
    if !types.contains(&POLYHEDRON) {
        return Ok(FaceLists::default());
    }
    let find = |name: &str| cells.children_named("DataArray").find(|array| array.attribute("Name") == Some(name));
    match (find("faces"), find("face_connectivity")) {
        (Some(faces), _) => streams(cells, (faces, find("faceoffsets")), types, encoding, source),
        (None, Some(points)) => {
            let arrays = ["face_offsets", "polyhedron_to_faces", "polyhedron_offsets"].map(find);
            lists(cells, (points, arrays), types, encoding, source)
        }
        (None, None) => {
            let problem = "holds polyhedra, but no <DataArray> \"faces\" or \"face_connectivity\"";
            Err(source.malformed(cells.place(), problem))
        }
    }
}

/// A stream for each polyhedron, which ends where its offset says.
fn streams(
    cells: &Element<'_>,
    (faces, ends): (&Element<'_>, Option<&Element<'_>>),
    types: &[u8],
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<FaceLists> {
    let ends = ends.ok_or_else(|| source.malformed(cells.place(), "holds no <DataArray> \"faceoffsets\""))?;
    let stream: Column<u32> = numbers(faces, None, encoding, source)?;
    let end_from_cell = encoding.values(ends, Some(types.len()))?;
    let mut lists = FaceLists::default();
    let mut start = 0;
    for (cell, &kind) in types.iter().enumerate() {
        let end = end_from_cell.get(cell);
        if kind != POLYHEDRON {
            lists.end_cell();
            // Some writers repeat the last end, others say −1.
            continue;
        }
        let own = (end >= start as f64 && end <= stream.len() as f64).then(|| &stream[start..end as usize]);
        let own = own.ok_or_else(|| {
            let problem = format!("cell {cell} would end at entry {end} of {}: damaged or truncated", stream.len());
            source.malformed(ends.place(), problem)
        })?;
        start = end as usize;
        push_stream(own, &mut lists)
            .map_err(|problem| source.malformed(faces.place(), format!("cell {cell} {problem}")))?;
    }
    Ok(lists)
}

/// All faces in one list, and for each cell the numbers of its faces: where each ends.
fn lists(
    cells: &Element<'_>,
    (points, others): (&Element<'_>, [Option<&Element<'_>>; 3]),
    types: &[u8],
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<FaceLists> {
    let [Some(face_ends), Some(faces), Some(ends)] = others else {
        let problem =
            "needs \"face_offsets\", \"polyhedron_to_faces\" and \"polyhedron_offsets\" beside \"face_connectivity\"";
        return Err(source.malformed(cells.place(), problem));
    };
    let points: Column<u32> = numbers(points, None, encoding, source)?;
    let end_from_face: Column<u64> = numbers(face_ends, None, encoding, source)?;
    let face_from_entry: Column<u64> = numbers(faces, None, encoding, source)?;
    let end_from_cell: Column<u64> = numbers(ends, Some(types.len()), encoding, source)?;
    let range = |ends: &[u64], i: usize, len: usize| {
        let start = i.checked_sub(1).map_or(0, |before| ends[before]);
        (start <= ends[i] && ends[i] <= len as u64).then(|| start as usize..ends[i] as usize)
    };
    let mut lists = FaceLists::default();
    for (cell, &code) in types.iter().enumerate() {
        let damaged = |of: &Element<'_>, what: String| {
            source.malformed(of.place(), format!("cell {cell}: {what}: damaged or truncated"))
        };
        let entries = range(&end_from_cell, cell, face_from_entry.len())
            .ok_or_else(|| damaged(ends, "its list of faces has no such end".to_owned()))?;
        if code == POLYHEDRON {
            for &face in &face_from_entry[entries] {
                let known = usize::try_from(face).ok().filter(|&face| face < end_from_face.len());
                let own = known.and_then(|face| range(&end_from_face, face, points.len()));
                let own =
                    own.ok_or_else(|| damaged(face_ends, format!("its face {face} is not there or has no end")))?;
                lists.push_face(&points[own]);
            }
        }
        lists.end_cell();
    }
    Ok(lists)
}

/// The whole numbers of an array.
fn numbers<T: TryFrom<u64> + bytemuck::Pod>(
    array: &Element<'_>,
    count: Option<usize>,
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<Column<T>> {
    let limit = if size_of::<T>() == 4 { u64::from(u32::MAX) } else { i64::MAX as u64 };
    let values = encoding.values(array, count)?;
    whole_numbers(&values, limit, source.scratch, |i, found| {
        source.malformed(array.place(), format!("value {i} is {found}, which is no number from 0 to {limit}"))
    })
}
