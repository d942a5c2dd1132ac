// A segment by its two ends alone, wherever control points lie between; `weights` says how. Colour and
// transmittance.

// What a cell without a part of the ray gives.
const NOTHING = vec4<f32>(0.0, 0.0, 0.0, 1.0);

fn over(front: vec4<f32>, back: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(front.rgb + front.a * back.rgb, front.a * back.a);
}

fn of_segment(ray: Segment, span: vec2<u32>) -> vec4<f32> {
    let first = piece_of(ray.enter);
    let last = piece_of(ray.leave);
    let k0 = extinction_at(first, ray.enter);
    let k1 = extinction_at(last, ray.leave);
    let w = weights(ray.length_world, k0, k1);
    return vec4<f32>(w.w0 * color_at(first, ray.enter) + w.w1 * color_at(last, ray.leave), w.transmittance);
}

@fragment
fn fragment(in: Fragment) -> @location(0) vec4<f32> {
    let sum = of_cell(in);
    return vec4<f32>(sum.rgb, 1.0 - sum.a);
}

struct InOrder {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) order: f32,
}

@fragment
fn fragment_in_order(in: Fragment) -> InOrder {
    let sum = of_cell(in);
    return InOrder(vec4<f32>(sum.rgb, 1.0 - sum.a), order_depth(in));
}
