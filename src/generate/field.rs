//! From points, tetrahedra and a field to a `TetMesh`: the field at every point and at every centroid.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::columns::{Array, Association, CellCounts, NumericColumn, Points, TetMesh};

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
    let array = |name: &str, association, values: Vec<f32>| Array {
        name: name.to_owned(),
        association,
        components: 1,
        values: NumericColumn::from(values),
    };
    TetMesh {
        file_from_tet: (0..tets.len() as u32).collect(),
        counts: CellCounts { in_file: tets.len() as u64, ..CellCounts::default() },
        arrays: vec![array("value", Association::Point, value), array("cell_value", Association::Cell, cell_value)],
        points: Points::F32(points),
        tets,
    }
}
