//! Hexahedra by the case of their projection, through the library's stages.

use std::collections::BTreeMap;

use cellfan::cells::HEXAHEDRON;
use cellfan::columns::Dataset;
use cellfan::stages::classify::polyhedra::{Placed, Projection, Projections};
use cellfan::stages::fans::polyhedra::{CellFans, ProjectedCorner};
use cellfan::stages::{ScreenVertex, View};
use glam::Vec2;
use serde::Serialize;

/// The fate of each hexahedron of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub(super) struct Counts {
    pub(super) cells: u64,
    /// Cells of which corners coincide.
    pub(super) degenerate: u64,
    /// Cells that are hidden or have no volume.
    pub(super) absent: u64,
    pub(super) edge_on: u64,
    /// Cells to be drawn as tetrahedra.
    pub(super) split: u64,
    by_case: BTreeMap<&'static str, u64>,
}

impl Counts {
    pub(super) fn whole(&self) -> u64 {
        self.by_case.values().sum()
    }

    pub(super) fn of_case(&self, name: &str) -> u64 {
        self.by_case.get(name).copied().unwrap_or(0)
    }

    /// All cells that have a fate.
    pub(super) fn accounted(&self) -> u64 {
        self.whole() + self.absent + self.edge_on + self.split
    }
}

/// The projected corners of a mesh's hexahedra.
pub(in crate::cli::bench) struct Classified {
    table: &'static Projections,
    pub(in crate::cli::bench) corners: Vec<[ProjectedCorner; 8]>,
    cells: u64,
    absent: u64,
    degenerate: u64,
}

impl Classified {
    /// Gathers the corners of all hexahedra that have a volume; none where the library has no table for them.
    pub(in crate::cli::bench) fn new(dataset: &Dataset, view: &View, screen: &[ScreenVertex]) -> Option<Self> {
        let hexahedra = dataset.hexahedra.view();
        let present = (0..hexahedra.len()).filter(|&cell| !hexahedra.shape(cell).is_absent());
        let corner = |v: u32| {
            let seen = screen[v as usize];
            let v = view.inverse_depth(seen.depth);
            let q = if view.is_perspective { seen.scalar * v } else { seen.scalar };
            ProjectedCorner { position_px: seen.xy(), vq: Vec2::new(v, q) }
        };
        let corners = present.map(|cell| hexahedra.get(cell).map(corner)).collect();
        let coincide = |cell: &usize| {
            let mut at = hexahedra.get(*cell).map(|v| dataset.positions[v as usize].map(f32::to_bits));
            at.sort_unstable();
            at.windows(2).any(|two| two[0] == two[1])
        };
        Some(Self {
            table: Projections::of(&HEXAHEDRON)?,
            corners,
            cells: hexahedra.len() as u64,
            absent: dataset.hexahedra.absent() as u64,
            degenerate: (0..hexahedra.len()).filter(coincide).count() as u64,
        })
    }

    /// The projection of one cell.
    #[inline]
    pub(in crate::cli::bench) fn classify(&self, corners: &[ProjectedCorner; 8]) -> Projection {
        // Shapes are turned when they are read: a cell that is positive in space is so on the picture.
        self.table.classify(&corners.map(|corner| corner.position_px), true)
    }

    /// Each cell's fate.
    pub(super) fn counts(&self) -> Counts {
        let Self { cells, degenerate, absent, .. } = *self;
        let mut counts = Counts { cells, degenerate, absent, ..Counts::default() };
        for corners in &self.corners {
            match self.classify(corners) {
                Projection::Whole(placed) => *counts.by_case.entry(placed.case.name).or_default() += 1,
                Projection::EdgeOn => counts.edge_on += 1,
                Projection::Split => counts.split += 1,
            }
        }
        counts
    }

    /// The cells that have a case.
    pub(in crate::cli::bench) fn whole(&self) -> impl Iterator<Item = (&[ProjectedCorner; 8], Placed)> {
        self.corners.iter().filter_map(|corners| match self.classify(corners) {
            Projection::Whole(placed) => Some((corners, placed)),
            Projection::EdgeOn | Projection::Split => None,
        })
    }

    /// The area of all triangles over half the area of all projected faces of whole cells: 1.
    pub(in crate::cli::bench) fn covered_ratio(&self) -> f64 {
        let area = |polygon: &[Vec2]| {
            let from = |p: Vec2| (p - polygon[0]).as_dvec2();
            0.5 * polygon[1..].windows(2).map(|side| from(side[0]).perp_dot(from(side[1]))).sum::<f64>().abs()
        };
        let (mut of_fans, mut of_faces) = (0.0, 0.0);
        for (corners, placed) in self.whole() {
            let fans = CellFans::new(&placed, corners, 0);
            let at = |vertex: u8| Vec2::from_array(fans.vertices[usize::from(vertex)].position_px);
            of_fans += fans.triangles.iter().map(|triangle| area(&triangle.map(at))).sum::<f64>();
            let face = |face: &&[u8]| area(&[0, 1, 2, 3].map(|i: usize| corners[usize::from(face[i])].position_px));
            of_faces += HEXAHEDRON.faces.iter().map(face).sum::<f64>();
        }
        2.0 * of_fans / of_faces
    }
}
