//! [`Mates`]: what a ray that leaves a tetrahedron finds across the face. Once a mesh.
//!
//! In: the cells and their neighbours. Out: for each face the other cell's number of it, and that cell's vertex that is not on it. One
//! look-up a step then says which cell the ray is in, through which of its faces it came, and the one vertex that is new to it.

use rayon::prelude::*;

use crate::columns::Dataset;
use crate::stages::sort::adjacency::{Adjacency, Face};

/// A face: four times its cell, plus the vertex of the cell opposite to it, 0 to 3.
pub(super) type FaceNumber = u32;

/// Across an exterior face.
pub(super) const OUTSIDE: FaceNumber = FaceNumber::MAX;

/// Across a face: the number of the same face among the other cell's, [`OUTSIDE`] if there is none, and the other cell's vertex opposite
/// to it.
pub(super) type Mate = [u32; 2];

/// What lies across each face of a mesh of tetrahedra.
#[derive(Clone, Debug)]
pub struct Mates {
    /// By face number.
    pub(super) of_face: Vec<Mate>,
    /// The faces by which rays come in and go.
    pub(super) exterior: Vec<Face>,
}

impl Mates {
    /// Most cells of a mesh: the numbers of their faces fit 31 bits.
    pub const MAX_CELLS: usize = (i32::MAX / 4) as usize;

    /// The mates of the faces of `dataset`, whose neighbours `adjacency` knows, in parallel. 32 bytes a cell.
    ///
    /// Where two cells do not share three vertices, as of neighbours that a container tells wrong, the face counts as exterior.
    ///
    /// # Panics
    /// If there are more than [`Mates::MAX_CELLS`] tetrahedra.
    ///
    /// ```
    /// # use cellfan::backends::cpu::Mates;
    /// # use cellfan::stages::sort::adjacency::Adjacency;
    /// # use cellfan::{Dataset, generate};
    /// let dataset = Dataset::from_tets(generate::tets(&generate::Settings { cells: 1_000, ..Default::default() })?)?;
    /// let mates = Mates::new(&dataset, &Adjacency::new(&dataset));
    /// assert_eq!(mates.bytes() / dataset.cells() as u64, 32);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn new(dataset: &Dataset, adjacency: &Adjacency) -> Self {
        let (tets, neighbours) = (dataset.tets.view(), adjacency.neighbours_from_tet());
        assert!(neighbours.len() <= Self::MAX_CELLS, "numbers of faces have 31 bits");
        let mut of_face = vec![[OUTSIDE; 2]; 4 * neighbours.len()];
        of_face.par_chunks_mut(4).zip(neighbours).enumerate().for_each(|(cell, (mates, neighbours))| {
            let mine = tets.get(cell);
            for (k, (mate, &other)) in mates.iter_mut().zip(neighbours).enumerate() {
                *mate = mate_of(mine, k, (other != Adjacency::NONE).then(|| (other, tets.get(other as usize))));
            }
        });
        Self { of_face, exterior: adjacency.exterior().to_vec() }
    }

    /// Bytes of memory that the faces take.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.of_face[..]) as u64
    }
}

/// What lies across the face opposite to vertex `k` of the cell with vertices `mine`, where the other cell is `other` with its vertices.
fn mate_of(mine: [u32; 4], k: usize, other: Option<(u32, [u32; 4])>) -> Mate {
    let Some((cell, theirs)) = other else { return [OUTSIDE, 0] };
    let is_shared = |vertex: u32| (0..4).any(|i| i != k && mine[i] == vertex);
    let mut apexes = (0..4).filter(|&i| !is_shared(theirs[i]));
    match (apexes.next(), apexes.next()) {
        (Some(apex), None) => [4 * cell + apex as u32, theirs[apex]],
        _ => [OUTSIDE, 0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate;

    #[test]
    fn the_mate_of_a_mate_is_the_face_itself() {
        let settings = generate::Settings { cells: 3_000, ..Default::default() };
        let dataset = Dataset::from_tets(generate::tets(&settings).unwrap()).unwrap();
        let mates = Mates::new(&dataset, &Adjacency::new(&dataset));
        let mut outside = 0;
        for (face, &[mate, apex]) in mates.of_face.iter().enumerate() {
            if mate == OUTSIDE {
                outside += 1;
                continue;
            }
            assert_eq!(mates.of_face[mate as usize][0] as usize, face);
            assert_eq!(dataset.tets.view().get(mate as usize / 4)[mate as usize % 4], apex);
            assert!(!dataset.tets.view().get(face / 4).contains(&apex));
        }
        assert!(outside > 0 && outside == mates.exterior.len());
    }

    #[test]
    fn cells_without_three_vertices_in_common_are_no_neighbours() {
        assert_eq!(mate_of([0, 1, 2, 3], 0, Some((7, [1, 2, 3, 9]))), [31, 9]);
        assert_eq!(mate_of([0, 1, 2, 3], 1, Some((7, [1, 2, 3, 9]))), [OUTSIDE, 0]);
        assert_eq!(mate_of([0, 1, 2, 3], 1, None), [OUTSIDE, 0]);
    }
}
