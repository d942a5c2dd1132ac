//! Collecting the fragments of some blocks, to composite each pixel's in the order of their depths.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::log::Log;
use super::simd::Simd;
use super::sink::{Fragments, Sink};
use super::tile::PIXELS;
use crate::control::Control;
use crate::optics::{LANES, Optics};

/// Fragments between two looks at the token.
const LOOK: usize = 1 << 15;

/// A fragment on its own.
#[derive(Clone, Copy, Debug)]
struct Fragment {
    pixel: u16,
    v_enter: f32,
    contribution: [f32; 4],
}

/// Keeps every fragment of some blocks, then composites each pixel's in the order of their depths: right for any disjoint cells.
#[derive(Default)]
pub(super) struct Collect {
    blocks: u64,
    fragments: Vec<Fragment>,
    fragment_from_sorted: Vec<u32>,
}

impl Collect {
    /// Forgets all fragments and takes those of `blocks`, one bit each.
    pub(super) fn reset(&mut self, blocks: u64) {
        self.blocks = blocks;
        self.fragments.clear();
    }

    /// Writes the pixels of its blocks to `out`, block by block, lane by lane, until the end is asked for.
    pub(super) fn composite<O: Optics>(&mut self, control: &Control, optics: &O, out: &mut [[f32; 4]; PIXELS]) {
        // Count, scan, write: the fragments of a pixel together, in the order they came.
        let mut starts = [0_u32; PIXELS + 1];
        for fragments in self.fragments.chunks(LOOK) {
            if control.is_cancelled() {
                return;
            }
            for fragment in fragments {
                starts[fragment.pixel as usize + 1] += 1;
            }
        }
        for pixel in 0..PIXELS {
            starts[pixel + 1] += starts[pixel];
        }
        let mut places = starts;
        self.fragment_from_sorted.resize(self.fragments.len(), 0);
        for (i, fragment) in self.fragments.iter().enumerate() {
            if i % LOOK == 0 && control.is_cancelled() {
                return;
            }
            let place = &mut places[fragment.pixel as usize];
            self.fragment_from_sorted[*place as usize] = i as u32;
            *place += 1;
        }
        let is_mine = |pixel: usize| self.blocks >> (pixel / LANES) & 1 == 1;
        for (pixel, out) in out.iter_mut().enumerate().filter(|&(pixel, _)| is_mine(pixel)) {
            if control.is_cancelled() {
                return;
            }
            let of_pixel = &mut self.fragment_from_sorted[starts[pixel] as usize..starts[pixel + 1] as usize];
            of_pixel.sort_by(|&a, &b| {
                let v = |i: u32| self.fragments[i as usize].v_enter;
                v(b).total_cmp(&v(a))
            });
            let fragments = of_pixel.iter().map(|&i| self.fragments[i as usize].contribution);
            *out = optics.pixel(fragments.fold(O::CLEAR, O::over));
        }
    }
}

impl<O: Optics> Sink<O> for Collect {
    #[inline(always)]
    fn is_any_done(&self) -> bool {
        true
    }

    #[inline(always)]
    fn done(&self, _: f32) -> u64 {
        !self.blocks
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        false
    }

    #[inline(always)]
    fn accept(&mut self, _: impl Simd, fragments: &Fragments, _: &mut Log) {
        for i in 0..LANES {
            if fragments.lanes >> i & 1 == 1 {
                self.fragments.push(Fragment {
                    pixel: (fragments.block * LANES + i) as u16,
                    v_enter: fragments.v_enter[i],
                    contribution: std::array::from_fn(|c| fragments.contribution[c][i]),
                });
            }
        }
    }
}
