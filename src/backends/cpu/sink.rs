//! Where a tile's fragments go, block by block: blended at once ([`blend`](super::blend)), collected and sorted per pixel
//! ([`collect`](super::collect)), added up ([`sum`](super::sum)), or compared
//! ([`maximum`](super::maximum)).

use super::log::Log;
use super::simd::Simd;
use crate::optics::{Contribution, Lanes, Optics};

/// The fragments of one cell in one 4×4 block.
pub(super) struct Fragments<'a> {
    /// The block in the tile.
    pub(super) block: usize,
    /// The lanes that meet the cell, a bit each.
    pub(super) lanes: u16,
    /// Their record in the log.
    pub(super) number: usize,
    /// Inverse depth at entry; infinite in lanes that miss.
    pub(super) v_enter: &'a Lanes,
    /// What each lane's segment contributes; nothing in lanes that miss.
    pub(super) contribution: &'a Contribution,
}

/// Takes fragments, cells in the tile's order.
pub(super) trait Sink<O: Optics> {
    /// Whether some blocks take no fragments of some cells.
    fn is_any_done(&self) -> bool;
    /// The blocks, a bit each, that take no fragments of a cell whose nearest point has inverse depth `v_max`.
    fn done(&self, v_max: f32) -> u64;
    /// The same where the cell's largest value is `s_max`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "part of kernels that are compiled for wider vectors")]
    fn done_at(&self, _: impl Simd, v_max: f32, _s_max: f32) -> u64 {
        self.done(v_max)
    }
    /// Whether no block takes fragments of any cell.
    fn is_all_done(&self) -> bool;
    /// Whether no block takes fragments of any cell without a value above `s_max`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "part of kernels that are compiled for wider vectors")]
    fn is_all_done_at(&self, _s_max: f32) -> bool {
        self.is_all_done()
    }
    /// Takes the fragments of one cell in one block.
    fn accept(&mut self, simd: impl Simd, fragments: &Fragments, log: &mut Log);
}
