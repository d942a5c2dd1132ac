//! Rays followed from cell to cell: tetrahedra without a sort.
//!
//! In: a [`Frame`] of tetrahedra and their [`Mates`]. Out: the picture. `mates`: what lies across each face, once a mesh. `entrances`:
//! exterior faces that look to the eye, the rays that meet them. `packet`: sixteen rays, a cell a step. `tile`: packets in turn.
//!
//! No cell is culled, boxed, keyed, binned or sorted, and no fragment comes late: segments come in the order in which the ray meets
//! them, each from where the last one ended. What it needs in return: [`Mates`] in memory, every vertex between the near and the far
//! plane, and cells that do not overlap. Where a frame is otherwise, footprints draw it.
//!
//! To follow rays through another kind of cell: its faces in `mates`, and which of them a ray leaves by in `packet`.

mod entrances;
mod kernels;
mod mates;
mod packet;
#[cfg(test)]
mod tests;
mod tile;

use std::sync::Mutex;
use std::time::Instant;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayon::prelude::*;

use self::entrances::Fronts;
use self::mates::Mate;
pub use self::mates::Mates;
use self::tile::RayTile;
use super::bins::lock;
use super::dispatch::{InstructionSet, Kernels};
use super::grid::TileGrid;
use super::tile::place_of;
use super::tile_source::{LentTile, TileSource};
use crate::backends::{Counts, Frame};
use crate::image::Image;
use crate::optics::{Intervals, Optics};
use crate::profile::Profile;
use crate::stages::SceneVertex;

/// A vertex as rays meet it: what is linear in the picture.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct RayVertex {
    /// Column and row of the picture, in pixels.
    x: f32,
    y: f32,
    /// Inverse view depth; view depth for parallel rays.
    depth_weight: f32,
    /// The scalar over the view depth; the scalar for parallel rays.
    scalar_weight: f32,
}

/// What rays are followed through.
struct RayMesh<'a> {
    frame: &'a Frame<'a>,
    vertices: &'a [RayVertex],
    mates: &'a [Mate],
    fronts: &'a Fronts,
    cell_values: Option<&'a [f32]>,
    intervals: &'a Intervals,
}

impl RayMesh<'_> {
    /// Whether the next cell's memory is asked for: where the mates do not fit a cache; where they do, it costs more than it gains.
    fn is_large(&self) -> bool {
        /// Bytes of them; chosen: two to four times the caches of two cores.
        const LARGE: usize = 64 << 20;
        size_of_val(self.mates) > LARGE
    }
}

/// A picture by rays.
pub struct FollowedRays {
    /// The picture.
    pub image: Image,
    /// What was counted.
    pub counts: Counts,
    /// The tiles in which a ray met cells out of order, as [`Frame::tiles`] takes them.
    pub is_out_of_order: Vec<bool>,
}

/// Composites tetrahedra ray by ray; keeps its memory between frames.
#[derive(Default)]
pub struct RayCompositor {
    vertices: Vec<RayVertex>,
    fronts: Fronts,
    instruction_set: Option<InstructionSet>,
}

impl RayCompositor {
    /// Draws with the kernels of `set` where the processor has it; the picture is the same.
    pub fn set_instruction_set(&mut self, set: Option<InstructionSet>) {
        self.instruction_set = set;
    }

    /// Draws one frame of tetrahedra with their `mates`; none where a vertex lies outside the near and the far plane.
    ///
    /// Where cells overlap their order is not that of the mesh: [`Counts::violations`] says how many rays found that, and each tile in
    /// which one did has to be drawn again by what checks the order of fragments.
    ///
    /// # Panics
    /// If the mates are those of another mesh.
    pub fn draw<O: Optics>(
        &mut self,
        frame: &Frame,
        mates: &Mates,
        optics: &O,
        profile: &mut Profile,
    ) -> Option<FollowedRays> {
        assert_eq!(mates.of_face.len(), 4 * frame.dataset.tets.len(), "mates are those of the mesh");
        let start = Instant::now();
        let is_within = self.project(frame);
        profile.add("project", start.elapsed(), frame.vertices.len() as u64 * 32);
        if !is_within {
            return None;
        }
        let start = Instant::now();
        let (view, grid) = (frame.view, TileGrid::new(frame.view));
        self.fronts.fill(frame.dataset, mates, &self.vertices, &grid);
        profile.add("entrances", start.elapsed(), mates.exterior.len() as u64 * 80);

        let start = Instant::now();
        let [width, height] = view.region.size_px();
        let mut image = Image::filled(width, height, optics.pixel(O::CLEAR));
        let mesh = RayMesh {
            frame,
            vertices: &self.vertices,
            mates: &mates.of_face,
            fronts: &self.fronts,
            cell_values: frame.cell_values(),
            intervals: frame.intervals(),
        };
        let kernels = Kernels::new(self.instruction_set);
        let tiles = Mutex::new(TileSource::new(view.region, &grid, &grid.rows, &mut image.pixels, &mut []));
        let next = || lock(&tiles).next().filter(|_| !frame.control.is_cancelled());
        let follow = |_| {
            let (mut tile, mut out_of_order, mut violations) = (RayTile::default(), Vec::new(), 0);
            while let Some(LentTile { tile: number, first, rows, .. }) = next() {
                let origin_px = grid.origin_px(number);
                tile.entrances.find(mesh.fronts, mesh.vertices, (number, origin_px), view.is_perspective);
                frame.control.tell(number as f64 / grid.len() as f64);
                if tile.entrances.is_empty() {
                    continue;
                }
                let _span = tracing::trace_span!("rays", tile = number).entered();
                kernels.rays(&mut tile, &mesh, optics, origin_px);
                if tile.violations > 0 {
                    out_of_order.push(number);
                    violations += tile.violations;
                }
                for (y, row) in rows.into_iter().enumerate() {
                    for (x, pixel) in row.iter_mut().enumerate() {
                        *pixel = optics.pixel(tile.contributions[place_of(first[0] + x, first[1] + y)]);
                    }
                }
            }
            (out_of_order, violations)
        };
        let threads = (0..rayon::current_num_threads()).into_par_iter().with_max_len(1);
        let followed: Vec<(Vec<usize>, u64)> = threads.map(follow).collect();
        drop(tiles);
        profile.add("rays", start.elapsed(), 0);
        let violations = followed.iter().map(|(_, violations)| violations).sum();
        let mut is_out_of_order = vec![false; grid.len()];
        for &tile in followed.iter().flat_map(|(tiles, _)| tiles) {
            is_out_of_order[tile] = true;
        }
        let counts = Counts { drawn: frame.dataset.tets.len() as u64, violations, ..Counts::default() };
        Some(FollowedRays { image, counts, is_out_of_order })
    }

    /// Projects the vertices; whether all lie between the near and the far plane.
    fn project(&mut self, frame: &Frame) -> bool {
        let _span = tracing::trace_span!("project").entered();
        let (view, projection) = (frame.view, frame.view.projection());
        self.vertices.resize(frame.vertices.len(), RayVertex::zeroed());
        let project = |(to, from): (&mut RayVertex, &SceneVertex)| {
            let p = projection.project(Vec3::from_array(from.position));
            let (depth_weight, scalar_weight) =
                if view.is_perspective { (1.0 / p.z, from.scalar / p.z) } else { (p.z, from.scalar) };
            *to = RayVertex { x: p.x, y: p.y, depth_weight, scalar_weight };
            p.z >= view.near && p.z <= view.far
        };
        self.vertices
            .par_iter_mut()
            .zip(frame.vertices)
            .with_min_len(1 << 14)
            .map(project)
            .reduce(|| true, |a, b| a & b)
    }
}
