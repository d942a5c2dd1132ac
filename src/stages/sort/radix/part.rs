//! `Part`: the pairs of some of a frame's cells, by bucket as they come where the last frame tells how many to expect.
//!
//! In: pairs in ascending order of index. Out: for each bucket its pairs, still in that order; those for which a bucket had no
//! room, or all where nothing was foreseen, wait in the order in which they came.

use super::Pair;
use super::spread::{BUCKETS, Counts, Spread};

/// Room in a bucket beyond what is expected: this share, and so many pairs. Chosen, not measured.
const SPARE: (u64, u64) = (8, 16);
/// Rooms for so many times the pairs that were, and so many more, are the most that is planned.
const MOST_ROOM: (u64, u64) = (2, 1 << 14);

/// One of the parts that several threads fill.
#[derive(Debug)]
pub struct Part {
    spread: Option<Spread>,
    /// Buckets with room between them.
    held: Vec<Pair>,
    /// Where each bucket starts in `held`, its next pair goes, and the next bucket starts.
    rooms: Vec<[u32; 3]>,
    /// Pairs without a room.
    rest: Vec<Pair>,
    /// How many pairs of each bucket there were, with those that had no room.
    counts: Counts,
}

impl Default for Part {
    fn default() -> Self {
        Self { spread: None, held: Vec::new(), rooms: Vec::new(), rest: Vec::new(), counts: [0; BUCKETS] }
    }
}

impl Part {
    /// Appends pairs: keys as they like, indices ascending and above those that came before.
    pub fn extend(&mut self, pairs: impl IntoIterator<Item = Pair>) {
        let Some(spread) = self.spread else {
            self.rest.extend(pairs);
            return;
        };
        for pair in pairs {
            let [_, next, end] = &mut self.rooms[spread.bucket(pair)];
            if next < end {
                self.held[*next as usize] = pair;
                *next += 1;
            } else {
                self.rest.push(pair);
            }
        }
    }

    /// Forgets the pairs and plans rooms for others, which will spread as the last ones did, each into a bucket at most `reach` away
    /// from where it was. Whether that takes a sensible amount of memory: not if most are in a few buckets.
    pub(super) fn plan(&mut self, reach: usize) -> bool {
        self.rest.clear();
        self.spread = None;
        let counts = self.counts;
        let room = |bucket: usize| {
            let near = &counts[bucket.saturating_sub(reach)..(bucket + reach + 1).min(BUCKETS)];
            let most = u64::from(near.iter().copied().fold(0, u32::max));
            most + most / SPARE.0 + SPARE.1
        };
        let pairs: u64 = counts.iter().copied().map(u64::from).sum();
        let rooms: u64 = (0..BUCKETS).map(room).sum();
        let is_sensible = rooms <= MOST_ROOM.0 * pairs + MOST_ROOM.1 && rooms <= u32::MAX.into();
        if is_sensible {
            self.plan_rooms(|bucket| room(bucket) as u32);
        }
        is_sensible
    }

    /// Makes ready for pairs: with the rooms that were planned, by `spread`, or without any.
    pub(super) fn begin(&mut self, spread: Option<Spread>) {
        self.rest.clear();
        self.spread = spread;
        if spread.is_some() {
            self.make_room();
        } else {
            self.rooms.clear();
        }
    }

    /// Puts all pairs into buckets of their exact sizes.
    pub(super) fn spread_all(&mut self, spread: Spread) {
        debug_assert!(self.spread.is_none(), "no pair lies in another bucket");
        self.counts = spread.count(&self.rest);
        let counts = self.counts;
        self.plan_rooms(|bucket| counts[bucket]);
        self.make_room();
        for &pair in &self.rest {
            let [_, next, _] = &mut self.rooms[spread.bucket(pair)];
            self.held[*next as usize] = pair;
            *next += 1;
        }
        self.rest.clear();
    }

    /// Takes all pairs out of the buckets; they come in no order then.
    pub(super) fn take_back(&mut self) {
        if self.spread.take().is_some() {
            for &[start, next, _] in &self.rooms {
                self.rest.extend_from_slice(&self.held[start as usize..next as usize]);
            }
            self.rooms.clear();
        }
    }

    /// Puts the pairs without a room by bucket, as far as there are buckets, and counts all.
    pub(super) fn close(&mut self) {
        let Some(spread) = self.spread else { return };
        self.rest.sort_by_key(|&pair| spread.bucket(pair));
        self.counts = spread.count(&self.rest);
        for (count, &[start, next, _]) in self.counts.iter_mut().zip(&self.rooms) {
            *count += next - start;
        }
    }

    /// The pairs of a bucket: those that had room, then the others, which came later.
    pub(super) fn runs(&self, bucket: usize) -> [&[Pair]; 2] {
        let [start, next, _] = self.rooms[bucket];
        let place = |bucket: usize| match self.spread {
            Some(spread) if !self.rest.is_empty() => self.rest.partition_point(|&pair| spread.bucket(pair) < bucket),
            _ => 0,
        };
        [&self.held[start as usize..next as usize], &self.rest[place(bucket)..place(bucket + 1)]]
    }

    /// How many pairs of each bucket there are.
    pub(super) fn counts(&self) -> &Counts {
        &self.counts
    }

    /// The pairs without a room.
    pub(super) fn rest(&self) -> &[Pair] {
        &self.rest
    }

    /// How many pairs there are.
    pub(super) fn len(&self) -> usize {
        let held: usize = self.rooms.iter().map(|[start, next, _]| (next - start) as usize).sum();
        held + self.rest.len()
    }

    fn plan_rooms(&mut self, room: impl Fn(usize) -> u32) {
        self.rooms.clear();
        let mut start = 0;
        self.rooms.extend((0..BUCKETS).map(|bucket| {
            let first = start;
            start += room(bucket);
            [first, first, start]
        }));
    }

    /// Makes memory for what is planned; it is never given back.
    fn make_room(&mut self) {
        let end = self.rooms.last().map_or(0, |[.., end]| *end as usize);
        if self.held.len() < end {
            self.held.resize(end, 0);
        }
    }
}
