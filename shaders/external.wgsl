// An external picture, before all geometry: its colour and inverse depth as if they had been drawn.

@group(1) @binding(0) var from_outside: texture_2d<f32>;

// One triangle that covers the picture.
@vertex
fn whole_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    return vec4<f32>(4.0 * corner - 1.0, 0.0, 1.0);
}

@fragment
fn of_external(@builtin(position) position: vec4<f32>) -> Drawn {
    let drawn = textureLoad(from_outside, vec2<u32>(position.xy), 0);
    var z = 0.0;
    if drawn.a > -0.25 * LARGEST {
        z = clamp(drawn.a * geometry.z_scale + geometry.z_offset, 0.0, 1.0);
    }
    return Drawn(drawn, z);
}
