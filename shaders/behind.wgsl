// What lies behind the volume where something opaque is drawn.

@group(2) @binding(0) var opaque: texture_2d<f32>;

// Its colour, and 1 where it ends rays. Elsewhere there may be light behind everything: its opacity runs from 0 at an inverse depth of
// -LARGEST to 1 at half of that (backends/gpu/external.rs).
fn behind(position: vec4<f32>) -> vec4<f32> {
    let drawn = textureLoad(opaque, vec2<u32>(position.xy), 0);
    let far_behind = clamp(2.0 + 2.0 * (drawn.a / LARGEST), 0.0, 1.0);
    return vec4<f32>(drawn.rgb, select(far_behind, 1.0, drawn.a > -0.25 * LARGEST));
}
