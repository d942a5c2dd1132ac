// What lies behind the volume where no opaque geometry is drawn.

fn behind(position: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(0.0);
}
