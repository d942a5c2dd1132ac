//! Lanes: sixteen independent rays in plain arrays. Loops over lanes are written without branches, so that the compiler turns
//! each into a few vector instructions of whatever width the caller was compiled for.

/// Rays handled together: the pixels of a 4×4 block.
pub const LANES: usize = 16;

/// One number per ray.
pub type Lanes = [f32; LANES];

/// One truth per ray, all bits set or none: a selection by bits is a vector instruction, one by `bool` often a branch.
pub type Mask = [u32; LANES];

/// A ray's segments in one cell: the stored field values at entry and exit, and the length between them.
#[derive(Clone, Copy, Debug)]
pub struct Segments {
    /// Value where the ray enters.
    pub enter: Lanes,
    /// Value where it leaves.
    pub leave: Lanes,
    /// World length; 0 in lanes that miss the cell.
    pub length_world: Lanes,
}

impl Segments {
    /// No segment in any lane.
    pub const NONE: Self = Self { enter: [0.0; LANES], leave: [0.0; LANES], length_world: [0.0; LANES] };
}

/// What a segment adds to a ray, four numbers whose meaning is the optical model's.
pub type Contribution = [Lanes; 4];

/// The smaller of two numbers, the second where either is NaN; one instruction on every target.
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two numbers, the second where either is NaN; one instruction on every target.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `a + b` rounded, and what rounding took from it: their sum is exact (Knuth 1969, `TwoSum`).
///
/// ```
/// # use cellfan::optics::lanes::two_sum;
/// assert_eq!(two_sum(16_777_216.0, 1.5), (16_777_218.0, -0.5));
/// ```
#[inline(always)]
pub fn two_sum(a: f32, b: f32) -> (f32, f32) {
    let sum = a + b;
    let b_in_sum = sum - a;
    (sum, (a - (sum - b_in_sum)) + (b - b_in_sum))
}

/// All bits set if `condition` holds.
#[inline(always)]
pub fn mask(condition: bool) -> u32 {
    u32::from(condition).wrapping_neg()
}

/// `a` where the mask is set, `b` elsewhere.
#[inline(always)]
pub fn select(mask: u32, a: f32, b: f32) -> f32 {
    f32::from_bits((a.to_bits() & mask) | (b.to_bits() & !mask))
}

/// Whether the mask is set for any ray.
#[inline(always)]
pub fn is_any(mask: &Mask) -> bool {
    mask.iter().fold(0, |any, &lane| any | lane) != 0
}
