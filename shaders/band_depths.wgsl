// Absorption in bands of their own (src/optics/band_depths.rs): ∫ κ dt of four bands.

fn of_piece(piece: Piece, part: Segment) -> vec4<f32> {
    return (part.length_world * 0.5) * (extinctions_at(piece, part.enter) + extinctions_at(piece, part.leave));
}
