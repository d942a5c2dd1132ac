// What all shaders of a frame read; src/backends/gpu/layout.rs declares the same.

struct Frame {
    // Normalised device coordinates of a picture position: (position - first_px) · scale + offset.
    ndc_scale: vec2<f32>,
    ndc_offset: vec2<f32>,
    // World length per scene unit of depth: |ray + x · ray_step_x + y · ray_step_y|.
    ray: vec3<f32>,
    is_perspective: u32,
    ray_step_x: vec3<f32>,
    piece_count: u32,
    ray_step_y: vec3<f32>,
    // Inverse depth of the far and of the near plane.
    v_far: f32,
    v_near: f32,
    // Side of the opacity texture, and what length and extinction are multiplied by for its texels.
    texels: u32,
    texels_per_length: f32,
    texels_per_extinction: f32,
    // Maxima are accumulated as (s - s_middle) · s_scale: 0 and 1, or what fits 16 bits.
    s_middle: f32,
    s_scale: f32,
    // Along parallel rays the order is checked by inverse depth · order_scale + order_offset, from 0 to 1.
    order_scale: f32,
    order_offset: f32,
    // First column and row of the part of the picture that is drawn. The tile in a column and row of the whole picture has there
    // the number row · tile_columns + column - first_tile.
    first_px: vec2<f32>,
    tile_columns: u32,
    first_tile: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
