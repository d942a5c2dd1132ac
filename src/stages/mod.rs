//! Stages: from blocks of cells to what a backend composites, for one view.
//!
//! In: [`BlockView`](crate::columns::BlockView)s, a [`View`], [`ScreenVertex`] records (`project`), a cull table.
//! Out: [`footprints`] for tile compositors; [`fans`] in lent memory, in draw order, for rasterisers.
//! Each stage is a function over slices that calls no other stage: `cull` → `classify` → `sort` → `fans` | `footprints`.
//! To add one: a file with its contract, its slow twin in its tests, a line here, a span in `backends`, a bench group.

pub mod classify;
mod cubes;
pub mod cull;
pub mod fans;
pub mod footprints;
pub mod near;
pub mod project;
pub mod scatter;
pub mod sort;
#[cfg(test)]
mod testing;
mod view;

pub use cubes::CubesInView;
pub use project::{SceneVertex, ScreenVertex};
pub use view::{PixelProjection, View, scene_per_length, scene_per_world};
