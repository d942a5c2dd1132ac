//! Offsets: where in the connectivity each cell begins.

/// Checks that `offsets` ascend and stay within `len` entries; the error is a sentence about them.
pub(super) fn check(offsets: &[u64], len: usize) -> Result<(), String> {
    for (cell, pair) in offsets.windows(2).enumerate() {
        if pair[1] < pair[0] {
            return Err(format!("cell {cell} would end at entry {}, before it begins at {}", pair[1], pair[0]));
        }
    }
    match offsets.last() {
        Some(&end) if end > len as u64 => {
            Err(format!("the last cell would end at entry {end}, but the connectivity has {len}: damaged or truncated"))
        }
        _ => Ok(()),
    }
}

/// The cell that entry `entry` of the connectivity belongs to.
pub(super) fn cell_of(offsets: &[u64], entry: usize) -> u64 {
    (offsets.partition_point(|&offset| offset <= entry as u64) as u64).saturating_sub(1)
}
