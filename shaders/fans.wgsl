// From fans (src/stages/fans.rs) to segments of rays.

// Whether there may be HexFans, which take the room of two fans.
override HAS_HEXAHEDRA: bool = true;
// Whether there may be PolyFans.
override HAS_POLYHEDRA: bool = true;

// A Fan, or a PlaneFan (src/stages/fans/planes.rs) in its room, as words:
//   Fan       thick x y, s min max | front v q, back v q | four times ring x y v q
//   PlaneFan  box columns rows, s max min | v min max, constant, fronts | four times plane c x y, varying c x y 0
struct Fan {
    words: array<vec4<u32>, 6>,
}

@group(1) @binding(0) var<storage, read> fans: array<Fan>;

fn floats(fan: u32, k: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(fans[fan].words[k]);
}

// Five vertices a record.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Fragment {
    return record_vertex(index / 5u * select(1u, 2u, HAS_HEXAHEDRA), index % 5u);
}

// The thick vertex, then the ring.
fn fan_vertex(fan: u32, corner: u32) -> Fragment {
    let head = floats(fan, 0u);
    if corner == 0u {
        return fragment_at(head.xy, floats(fan, 1u), head.zw);
    }
    let ring = floats(fan, corner + 1u);
    return fragment_at(ring.xy, ring.zwzw, head.zw);
}

fn fragment_at(position_px: vec2<f32>, enter_leave: vec4<f32>, s_range: vec2<f32>) -> Fragment {
    var out: Fragment;
    out.position = vec4<f32>((position_px - frame.first_px) * frame.ndc_scale + frame.ndc_offset, 0.0, 1.0);
    out.enter_leave = enter_leave;
    out.s_range = s_range;
    out.span = vec2<u32>(piece_of(min(s_range.x, s_range.y)), piece_of(max(s_range.x, s_range.y)));
    return out;
}

// A cell's part of a ray.
struct Segment {
    enter: f32,
    leave: f32,
    length_world: f32,
}

// Column and row in the whole picture.
fn pixel_of(in: Fragment) -> vec2<f32> {
    return in.position.xy - 0.5 + frame.first_px;
}

// World length per scene unit of depth at a pixel.
fn length_per_depth(pixel: vec2<f32>) -> f32 {
    return length(frame.ray + pixel.x * frame.ray_step_x + pixel.y * frame.ray_step_y);
}

fn segment_of_fan(in: Fragment) -> Segment {
    let pixel = pixel_of(in);
    let v0 = in.enter_leave.x;
    let v1 = in.enter_leave.z;
    let v_far = v_far_at(in.position);
    let clipped0 = clamp(v0, v_far, frame.v_near);
    let clipped1 = clamp(v1, v_far, frame.v_near);
    note_part(clipped0, clipped1);
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
    return Segment(
        clamp(value0, in.s_range.x, in.s_range.y),
        clamp(value1, in.s_range.x, in.s_range.y),
        depth * length_per_depth(pixel),
    );
}
