// A segment by its two ends alone, wherever control points lie between; `weights` says how.

fn of_segment(ray: Segment, span: vec2<u32>) -> vec4<f32> {
    let first = pieces[piece_of(ray.enter)];
    let last = pieces[piece_of(ray.leave)];
    let k0 = extinction_at(first, ray.enter);
    let k1 = extinction_at(last, ray.leave);
    let w = weights(ray.length_world, k0, k1);
    return vec4<f32>(w.w0 * color_at(first, ray.enter) + w.w1 * color_at(last, ray.leave), w.transmittance);
}
