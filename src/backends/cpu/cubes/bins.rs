//! The tiles of cubes: for each tile the cubes that may cover a pixel of it, in their order.
//!
//! Runs of cubes are spread over the tiles by one thread each, counted first and then written; a tile's cubes are its parts of all
//! runs, one after the other. So the order is that of the cubes, whatever the number of threads and runs.

use glam::{DVec3, Vec2};
use rayon::prelude::*;

use crate::backends::cpu::grid::{TileBox, TileGrid};
use crate::columns::Cube;
use crate::stages::footprints::{PixelBox, PixelBoxes};
use crate::stages::{CubesInView, SceneVertex, ScreenVertex, View};

/// A cube and its pixels.
#[derive(Clone, Copy)]
pub(in crate::backends::cpu) struct BinnedCube {
    pub(super) cube: Cube,
    /// Its place among the cubes of the frame.
    pub(super) number: u32,
    pub(super) pixels: PixelBox,
}

/// The cubes of each tile.
#[derive(Default)]
pub(super) struct CubeBins {
    runs: Vec<Run>,
}

/// Some cubes, spread over the tiles.
#[derive(Default)]
struct Run {
    /// Those that may cover a pixel.
    cubes: Vec<BinnedCube>,
    /// Numbers of them, tile by tile.
    cube_from_entry: Vec<u32>,
    /// Where each tile's begin, and the last one's end.
    first_of_tile: Vec<u32>,
}

/// Runs that each thread takes, one after the other: enough for threads to end at the same time.
const RUNS_PER_THREAD: usize = 8;
/// Cubes below which a run is not worth its tables.
const RUN_MIN: usize = 1 << 12;

impl CubeBins {
    /// Spreads cubes, farthest first, over tiles; how many may cover a pixel.
    pub(super) fn fill(&mut self, cubes: &CubesInView, view: &View, grid: &TileGrid) -> u64 {
        let _span = tracing::trace_span!("footprints").entered();
        let per_run = cubes.cubes.len().div_ceil(RUNS_PER_THREAD * rayon::current_num_threads()).max(RUN_MIN);
        let boxes = CubeBoxes::new(cubes, view, grid);
        self.runs.resize_with(cubes.cubes.len().div_ceil(per_run), Run::default);
        let runs = self.runs.par_iter_mut().zip(cubes.cubes.par_chunks(per_run));
        runs.enumerate()
            .map(|(i, (run, some))| {
                run.fill((i * per_run, some), &boxes, grid);
                run.cubes.len() as u64
            })
            .sum()
    }

    /// Puts the cubes of a tile, nearest first, into `nearest_first`.
    pub(super) fn cubes_of(&self, tile: usize, nearest_first: &mut Vec<BinnedCube>) {
        nearest_first.clear();
        for run in self.runs.iter().rev() {
            let [first, end] = [0, 1].map(|next| run.first_of_tile[tile + next] as usize);
            let cube = |&entry: &u32| run.cubes[entry as usize];
            nearest_first.extend(run.cube_from_entry[first..end].iter().rev().map(cube));
        }
    }

    /// Cubes of all tiles together.
    pub(super) fn entries(&self) -> u64 {
        self.runs.iter().map(|run| run.cube_from_entry.len() as u64).sum()
    }
}

impl Run {
    /// With cubes of which the first is that of number `first`.
    fn fill(&mut self, (first, cubes): (usize, &[Cube]), boxes: &CubeBoxes, grid: &TileGrid) {
        self.cubes.clear();
        self.first_of_tile.clear();
        self.first_of_tile.resize(grid.len() + 1, 0);
        for (number, &cube) in (first as u32..).zip(cubes) {
            if let Some(pixels) = boxes.of(&cube) {
                self.cubes.push(BinnedCube { cube, number, pixels });
                TileBox::around(pixels).tiles(grid).for_each(|tile| self.first_of_tile[tile] += 1);
            }
        }
        let mut entries = 0;
        for first in &mut self.first_of_tile {
            entries += *first;
            *first = entries;
        }
        // Each count is where the tile's entries end now: written from behind, it becomes where they begin.
        self.cube_from_entry.clear();
        self.cube_from_entry.resize(entries as usize, 0);
        for (number, cube) in self.cubes.iter().enumerate().rev() {
            for tile in TileBox::around(cube.pixels).tiles(grid) {
                self.first_of_tile[tile] -= 1;
                self.cube_from_entry[self.first_of_tile[tile] as usize] = number as u32;
            }
        }
    }
}

/// What maps cubes to pixel boxes for one view.
struct CubeBoxes<'a> {
    cubes: &'a CubesInView<'a>,
    view: &'a View,
    boxes: PixelBoxes,
    /// (x·w, y·w, w), in perspective, and (x, y, w) along parallel rays, of grid point (0, 0, 0).
    origin: DVec3,
    /// What a step along each axis of the grid adds to it.
    steps: [DVec3; 3],
}

impl<'a> CubeBoxes<'a> {
    fn new(cubes: &'a CubesInView<'a>, view: &'a View, grid: &TileGrid) -> Self {
        let (to_x, to_y) = (view.step_x / view.step_x.length_squared(), view.step_y / view.step_y.length_squared());
        let of_vector = |v: DVec3| {
            let w = v.dot(view.forward);
            // The ray of pixel (0, 0) is apart from the view axis; along parallel rays it starts there.
            let apart = if view.is_perspective { w } else { 0.0 };
            DVec3::new(v.dot(to_x) - view.corner.dot(to_x) * apart, v.dot(to_y) - view.corner.dot(to_y) * apart, w)
        };
        let map = cubes.scene_from_grid();
        let from_corner = if view.is_perspective { DVec3::ZERO } else { view.corner };
        let steps = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis].map(of_vector);
        let origin = of_vector(map.translation - view.eye - from_corner);
        let origin = DVec3::new(origin.x, origin.y, (map.translation - view.eye).dot(view.forward));
        // All pixels of the tiles: blocks at the edge of a region end as they do in the whole picture.
        let boxes = PixelBoxes::new(view).within(grid.pixels(view.size_px));
        Self { cubes, view, boxes, origin, steps }
    }

    /// The pixels that a cube may cover; `None` if there is none.
    #[inline]
    fn of(&self, cube: &Cube) -> Option<PixelBox> {
        let [low, high] = self.cubes.ends(cube);
        let [i, j, k] = self.steps;
        let first = self.origin + i * low.x + j * low.y + k * low.z;
        let side = high - low;
        let (i, j, k) = (i * side.x, j * side.y, k * side.z);
        let corners = [first, first + i, first + j, first + i + j].map(|corner| [corner, corner + k]);
        let corners = corners.as_flattened();
        let depths = corners.iter().map(|corner| corner.z);
        let (nearest, farthest) =
            depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(near, far), w| (near.min(w), far.max(w)));
        if nearest > self.view.far.into() || farthest < self.view.near.into() {
            return None;
        }
        if nearest < self.view.near.into() {
            return self.across_near([low, high]);
        }
        let (mut least, mut most) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for corner in corners {
            let scale = if self.view.is_perspective { corner.z.recip() } else { 1.0 };
            let at = Vec2::new((corner.x * scale) as f32, (corner.y * scale) as f32);
            (least, most) = (least.min(at), most.max(at));
        }
        self.boxes.around(least, most)
    }

    /// The same for one that the near plane cuts.
    #[cold]
    fn across_near(&self, ends: [DVec3; 2]) -> Option<PixelBox> {
        let projection = self.view.projection();
        let corners = self.cubes.corners(ends);
        let vertices = corners.map(|corner| SceneVertex { position: corner.to_array(), scalar: 0.0 });
        let screen = corners.map(|corner| {
            let p = projection.project(corner);
            ScreenVertex { x_px: p.x, y_px: p.y, depth: p.z, scalar: 0.0 }
        });
        self.boxes.of_cell([0, 1, 2, 3, 4, 5, 6, 7], &vertices, &screen)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;
    use crate::camera::{Camera, Projection};
    use crate::columns::{CubeGrid, Lattice};

    #[test]
    fn every_tile_has_the_cubes_whose_pixels_touch_it_in_their_order() {
        let steps = DMat3::from_cols(DVec3::X * 0.9, DVec3::new(0.2, 1.0, 0.1), DVec3::new(0.0, -0.3, 1.1));
        let grid = CubeGrid { dims: [20, 30, 10], lattice: Lattice::sheared(DVec3::new(5.0, -2.0, 1.0), steps) };
        let place = grid.place();
        let cubes: Vec<Cube> = (0..20 * 30 * 10)
            .map(|i: u16| Cube { node: [i % 20, i / 20 % 30, i / 600], level: 0, value: 0.0 })
            .collect();
        let camera = Camera::framing(&grid.corners_world(), 40.0, 25.0, 150, 100);
        let parallel = Camera { projection: Projection::Orthographic { height_world: 20.0 }, ..camera.clone() };
        let inside = Camera::looking_at(place.center_world(), grid.corners_world()[6], 150, 100);
        for camera in [camera, parallel, inside] {
            let view = View::new(&camera, &place).unwrap();
            let cubes = CubesInView::new(&cubes, &grid, place.origin, &view);
            let tiles = TileGrid::new(&view);
            let mut bins = CubeBins::default();
            let drawn = bins.fill(&cubes, &view, &tiles);
            assert!(drawn > 500, "{drawn}");
            let boxes = CubeBoxes::new(&cubes, &view, &tiles);
            let mut entries = 0;
            for tile in 0..tiles.len() {
                let [column, row] = tiles.place(tile);
                let mut found = Vec::new();
                bins.cubes_of(tile, &mut found);
                let found: Vec<Cube> = found.iter().rev().map(|found| found.cube).collect();
                let touches =
                    |cube: &&Cube| boxes.of(cube).is_some_and(|pixels| TileBox::around(pixels).touches(column, row));
                let expected: Vec<Cube> = cubes.cubes.iter().filter(touches).copied().collect();
                assert!(found == expected, "tile {tile}");
                entries += found.len();
            }
            assert_eq!(bins.entries(), entries as u64);
            // Boxes hold the corners that are in front of the eye.
            let projection = view.projection();
            for cube in cubes.cubes {
                let seen = cubes.corners(cubes.ends(cube)).map(|corner| projection.project(corner));
                for corner in seen.iter().filter(|corner| corner.z > view.near.max(0.5)) {
                    let is_in = |pixels: PixelBox| {
                        let pad = 1.01;
                        (f32::from(pixels.x0) - pad..=f32::from(pixels.x1) + pad).contains(&corner.x)
                            && (f32::from(pixels.y0) - pad..=f32::from(pixels.y1) + pad).contains(&corner.y)
                    };
                    let is_in_picture = corner.x >= 0.0 && corner.x <= 149.0 && corner.y >= 0.0 && corner.y <= 99.0;
                    assert!(!is_in_picture || boxes.of(cube).is_none_or(is_in), "{cube:?} {corner}");
                }
            }
        }
    }
}
