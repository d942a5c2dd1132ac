//! `Source`: the scalars of a field as samplers read them, in place and in the type of the file.
//!
//! Scalars of types that f32 holds are read as they are. Components, magnitudes and wide types are converted value by value, less an offset
//! where they vary little around a large value.

use super::dispatch::Dispatch;
use super::gather;
use crate::columns::{Sample, SampleVisitor, Samples, VolumeField};
use crate::optics::lanes::LANES;

/// Scalars by their number.
pub(super) trait Source: Copy + Sync {
    /// The type in which they are fetched.
    type Value: Sample;
    /// Two of them, side by side, as they are fetched at once.
    type Pair: Copy + bytemuck::Zeroable;

    /// Scalar `i`.
    fn get(&self, i: usize) -> Self::Value;

    /// Scalars `start + o` and the one after for each offset o, of which the last is the greatest.
    fn pairs(&self, start: usize, offsets: [usize; 4]) -> [Self::Pair; 4];

    /// Both of a pair.
    fn halves(pair: Self::Pair) -> [f32; 2];

    /// The same pairs at sixteen places, where the processor has an instruction for that.
    #[inline(always)]
    fn gathered(&self, _: Dispatch, _: &[u32; LANES], _: [usize; 4]) -> Option<[[u32; LANES]; 4]> {
        None
    }
}

/// Bytes as the file has them: a pair of them is one word, whose halves are told apart in vectors.
#[derive(Clone, Copy)]
struct Bytes<'a>(&'a [u8]);

impl Source for Bytes<'_> {
    type Value = u8;
    type Pair = u16;

    #[inline(always)]
    fn get(&self, i: usize) -> u8 {
        self.0[i]
    }

    #[inline(always)]
    fn pairs(&self, start: usize, offsets: [usize; 4]) -> [u16; 4] {
        let all = &self.0[start..start + (offsets[3] + 2)];
        offsets.map(|o| u16::from_le_bytes([all[o], all[o + 1]]))
    }

    #[inline(always)]
    fn halves(pair: u16) -> [f32; 2] {
        [f32::from(pair & 0xff), f32::from(pair >> 8)]
    }

    #[inline(always)]
    fn gathered(&self, dispatch: Dispatch, start: &[u32; LANES], offsets: [usize; 4]) -> Option<[[u32; LANES]; 4]> {
        gather::pairs(dispatch, self.0, start, offsets)
    }
}

/// Scalars as the file has them.
#[derive(Clone, Copy)]
struct InPlace<'a, T>(&'a [T]);

impl<T: Sample> Source for InPlace<'_, T> {
    type Value = T;
    type Pair = [T; 2];

    #[inline(always)]
    fn get(&self, i: usize) -> T {
        self.0[i]
    }

    #[inline(always)]
    fn pairs(&self, start: usize, offsets: [usize; 4]) -> [[T; 2]; 4] {
        // One check for all that depends on the place; the others are the same for every place.
        let all = &self.0[start..start + (offsets[3] + 2)];
        let at = |o: usize| [all[o], all[o + 1]];
        [at(offsets[0]), at(offsets[1]), at(offsets[2]), at(offsets[3])]
    }

    #[inline(always)]
    fn halves(pair: [T; 2]) -> [f32; 2] {
        pair.map(Sample::narrowed)
    }
}

/// Scalars that are computed as they are read.
#[derive(Clone, Copy)]
struct Converted<'a, T> {
    samples: Samples<'a, T>,
    offset: f64,
}

impl<T: Sample> Source for Converted<'_, T> {
    type Value = f32;
    type Pair = [f32; 2];

    #[inline(always)]
    fn get(&self, i: usize) -> f32 {
        (self.samples.get(i) - self.offset) as f32
    }

    #[inline(always)]
    fn pairs(&self, start: usize, offsets: [usize; 4]) -> [[f32; 2]; 4] {
        let at = |o: usize| [self.get(start + o), self.get(start + o + 1)];
        [at(offsets[0]), at(offsets[1]), at(offsets[2]), at(offsets[3])]
    }

    #[inline(always)]
    fn halves(pair: [f32; 2]) -> [f32; 2] {
        pair
    }
}

/// What stored values are relative to: 0, or the middle of a range that is narrow and far from it.
pub(super) fn offset_of(field: &VolumeField) -> f64 {
    let (low, high) = field.range;
    let is_wide = matches!(field.values.type_name(), "f64" | "i32" | "u32" | "i64" | "u64");
    if is_wide && low.abs().max(high.abs()) > 100.0 * (high - low) { 0.5 * low + 0.5 * high } else { 0.0 }
}

/// Work on a source, compiled for each.
pub(super) trait SourceVisitor {
    type Output;

    fn visit<S: Source>(self, source: &S) -> Self::Output;
}

struct Sourced<V> {
    offset: f64,
    /// Whether f32 holds every value of the type.
    is_narrow: bool,
    /// Whether the type is `u8`.
    is_bytes: bool,
    visitor: V,
}

impl<V: SourceVisitor> SampleVisitor for Sourced<V> {
    type Output = V::Output;

    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> V::Output {
        match samples.scalars().filter(|_| self.is_narrow) {
            Some(values) if self.is_bytes => self.visitor.visit(&Bytes(bytemuck::cast_slice(values))),
            Some(values) => self.visitor.visit(&InPlace(values)),
            None => self.visitor.visit(&Converted { samples, offset: self.offset }),
        }
    }
}

/// Does `visitor`'s work on the scalars of `field`.
pub(super) fn visit<V: SourceVisitor>(field: &VolumeField, visitor: V) -> V::Output {
    let is_narrow = matches!(field.values.type_name(), "i8" | "u8" | "i16" | "u16" | "f32");
    let is_bytes = field.values.type_name() == "u8";
    field.visit(Sourced { offset: offset_of(field), is_narrow, is_bytes, visitor })
}
