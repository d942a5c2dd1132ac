//! The fragments of the last cells: packed, with a record of each cell in each block of pixels.
//!
//! In: groups of a few cells; the fragments of a group, cell after cell, block after block. Out: its records; and, for sinks that want
//! to know what a late fragment belongs before, the fragments before one in its pixel, latest first, as far back as they are
//! remembered. Two rings: new ones are written over the oldest.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::tile::{BLOCKS, PIXELS};
use crate::optics::{Contribution, LANES, Lanes};

/// Most fragments of a group.
pub(super) const GROUP: usize = 2 * PIXELS;
/// Most records of a group but for those of its last cell.
const GROUP_RECORDS: usize = 512;
/// Fragments that there is room for: some six a pixel, and those of a group.
const ROOM: usize = 12 * PIXELS;
/// Records that there is room for.
const RECORDS: usize = 4 * PIXELS;
/// The record of none.
pub(super) const NOTHING: u32 = u32::MAX;

/// The fragments of one cell in one block of pixels.
#[derive(Clone, Copy, bytemuck::Zeroable)]
pub(super) struct Record {
    /// How many fragments came before the first of them, in the tile, places left empty included; beyond 2^32 it begins again.
    first: u32,
    /// The record before it in the block.
    before: u32,
    /// Where the first of them stands.
    place: u16,
    /// The lanes of the block that meet the cell, a bit each; those whose fragment came late.
    pub(super) lanes: u16,
    late: u16,
    pub(super) block: u8,
}

/// A fragment before another one in its pixel.
pub(super) struct Earlier {
    pub(super) v_enter: f32,
    pub(super) contribution: [f32; 4],
    pub(super) is_late: bool,
}

/// Where the group at hand ends: how many fragments it has, and the number of the next record.
#[derive(Clone, Copy, Default)]
pub(super) struct End {
    pub(super) fragments: usize,
    next_record: usize,
}

/// The last fragments of a tile; kept between frames.
pub(super) struct Log {
    /// Where the fragments of the group at hand begin, and the number of its first record.
    first: usize,
    /// Its place.
    first_place: usize,
    first_record: usize,
    end: End,
    rings: Box<Rings>,
}

/// What is written over: of each fragment inverse depth at entry and contribution; records.
#[derive(Clone, Copy, bytemuck::Zeroable)]
struct Rings {
    v_enter: Channel,
    contribution: [Channel; 4],
    records: [Record; RECORDS],
}

/// One number for each fragment, and room for a vector that begins at the last.
type Channel = [f32; ROOM + LANES];

impl Default for Log {
    fn default() -> Self {
        Self { first: 0, first_place: 0, first_record: 0, end: End::default(), rings: bytemuck::zeroed_box() }
    }
}

impl Log {
    /// Forgets all.
    pub(super) fn reset(&mut self) {
        (self.first, self.first_place, self.first_record, self.end) = (0, 0, 0, End::default());
    }

    /// Begins a group.
    pub(super) fn begin_group(&mut self) {
        self.first += self.end.fragments;
        if self.first % ROOM + GROUP > ROOM {
            self.first = self.first.next_multiple_of(ROOM);
        }
        self.first_place = self.first % ROOM;
        self.end.fragments = 0;
        self.first_record = self.end.next_record;
    }

    /// How many fragments the group may still have; none where it has as many records as it may.
    pub(super) fn room(&self) -> usize {
        if self.end.next_record - self.first_record > GROUP_RECORDS { 0 } else { GROUP - self.end.fragments }
    }

    /// Where the group ends.
    #[inline(always)]
    pub(super) fn end(&self) -> End {
        self.end
    }

    /// Moves the end to where [`Log::record`] brought it.
    #[inline(always)]
    pub(super) fn set_end(&mut self, end: End) {
        self.end = end;
    }

    /// Records the fragments of a cell in the `lanes` of a block, of which there may be none: the next ones of the group, from `end` on.
    /// The end is the caller's to keep, in registers where it is in a hurry.
    #[inline(always)]
    pub(super) fn record(&mut self, end: &mut End, block: usize, lanes: u16) {
        self.rings.records[end.next_record % RECORDS] = Record {
            first: (self.first + end.fragments) as u32,
            before: NOTHING,
            place: self.place(end.fragments) as u16,
            lanes,
            late: 0,
            block: (block % BLOCKS) as u8,
        };
        end.next_record += usize::from(lanes != 0);
        end.fragments += lanes.count_ones() as usize;
    }

    /// The place of the group's `nth` fragment, and of fifteen after it.
    #[inline(always)]
    fn place(&self, nth: usize) -> usize {
        (self.first_place + nth).min(ROOM)
    }

    /// The room for the inverse depths at entry of sixteen fragments of the group from the `nth` on.
    #[inline(always)]
    pub(super) fn v_enter_mut(&mut self, nth: usize) -> &mut Lanes {
        let place = self.place(nth);
        self.rings.v_enter[place..].first_chunk_mut().expect("there is room for sixteen more")
    }

    /// Puts what sixteen fragments of the group contribute, from the `nth` on.
    #[inline(always)]
    pub(super) fn put_contribution(&mut self, nth: usize, contribution: &Contribution) {
        let place = self.place(nth);
        for (channel, values) in self.rings.contribution.iter_mut().zip(contribution) {
            *channel[place..].first_chunk_mut().expect("there is room for sixteen more") = *values;
        }
    }

    /// The inverse depths at entry of sixteen fragments of the group from the `nth` on.
    #[inline(always)]
    pub(super) fn v_enter(&self, nth: usize) -> Lanes {
        let place = self.place(nth);
        lanes_at(&self.rings.v_enter, place)
    }

    /// The numbers of the group's records.
    pub(super) fn group(&self) -> std::ops::Range<usize> {
        self.first_record..self.end.next_record
    }

    /// Record `number`, and of its first sixteen fragments inverse depth at entry and contribution.
    #[inline(always)]
    pub(super) fn get(&self, number: usize) -> (Record, Lanes, Contribution) {
        let record = self.rings.records[number % RECORDS];
        let (place, [r, g, b, a]) = (usize::from(record.place), &self.rings.contribution);
        let contribution = [lanes_at(r, place), lanes_at(g, place), lanes_at(b, place), lanes_at(a, place)];
        (record, lanes_at(&self.rings.v_enter, place), contribution)
    }

    /// Links record `number` with the `last` of its block, whose place it takes.
    #[inline(always)]
    pub(super) fn link(&mut self, number: usize, last: &mut u32) {
        self.rings.records[number % RECORDS].before = std::mem::replace(last, number as u32);
    }

    /// The block of record `number`.
    pub(super) fn block_of(&self, number: usize) -> usize {
        self.rings.records[number % RECORDS].block as usize % BLOCKS
    }

    /// Notes that the fragment of a lane came late; that fragment.
    pub(super) fn mark_late(&mut self, number: usize, lane: usize) -> Earlier {
        self.rings.records[number % RECORDS].late |= 1 << lane;
        self.of_record(&self.rings.records[number % RECORDS], lane)
    }

    fn of_record(&self, record: &Record, lane: usize) -> Earlier {
        let before = record.lanes & ((1 << lane) - 1);
        let place = usize::from(record.place) + before.count_ones() as usize;
        let [r, g, b, a] = &self.rings.contribution;
        let contribution = [r[place], g[place], b[place], a[place]];
        Earlier { v_enter: self.rings.v_enter[place], contribution, is_late: record.late >> lane & 1 == 1 }
    }

    /// The fragments before that of record `number` in a lane of its block, latest first; none in place of what was written over.
    pub(super) fn before(&self, number: usize, lane: usize) -> impl Iterator<Item = Option<Earlier>> {
        // All that the group has written, the rest of its last sixteen places included.
        let written = (self.first + self.end.fragments + LANES) as u32;
        let mut at = self.rings.records[number % RECORDS].before;
        std::iter::from_fn(move || {
            while at != NOTHING {
                let record = &self.rings.records[at as usize % RECORDS];
                let is_kept = written.wrapping_sub(record.first) <= ROOM as u32;
                if at as usize + RECORDS <= self.end.next_record || !is_kept {
                    at = NOTHING;
                    return Some(None);
                }
                at = record.before;
                if record.lanes >> lane & 1 == 1 {
                    return Some(Some(self.of_record(record, lane)));
                }
            }
            None
        })
    }
}

/// Sixteen numbers from a place on.
#[inline(always)]
fn lanes_at(channel: &Channel, place: usize) -> Lanes {
    *channel[place.min(ROOM)..].first_chunk().expect("there are sixteen more")
}
