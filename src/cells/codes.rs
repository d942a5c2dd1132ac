//! VTK's cell codes: which kind a code means, by which corners it is drawn, and which codes are left out.

use super::{CellKind, HEXAGONAL_PRISM, HEXAHEDRON, PENTAGONAL_PRISM, PYRAMID, TETRAHEDRON, VOXEL, WEDGE};

/// What a VTK cell code means here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellClass {
    /// A cell with a volume; the first corners of its nodes are those of `kind`.
    Volume {
        /// The linear kind it is drawn as.
        kind: &'static CellKind,
        /// How many nodes a cell of this code has.
        nodes: Nodes,
    },
    /// A cell with any faces, which its file lists.
    Polyhedron,
    /// Points, lines and faces: no volume by their kind.
    LowerDimensional,
    /// A kind that is not drawn, by its name.
    Unsupported(&'static str),
}

/// How many nodes a cell has in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nodes {
    /// Its corners and nothing else.
    Linear,
    /// This many, corners first: quadratic cells.
    Quadratic(usize),
    /// As many as its order asks for, corners first: Lagrange and Bézier cells.
    AnyOrder,
}

impl Nodes {
    /// Whether a cell of `kind` may have `count` nodes.
    pub fn accept(self, kind: &CellKind, count: usize) -> bool {
        match self {
            Self::Linear => count == kind.corners,
            Self::Quadratic(nodes) => count == nodes,
            Self::AnyOrder => count >= kind.corners,
        }
    }

    /// How many nodes a cell of `kind` has at least.
    pub fn least(self, kind: &CellKind) -> usize {
        match self {
            Self::Quadratic(nodes) => nodes,
            Self::Linear | Self::AnyOrder => kind.corners,
        }
    }
}

/// What VTK cell code `code` means.
///
/// ```
/// # use cellfan::cells::{CellClass, Nodes, TETRAHEDRON, classify};
/// assert_eq!(classify(24), CellClass::Volume { kind: &TETRAHEDRON, nodes: Nodes::Quadratic(10) });
/// assert_eq!(classify(9), CellClass::LowerDimensional);
/// assert_eq!(classify(42), CellClass::Polyhedron);
/// assert_eq!(classify(41), CellClass::Unsupported("convex point set"));
/// ```
pub fn classify(code: u8) -> CellClass {
    let linear = |kind| CellClass::Volume { kind, nodes: Nodes::Linear };
    let quadratic = |kind, nodes| CellClass::Volume { kind, nodes: Nodes::Quadratic(nodes) };
    let any_order = |kind| CellClass::Volume { kind, nodes: Nodes::AnyOrder };
    match code {
        // Vertices, lines, polygons; 21 to 36 their quadratic, 51 to 56 their parametric, 60 to 63, 68 to 70 and 75 to
        // 77 their higher-order relatives.
        0..=9 | 21..=23 | 28 | 30 | 34..=36 | 51..=56 | 60..=63 | 68..=70 | 75..=77 => CellClass::LowerDimensional,
        10 => linear(&TETRAHEDRON),
        11 => linear(&VOXEL),
        12 => linear(&HEXAHEDRON),
        13 => linear(&WEDGE),
        14 => linear(&PYRAMID),
        15 => linear(&PENTAGONAL_PRISM),
        16 => linear(&HEXAGONAL_PRISM),
        24 => quadratic(&TETRAHEDRON, 10),
        25 => quadratic(&HEXAHEDRON, 20),
        26 => quadratic(&WEDGE, 15),
        27 => quadratic(&PYRAMID, 13),
        29 => quadratic(&HEXAHEDRON, 27),
        31 => quadratic(&WEDGE, 12),
        32 => quadratic(&WEDGE, 18),
        33 => quadratic(&HEXAHEDRON, 24),
        37 => quadratic(&PYRAMID, 19),
        41 => CellClass::Unsupported("convex point set"),
        42 => CellClass::Polyhedron,
        64 | 71 | 78 => any_order(&TETRAHEDRON),
        65 | 73 | 80 => any_order(&WEDGE),
        66 | 74 | 81 => any_order(&PYRAMID),
        67 | 72 | 79 => any_order(&HEXAHEDRON),
        _ => CellClass::Unsupported("unknown kind"),
    }
}
