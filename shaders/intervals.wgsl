// The pieces' intervals, as in src/optics/intervals.rs.

// The piece that holds s: the last that begins at or before it.
fn piece_of(s: f32) -> u32 {
    var low = 0u;
    var high = frame.piece_count;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if s >= pieces[middle].begin {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}
