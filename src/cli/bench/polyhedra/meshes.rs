//! The meshes of figure 4, as hexahedra and as polyhedra.
//!
//! Two stand in the literature: they are read where a folder has them, else grids of as many points with the density of C60 stand for them.
//! Two are phenomena of the paper's own, and generated.

use std::f64::consts::PI;
use std::path::Path;

use cellfan::cells::HEXAHEDRON;
use cellfan::columns::{Array, Association, CellCounts, CellMesh, FaceLists, NumericColumn};
use cellfan::generate::{Buckyball, Phenomenon, PhenomenonSettings, phenomenon};
use cellfan::io::{Mesh, StructuredMesh, open_mesh};
use cellfan::{Error, Points, Result};
use glam::DVec3;
use serde::Serialize;

/// A mesh of the paper's figure 4.
#[derive(Clone, Copy, Serialize)]
pub(super) struct PaperMesh {
    pub(super) name: &'static str,
    /// Points along each axis.
    points: [usize; 3],
    pub(super) hexahedra: u64,
    pub(super) frames_per_s: f64,
    #[serde(skip)]
    origin: Origin,
}

/// Where a mesh comes from.
#[derive(Clone, Copy)]
enum Origin {
    /// A file of a folder of real data, or a block that is bent like its grid.
    File(&'static str, fn(DVec3) -> DVec3),
    Phenomenon(Phenomenon),
}

pub(super) const PAPER: [PaperMesh; 4] = [
    PaperMesh {
        name: "Blunt Fin",
        points: [40, 32, 32],
        hexahedra: 37_479,
        frames_per_s: 8.5,
        origin: Origin::File("classic/bluntfin.vts", around_a_fin),
    },
    PaperMesh {
        name: "Bucky Ball",
        points: [32, 32, 32],
        hexahedra: 29_791,
        frames_per_s: 15.9,
        origin: Origin::File("classic/Bucky.nhdr", |at| at),
    },
    PaperMesh {
        name: "Search Light",
        points: [16, 4, 32],
        hexahedra: 1395,
        frames_per_s: 115.8,
        origin: Origin::Phenomenon(Phenomenon::SearchLight),
    },
    PaperMesh {
        name: "Camp Fire",
        points: [16, 16, 16],
        hexahedra: 3375,
        frames_per_s: 51.3,
        origin: Origin::Phenomenon(Phenomenon::CampFire),
    },
];

/// A grid around half a fin: dense at its nose, coarse away from it.
fn around_a_fin(at: DVec3) -> DVec3 {
    let (radius, angle) = (0.2 + 0.8 * at.x * at.x, 0.5 * PI * (1.0 - at.y));
    DVec3::new(-radius * angle.cos(), radius * angle.sin(), at.z)
}

impl PaperMesh {
    /// Its hexahedra, with the point array `value` and the cell array `cell_value`, and what they are called.
    pub(super) fn hexahedra(&self, data: Option<&Path>) -> Result<(String, CellMesh)> {
        match self.origin {
            Origin::Phenomenon(kind) => {
                let settings = PhenomenonSettings { cells: self.hexahedra, ..PhenomenonSettings::default() };
                Ok((format!("{}, generated", self.name), phenomenon(kind, &settings)?))
            }
            Origin::File(file, place) => {
                let path = data.map(|data| data.join(file)).filter(|path| path.is_file());
                let Some(path) = path else { return Ok((format!("as {}", self.name), stand_in(self.points, place)?)) };
                Ok((self.name.to_owned(), read(&path).map_err(|error| error.in_file(&path))?))
            }
        }
    }
}

/// A grid of so many points, placed by `place`, with the density of C60.
fn stand_in(points: [usize; 3], place: fn(DVec3) -> DVec3) -> Result<CellMesh> {
    let bucky = Buckyball::new();
    let last = points.map(|n| (n - 1) as f64);
    let at = |i: usize| {
        let place = [i % points[0], i / points[0] % points[1], i / (points[0] * points[1])];
        DVec3::from([0, 1, 2].map(|axis| place[axis] as f64 / last[axis]))
    };
    let count = points.iter().product();
    let values: Vec<f32> = (0..count).map(|i| bucky.density(at(i)) as f32).collect();
    let positions = (0..count).map(|i| place(at(i)).to_array()).collect();
    let block = StructuredMesh::new(&[points], Points::F64(positions), Vec::new())?;
    Ok(hexahedra_of(&block, values))
}

/// The grid of a file with its first array of one value a point.
fn read(path: &Path) -> Result<CellMesh> {
    let block = match open_mesh(path)? {
        Mesh::Structured(block) => block,
        Mesh::Volume(volume) => StructuredMesh::from_volume(volume)?,
        Mesh::Unstructured(_) => {
            let problem = "a structured grid is expected here".to_owned();
            return Err(Error::Option { option: "--data", problem });
        }
    };
    let of_points = |array: &&Array| array.association == Association::Point && array.components == 1;
    let Some(array) = block.arrays().iter().find(of_points) else {
        let problem = "it has no array of one value a point".to_owned();
        return Err(Error::Option { option: "--data", problem });
    };
    let values = (0..array.values.len()).map(|i| array.values.get(i) as f32).collect();
    Ok(hexahedra_of(&block, values))
}

/// The cells of all blocks, with values of points, and of cells as their corners' mean.
fn hexahedra_of(mesh: &StructuredMesh, values: Vec<f32>) -> CellMesh {
    let blocks = mesh.blocks().iter().filter(|block| block.has_volume());
    let hexahedra: Vec<[u32; 8]> =
        blocks.flat_map(|block| (0..block.cells()).map(|cell| block.corners(cell))).collect();
    let mean = |corners: &[u32; 8]| corners.iter().map(|&v| values[v as usize]).sum::<f32>() / 8.0;
    let cell_values: Vec<f32> = hexahedra.iter().map(mean).collect();
    let array = |name: &str, association, values: Vec<f32>| Array {
        name: name.to_owned(),
        association,
        components: 1,
        values: NumericColumn::from(values),
    };
    CellMesh {
        points: mesh.points().clone(),
        file_from_hexahedron: (0..hexahedra.len() as u32).collect(),
        counts: CellCounts { in_file: hexahedra.len() as u64, ..CellCounts::default() },
        hexahedra: hexahedra.into(),
        arrays: vec![array("value", Association::Point, values), array("cell_value", Association::Cell, cell_values)],
        ..CellMesh::empty()
    }
}

/// The same cells by their faces alone.
pub(super) fn as_polyhedra(mesh: &CellMesh) -> CellMesh {
    let mut polyhedra = FaceLists::default();
    for corners in &mesh.hexahedra[..] {
        for face in HEXAHEDRON.faces {
            polyhedra.push_face(&[0, 1, 2, 3].map(|i| corners[usize::from(face[i])]));
        }
        polyhedra.end_cell();
    }
    CellMesh {
        points: mesh.points.clone(),
        polyhedra,
        file_from_polyhedron: mesh.file_from_hexahedron.clone(),
        arrays: mesh.arrays.clone(),
        counts: mesh.counts,
        ..CellMesh::empty()
    }
}

#[cfg(test)]
mod tests {
    use cellfan::Dataset;

    use super::*;

    #[test]
    fn meshes_have_about_as_many_cells_as_the_paper_s_in_both_forms() {
        for paper in PAPER {
            let (name, mesh) = paper.hexahedra(None).unwrap();
            let polyhedra = Dataset::from_cells(as_polyhedra(&mesh)).unwrap();
            let hexahedra = Dataset::from_cells(mesh).unwrap();
            assert_eq!(polyhedra.polyhedra.len(), hexahedra.cells(), "{name}");
            assert_eq!(hexahedra.counts.degenerate + hexahedra.counts.inverted, 0, "{name}");
            assert_eq!(paper.points.iter().map(|n| n - 1).product::<usize>() as u64, paper.hexahedra);
            // Phenomena leave out what emits nothing.
            let share = hexahedra.cells() as f64 / paper.hexahedra as f64;
            let least = if name.starts_with("as") { 1.0 } else { 0.2 };
            assert!((least..1.3).contains(&share), "{name} {share}");
        }
    }
}
