// From a HexFan (src/stages/fans/hexahedra.rs) to the parts of a ray in it. As words:
//   box columns rows, s max min | v origin, 0 0, flags | eight corners: x y, v origin − v, s·v; homogeneous: x·w y·w w s | 0 | 0

const FIRST_DIAGONAL: u32 = 12u;
const DIAGONALS: u32 = 18u;
const IS_HOMOGENEOUS: u32 = 0x1000000u;
const IS_CONSTANT: u32 = 0x2000000u;
const IS_HEXAHEDRON: u32 = 0x80000000u;

// No ray is cut into more parts by a cell.
const PARTS: u32 = 3u;

// Where a ray crosses triangles: what grows with depth, and what the value is found from; nearest first.
struct Crossings {
    enter: array<vec2<f32>, PARTS>,
    leave: array<vec2<f32>, PARTS>,
}

// The product of an edge's ends, and whether the ray passes on the side where it is positive.
struct Side {
    product: f32,
    is_left: bool,
}

// An edge runs from the vertex of lower number, whichever way it is asked for: the same bits for all cells around it.
fn side(edge: u32, flags: u32, a: vec4<f32>, b: vec4<f32>) -> Side {
    return side_between((flags >> edge & 1u) != 0u, a, b);
}

fn side_between(is_reversed: bool, a: vec4<f32>, b: vec4<f32>) -> Side {
    let first = select(a.xy, b.xy, is_reversed);
    let second = select(b.xy, a.xy, is_reversed);
    let product = first.x * second.y - first.y * second.x;
    return Side(select(product, -product, is_reversed), (product >= 0.0) != is_reversed);
}

fn turned(along: Side) -> Side {
    return Side(-along.product, !along.is_left);
}

// The nearest crossings of those found and one more.
fn with_crossing(nearest: array<vec2<f32>, PARTS>, one: vec2<f32>) -> array<vec2<f32>, PARTS> {
    var sorted = nearest;
    if one.x < sorted[0].x {
        sorted[2] = sorted[1];
        sorted[1] = sorted[0];
        sorted[0] = one;
    } else if one.x < sorted[1].x {
        sorted[2] = sorted[1];
        sorted[1] = one;
    } else if one.x < sorted[2].x {
        sorted[2] = one;
    }
    return sorted;
}

// A triangle that runs counterclockwise seen from outside.
fn cross_triangle(
    found: ptr<function, Crossings>,
    a: vec4<f32>, b: vec4<f32>, c: vec4<f32>,
    ab: Side, bc: Side, ca: Side,
) {
    let whole = ab.product + bc.product + ca.product;
    if ab.is_left != bc.is_left || bc.is_left != ca.is_left || whole == 0.0 {
        return;
    }
    let crossing = (bc.product * a.zw + ca.product * b.zw + ab.product * c.zw) / whole;
    // Rows run down: what is counterclockwise on the picture lies to the right.
    if ab.is_left {
        (*found).leave = with_crossing((*found).leave, crossing);
    } else {
        (*found).enter = with_crossing((*found).enter, crossing);
    }
}

// Both triangles of a face with corners a, b, c, d and the edges between them.
fn cross_face(
    found: ptr<function, Crossings>, face: u32, flags: u32,
    a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>,
    ab: Side, bc: Side, cd: Side, da: Side,
) {
    if (flags >> (DIAGONALS + face) & 1u) == 0u {
        let diagonal = side(FIRST_DIAGONAL + face, flags, a, c);
        cross_triangle(found, a, c, d, diagonal, cd, da);
        cross_triangle(found, c, a, b, turned(diagonal), ab, bc);
    } else {
        let diagonal = side(FIRST_DIAGONAL + face, flags, b, d);
        cross_triangle(found, b, d, a, diagonal, da, ab);
        cross_triangle(found, d, b, c, turned(diagonal), bc, cd);
    }
}

// A corner relative to the fragment (homogeneous: times w), and what is interpolated.
fn corner_at(corner: vec4<f32>, at: vec2<f32>, flags: u32) -> vec4<f32> {
    return vec4<f32>(corner.xy - at * select(1.0, corner.z, (flags & IS_HOMOGENEOUS) != 0u), corner.zw);
}

fn crossings(in: Fragment) -> Crossings {
    let flags = in.head.w;
    let at = pixel_of(in) - in.first_px;
    let a = corner_at(in.a, at, flags);
    let b = corner_at(in.b, at, flags);
    let c = corner_at(in.c, at, flags);
    let d = corner_at(in.d, at, flags);
    let e = corner_at(in.e, at, flags);
    let f = corner_at(in.f, at, flags);
    let g = corner_at(in.g, at, flags);
    let h = corner_at(in.h, at, flags);
    let ab = side(0u, flags, a, b);
    let bc = side(1u, flags, b, c);
    let cd = side(2u, flags, c, d);
    let da = side(3u, flags, d, a);
    let ef = side(4u, flags, e, f);
    let fg = side(5u, flags, f, g);
    let gh = side(6u, flags, g, h);
    let he = side(7u, flags, h, e);
    let ae = side(8u, flags, a, e);
    let bf = side(9u, flags, b, f);
    let cg = side(10u, flags, c, g);
    let dh = side(11u, flags, d, h);
    var found: Crossings;
    for (var i = 0u; i < PARTS; i++) {
        found.enter[i] = vec2<f32>(LARGEST);
        found.leave[i] = vec2<f32>(LARGEST);
    }
    cross_face(&found, 0u, flags, a, e, h, d, ae, turned(he), turned(dh), da);
    cross_face(&found, 1u, flags, b, c, g, f, bc, cg, turned(fg), turned(bf));
    cross_face(&found, 2u, flags, a, b, f, e, ab, bf, turned(ef), turned(ae));
    cross_face(&found, 3u, flags, d, h, g, c, dh, turned(gh), turned(cg), cd);
    cross_face(&found, 4u, flags, a, d, c, b, turned(da), turned(cd), turned(bc), turned(ab));
    cross_face(&found, 5u, flags, e, f, g, h, ef, fg, gh, he);
    return found;
}

// The part of a ray between two crossings, within the depths that are drawn.
fn part_between(in: Fragment, enter: vec2<f32>, leave: vec2<f32>) -> Segment {
    let flags = in.head.w;
    let world = length_per_depth(pixel_of(in));
    let s_max = in.s_range.x;
    let s_min = in.s_range.y;
    var s0 = enter.y;
    var s1 = leave.y;
    var cut0 = 0.0;
    var cut1 = 1.0;
    var depth = 0.0;
    let v_far = v_far_at(in.position);
    if (flags & IS_HOMOGENEOUS) != 0u {
        let far = select(LARGEST, 1.0 / v_far, v_far > 0.0);
        let w0 = clamp(enter.x, 1.0 / frame.v_near, far);
        let w1 = clamp(leave.x, 1.0 / frame.v_near, far);
        depth = w1 - w0;
        note_part(1.0 / w0, 1.0 / w1);
        cut0 = (w0 - enter.x) / (leave.x - enter.x);
        cut1 = (w1 - enter.x) / (leave.x - enter.x);
    } else {
        let v_origin = bitcast<f32>(in.head.x);
        let v0 = v_origin - enter.x;
        let v1 = v_origin - leave.x;
        let clipped0 = clamp(v0, v_far, frame.v_near);
        let clipped1 = clamp(v1, v_far, frame.v_near);
        note_part(clipped0, clipped1);
        let is_whole = clipped0 == v0 && clipped1 == v1;
        // Relative to the origin nothing cancels.
        depth = select(clipped0 - clipped1, leave.x - enter.x, is_whole);
        if !is_whole {
            cut0 = (v0 - clipped0) / (v0 - v1);
            cut1 = (v0 - clipped1) / (v0 - v1);
        }
        if frame.is_perspective != 0u {
            depth = depth / (clipped0 * clipped1);
            s0 = s0 / v0;
            s1 = s1 / v1;
            cut0 = cut0 * v1 / clipped0;
            cut1 = select(cut1 * v1 / clipped1, 1.0, is_whole);
        }
    }
    if !(depth > 0.0) {
        return Segment(s_min, s_min, 0.0);
    }
    if (flags & IS_CONSTANT) != 0u {
        return Segment(s_min, s_min, depth * world);
    }
    // Within the triangles' values, then along the ray.
    s0 = clamp(s0, s_min, s_max);
    s1 = clamp(s1, s_min, s_max);
    return Segment(s0 + (s1 - s0) * cut0, s0 + (s1 - s0) * cut1, depth * world);
}

// All but the nearest part.
fn without_nearest(found: Crossings) -> Crossings {
    let none = vec2<f32>(LARGEST);
    return Crossings(
        array<vec2<f32>, PARTS>(found.enter[1], found.enter[2], none),
        array<vec2<f32>, PARTS>(found.leave[1], found.leave[2], none),
    );
}

// All of a cell's light on a ray: its parts, the nearest in front. Most rays have one: a loop that is not unrolled ends there.
fn of_hexahedron(in: Fragment) -> vec4<f32> {
    var rest = crossings(in);
    var sum = NOTHING;
    while max(rest.enter[0].x, rest.leave[0].x) < LARGEST {
        let part = part_between(in, rest.enter[0], rest.leave[0]);
        if part.length_world > 0.0 {
            sum = over(sum, of_segment(part, in.span));
        }
        rest = without_nearest(rest);
    }
    return sum;
}
