// From fans (src/stages/fans.rs) to segments of rays.

// Whether a draw may have PlaneFans, or HexFans, which take the room of two: shaders that need not know them are faster.
override HAS_PLANES: bool = true;
override HAS_HEXAHEDRA: bool = true;

// A Fan, or a PlaneFan (src/stages/fans/planes.rs) in its room, as words:
//   Fan       thick x y, s min max | front v q, back v q | four times ring x y v q
//   PlaneFan  box columns rows, s max min | v min max, constant, fronts | four times plane c x y, varying c x y 0
struct Fan {
    words: array<vec4<u32>, 6>,
}

@group(1) @binding(0) var<storage, read> fans: array<Fan>;

struct Fragment {
    @builtin(position) position: vec4<f32>,
    // (v, q) where the ray enters and where it leaves: affine on the picture.
    @location(0) @interpolate(linear) enter_leave: vec4<f32>,
    // Smallest and largest value of the cell; planes have them the other way round.
    @location(1) @interpolate(flat) s_range: vec2<f32>,
    // The pieces of the transfer function that the cell touches, both ends included.
    @location(2) @interpolate(flat) span: vec2<u32>,
    @location(3) @interpolate(flat) fan: u32,
}

fn floats(fan: u32, k: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(fans[fan].words[k]);
}

// First column and row of a box of pixels, and those after the last.
fn box_of(fan: u32) -> vec4<f32> {
    let columns_rows = fans[fan].words[0].xy;
    return vec4<f32>(vec4<u32>(columns_rows & vec2<u32>(0xffffu), columns_rows >> vec2<u32>(16u)));
}

// Five vertices a fan: the thick one, then the ring; of a box one corner twice, then all of them: two triangles cover nothing.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Fragment {
    return fan_vertex(index / 5u * select(1u, 2u, HAS_HEXAHEDRA), index % 5u);
}

fn fan_vertex(fan: u32, corner: u32) -> Fragment {
    let head = floats(fan, 0u);
    var position_px = head.xy;
    var enter_leave = floats(fan, 1u);
    if (HAS_PLANES || HAS_HEXAHEDRA) && head.z > head.w {
        let pixels = box_of(fan) - 0.5;
        let right = corner == 2u || corner == 3u;
        let below = corner == 3u || corner == 4u;
        position_px = vec2<f32>(select(pixels.x, pixels.z, right), select(pixels.y, pixels.w, below));
    } else if corner > 0u {
        let ring = floats(fan, corner + 1u);
        position_px = ring.xy;
        enter_leave = ring.zwzw;
    }
    return fragment_at(fan, position_px, enter_leave);
}

fn fragment_at(fan: u32, position_px: vec2<f32>, enter_leave: vec4<f32>) -> Fragment {
    let head = floats(fan, 0u);
    var out: Fragment;
    out.position = vec4<f32>(position_px * frame.ndc_scale + frame.ndc_offset, 0.0, 1.0);
    out.enter_leave = enter_leave;
    out.s_range = head.zw;
    out.span = vec2<u32>(piece_of(min(head.z, head.w)), piece_of(max(head.z, head.w)));
    out.fan = fan;
    return out;
}

// A cell's part of a ray.
struct Segment {
    enter: f32,
    leave: f32,
    length_world: f32,
}

// World length per scene unit of depth at a pixel.
fn length_per_depth(pixel: vec2<f32>) -> f32 {
    return length(frame.ray + pixel.x * frame.ray_step_x + pixel.y * frame.ray_step_y);
}

fn segment(in: Fragment) -> Segment {
    let pixel = in.position.xy - 0.5;
    if HAS_PLANES && in.s_range.x > in.s_range.y {
        return segment_of_planes(in.fan, pixel);
    }
    let v0 = in.enter_leave.x;
    let v1 = in.enter_leave.z;
    let clipped0 = clamp(v0, frame.v_far, frame.v_near);
    let clipped1 = clamp(v1, frame.v_far, frame.v_near);
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

// All of a cell's light on a ray.
fn of_cell(in: Fragment) -> vec4<f32> {
    if HAS_HEXAHEDRA && in.s_range.x > in.s_range.y && (fans[in.fan].words[1].w & IS_HEXAHEDRON) != 0u {
        return of_hexahedron(in);
    }
    let ray = segment(in);
    if !(ray.length_world > 0.0) {
        return NOTHING;
    }
    return of_segment(ray, in.span);
}

// Entry is the farthest front face's plane, exit the nearest back face's, as in src/stages/footprints.
fn segment_of_planes(fan: u32, pixel: vec2<f32>) -> Segment {
    let at = pixel - box_of(fan).xy;
    let head = floats(fan, 0u);
    let ranges = floats(fan, 1u);
    let fronts = fans[fan].words[1].w;
    var enter = ranges.y;
    var leave = ranges.x;
    var scalar: array<f32, 4>;
    for (var k = 0u; k < 4u; k++) {
        let plane = floats(fan, k + 2u);
        let v = plane.x + plane.y * at.x + plane.z * at.y;
        if k < fronts {
            enter = min(enter, v);
        } else {
            leave = max(leave, v);
        }
        scalar[k] = plane.w;
    }
    let depth = enter - leave;
    if !(depth > 0.0) {
        return Segment(head.w, head.w, 0.0);
    }
    note_part(enter, leave);
    let on_picture = scalar[0] + scalar[1] * at.x + scalar[2] * at.y;
    let world = length_per_depth(pixel);
    if frame.is_perspective != 0u {
        let s0 = clamp(ranges.z + on_picture / enter, head.w, head.z);
        let s1 = clamp(ranges.z + on_picture / leave, head.w, head.z);
        return Segment(s0, s1, depth / (enter * leave) * world);
    }
    let s0 = clamp(on_picture - ranges.z * enter, head.w, head.z);
    let s1 = clamp(on_picture - ranges.z * leave, head.w, head.z);
    return Segment(s0, s1, depth * world);
}
