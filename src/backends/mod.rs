//! Backends: composite cells into a picture.
//!
//! In: a [`Frame`], the scene's columns and one view of them. Out: an [`Image`](crate::image::Image) and what was counted.
//! To add one: a folder that runs the stages it needs and fills the picture, and its line in `render`.

pub mod cpu;
mod draw_order;
#[cfg(feature = "gpu")]
pub mod gpu;
mod opaque;
mod tiles;

pub use opaque::{Opaque, OpaquePicture};
pub(crate) use tiles::TileGrid;

use std::sync::Arc;

use self::cpu::Mates;
use crate::columns::{Association, Dataset, Field};
use crate::control::Control;
use crate::optics::{BandPiece, CullTable, Intervals, Pieces};
use crate::stages::classify::ClassCounts;
use crate::stages::fans::Faces;
use crate::stages::sort::KeyMaker;
use crate::stages::{CubesInView, SceneVertex, View};

/// Everything a backend reads for one frame.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// The mesh.
    pub dataset: &'a Dataset,
    /// Cubes of a volume that are drawn instead of the mesh's cells, farthest first; the mesh is then one without cells in the
    /// place of the volume, and says where and how large it is.
    pub cubes: Option<CubesInView<'a>>,
    /// The scalar field.
    pub field: &'a Field,
    /// Position and scalar of each vertex, in scene units.
    pub vertices: &'a [SceneVertex],
    /// The transfer function over the field's stored values.
    pub pieces: &'a Pieces,
    /// The bands of this pass over the field's stored values, where they have extinctions of their own.
    pub bands: Option<&'a Pieces<BandPiece>>,
    /// What lies across each face, where rays are followed from cell to cell; the mesh is then one of tetrahedra.
    pub mates: Option<&'a Mates>,
    /// Which cells cannot show.
    pub cull_table: &'a CullTable,
    /// The camera.
    pub view: &'a View,
    /// What cells are sorted by; nothing where the optical model asks for no order.
    pub keys: KeyMaker<'a>,
    /// Whether fragments found out of order are put right; otherwise they are only counted.
    pub is_exact: bool,
    /// The tiles of the region to draw, one flag each, row by row; `None` for all. For the tile compositor.
    pub tiles: Option<&'a [bool]>,
    /// How rasterisers draw faces of four corners.
    pub faces: Faces,
    /// A ray ends below this transmittance; 0 never ends one.
    pub stop_transmittance: f32,
    /// What scene and frame may hold, mapped files aside; `None` for any amount.
    pub memory_bytes: Option<u64>,
    /// Whether somebody still wants the frame; who is told how far it is. Where the end is asked for, what was drawn is of no use.
    pub control: &'a Control,
    /// Where scalars may change and the view stay as it is; the tile compositor then keeps the order of cells.
    pub still: Option<Still<'a>>,
    /// Opaque geometry, which cuts every cell; a backend's picture does not show it where the caller puts it behind.
    pub opaque: Option<&'a Opaque>,
}

/// Cells whose order is kept between frames that see them from the same place.
#[derive(Clone, Copy, Debug)]
pub struct Still<'a> {
    /// The same for the same cells with their vertices at the same places.
    pub shape: &'a Arc<()>,
    /// Whether scalars are known to change: cells that do not show now may do so in the next frame.
    pub is_live: bool,
}

/// Bytes of memory that a scene takes; columns that are used in place count nothing.
pub fn scene_bytes(dataset: &Dataset, field: &Field, vertices: &[SceneVertex]) -> u64 {
    let field = size_of_val(&field.values[..]) + size_of_val(&field.block_ranges[..]);
    dataset.owned_bytes() + (field + size_of_val(vertices)) as u64
}

impl<'a> Frame<'a> {
    /// The intervals of stored values within which everything is linear.
    pub fn intervals(&self) -> &'a Intervals {
        self.bands.map_or(self.pieces, |bands| bands)
    }

    /// The values of cell data; `None` for point data, which the vertices carry.
    pub fn cell_values(&self) -> Option<&'a [f32]> {
        (self.field.association == Association::Cell).then_some(&self.field.values[..])
    }

    /// Opaque geometry as it shows, where there is any: rays end on it.
    pub(crate) fn limits(&self) -> Option<&'a OpaquePicture> {
        self.opaque.map(|opaque| opaque.picture(self.view))
    }
}

/// What a backend counted while it drew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Cells that were composited.
    pub drawn: u64,
    /// Cells without extinction on their value interval.
    pub culled_transparent: u64,
    /// Cells outside the view, or between pixel centres.
    pub culled_outside: u64,
    /// Cells with a value that is not finite.
    pub invalid: u64,
    /// Cells by class, where classified.
    pub by_class: ClassCounts,
    /// Triangles rasterised.
    pub triangles: u64,
    /// Fragments that met their pixel after one that lies behind them.
    pub violations: u64,
    /// Tiles parts of which were redone with their fragments sorted per pixel.
    pub tiles_redone: u64,
    /// Bytes of opaque geometry that were sent to a GPU.
    pub uploaded_bytes: u64,
}

impl Counts {
    /// Counts fans by class, and their triangles.
    fn add_classes(&mut self, by_class: ClassCounts) {
        self.by_class += by_class;
        self.triangles += by_class.triangles();
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.drawn += other.drawn;
        self.culled_transparent += other.culled_transparent;
        self.culled_outside += other.culled_outside;
        self.invalid += other.invalid;
        self.by_class += other.by_class;
        self.triangles += other.triangles;
        self.violations += other.violations;
        self.tiles_redone += other.tiles_redone;
        self.uploaded_bytes += other.uploaded_bytes;
    }
}
