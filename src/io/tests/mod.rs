//! Tests over several files of this room: every encoding reads alike, what is damaged is refused.

mod assemble;
mod blocks;
mod collection;
mod join;
mod legacy;
mod legacy_grids;
mod malformed;
mod samples;
mod structured;
mod volumes;
mod writer;
mod xml;

use std::path::Path;

use super::*;
use crate::columns::{Array, Association, NumericColumn, Points};

const NAME: &str = "sample";

fn vtu(bytes: &[u8]) -> Result<UnstructuredMesh> {
    read_vtu(bytes, Path::new(NAME))
}

fn vtk(bytes: &[u8]) -> Result<UnstructuredMesh> {
    read_vtk(bytes, Path::new(NAME)).map(unstructured)
}

fn unstructured(mesh: Mesh) -> UnstructuredMesh {
    match mesh {
        Mesh::Unstructured(mesh) => mesh,
        Mesh::Structured(mesh) => panic!("blocks {:?}", mesh.blocks()),
        Mesh::Volume(volume) => panic!("a volume {:?}", volume.dims),
    }
}

fn structured(mesh: Mesh) -> StructuredMesh {
    match mesh {
        Mesh::Structured(mesh) => mesh,
        Mesh::Unstructured(mesh) => panic!("{} cells in no block", mesh.cells()),
        Mesh::Volume(volume) => panic!("a volume {:?}", volume.dims),
    }
}

fn values(column: &NumericColumn) -> Vec<f64> {
    (0..column.len()).map(|i| column.get(i)).collect()
}

/// Panics where the meshes differ in anything but the types of numbers.
fn assert_same(a: &UnstructuredMesh, b: &UnstructuredMesh, what: &str) {
    let points = |mesh: &UnstructuredMesh| (0..mesh.points.len()).map(|i| mesh.points.get(i)).collect::<Vec<_>>();
    assert_eq!(points(a), points(b), "{what}");
    assert_eq!((&a.types, &a.offsets, &a.connectivity), (&b.types, &b.offsets, &b.connectivity), "{what}");
    let arrays = |mesh: &UnstructuredMesh| {
        let key = |a: &Array| (a.name.clone(), a.association == Association::Cell, a.components);
        mesh.arrays.iter().map(|array| (key(array), values(&array.values))).collect::<Vec<_>>()
    };
    assert_eq!(arrays(a), arrays(b), "{what}");
}
