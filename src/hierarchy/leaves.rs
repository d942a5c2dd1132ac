//! The smallest boxes of the hierarchy: samples, or what lies between eight points, in single precision, less an offset.

use super::level::{Interpolation, Node, index};
use crate::columns::{Sample, Samples};

/// A field's samples as stored values, and the smallest boxes that they make.
#[derive(Clone, Copy)]
pub(super) struct Leaves<'a, T> {
    samples: Samples<'a, T>,
    offset: f64,
    interpolation: Interpolation,
    /// Samples along i, j and k.
    dims: [u32; 3],
}

impl<'a, T: Sample> Leaves<'a, T> {
    /// Of `boxes` along i, j and k.
    pub(super) fn new(samples: Samples<'a, T>, offset: f64, interpolation: Interpolation, boxes: [u32; 3]) -> Self {
        let more = u32::from(interpolation == Interpolation::Trilinear);
        Self { samples, offset, interpolation, dims: boxes.map(|boxes| boxes + more) }
    }

    pub(super) fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// Stored value `i`; NaN where it is not finite.
    #[inline]
    fn get(&self, i: usize) -> f32 {
        let value =
            if self.offset == 0.0 { self.samples.get_f32(i) } else { (self.samples.get(i) - self.offset) as f32 };
        if value.is_finite() { value } else { f32::NAN }
    }

    /// The stored value of a sample.
    #[inline]
    pub(super) fn value(&self, sample: [u32; 3]) -> f32 {
        self.get(index(self.dims, sample))
    }

    /// The smallest box at (i, j, k).
    #[inline]
    pub(super) fn node(&self, at: [u32; 3]) -> Node {
        let first = index(self.dims, at);
        if self.interpolation == Interpolation::Constant {
            return Node::of_sample(self.get(first));
        }
        let [row, layer] = [self.dims[0] as usize, self.dims[0] as usize * self.dims[1] as usize];
        let (mut min, mut max, mut is_finite) = (f32::INFINITY, f32::NEG_INFINITY, true);
        for pair in [first, first + row, first + layer, first + layer + row] {
            for value in [self.get(pair), self.get(pair + 1)] {
                is_finite &= !value.is_nan();
                min = if value < min { value } else { min };
                max = if value > max { value } else { max };
            }
        }
        Node::of_points([min, max], is_finite)
    }
}
