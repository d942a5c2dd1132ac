//! Sixteen lanes in the registers of an instruction set: what is added, compared and chosen in them, chosen lanes moved together, and
//! back. One or two instructions each where the processor has them, a loop elsewhere, the same bits.
//!
//! Loops over plain arrays become the same instructions where they are short; where a loop needs all registers there are, the
//! compiler is better told which they are.
//! To add an instruction set: a file like [`avx512`], and its kernels in [`dispatch`](super::dispatch).

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod by_lane;
#[cfg(test)]
mod tests;

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::ByAvx2;
#[cfg(target_arch = "x86_64")]
pub(super) use avx512::ByAvx512;
pub(super) use by_lane::ByLane;

use crate::optics::{LANES, Lanes, Mask};

/// What an instruction set does with sixteen lanes.
pub(super) trait Simd: Copy {
    /// Sixteen numbers in registers.
    type Vector: Copy;

    fn load(self, from: &Lanes) -> Self::Vector;
    fn store(self, vector: Self::Vector, to: &mut Lanes);
    /// One number in all lanes.
    fn splat(self, value: f32) -> Self::Vector;
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn abs(self, a: Self::Vector) -> Self::Vector;
    /// As [`lanes::min`](crate::optics::lanes::min).
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// As [`lanes::max`](crate::optics::lanes::max).
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// All bits of all lanes set, or none.
    fn splat_mask(self, mask: u32) -> Self::Vector;
    /// `a` where the bits of `mask` are set, `b` elsewhere.
    fn select(self, mask: Self::Vector, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// One bit for each lane in which a < b.
    fn bits_where_less(self, a: Self::Vector, b: Self::Vector) -> u16;
    /// The lanes whose bit is set, moved together to the front; anything after them.
    fn pack(self, lanes: u16, from: Self::Vector) -> Self::Vector;

    /// One bit for each lane of the mask that is set.
    fn bits(self, mask: &Mask) -> u16;
    /// The lanes whose bit is set, moved together to the front; anything after them.
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes;
    /// The reverse: the first numbers of `packed` in the lanes whose bit is set, `elsewhere` in the others.
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes;
    /// Puts one number in the lanes whose bit is set.
    fn put(self, lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes;

    /// Row `at[i]` of a table for each lane i, by columns.
    ///
    /// # Panics
    /// If there is no such row.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]
    fn rows(self, table: &[[f32; 4]], at: &[u32; LANES]) -> [Lanes; 4] {
        let mut columns = [[0.0; LANES]; 4];
        for (lane, &at) in at.iter().enumerate() {
            let row = table[at as usize];
            for c in 0..4 {
                columns[c][lane] = row[c];
            }
        }
        columns
    }

    /// The same of a table of pairs.
    ///
    /// # Panics
    /// If there is no such row.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]
    fn pairs(self, table: &[[u32; 2]], at: &[u32; LANES]) -> [[u32; LANES]; 2] {
        let mut columns = [[0; LANES]; 2];
        for (lane, &at) in at.iter().enumerate() {
            [columns[0][lane], columns[1][lane]] = table[at as usize];
        }
        columns
    }
}

/// For each pattern of eight lanes, the set ones in order, then zeros.
static LANE_FROM_PACKED: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut lanes = 0;
    while lanes < 256 {
        let (mut lane, mut len) = (0, 0);
        while lane < 8 {
            if lanes >> lane & 1 == 1 {
                table[lanes][len] = lane as u8;
                len += 1;
            }
            lane += 1;
        }
        lanes += 1;
    }
    table
};

/// For each pattern of eight lanes and each lane, how many set ones come before it.
static PACKED_FROM_LANE: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut lanes = 0;
    while lanes < 256 {
        let mut lane = 1;
        while lane < 8 {
            table[lanes][lane] = table[lanes][lane - 1] + (lanes >> (lane - 1) & 1) as u8;
            lane += 1;
        }
        lanes += 1;
    }
    table
};
