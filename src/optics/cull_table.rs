//! In: the pieces of a transfer function and a model. Out: whether a value interval is wholly transparent, in O(1).
//!
//! A running count of opaque pieces: an interval is transparent if no piece from that of its low end to that of its high end
//! counts. Exact but for an interval that ends on the very knot where extinction starts to rise from 0: it may be kept.

use super::intervals::Intervals;
use super::model::Model;
use super::pieces::{LinearPiece, Pieces};

/// Tells which value intervals show nothing; built once per transfer function, model and field offset.
///
/// Absorption by κ · (r, g, b, 1) is transparent where κ is 0, so three models share one table. Maximum intensity shows a cell
/// whatever its extinction: there nothing is transparent. Bands of their own are transparent where all of them are 0.
///
/// ```
/// # use cellfan::optics::{cull_table::CullTable, model::Model, transfer::{ControlPoint, TransferFunction}};
/// let point = |value, extinction| ControlPoint { value, color: [1.0; 3], extinction };
/// let transfer = TransferFunction::new(vec![point(0.5, 0.0), point(1.0, 8.0)])?;
/// let pieces = transfer.pieces(0.0);
/// let table = CullTable::new(&pieces, Model::EmissionAbsorption);
/// assert!(table.is_transparent(&pieces, 0.0, 0.49));
/// assert!(!table.is_transparent(&pieces, 0.0, 0.51));
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct CullTable {
    /// How many of the pieces before piece k show something; one more entry at the end.
    opaque_before_piece: Vec<u32>,
}

impl CullTable {
    /// The table for these pieces.
    pub fn new(pieces: &Pieces, model: Model) -> Self {
        Self::of(pieces.as_slice().iter().map(|piece| model.shows_transparent_cells() || !piece.is_transparent()))
    }

    /// The table for several passes over the same intervals: what shows in one of them shows.
    pub fn of_passes<P: LinearPiece>(passes: &[Pieces<P>]) -> Self {
        let pieces = passes.first().map_or(0, |pass| pass.len());
        Self::of((0..pieces).map(|k| passes.iter().any(|pass| !pass.piece(k).is_transparent())))
    }

    /// The table for pieces that show something or not.
    fn of(is_opaque: impl Iterator<Item = bool>) -> Self {
        let mut opaque = 0;
        let counts = is_opaque.map(|is_opaque| {
            opaque += u32::from(is_opaque);
            opaque
        });
        Self { opaque_before_piece: std::iter::once(0).chain(counts).collect() }
    }

    /// Whether nothing shows for low <= s <= high, with the intervals of the pieces that the table was built from; false if an end is NaN or they
    /// are in the wrong order.
    #[inline]
    pub fn is_transparent(&self, pieces: &Intervals, low: f32, high: f32) -> bool {
        low <= high
            && self.opaque_before_piece[pieces.piece_of(low)] == self.opaque_before_piece[pieces.piece_of(high) + 1]
    }

    /// Whether no value at all shows something.
    pub fn is_all_transparent(&self) -> bool {
        self.opaque_before_piece.last() == Some(&0)
    }

    /// Whether no interval can be culled, so that asking is not worth the time.
    pub fn is_all_opaque(&self) -> bool {
        self.opaque_before_piece.last().is_some_and(|&opaque| opaque as usize == self.opaque_before_piece.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::pieces::tests::random_transfer;
    use super::super::transfer::{ControlPoint, TransferFunction};
    use super::*;
    use proptest::prelude::*;

    /// The slow twin: extinction at both ends, at all control points between and on either side of them.
    fn is_transparent_slow(transfer: &TransferFunction, low: f32, high: f32) -> bool {
        let (low, high) = (f64::from(low), f64::from(high));
        let inside = transfer.points().iter().filter(|point| low <= point.value && point.value <= high);
        let at = inside.flat_map(|point| {
            let before =
                if point.value > low { transfer.eval(point.value.next_down().max(low)).extinction } else { 0.0 };
            [before, transfer.eval(point.value).extinction]
        });
        at.chain([transfer.eval(low).extinction, transfer.eval(high).extinction]).all(|extinction| extinction == 0.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        #[test]
        fn never_culls_what_shows(transfer in random_transfer(), ends in prop::collection::vec((-10.0..10.0_f32, 0.0..4.0_f32), 50)) {
            let pieces = transfer.pieces(0.0);
            let table = CullTable::new(&pieces, Model::EmissionAbsorption);
            let mip = CullTable::new(&pieces, Model::Mip);
            for (low, width) in ends {
                let knots = pieces.knots();
                let snap = |s: f32| knots.get(pieces.piece_of(s)).copied().unwrap_or(s);
                for (low, high) in [(low, low + width), (snap(low), low + width), (snap(low), snap(low + width)), (low, snap(low + width))] {
                    let fast = table.is_transparent(&pieces, low, high);
                    // Control points are not f32 values: leave out what the narrowing may have moved across an end.
                    let moved = transfer.points().iter().any(|point| {
                        let narrowed = f64::from(point.value as f32);
                        narrowed != point.value && [low, high].iter().any(|&end| (f64::from(end) - narrowed).abs() < 1e-5)
                    });
                    if low <= high && !moved {
                        let slow = is_transparent_slow(&transfer, low, high);
                        let at_knot = knots.contains(&high);
                        prop_assert!(!fast || slow, "culled {}..{} of {:?}", low, high, transfer);
                        prop_assert!(fast || !slow || at_knot, "kept {}..{} of {:?}", low, high, transfer);
                    }
                    prop_assert!(!mip.is_transparent(&pieces, low, high));
                }
            }
        }
    }

    #[test]
    fn nan_and_reversed_ends_are_kept() {
        let pieces = TransferFunction::constant([1.0; 3], 0.0).unwrap().pieces(0.0);
        let table = CullTable::new(&pieces, Model::Absorption);
        assert!(table.is_all_transparent() && !table.is_all_opaque());
        assert!(table.is_transparent(&pieces, f32::NEG_INFINITY, f32::INFINITY));
        assert!(!table.is_transparent(&pieces, f32::NAN, 1.0) && !table.is_transparent(&pieces, 0.0, f32::NAN));
        assert!(!table.is_transparent(&pieces, 1.0, 0.0));
    }

    #[test]
    fn a_gap_between_two_peaks_is_found() {
        let point = |value, extinction| ControlPoint { value, color: [1.0; 3], extinction };
        let peaks = [(0.0, 0.0), (1.0, 3.0), (2.0, 0.0), (4.0, 0.0), (5.0, 3.0), (6.0, 0.0)];
        let pieces = TransferFunction::new(peaks.map(|(v, k)| point(v, k)).to_vec()).unwrap().pieces(0.0);
        let table = CullTable::new(&pieces, Model::Emission);
        assert!(table.is_transparent(&pieces, 2.0, 3.999));
        assert!(!table.is_transparent(&pieces, 1.999, 3.0) && !table.is_transparent(&pieces, 3.0, 4.001));
        assert!(!table.is_transparent(&pieces, -1.0, 9.0));
    }
}
