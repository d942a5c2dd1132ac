//! `gather`: pairs of neighbouring bytes at sixteen places, fetched as words by one instruction for each of four rows.
#![expect(unsafe_code, reason = "a gather reads through addresses, which are kept within the slice")]

use super::dispatch::Dispatch;
use crate::optics::lanes::LANES;

/// The bytes `start + o` and the one after, as the lower half of a word, for each lane and each of four offsets o, of which the last is the
/// greatest; none where the processor has no such instruction, or the slice is too short or too long for it. What lies beyond the
/// slice is never read; a place there gives any word.
#[inline(always)]
pub(super) fn pairs(
    dispatch: Dispatch,
    bytes: &[u8],
    start: &[u32; LANES],
    offsets: [usize; 4],
) -> Option<[[u32; LANES]; 4]> {
    #[cfg(target_arch = "x86_64")]
    if dispatch.has_avx512() && i32::try_from(bytes.len()).is_ok() && bytes.len() >= offsets[3].saturating_add(4) {
        // SAFETY: `Dispatch` says so only of a processor that has the instructions.
        return Some(unsafe { pairs_avx512(bytes, start, offsets) });
    }
    let _ = (dispatch, bytes, start, offsets);
    None
}

#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx512f")]
fn pairs_avx512(bytes: &[u8], start: &[u32; LANES], offsets: [usize; 4]) -> [[u32; LANES]; 4] {
    use std::arch::x86_64::{
        _mm512_i32gather_epi32, _mm512_loadu_epi32, _mm512_min_epu32, _mm512_set1_epi32, _mm512_slli_epi32,
        _mm512_srlv_epi32, _mm512_storeu_epi32, _mm512_sub_epi32,
    };
    let limit = bytes.len() - 4 - offsets[3];
    // SAFETY: sixteen words are read from `start`.
    let start = unsafe { _mm512_loadu_epi32(start.as_ptr().cast()) };
    // A word that would end beyond the slice begins earlier, and its pair is further up in it.
    let first = _mm512_min_epu32(start, _mm512_set1_epi32(limit as i32));
    let shift = _mm512_slli_epi32::<3>(_mm512_sub_epi32(start, first));
    offsets.map(|offset| {
        debug_assert!(limit + offset + 4 <= bytes.len() && i32::try_from(limit).is_ok());
        // SAFETY: `first` is at most `limit`, which as an i32 is not negative, and `limit + offset + 4` at most the slice's length.
        let words = unsafe { _mm512_i32gather_epi32::<1>(first, bytes.as_ptr().add(offset).cast()) };
        let mut out = [0; LANES];
        // SAFETY: sixteen words are written to `out`.
        unsafe { _mm512_storeu_epi32(out.as_mut_ptr().cast(), _mm512_srlv_epi32(words, shift)) };
        out
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gathered_pairs_are_those_that_are_read_one_by_one() {
        let bytes: Vec<u8> = (0..997_u32).map(|i| (i * i % 251) as u8).collect();
        let offsets = [0, 10, 70, 80];
        for round in 0..60 {
            let last = bytes.len() as u32 - 82;
            let start: [u32; LANES] = std::array::from_fn(|l| (round * 7919 + l as u32 * 104_729) % (last + 1));
            // The last places of the slice, whose words would end beyond it.
            let start = if round < 3 { start.map(|start| last - start % 3) } else { start };
            let Some(found) = pairs(Dispatch::new(None), &bytes, &start, offsets) else { return };
            for (words, offset) in found.iter().zip(offsets) {
                for (word, start) in words.iter().zip(start) {
                    let at = start as usize + offset;
                    assert_eq!([*word as u8, (*word >> 8) as u8], [bytes[at], bytes[at + 1]], "{start} {offset}");
                }
            }
        }
        // Places that there are none of are not read.
        assert!(pairs(Dispatch::new(None), &bytes, &[u32::MAX; LANES], offsets).is_some());
        assert!(pairs(Dispatch::new(None), &bytes[..83], &[0; LANES], offsets).is_none());
    }
}
