//! Columns: a mesh as structure-of-arrays data, validated once and then read as slices.
//!
//! In: [`TetMesh`], tetrahedra in file order, as a reader or a generator makes them.
//! Out: [`Dataset`] (cells and vertices in spatial order, in blocks) and [`Field`] (one scalar per vertex or cell).
//! To add a column: a member of [`Dataset`], its check in `build.rs`, its line in [`BlockView`] if stages read it.

mod array;
mod bits;
mod build;
mod column;
mod dataset;
mod field;
mod spatial_order;
mod tets;

pub use array::{Array, Association, NumericColumn};
pub use bits::BitColumn;
pub use build::{Points, TetMesh};
pub use column::{Column, SharedBytes};
pub use dataset::{ArrayRanges, Block, BlockView, Bounds, CellCounts, Dataset, ValueRanges};
pub use field::{Component, Field, FieldSelection};
pub use tets::{BlockIds, BlockTets, Tets, TetsView};
