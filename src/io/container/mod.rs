//! The container `.cells`: a mesh as columns that are used in place through a memory map. The format: `docs/container.md`.
//!
//! In: a path ([`open`]), or cells to write: listed ([`write()`], in bounded memory) or structured ([`write_structured`]). Out: a
//! [`Dataset`](crate::Dataset), or a file. `directory` names the columns, `columns` finds them in a file's bytes, `read` opens, `write`
//! lays them out (`cells` in the `order` that `external_sort` gives; `ranges` of values, `adjacency` on request), `structured` as they
//! come, with the `octree` over the values of a regular grid ([`write_volume`], [`open_volume`]); `check` reads everything. To add a column: its entry in `directory`, its writer, and its check.

mod adjacency;
mod cells;
mod check;
mod columns;
mod directory;
mod external_sort;
mod octree;
mod order;
mod ranges;
mod read;
mod sink;
mod structured;
mod write;

pub use check::Checked;
pub use check::check;
pub use directory::MAGIC;
pub use octree::{StoredVolume, open_volume, write_volume};
pub use read::{cells_by_kind, is_container, open};
pub use structured::write_structured;
pub use write::{Phase, WriteOptions, Written, write};

#[cfg(test)]
mod tests;
