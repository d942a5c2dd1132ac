// From a PolyFan (src/stages/fans/faces.rs) and its list to the parts of a ray in it. As words:
//   box columns rows, s max min | list, corners, around, flags | w of the middle, least length in depth
//   list: corners (x·w, y·w, w, s) | eight corners of faces, two a word, each face's first one marked

const IS_POLYHEDRON: u32 = 0x40000000u;
const FIRST_OF_FACE: u32 = 32768u;

// So much aside, in pixels, is seen which cells a ray meets that runs into a corner or along an edge, as in backends/cpu/polyhedra.rs.
const ASIDE_PX = vec2<f32>(3e-4, 2e-4);

// What a ray has crossed: depths from the middle of the cell, and values.
struct Crossed {
    entries: u32,
    exits: u32,
    // The sum of signed depths within those that are drawn.
    depth: f32,
    nearest: Crossings,
}

fn listed(in: Fragment, k: u32) -> vec4<u32> {
    return fans[in.head.x + k / 6u].words[k % 6u];
}

// Relative to the ray at a position: x·w, y·w, depth from the middle, s.
fn listed_corner(in: Fragment, k: u32, at: vec2<f32>) -> vec4<f32> {
    let corner = bitcast<vec4<f32>>(listed(in, k));
    return vec4<f32>(corner.xy - at * select(1.0, corner.z, frame.is_perspective != 0u), corner.z - in.a.x, corner.w);
}

// All triangles against the ray at a position. Depths of the sum are cut to `range`; others are kept from `beyond` on.
fn cross_faces(in: Fragment, at: vec2<f32>, range: vec2<f32>, beyond: f32) -> Crossed {
    var found: Crossed;
    for (var i = 0u; i < PARTS; i++) {
        found.nearest.enter[i] = vec2<f32>(LARGEST);
        found.nearest.leave[i] = vec2<f32>(LARGEST);
    }
    var first: vec4<f32>;
    var before: vec4<f32>;
    var to_before: Side;
    var first_number = 0u;
    var before_number = 0u;
    // Corners since the face began.
    var nth = 0u;
    for (var k = 0u; k < in.head.z; k++) {
        let eight = listed(in, in.head.y + k / 8u);
        let number = eight[k % 8u / 2u] >> (16u * (k & 1u)) & 0xffffu;
        let next_number = number & ~FIRST_OF_FACE;
        let next = listed_corner(in, next_number, at);
        nth = select(nth + 1u, 0u, (number & FIRST_OF_FACE) != 0u);
        if nth == 0u {
            first = next;
            first_number = next_number;
            continue;
        }
        let to_next = side_between(first_number > next_number, first, next);
        if nth > 1u {
            let outer = side_between(before_number > next_number, before, next);
            if to_before.is_left == outer.is_left && outer.is_left != to_next.is_left {
                let whole = to_before.product + outer.product - to_next.product;
                let sum = outer.product * first.zw - to_next.product * before.zw + to_before.product * next.zw;
                let crossing = sum / select(whole, 1.0, whole == 0.0);
                let clamped = clamp(crossing.x, range.x, range.y);
                if outer.is_left {
                    found.exits += 1u;
                    found.depth += clamped;
                    if crossing.x > beyond {
                        found.nearest.leave = with_crossing(found.nearest.leave, crossing);
                    }
                } else {
                    found.entries += 1u;
                    found.depth -= clamped;
                    if crossing.x >= beyond {
                        found.nearest.enter = with_crossing(found.nearest.enter, crossing);
                    }
                }
            }
        }
        before = next;
        before_number = next_number;
        to_before = to_next;
    }
    return found;
}

// Inverse depth of a depth from the middle.
fn inverse_depth(in: Fragment, depth: f32) -> f32 {
    let w = depth + in.a.x;
    return select(-w, 1.0 / w, frame.is_perspective != 0u);
}

// The part of the ray between its nth crossings, its length in depth.
fn part_of_polyhedron(in: Fragment, found: Crossings, nth: u32, range: vec2<f32>) -> Segment {
    let enter = found.enter[nth];
    let leave = found.leave[nth];
    let s_max = in.s_range.x;
    let s_min = in.s_range.y;
    let w0 = clamp(enter.x, range.x, range.y);
    let w1 = clamp(leave.x, range.x, range.y);
    // Without one of both, the other is of no use.
    if !(w1 - w0 > in.a.y) || max(enter.x, leave.x) == LARGEST {
        return Segment(s_min, s_min, 0.0);
    }
    note_part(inverse_depth(in, w0), inverse_depth(in, w1));
    let slope = (leave.y - enter.y) / (leave.x - enter.x);
    let s0 = clamp(enter.y + slope * (w0 - enter.x), s_min, s_max);
    let s1 = clamp(leave.y + slope * (w1 - leave.x), s_min, s_max);
    return Segment(s0, s1, w1 - w0);
}

// All of a cell's light on a ray.
fn of_polyhedron(in: Fragment) -> vec4<f32> {
    let pixel = pixel_of(in);
    let world = length_per_depth(pixel);
    let v_far = v_far_at(in.position);
    var range = vec2<f32>(-frame.v_near, -v_far);
    if frame.is_perspective != 0u {
        range = vec2<f32>(1.0 / frame.v_near, select(LARGEST, 1.0 / v_far, v_far > 0.0));
    }
    range = range - in.a.x;
    var at = pixel;
    var found = cross_faces(in, at, range, -LARGEST);
    if found.entries != found.exits {
        at = pixel + ASIDE_PX;
        found = cross_faces(in, at, range, -LARGEST);
    }
    if found.entries != found.exits || found.entries == 0u {
        return NOTHING;
    }
    if (in.head.w & IS_CONSTANT) != 0u {
        // Parts of one value are as dense as their whole length; where each of them lies is asked for the order.
        for (var i = 0u; i < min(found.entries, PARTS); i++) {
            let part = part_of_polyhedron(in, found.nearest, i, range);
        }
        if !(found.depth > in.a.y) {
            return NOTHING;
        }
        return of_segment(Segment(in.s_range.y, in.s_range.y, found.depth * world), in.span);
    }
    var sum = NOTHING;
    var left = found.entries;
    // As many parts at a time as are kept.
    while left > 0u {
        let parts = min(left, PARTS);
        for (var i = 0u; i < parts; i++) {
            var part = part_of_polyhedron(in, found.nearest, i, range);
            if part.length_world > 0.0 {
                part.length_world *= world;
                sum = over(sum, of_segment(part, in.span));
            }
        }
        left -= parts;
        if left > 0u {
            found = cross_faces(in, at, range, found.nearest.leave[PARTS - 1u].x);
        }
    }
    return sum;
}
