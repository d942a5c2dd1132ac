// From what was accumulated to the picture of a model; `pixel` is chosen by the pipeline.

@group(1) @binding(0) var accumulated: texture_2d<f32>;

// One triangle that covers the picture.
@vertex
fn whole_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    return vec4<f32>(4.0 * corner - 1.0, 0.0, 1.0);
}

fn at(position: vec4<f32>) -> vec4<f32> {
    return textureLoad(accumulated, vec2<u32>(position.xy), 0);
}

// Light with its opacity, and what shines through it.
@fragment
fn light(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let front = at(position);
    return front + (1.0 - front.a) * behind(position);
}

// Light of bands; optical depths, which end at what lies behind.
@fragment
fn as_it_is(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return at(position);
}

@fragment
fn absorption(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let depths = at(position);
    let shown = 1.0 - behind(position).a;
    return shown * vec4<f32>(exp_neg(depths.r), exp_neg(depths.g), exp_neg(depths.b), exp_neg(depths.a));
}

@fragment
fn emission(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(at(position).rgb, 0.0) + behind(position);
}

@fragment
fn mip(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let largest = at(position);
    if largest.a == 0.0 {
        return behind(position);
    }
    let s = largest.r / frame.s_scale + frame.s_middle;
    return vec4<f32>(color_at(pieces[piece_of(s)], s), 1.0);
}
