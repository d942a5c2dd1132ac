//! Polyhedra of a file: lists that were written once, read through before they are used as slices.

use std::collections::HashMap;

use glam::Vec3;

use super::{Most, Polyhedra, PolyhedraColumns, PolyhedraView};

impl Polyhedra {
    /// The cells in `columns`, of so many vertices: where each list ends before it begins, every number is that of a vertex or of a face,
    /// corners ascend.
    ///
    /// # Errors
    /// Which column is wrong, and what is.
    pub(crate) fn in_file(columns: PolyhedraColumns, vertices: usize) -> Result<Self, (&'static str, String)> {
        let PolyhedraColumns { starts, sides, corners, face_starts, around } = &columns;
        let ends = |last: &[u32; 2]| last.map(|end| end as usize) == [sides.len(), corners.len()];
        if starts.first() != Some(&[0; 2]) || !starts.last().is_some_and(ends) {
            return Err(("starts of polyhedra", "it does not span their faces and corners".to_owned()));
        }
        if face_starts.first() != Some(&0) || face_starts.last().is_none_or(|&end| end as usize != around.len()) {
            return Err(("starts of faces", "it does not span the corners of faces".to_owned()));
        }
        if let Some(face) =
            face_starts.windows(2).position(|two| two[0].checked_add(3).is_none_or(|least| two[1] < least))
        {
            return Err(("starts of faces", format!("face {face} has fewer than three corners")));
        }
        let faces = face_starts.len() - 1;
        if let Some(place) = around.iter().position(|&vertex| vertex as usize >= vertices) {
            return Err(("corners of faces", format!("place {place} names a vertex that there is none of")));
        }
        let mut most = Most::default();
        // Each side of a face is one cell's: what all cells have is bounded by what the file has.
        let mut is_taken = vec![false; 2 * faces];
        for (cell, two) in starts.windows(2).enumerate() {
            let [[side, corner], [side_end, corner_end]] =
                [two[0], two[1]].map(|start| start.map(|start| start as usize));
            let wrong = |problem: &str| Err(("starts of polyhedra", format!("cell {cell} of them {problem}")));
            // The last one ends where the lists do, so those between stay in them as long as they ascend.
            let (Some(of_cell), Some(corners_of_cell)) = (sides.get(side..side_end), corners.get(corner..corner_end))
            else {
                return wrong("ends before it begins");
            };
            if of_cell.is_empty() || corners_of_cell.is_empty() {
                return wrong("has no face or no corner");
            }
            for &side in of_cell {
                match is_taken.get_mut(side as usize) {
                    Some(is_taken) if !*is_taken => *is_taken = true,
                    _ => {
                        let problem =
                            format!("cell {cell} of them names a face that there is none of, or that another has");
                        return Err(("faces of polyhedra", problem));
                    }
                }
            }
            let last = corners_of_cell[corners_of_cell.len() - 1];
            if !corners_of_cell.is_sorted_by(|a, b| a < b) || last as usize >= vertices {
                return Err((
                    "corners of polyhedra",
                    format!("cell {cell} of them has vertices that do not ascend, or are none"),
                ));
            }
            let corners_of = |&side: &u32| {
                let face = side as usize / 2;
                (face_starts[face + 1] - face_starts[face]) as usize
            };
            most = most.max(Most::of_cell(of_cell.len(), corners_of_cell.len(), of_cell.iter().map(corners_of).sum()));
        }
        Ok(Self { columns, most })
    }
}

impl PolyhedraView<'_> {
    /// What is wrong with cell `cell`, whose vertices stand at `position`, if it is not closed or has other corners than its faces.
    pub(crate) fn problem_of(&self, cell: usize, position: impl Fn(u32) -> Vec3) -> Option<&'static str> {
        let mut corners: Vec<u32> = self.faces(cell).flat_map(|face| face.around).copied().collect();
        corners.sort_unstable();
        corners.dedup();
        if corners != self.corners(cell) {
            return Some("its corners are not those of its faces");
        }
        // Coincident vertices are one.
        let place = |v: u32| position(v).to_array().map(|x| (x + 0.0).to_bits());
        let mut balance: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        for [a, b, c] in self.faces(cell).flat_map(super::PolyFace::triangles).map(|triangle| triangle.map(place)) {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *balance.entry([from.min(to), from.max(to)]).or_insert(0) += if from < to { 1 } else { -1 };
            }
        }
        if balance.iter().any(|([a, b], &sum)| sum != 0 && a != b) {
            return Some("its faces do not close it");
        }
        (self.volume(cell, position) <= 0.0).then_some("it has no volume, or is turned inside out")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tetrahedra on either side of a face.
    fn columns() -> PolyhedraColumns {
        PolyhedraColumns {
            starts: vec![[0, 0], [4, 4], [8, 8]].into(),
            sides: vec![0, 2, 4, 6, 1, 8, 10, 12].into(),
            corners: vec![0, 1, 2, 3, 0, 1, 2, 4].into(),
            face_starts: (0..=7).map(|i| 3 * i).collect(),
            around: vec![0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2, 0, 4, 1, 1, 4, 2, 0, 2, 4].into(),
        }
    }

    fn place(v: u32) -> Vec3 {
        [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Z][v as usize]
    }

    #[test]
    fn lists_are_checked() {
        let polyhedra = Polyhedra::in_file(columns(), 5).unwrap();
        assert_eq!(polyhedra.most(), Most { triangles: 4, corners: 4, around: 12 });
        let view = polyhedra.view();
        assert_eq!([0, 1].map(|cell| view.problem_of(cell, place)), [None; 2]);
        for (change, column) in [
            ((|c| c.starts.to_mut()[1] = [9, 4]) as fn(&mut PolyhedraColumns), "starts of polyhedra"),
            (|c| c.starts.to_mut()[1] = [0, 4], "starts of polyhedra"),
            (|c| c.starts.to_mut()[2] = [8, 7], "starts of polyhedra"),
            (|c| c.sides.to_mut()[2] = 14, "faces of polyhedra"),
            (|c| c.sides.to_mut()[2] = 0, "faces of polyhedra"),
            (|c| c.corners.to_mut()[1] = 0, "corners of polyhedra"),
            (|c| c.corners.to_mut()[7] = 5, "corners of polyhedra"),
            (|c| c.face_starts.to_mut()[1] = 2, "starts of faces"),
            (|c| c.face_starts.to_mut()[1] = u32::MAX, "starts of faces"),
            (|c| c.around.to_mut()[3] = 5, "corners of faces"),
        ] {
            let mut columns = columns();
            change(&mut columns);
            assert_eq!(Polyhedra::in_file(columns, 5).unwrap_err().0, column);
        }
        let problem = |change: &dyn Fn(&mut PolyhedraColumns)| {
            let mut columns = columns();
            change(&mut columns);
            Polyhedra::in_file(columns, 5).unwrap().view().problem_of(0, place)
        };
        assert_eq!(problem(&|c| c.corners.to_mut()[3] = 4), Some("its corners are not those of its faces"));
        assert_eq!(problem(&|c| c.sides.to_mut()[1] = 3), Some("its faces do not close it"));
        let is_turned = problem(&|c| c.sides.to_mut().copy_from_slice(&[1, 3, 5, 7, 0, 8, 10, 12]));
        assert!(is_turned.unwrap().starts_with("it has no volume"));
    }
}
