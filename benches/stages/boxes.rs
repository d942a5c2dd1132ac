//! Hexahedra that benchmarks share: boxes of a grid with moved corners.

use cellfan::Camera;
use cellfan::columns::{CellCounts, CellMesh, Points, StructuredCells};
use cellfan::stages::fans::polyhedra::ProjectedCorner;
use glam::{DVec2, DVec3, UVec3, Vec2};

use crate::seen::SIDE_PX;

/// Boxes of a grid with moved corners, seen in perspective: the projected corners of each, and those of a field on them.
pub(crate) struct Boxes {
    pub(crate) xy: Vec<[Vec2; 8]>,
    pub(crate) corners: Vec<[ProjectedCorner; 8]>,
}

impl Boxes {
    pub(crate) const SIDE: u32 = 48;

    /// Where corner `at` stands in the unit cube; each coordinate is moved by up to `jitter` boxes, by a hash.
    fn position(at: UVec3, jitter: f64) -> DVec3 {
        let hash = (at.x * 73 + at.y * 179 + at.z * 283).wrapping_mul(0x9e37_79b9);
        let moved = [0, 10, 20].map(|shift| f64::from(hash >> shift & 0x3ff) / 1023.0 - 0.5);
        (at.as_dvec3() + 2.0 * jitter * DVec3::from_array(moved)) / f64::from(Self::SIDE)
    }

    pub(crate) fn new() -> Self {
        let camera = Camera::looking_at(DVec3::new(3.0, -2.2, 1.6), DVec3::splat(0.5), SIDE_PX, SIDE_PX);
        let frame = camera.frame().expect("the camera is valid");
        let vertex = |at: UVec3| {
            let position = Self::position(at, 0.1);
            let v = 1.0 / frame.depth(position);
            ProjectedCorner {
                position_px: frame.pixel(position).as_vec2(),
                vq: DVec2::new(v, position.x * v).as_vec2(),
            }
        };
        let around = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let cell = |i: u32| UVec3::new(i % Self::SIDE, i / Self::SIDE % Self::SIDE, i / Self::SIDE.pow(2));
        let corners = |i| around.map(|corner| vertex(cell(i) + UVec3::from_array(corner)));
        let corners: Vec<_> = (0..Self::SIDE.pow(3)).map(corners).collect();
        Self { xy: corners.iter().map(|of| of.map(|corner| corner.position_px)).collect(), corners }
    }
}

/// The boxes as one structured block.
pub(crate) fn block_of_boxes() -> StructuredCells {
    let side = Boxes::SIDE + 1;
    let at = |i: u32| UVec3::new(i % side, i / side % side, i / side.pow(2));
    let cells = u64::from(Boxes::SIDE.pow(3));
    StructuredCells {
        dims: vec![[side as usize; 3]],
        points: Points::F64((0..side.pow(3)).map(|i| Boxes::position(at(i), 0.02).to_array()).collect()),
        hidden: (0..cells).map(|_| false).collect(),
        arrays: Vec::new(),
        counts: CellCounts { in_file: cells, ..CellCounts::default() },
    }
}

/// The same, each box with its corners.
pub(crate) fn listed_boxes(block: &StructuredCells) -> CellMesh {
    let (side, cells) = (Boxes::SIDE, Boxes::SIDE.pow(3));
    let corners = |cell: u32| {
        let row = side + 1;
        let first = cell % side + row * (cell / side % side) + row * row * (cell / side.pow(2));
        [0, 1, row + 1, row].map(|step| first + step)
    };
    let hexahedron = |cell: u32| {
        let [a, b, c, d] = corners(cell);
        let above = |v: u32| v + (side + 1).pow(2);
        [a, b, c, d, above(a), above(b), above(c), above(d)]
    };
    CellMesh {
        points: block.points.clone(),
        tets: Vec::new().into(),
        file_from_tet: Vec::new().into(),
        hexahedra: (0..cells).map(hexahedron).collect(),
        file_from_hexahedron: (0..cells).collect(),
        arrays: Vec::new(),
        counts: block.counts,
        ..CellMesh::empty()
    }
}
