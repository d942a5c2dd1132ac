//! The CPU backend: a tile compositor over footprints, and the papers' triangle fans as its twin.
//!
//! In: a [`Frame`](super::Frame) and an optical model. Out: an [`Image`](crate::image::Image), [`Counts`](super::Counts),
//! spans in a [`Profile`](crate::profile::Profile).
//! `compositor`: `project` → `bins` (`cull`, `footprints`, `sort` keys, scatter to tiles) → per tile, by a `worker`: sort,
//! `tile` (cell by cell: its `planes`, its `hits`) into a `sink` (blend, or collect and sort per pixel) → picture.
//! To add a way to composite: a sink; an instruction set: its kernels in `dispatch`, how it moves lanes in `compress`.

mod bins;
mod compositor;
mod compress;
mod dispatch;
mod fans;
mod hits;
mod planes;
mod sink;
mod steep;
mod tile;
mod worker;

pub use compositor::TileCompositor;
pub use dispatch::InstructionSet;
pub use fans::FanCompositor;
