// Emission and absorption (src/optics/emission_absorption.rs): premultiplied colour and opacity, blended over what lies behind.

fn of_piece(k: u32, part: Segment) -> vec4<f32> {
    let k0 = extinction_at(k, part.enter);
    let k1 = extinction_at(k, part.leave);
    let w = segment_weights(k0 * part.length_world, k1 * part.length_world);
    return vec4<f32>(w.w0 * color_at(k, part.enter) + w.w1 * color_at(k, part.leave), w.transmittance);
}

// What a cell without a part of the ray gives.
const NOTHING = vec4<f32>(0.0, 0.0, 0.0, 1.0);

fn over(front: vec4<f32>, back: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(front.rgb + front.a * back.rgb, front.a * back.a);
}

fn of_segment(ray: Segment, span: vec2<u32>) -> vec4<f32> {
    if span.x == span.y {
        return of_piece(span.x, ray);
    }
    var sum = NOTHING;
    for (var k = span.x; k <= span.y; k++) {
        if pieces[k].is_transparent != 0u {
            continue;
        }
        let part = cut(ray, k);
        if part.length_world > 0.0 {
            let added = of_piece(k, part);
            // Pieces are visited by rising value: along a falling ray each one lies in front of those before it.
            if ray.leave >= ray.enter {
                sum = over(sum, added);
            } else {
                sum = over(added, sum);
            }
        }
    }
    return sum;
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
