// The bands of a pass (src/optics/band_pieces.rs): linear pieces over the stored value s, four extinctions and colours each.

struct Piece {
    // The smallest s of the piece, and its end, which is not in it.
    begin: f32,
    end: f32,
    // Where extinctions and colours are stated, for s = start.
    start: f32,
    is_transparent: u32,
    extinction: vec4<f32>,
    extinction_slope: vec4<f32>,
    color: vec4<f32>,
    color_slope: vec4<f32>,
}

@group(0) @binding(1) var<storage, read> pieces: array<Piece>;

fn extinctions_at(piece: Piece, s: f32) -> vec4<f32> {
    return max(piece.extinction + (s - piece.start) * piece.extinction_slope, vec4<f32>(0.0));
}

fn colors_at(piece: Piece, s: f32) -> vec4<f32> {
    return piece.color + (s - piece.start) * piece.color_slope;
}
