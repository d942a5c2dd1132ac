//! A dataset's whole cells cut into tetrahedra, along the diagonals that their faces have.
//!
//! In: a [`Dataset`]. Out: one of tetrahedra alone. A hexahedron becomes a fan from one of its corners to the triangles of the
//! faces that do not touch it. In the faces that do, every triangle has to have it as a corner; the corner of lowest number in the
//! file is such a one, because each face is cut from its lowest.

use glam::Vec3;
use rayon::prelude::*;

use super::polyhedra::fan;
use super::{CellCounts, Column, Dataset, HexShape, Points, TetMesh, canonical_from_point};
use crate::cells::HEXAHEDRON;
use crate::error::Result;

impl Dataset {
    /// Cuts whole cells into tetrahedra that agree with their neighbours', which draws another field inside a cell; a mesh of
    /// tetrahedra comes back as it is. Polyhedra that a fan from their lowest point does not fill, as some are that are not convex,
    /// are left out and counted as unsupported. Arrays stay, vertices are copied and numbered anew.
    ///
    /// # Errors
    /// Those of [`Dataset::from_tets`].
    ///
    /// ```
    /// # use cellfan::{Points, io::StructuredMesh};
    /// let points: Vec<[f32; 3]> = (0..12).map(|i| [i % 3, i / 3 % 2, i / 6].map(|c| c as f32)).collect();
    /// let mesh = StructuredMesh::new(&[[3, 2, 2]], Points::F32(points), Vec::new())?;
    /// let dataset = mesh.into_whole_dataset()?.into_tetrahedra()?;
    /// assert_eq!((dataset.tets.len(), dataset.hexahedra.len(), dataset.counts.split), (12, 0, 2));
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn into_tetrahedra(self) -> Result<Self> {
        if self.hexahedra.is_empty() && self.polyhedra.is_empty() {
            return Ok(self);
        }
        let points = Points::F32(self.positions.to_vec());
        let canonical = canonical_from_point(&points);
        let (first, hexahedra) = (self.tets.len(), self.hexahedra.view());
        let of_hexahedron = |cell: usize| {
            let tets =
                split_hexahedron(hexahedra.get(cell), hexahedra.shape(cell), |vertex| canonical[vertex as usize]);
            tets.map(move |tet| (tet, (first + cell) as u32))
        };
        let (first_polyhedron, polyhedra) = (self.first_polyhedron(), self.polyhedra.view());
        let position = |vertex: u32| Vec3::from_array(self.positions[vertex as usize]);
        let fans: Vec<Option<Vec<[u32; 4]>>> =
            (0..polyhedra.len()).into_par_iter().map(|cell| fan(polyhedra.faces(cell), position)).collect();
        let unsupported = fans.iter().filter(|fan| fan.is_none()).count() as u64;
        let of_polyhedron = |(cell, fan): (usize, Option<Vec<[u32; 4]>>)| {
            fan.into_iter().flatten().map(move |tet| (tet, (first_polyhedron + cell) as u32))
        };
        let fans = fans.into_par_iter().enumerate().flat_map_iter(of_polyhedron);
        let whole = (0..self.tets.len()).into_par_iter().map(|cell| (self.tets.get(cell), cell as u32));
        let cut = (0..hexahedra.len()).into_par_iter().flat_map_iter(of_hexahedron);
        let (tets, cell_from_tet): (Vec<[u32; 4]>, Vec<u32>) = whole.chain(cut).chain(fans).unzip();
        drop(canonical);

        // Arrays stay in their order: what is numbered anew is led back to it.
        let counts = CellCounts::default();
        let mesh =
            TetMesh { points, tets: tets.into(), file_from_tet: cell_from_tet.into(), arrays: Vec::new(), counts };
        let tetrahedra = Self::from_tets(mesh)?;
        let through = |map: &Option<Column<u32>>, tuple: &dyn Fn(usize) -> usize| {
            map.as_ref().map(|map| map.iter().map(|&old| tuple(old as usize) as u32).collect())
        };
        Ok(Self {
            origin: self.origin + tetrahedra.origin,
            file_from_vertex: through(&tetrahedra.file_from_vertex, &|vertex| self.point_tuple(vertex)),
            file_from_cell: through(&tetrahedra.file_from_cell, &|cell| self.cell_tuple(cell)),
            counts: CellCounts {
                split: self.counts.split + (self.cells() - self.tets.len() - self.hexahedra.absent()) as u64
                    - unsupported,
                unsupported: self.counts.unsupported + unsupported,
                degenerate: self.counts.degenerate + tetrahedra.counts.degenerate,
                ..self.counts
            },
            arrays: self.arrays,
            read_bytes: self.read_bytes,
            backing: self.backing,
            ..tetrahedra
        })
    }
}

/// The tetrahedra of a hexahedron with these corners, compared by `canonical`; none where it is not drawn.
///
/// Where no corner is in every triangle of its faces, as in no cell whose faces are cut by the rule, the tetrahedra overlap.
pub(crate) fn split_hexahedron(
    corners: [u32; 8],
    shape: HexShape,
    canonical: impl Fn(u32) -> u32,
) -> impl Iterator<Item = [u32; 4]> {
    let number = corners.map(canonical);
    let of = |triangle: [u8; 3]| triangle.map(|corner| number[usize::from(corner)]);
    let has_area = |&triangle: &[u8; 3]| {
        let [a, b, c] = of(triangle);
        a != b && b != c && c != a
    };
    let missing = |apex: u32, face: usize| {
        let touches = HEXAHEDRON.faces[face].iter().any(|&corner| number[usize::from(corner)] == apex);
        let misses =
            shape.triangles(face).into_iter().filter(has_area).filter(|&triangle| !of(triangle).contains(&apex));
        if touches { misses.count() } else { 0 }
    };
    let rank = |&corner: &usize| {
        let apex = number[corner];
        ((0..6).map(|face| missing(apex, face)).sum::<usize>(), apex)
    };
    let apex = (0..8).min_by_key(rank).unwrap_or(0);
    let mut tets = arrayvec::ArrayVec::<[u32; 4], 12>::new();
    if !shape.is_absent() {
        let all = (0..6).flat_map(|face| shape.triangles(face)).filter(has_area);
        let fan = all.filter(|&triangle| !of(triangle).contains(&number[apex]));
        tets.extend(fan.map(|triangle| {
            let [a, b, c] = triangle.map(|corner| corners[usize::from(corner)]);
            [corners[apex], a, b, c]
        }));
    }
    tets.into_iter()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::cells;

    fn place(i: u32) -> Vec3 {
        Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)
    }

    /// Corner i of VTK's hexahedron as a corner of the cube numbered by its bits.
    const CUBE: [u32; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

    #[test]
    fn a_fan_along_the_shape_s_diagonals_is_the_split_of_the_file_s_cell() {
        let sorted = |mut tet: [u32; 4]| {
            tet.sort_unstable();
            tet
        };
        for turn in 0..40_320_u32 {
            // Every numbering of the corners, as a numeral of the factorial base.
            let (mut left, mut rest) = ((0..8).collect::<Vec<u32>>(), turn);
            let number: [u32; 8] = std::array::from_fn(|i| {
                let n = 8 - i as u32;
                let digit = rest % n;
                rest /= n;
                left.remove(digit as usize)
            });
            let of = |corner: u32| number[corner as usize];
            let shape = HexShape::new(CUBE.map(place), CUBE.map(of));
            let found: BTreeSet<_> = split_hexahedron(CUBE, shape, of).map(sorted).collect();
            let mut expected = BTreeSet::new();
            cells::split(&HEXAHEDRON, &CUBE, of, |tet| {
                expected.insert(sorted(tet));
            });
            assert_eq!(found, expected, "{number:?}");
        }
    }

    #[test]
    fn any_shape_fills_the_cell_and_collapsed_ones_repeat_no_corner() {
        let volume = |tets: &[[u32; 4]]| -> f32 {
            let of = |tet: &[u32; 4]| {
                let [a, b, c, d] = tet.map(place);
                (b - a).cross(c - a).dot(d - a) / 6.0
            };
            tets.iter().map(of).sum()
        };
        for bits in 0..64_u16 {
            let shape: HexShape = bytemuck::cast(bits);
            let tets: Vec<_> = split_hexahedron(CUBE, shape, |vertex| vertex).collect();
            assert!((volume(&tets) - 1.0).abs() < 1e-6, "{bits:06b}: {}", volume(&tets));
        }
        // A pyramid over the cube's bottom, its tip at corner 7.
        let pyramid = [0, 1, 3, 2, 7, 7, 7, 7];
        let shape = HexShape::new(pyramid.map(place), pyramid);
        let tets: Vec<_> = split_hexahedron(pyramid, shape, |vertex| vertex).collect();
        assert_eq!(tets.len(), 2);
        assert!((volume(&tets).abs() - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(split_hexahedron(CUBE, HexShape::ABSENT, |vertex| vertex).count(), 0);
    }
}
