//! A mesh in one view, projected: what the stages read.

use cellfan::columns::BlockView;
use cellfan::generate::Kind;
use cellfan::stages::project::{project, scene_vertices};
use cellfan::stages::{SceneVertex, ScreenVertex, View};
use cellfan::{Camera, Dataset, Field, Result, TransferFunction};

use crate::cli::bench::frames::camera;
use crate::cli::bench::subject::Subject;

/// The share of the cells that the transfer function leaves out.
const CULLED: f64 = 0.3;

pub(super) struct Seen {
    pub(super) dataset: Dataset,
    pub(super) field: Field,
    pub(super) transfer: TransferFunction,
    pub(super) camera: Camera,
    pub(super) view: View,
    pub(super) vertices: Vec<SceneVertex>,
    pub(super) screen: Vec<ScreenVertex>,
}

impl Seen {
    pub(super) fn new(kind: Kind, cells: u64, side: u32) -> Result<Self> {
        let subject = Subject::generated(kind, cells)?;
        let transfer = subject.ramp(CULLED)?;
        let Subject { dataset, field, .. } = subject;
        let camera = camera(&dataset, [side; 2], 0.0);
        let view = View::new(&camera, &dataset)?;
        let vertices = scene_vertices(&dataset, &field);
        let mut screen = Vec::new();
        project(&view, &vertices, &mut screen);
        Ok(Self { dataset, field, transfer, camera, view, vertices, screen })
    }

    /// The same from an eye turned by `degrees`.
    pub(super) fn turned(&self, degrees: f64) -> Result<View> {
        View::new(&self.camera.orbited(degrees), &self.dataset)
    }

    pub(super) fn cells(&self) -> u64 {
        self.dataset.tets.len() as u64
    }

    pub(super) fn block(&self, block: usize) -> BlockView<'_> {
        self.dataset.block(block)
    }

    /// The numbers of the cells of any block; the last has fewer.
    pub(super) fn cells_of_block() -> Vec<u32> {
        (0..Dataset::BLOCK_CELLS as u32).collect()
    }

    /// Memory of its own for each block, to be kept between runs.
    pub(super) fn for_each_block<T: Default>(&self) -> Vec<T> {
        (0..self.dataset.blocks.len()).map(|_| T::default()).collect()
    }
}
