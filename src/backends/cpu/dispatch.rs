//! Run-time dispatch: the same kernel compiled for several instruction sets, chosen by what the processor offers.
//!
//! The kernels use no fused or reordered operations, so that every instruction set gives the same bits.
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]

use super::composite::{Scratch, composite};
use super::cubes::{BinnedCube, CubeTile};
use super::simd::ByLane;
#[cfg(target_arch = "x86_64")]
use super::simd::{ByAvx2, ByAvx512};
use super::sink::Sink;
use super::tile::TileFrame;
use crate::backends::Frame;
use crate::optics::{LANES, Optics};
use crate::stages::footprints::planes::Corners;
use crate::stages::footprints::{BoxLanes, PixelBoxes};
use crate::stages::sort::KeyMaker;
use crate::stages::sort::radix::Pair;

/// An instruction set that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// What every processor of the target has (SSE2 on x86-64, NEON on aarch64).
    Baseline,
    /// AVX2, with the bit counts that its processors have.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 F, BW, DQ, VL, and AVX2.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl InstructionSet {
    /// Those this processor has, best first.
    pub fn available() -> Vec<Self> {
        let mut sets = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            let has_avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("popcnt")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2");
            if has_avx2
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
            {
                sets.push(Self::Avx512);
            }
            if has_avx2 {
                sets.push(Self::Avx2);
            }
        }
        sets.push(Self::Baseline);
        sets
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "avx512",
        }
    }
}

/// The kernels of one instruction set that this processor has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernels {
    pub(super) set: InstructionSet,
}

impl Kernels {
    /// The kernels for `set`, or for the best set there is where the processor lacks it.
    pub(super) fn new(set: Option<InstructionSet>) -> Self {
        let available = InstructionSet::available();
        let set = set.filter(|set| available.contains(set)).unwrap_or(available[0]);
        Self { set }
    }

    /// [`composite`] for this instruction set.
    pub(super) fn composite<O: Optics, S: Sink<O>>(
        self,
        tile: &TileFrame,
        optics: &O,
        order: &[Pair],
        scratch: &mut Scratch,
        sink: &mut S,
    ) {
        match self.set {
            InstructionSet::Baseline => composite(tile, optics, order, ByLane, scratch, sink),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Kernels::new`, the only constructor, keeps a set only if `available` detected its features.
            InstructionSet::Avx2 => unsafe { composite_avx2(tile, optics, order, scratch, sink) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            InstructionSet::Avx512 => unsafe { composite_avx512(tile, optics, order, scratch, sink) },
        }
    }
}

impl Kernels {
    /// [`PixelBoxes::of_lanes`] for this instruction set.
    pub(super) fn boxes(self, boxes: &PixelBoxes, corners: &Corners, found: &mut BoxLanes) {
        match self.set {
            InstructionSet::Baseline => boxes.of_lanes(corners, found),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx2 => unsafe { boxes_avx2(boxes, corners, found) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx512 => unsafe { boxes_avx512(boxes, corners, found) },
        }
    }

    /// [`KeyMaker::of_lanes`] for this instruction set.
    pub(super) fn keys(self, keys: &KeyMaker, corners: &Corners, key: &mut [u32; LANES]) {
        match self.set {
            InstructionSet::Baseline => keys.of_lanes(corners, key),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx2 => unsafe { keys_avx2(keys, corners, key) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx512 => unsafe { keys_avx512(keys, corners, key) },
        }
    }

    /// [`CubeTile::composite`] for this instruction set.
    pub(super) fn cubes<O: Optics>(self, tile: &mut CubeTile, frame: &Frame, optics: &O, cubes: &[BinnedCube]) {
        match self.set {
            InstructionSet::Baseline => tile.composite(frame, optics, cubes),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx2 => unsafe { cubes_avx2(tile, frame, optics, cubes) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx512 => unsafe { cubes_avx512(tile, frame, optics, cubes) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn cubes_avx2<O: Optics>(tile: &mut CubeTile, frame: &Frame, optics: &O, cubes: &[BinnedCube]) {
    tile.composite(frame, optics, cubes);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn cubes_avx512<O: Optics>(tile: &mut CubeTile, frame: &Frame, optics: &O, cubes: &[BinnedCube]) {
    tile.composite(frame, optics, cubes);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn boxes_avx2(boxes: &PixelBoxes, corners: &Corners, found: &mut BoxLanes) {
    boxes.of_lanes(corners, found);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn boxes_avx512(boxes: &PixelBoxes, corners: &Corners, found: &mut BoxLanes) {
    boxes.of_lanes(corners, found);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn keys_avx2(keys: &KeyMaker, corners: &Corners, key: &mut [u32; LANES]) {
    keys.of_lanes(corners, key);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn keys_avx512(keys: &KeyMaker, corners: &Corners, key: &mut [u32; LANES]) {
    keys.of_lanes(corners, key);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn composite_avx2<O: Optics, S: Sink<O>>(
    tile: &TileFrame,
    optics: &O,
    order: &[Pair],
    scratch: &mut Scratch,
    sink: &mut S,
) {
    // SAFETY: this function itself may run only where the processor has AVX2.
    composite(tile, optics, order, unsafe { ByAvx2::new() }, scratch, sink);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn composite_avx512<O: Optics, S: Sink<O>>(
    tile: &TileFrame,
    optics: &O,
    order: &[Pair],
    scratch: &mut Scratch,
    sink: &mut S,
) {
    // SAFETY: this function itself may run only where the processor has AVX-512 F.
    composite(tile, optics, order, unsafe { ByAvx512::new() }, scratch, sink);
}
