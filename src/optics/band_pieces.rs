//! In: bands, the colours of a transfer function where light is emitted too, the offset of a stored field. Out: linear pieces in
//! f32, four bands a pass, or two with their colours: what four numbers a pixel can hold.
//!
//! All passes have the same intervals, so that they draw the same cells.

use super::bands::{BandPoint, BandTable, eval, eval_below};
use super::cull_table::CullTable;
use super::lanes::max;
use super::pieces::{LinearPiece, Pieces, slope};
use super::transfer::TransferFunction;

/// Bands of one pass.
pub const BANDS_PER_PASS: usize = 4;

/// Bands of one pass with emission: light and transmittance of each are two numbers.
pub const GLOWING_BANDS_PER_PASS: usize = 2;

/// Extinctions and colours of a pass's bands, linear in s as those of a [`Piece`](super::Piece). A pass that has bands to spare holds the
/// last one again; with emission two of four are used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandPiece {
    /// Where the piece begins (the first: where it ends).
    pub start: f32,
    /// At `start`, per world unit length.
    pub extinction: [f32; 4],
    /// Per unit of s.
    pub extinction_slope: [f32; 4],
    /// Of what is emitted, at `start`.
    pub color: [f32; 4],
    /// Per unit of s.
    pub color_slope: [f32; 4],
}

impl BandPiece {
    /// Extinction of band c at s.
    #[inline(always)]
    pub fn extinction_of(&self, c: usize, s: f32) -> f32 {
        self.extinction[c] + (s - self.start) * self.extinction_slope[c]
    }

    /// Colour of band c at s.
    #[inline(always)]
    pub fn color_of(&self, c: usize, s: f32) -> f32 {
        self.color[c] + (s - self.start) * self.color_slope[c]
    }
}

impl LinearPiece for BandPiece {
    fn is_transparent(&self) -> bool {
        self.extinction.iter().chain(&self.extinction_slope).all(|&number| number == 0.0)
    }

    #[inline(always)]
    fn extinction_at(&self, s: f32) -> f32 {
        let of = |c| self.extinction_of(c, s);
        max(max(of(0), of(1)), max(of(2), of(3)))
    }
}

/// The passes of all bands over one field.
#[derive(Clone, Debug)]
pub struct BandPasses {
    /// How many bands there are; each pass but the last is full.
    pub bands: usize,
    /// Pieces of each pass, the bands in their order.
    pub passes: Vec<Pieces<BandPiece>>,
    /// A cell can be left out only where no band has extinction.
    pub cull_table: CullTable,
}

/// Columns from one knot to the next; the first and the last are constant and have no outer end.
struct Stretch {
    start: f32,
    end: f32,
    from: Vec<f64>,
    to: Vec<f64>,
}

impl BandTable {
    /// The bands over s = value - offset, four a pass.
    pub fn passes(&self, offset: f64) -> BandPasses {
        of_columns(self.points(), self.names().len(), offset, BANDS_PER_PASS)
    }

    /// The bands over s = value - offset, two a pass. The first glows with colour channel `channel` of `transfer`, the next ones with
    /// those that follow, and bands beyond blue with 1.
    pub fn glowing_passes(&self, transfer: &TransferFunction, channel: usize, offset: f64) -> BandPasses {
        let bands = self.names().len();
        let color =
            |channels: [f64; 3]| (channel..channel + bands).map(move |k| channels.get(k).copied().unwrap_or(1.0));
        let colors: Vec<BandPoint> = transfer
            .points()
            .iter()
            .map(|point| BandPoint { value: point.value, extinctions: color(point.color).collect() })
            .collect();
        of_columns(&merged(self.points(), &colors), bands, offset, GLOWING_BANDS_PER_PASS)
    }
}

/// The columns of both, with the control points of both.
fn merged(a: &[BandPoint], b: &[BandPoint]) -> Vec<BandPoint> {
    let mut values: Vec<f64> = a.iter().chain(b).map(|point| point.value).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let mut points: Vec<BandPoint> = Vec::with_capacity(2 * values.len());
    for value in values {
        // At a step, what holds below it and what holds above it.
        let below = [eval_below(a, value), eval_below(b, value)].concat();
        let above = [eval(a, value), eval(b, value)].concat();
        if below != above {
            points.push(BandPoint { value, extinctions: below });
        }
        points.push(BandPoint { value, extinctions: above });
    }
    points
}

/// Passes of `per_pass` bands each; columns are the extinctions of all `bands`, then their colours, if there are any.
fn of_columns(points: &[BandPoint], bands: usize, offset: f64, per_pass: usize) -> BandPasses {
    let stretches = stretches(points, offset);
    let knots: Vec<f32> = stretches[1..].iter().map(|stretch| stretch.start).collect();
    let pass = |first: usize| {
        let pieces = stretches.iter().map(|stretch| {
            let column = |c: usize, of: &[f64]| {
                // The last band again: it ends rays where its twin does.
                let band = (first + c).min(bands - 1);
                let is_mine = c < per_pass;
                [band, bands + band].map(|column| of.get(column).copied().filter(|_| is_mine).unwrap_or(0.0))
            };
            let ends = [stretch.start, stretch.end];
            let at = |k: usize| std::array::from_fn(|c| column(c, &stretch.from)[k] as f32);
            let rise = |k: usize| {
                std::array::from_fn(|c| slope(ends, [column(c, &stretch.from)[k], column(c, &stretch.to)[k]]))
            };
            BandPiece {
                start: stretch.start,
                extinction: at(0),
                extinction_slope: rise(0),
                color: at(1),
                color_slope: rise(1),
            }
        });
        Pieces::new(pieces.collect(), knots.clone())
    };
    let passes: Vec<_> = (0..bands).step_by(per_pass).map(pass).collect();
    let cull_table = CullTable::of_passes(&passes);
    BandPasses { bands, passes, cull_table }
}

/// What lies between control points, in f32: steps become two stretches, points that are one f32 become a step.
fn stretches(points: &[BandPoint], offset: f64) -> Vec<Stretch> {
    let narrow = |point: &BandPoint| ((point.value - offset) as f32).clamp(f32::MIN, f32::MAX);
    let constant = |point: &BandPoint| {
        let (from, to) = (point.extinctions.clone(), point.extinctions.clone());
        Stretch { start: narrow(point), end: f32::INFINITY, from, to }
    };
    let mut stretches = vec![constant(&points[0])];
    let mut push = |next: Stretch| {
        let before = &stretches[stretches.len() - 1];
        let continues = before.from == before.to && next.from == next.to && before.from == next.from;
        if !continues {
            stretches.push(next);
        }
    };
    for pair in points.windows(2) {
        let (start, end) = (narrow(&pair[0]), narrow(&pair[1]));
        if start < end {
            push(Stretch { start, end, from: pair[0].extinctions.clone(), to: pair[1].extinctions.clone() });
        }
    }
    push(constant(&points[points.len() - 1]));
    stretches
}
