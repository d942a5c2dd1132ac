//! `CubesInView`: selected cubes of a volume, in the coordinates of a view.
//!
//! In: cubes, farthest first, their grid, a view. Out: their corners in scene units, the eye in grid coordinates. The corner at a
//! place in the grid has the same bits whichever cube asks.

use glam::{DAffine3, DVec3, Vec3};

use super::{PixelProjection, View};
use crate::columns::{Cube, CubeCorners, CubeGrid, CubeSlopes, GridEye};

/// Cubes, farthest first, as a view sees them.
#[derive(Clone, Copy, Debug)]
pub struct CubesInView<'a> {
    /// The cubes.
    pub cubes: &'a [Cube],
    /// Samples of the volume along i, j and k.
    pub dims: [u32; 3],
    /// From where the grid is seen.
    pub eye: GridEye,
    /// The values at the corners of cubes that have other values than one.
    pub corners: Option<&'a dyn CubeCorners>,
    /// How values change over cubes that are lit.
    pub slopes: Option<&'a dyn CubeSlopes>,
    scene_from_grid: DAffine3,
}

impl<'a> CubesInView<'a> {
    /// `cubes` of `grid`; `origin` is that of the view's scene, in world coordinates.
    pub fn new(cubes: &'a [Cube], grid: &CubeGrid, origin: DVec3, view: &View) -> Self {
        let scene_from_world =
            DAffine3::from_scale(DVec3::splat(view.world_per_scene.recip())) * DAffine3::from_translation(-origin);
        let scene_from_grid = scene_from_world * grid.lattice.world_from_grid();
        let grid_from_scene = scene_from_grid.inverse();
        let eye = if view.is_perspective {
            GridEye::At(grid_from_scene.transform_point3(view.eye))
        } else {
            GridEye::Along(grid_from_scene.transform_vector3(-view.forward))
        };
        Self { cubes, dims: grid.dims, eye, corners: None, slopes: None, scene_from_grid }
    }

    /// Other cubes of the same grid, in the same view, with values at their corners where they are not constant, and slopes
    /// where they are lit.
    #[must_use]
    pub fn with<'b>(
        &self,
        cubes: &'b [Cube],
        corners: Option<&'b dyn CubeCorners>,
        slopes: Option<&'b dyn CubeSlopes>,
    ) -> CubesInView<'b> {
        let Self { dims, eye, scene_from_grid, .. } = *self;
        CubesInView { cubes, dims, eye, corners, slopes, scene_from_grid }
    }

    /// The map from grid coordinates to scene units.
    pub fn scene_from_grid(&self) -> DAffine3 {
        self.scene_from_grid
    }

    /// The place of a grid point, in scene units.
    #[inline]
    pub fn position(&self, grid: DVec3) -> Vec3 {
        self.scene_from_grid.transform_point3(grid).as_vec3()
    }

    /// The lowest and the highest corner of a cube in grid coordinates.
    #[inline]
    pub fn ends(&self, cube: &Cube) -> [DVec3; 2] {
        cube.samples(self.dims).map(|end| DVec3::from_array(end.map(f64::from)))
    }

    /// The eight corners of the box between two grid points: corner i has x = bit 0, y = bit 1, z = bit 2 of i.
    #[inline]
    pub fn corners(&self, ends: [DVec3; 2]) -> [Vec3; 8] {
        std::array::from_fn(|corner| self.position(corner_between(ends, corner)))
    }

    /// The corners of all cubes of the volume together on the picture: column, row, depth.
    pub fn outline(&self, projection: &PixelProjection) -> [Vec3; 8] {
        let whole = [DVec3::ZERO, DVec3::from_array(self.dims.map(f64::from))];
        self.corners(whole).map(|corner| projection.project(corner))
    }
}

/// Corner `corner` of the box between two grid points.
#[inline]
pub(super) fn corner_between(ends: [DVec3; 2], corner: usize) -> DVec3 {
    DVec3::new(ends[corner & 1].x, ends[corner >> 1 & 1].y, ends[corner >> 2 & 1].z)
}
