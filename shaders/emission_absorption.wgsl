// Emission and absorption (src/optics/emission_absorption.rs).

fn of_piece(piece: Piece, part: Segment) -> vec4<f32> {
    let k0 = extinction_at(piece, part.enter);
    let k1 = extinction_at(piece, part.leave);
    let w = segment_weights(k0 * part.length_world, k1 * part.length_world);
    return vec4<f32>(w.w0 * color_at(piece, part.enter) + w.w1 * color_at(piece, part.leave), w.transmittance);
}
