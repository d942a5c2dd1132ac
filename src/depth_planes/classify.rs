//! `Classifier`: colour and extinction of sixteen scalars, or of the points around them.
//!
//! The transfer function's linear pieces, the same as everywhere, found through a table over the value range: a bin tells the first knot
//! that may be above a value, and seldom a second one has to be compared.

use super::sample::Corners;
use crate::optics::lanes::{LANES, Lanes, max, min};
use crate::optics::{LinearPiece, Piece, Pieces};

/// Bins of the table.
const BINS: usize = 4096;

/// A transfer function, ready to be asked for many values.
#[derive(Clone, Debug)]
pub(super) struct Classifier {
    pieces: Vec<Piece>,
    knots: Vec<f32>,
    /// For each bin how many knots lie in bins before it.
    knots_before_bin: Vec<u32>,
    low: f32,
    bins_per_unit: f32,
    /// Extinctions up to this are none.
    threshold: f32,
}

/// What sixteen samples look like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Looks {
    /// Per world unit length; 0 where nothing shows.
    pub(super) extinction: Lanes,
    piece: PieceOf,
}

/// Which piece values are in, for their colour.
#[derive(Clone, Copy, Debug)]
enum PieceOf {
    /// All in one: neighbours often are, and what is the same for all lanes needs no look-up.
    All(u32),
    Each([u32; LANES]),
}

impl Classifier {
    /// The function, with extinctions up to `threshold` taken for none.
    pub(super) fn new(pieces: &Pieces, threshold: f32) -> Self {
        let knots = pieces.knots().to_vec();
        let low = knots.first().copied().unwrap_or(0.0);
        let width = knots.last().map_or(0.0, |last| last - low);
        let bins_per_unit = if width > 0.0 { (BINS as f32 / width).min(f32::MAX) } else { 0.0 };
        let all = pieces.as_slice().to_vec();
        let mut this = Self { pieces: all, knots, knots_before_bin: vec![0; BINS + 1], low, bins_per_unit, threshold };
        for i in 0..this.knots.len() {
            let bin = this.bin(this.knots[i]);
            this.knots_before_bin[bin + 1] += 1;
        }
        for bin in 0..BINS {
            this.knots_before_bin[bin + 1] += this.knots_before_bin[bin];
        }
        this
    }

    /// Grows with s, in floating point too; 0 for NaN.
    #[inline(always)]
    fn bin(&self, s: f32) -> usize {
        (((s - self.low) * self.bins_per_unit) as i32).clamp(0, BINS as i32 - 1) as usize
    }

    /// The piece that holds s: the number of knots up to it.
    #[inline(always)]
    fn piece_of(&self, s: f32) -> usize {
        let mut piece = self.knots_before_bin[self.bin(s)] as usize;
        while piece < self.knots.len() && self.knots[piece] <= s {
            piece += 1;
        }
        piece
    }

    /// The extinction of a value; 0 below the threshold and for what is not finite.
    #[inline(always)]
    fn extinction_in(&self, piece: usize, s: f32) -> f32 {
        let extinction = self.pieces[piece].extinction_at(s);
        // The outermost pieces are level: infinity times their slope is NaN, which is not above either.
        if extinction > self.threshold { extinction } else { 0.0 }
    }

    /// Whether the values of all lanes that have a length are in one piece.
    #[inline(always)]
    fn are_in(&self, piece: u32, s: &Lanes, length: &Lanes) -> bool {
        let knots = &self.knots;
        let start = (piece as usize).checked_sub(1).map_or(f32::NEG_INFINITY, |knot| knots[knot]);
        let end = knots.get(piece as usize).copied().unwrap_or(f32::INFINITY);
        let mut are_in = true;
        for l in 0..LANES {
            let [is_above, is_below, is_empty] = [s[l] >= start, s[l] < end, length[l] <= 0.0];
            are_in &= (is_above & is_below) | is_empty;
        }
        are_in
    }

    /// Extinctions of the values of lanes that have a length, and anything in the others. `last` is the piece that all were in when there
    /// was one, which is often the one that they are in.
    #[inline(always)]
    pub(super) fn looks(&self, s: &Lanes, length: &Lanes, last: &mut u32) -> Looks {
        if self.are_in(*last, s, length) {
            return self.looks_in(*last, s);
        }
        let (mut low, mut high) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            (low[l], high[l]) = if length[l] > 0.0 { (s[l], s[l]) } else { (f32::INFINITY, f32::NEG_INFINITY) };
        }
        let (first, end) = (self.piece_of(least(&low)), self.piece_of(most(&high)));
        if first == end {
            *last = first as u32;
            return self.looks_in(*last, s);
        }
        let mut extinction = [0.0; LANES];
        let mut pieces = [0; LANES];
        for l in 0..LANES {
            let piece = self.piece_of(s[l]);
            pieces[l] = piece as u32;
            extinction[l] = self.extinction_in(piece, s[l]);
        }
        Looks { extinction, piece: PieceOf::Each(pieces) }
    }

    /// The same of values in one piece.
    #[inline(always)]
    fn looks_in(&self, piece: u32, s: &Lanes) -> Looks {
        let mut extinction = [0.0; LANES];
        let of_piece = self.pieces[piece as usize];
        for l in 0..LANES {
            let found = of_piece.extinction_at(s[l]);
            extinction[l] = if found > self.threshold { found } else { 0.0 };
        }
        Looks { extinction, piece: PieceOf::All(piece) }
    }

    /// The colours of the same values.
    #[inline(always)]
    pub(super) fn colors(&self, looks: &Looks, s: &Lanes, colors: &mut [Lanes; 3]) {
        match looks.piece {
            PieceOf::All(piece) => {
                let piece = self.pieces[piece as usize];
                for c in 0..3 {
                    for l in 0..LANES {
                        colors[c][l] = piece.color[c] + (s[l] - piece.start) * piece.color_slope[c];
                    }
                }
            }
            PieceOf::Each(pieces) => {
                for l in 0..LANES {
                    let color = self.pieces[pieces[l] as usize].color_at(s[l]);
                    (0..3).for_each(|c| colors[c][l] = color[c]);
                }
            }
        }
    }

    /// The colour of any finite value.
    pub(super) fn color_of(&self, s: f32) -> [f32; 3] {
        self.pieces[self.piece_of(s)].color_at(s)
    }

    /// Extinction and colour of the points around a sample, interpolated; nothing where one of them is not finite.
    #[inline(always)]
    pub(super) fn interpolated(&self, corners: &Corners, lane: usize) -> [f32; 4] {
        let [x, y, z] = corners.fraction.map(|fraction| fraction[lane]);
        let of = |corner: usize| -> [f32; 4] {
            let s = corners.values[corner][lane];
            let piece = self.piece_of(s);
            let [r, g, b] = self.pieces[piece].color_at(s);
            // Unlike the threshold, which is one of samples.
            let extinction = self.pieces[piece].extinction_at(s);
            [if s.is_finite() { extinction.max(0.0) } else { f32::NAN }, r, g, b]
        };
        let mix = |a: [f32; 4], b: [f32; 4], t: f32| -> [f32; 4] { std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t) };
        let layer = |k: usize| mix(mix(of(k), of(k + 1), x), mix(of(k + 2), of(k + 3), x), y);
        let [extinction, r, g, b] = mix(layer(0), layer(4), z);
        if extinction > self.threshold { [extinction, r, g, b] } else { [0.0; 4] }
    }

    /// Whether a value from `low` to `high` may show something.
    pub(super) fn shows(&self, low: f32, high: f32) -> bool {
        // Empty where no value is a number.
        low <= high
            && (self.piece_of(low)..=self.piece_of(high)).any(|piece| {
                let start = if piece == 0 { low } else { low.max(self.knots[piece - 1]) };
                let end = self.knots.get(piece).map_or(high, |&knot| high.min(knot));
                let most = self.pieces[piece].extinction_at(start).max(self.pieces[piece].extinction_at(end));
                // What rounding may add to a sample between both.
                most > 0.0 && most * (1.0 + 1e-5) > self.threshold
            })
    }
}

/// The least of sixteen numbers, halves against each other; what is no number does not count where another follows it.
#[inline(always)]
pub(super) fn least(v: &Lanes) -> f32 {
    folded(v, |a, b| min(b, a))
}

/// The greatest, alike.
#[inline(always)]
pub(super) fn most(v: &Lanes) -> f32 {
    folded(v, |a, b| max(b, a))
}

#[inline(always)]
fn folded(v: &Lanes, of: impl Fn(f32, f32) -> f32) -> f32 {
    let (mut eight, mut four) = ([0.0; 8], [0.0; 4]);
    for l in 0..8 {
        eight[l] = of(v[l], v[l + 8]);
    }
    for l in 0..4 {
        four[l] = of(eight[l], eight[l + 4]);
    }
    of(of(four[0], four[2]), of(four[1], four[3]))
}
