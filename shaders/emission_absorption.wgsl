// Emission and absorption (src/optics/emission_absorption.rs): premultiplied colour and opacity, blended over what lies behind.

fn of_piece(k: u32, part: Segment) -> vec4<f32> {
    let k0 = extinction_at(k, part.enter);
    let k1 = extinction_at(k, part.leave);
    let w = segment_weights(k0 * part.length_world, k1 * part.length_world);
    return vec4<f32>(w.w0 * color_at(k, part.enter) + w.w1 * color_at(k, part.leave), w.transmittance);
}

fn over(front: vec4<f32>, back: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(front.rgb + front.a * back.rgb, front.a * back.a);
}

@fragment
fn fragment(in: Fragment) -> @location(0) vec4<f32> {
    let ray = segment(in);
    if !(ray.length_world > 0.0) {
        return vec4<f32>(0.0);
    }
    if in.span.x == in.span.y {
        let one = of_piece(in.span.x, ray);
        return vec4<f32>(one.rgb, 1.0 - one.a);
    }
    var sum = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    for (var k = in.span.x; k <= in.span.y; k++) {
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
    return vec4<f32>(sum.rgb, 1.0 - sum.a);
}
