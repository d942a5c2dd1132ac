// What a cell adds to four sums, in any order.

// What a cell without a part of the ray gives.
const NOTHING = vec4<f32>(0.0);

fn over(front: vec4<f32>, back: vec4<f32>) -> vec4<f32> {
    return front + back;
}

@fragment
fn fragment(in: Fragment) -> @location(0) vec4<f32> {
    return of_cell(in);
}
