//! The container `.cells`: a mesh as columns that are used in place through a memory map. The format: `docs/container.md`.
//!
//! In: a path ([`open`]), or tetrahedra to write ([`write()`], in bounded memory). Out: a [`Dataset`](crate::Dataset), or a file.
//! `directory` names the columns, `read` opens, `write` lays them out (`cells` in order, by `external_sort`; `ranges` of
//! values, `adjacency` on request), `check` reads everything. To add a column: its entry in `directory`, its writer, and its check.

mod adjacency;
mod cells;
mod check;
mod directory;
mod external_sort;
mod ranges;
mod read;
mod sink;
mod write;

pub use check::Checked;
pub use check::check;
pub use directory::MAGIC;
pub use read::{is_container, open};
pub use write::{Phase, WriteOptions, Written, write};

#[cfg(test)]
mod tests;
