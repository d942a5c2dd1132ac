// The opacity texture of src/optics/texture.rs: 1 - e^-(extinction · length), bilinear between texels, clamped outside.

@group(0) @binding(2) var<storage, read> opacity_texture: array<f32>;

fn along(row: u32, column: u32, u: f32) -> f32 {
    let at = row * frame.texels + column;
    return opacity_texture[at] * (1.0 - u) + opacity_texture[at + 1u] * u;
}

fn opacity(length_world: f32, extinction: f32) -> f32 {
    let last = f32(frame.texels - 1u);
    let x = clamp(length_world * frame.texels_per_length, 0.0, last);
    let y = clamp(extinction * frame.texels_per_extinction, 0.0, last);
    let column = min(u32(x), frame.texels - 2u);
    let row = min(u32(y), frame.texels - 2u);
    let v = y - f32(row);
    return along(row, column, x - f32(column)) * (1.0 - v) + along(row + 1u, column, x - f32(column)) * v;
}

fn weights(length_world: f32, k0: f32, k1: f32) -> SegmentWeights {
    let alpha = opacity(length_world, 0.5 * (k0 + k1));
    return SegmentWeights(0.5 * alpha, 0.5 * alpha, 1.0 - alpha);
}
