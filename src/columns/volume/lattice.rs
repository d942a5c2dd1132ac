//! `Lattice`: where the points of a regular grid are, by one affine map.

use glam::{DAffine3, DMat3, DVec3};

/// The map from grid coordinates (point (i, j, k) is at these numbers) to the world: any spacing, direction and shear.
///
/// ```
/// use cellfan::columns::Lattice;
/// use glam::DVec3;
/// let lattice = Lattice::new(DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.5, 1.0, 2.0));
/// assert_eq!(lattice.world(DVec3::new(2.0, 0.0, 1.0)), DVec3::new(2.0, 0.0, 2.0));
/// assert_eq!(lattice.grid(DVec3::new(2.0, 0.0, 2.0)), DVec3::new(2.0, 0.0, 1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    world_from_grid: DAffine3,
}

impl Default for Lattice {
    /// One unit a step along the axes.
    fn default() -> Self {
        Self { world_from_grid: DAffine3::IDENTITY }
    }
}

impl Lattice {
    /// Point (0, 0, 0) at `origin`, `spacing` along x, y and z from point to point.
    pub fn new(origin: DVec3, spacing: DVec3) -> Self {
        Self::sheared(origin, DMat3::from_diagonal(spacing))
    }

    /// Point (0, 0, 0) at `origin`; the columns of `steps` lead from a point to the next along i, j and k.
    pub fn sheared(origin: DVec3, steps: DMat3) -> Self {
        Self { world_from_grid: DAffine3::from_mat3_translation(steps, origin) }
    }

    /// Where point (0, 0, 0) is.
    pub fn origin(&self) -> DVec3 {
        self.world_from_grid.translation
    }

    /// The steps from a point to the next along i, j and k.
    pub fn steps(&self) -> DMat3 {
        self.world_from_grid.matrix3
    }

    /// The same grid, counted from point `first` of it.
    #[must_use]
    pub fn from_point(&self, first: DVec3) -> Self {
        Self::sheared(self.world(first), self.steps())
    }

    /// The map itself.
    pub fn world_from_grid(&self) -> DAffine3 {
        self.world_from_grid
    }

    /// Its inverse; not finite where the steps lie in a plane.
    pub fn grid_from_world(&self) -> DAffine3 {
        self.world_from_grid.inverse()
    }

    /// The world coordinates of a place in the grid.
    pub fn world(&self, grid: DVec3) -> DVec3 {
        self.world_from_grid.transform_point3(grid)
    }

    /// The grid coordinates of a place in the world; not finite where the steps lie in a plane.
    pub fn grid(&self, world: DVec3) -> DVec3 {
        self.grid_from_world().transform_point3(world)
    }

    /// The volume of one cell in world units.
    pub fn volume_of_cell(&self) -> f64 {
        self.steps().determinant().abs()
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.world_from_grid.is_finite()
    }
}
