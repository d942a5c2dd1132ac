// Colour and transmittance of a cell, blended over what lies behind: premultiplied colour and opacity.

// What a cell without a part of the ray gives.
const NOTHING = vec4<f32>(0.0, 0.0, 0.0, 1.0);

fn over(front: vec4<f32>, back: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(front.rgb + front.a * back.rgb, front.a * back.a);
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
