// Emission and absorption apart (src/optics/emission.rs, absorption.rs): RGB ∫ c κ dt, A ∫ κ dt, added up in any order.

fn of_piece(k: u32, part: Segment) -> vec4<f32> {
    let k0 = extinction_at(k, part.enter);
    let k1 = extinction_at(k, part.leave);
    let light = product_mean(k0, k1, color_at(k, part.enter), color_at(k, part.leave));
    return part.length_world * vec4<f32>(light, 0.5 * (k0 + k1));
}

@fragment
fn fragment(in: Fragment) -> @location(0) vec4<f32> {
    let ray = segment(in);
    if !(ray.length_world > 0.0) {
        return vec4<f32>(0.0);
    }
    if in.span.x == in.span.y {
        return of_piece(in.span.x, ray);
    }
    var sum = vec4<f32>(0.0);
    for (var k = in.span.x; k <= in.span.y; k++) {
        let part = cut(ray, k);
        if part.length_world > 0.0 {
            sum += of_piece(k, part);
        }
    }
    return sum;
}
