//! From structured blocks to a [`Dataset`]: points and cells keep their order, and no cell stores its corners.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{Points, check_arrays, describe};
use crate::columns::canonical_from_point;
use crate::columns::placement::Placement;
use crate::columns::{
    Array, BitColumn, Block, Bounds, CellCounts, Dataset, HexShape, Hexahedra, HexahedraView, Polyhedra,
    StructuredBlock,
};
use crate::error::{Error, Result};

/// Structured blocks in file order: what a reader hands over whose cells follow from the order of the points.
#[derive(Clone, Debug)]
pub struct StructuredCells {
    /// Points of each block along i, j and k, two at least.
    pub dims: Vec<[usize; 3]>,
    /// The points of all blocks, in each i fastest, then j.
    pub points: Points,
    /// Whether each cell is left out; cells stand as the points do.
    pub hidden: BitColumn,
    /// Arrays over all points and cells.
    pub arrays: Vec<Array>,
    /// What is left out; `inverted` and `degenerate` are counted here.
    pub counts: CellCounts,
}

impl Dataset {
    /// Checks `mesh`; its columns stay in their order.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NonFinitePosition`], [`Error::TooLarge`], and [`Error::NoCells`] where no cell has a
    /// volume.
    pub fn from_structured(mesh: StructuredCells) -> Result<Self> {
        let StructuredCells { dims, points, hidden, arrays, mut counts } = mesh;
        let blocks = StructuredBlock::sequence(dims, points.len(), hidden.len())?;
        check_arrays(points.len() as u64, &arrays, counts.in_file)?;
        let shapes: Vec<HexShape> = (0..hidden.len())
            .map(|cell| if hidden.get(cell) { HexShape::ABSENT } else { HexShape::default() })
            .collect();
        // Corners without regard to which way they run.
        let all = Hexahedra::structured(blocks.clone(), shapes.into());
        let cells = all.view();
        let present = || (0..cells.len()).into_par_iter().filter(|&cell| !cells.shape(cell).is_absent());

        let bad = present().flat_map_iter(|cell| cells.get(cell)).find_first(|&v| !points.get(v as usize).is_finite());
        if let Some(point) = bad {
            let position = points.get(point as usize).to_array();
            return Err(Error::NonFinitePosition { point: point.into(), position });
        }
        let (low, high) = present()
            .flat_map_iter(|cell| cells.get(cell))
            .map(|v| points.get(v as usize))
            .fold(|| (DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
            .reduce(|| (DVec3::INFINITY, DVec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let placement = Placement::new(&points, low, high);
        // A point of no cell may stand anywhere.
        let narrow = |v: usize| Some(points.get(v)).filter(|p| p.is_finite()).map(|p| placement.position(p));
        let is_too_far = |&v: &u32| narrow(v as usize).is_some_and(|p| !p.is_finite());
        if let Some(point) = present().flat_map_iter(|cell| cells.get(cell)).find_first(is_too_far) {
            let position = points.get(point as usize).to_array();
            return Err(Error::NonFinitePosition { point: point.into(), position });
        }
        let position = |v: usize| narrow(v).filter(|p| p.is_finite()).unwrap_or(Vec3::ZERO);
        let positions: Vec<[f32; 3]> = (0..points.len()).into_par_iter().map(|v| position(v).to_array()).collect();

        let shapes = shapes_of(&cells, &positions, &canonical_from_point(&points));
        let hexahedra = Hexahedra::structured(blocks, shapes.into());
        let is =
            |of: fn(HexShape) -> bool| (0..cells.len()).filter(|&cell| of(hexahedra.view().shape(cell))).count() as u64;
        let left_out = is(HexShape::is_absent);
        counts.inverted = is(HexShape::is_mirrored);
        counts.degenerate = left_out - (0..hidden.len()).filter(|&cell| hidden.get(cell)).count() as u64;
        if left_out == hexahedra.len() as u64 {
            return Err(Error::NoCells { found: describe(&counts) });
        }
        let blocks = draw_blocks(&hexahedra.view(), &positions);
        let bounds = blocks.iter().fold(Bounds::EMPTY, |all, block| all.union(block.bounds));
        Ok(Self {
            origin: placement.origin,
            positions: positions.into(),
            tets: Vec::new().into(),
            hexahedra,
            polyhedra: Polyhedra::none(),
            positive: BitColumn::from_iter([]),
            file_from_vertex: None,
            file_from_cell: None,
            arrays,
            array_ranges: Vec::new(),
            adjacency: None,
            blocks,
            bounds,
            counts,
            read_bytes: 0,
            backing: None,
        })
    }
}

/// The shape of each cell that is not hidden.
fn shapes_of(cells: &HexahedraView<'_>, positions: &[[f32; 3]], canonical: &[u32]) -> Vec<HexShape> {
    let shape = |cell: usize| {
        if cells.shape(cell).is_absent() {
            return HexShape::ABSENT;
        }
        let corners = cells.get(cell);
        let p = corners.map(|v| Vec3::from_array(positions[v as usize]));
        HexShape::new(p, corners.map(|v| canonical[v as usize]))
    };
    (0..cells.len()).into_par_iter().map(shape).collect()
}

/// Runs of cells with the boxes around those that are drawn.
fn draw_blocks(cells: &HexahedraView<'_>, positions: &[[f32; 3]]) -> Vec<Block> {
    let block = |run: Range<usize>| {
        let corners = run.clone().filter(|&cell| !cells.shape(cell).is_absent()).flat_map(|cell| cells.get(cell));
        let bounds = corners.fold(Bounds::EMPTY, |b, v| b.include(Vec3::from_array(positions[v as usize])));
        Block { cells: run, bounds }
    };
    Dataset::runs([0, cells.len(), 0]).collect::<Vec<_>>().into_par_iter().map(block).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(dims: [usize; 3], first: f32) -> Vec<[f32; 3]> {
        let [ni, nj, nk] = dims;
        let ijk = (0..nk).flat_map(|k| (0..nj).flat_map(move |j| (0..ni).map(move |i| [i, j, k])));
        ijk.map(|[i, j, k]| [first + i as f32, j as f32, k as f32]).collect()
    }

    fn two_blocks(hidden: impl Fn(usize) -> bool) -> StructuredCells {
        let dims = vec![[3, 4, 2], [2, 4, 3]];
        let points = Points::F32([grid(dims[0], 0.0), grid(dims[1], 2.0)].concat());
        let counts = CellCounts { in_file: 12, ..CellCounts::default() };
        StructuredCells { dims, points, hidden: (0..12).map(hidden).collect(), arrays: Vec::new(), counts }
    }

    #[test]
    fn corners_follow_from_the_number_of_a_cell() {
        let dataset = Dataset::from_structured(two_blocks(|_| false)).unwrap();
        assert_eq!((dataset.cells(), dataset.hexahedra.owned_bytes()), (12, 12 * 2 + 2 * 20));
        for cell in 0..12 {
            assert!((dataset.volume_world(cell) - 1.0).abs() < 1e-6);
        }
        // The second block's second cell lies one step up in j.
        let low = Vec3::from_array(dataset.positions[dataset.corners(7)[0] as usize]);
        assert!(low.abs_diff_eq(Vec3::new(2.0, 1.0, 0.0), 1e-6));
    }

    #[test]
    fn hidden_and_flat_cells_stay_numbered_and_are_not_drawn() {
        let mut mesh = two_blocks(|cell| cell == 2);
        // Cell 7 loses its height.
        let Points::F32(points) = &mut mesh.points else { panic!("single precision") };
        for (i, point) in points.iter_mut().enumerate().skip(24) {
            if (24..32).contains(&i) {
                point[2] = 1.0;
            }
        }
        let dataset = Dataset::from_structured(mesh).unwrap();
        assert_eq!((dataset.cells(), dataset.counts.degenerate), (12, 3), "three cells of the lower layer");
        assert!([2, 7].iter().all(|&cell| dataset.volume_world(cell) < 1e-12));
        assert_eq!(dataset.cells_drawn_in(0), 12 - 4);
    }

    #[test]
    fn lengths_and_positions_are_checked() {
        let mut mesh = two_blocks(|_| false);
        mesh.dims[0][0] = 4;
        assert!(matches!(Dataset::from_structured(mesh), Err(Error::LengthMismatch { len: 48, expected: 56, .. })));
        let mut mesh = two_blocks(|_| false);
        mesh.dims = vec![[48, 1, 1]];
        assert!(matches!(Dataset::from_structured(mesh), Err(Error::LengthMismatch { len: 1, expected: 2, .. })));
        let mut mesh = two_blocks(|_| false);
        let Points::F32(points) = &mut mesh.points else { panic!("single precision") };
        points[3][1] = f32::NAN;
        assert!(matches!(Dataset::from_structured(mesh), Err(Error::NonFinitePosition { point: 3, .. })));
        assert!(matches!(Dataset::from_structured(two_blocks(|_| true)), Err(Error::NoCells { .. })));
    }
}
