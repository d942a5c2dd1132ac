//! Meshes with a field at every point and at every centroid: as a `TetMesh`, or as a rule where cells and values are made when they
//! are asked for.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::grid::Lattice;
use crate::columns::{
    Array, ArrayHead, Association, CellCounts, CellMesh, CellSource, FaceLists, NumericColumn, Points, TetMesh,
};

/// The point array and the cell array of every generated mesh.
const ARRAYS: [(&str, Association); 2] = [("value", Association::Point), ("cell_value", Association::Cell)];

/// The mesh with `field` sampled as the point array `value` and the cell array `cell_value`.
pub(super) fn sample(points: Vec<[f32; 3]>, tets: Vec<[u32; 4]>, field: impl Fn(DVec3) -> f64 + Sync) -> TetMesh {
    let position = |v: u32| Vec3::from_array(points[v as usize]).as_dvec3();
    let value: Vec<f32> = points.par_iter().map(|&p| field(Vec3::from_array(p).as_dvec3()) as f32).collect();
    let cell_value: Vec<f32> = tets
        .par_iter()
        .map(|tet| {
            let [a, b, c, d] = tet.map(position);
            field((a + b + c + d) * 0.25) as f32
        })
        .collect();
    TetMesh {
        file_from_tet: (0..tets.len() as u32).collect(),
        counts: CellCounts { in_file: tets.len() as u64, ..CellCounts::default() },
        arrays: ARRAYS.into_iter().zip([value, cell_value]).map(array).collect(),
        points: Points::F32(points),
        tets: tets.into(),
    }
}

/// The same of polyhedra around `centers`, at which `cell_value` is sampled.
pub(super) fn sample_polyhedra(
    points: Vec<[f32; 3]>,
    polyhedra: FaceLists,
    centers: &[DVec3],
    field: impl Fn(DVec3) -> f64 + Sync,
) -> CellMesh {
    let value: Vec<f32> = points.par_iter().map(|&p| field(Vec3::from_array(p).as_dvec3()) as f32).collect();
    let cell_value: Vec<f32> = centers.par_iter().map(|&p| field(p) as f32).collect();
    CellMesh {
        file_from_polyhedron: (0..polyhedra.cells() as u32).collect(),
        counts: CellCounts { in_file: polyhedra.cells() as u64, ..CellCounts::default() },
        arrays: ARRAYS.into_iter().zip([value, cell_value]).map(array).collect(),
        points: Points::F32(points),
        polyhedra,
        ..CellMesh::empty()
    }
}

fn array(((name, association), values): ((&str, Association), Vec<f32>)) -> Array {
    Array { name: name.to_owned(), association, components: 1, values: NumericColumn::from(values) }
}

/// A field over the unit cube.
pub(super) type Field = Box<dyn Fn(DVec3) -> f64 + Send + Sync>;

/// What [`sample`] makes of a grid, cell by cell.
pub(super) struct GridSource {
    lattice: Lattice,
    points: Points,
    field: Field,
}

impl GridSource {
    pub(super) fn new(lattice: Lattice, field: Field) -> Self {
        Self { points: Points::F32(lattice.points()), lattice, field }
    }
}

impl CellSource for GridSource {
    fn points(&self) -> &Points {
        &self.points
    }

    fn tets(&self) -> usize {
        self.lattice.len()
    }

    fn tet(&self, tet: usize) -> [u32; 4] {
        self.lattice.tet(tet)
    }

    fn file_cell(&self, tet: usize) -> u32 {
        tet as u32
    }

    fn arrays(&self) -> Vec<ArrayHead> {
        let head = |(name, association): (&str, _)| ArrayHead {
            name: name.to_owned(),
            association,
            components: 1,
            type_name: "f32",
        };
        ARRAYS.into_iter().map(head).collect()
    }

    fn append_values(&self, array: usize, tuples: &[u32], bytes: &mut Vec<u8>) {
        let point = |v: u32| self.points.get(v as usize);
        for &tuple in tuples {
            let at = match ARRAYS[array].1 {
                Association::Point => point(tuple),
                Association::Cell => {
                    let [a, b, c, d] = self.lattice.tet(tuple as usize).map(point);
                    (a + b + c + d) * 0.25
                }
            };
            bytes.extend_from_slice(&((self.field)(at) as f32).to_le_bytes());
        }
    }

    fn counts(&self) -> CellCounts {
        CellCounts { in_file: self.lattice.len() as u64, ..CellCounts::default() }
    }
}
