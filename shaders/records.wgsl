// Where there are other records in the room of fans: of each a box is drawn, and fragments find what they need in the
// record, which the first vertex of a triangle hands on (flat means the first one): memory is read once a cell, not once a fragment.

struct Fragment {
    @builtin(position) position: vec4<f32>,
    // Of a fan (v, q) where the ray enters and where it leaves: affine on the picture.
    @location(0) @interpolate(linear) enter_leave: vec4<f32>,
    // Smallest and largest value of the cell; other records have them the other way round.
    @location(1) @interpolate(flat) s_range: vec2<f32>,
    // The pieces of the transfer function that the cell touches, both ends included.
    @location(2) @interpolate(flat) span: vec2<u32>,
    // First column and row of the box.
    @location(3) @interpolate(flat) first_px: vec2<f32>,
    // The second word, and those after it: four planes or eight corners.
    @location(4) @interpolate(flat) head: vec4<u32>,
    @location(5) @interpolate(flat) a: vec4<f32>,
    @location(6) @interpolate(flat) b: vec4<f32>,
    @location(7) @interpolate(flat) c: vec4<f32>,
    @location(8) @interpolate(flat) d: vec4<f32>,
    @location(9) @interpolate(flat) e: vec4<f32>,
    @location(10) @interpolate(flat) f: vec4<f32>,
    @location(11) @interpolate(flat) g: vec4<f32>,
    @location(12) @interpolate(flat) h: vec4<f32>,
}

fn record_vertex(fan: u32, corner: u32) -> Fragment {
    let s_range = floats(fan, 0u).zw;
    if s_range.x <= s_range.y {
        return fan_vertex(fan, corner);
    }
    return box_vertex(fan, corner, s_range);
}

// One corner of the box twice, then all of them: two triangles cover nothing.
fn box_vertex(fan: u32, corner: u32, s_range: vec2<f32>) -> Fragment {
    let columns_rows = fans[fan].words[0].xy;
    let first_px = vec2<f32>(columns_rows & vec2<u32>(0xffffu));
    let end_px = vec2<f32>(columns_rows >> vec2<u32>(16u));
    let is_beyond = vec2<bool>(corner == 2u || corner == 3u, corner == 3u || corner == 4u);
    var out = fragment_at(select(first_px, end_px, is_beyond) - 0.5, vec4<f32>(0.0), s_range);
    // The first vertex of all triangles.
    if corner == 0u {
        out.first_px = first_px;
        out.head = fans[fan].words[1];
        if HAS_POLYHEDRA && (out.head.w & IS_POLYHEDRON) != 0u {
            out.head.x += fan;
        }
        out.a = floats(fan, 2u);
        out.b = floats(fan, 3u);
        out.c = floats(fan, 4u);
        out.d = floats(fan, 5u);
        if HAS_HEXAHEDRA {
            out.e = floats(fan + 1u, 0u);
            out.f = floats(fan + 1u, 1u);
            out.g = floats(fan + 1u, 2u);
            out.h = floats(fan + 1u, 3u);
        }
    }
    return out;
}

// All of a cell's light on a ray.
fn of_cell(in: Fragment) -> vec4<f32> {
    let is_box = in.s_range.x > in.s_range.y;
    if HAS_POLYHEDRA && is_box && (in.head.w & IS_POLYHEDRON) != 0u {
        return of_polyhedron(in);
    }
    if HAS_HEXAHEDRA && is_box && (in.head.w & IS_HEXAHEDRON) != 0u {
        return of_hexahedron(in);
    }
    var ray: Segment;
    if is_box {
        ray = segment_of_planes(in);
    } else {
        ray = segment_of_fan(in);
    }
    if !(ray.length_world > 0.0) {
        return NOTHING;
    }
    return of_segment(ray, in.span);
}
