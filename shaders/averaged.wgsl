// The papers' averages (src/optics/averaged.rs): colour and extinction are read at a segment's ends and averaged.

fn weights(length_world: f32, k0: f32, k1: f32) -> SegmentWeights {
    return segment_weights_average(k0 * length_world, k1 * length_world);
}
