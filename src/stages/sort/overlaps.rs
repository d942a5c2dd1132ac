//! `overlaps`: the faces at which cells of a mesh overlap. Once a mesh.
//!
//! In: cells, their [`Adjacency`]. Out: how many faces. A face of four corners is two triangles; where what lies across it is cut along
//! the other diagonal, the two cells do not adjoin, and between the two surfaces lies a tetrahedron: in both cells where the face folds
//! outwards, in neither where it folds inwards. No order of such cells is right on the rays through it.
//!
//! What else may overlap is not looked for: faces with hanging nodes, meshes in one picture. O(f log f) for f exterior faces.

use glam::Vec3;
use rayon::prelude::*;

use super::adjacency::{Adjacency, Face};
use super::faces::triangles;
use crate::columns::{Dataset, place};

/// Cells that overlap by less, in diagonals of the mesh, are as good as side by side: what the check of fragments allows too
/// (`ORDER_SLACK`), and some thirty times what narrowing positions to f32 does to a plane face.
const SLACK: f64 = 2e-6;

/// Where a triangle is: the bits of its corners, ascending. Cells may have vertices of their own at one place.
type Place = [[u32; 3]; 3];

fn place_of(corners: [Vec3; 3]) -> Place {
    let mut places = corners.map(|corner| place(corner.to_array()));
    places.sort_unstable();
    places
}

/// Counts the faces of four corners that reach into a cell across them which is cut along the other diagonal.
pub fn overlapping_faces(dataset: &Dataset, adjacency: &Adjacency) -> u64 {
    if dataset.hexahedra.is_empty() {
        return 0;
    }
    let position = |v: u32| Vec3::from_array(dataset.positions[v as usize]);
    let of_face = |face: &Face| triangles(dataset, face.cell as usize, face.index as usize);
    let exterior = adjacency.exterior().par_iter();
    let mut places: Vec<Place> =
        exterior.clone().flat_map_iter(of_face).map(|triangle| place_of(triangle.map(position))).collect();
    places.par_sort_unstable();

    let least = SLACK * dataset.diagonal_world();
    let overlaps = |face: &&Face| {
        let [[a, b, c], [.., d]] = of_face(face)[..] else { return false };
        let [a, b, c, d] = [a, b, c, d].map(position);
        // How far the diagonal a b, by which the face is cut, lies outside of the other one where it passes over it.
        let outward = (b - a).as_dvec3().cross((c - d).as_dvec3());
        let height = (a - c).as_dvec3().dot(outward) / outward.length();
        height > least && [a, b].into_iter().any(|end| places.binary_search(&place_of([c, d, end])).is_ok())
    };
    exterior.filter(overlaps).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::HEXAHEDRON;
    use crate::columns::{Column, Points};
    use crate::io::UnstructuredMesh;

    /// A box whose top is cut from vertex 4 to vertex 6, these two raised; on it two tetrahedra, along that diagonal or the other.
    fn box_and_tets(raised: f32, along_its_diagonal: bool) -> Dataset {
        let top = |x, y, raised| [x, y, 1.0 + raised];
        let points = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            top(0.0, 0.0, raised),
            top(1.0, 0.0, 0.0),
            top(1.0, 1.0, raised),
            top(0.0, 1.0, 0.0),
            [0.5, 0.5, 2.0],
        ];
        let tets = if along_its_diagonal { [[4, 5, 6, 8], [4, 6, 7, 8]] } else { [[4, 5, 7, 8], [5, 6, 7, 8]] };
        let connectivity: Vec<u32> = (0..8).chain(tets.into_iter().flatten()).collect();
        let mesh = UnstructuredMesh {
            points: Points::F32(points),
            types: vec![HEXAHEDRON.code, 10, 10].into(),
            offsets: Column::from(vec![0, 8, 12, 16]),
            connectivity: connectivity.into(),
            arrays: Vec::new(),
            ..UnstructuredMesh::empty()
        };
        mesh.into_whole_dataset().unwrap()
    }

    #[test]
    fn a_face_that_folds_outwards_reaches_into_what_is_cut_otherwise() {
        let found = |raised: f32, along_its_diagonal: bool| {
            let dataset = box_and_tets(raised, along_its_diagonal);
            overlapping_faces(&dataset, &Adjacency::new(&dataset))
        };
        assert_eq!(found(0.1, false), 1);
        // A gap, a plane, a plane but for rounding, and cells that adjoin.
        assert_eq!(
            [found(-0.1, false), found(0.0, false), found(1e-6, false), found(0.1, true), found(-0.1, true)],
            [0; 5]
        );
    }

    #[test]
    fn zeros_of_both_signs_are_one_place() {
        let [a, b] = [Vec3::new(0.0, 1.0, 2.0), Vec3::new(-0.0, 1.0, 2.0)];
        assert_eq!(place_of([a, Vec3::X, Vec3::Y]), place_of([Vec3::Y, b, Vec3::X]));
    }
}
