// Opaque geometry to colour and inverse depth, as src/backends/cpu/geometry draws it: triangles here, lines and points in strokes.wgsl.

struct Geometry {
    eye: vec3<f32>,
    is_perspective: u32,
    forward: vec3<f32>,
    near: f32,
    // Picture position of q = p − eye: (q · to_x + center_x · w) / w, w being the depth, or 1.
    to_x: vec3<f32>,
    center_x: f32,
    to_y: vec3<f32>,
    center_y: f32,
    // Direction (parallel rays: origin) of the ray of pixel (0, 0), and its change per pixel.
    first: vec3<f32>,
    v_far: f32,
    step_x: vec3<f32>,
    v_near: f32,
    step_y: vec3<f32>,
    // How far surfaces stand back in comparisons, in pixels of their slope.
    setback_px: f32,
    color: vec3<f32>,
    width_px: f32,
    ndc_scale: vec2<f32>,
    ndc_offset: vec2<f32>,
    size_px: vec2<f32>,
    // From inverse depth to what is compared, 0 to 1.
    z_scale: f32,
    z_offset: f32,
    // First column and row of the part of the picture that is drawn.
    first_px: vec2<f32>,
    has_back_only: u32,
    // Bit 0: corners have colours; bit 1: normals.
    has_looks: u32,
}

@group(0) @binding(0) var<uniform> geometry: Geometry;

// Outside of what is drawn.
const NOWHERE = vec4<f32>(0.0, 0.0, 2.0, 1.0);

struct Drawn {
    // Linear RGB, and inverse depth.
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) z: f32,
}

// x · w, y · w, w, depth.
fn project(position: vec3<f32>) -> vec4<f32> {
    let q = position - geometry.eye;
    let depth = dot(q, geometry.forward);
    let w = select(1.0, depth, geometry.is_perspective != 0u);
    let x = dot(q, geometry.to_x) + geometry.center_x * w;
    let y = dot(q, geometry.to_y) + geometry.center_y * w;
    return vec4<f32>(x, y, w, depth);
}

fn inverse(depth: f32) -> f32 {
    return select(-depth, 1.0 / depth, geometry.is_perspective != 0u);
}

fn shows(v: f32) -> bool {
    return v >= geometry.v_far && v <= geometry.v_near;
}

struct Surface {
    @builtin(position) position: vec4<f32>,
    // Inverse depth at pixel (0, 0), per column, per row.
    @location(0) @interpolate(flat) plane: vec3<f32>,
    // Smallest and largest of the triangle.
    @location(1) @interpolate(flat) range: vec2<f32>,
    @location(2) @interpolate(flat) normal: vec3<f32>,
}

@vertex
fn triangle(
    @builtin(vertex_index) index: u32,
    @location(0) a: vec3<f32>,
    @location(1) b: vec3<f32>,
    @location(2) c: vec3<f32>,
) -> Surface {
    return surface(index, a, b, c);
}

fn surface(index: u32, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> Surface {
    let is_perspective = geometry.is_perspective != 0u;
    var out: Surface;
    let across = cross(b - a, c - a);
    let size = length(across);
    let normal = across / max(size, 1e-30);
    // Perspective: 1/w = n·d / n·(a − e). Parallel rays: −w = n·(o − a) / n·f.
    let height = select(dot(normal, geometry.forward), dot(normal, a - geometry.eye), is_perspective);
    let first = select(geometry.first - a, geometry.first, is_perspective);
    let plane = vec3<f32>(dot(normal, first), dot(normal, geometry.step_x), dot(normal, geometry.step_y));
    let is_hidden = geometry.has_back_only != 0u && height < 0.0;
    if height == 0.0 || size == 0.0 || is_hidden {
        out.position = NOWHERE;
        return out;
    }
    out.plane = plane / height;
    out.normal = normal;
    let corners = array<vec4<f32>, 3>(project(a), project(b), project(c));
    out.range = vec2<f32>(LARGEST, -LARGEST);
    for (var k = 0u; k < 3u; k++) {
        let depth = corners[k].w;
        if is_perspective && depth < geometry.near {
            out.range.y = geometry.v_near;
            continue;
        }
        let v = inverse(depth);
        out.range = vec2<f32>(min(out.range.x, v), max(out.range.y, v));
    }
    let at = corners[index];
    // The near plane is that of the clip volume; along parallel rays fragments are looked at.
    let z = select(0.5, geometry.near, is_perspective);
    let in_region = at.xy - geometry.first_px * at.z;
    out.position = vec4<f32>(in_region * geometry.ndc_scale + geometry.ndc_offset * at.z, z, at.z);
    return out;
}

@fragment
fn of_triangle(in: Surface) -> Drawn {
    return fragment_of(in, geometry.color, in.normal);
}

// A triangle with a colour and a normal at each corner.
struct Looks {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) plane: vec3<f32>,
    @location(1) @interpolate(flat) range: vec2<f32>,
    @location(2) @interpolate(flat) normal: vec3<f32>,
    // Linear on the triangle.
    @location(3) color: vec3<f32>,
    @location(4) between: vec3<f32>,
}

@vertex
fn triangle_with_looks(
    @builtin(vertex_index) index: u32,
    @location(0) a: vec3<f32>,
    @location(1) b: vec3<f32>,
    @location(2) c: vec3<f32>,
    @location(3) color_a: vec3<f32>,
    @location(4) color_b: vec3<f32>,
    @location(5) color_c: vec3<f32>,
    @location(6) normal_a: vec3<f32>,
    @location(7) normal_b: vec3<f32>,
    @location(8) normal_c: vec3<f32>,
) -> Looks {
    let plain = surface(index, a, b, c);
    let colors = array<vec3<f32>, 3>(color_a, color_b, color_c);
    let normals = array<vec3<f32>, 3>(normal_a, normal_b, normal_c);
    return Looks(plain.position, plain.plane, plain.range, plain.normal, colors[index], normals[index]);
}

@fragment
fn of_triangle_with_looks(in: Looks) -> Drawn {
    let size = length(in.between);
    let has_normal = (geometry.has_looks & 2u) != 0u && size > 0.0;
    let normal = select(in.normal, in.between / max(size, 1e-30), has_normal);
    let color = select(geometry.color, in.color, (geometry.has_looks & 1u) != 0u);
    return fragment_of(Surface(in.position, in.plane, in.range, in.normal), color, normal);
}

fn fragment_of(in: Surface, color: vec3<f32>, normal: vec3<f32>) -> Drawn {
    let pixel = in.position.xy - 0.5 + geometry.first_px;
    let v = clamp(dot(in.plane, vec3<f32>(1.0, pixel)), in.range.x, in.range.y);
    if !shows(v) {
        discard;
    }
    var compared = v;
    let is_perspective = geometry.is_perspective != 0u;
    if geometry.setback_px > 0.0 {
        // No farther back than its farthest corner, and a little.
        let slope = geometry.setback_px * (abs(in.plane.y) + abs(in.plane.z));
        compared = max(v - slope, in.range.x) - SETBACK * select(1.0, v, is_perspective);
    }
    let along = geometry.first + pixel.x * geometry.step_x + pixel.y * geometry.step_y;
    let ray = normalize(select(geometry.forward, along, is_perspective));
    let light = AMBIENT + (1.0 - AMBIENT) * min(abs(dot(normal, ray)), 1.0);
    return Drawn(vec4<f32>(color * light, v), compared * geometry.z_scale + geometry.z_offset);
}
