//! Where a tile's fragments go, block by block: blended at once ([`blend`](super::blend)), collected and sorted per pixel
//! ([`collect`](super::collect)), or added up ([`sum`](super::sum)).

use super::compress::Compress;
use super::log::Log;
use crate::optics::{Contribution, Lanes, Mask, Optics};

/// The fragments of one cell in one 4×4 block.
pub(super) struct Fragments<'a> {
    /// The block in the tile.
    pub(super) block: usize,
    /// The lanes that meet the cell, a bit each, and as a mask.
    pub(super) lanes: u16,
    pub(super) is_hit: &'a Mask,
    /// Where the first of them stands in the log.
    pub(super) ray: usize,
    /// Inverse depth at entry.
    pub(super) v_enter: &'a Lanes,
    /// What each lane's segment contributes; nothing in lanes that miss.
    pub(super) contribution: &'a Contribution,
}

/// Takes fragments, cells in the tile's order.
pub(super) trait Sink<O: Optics> {
    /// Whether the block takes no fragments of a cell whose nearest point has inverse depth `v_max`.
    fn is_done(&self, block: usize, v_max: f32) -> bool;
    /// Whether no block takes fragments of any cell.
    fn is_all_done(&self) -> bool;
    /// Takes the fragments of one cell in one block.
    fn accept(&mut self, compress: impl Compress, fragments: &Fragments, log: &mut Log);
}
