// Where opaque geometry is drawn: each ray ends on it.

// Its linear RGB, and its inverse depth; far away where there is nothing.
@group(3) @binding(0) var opaque: texture_2d<f32>;

fn v_far_at(position: vec4<f32>) -> f32 {
    return max(frame.v_far, textureLoad(opaque, vec2<u32>(position.xy), 0).a);
}
