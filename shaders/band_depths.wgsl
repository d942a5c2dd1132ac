// Absorption in bands of their own (src/optics/band_depths.rs): ∫ κ dt of four bands, added up in any order.

fn of_piece(k: u32, part: Segment) -> vec4<f32> {
    return (part.length_world * 0.5) * (extinctions_at(k, part.enter) + extinctions_at(k, part.leave));
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
