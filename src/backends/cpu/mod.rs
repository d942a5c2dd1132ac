//! The CPU backend: a tile compositor over footprints, and the papers' triangle fans as its twin.
//!
//! In: a [`Frame`](super::Frame) and an optical model. Out: an [`Image`](crate::image::Image), [`Counts`](super::Counts),
//! spans in a [`Profile`](crate::profile::Profile).
//! `compositor`: `project` → `bins` (per `block` of cells `cull`, `footprints`, `sort` keys; scatter to tiles) → per tile, by a
//! `worker`: sort, `composite` a `tile` (sixteen cells at a time: `gather` corners, `planes`, rays that meet `tetrahedra`, or `hexahedra`,
//! `crossed` ones and `polyhedra` with their `hits` and `parts`; fragments to the `log`) into a `sink` (`blend`, which puts late fragments where they belong; `collect`
//! and sort per pixel; `sum`; `maximum`) → picture.
//! Where the view stays as it is, the order is `kept`. Under a memory budget the bins are filled in `bands`, within what `budget` leaves, and blocks collected in `portions`.
//! Cubes of a volume, which come in order, have tiles of their own (`cubes`). Where a mesh of tetrahedra is drawn often, its rays are followed
//! from cell to cell (`rays`): no sort at all.
//! To add a way to composite: a sink; an instruction set: its kernels in `dispatch` and `cell_kernels`, how it moves lanes in `simd`.

mod bands;
mod bins;
mod blend;
mod block;
mod budget;
mod cell_kernels;
mod collect;
mod composite;
mod compositor;
mod crossed;
mod cubes;
mod dispatch;
mod fans;
mod gather;
pub(super) mod geometry;
mod grid;
mod hexahedra;
mod hits;
mod kept;
mod log;
mod maximum;
mod parts;
mod planes;
mod polyhedra;
mod portions;
mod prefetch;
mod rays;
mod simd;
mod sink;
mod steep;
mod sum;
mod tetrahedra;
mod tile;
mod tile_source;
mod worker;

pub use compositor::TileCompositor;
pub use cubes::CubeCompositor;
pub use dispatch::InstructionSet;
pub use fans::FanCompositor;
pub use rays::{FollowedRays, Mates, RayCompositor};
