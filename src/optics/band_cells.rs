//! Absorption in bands whose extinctions are columns over cells, four a pass: length × κ of each.
//!
//! Contribution: the optical depth of each band of the pass. κ is constant in a cell, so that neither the scalar nor its pieces
//! are looked at: the cell is asked for once, whatever the number of its segments.

use super::compositing::{CellSpan, Optics};
use super::lanes::{Contribution, LANES, Segments, max, min};
use super::model::Output;

/// A band's extinction per world unit length in each cell: `offset + values[cell]`.
#[derive(Clone, Copy, Debug)]
pub struct BandColumn<'a> {
    /// Stored values, one a cell of the dataset.
    pub values: &'a [f32],
    /// What is added to each.
    pub offset: f64,
}

impl BandColumn<'_> {
    /// The extinction of a cell; 0 where the column has none, as it is where a value is not a number or below 0.
    #[inline(always)]
    pub fn extinction_of(&self, cell: usize) -> f32 {
        let extinction = self.values.get(cell).map_or(0.0, |&value| (self.offset + f64::from(value)) as f32);
        min(max(extinction, 0.0), f32::MAX)
    }
}

/// The exact optical depth of up to four columns.
///
/// For a compositor that says which cell a segment is of, [`CellSpan::cell`]; elsewhere nothing absorbs.
#[derive(Clone, Copy, Debug)]
pub struct BandCells<'a> {
    /// The bands of the pass; those beyond the last have depth 0.
    pub columns: &'a [BandColumn<'a>],
    /// What pixels hold.
    pub output: Output,
}

impl Optics for BandCells<'_> {
    const IS_ORDERED: bool = false;
    const IS_SUM: bool = true;
    const CLEAR: [f32; 4] = [0.0; 4];

    #[inline(always)]
    fn contributions(&self, span: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        let mut extinctions = [0.0; 4];
        if let Some(cell) = span.cell {
            for (extinction, column) in extinctions.iter_mut().zip(self.columns) {
                *extinction = column.extinction_of(cell);
            }
        }
        for (segments, out) in segments.iter().zip(out) {
            for c in 0..4 {
                for i in 0..LANES {
                    out[c][i] = segments.length_world[i] * extinctions[c];
                }
            }
        }
    }

    #[inline(always)]
    fn over(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
    }

    fn slipped_in(whole: [f32; 4], _: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]> {
        Some(Self::over(whole, fragment))
    }

    #[inline(always)]
    fn transmittance(_: [f32; 4]) -> f32 {
        1.0
    }

    fn pixel(&self, depths: [f32; 4]) -> [f32; 4] {
        self.output.of_depths(depths)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_extinction_is_none() {
        let values = [0.5, f32::NAN, f32::INFINITY, -3.0, f32::NEG_INFINITY];
        let found =
            |offset: f64| [0, 1, 2, 3, 4, 5].map(|cell| BandColumn { values: &values, offset }.extinction_of(cell));
        assert_eq!(found(0.0), [0.5, 0.0, f32::MAX, 0.0, 0.0, 0.0]);
        assert_eq!(found(1000.0), [1000.5, 0.0, f32::MAX, 997.0, 0.0, 0.0]);
    }
}
