// Where the order must be exact: what the depth test of src/backends/gpu/late.rs compares, and the tiles it cannot judge.

// A word for each tile, row by row.
@group(2) @binding(0) var<storage, read_write> late_tiles: array<atomic<u32>>;

// Inverse depth where the ray enters and leaves the nearest part of the cell, and how many parts it has there.
var<private> nearest: vec2<f32>;
var<private> parts: u32;

// Parts thinner than some ulp have no place in an order, and nothing to show.
const THINNEST: f32 = 2.5e-7;

fn is_part(enter: f32, leave: f32) -> bool {
    return enter - leave > THINNEST * select(1.0, enter, frame.is_perspective != 0u);
}

fn note_part(enter: f32, leave: f32) {
    if !is_part(enter, leave) {
        return;
    }
    if parts == 0u {
        nearest = vec2<f32>(enter, leave);
    }
    parts += 1u;
}

// From 0, far away, to 1; nothing where the ray misses the cell.
fn order_depth(in: Fragment) -> f32 {
    if parts == 0u {
        discard;
    }
    if parts > 1u {
        // Cells lie between the parts, whichever is drawn first.
        let tile = vec2<u32>(pixel_of(in)) / TILE_PX;
        atomicOr(&late_tiles[tile.y * frame.tile_columns + tile.x - frame.first_tile], 1u);
    }
    let middle = 0.5 * (nearest.x + nearest.y);
    if frame.is_perspective != 0u {
        // 1 / (1 + depth)
        return middle / (1.0 + middle);
    }
    return clamp(middle * frame.order_scale + frame.order_offset, 0.0, 1.0);
}
