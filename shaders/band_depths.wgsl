// Absorption in bands of their own (src/optics/band_depths.rs): ∫ κ dt of four bands, added up in any order.

fn of_piece(k: u32, part: Segment) -> vec4<f32> {
    return (part.length_world * 0.5) * (extinctions_at(k, part.enter) + extinctions_at(k, part.leave));
}

// What a cell without a part of the ray gives.
const NOTHING = vec4<f32>(0.0);

fn over(front: vec4<f32>, back: vec4<f32>) -> vec4<f32> {
    return front + back;
}

fn of_segment(ray: Segment, span: vec2<u32>) -> vec4<f32> {
    if span.x == span.y {
        return of_piece(span.x, ray);
    }
    var sum = NOTHING;
    for (var k = span.x; k <= span.y; k++) {
        let part = cut(ray, k);
        if part.length_world > 0.0 {
            sum += of_piece(k, part);
        }
    }
    return sum;
}

@fragment
fn fragment(in: Fragment) -> @location(0) vec4<f32> {
    return of_cell(in);
}
