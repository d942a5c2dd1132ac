//! The fragments of the last cells, for sinks that want to know what a late one belongs before.
//!
//! In: cells, one after the other, their fragments packed. Out: the fragments before one in its pixel, latest first, as far back as
//! they are remembered. A ring: new ones are written over the oldest.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::compress::Compress;
use super::tile::PIXELS;
use crate::optics::{Contribution, LANES, Lanes, Mask};

/// Fragments that are remembered: some six a pixel.
const REMEMBERED: usize = 6 * PIXELS;
/// Room for them, for those of one more cell, and for a vector that begins at its last one.
const ROOM: usize = REMEMBERED + PIXELS + 2 * LANES;

/// Set in the link of a fragment that came late.
const LATE: u32 = 1 << 31;
/// The link of a fragment that is the first of its pixel.
pub(super) const NOTHING: u32 = LATE - 1;
/// Bits of a place; those above it number the laps.
const PLACE_BITS: u32 = ROOM.ilog2() + 1;

/// What came before a fragment in its pixel.
pub(super) enum Before {
    Nothing,
    Fragment(usize),
    /// It was written over.
    Forgotten,
}

/// The last fragments of a tile; kept between frames.
pub(super) struct Log {
    /// Where the fragments of the cell at hand begin, and where those of the next one will.
    first: usize,
    next: usize,
    /// How often it was begun again, and where the last lap ended.
    lap: u32,
    lap_end: usize,
    v_enter: Box<[f32; ROOM]>,
    contribution: [Box<[f32; ROOM]>; 4],
    before: Box<[u32; ROOM]>,
}

impl Default for Log {
    fn default() -> Self {
        Self {
            first: 0,
            next: 0,
            lap: 0,
            lap_end: 0,
            v_enter: bytemuck::zeroed_box(),
            contribution: [(); 4].map(|()| bytemuck::zeroed_box()),
            before: bytemuck::zeroed_box(),
        }
    }
}

impl Log {
    /// Forgets all.
    pub(super) fn reset(&mut self) {
        (self.first, self.next, self.lap, self.lap_end) = (0, 0, 0, 0);
    }

    /// Begins a cell.
    #[inline(always)]
    pub(super) fn begin_cell(&mut self) {
        if self.next > REMEMBERED {
            (self.lap_end, self.next, self.lap) = (self.next, 0, self.lap + 1);
        }
        self.first = self.next;
    }

    /// Puts sixteen fragments of the cell from the `nth` on.
    #[inline(always)]
    pub(super) fn put(&mut self, nth: usize, v_enter: &Lanes, contribution: &Contribution) {
        let place = self.ray(nth);
        self.v_enter[place..place + LANES].copy_from_slice(v_enter);
        for (channel, values) in self.contribution.iter_mut().zip(contribution) {
            channel[place..place + LANES].copy_from_slice(values);
        }
    }

    /// The cell had so many.
    #[inline(always)]
    pub(super) fn end_cell(&mut self, fragments: usize) {
        self.next = self.first + fragments;
    }

    /// The place of the cell's `nth` fragment.
    #[inline(always)]
    pub(super) fn ray(&self, nth: usize) -> usize {
        (self.first + nth).min(ROOM - LANES)
    }

    /// Inverse depth at entry and contribution of sixteen fragments from `place` on.
    #[inline(always)]
    pub(super) fn get(&self, place: usize) -> (Lanes, Contribution) {
        let place = place.min(ROOM - LANES);
        let of = |channel: &[f32; ROOM]| {
            let mut lanes = [0.0; LANES];
            lanes.copy_from_slice(&channel[place..place + LANES]);
            lanes
        };
        (of(&self.v_enter), [0, 1, 2, 3].map(|c: usize| of(&self.contribution[c])))
    }

    /// Links the fragments from `place` on, of the pixels of a block in `lanes`, with the `last` of these pixels, whose place they take.
    #[inline(always)]
    pub(super) fn link(&mut self, compress: impl Compress, place: usize, lanes: u16, is_hit: &Mask, last: &mut Mask) {
        let place = place.min(ROOM - LANES);
        let before = compress.compress(lanes, &bytemuck::cast(*last));
        self.before[place..place + LANES].copy_from_slice(&bytemuck::cast::<Lanes, Mask>(before));
        let first = self.lap << PLACE_BITS | place as u32;
        let numbers: Mask = std::array::from_fn(|i| first + i as u32);
        let numbers: Mask = bytemuck::cast(compress.expand(lanes, &bytemuck::cast(numbers), 0.0));
        for i in 0..LANES {
            last[i] = (numbers[i] & is_hit[i]) | (last[i] & !is_hit[i]);
        }
    }

    /// Notes that a fragment came late.
    pub(super) fn mark_late(&mut self, place: usize) {
        self.before[place] |= LATE;
    }

    /// Whether a fragment came late.
    pub(super) fn is_late(&self, place: usize) -> bool {
        self.before[place] & LATE != 0
    }

    /// Inverse depth at entry and contribution of a fragment.
    pub(super) fn fragment(&self, place: usize) -> (f32, [f32; 4]) {
        (self.v_enter[place], [0, 1, 2, 3].map(|c: usize| self.contribution[c][place]))
    }

    /// What came before a fragment in its pixel.
    pub(super) fn before(&self, place: usize) -> Before {
        let link = self.before[place] & !LATE;
        let (lap, place) = (link >> PLACE_BITS, (link & ((1 << PLACE_BITS) - 1)) as usize);
        // What the cell at hand was written over, the rest of its last sixteen included.
        let is_kept = || lap + 1 == self.lap && place >= self.next + LANES && place < self.lap_end;
        if link == NOTHING {
            Before::Nothing
        } else if lap == self.lap || is_kept() {
            Before::Fragment(place)
        } else {
            Before::Forgotten
        }
    }
}
