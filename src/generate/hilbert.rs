//! Position along a Hilbert curve: points that follow one another on it are close in space.
//!
//! Skilling, Programming the Hilbert curve, AIP Conference Proceedings 707, 2004: the axes are exchanged and mirrored
//! from the coarsest bit to the finest, then Gray decoded; a few operations a bit, no table.

/// Bits of each coordinate.
pub(super) const BITS: u32 = 16;

/// The position along the curve of a cell whose coordinates have [`BITS`] bits.
pub(super) fn hilbert(mut cell: [u32; 3]) -> u64 {
    for bit in (1..BITS).rev().map(|b| 1_u32 << b) {
        let below = bit - 1;
        for axis in 0..3 {
            if cell[axis] & bit == 0 {
                let exchange = (cell[0] ^ cell[axis]) & below;
                cell[0] ^= exchange;
                cell[axis] ^= exchange;
            } else {
                cell[0] ^= below;
            }
        }
    }
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let flips = (1..BITS).map(|b| 1_u32 << b).filter(|bit| cell[2] & bit != 0).fold(0, |flips, bit| flips ^ (bit - 1));
    (0..BITS).rev().fold(0, |key, b| cell.iter().fold(key, |key, axis| key << 1 | u64::from((axis ^ flips) >> b & 1)))
}

#[cfg(test)]
mod tests {
    use super::{BITS, hilbert};

    #[test]
    fn curve_visits_a_cube_cell_by_cell_each_a_neighbour_of_the_last() {
        let n = 16_u32;
        let mut cells: Vec<(u64, [u32; 3])> =
            (0..n.pow(3)).map(|i| [i % n, i / n % n, i / (n * n)]).map(|cell| (hilbert(cell), cell)).collect();
        cells.sort_unstable();
        for (i, pair) in cells.windows(2).enumerate() {
            assert_eq!(pair[0].0, i as u64);
            let steps: u32 = (0..3).map(|axis| pair[0].1[axis].abs_diff(pair[1].1[axis])).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
        assert!(hilbert([(1 << BITS) - 1; 3]) < 1 << (3 * BITS));
    }
}
