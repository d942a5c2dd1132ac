//! The samples of a field as the hierarchy stores values: single precision, less an offset.

use crate::columns::{Sample, Samples};

/// A field's samples as stored values.
#[derive(Clone, Copy)]
pub(super) struct Leaves<'a, T> {
    samples: Samples<'a, T>,
    offset: f64,
}

impl<'a, T: Sample> Leaves<'a, T> {
    pub(super) fn new(samples: Samples<'a, T>, offset: f64) -> Self {
        Self { samples, offset }
    }

    /// Stored value `i`; NaN where it is not finite.
    #[inline]
    pub(super) fn get(&self, i: usize) -> f32 {
        let value =
            if self.offset == 0.0 { self.samples.get_f32(i) } else { (self.samples.get(i) - self.offset) as f32 };
        if value.is_finite() { value } else { f32::NAN }
    }
}
