//! VTK XML: what `.vtu` and its relatives have in common.
//!
//! In: the bytes of a file. Out: its [`Element`]s, and the values of a `DataArray` element in any encoding
//! ([`Encoding::values`]). `grid.rs` and `parallel.rs` hold what the kinds of grids share. Nothing that a file declares is trusted for an allocation: it is first held against the bytes
//! that are there.
//! To add a compressor: its line in `blocks.rs`. To add a kind of grid: a reader beside `vtu.rs`.

mod base64;
mod blocks;
mod document;
mod encoding;
mod extent;
mod faces;
mod grid;
mod parallel;
mod stream;

pub(super) use document::{Element, parse, split_appended};
pub(super) use encoding::Encoding;
pub(super) use extent::Extent;
pub(super) use faces::faces;
pub(super) use grid::{arrays, child, grid_of, points, read_grid, read_mapped};
pub(super) use parallel::{NamedFiles, read_pieces};

use super::source::{Source, quote};
use crate::error::Result;

/// The root element, if it is that of a VTK XML file of type `kind`.
fn check_root(root: &Element<'_>, kind: &str, source: Source<'_>) -> Result<()> {
    if root.name != "VTKFile" {
        let problem = format!("the root element is <{}>, not <VTKFile>: this is no VTK XML file", root.name);
        return Err(source.malformed("byte 0", problem));
    }
    match root.attribute("type") {
        Some(found) if found == kind => Ok(()),
        Some(found) => {
            let advice = "convert it to an unstructured grid (.vtu)";
            Err(source.unsupported(format!("a VTK XML file of type {}", quote(found.as_bytes())), advice))
        }
        None => Err(source.malformed(root.place(), "has no attribute \"type\"")),
    }
}
