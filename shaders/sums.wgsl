// Emission and absorption apart (src/optics/emission.rs, absorption.rs): RGB ∫ c κ dt, A ∫ κ dt.

fn of_piece(piece: Piece, part: Segment) -> vec4<f32> {
    let k0 = extinction_at(piece, part.enter);
    let k1 = extinction_at(piece, part.leave);
    let light = product_mean(k0, k1, color_at(piece, part.enter), color_at(piece, part.leave));
    return part.length_world * vec4<f32>(light, 0.5 * (k0 + k1));
}
