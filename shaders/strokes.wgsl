// Lines and points, as src/backends/cpu/geometry/strokes.rs draws them: as wide in pixels wherever they are, flat in colour. What is
// covered is decided at each centre; the triangles that are drawn reach a pixel farther.

// Two triangles of four corners, as signs.
const CORNERS = array<vec2<f32>, 6>(
    vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, -1.0), vec2<f32>(-1.0, 1.0),
    vec2<f32>(-1.0, 1.0), vec2<f32>(1.0, -1.0), vec2<f32>(1.0, 1.0),
);

fn on_picture(pixel: vec2<f32>) -> vec4<f32> {
    return vec4<f32>((pixel - geometry.first_px) * geometry.ndc_scale + geometry.ndc_offset, 0.5, 1.0);
}

fn flat_color(v: f32) -> Drawn {
    return Drawn(vec4<f32>(geometry.color, v), v * geometry.z_scale + geometry.z_offset);
}

struct Stroke {
    @builtin(position) position: vec4<f32>,
    // Both ends in pixels.
    @location(0) @interpolate(flat) ends: vec4<f32>,
    // Their inverse depths.
    @location(1) @interpolate(flat) v: vec2<f32>,
}

// Of five sides those beyond which nothing is drawn: the near plane, and `margin` pixels outside the picture; negative is outside.
fn sides(p: vec4<f32>, margin: f32) -> array<f32, 5> {
    let beyond = p.xy + margin * p.z;
    let before = (geometry.size_px + 2.0 * margin) * p.z - beyond;
    return array<f32, 5>(p.w - geometry.near, beyond.x, before.x, beyond.y, before.y);
}

@vertex
fn line(@builtin(vertex_index) index: u32, @location(0) from_p: vec3<f32>, @location(1) to_p: vec3<f32>) -> Stroke {
    let half = 0.5 * geometry.width_px + LINE_SLACK_PX;
    var out: Stroke;
    out.position = NOWHERE;
    let a = project(from_p);
    let b = project(to_p);
    let from_sides = sides(a, half + 1.0);
    let to_sides = sides(b, half + 1.0);
    var start = 0.0;
    var end = 1.0;
    for (var k = 0u; k < 5u; k++) {
        let from_side = from_sides[k];
        let to_side = to_sides[k];
        if from_side < 0.0 && to_side < 0.0 {
            return out;
        }
        if from_side < 0.0 {
            start = max(start, from_side / (from_side - to_side));
        } else if to_side < 0.0 {
            end = min(end, from_side / (from_side - to_side));
        }
    }
    if start > end {
        return out;
    }
    let first = a + (b - a) * start;
    let last = a + (b - a) * end;
    let ends = vec4<f32>(first.xy / first.z, last.xy / last.z);
    let way = ends.zw - ends.xy;
    let size = length(way);
    let along = select(vec2<f32>(1.0, 0.0), way / max(size, 1e-30), size > 0.0);
    let corner = CORNERS[index];
    let middle = select(ends.xy, ends.zw, corner.x > 0.0);
    let reach = half + 1.0;
    out.position = on_picture(middle + reach * (corner.x * along + corner.y * vec2<f32>(-along.y, along.x)));
    out.ends = ends;
    out.v = vec2<f32>(inverse(first.w), inverse(last.w));
    return out;
}

@fragment
fn of_line(in: Stroke) -> Drawn {
    let half = 0.5 * geometry.width_px + LINE_SLACK_PX;
    let from_first = in.position.xy - 0.5 + geometry.first_px - in.ends.xy;
    let along = in.ends.zw - in.ends.xy;
    let per_length = dot(along, along);
    let t = select(0.0, clamp(dot(from_first, along) / max(per_length, 1e-30), 0.0, 1.0), per_length > 0.0);
    let off = from_first - along * t;
    let v = in.v.x + (in.v.y - in.v.x) * t;
    if dot(off, off) > half * half || !shows(v) {
        discard;
    }
    return flat_color(v);
}

struct Dot {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) center: vec2<f32>,
    @location(1) @interpolate(flat) v: f32,
}

@vertex
fn point(@builtin(vertex_index) index: u32, @location(0) position: vec3<f32>) -> Dot {
    var out: Dot;
    out.position = NOWHERE;
    let p = project(position);
    let v = inverse(p.w);
    if !(p.z > 0.0) || !shows(v) {
        return out;
    }
    out.center = p.xy / p.z;
    out.v = v;
    out.position = on_picture(out.center + (0.5 * geometry.width_px + 1.0) * CORNERS[index]);
    return out;
}

@fragment
fn of_point(in: Dot) -> Drawn {
    let half = 0.5 * geometry.width_px;
    let off = in.position.xy - 0.5 + geometry.first_px - in.center;
    if any(off < vec2<f32>(-half)) || any(off >= vec2<f32>(half)) {
        discard;
    }
    return flat_color(in.v);
}
