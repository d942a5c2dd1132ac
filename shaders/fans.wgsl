// From fans (src/stages/fans.rs) to segments of rays.

struct RingVertex {
    position_px: vec2<f32>,
    vq: vec2<f32>,
}

struct Fan {
    thick_px: vec2<f32>,
    s_range: vec2<f32>,
    front: vec2<f32>,
    back: vec2<f32>,
    ring: array<RingVertex, 4>,
}

@group(1) @binding(0) var<storage, read> fans: array<Fan>;

struct Fragment {
    @builtin(position) position: vec4<f32>,
    // (v, q) where the ray enters and where it leaves: affine on the picture.
    @location(0) @interpolate(linear) enter_leave: vec4<f32>,
    @location(1) @interpolate(flat) s_range: vec2<f32>,
    // The pieces of the transfer function that the cell touches, both ends included.
    @location(2) @interpolate(flat) span: vec2<u32>,
}

// Five vertices a fan: the thick one, then the ring.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Fragment {
    let fan = index / 5u;
    let corner = index % 5u;
    var position_px = fans[fan].thick_px;
    var enter = fans[fan].front;
    var leave = fans[fan].back;
    if corner > 0u {
        position_px = fans[fan].ring[corner - 1u].position_px;
        enter = fans[fan].ring[corner - 1u].vq;
        leave = enter;
    }
    let s_range = fans[fan].s_range;
    var out: Fragment;
    out.position = vec4<f32>(position_px * frame.ndc_scale + frame.ndc_offset, 0.0, 1.0);
    out.enter_leave = vec4<f32>(enter, leave);
    out.s_range = s_range;
    out.span = vec2<u32>(piece_of(s_range.x), piece_of(s_range.y));
    return out;
}

// A cell's part of a ray.
struct Segment {
    enter: f32,
    leave: f32,
    length_world: f32,
}

fn segment(in: Fragment) -> Segment {
    let pixel = in.position.xy - 0.5;
    let v0 = in.enter_leave.x;
    let v1 = in.enter_leave.z;
    let clipped0 = clamp(v0, frame.v_far, frame.v_near);
    let clipped1 = clamp(v1, frame.v_far, frame.v_near);
    // Nearer is larger: a ray enters at the larger v.
    var depth = max(clipped0 - clipped1, 0.0);
    var s0 = in.enter_leave.y;
    var s1 = in.enter_leave.w;
    // Where along the ray, linear in depth, a plane cuts the segment.
    var cut0 = (v0 - clipped0) / (v0 - v1);
    var cut1 = (v0 - clipped1) / (v0 - v1);
    if frame.is_perspective != 0u {
        depth = depth / (clipped0 * clipped1);
        s0 = s0 / v0;
        s1 = s1 / v1;
        cut0 = cut0 * v1 / clipped0;
        cut1 = cut1 * v1 / clipped1;
    }
    let value0 = select(s0 + (s1 - s0) * cut0, s0, clipped0 == v0);
    let value1 = select(s0 + (s1 - s0) * cut1, s1, clipped1 == v1);
    let length_per_depth = length(frame.ray + pixel.x * frame.ray_step_x + pixel.y * frame.ray_step_y);
    return Segment(
        clamp(value0, in.s_range.x, in.s_range.y),
        clamp(value1, in.s_range.x, in.s_range.y),
        depth * length_per_depth,
    );
}
