//! `cull`: drop the cells that cannot show.
//!
//! In: a block, its scalars, a [`CullTable`]. Out: `cell_from_visible`, ascending. Drops a cell only if its extinction is 0
//! on its whole value interval (`CellFast`, "Culling") or one of its values is NaN. O(1) a cell: two table reads.

use crate::columns::{Association, BlockCells, BlockView, Field};
use crate::optics::{CullTable, Intervals};
use crate::stages::ScreenVertex;

/// Smallest and largest stored value of a cell; NaN in either where a value is NaN.
#[inline]
pub fn value_interval([a, b, c, d]: [f32; 4]) -> (f32, f32) {
    let low = if a < b { a } else { b };
    let high = if a < b { b } else { a };
    let low2 = if c < d { c } else { d };
    let high2 = if c < d { d } else { c };
    // A comparison with NaN is false, so a NaN can hide behind a number: the sum shows it.
    let nan = (a * 0.0 + b * 0.0) + (c * 0.0 + d * 0.0);
    (if low < low2 { low } else { low2 } + nan, if high > high2 { high } else { high2 } + nan)
}

/// The same for eight values.
#[inline]
fn interval_of_eight([a, b, c, d, e, f, g, h]: [f32; 8]) -> (f32, f32) {
    let ((low, high), (low2, high2)) = (value_interval([a, b, c, d]), value_interval([e, f, g, h]));
    value_interval([low, high, low2, high2])
}

/// Appends all block-local cells that there are to `cell_from_visible`.
pub fn all(block: &BlockView, cell_from_visible: &mut Vec<u32>) {
    match &block.cells {
        BlockCells::Tets(tets) => cell_from_visible.extend(0..tets.len() as u32),
        BlockCells::Hexahedra(hexahedra) => {
            let is_there = |&cell: &u32| !hexahedra.shape(cell as usize).is_absent();
            cell_from_visible.extend((0..hexahedra.len() as u32).filter(is_there));
        }
        BlockCells::Polyhedra(polyhedra) => cell_from_visible.extend(0..polyhedra.len() as u32),
    }
}

/// The same for any number of values.
fn interval_of(values: impl Iterator<Item = f32>) -> (f32, f32) {
    values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| {
        let nan = value * 0.0;
        (low.min(value) + nan, high.max(value) + nan)
    })
}

/// Appends the block-local cells that can show to `cell_from_visible`; returns how many were transparent and invalid.
pub fn cull(
    block: &BlockView,
    field: &Field,
    screen: &[ScreenVertex],
    optics: (&Intervals, &CullTable),
    cell_from_visible: &mut Vec<u32>,
) -> Culled {
    let (_, table) = optics;
    if field.invalid == 0 && table.is_all_opaque() {
        // Nothing to look at: all cells that there are show.
        all(block, cell_from_visible);
        return Culled::default();
    }
    let of_vertex = |v: u32| screen[v as usize].scalar;
    let of_cell = |cell: usize| value_interval([field.values[block.base + cell]; 4]);
    match (&block.cells, field.association) {
        (BlockCells::Tets(tets), Association::Point) => {
            sift(0..tets.len(), |cell| value_interval(tets.get(cell).map(of_vertex)), optics, cell_from_visible)
        }
        (BlockCells::Tets(tets), Association::Cell) => sift(0..tets.len(), of_cell, optics, cell_from_visible),
        (BlockCells::Hexahedra(hexahedra), association) => {
            let cells = (0..hexahedra.len()).filter(|&cell| !hexahedra.shape(cell).is_absent());
            if association == Association::Cell {
                return sift(cells, of_cell, optics, cell_from_visible);
            }
            sift(cells, |cell| interval_of_eight(hexahedra.get(cell).map(of_vertex)), optics, cell_from_visible)
        }
        (BlockCells::Polyhedra(polyhedra), Association::Cell) => {
            sift(0..polyhedra.len(), of_cell, optics, cell_from_visible)
        }
        (BlockCells::Polyhedra(polyhedra), Association::Point) => {
            let interval = |cell: usize| interval_of(polyhedra.corners(cell).iter().map(|&v| of_vertex(v)));
            sift(0..polyhedra.len(), interval, optics, cell_from_visible)
        }
    }
}

/// Keeps those of `cells` whose `interval` of values shows.
#[inline]
fn sift(
    cells: impl Iterator<Item = usize>,
    interval: impl Fn(usize) -> (f32, f32),
    (intervals, table): (&Intervals, &CullTable),
    cell_from_visible: &mut Vec<u32>,
) -> Culled {
    let mut culled = Culled::default();
    for cell in cells {
        let (low, high) = interval(cell);
        if low.is_nan() {
            culled.invalid += 1;
        } else if table.is_transparent(intervals, low, high) {
            culled.transparent += 1;
        } else {
            cell_from_visible.push(cell as u32);
        }
    }
    culled
}

/// How many cells `cull` dropped, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Culled {
    /// No extinction on the cell's whole value interval.
    pub transparent: u64,
    /// A value that is not finite.
    pub invalid: u64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Dataset;
    use crate::generate::{Settings, delaunay};
    use crate::optics::{ControlPoint, Model, TransferFunction};
    use crate::stages::View;
    use crate::stages::project::{project, scene_vertices};
    use crate::stages::testing::{Random, views};

    #[test]
    fn the_interval_is_the_smallest_and_largest_value() {
        let values = [3.0, -1.0, 2.0, 0.5];
        for turn in 0..4 {
            let mut turned = values;
            turned.rotate_left(turn);
            assert_eq!(value_interval(turned), (-1.0, 3.0));
            turned[turn] = f32::NAN;
            assert!(value_interval(turned).0.is_nan() && value_interval(turned).1.is_nan());
        }
    }

    /// Three to eight points at odd multiples of 1/64, which no value of the mesh meets; half without extinction.
    fn random_transfer(random: &mut Random) -> TransferFunction {
        let mut values: Vec<u32> =
            (0..3 + (random.unit() * 6.0) as u32).map(|_| (random.unit() * 32.0) as u32).collect();
        values.sort_unstable();
        values.dedup();
        let point = |value: u32| {
            let extinction = if random.unit() < 0.5 { 0.0 } else { random.unit() };
            ControlPoint { value: f64::from(2 * value + 1) / 64.0, color: [1.0; 3], extinction }
        };
        TransferFunction::new(values.into_iter().map(point).collect()).unwrap()
    }

    /// The slow twin: extinction at both ends and at every control point between them; linear elsewhere.
    fn is_transparent(transfer: &TransferFunction, values: [f64; 4]) -> bool {
        let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), &s| (low.min(s), high.max(s)));
        let between = transfer.points().iter().map(|point| point.value).filter(|&value| low < value && value < high);
        between.chain([low, high]).all(|value| transfer.eval(value).extinction == 0.0)
    }

    #[test]
    fn cells_are_dropped_as_their_slow_twin_says_and_nan_is_counted() {
        let mut random = Random::new(1);
        let mesh = delaunay(&Settings { cells: 10_000, ..Settings::default() }).unwrap();
        let dataset = Dataset::from_tets(mesh).unwrap();
        let mut field = dataset.homogeneous_field();
        field.association = Association::Point;
        // From −0.05 to 1.1: some values below the first control point, some above the last.
        let smooth = |p: &[f32; 3]| (p[0] - 0.5).hypot(p[1] - 0.5) * 1.6 - 0.05 + p[2] * 0.02;
        let mut values: Vec<f32> = dataset.positions.iter().map(smooth).collect();
        for i in (0..values.len()).step_by(211) {
            values[i] = if i % 2 == 0 { f32::NAN } else { f32::INFINITY };
        }
        let is_invalid = |tet: &[u32; 4]| tet.iter().any(|&v| !values[v as usize].is_finite());
        field.invalid = dataset.tets.iter().filter(is_invalid).count() as u64;
        field.values = values.into();
        let (mut screen, view): (_, View) = (Vec::new(), views(&dataset, 64, 64)[0]);
        project(&view, &scene_vertices(&dataset, &field), &mut screen);
        let (mut dropped, mut kept) = (0, 0);
        for _ in 0..50 {
            let transfer = random_transfer(&mut random);
            let pieces = transfer.pieces(0.0);
            let table = CullTable::new(&pieces, Model::EmissionAbsorption);
            let (mut expected, mut slow) = (Vec::new(), Culled::default());
            let (mut visible, mut culled) = (Vec::new(), Culled::default());
            for block in (0..dataset.blocks.len()).map(|block| dataset.block(block)) {
                let BlockCells::Tets(tets) = &block.cells else { panic!("a block of tetrahedra") };
                for (cell, tet) in tets.iter().enumerate() {
                    let values = tet.map(|v| f64::from(field.values[v as usize]));
                    if values.iter().any(|value| !value.is_finite()) {
                        slow.invalid += 1;
                    } else if is_transparent(&transfer, values) {
                        slow.transparent += 1;
                    } else {
                        expected.push(cell as u32);
                    }
                }
                let of_block = cull(&block, &field, &screen, (&pieces, &table), &mut visible);
                culled.invalid += of_block.invalid;
                culled.transparent += of_block.transparent;
            }
            assert_eq!(culled, slow, "{transfer:?}");
            assert!(visible == expected, "{transfer:?}");
            assert!(culled.invalid > 100);
            dropped += culled.transparent;
            kept += visible.len();
        }
        assert!(dropped > 10_000 && kept > 10_000, "{dropped} dropped, {kept} kept");
    }
}
