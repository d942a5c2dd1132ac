//! `DATASET UNSTRUCTURED_GRID`.

use super::super::UnstructuredMesh;
use super::super::numbers::{points_from, whole_numbers};
use super::attributes::Attributes;
use super::cells::Cells;
use super::cursor::Cursor;
use super::read_common;
use crate::columns::FaceLists;
use crate::error::Result;
use crate::io::face_streams::{POLYHEDRON, points_of, push_stream};
use crate::io::source::Source;

/// Reads the sections after the head of the file.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<UnstructuredMesh> {
    let source = cursor.source;
    let mut mesh = UnstructuredMesh::empty();
    let mut attributes = Attributes::default();
    let mut cells = None;
    let mut types = None;
    while let Some(keyword) = cursor.next_keyword() {
        match keyword.as_str() {
            "POINTS" => {
                let count = cursor.count("the number of points")?;
                let number = cursor.number_type()?;
                mesh.points = points_from(&cursor.tuples(number, count, 3)?);
            }
            "CELLS" => cells = Some(Cells::read(cursor)?),
            "CELL_TYPES" => {
                let count = cursor.count("the number of cells")?;
                types = Some(cursor.integers(count)?);
            }
            _ => read_common(&keyword, &mut attributes, cursor)?,
        }
    }

    let cells = cells.unwrap_or_else(Cells::none);
    let types = types.unwrap_or_else(|| Vec::<i32>::new().into());
    if types.len() != cells.count() {
        let problem = format!("names {} cells where CELLS has {}: damaged or truncated", types.len(), cells.count());
        return Err(source.malformed("CELL_TYPES", problem));
    }
    let bad = |cell, code| source.malformed("CELL_TYPES", format!("cell {cell} has type {code}"));
    mesh.types = whole_numbers(&types, 255, source.scratch, bad)?;
    (mesh.offsets, mesh.connectivity) = cells.into_columns(mesh.points.len() as u64, source)?;
    read_faces(&mut mesh, source)?;
    mesh.arrays = attributes.into_arrays(mesh.points.len(), mesh.types.len(), source)?;
    Ok(mesh)
}

/// Takes the streams of faces that polyhedra have in the place of points; their points come there.
fn read_faces(mesh: &mut UnstructuredMesh, source: Source<'_>) -> Result<()> {
    if !mesh.types.contains(&POLYHEDRON) {
        return Ok(());
    }
    let (mut offsets, mut connectivity) = (source.scratch.column(), source.scratch.column());
    let (mut faces, mut points) = (FaceLists::default(), Vec::new());
    offsets.push(0)?;
    for (cell, &code) in mesh.types.iter().enumerate() {
        let list = mesh.cell(cell).unwrap_or_default();
        if code == POLYHEDRON {
            push_stream(list, &mut faces)
                .map_err(|problem| source.malformed("CELLS", format!("cell {cell} {problem}")))?;
            points_of(&faces, cell, &mut points);
            connectivity.extend(points.iter().copied())?;
        } else {
            faces.end_cell();
            connectivity.extend(list.iter().copied())?;
        }
        offsets.push(connectivity.len() as u64)?;
    }
    (mesh.offsets, mesh.connectivity, mesh.faces) = (offsets.finish()?, connectivity.finish()?, faces);
    Ok(())
}
