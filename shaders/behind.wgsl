// What lies behind the volume where opaque geometry is drawn.

@group(2) @binding(0) var opaque: texture_2d<f32>;

// Its colour, and 1 where there is something.
fn behind(position: vec4<f32>) -> vec4<f32> {
    let drawn = textureLoad(opaque, vec2<u32>(position.xy), 0);
    return vec4<f32>(drawn.rgb, select(0.0, 1.0, drawn.a > -LARGEST));
}
