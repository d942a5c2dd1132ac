// From a PlaneFan (src/stages/fans/planes.rs) to the part of a ray in it.

// Entry is the farthest front face's plane, exit the nearest back face's, as in src/stages/footprints.
fn segment_of_planes(in: Fragment) -> Segment {
    let pixel = pixel_of(in);
    let at = pixel - in.first_px;
    let ranges = bitcast<vec4<f32>>(in.head);
    let fronts = in.head.w;
    let s_max = in.s_range.x;
    let s_min = in.s_range.y;
    let planes = array<vec4<f32>, 4>(in.a, in.b, in.c, in.d);
    var enter = ranges.y;
    var leave = ranges.x;
    var scalar: array<f32, 4>;
    for (var k = 0u; k < 4u; k++) {
        let plane = planes[k];
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
        return Segment(s_min, s_min, 0.0);
    }
    note_part(enter, leave);
    let on_picture = scalar[0] + scalar[1] * at.x + scalar[2] * at.y;
    let world = length_per_depth(pixel);
    if frame.is_perspective != 0u {
        let s0 = clamp(ranges.z + on_picture / enter, s_min, s_max);
        let s1 = clamp(ranges.z + on_picture / leave, s_min, s_max);
        return Segment(s0, s1, depth / (enter * leave) * world);
    }
    let s0 = clamp(on_picture - ranges.z * enter, s_min, s_max);
    let s1 = clamp(on_picture - ranges.z * leave, s_min, s_max);
    return Segment(s0, s1, depth * world);
}
