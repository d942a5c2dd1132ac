// Where nothing but fans is drawn (src/stages/fans.rs).

struct Fragment {
    @builtin(position) position: vec4<f32>,
    // (v, q) where the ray enters and where it leaves: affine on the picture.
    @location(0) @interpolate(linear) enter_leave: vec4<f32>,
    // Smallest and largest value of the cell.
    @location(1) @interpolate(flat) s_range: vec2<f32>,
    // The pieces of the transfer function that the cell touches, both ends included.
    @location(2) @interpolate(flat) span: vec2<u32>,
}

fn record_vertex(fan: u32, corner: u32) -> Fragment {
    return fan_vertex(fan, corner);
}

// All of a cell's light on a ray.
fn of_cell(in: Fragment) -> vec4<f32> {
    let ray = segment_of_fan(in);
    if !(ray.length_world > 0.0) {
        return NOTHING;
    }
    return of_segment(ray, in.span);
}
