// A segment by its two ends alone, wherever control points lie between; `weights` says how.

@fragment
fn fragment(in: Fragment) -> @location(0) vec4<f32> {
    let ray = segment(in);
    if !(ray.length_world > 0.0) {
        return vec4<f32>(0.0);
    }
    let first = piece_of(ray.enter);
    let last = piece_of(ray.leave);
    let k0 = extinction_at(first, ray.enter);
    let k1 = extinction_at(last, ray.leave);
    let w = weights(ray.length_world, k0, k1);
    return vec4<f32>(w.w0 * color_at(first, ray.enter) + w.w1 * color_at(last, ray.leave), 1.0 - w.transmittance);
}
