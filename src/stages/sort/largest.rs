//! `largest`: cells by their largest values, falling: for maximum intensity, which ends where no value left can be larger.
//!
//! In: the values of a field. Out: a key per cell, 1 to 255 in equal steps over the field's range, so that one pass of a radix sort
//! does, and cells of about the same value keep the order of memory. Of a key, the largest value that its cells may have.

use crate::columns::{Association, Field};

/// Keys, from the one of the largest values on; 0 is that of any value.
const FIRST: u32 = 1;
const LAST: u32 = 255;

/// Orders by the largest value, largest first.
#[derive(Clone, Copy, Debug)]
pub struct Largest<'a> {
    /// The values of cell data; point data comes with the corners.
    cell_values: Option<&'a [f32]>,
    high: f32,
    keys_per_unit: f32,
}

impl<'a> Largest<'a> {
    /// For the stored values of a field.
    ///
    /// ```
    /// # use cellfan::columns::Dataset;
    /// # use cellfan::generate::{Settings, tets};
    /// # use cellfan::stages::sort::largest::Largest;
    /// let dataset = Dataset::from_tets(tets(&Settings { cells: 10, ..Settings::default() })?)?;
    /// let field = dataset.homogeneous_field();
    /// let largest = Largest::new(&field);
    /// assert!(largest.at_most(largest.key(field.values[0])) >= field.values[0]);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn new(field: &'a Field) -> Self {
        let none = (f32::INFINITY, f32::NEG_INFINITY);
        let (low, high) = field.block_ranges.iter().fold(none, |(a, b), &(low, high)| (a.min(low), b.max(high)));
        let keys_per_unit = (LAST - FIRST) as f32 / (high - low);
        Self {
            cell_values: (field.association == Association::Cell).then_some(&field.values[..]),
            high,
            // One value, or none, or a range beyond what f32 holds: one key.
            keys_per_unit: if keys_per_unit.is_finite() { keys_per_unit.max(0.0) } else { 0.0 },
        }
    }

    /// The values of cell data, where that is what the field is.
    #[inline]
    pub fn cell_values(&self) -> Option<&'a [f32]> {
        self.cell_values
    }

    /// The key of a cell whose largest value is `s_max`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "part of kernels that are compiled for wider vectors")]
    pub fn key(&self, s_max: f32) -> u32 {
        // A conversion keeps within the range of its type.
        FIRST + (((self.high - s_max) * self.keys_per_unit) as u32).min(LAST - FIRST)
    }

    /// A value that cells of this key, or of a greater one, do not exceed: that of the key before, as keys are rounded.
    #[inline]
    pub fn at_most(&self, key: u32) -> f32 {
        let keys = key.saturating_sub(FIRST + 1);
        if keys == 0 {
            return f32::INFINITY;
        }
        (f64::from(self.high) - f64::from(keys) / f64::from(self.keys_per_unit)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::testing::Random;

    #[test]
    fn keys_fall_with_values_and_bound_them() {
        let mut random = Random::new(5);
        for (low, high) in
            [(0.0_f32, 1.0_f32), (-3e4, 2e-3), (1e6, 1e6 + 0.5), (1e-40, 3e-40), (-3e38, 3e38), (2.0, 2.0)]
        {
            let keys_per_unit = (LAST - FIRST) as f32 / (high - low);
            let keys_per_unit = if keys_per_unit.is_finite() { keys_per_unit } else { 0.0 };
            let largest = Largest { cell_values: None, high, keys_per_unit };
            let mut values: Vec<f32> = (0..2000)
                .map(|_| (low + (high - low) * random.unit() as f32).clamp(low, high))
                .chain([low, high])
                .collect();
            values.sort_by(f32::total_cmp);
            let keys: Vec<u32> = values.iter().map(|&value| largest.key(value)).collect();
            assert!(keys.is_sorted_by(|a, b| a >= b), "{low} to {high}");
            for (&value, &key) in values.iter().zip(&keys) {
                assert!((FIRST..=LAST).contains(&key));
                assert!(value <= largest.at_most(key), "{value} of {low} to {high}");
            }
            // Two steps of the range at most, where f32 has as many numbers.
            if (high - low - 1.0).abs() < 1e-6 {
                assert!(
                    values
                        .iter()
                        .zip(&keys)
                        .skip(100)
                        .all(|(&value, &key)| key < 3 || largest.at_most(key) < value + 0.009)
                );
            }
        }
    }
}
