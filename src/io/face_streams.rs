//! Face streams: how VTK writes the faces of a polyhedron in one list. Their number, then for each how many points it has, and these.
//!
//! In: streams, or (from version 2.3 of XML files) lists of faces and of the faces of each cell. Out: [`FaceLists`]. Whether the points
//! exist is checked with the cells.

use crate::columns::FaceLists;

/// VTK's code of a polyhedron.
pub(super) const POLYHEDRON: u8 = 42;

/// Adds the cell with the faces of `stream`; the error is a sentence about it.
pub(super) fn push_stream(stream: &[u32], lists: &mut FaceLists) -> Result<(), String> {
    let (&faces, mut rest) = stream.split_first().ok_or("has no list of faces")?;
    for face in 0..faces {
        let problem = || format!("has a list of {faces} faces that ends in face {face}: damaged or truncated");
        let (&count, after) = rest.split_first().ok_or_else(problem)?;
        let (points, after) = after.split_at_checked(count as usize).ok_or_else(problem)?;
        lists.push_face(points);
        rest = after;
    }
    if !rest.is_empty() {
        return Err(format!("has {} values left after its list of {faces} faces: damaged", rest.len()));
    }
    lists.end_cell();
    Ok(())
}

/// The points of the faces of cell `cell`, each once, in the order in which they first come.
pub(super) fn points_of(lists: &FaceLists, cell: usize, points: &mut Vec<u32>) {
    points.clear();
    points.extend(lists.faces(cell).flatten());
    points.sort_unstable();
    points.dedup();
}

/// The streams of all cells one after the other, and where that of each ends; −1 of a cell without faces.
pub(super) fn streams_of(lists: &FaceLists, cells: usize) -> (Vec<i64>, Vec<i64>) {
    let (mut streams, mut ends) = (Vec::new(), Vec::with_capacity(cells));
    for cell in 0..cells {
        let faces = lists.faces(cell);
        if faces.len() == 0 {
            ends.push(-1);
            continue;
        }
        streams.push(faces.len() as i64);
        for face in faces {
            streams.push(face.len() as i64);
            streams.extend(face.iter().map(|&point| i64::from(point)));
        }
        ends.push(streams.len() as i64);
    }
    (streams, ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_read_as_they_are_written_and_damage_is_said() {
        let mut lists = FaceLists::default();
        lists.end_cell();
        push_stream(&[2, 3, 7, 8, 9, 4, 9, 8, 7, 6], &mut lists).unwrap();
        let (streams, ends) = streams_of(&lists, 3);
        assert_eq!((streams, ends), (vec![2, 3, 7, 8, 9, 4, 9, 8, 7, 6], vec![-1, 10, -1]));
        for (stream, problem) in [
            (&[][..], "no list"),
            (&[2, 3, 7, 8, 9], "ends in face 1"),
            (&[1, 3, 7, 8], "ends in face 0"),
            (&[1, u32::MAX, 7, 8], "ends in face 0"),
            (&[1, 3, 7, 8, 9, 1], "1 values left"),
        ] {
            let error = push_stream(stream, &mut FaceLists::default()).unwrap_err();
            assert!(error.contains(problem), "{stream:?}: {error}");
        }
    }
}
