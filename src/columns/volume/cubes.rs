//! `Cube`: a box of samples with one value, and the grid of the smallest of them.

use std::fmt;

use glam::DVec3;

use super::{Lattice, Volume, VolumeField};
use crate::columns::{Association, Bounds, CellCounts, Dataset, Hexahedra, Polyhedra};

/// A box of a volume's samples that has one value: what the octree selects and renderers draw.
///
/// ```
/// use cellfan::columns::Cube;
/// // The second along i of boxes of four samples a side, of a volume six samples long.
/// let cube = Cube { node: [1, 0, 0], level: 2, value: 0.5 };
/// assert_eq!(cube.samples([6, 4, 4]), [[4, 0, 0], [6, 4, 4]]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    /// Its place among the boxes of its level along i, j and k.
    pub node: [u16; 3],
    /// It has 2^`level` samples a side, or what is left of them at the volume's end.
    pub level: u16,
    /// The stored value.
    pub value: f32,
}

impl Cube {
    /// Samples that a volume may have along a side.
    pub const SIDE_MAX: usize = 1 << 16;

    /// Its first samples along i, j and k and those after its last, of a volume of `dims` samples.
    #[inline]
    pub fn samples(&self, dims: [u32; 3]) -> [[u32; 3]; 2] {
        let first = self.node.map(|node| u32::from(node) << self.level);
        let end = std::array::from_fn(|axis| (first[axis] + (1 << self.level)).min(dims[axis]));
        [first, end]
    }
}

/// Values at the corners of cubes, between which these are trilinear.
pub trait CubeCorners: fmt::Debug + Sync {
    /// The stored values at the corners of a cube: corner i has x = bit 0, y = bit 1, z = bit 2 of i.
    fn of(&self, cube: &Cube) -> [f32; 8];
}

/// How the field changes over cubes.
pub trait CubeSlopes: fmt::Debug + Sync {
    /// How much the stored value changes by a step of the grid along i, j and k.
    fn of(&self, cube: &Cube) -> [f32; 3];
}

/// The smallest cubes of a field: one a sample, or one between eight. Cube (i, j, k) reaches from these numbers to those one larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeGrid {
    /// Cubes along i, j and k.
    pub dims: [u32; 3],
    /// Where the corners of the cubes are.
    pub lattice: Lattice,
}

impl CubeGrid {
    /// The cubes of `field`, one of `volume`: its cells, or boxes around its points.
    pub fn new(volume: &Volume, field: &VolumeField) -> Self {
        let lattice = match field.association {
            Association::Cell => volume.lattice,
            Association::Point => volume.lattice.from_point(DVec3::splat(-0.5)),
        };
        Self { dims: field.dims.map(|side| side as u32), lattice }
    }

    /// The cubes between the points of `volume`.
    pub fn between_points(volume: &Volume) -> Self {
        Self { dims: volume.cell_dims().map(|side| side as u32), lattice: volume.lattice }
    }

    /// The eight corners of all cubes together, in world coordinates.
    pub fn corners_world(&self) -> [DVec3; 8] {
        let [nx, ny, nz] = self.dims.map(f64::from);
        std::array::from_fn(|i| {
            let end = DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64);
            self.lattice.world(end * DVec3::new(nx, ny, nz))
        })
    }

    /// A mesh without cells where the cubes are: it tells views and backends their origin and their size.
    pub fn place(&self) -> Dataset {
        let corners = self.corners_world();
        let origin = corners.iter().sum::<DVec3>() / 8.0;
        Dataset {
            origin,
            positions: Vec::new().into(),
            tets: Vec::new().into(),
            hexahedra: Hexahedra::none(),
            polyhedra: Polyhedra::none(),
            positive: std::iter::empty().collect(),
            file_from_vertex: None,
            file_from_cell: None,
            arrays: Vec::new(),
            array_ranges: Vec::new(),
            adjacency: None,
            blocks: Vec::new(),
            bounds: corners.iter().fold(Bounds::EMPTY, |all, &corner| all.include((corner - origin).as_vec3())),
            counts: CellCounts::default(),
            read_bytes: 0,
            backing: None,
        }
    }
}

/// From where a grid is seen, in its own coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GridEye {
    /// The eye.
    At(DVec3),
    /// The direction to the eye, along which all rays run.
    Along(DVec3),
}

impl GridEye {
    /// How far outside a box the eye lies, in sides of the box, seen from each of its faces x−, x+, y−, y+, z−, z+; along parallel
    /// rays, which have no distance, how steeply they leave it.
    ///
    /// It is the dot product of the face's normal with the vector from the face to the eye, in coordinates in which the box is the
    /// unit cube: affine maps change neither its sign nor what hides what.
    #[inline]
    pub fn beyond_faces(&self, [low, high]: [DVec3; 2]) -> [f64; 6] {
        let side = high - low;
        let (below, above) = match self {
            Self::At(eye) => ((low - *eye) / side, (*eye - high) / side),
            Self::Along(direction) => (-*direction / side, *direction / side),
        };
        [below.x, above.x, below.y, above.y, below.z, above.z]
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "halves and wholes are exact")]
mod tests {
    use super::super::Lattice;
    use super::*;
    use crate::columns::{Array, FieldSelection};

    #[test]
    fn samples_at_points_have_boxes_around_them_and_those_of_cells_are_the_cells() {
        for (association, first, last) in
            [(Association::Point, [-1.0, -0.5, -0.5], [5.0, 1.5, 1.5]), (Association::Cell, [0.0; 3], [4.0, 1.0, 1.0])]
        {
            let count = if association == Association::Point { 12 } else { 2 };
            let array = Array { name: "v".into(), association, components: 1, values: vec![0_u8; count].into() };
            let lattice = Lattice::new(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0));
            let volume = Volume::new([3, 2, 2], lattice, vec![array]).unwrap();
            let field = volume.field(&FieldSelection::parse("v", &[])).unwrap();
            let corners = CubeGrid::new(&volume, &field).corners_world();
            assert_eq!((corners[0].to_array(), corners[7].to_array()), (first, last));
        }
    }

    #[test]
    fn the_eye_is_beyond_the_faces_that_it_sees() {
        let unit = [DVec3::new(2.0, 0.0, 0.0), DVec3::new(4.0, 1.0, 1.0)];
        let at = GridEye::At(DVec3::new(8.0, 0.5, -0.25)).beyond_faces(unit);
        assert_eq!(at, [-3.0, 2.0, -0.5, -0.5, 0.25, -1.25]);
        let along = GridEye::Along(DVec3::new(1.0, 0.0, -3.0)).beyond_faces(unit);
        assert_eq!(along, [-0.5, 0.5, 0.0, 0.0, 3.0, -3.0]);
    }
}
