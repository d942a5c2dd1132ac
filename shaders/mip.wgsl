// Maximum intensity (src/optics/mip.rs): the largest value on the ray, and whether it meets a cell; coloured when resolved.

@fragment
fn fragment(in: Fragment) -> @location(0) vec4<f32> {
    let ray = segment(in);
    if !(ray.length_world > 0.0) {
        return vec4<f32>(-LARGEST, 0.0, 0.0, 0.0);
    }
    return vec4<f32>((max(ray.enter, ray.leave) - frame.s_middle) * frame.s_scale, 0.0, 0.0, 1.0);
}
