//! Triangles that are no boundary of the mesh: those of another file, beside it.

use glam::DVec3;

use super::{List, Looks, Primitive};
use crate::columns::Dataset;
use crate::error::{Error, Result};
use crate::stages::scene_per_world;

/// A surface of triangles in world coordinates, opaque, drawn from both sides.
///
/// ```
/// use cellfan::geometry::TriangleMesh;
/// let mesh = TriangleMesh { positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], triangles: vec![[0, 1, 2]], ..Default::default() };
/// assert!(mesh.check().is_ok());
/// assert!(TriangleMesh { triangles: vec![[0, 1, 3]], ..mesh }.check().is_err());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// In world coordinates.
    pub positions: Vec<[f64; 3]>,
    /// Three positions each.
    pub triangles: Vec<[u32; 3]>,
    /// A normal of each position, of any length, turned either way, zero for that of the triangle; or none: triangles are flat then.
    pub normals: Vec<[f32; 3]>,
    /// Linear RGB of each position; or none.
    pub colors: Vec<[f32; 3]>,
}

/// No coordinate in scene units reaches this: products of three are numbers still.
const FARTHEST: f64 = 1e12;

impl TriangleMesh {
    /// The colour of triangles that have none, linear: `#b4b8c0`, as that of the mesh's own surface.
    pub const COLOR: [f32; 3] = [0.456_411, 0.479_32, 0.527_115];

    /// Whether triangles name positions that there are, normals and colours are as many as positions, and all are numbers.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`], [`Error::LengthMismatch`], [`Error::NonFinitePosition`].
    pub fn check(&self) -> Result<()> {
        let len = self.positions.len() as u64;
        for (column, each) in [("normals", &self.normals), ("colors", &self.colors)] {
            if !each.is_empty() && each.len() as u64 != len {
                return Err(Error::LengthMismatch { column: column.to_owned(), len: each.len() as u64, expected: len });
            }
        }
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for &corner in corners {
                let Some(position) = self.positions.get(corner as usize) else {
                    let (cell, index) = (triangle as u64, corner.into());
                    return Err(Error::IndexOutOfRange { column: "triangles", cell, index, len });
                };
                if !position.iter().all(|x| x.is_finite()) {
                    return Err(Error::NonFinitePosition { point: corner.into(), position: *position });
                }
            }
        }
        Ok(())
    }
}

/// The triangles of `mesh` beside `dataset`; their colours are those of the layer where the mesh has none.
///
/// # Errors
/// Those of [`TriangleMesh::check`]; [`Error::Option`] where a triangle is farther away than can be drawn beside the dataset.
///
/// ```
/// use cellfan::{Dataset, generate, geometry};
/// let dataset = Dataset::from_tets(generate::tets(&generate::Settings { cells: 6, ..Default::default() })?)?;
/// let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = geometry::TriangleMesh { positions, triangles: vec![[0, 1, 2]], ..Default::default() };
/// assert_eq!(geometry::triangles(&dataset, &mesh)?.len(), 1);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn triangles(dataset: &Dataset, mesh: &TriangleMesh) -> Result<List> {
    triangles_around(dataset.origin, scene_per_world(dataset), mesh)
}

/// The same beside anything else: in scene units, of which there are so many in a world unit, relative to `origin`.
pub(crate) fn triangles_around(origin: DVec3, scale: f64, mesh: &TriangleMesh) -> Result<List> {
    mesh.check()?;
    let mut corners = Vec::with_capacity(3 * mesh.triangles.len());
    for &corner in mesh.triangles.as_flattened() {
        let position = mesh.positions[corner as usize];
        let in_scene: [f64; 3] = std::array::from_fn(|axis| (position[axis] - origin[axis]) * scale);
        if in_scene.iter().any(|x| x.abs() > FARTHEST) {
            let problem = format!("a triangle at {position:?} is too far from the mesh to be drawn beside it");
            return Err(Error::Option { option: "--mesh", problem });
        }
        corners.push(in_scene.map(|x| x as f32));
    }
    let of_corners = |each: &[[f32; 3]]| -> Vec<[f32; 3]> {
        let corners = mesh.triangles.as_flattened().iter().filter(|_| !each.is_empty());
        corners.map(|&corner| each[corner as usize]).collect()
    };
    let looks = Looks { colors: of_corners(&mesh.colors), normals: of_corners(&mesh.normals) };
    Ok(List::new(Primitive::Triangles, corners).with_looks(looks))
}
