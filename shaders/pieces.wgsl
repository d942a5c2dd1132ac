// The transfer function of src/optics/pieces.rs: linear pieces over the stored value s.

struct Piece {
    // The smallest s of the piece, and its end, which is not in it.
    begin: f32,
    end: f32,
    // Where extinction and colour are stated, for s = start.
    start: f32,
    extinction: f32,
    color: vec3<f32>,
    extinction_slope: f32,
    color_slope: vec3<f32>,
    is_transparent: u32,
}

@group(0) @binding(1) var<storage, read> pieces: array<Piece>;

fn extinction_at(piece: Piece, s: f32) -> f32 {
    return max(piece.extinction + (s - piece.start) * piece.extinction_slope, 0.0);
}

fn color_at(piece: Piece, s: f32) -> vec3<f32> {
    return piece.color + (s - piece.start) * piece.color_slope;
}
