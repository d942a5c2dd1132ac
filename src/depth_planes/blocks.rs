//! `ValueBlocks`: least and greatest value in blocks of cells; `Occupancy`: which of them show something.
//!
//! In: a field, once. Out: an interval for each block of 8×8×8 cells, of all points around which a sample in the block may be made of. For
//! each transfer function: a flag for each block, and pyramids of flags over them, so that any box is asked in a few looks.

use rayon::prelude::*;

use super::classify::Classifier;
use super::filter::OVERSHOOT;
use super::source::{Source, SourceVisitor, visit};
use super::{Filter, sample::Grid};
use crate::columns::{Association, Sample, VolumeField};
use crate::optics::lanes::{max, min};

/// Cells along the side of a block.
pub(super) const BLOCK: usize = 8;

/// Least and greatest value in the blocks of a field; made once, whatever is drawn.
#[derive(Clone, Debug)]
pub struct ValueBlocks {
    /// Blocks along i, j and k.
    dims: [usize; 3],
    /// Of the points of a block and one around it; empty, the greater first, where none is a number.
    ranges: Vec<[f32; 2]>,
}

impl ValueBlocks {
    /// The blocks of `field`. O(values), in parallel.
    pub fn new(field: &VolumeField) -> Self {
        visit(field, Build { grid: Grid::of(field), is_cell: field.association == Association::Cell })
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.ranges[..]) as u64
    }
}

struct Build {
    grid: Grid,
    is_cell: bool,
}

impl SourceVisitor for Build {
    type Output = ValueBlocks;

    fn visit<S: Source>(self, source: &S) -> ValueBlocks {
        let values = self.grid.dims;
        let cells = values.map(|along| if self.is_cell { along } else { along.saturating_sub(1).max(1) });
        let dims = cells.map(|along| along.div_ceil(BLOCK));
        // A point more than a block has, for filters of four points, and one for the block's end.
        let reach = |block: usize, along: usize| {
            if self.is_cell {
                block * BLOCK..((block + 1) * BLOCK).min(along)
            } else {
                (block * BLOCK).saturating_sub(1)..((block + 1) * BLOCK + 2).min(along)
            }
        };
        let strides = self.grid.strides();
        let of_row = |row: usize| {
            let [ys, zs] = [reach(row % dims[1], values[1]), reach(row / dims[1], values[2])];
            // Along j and k first, side by side in i.
            let (mut low, mut high) = (vec![f32::INFINITY; values[0]], vec![f32::NEG_INFINITY; values[0]]);
            for k in zs {
                for j in ys.clone() {
                    let start = j * strides[1] + k * strides[2];
                    for i in 0..values[0] {
                        let value = source.get(start + i).narrowed();
                        // What is not finite shows nothing; the second where the first is not a number.
                        let value = if value.abs() <= f32::MAX { value } else { f32::NAN };
                        low[i] = min(value, low[i]);
                        high[i] = max(value, high[i]);
                    }
                }
            }
            let of_block = |block: usize| {
                let xs = reach(block, values[0]);
                let least = low[xs.clone()].iter().fold(f32::INFINITY, |a, &b| a.min(b));
                [least, high[xs].iter().fold(f32::NEG_INFINITY, |a, &b| a.max(b))]
            };
            (0..dims[0]).map(of_block).collect::<Vec<_>>()
        };
        let ranges = (0..dims[1] * dims[2]).into_par_iter().flat_map_iter(of_row).collect();
        ValueBlocks { dims, ranges }
    }
}

/// Flags of blocks, and of 2×2×2 of them, and so on.
#[derive(Clone, Debug)]
pub(super) struct Occupancy {
    levels: Vec<([usize; 3], Vec<bool>)>,
    /// Whether any block shows something, and whether all do.
    pub(super) is_any: bool,
    is_all: bool,
}

impl Occupancy {
    /// Which blocks show something.
    pub(super) fn new(blocks: &ValueBlocks, classifier: &Classifier, filter: Filter) -> Self {
        let beyond = if filter == Filter::CatmullRom { OVERSHOOT } else { 0.0 };
        let shows = |&[low, high]: &[f32; 2]| {
            let more = if low <= high { beyond * (high - low) } else { 0.0 };
            classifier.shows((low - more).max(f32::MIN), (high + more).min(f32::MAX))
        };
        let finest: Vec<bool> = blocks.ranges.par_iter().map(shows).collect();
        let (is_any, is_all) = (finest.contains(&true), !finest.contains(&false));
        let mut levels = vec![(blocks.dims, finest)];
        while let Some((below, flags)) = levels.last().filter(|(dims, _)| dims.iter().any(|&along| along > 1)) {
            let dims = below.map(|along| along.div_ceil(2));
            let mut coarser = vec![false; dims.iter().product()];
            for (i, _) in flags.iter().enumerate().filter(|&(_, &flag)| flag) {
                let [x, y, z] = [i % below[0], i / below[0] % below[1], i / below[0] / below[1]];
                coarser[x / 2 + dims[0] * (y / 2 + dims[1] * (z / 2))] = true;
            }
            levels.push((dims, coarser));
        }
        Self { levels, is_any, is_all }
    }

    /// Whether anything may show between two corners of a box, in grid coordinates.
    #[inline(always)]
    pub(super) fn any(&self, low: [f32; 3], high: [f32; 3]) -> bool {
        if self.is_all {
            return true;
        }
        let block = |place: f32| (place * (1.0 / BLOCK as f32)) as usize;
        let (low, high) = (low.map(block), high.map(block));
        // The level at which the box spans three blocks at most.
        let span = (high[0] - low[0]).max(high[1] - low[1]).max(high[2] - low[2]);
        let level = span.div_ceil(2).next_power_of_two().ilog2() as usize;
        let level = level.min(self.levels.len() - 1);
        let (dims, flags) = &self.levels[level];
        let at = |place: usize, axis: usize| (place >> level).min(dims[axis] - 1);
        (at(low[2], 2)..=at(high[2], 2)).any(|z| {
            (at(low[1], 1)..=at(high[1], 1)).any(|y| {
                let row = dims[0] * (y + dims[1] * z);
                flags[row + at(low[0], 0)..=row + at(high[0], 0)].contains(&true)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::{Array, FieldSelection, Lattice, Volume};
    use crate::optics::{ControlPoint, TransferFunction};

    /// One bright point in a dark volume of odd size.
    fn field(at: [usize; 3], dims: [usize; 3]) -> VolumeField {
        let mut values = vec![0_u8; dims.iter().product()];
        values[at[0] + dims[0] * (at[1] + dims[1] * at[2])] = 200;
        let array = Array { name: "v".into(), association: Association::Point, components: 1, values: values.into() };
        Volume::new(dims, Lattice::default(), vec![array]).unwrap().field(&FieldSelection::parse("v", &[])).unwrap()
    }

    #[test]
    fn boxes_that_hold_a_bright_sample_are_never_missed() {
        let dims = [37, 18, 70];
        let point = |value, extinction| ControlPoint { value, color: [1.0; 3], extinction };
        let transfer = TransferFunction::new(vec![point(0.0, 0.0), point(255.0, 1.0)]).unwrap();
        let classifier = Classifier::new(&transfer.pieces(0.0), 0.0);
        for at in [[0, 0, 0], [36, 17, 69], [8, 8, 8], [7, 9, 64], [16, 0, 33]] {
            let blocks = ValueBlocks::new(&field(at, dims));
            let occupancy = Occupancy::new(&blocks, &classifier, Filter::Trilinear);
            assert!(occupancy.is_any && !occupancy.is_all);
            let (mut found, mut left_out) = (0, 0);
            for seed in 0..4000_u32 {
                let random =
                    |k: u32| (seed.wrapping_mul(2_654_435_761).rotate_left(7 * k) >> 8) as f32 / (1 << 24) as f32;
                // Every second box begins near the point.
                let low: [f32; 3] = std::array::from_fn(|a| {
                    let place = random(a as u32);
                    let near = (at[a] as f32 - 3.0 * place).max(0.0);
                    if seed % 2 == 0 { near } else { place * (dims[a] - 1) as f32 }
                });
                let size = random(4) * random(4) * 60.0;
                let high: [f32; 3] = std::array::from_fn(|a| (low[a] + size).min((dims[a] - 1) as f32));
                let holds = (0..3).all(|a| low[a] < at[a] as f32 + 1.0 && high[a] > at[a] as f32 - 1.0);
                let says = occupancy.any(low, high);
                assert!(says || !holds, "{at:?}: {low:?} to {high:?}");
                found += u32::from(holds);
                left_out += u32::from(!says);
            }
            assert!(found > 20 && left_out > 100, "{at:?}: {found} hold it, {left_out} are left out");
        }
    }
}
