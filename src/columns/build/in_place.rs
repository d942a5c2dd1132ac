//! From cells as another program holds them to a [`Dataset`]: checked, and left where they are.
//!
//! In: columns in the caller's order. Out: a dataset whose vertices are the caller's points. Beside the columns that are lent it holds
//! what a view is drawn with: an orientation bit a tetrahedron, two bytes a hexahedron, and four bytes a tetrahedron where the
//! caller's order scatters neighbours over memory or some have no volume.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::describe;
use crate::columns::placement::{Placement, orientation_of};
use crate::columns::{
    BitColumn, Block, Bounds, CellCounts, Column, Dataset, HexCorners, HexShape, Hexahedra, Polyhedra, Positions, Tets,
    canonical_from_vertex,
};
use crate::error::{Error, Result};

/// Cells in the caller's order.
#[derive(Clone, Debug)]
pub(crate) struct CellsInPlace {
    /// Four points each, in any order.
    pub(crate) tets: Column<[u32; 4]>,
    /// The caller's cell of each tetrahedron; none where they are its cells.
    pub(crate) file_from_tet: Option<Column<u32>>,
    /// Eight points each in VTK's order, in either orientation, or blocks of them.
    pub(crate) hexahedra: HexCorners,
    /// The caller's cell of each hexahedron; none where they are its cells.
    pub(crate) file_from_hexahedron: Option<Column<u32>>,
    /// What was left out; `inverted` and `degenerate` are counted here.
    pub(crate) counts: CellCounts,
}

/// Point coordinates, and themselves as a column where they may be drawn in place.
pub(crate) struct PositionsInPlace<'a> {
    pub(crate) read: Positions<'a>,
    pub(crate) lent: Option<Column<[f32; 3]>>,
}

/// A caller's order is kept unless its blocks of cells overlap so much: the sum of the volumes of their boxes, over that of the box around
/// all. Along a curve that fills space it is 1 to 3, in no order it is the number of blocks.
const SCATTERED: f64 = 8.0;

impl CellsInPlace {
    /// How many cells there are: tetrahedra and hexahedra.
    fn len(&self) -> [usize; 2] {
        let hexahedra = match &self.hexahedra {
            HexCorners::Listed(corners) => corners.len(),
            HexCorners::Structured(blocks) => blocks.iter().map(|block| block.cells() as usize).sum(),
        };
        [self.tets.len(), hexahedra]
    }

    /// Every corner is one of `points` points.
    pub(crate) fn check(&self, points: usize) -> Result<()> {
        let limit = u64::from(u32::MAX) - 1;
        for (column, len) in [("points", points as u64), ("cells", self.len().iter().sum::<usize>() as u64)] {
            if len > limit {
                return Err(Error::TooLarge { column, len, limit });
            }
        }
        check_corners(&self.tets, self.file_from_tet.as_deref(), points)?;
        match &self.hexahedra {
            HexCorners::Listed(corners) => check_corners(corners, self.file_from_hexahedron.as_deref(), points),
            HexCorners::Structured(_) => Ok(()),
        }
    }
}

fn check_corners<const N: usize>(cells: &[[u32; N]], file_from: Option<&[u32]>, points: usize) -> Result<()> {
    let is_bad = |cell: &[u32; N]| cell.iter().any(|&v| v as usize >= points);
    let Some(cell) = cells.par_iter().position_first(is_bad) else { return Ok(()) };
    let index = cells[cell].iter().copied().max().map_or(0, i64::from);
    let cell = file_from.map_or(cell as u64, |file_from| u64::from(file_from[cell]));
    Err(Error::IndexOutOfRange { column: "connectivity", cell, index, len: points as u64 })
}

impl Dataset {
    /// Cells whose corners were [checked](CellsInPlace::check), at `positions`; in the order of `before`, a dataset of the same cells at
    /// other places, if that holds them all.
    ///
    /// # Errors
    /// [`Error::NonFinitePosition`], [`Error::LengthMismatch`], and [`Error::NoCells`] where no cell has a volume.
    pub(crate) fn in_place(
        cells: &CellsInPlace,
        positions: PositionsInPlace<'_>,
        before: Option<&Self>,
    ) -> Result<Self> {
        let points = positions.read.len();
        let [_, all_hexahedra] = cells.len();
        let counts = cells.counts;
        let none = || Error::NoCells { found: describe(&counts) };
        if cells.len() == [0, 0] || points == 0 {
            return Err(none());
        }
        // Corners as they are read, shapes to come.
        let unshaped = vec![HexShape::default(); all_hexahedra].into();
        let unshaped = Hexahedra::in_file(cells.hexahedra.clone(), unshaped, 0, points)?;
        let rows = Tets::lent(cells.tets.clone(), None, points);
        let (positions, placement) = place(positions, &rows, &unshaped)?;
        let position = |v: u32| Vec3::from_array(positions[v as usize]);

        let [positive, flat] = orientations(&rows, position);
        let mut counts = cells.counts;
        counts.inverted = inverted(&cells.tets, &positive);
        let flat_tets = flat.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
        let kept = |row: usize| flat[row / 64] >> (row % 64) & 1 == 0;
        let order = match before {
            Some(before) if flat_tets == 0 && before.tets.len() == rows.len() => before.tets.row_from_cell().cloned(),
            _ => order(&rows, &placement, position, (flat_tets > 0).then_some(&kept)),
        };
        drop((flat, rows));
        let positive = match &order {
            Some(order) => {
                let of_row = |&row: &u32| positive[row as usize / 64] >> (row % 64) & 1 == 1;
                order.iter().map(of_row).collect()
            }
            None => BitColumn::from_words(positive.into(), cells.tets.len()).ok_or_else(none)?,
        };
        let tets = Tets::lent(cells.tets.clone(), order.clone(), points);

        let canonical = if all_hexahedra > 0 { canonical_from_vertex(&positions) } else { Vec::new() };
        let shape = |cell: usize| {
            let corners = unshaped.view().get(cell);
            HexShape::new(corners.map(position), corners.map(|v| canonical[v as usize]))
        };
        let shapes: Vec<HexShape> = (0..all_hexahedra).into_par_iter().map(shape).collect();
        drop(canonical);
        let is = |of: fn(&HexShape) -> bool| shapes.par_iter().filter(|shape| of(shape)).count();
        let absent = is(|shape| shape.is_absent());
        counts.inverted += is(|shape| shape.is_mirrored()) as u64;
        counts.degenerate = flat_tets + absent as u64;
        if tets.is_empty() && absent == all_hexahedra {
            return Err(Error::NoCells { found: describe(&counts) });
        }
        let hexahedra = Hexahedra::in_file(cells.hexahedra.clone(), shapes.into(), absent, points)?;
        let blocks = blocks(&tets, &hexahedra, position);
        let bounds = blocks.iter().fold(Bounds::EMPTY, |all, block| all.union(block.bounds));
        Ok(Self {
            origin: placement.origin,
            file_from_cell: file_from_cell(cells, order.as_ref()),
            positions,
            tets,
            hexahedra,
            polyhedra: Polyhedra::none(),
            positive,
            file_from_vertex: None,
            arrays: Vec::new(),
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

/// All positions relative to an origin near the cells: in place where they are lent and near the origin already, and else copied.
fn place(
    PositionsInPlace { read, lent }: PositionsInPlace<'_>,
    tets: &Tets,
    hexahedra: &Hexahedra,
) -> Result<(Column<[f32; 3]>, Placement)> {
    let nothing = || (DVec3::INFINITY, DVec3::NEG_INFINITY, true);
    let include = |(low, high, is_finite): (DVec3, DVec3, bool), v: u32| {
        let p = read.get(v as usize);
        (low.min(p), high.max(p), is_finite && p.is_finite())
    };
    let both = |a: (DVec3, DVec3, bool), b: (DVec3, DVec3, bool)| (a.0.min(b.0), a.1.max(b.1), a.2 && b.2);
    let (rows, whole) = (tets.view(), hexahedra.view());
    let of_tets = (0..tets.len()).into_par_iter();
    let of_tets = of_tets.fold(nothing, |all, tet| rows.get(tet).into_iter().fold(all, include));
    let of_hexahedra = (0..hexahedra.len()).into_par_iter();
    let of_hexahedra = of_hexahedra.fold(nothing, |all, hex| whole.get(hex).into_iter().fold(all, include));
    let (low, high, are_finite) = of_tets.chain(of_hexahedra).reduce(nothing, both);
    if !are_finite {
        let corners = (0..tets.len()).into_par_iter().flat_map_iter(|tet| rows.get(tet));
        let corners = corners.chain((0..hexahedra.len()).into_par_iter().flat_map_iter(|hex| whole.get(hex)));
        let bad = corners.find_first(|&v| !read.get(v as usize).is_finite());
        let point = bad.unwrap_or(0);
        return Err(Error::NonFinitePosition { point: point.into(), position: read.get(point as usize).to_array() });
    }
    let placement = Placement::of(read.is_single(), low, high);
    if let Some(lent) = lent.filter(|_| placement.origin == DVec3::ZERO) {
        return Ok((lent, placement));
    }
    // A point of no cell may stand anywhere.
    let position = |v: usize| Some(read.get(v)).filter(|p| p.is_finite()).map_or(Vec3::ZERO, |p| placement.position(p));
    let positions: Vec<[f32; 3]> = (0..read.len()).into_par_iter().map(|v| position(v).to_array()).collect();
    Ok((positions.into(), placement))
}

/// A bit for each row: whether its ascending vertices are positively oriented; whether it is flat.
fn orientations(rows: &Tets, position: impl Fn(u32) -> Vec3 + Sync) -> [Vec<u64>; 2] {
    let rows_of = |word: usize| (word * 64..rows.len().min(word * 64 + 64)).enumerate();
    let view = rows.view();
    let word = |word: usize| {
        rows_of(word).fold((0_u64, 0_u64), |(positive, flat), (bit, row)| {
            let sign = orientation_of(view.get(row).map(&position));
            (positive | u64::from(sign > 0) << bit, flat | u64::from(sign == 0) << bit)
        })
    };
    let (positive, flat) = (0..rows.len().div_ceil(64)).into_par_iter().map(word).unzip();
    [positive, flat]
}

/// Cells whose vertices, as the caller lists them, run the other way: an odd permutation turns the sign of ascending ones.
fn inverted(tets: &[[u32; 4]], positive: &[u64]) -> u64 {
    let is_odd = |[a, b, c, d]: [u32; 4]| (a > b) ^ (a > c) ^ (a > d) ^ (b > c) ^ (b > d) ^ (c > d);
    let is_inverted = |&row: &usize| is_odd(tets[row]) == (positive[row / 64] >> (row % 64) & 1 == 1);
    (0..tets.len()).into_par_iter().filter(is_inverted).count() as u64
}

/// The rows in the order in which they are drawn; none where that is the caller's, and all.
fn order(
    rows: &Tets,
    placement: &Placement,
    position: impl Fn(u32) -> Vec3 + Sync + Copy,
    kept: Option<&impl Fn(usize) -> bool>,
) -> Option<Column<u32>> {
    let is_kept = |row: &u32| kept.is_none_or(|kept| kept(*row as usize));
    let boxes = blocks(rows, &Hexahedra::none(), position);
    let volume = |bounds: Bounds| (bounds.max - bounds.min).as_dvec3().element_product();
    let sum: f64 = boxes.iter().map(|block| volume(block.bounds)).sum();
    if sum <= SCATTERED * volume(boxes.iter().fold(Bounds::EMPTY, |all, block| all.union(block.bounds))) {
        return kept.is_some().then(|| (0..rows.len() as u32).filter(is_kept).collect());
    }
    let view = rows.view();
    let key = |row: usize| placement.key(view.get(row).map(position));
    let mut keyed: Vec<(u64, u32)> = (0..rows.len()).into_par_iter().map(|row| (key(row), row as u32)).collect();
    keyed.par_sort_unstable();
    Some(keyed.into_iter().map(|(_, row)| row).filter(is_kept).collect())
}

/// The caller's cell of each cell; none where they are numbered alike.
fn file_from_cell(cells: &CellsInPlace, order: Option<&Column<u32>>) -> Option<Column<u32>> {
    let [tets, hexahedra] = cells.len();
    if hexahedra == 0 && cells.file_from_tet.is_none() {
        return order.cloned();
    }
    if tets == 0 {
        return cells.file_from_hexahedron.clone();
    }
    let of_row = |row: u32| cells.file_from_tet.as_ref().map_or(row, |file_from| file_from[row as usize]);
    let of_tets: Vec<u32> = match order {
        Some(order) => order.iter().map(|&row| of_row(row)).collect(),
        None => (0..tets as u32).map(of_row).collect(),
    };
    let of_hexahedra = (0..hexahedra).map(|hex| {
        let file_from = cells.file_from_hexahedron.as_ref();
        file_from.map_or((tets + hex) as u32, |file_from| file_from[hex])
    });
    Some(of_tets.into_iter().chain(of_hexahedra).collect())
}

/// Runs of cells of one kind, with the boxes around those that are drawn.
fn blocks(tets: &Tets, hexahedra: &Hexahedra, position: impl Fn(u32) -> Vec3 + Sync) -> Vec<Block> {
    let (rows, whole, first) = (tets.view(), hexahedra.view(), tets.len());
    let include = |bounds: Bounds, v: u32| bounds.include(position(v));
    let block = |run: Range<usize>| {
        let bounds = run.clone().fold(Bounds::EMPTY, |bounds, cell| match cell.checked_sub(first) {
            None => rows.get(cell).into_iter().fold(bounds, include),
            Some(hex) if whole.shape(hex).is_absent() => bounds,
            Some(hex) => whole.get(hex).into_iter().fold(bounds, include),
        });
        Block { cells: run, bounds }
    };
    let runs: Vec<Range<usize>> = Dataset::runs([tets.len(), hexahedra.len(), 0]).collect();
    runs.into_par_iter().map(block).collect()
}
