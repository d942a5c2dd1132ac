// Emission and absorption by band, two a pass (src/optics/band_light.rs): light and opacity of both, blended over what lies
// behind, which each channel dims on its own.

// Light of both bands, transmittance of both.
fn of_piece(piece: Piece, part: Segment) -> vec4<f32> {
    let x = extinctions_at(piece, part.enter) * part.length_world;
    let y = extinctions_at(piece, part.leave) * part.length_world;
    let near = colors_at(piece, part.enter);
    let far = colors_at(piece, part.leave);
    let a = segment_weights(x.x, y.x);
    let b = segment_weights(x.y, y.y);
    return vec4<f32>(a.w0 * near.x + a.w1 * far.x, b.w0 * near.y + b.w1 * far.y, a.transmittance, b.transmittance);
}

// What a cell without a part of the ray gives.
const NOTHING = vec4<f32>(0.0, 0.0, 1.0, 1.0);

fn over(front: vec4<f32>, back: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(front.xy + front.zw * back.xy, front.zw * back.zw);
}

struct Blended {
    // Light and opacity.
    @location(0) @blend_src(0) added: vec4<f32>,
    // What is left of the same behind.
    @location(0) @blend_src(1) transmittance: vec4<f32>,
}

@fragment
fn fragment(in: Fragment) -> Blended {
    let sum = of_cell(in);
    return Blended(vec4<f32>(sum.xy, 1.0 - sum.zw), sum.zwzw);
}

struct BlendedInOrder {
    @location(0) @blend_src(0) added: vec4<f32>,
    @location(0) @blend_src(1) transmittance: vec4<f32>,
    @builtin(frag_depth) order: f32,
}

@fragment
fn fragment_in_order(in: Fragment) -> BlendedInOrder {
    let sum = of_cell(in);
    return BlendedInOrder(vec4<f32>(sum.xy, 1.0 - sum.zw), sum.zwzw, order_depth(in));
}
