// From a CaseFan (src/stages/fans/cases.rs) to triangles. As numbers of four bytes:
//   0: triangle count 0 s min max | 4: twelve vertices x y, front v q, back v q | 76: sixteen triangles, two a number | 84: 0 … mark

const CASE_FANS: u32 = 4u;
const CASE_TRIANGLES: u32 = 16u;
const CASE_VERTICES: u32 = 4u;
const CASE_INDICES: u32 = 76u;
const CASE_MARK: u32 = 95u;

fn number_of(fan: u32, i: u32) -> u32 {
    return fans[fan + i / 24u].words[i % 24u / 4u][i % 4u];
}

fn pair_of(fan: u32, i: u32) -> vec2<f32> {
    return bitcast<vec2<f32>>(vec2<u32>(number_of(fan, i), number_of(fan, i + 1u)));
}

// Three vertices a triangle; those that a record has not cover nothing.
@vertex
fn vertex_of_triangle(@builtin(vertex_index) index: u32) -> Fragment {
    let fan = index / (3u * CASE_TRIANGLES) * CASE_FANS;
    let triangle = index / 3u % CASE_TRIANGLES;
    let k = index % 3u;
    if number_of(fan, CASE_MARK) == 0u {
        // Of a fan: the thick vertex, ring i, ring i + 1.
        let ring = select(triangle + 1u, (triangle + 1u) % 4u + 1u, k == 2u);
        return record_vertex(fan, select(0u, ring, k > 0u && triangle < 4u));
    }
    let packed = number_of(fan, CASE_INDICES + triangle / 2u) >> (16u * (triangle % 2u));
    let at = CASE_VERTICES + 6u * (packed >> (4u * k) & 15u);
    let enter_leave = vec4<f32>(pair_of(fan, at + 2u), pair_of(fan, at + 4u));
    return fragment_at(pair_of(fan, at), enter_leave, floats(fan, 0u).zw);
}
