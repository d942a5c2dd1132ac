//! Where rays come in: exterior faces that look to the eye, and the rays of a tile that meet each.
//!
//! In: the exterior faces of a mesh, its vertices in the picture. Out: the faces of each tile; in a tile, of each ray the faces by which
//! it comes in, nearest first. A ray along an edge of two such faces belongs to one of them: edges are half open.

use rayon::prelude::*;

use super::RayVertex;
use super::mates::{FaceNumber, Mates};
use crate::backends::cpu::grid::{TILE, TileBox, TileGrid};
use crate::backends::cpu::tile::{PIXELS, place_of};
use crate::columns::Dataset;
use crate::stages::classify::{FACES, OUTWARD_IF_POSITIVE};
use crate::stages::sort::adjacency::Face;

/// A face by which rays come into a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Front {
    pub(super) face: FaceNumber,
    /// The cell's vertex opposite to it.
    pub(super) apex: u32,
    /// Its vertices, in the order in which its area is positive.
    pub(super) vertices: [u32; 3],
    /// Which of the cell's four each of them is.
    pub(super) slots: [u32; 3],
}

/// Twice the signed area of the triangle of u, w and the ray, positions relative to the ray.
///
/// Exchanged points give the same bits with the other sign, so that both sides of an edge agree.
#[inline(always)]
#[expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]
pub(super) fn area(u: [f32; 2], w: [f32; 2]) -> f32 {
    u[0] * w[1] - u[1] * w[0]
}

/// Three corners relative to the ray at (x, y).
pub(super) fn relative(corners: &[RayVertex; 3], [x, y]: [f32; 2]) -> [[f32; 2]; 3] {
    corners.each_ref().map(|corner| [corner.x - x, corner.y - y])
}

impl Front {
    /// The face of a cell, if rays come in by it; none where it is seen edge-on.
    ///
    /// Which side of it the cell lies on is the cell's orientation, found in f64: of a sliver the picture does not tell.
    fn new(face: Face, dataset: &Dataset, vertices: &[RayVertex]) -> Option<Self> {
        let (cell, k) = (dataset.tets.view().get(face.cell as usize), face.index as usize % 4);
        let mut slots = FACES[k];
        let corners = slots.map(|slot| vertices[cell[slot] as usize]);
        let [_, b, c] = relative(&corners, [corners[0].x, corners[0].y]);
        let all = area(b, c);
        // Rays run along with the normal where the area is positive.
        let is_outward = dataset.positive.get(face.cell as usize) == OUTWARD_IF_POSITIVE[k];
        if all == 0.0 || (all > 0.0) == is_outward {
            return None;
        }
        if all < 0.0 {
            slots.swap(1, 2);
        }
        Some(Self {
            face: 4 * face.cell + face.index,
            apex: cell[k],
            vertices: slots.map(|slot| cell[slot]),
            slots: slots.map(|slot| slot as u32),
        })
    }

    /// The columns and rows of the picture whose rays may meet it.
    fn pixels(&self, vertices: &[RayVertex]) -> [[f32; 2]; 2] {
        let corners = self.vertices.map(|vertex| vertices[vertex as usize]);
        let range = |of: fn(&RayVertex) -> f32| {
            let [a, b, c] = corners.each_ref().map(of);
            [a.min(b).min(c).ceil(), a.max(b).max(c).floor()]
        };
        [range(|corner| corner.x), range(|corner| corner.y)]
    }
}

/// The faces by which rays come in, tile by tile.
#[derive(Default)]
pub(super) struct Fronts {
    all: Vec<Front>,
    front_from_entry: Vec<u32>,
    /// Where each tile's begin, and the last one's end.
    first_of_tile: Vec<usize>,
}

impl Fronts {
    /// Spreads the faces of `mates` that look to the eye over the tiles of `grid`.
    pub(super) fn fill(&mut self, dataset: &Dataset, mates: &Mates, vertices: &[RayVertex], grid: &TileGrid) {
        let _span = tracing::trace_span!("entrances").entered();
        let [columns, rows] = [&grid.columns, &grid.rows].map(|of| [of.start * TILE, of.end * TILE]);
        let boxed = |&face: &Face| {
            let front = Front::new(face, dataset, vertices)?;
            let [x, y] = front.pixels(vertices);
            let tiles = |[low, high]: [f32; 2], [first, end]: [u32; 2]| {
                let (low, high) = (low.max(first as f32), high.min(end as f32 - 1.0));
                (low <= high).then(|| [low as u16 / TILE as u16, high as u16 / TILE as u16 + 1])
            };
            let ([x0, x1], [y0, y1]) = (tiles(x, columns)?, tiles(y, rows)?);
            Some((front, TileBox { x0, x1, y0, y1 }))
        };
        let boxed: Vec<(Front, TileBox)> = mates.exterior.par_iter().filter_map(boxed).collect();
        self.first_of_tile.clear();
        self.first_of_tile.resize(grid.len() + 1, 0);
        for tile in boxed.iter().flat_map(|(_, tiles)| tiles.tiles(grid)) {
            self.first_of_tile[tile] += 1;
        }
        let mut entries = 0;
        for first in &mut self.first_of_tile {
            entries += *first;
            *first = entries;
        }
        self.front_from_entry.clear();
        self.front_from_entry.resize(entries, 0);
        // Each tile is filled from its end, so that its number becomes its beginning.
        for (front, (_, tiles)) in boxed.iter().enumerate().rev() {
            for tile in tiles.tiles(grid) {
                self.first_of_tile[tile] -= 1;
                self.front_from_entry[self.first_of_tile[tile]] = front as u32;
            }
        }
        self.all.clear();
        self.all.extend(boxed.into_iter().map(|(front, _)| front));
    }

    /// A face by its number among them.
    pub(super) fn front(&self, number: u32) -> &Front {
        &self.all[number as usize]
    }

    fn of_tile(&self, tile: usize) -> &[u32] {
        &self.front_from_entry[self.first_of_tile[tile]..self.first_of_tile[tile + 1]]
    }
}

/// By which faces the rays of a tile come in.
pub(super) struct Entrances {
    /// The ray's place in the tile, its depth there, the number of the front.
    all: Vec<(u16, f32, u32)>,
    /// Where those of each place begin, and the last one's end.
    first_of_place: Box<[u32; PIXELS + 1]>,
}

impl Default for Entrances {
    fn default() -> Self {
        Self { all: Vec::new(), first_of_place: Box::new([0; PIXELS + 1]) }
    }
}

impl Entrances {
    /// Finds those of the tile with its first pixel at `origin_px`.
    pub(super) fn find(
        &mut self,
        fronts: &Fronts,
        vertices: &[RayVertex],
        (tile, origin_px): (usize, [u32; 2]),
        is_perspective: bool,
    ) {
        self.all.clear();
        for &number in fronts.of_tile(tile) {
            let front = fronts.front(number);
            let corners = front.vertices.map(|vertex| vertices[vertex as usize]);
            let [columns, rows] = front.pixels(vertices);
            let within = |[low, high]: [f32; 2], first: u32| {
                let (low, high) = (low.max(first as f32), high.min((first + TILE - 1) as f32));
                if low <= high { low as u32..high as u32 + 1 } else { 0..0 }
            };
            let columns = within(columns, origin_px[0]);
            for y in within(rows, origin_px[1]) {
                for x in columns.clone() {
                    let at = relative(&corners, [x as f32, y as f32]);
                    if let Some(depth) = depth_within(&corners, at, is_perspective) {
                        let place = place_of((x - origin_px[0]) as usize, (y - origin_px[1]) as usize);
                        self.all.push((place as u16, depth, number));
                    }
                }
            }
        }
        self.all.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut next = 0;
        for (place, first) in self.first_of_place.iter_mut().enumerate() {
            next += self.all[next..].iter().take_while(|entrance| usize::from(entrance.0) < place).count();
            *first = next as u32;
        }
    }

    /// Those of the ray at a place, nearest first: the depth there, and the number of the front.
    pub(super) fn of_place(&self, place: usize) -> impl Iterator<Item = (f32, u32)> {
        let [first, end] = [place, place + 1].map(|place| self.first_of_place[place] as usize);
        self.all[first..end].iter().map(|&(_, depth, front)| (depth, front))
    }

    /// How many the ray at a place has.
    pub(super) fn count(&self, place: usize) -> usize {
        (self.first_of_place[place + 1] - self.first_of_place[place]) as usize
    }

    /// The `nth` of the ray at a place.
    pub(super) fn get(&self, place: usize, nth: usize) -> Option<(f32, u32)> {
        self.of_place(place).nth(nth)
    }

    /// Whether no ray comes in.
    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }
}

/// The depth at which the ray meets a triangle with corners at `at` relative to it, if it does.
fn depth_within(corners: &[RayVertex; 3], at: [[f32; 2]; 3], is_perspective: bool) -> Option<f32> {
    let weights = [area(at[1], at[2]), area(at[2], at[0]), area(at[0], at[1])];
    for k in 0..3 {
        let ([x0, y0], [x1, y1]) = (at[(k + 1) % 3], at[(k + 2) % 3]);
        // A ray on an edge belongs to the triangle on one side of it, which runs along it the other way.
        let has_its_edge = y1 < y0 || (y1 <= y0 && x1 > x0);
        let is_inside = weights[k] > 0.0 || (weights[k] >= 0.0 && has_its_edge);
        if !is_inside {
            return None;
        }
    }
    let all: f32 = weights.iter().sum();
    let by_depth: f32 = corners.iter().zip(weights).map(|(corner, weight)| corner.depth_weight * weight).sum();
    let depth = if is_perspective { all / by_depth } else { by_depth / all };
    depth.is_finite().then_some(depth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_on_an_edge_or_corner_belongs_to_one_triangle_of_a_fan() {
        let vertex = |x: f32, y: f32| RayVertex { x, y, depth_weight: 0.5, scalar_weight: 0.0 };
        // Six triangles around (2, 2), all counter-clockwise.
        let around = [(4.0, 2.0), (3.0, 4.0), (1.0, 4.0), (0.0, 2.0), (1.0, 0.0), (3.0, 0.0)];
        let hits = |x: f32, y: f32| {
            let triangles = (0..6).map(|k| {
                let (b, c) = (around[k], around[(k + 1) % 6]);
                [vertex(2.0, 2.0), vertex(b.0, b.1), vertex(c.0, c.1)]
            });
            triangles.filter(|corners| depth_within(corners, relative(corners, [x, y]), true).is_some()).count()
        };
        // Its middle, points on spokes, inside, outside.
        for (x, y, expected) in
            [(2.0, 2.0, 1), (3.0, 2.0, 1), (1.5, 3.0, 1), (1.0, 2.0, 1), (2.5, 1.0, 1), (9.0, 2.0, 0)]
        {
            assert_eq!(hits(x, y), expected, "{x}, {y}");
        }
    }
}
