// Where no opaque geometry is drawn: rays end at the far plane, and nothing lies behind the volume.

fn v_far_at(position: vec4<f32>) -> f32 {
    return frame.v_far;
}
