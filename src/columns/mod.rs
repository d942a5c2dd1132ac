//! Columns: a mesh as structure-of-arrays data, validated once and then read as slices.
//!
//! In: [`TetMesh`], [`CellMesh`] or [`StructuredCells`], cells in file order, as a reader or a generator makes them.
//! Out: [`Dataset`] (cells and vertices in spatial order, in blocks) and [`Field`] (one scalar per vertex or cell).
//! To add a column: a member of [`Dataset`], its check in `build.rs`, its line in [`BlockView`] if stages read it.

mod array;
mod backing;
mod bits;
mod build;
mod canonical;
mod cell_source;
mod column;
mod dataset;
mod faces;
mod field;
mod hexahedra;
mod neighbours;
mod placement;
mod polyhedra;
mod positions;
mod spatial_order;
mod split;
mod tets;
mod volume;

pub use array::{Array, Association, NumericColumn, Sample, SliceVisitor};
pub use backing::Backing;
pub use bits::{BitColumn, BitView};
pub(crate) use build::describe;
pub use build::{CellMesh, Points, StructuredCells, TetMesh};
pub(crate) use build::{CellsInPlace, PositionsInPlace};
pub use canonical::canonical_from_point;
pub(crate) use canonical::{canonical_from_vertex, place};
pub use cell_source::{ArrayHead, CellSource};
pub use column::{Column, SharedBytes};
pub use dataset::{ArrayRanges, Block, BlockCells, BlockView, Bounds, CellCorners, CellCounts, Dataset, ValueRanges};
pub(crate) use faces::{CellColumns, FaceName, Faces, HEX_FACES, TET_FACES};
pub use field::{Component, Field, FieldSelection};
pub(crate) use hexahedra::HexCorners;
pub use hexahedra::{HexShape, Hexahedra, HexahedraView, StructuredBlock};
pub use neighbours::Neighbours;
pub(crate) use neighbours::{Joiner, Side, within_blocks};
pub(crate) use placement::{Placement, orientation_of};
pub(crate) use polyhedra::{Built, PolyhedraColumns};
pub use polyhedra::{FaceLists, Most, PolyFace, Polyhedra, PolyhedraView};
pub use positions::Positions;
pub(crate) use spatial_order::UNUSED;
pub(crate) use split::split_hexahedron;
pub use tets::{BlockIds, BlockTets, Tets, TetsView};
pub use volume::{
    Cube, CubeCorners, CubeGrid, CubeSlopes, GridEye, Lattice, SampleVisitor, Samples, Volume, VolumeField,
};
