//! Lane by lane, in loops that become the vector code of any instruction set.
#![expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]

use super::{LANE_FROM_PACKED, PACKED_FROM_LANE, Simd};
use crate::optics::lanes::{self, LANES, Lanes, Mask};

/// Lane by lane.
#[derive(Clone, Copy, Debug)]
pub(in crate::backends::cpu) struct ByLane;

/// Lane by lane: the same for two vectors.
#[inline(always)]
fn each(a: Lanes, b: Lanes, of: impl Fn(f32, f32) -> f32) -> Lanes {
    let mut result = [0.0; LANES];
    for i in 0..LANES {
        result[i] = of(a[i], b[i]);
    }
    result
}

impl Simd for ByLane {
    type Vector = Lanes;

    #[inline(always)]
    fn load(self, from: &Lanes) -> Lanes {
        *from
    }

    #[inline(always)]
    fn store(self, vector: Lanes, to: &mut Lanes) {
        *to = vector;
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Lanes {
        [value; LANES]
    }

    #[inline(always)]
    fn add(self, a: Lanes, b: Lanes) -> Lanes {
        each(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn mul(self, a: Lanes, b: Lanes) -> Lanes {
        each(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn abs(self, a: Lanes) -> Lanes {
        each(a, a, |a, _| a.abs())
    }

    #[inline(always)]
    fn min(self, a: Lanes, b: Lanes) -> Lanes {
        each(a, b, lanes::min)
    }

    #[inline(always)]
    fn max(self, a: Lanes, b: Lanes) -> Lanes {
        each(a, b, lanes::max)
    }

    #[inline(always)]
    fn splat_mask(self, mask: u32) -> Lanes {
        [f32::from_bits(mask); LANES]
    }

    #[inline(always)]
    fn select(self, mask: Lanes, a: Lanes, b: Lanes) -> Lanes {
        let mut result = [0.0; LANES];
        for i in 0..LANES {
            result[i] = lanes::select(mask[i].to_bits(), a[i], b[i]);
        }
        result
    }

    #[inline(always)]
    fn bits_where_less(self, a: Lanes, b: Lanes) -> u16 {
        let mut is_less = [0; LANES];
        for i in 0..LANES {
            is_less[i] = lanes::mask(a[i] < b[i]);
        }
        self.bits(&is_less)
    }

    #[inline(always)]
    fn pack(self, lanes: u16, from: Lanes) -> Lanes {
        self.compress(lanes, &from)
    }

    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        mask.iter().enumerate().fold(0, |bits, (lane, mask)| bits | mask & 1 << lane) as u16
    }

    #[inline(always)]
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let (low_order, high_order) = (&LANE_FROM_PACKED[low as usize], &LANE_FROM_PACKED[high as usize]);
        let mut to = [0.0; LANES + 8];
        let middle = low.count_ones() as usize;
        for i in 0..8 {
            to[i] = from[low_order[i] as usize % 8];
        }
        for i in 0..8 {
            to[middle % 9 + i] = from[8 + high_order[i] as usize % 8];
        }
        let mut packed = [0.0; LANES];
        packed.copy_from_slice(&to[..LANES]);
        packed
    }

    #[inline(always)]
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let (low_order, high_order) = (&PACKED_FROM_LANE[low as usize], &PACKED_FROM_LANE[high as usize]);
        let middle = low.count_ones() as usize;
        let mut to = [0.0; LANES];
        for i in 0..8 {
            to[i] = packed[low_order[i] as usize % 8];
            to[8 + i] = packed[(middle + high_order[i] as usize) % LANES];
        }
        for (lane, to) in to.iter_mut().enumerate() {
            *to = if lanes >> lane & 1 == 1 { *to } else { elsewhere };
        }
        to
    }

    #[inline(always)]
    fn put(self, lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        let mut to = *elsewhere;
        for (lane, to) in to.iter_mut().enumerate() {
            *to = if lanes >> lane & 1 == 1 { value } else { *to };
        }
        to
    }
}
