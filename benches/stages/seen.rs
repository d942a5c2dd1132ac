//! A mesh in one view, projected: what most stages read.

use cellfan::columns::BlockView;
use cellfan::generate::Kind;
use cellfan::stages::project::{project, scene_vertices};
use cellfan::stages::{SceneVertex, ScreenVertex, View};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Throughput};

use crate::support::Mesh;

const CELLS: u64 = 100_000;
pub(crate) const SIDE_PX: u32 = 512;

/// A mesh in one view, projected.
pub(crate) struct Seen {
    pub(crate) mesh: Mesh,
    pub(crate) view: View,
    pub(crate) vertices: Vec<SceneVertex>,
    pub(crate) screen: Vec<ScreenVertex>,
}

impl Seen {
    pub(crate) fn new(kind: Kind) -> Self {
        let mesh = Mesh::generate(kind, CELLS);
        let view = View::new(&mesh.camera(0.0, SIDE_PX), &mesh.dataset).expect("the camera is valid");
        let vertices = scene_vertices(&mesh.dataset, &mesh.field);
        let mut screen = Vec::new();
        project(&view, &vertices, &mut screen);
        Self { mesh, view, vertices, screen }
    }

    pub(crate) fn cells(&self) -> u64 {
        self.mesh.dataset.tets.len() as u64
    }

    pub(crate) fn blocks(&self) -> impl Iterator<Item = BlockView<'_>> {
        (0..self.mesh.dataset.blocks.len()).map(|block| self.mesh.dataset.block(block))
    }

    /// Calls `f` with every block and the list of its cells.
    pub(crate) fn each_block(&self, cell_from_visible: &[u32], mut f: impl FnMut(&BlockView, &[u32])) {
        for block in self.blocks() {
            f(&block, &cell_from_visible[..block.len()]);
        }
    }
}

pub(crate) fn all_cells() -> Vec<u32> {
    (0..cellfan::Dataset::BLOCK_CELLS as u32).collect()
}

pub(crate) fn throughput(group: &mut BenchmarkGroup<WallTime>, elements: u64, bytes_each: usize) {
    group.throughput(Throughput::ElementsAndBytes { elements, bytes: elements * bytes_each as u64 });
}

/// A pool of one thread, for stages that spread over all there are.
pub(crate) fn rayon_of_one() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had")
}
