//! The transfer function that shows something of an array of which nothing is known.
//!
//! In: mesh, field, optical model. Out: colours over all but the rarest values, extinction by how rare a value is in the
//! mesh's volume, none where it is background; the optical depth is that of a mesh as thick as this one. Absorption shows
//! greys, emission adds up and must not blind, mip shows colours alone; a homogeneous mesh has one extinction.

use cellfan::columns::{Association, Block, SampleVisitor, Samples, Volume, VolumeField};
use cellfan::optics::presets::{ColorMap, OpacityProfile, preset};
use cellfan::{ControlPoint, Dataset, Field, Model, Result, TransferFunction};
use rayon::prelude::*;

use crate::cli::numbers::short;

/// A larger mesh is sampled: about so many of its cells are read.
const CELLS_READ: usize = 1 << 22;

/// Bins of the histogram.
const BINS: usize = 256;

/// The parts in which a histogram counts volume.
const PARTS: f64 = 1e12;

/// Optical depth of a homogeneous mesh over its thickness, see [`thickness_world`].
const HOMOGENEOUS_DEPTH: f64 = 2.0;

/// Linear RGB of a homogeneous mesh.
const HOMOGENEOUS_COLOR: [f64; 3] = [0.75, 0.85, 1.0];

/// The share of the values at either end over which the colours are not stretched: outliers would take them all.
const TAIL: f64 = 0.01;

/// How much more opaque the rarest values must be than the commonest before these are background; chosen by eye.
const BACKGROUND_CONTRAST: f64 = 8.0;

/// No optical depth over the thickness is greater without the background: a small feature stays translucent.
const DEPTH_LIMIT: f64 = 30.0;

/// The share of the mean optical depth that must be left without the background; chosen by eye.
const DEPTH_KEPT: f64 = 0.1;

/// The transfer function, and what to call it.
///
/// # Errors
/// [`Error::TransferFunction`](cellfan::Error::TransferFunction) where the mesh's size or the field's range leaves what
/// can be computed with.
pub(super) fn automatic(dataset: &Dataset, field: &Field, model: Model) -> Result<(TransferFunction, String)> {
    of_values(field.range, thickness_world(dataset), model, || Values::of(dataset, field))
}

/// The same for a volume.
///
/// # Errors
/// As [`automatic`].
pub(super) fn automatic_of_volume(
    volume: &Volume,
    field: &VolumeField,
    model: Model,
) -> Result<(TransferFunction, String)> {
    let [i, j, k] = [0, 1, 2].map(|axis| volume.lattice.steps().col(axis) * (volume.dims[axis] - 1) as f64);
    let surface = 2.0 * (i.cross(j).length() + j.cross(k).length() + k.cross(i).length());
    let thickness = mean_thickness(i.cross(j).dot(k).abs(), surface, (i + j + k).length());
    of_values(field.range, thickness, model, || Values::of_volume(field))
}

/// The transfer function of values of which each has its share of a mesh so thick.
fn of_values(
    range: (f64, f64),
    thickness: f64,
    model: Model,
    values: impl FnOnce() -> Values,
) -> Result<(TransferFunction, String)> {
    if range.0 >= range.1 {
        let (color, depth) = match model {
            Model::Absorption => ([1.0; 3], HOMOGENEOUS_DEPTH),
            Model::Emission => (HOMOGENEOUS_COLOR, 0.3 * HOMOGENEOUS_DEPTH),
            Model::EmissionAbsorption | Model::Mip => (HOMOGENEOUS_COLOR, HOMOGENEOUS_DEPTH),
        };
        let extinction = depth / thickness;
        let transfer = TransferFunction::constant(color, extinction)?;
        return Ok((transfer, format!("constant extinction {}", short(extinction))));
    }
    let (map, scale) = match model {
        Model::EmissionAbsorption => (ColorMap::Viridis, 1.0),
        // Half the depth: light that nothing dims adds up, and what a film shows lies between black and white.
        Model::Emission => (ColorMap::Inferno, 0.5),
        Model::Absorption => (ColorMap::XRay, 0.5),
        Model::Mip => {
            let map = ColorMap::Viridis;
            let transfer = preset(map.name(), range, OpacityProfile::default(), thickness)?;
            return Ok((transfer, map.to_string()));
        }
    };
    let values = values();
    let transfer = TransferFunction::from_histogram(&values.histogram, values.range, map, thickness)?;
    let transfer = without_background(&transfer, &values, thickness)?.scaled_extinction(scale)?;
    Ok((transfer, format!("{map} by histogram")))
}

/// How often the values of a field occur.
struct Values {
    /// What all but the rarest values lie in.
    range: (f64, f64),
    /// Volume in equal bins of the range, in parts of [`PARTS`]; what lies outside is in the first and the last.
    histogram: [u64; BINS],
}

impl Values {
    fn of(dataset: &Dataset, field: &Field) -> Self {
        let some = field.values.iter().step_by(stride(dataset)).copied();
        let mut values: Vec<f32> = some.filter(|value| value.is_finite()).collect();
        if values.is_empty() {
            values.push((field.range.0 - field.offset) as f32);
        }
        let inner = without_tails(&mut values);
        let mut range = (field.offset + f64::from(inner.0), field.offset + f64::from(inner.1));
        if range.0 >= range.1 {
            range = field.range;
        }
        Self { range, histogram: histogram(dataset, field, range) }
    }

    /// Of a volume, whose points or cells have all as much of it.
    fn of_volume(field: &VolumeField) -> Self {
        let middle = 0.5 * field.range.0 + 0.5 * field.range.1;
        let mut values = field.visit(Sparse { middle });
        let inner = without_tails(&mut values);
        let mut range = (middle + f64::from(inner.0), middle + f64::from(inner.1));
        if range.0 >= range.1 {
            range = field.range;
        }
        let mut histogram = [0; BINS];
        let bins_per_unit = BINS as f64 / (range.1 - range.0);
        for value in values {
            let bin = ((middle + f64::from(value) - range.0) * bins_per_unit).clamp(0.0, (BINS - 1) as f64);
            histogram[bin as usize] += 1;
        }
        Self { range, histogram }
    }

    /// Mean extinction of the values.
    fn mean_extinction(&self, transfer: &TransferFunction) -> f64 {
        let (low, high) = self.range;
        let value = |bin: usize| low + (high - low) * (bin as f64 + 0.5) / BINS as f64;
        let sum = |sum, (bin, &count): (usize, &u64)| sum + count as f64 * transfer.eval(value(bin)).extinction;
        self.histogram.iter().enumerate().fold(0.0, sum) / self.histogram.iter().sum::<u64>() as f64
    }
}

/// The range of all but the rarest values at either end; there is a value.
fn without_tails(values: &mut [f32]) -> (f32, f32) {
    let last = values.len() - 1;
    let tail = (last as f64 * TAIL) as usize;
    let mut at = |place| *values.select_nth_unstable_by(place, f32::total_cmp).1;
    (at(tail), at(last - tail))
}

/// Some of the values of a volume, less the middle of their range.
struct Sparse {
    middle: f64,
}

impl SampleVisitor for Sparse {
    type Output = Vec<f32>;

    fn visit<T: cellfan::columns::Sample>(self, samples: Samples<'_, T>) -> Vec<f32> {
        // Odd, so that sides that are powers of two do not show the same columns.
        let stride = samples.len().div_ceil(CELLS_READ) | 1;
        let some = (0..samples.len()).step_by(stride).map(|i| (samples.get(i) - self.middle) as f32);
        let mut values: Vec<f32> = some.filter(|value| value.is_finite()).collect();
        if values.is_empty() {
            values.push(0.0);
        }
        values
    }
}

/// How much volume has a value in each bin: a cell's volume is spread evenly from its lowest to its highest corner.
fn histogram(dataset: &Dataset, field: &Field, range: (f64, f64)) -> [u64; BINS] {
    let bins = BINS as f64;
    let place = |value: f32| {
        let place = (field.offset + f64::from(value) - range.0) / (range.1 - range.0) * bins;
        // Inside, so that the last bin has its upper end.
        place.clamp(0.0, bins - 1e-9)
    };
    let of_block = |block: &Block| {
        let mut volumes = [0.0; BINS];
        for cell in block.cells.clone() {
            let widen = |(low, high): (f64, f64), value: f32| {
                value.is_finite().then(|| (low.min(place(value)), high.max(place(value))))
            };
            let ends = match field.association {
                Association::Point => {
                    dataset.corners(cell).iter().map(|&v| field.values[v as usize]).try_fold((bins, 0.0), widen)
                }
                Association::Cell => widen((bins, 0.0), field.values[cell]),
            };
            let Some((low, high)) = ends else { continue };
            let volume = dataset.volume_world(cell);
            let (first, last) = (low as usize, high as usize);
            if first == last {
                volumes[first] += volume;
                continue;
            }
            for (bin, sum) in volumes.iter_mut().enumerate().take(last + 1).skip(first) {
                let overlap = high.min((bin + 1) as f64) - low.max(bin as f64);
                *sum += volume * overlap / (high - low);
            }
        }
        volumes
    };
    // Blocks side by side, their sum in order: the same digits for any number of threads.
    let blocks: Vec<[f64; BINS]> = sample(dataset).map(of_block).collect();
    let mut sum = [0.0; BINS];
    for block in &blocks {
        sum.iter_mut().zip(block).for_each(|(sum, volume)| *sum += volume);
    }
    let all: f64 = sum.iter().sum();
    sum.map(|volume| (volume / all * PARTS) as u64)
}

/// Which blocks are read: every so manieth. Odd, since every second or fourth along a Morton curve would lie on one side.
fn stride(dataset: &Dataset) -> usize {
    dataset.cells().div_ceil(CELLS_READ) | 1
}

fn sample(dataset: &Dataset) -> impl IndexedParallelIterator<Item = &Block> {
    dataset.blocks.par_iter().step_by(stride(dataset))
}

/// The function with extinction 0 for the commonest values, as deep as before where the rest allows; the same function
/// where these are no background: not much commoner than others, or not the lowest or highest.
fn without_background(transfer: &TransferFunction, values: &Values, thickness_world: f64) -> Result<TransferFunction> {
    let extinctions: Vec<f64> = transfer.points().iter().map(|point| point.extinction).collect();
    let least = extinctions.iter().copied().fold(f64::INFINITY, f64::min);
    let most = extinctions.iter().copied().fold(0.0, f64::max);
    let ends = extinctions[0].min(extinctions[extinctions.len() - 1]);
    // A value in the middle of the range is no background: without it there would be a hole in the picture.
    if ends > least || most < BACKGROUND_CONTRAST * least {
        return Ok(transfer.clone());
    }
    let lowered = |point: &ControlPoint| ControlPoint { extinction: point.extinction - least, ..*point };
    let lowered = TransferFunction::new(transfer.points().iter().map(lowered).collect())?;
    let (before, left) = (values.mean_extinction(transfer), values.mean_extinction(&lowered));
    let factor = (before / left).min(DEPTH_LIMIT / thickness_world / (most - least));
    // Where (nearly) all values are background, it is what there is to see.
    if factor.is_finite() && factor * left > DEPTH_KEPT * before {
        lowered.scaled_extinction(factor)
    } else {
        Ok(transfer.clone())
    }
}

/// How much of the mesh a ray crosses, as the diagonal of the cube in which a ray crosses as much; world units.
///
/// The mean chord of a convex body is 4 V / S (Cauchy): rays that meet the box of the mesh cross 4 V(mesh) / S(box) on
/// average, whether the mesh is a thin shell, a flat plate or fills its box. In a cube that is 2/3 of its edge.
fn thickness_world(dataset: &Dataset) -> f64 {
    // Side by side, their sum in order.
    let of_block = |block: &Block| block.cells.clone().map(|cell| dataset.volume_world(cell)).sum();
    let volumes: Vec<f64> = sample(dataset).map(of_block).collect();
    let read: usize = dataset.blocks.iter().step_by(stride(dataset)).map(|block| block.cells.len()).sum();
    let volume = volumes.iter().sum::<f64>() * (dataset.cells() as f64 / read as f64);
    let [x, y, z] = (dataset.bounds.max.as_dvec3() - dataset.bounds.min.as_dvec3()).to_array();
    mean_thickness(volume, 2.0 * (x * y + y * z + z * x), dataset.diagonal_world())
}

/// The same from volume, surface of the box, and diagonal.
fn mean_thickness(volume: f64, surface: f64, diagonal: f64) -> f64 {
    // The diagonal of a cube is √3 edges, its mean chord 2/3 of one.
    let thickness = 1.5 * 3_f64.sqrt() * 4.0 * volume / surface;
    thickness.clamp(1e-3 * diagonal, diagonal)
}

#[cfg(test)]
mod tests {
    use cellfan::generate::{Kind, Settings, generate};
    use cellfan::{FieldSelection, Points};

    use super::*;

    /// The unit cube or a flattened one, with a field of its heights.
    fn cube(height: f32, value: impl Fn(f32) -> f32) -> (Dataset, Field) {
        let mut mesh = generate(Kind::Tets, &Settings { cells: 4000, ..Settings::default() }).unwrap();
        let Points::F32(points) = &mut mesh.points else { panic!("generated points are f32") };
        let values: Vec<f32> = points.iter().map(|p| value(p[2])).collect();
        for p in points.iter_mut() {
            p[2] *= height;
        }
        mesh.arrays.truncate(1);
        mesh.arrays[0].values = values.into();
        let dataset = Dataset::from_tets(mesh).unwrap();
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
        (dataset, field)
    }

    #[test]
    fn thickness_of_a_cube_and_of_a_plate() {
        let (cube_thickness, plate) = (thickness_world(&cube(1.0, |z| z).0), thickness_world(&cube(0.01, |z| z).0));
        assert!((cube_thickness - 3_f64.sqrt()).abs() < 1e-4, "{cube_thickness}");
        // 1.5 √3 · 4 V / S with V = 0.01 and S = 2.04.
        assert!((plate - 0.050_94).abs() < 1e-4, "{plate}");
    }

    #[test]
    fn volume_is_spread_over_the_values_of_a_cell() {
        let (dataset, field) = cube(1.0, |z| z);
        let histogram = histogram(&dataset, &field, (0.0, 1.0));
        let all: u64 = histogram.iter().sum();
        assert!((all as f64 / PARTS - 1.0).abs() < 1e-9);
        let quarters: Vec<f64> =
            histogram.chunks(BINS / 4).map(|bins| bins.iter().sum::<u64>() as f64 / PARTS).collect();
        assert!(quarters.iter().all(|share| (share - 0.25).abs() < 0.03), "{quarters:?}");
        assert!(histogram.iter().all(|&volume| volume > 0), "no gap between the layers of the grid");
    }

    #[test]
    fn outliers_do_not_take_all_colours() {
        let (dataset, mut field) = cube(1.0, |z| z);
        let mut values = field.values.to_vec();
        values[7] = 1e6;
        field.values = values.into();
        field.range.1 = 1e6;
        let values = Values::of(&dataset, &field);
        assert!(values.range.1 <= 1.0, "{:?}", values.range);
    }

    #[test]
    fn what_fills_most_of_the_mesh_at_one_end_is_background() {
        let (dataset, field) = cube(1.0, |z| (z - 0.8).max(0.0));
        let (transfer, _) = automatic(&dataset, &field, Model::EmissionAbsorption).unwrap();
        assert!(transfer.eval(0.0).extinction <= 0.0 && transfer.eval(0.15).extinction > 1.0);
        // In the middle it is not.
        let (dataset, field) = cube(1.0, |z| (z - 0.8).max(0.0) + (z - 0.2).min(0.0));
        let (transfer, _) = automatic(&dataset, &field, Model::EmissionAbsorption).unwrap();
        assert!(transfer.points().iter().all(|point| point.extinction > 0.0));
    }

    #[test]
    fn two_values_at_the_ends_are_both_seen() {
        let (dataset, _) = cube(1.0, |z| z);
        let mut field = dataset.homogeneous_field();
        let half = field.values.len() / 2;
        let mut values = field.values.to_vec();
        values[half..].fill(2.0);
        field.values = values.into();
        field.range = (0.0, 2.0);
        let (transfer, _) = automatic(&dataset, &field, Model::EmissionAbsorption).unwrap();
        assert!(transfer.eval(0.0).extinction > 0.5 && transfer.eval(2.0).extinction > 0.5);
    }

    #[test]
    fn every_model_has_one() {
        let (dataset, field) = cube(1.0, |z| z);
        for model in Model::ALL {
            for field in [&field, &dataset.homogeneous_field()] {
                let (transfer, name) = automatic(&dataset, field, model).unwrap();
                assert!(transfer.points().iter().any(|point| point.extinction > 0.0), "{model}: {name}");
            }
        }
    }
}
