//! Hierarchy: an octree over the samples of a regular grid, and the cubes of it that a picture needs.
//!
//! In: a [`VolumeField`](crate::columns::VolumeField), in place and in its own type. Out: a [`Hierarchy`] (`build`: `leaves`, then
//! `level` by level; boxes between points with the errors of `linear`), and of it a [`Selection`] of [`Cube`](crate::columns::Cube)s,
//! farthest first (`select`), with values at their corners that neighbours of other size agree on (`corners`).
//! To add a rule for what is fine enough: a type that implements [`Accept`], as [`WithinError`] and [`WithinPicture`].
//!
//! Source: Schussman and Max 2001, section 6.

mod budget;
mod build;
mod corners;
mod leaves;
mod level;
mod linear;
mod picture;
mod select;
mod slopes;

pub use budget::{CubeCounts, TimeBudget};
pub use build::Hierarchy;
pub use corners::SelectedCorners;
pub use level::{Interpolation, Level, Node};
pub use picture::{WithinPicture, longest_chord_world};
pub use select::{Accept, Selection, Shows, WithinError};
pub use slopes::Slopes;

#[cfg(test)]
mod tests;
