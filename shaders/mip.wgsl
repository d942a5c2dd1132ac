// Maximum intensity (src/optics/mip.rs): the largest value on the ray, and whether it meets a cell; coloured when resolved.

// What a cell without a part of the ray gives.
const NOTHING = vec4<f32>(-LARGEST, 0.0, 0.0, 0.0);

fn over(front: vec4<f32>, back: vec4<f32>) -> vec4<f32> {
    return max(front, back);
}

fn of_segment(ray: Segment, span: vec2<u32>) -> vec4<f32> {
    return vec4<f32>((max(ray.enter, ray.leave) - frame.s_middle) * frame.s_scale, 0.0, 0.0, 1.0);
}

@fragment
fn fragment(in: Fragment) -> @location(0) vec4<f32> {
    return of_cell(in);
}
