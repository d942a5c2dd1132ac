//! `volume`: an analytic signal at the points of a regular grid, for the readers and renderers of volumes.

use glam::DVec3;
use rayon::prelude::*;

use super::field::Field;
use super::{Orbital, Settings, buckyball, marschner_lobb, orbital};
use crate::columns::{Array, Association, Lattice, NumericColumn, Volume};
use crate::error::{Error, Result};
use crate::memory;

/// A signal over the unit cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// [`marschner_lobb`], 0 to 1.
    MarschnerLobb,
    /// The density of a [`Buckyball`](super::Buckyball).
    Buckyball,
    /// The density of an [`Orbital`].
    Orbital(Orbital),
}

/// What samples of a generated volume are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleType {
    /// The signal's lowest value at a point as 0, its highest as 255.
    U8,
    /// The signal itself.
    F32,
}

/// The signal at `dims` points, a value a point, as the array `value`. The grid is centred in the unit cube, whose edge is its longest.
///
/// ```
/// use cellfan::generate::{SampleType, Signal, volume};
/// let volume = volume([9, 9, 5], Signal::MarschnerLobb, SampleType::F32)?;
/// assert_eq!((volume.points(), volume.arrays[0].values.type_name()), (405, "f32"));
/// assert_eq!(volume.lattice.origin().to_array(), [0.0, 0.0, 0.25]);
/// assert!((volume.arrays[0].values.get(4 + 9 * (4 + 9 * 2)) - 0.6).abs() < 1e-7); // (1 + 0.25 * 2) / 2.5 in the middle
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// [`Error::Option`] where a side has fewer than two points or there is no such orbital; [`Error::OutOfMemory`].
pub fn volume(dims: [usize; 3], signal: Signal, sample: SampleType) -> Result<Volume> {
    if dims.iter().any(|&points| points < 2) {
        let problem = format!("{dims:?} points: a volume has at least 2 along each axis");
        return Err(Error::Option { option: "--dims", problem });
    }
    let field: Field = match signal {
        Signal::MarschnerLobb => Box::new(marschner_lobb),
        Signal::Buckyball => buckyball::field(),
        Signal::Orbital(orbital) => orbital::field(&Settings { orbital, ..Settings::default() })?,
    };
    let points = dims.iter().try_fold(1_usize, |product, &along| product.checked_mul(along));
    let bytes_each = if sample == SampleType::U8 { 5 } else { 4 };
    let bytes = points.and_then(|points| (points as u64).checked_mul(bytes_each));
    memory::check(|| format!("a volume of {} points", dims.map(|points| points.to_string()).join(" x ")), bytes)?;

    let steps = (dims.into_iter().max().unwrap_or(2) - 1) as f64;
    let spacing = 1.0 / steps;
    let origin = DVec3::from(dims.map(|points| 0.5 - 0.5 * (points - 1) as f64 / steps));
    let lattice = Lattice::new(origin, DVec3::splat(spacing));
    let [ni, nj, nk] = dims;
    let row = |row: usize| {
        let (j, k, field) = ((row % nj) as f64, (row / nj) as f64, &field);
        (0..ni).map(move |i| field(lattice.world(DVec3::new(i as f64, j, k))) as f32)
    };
    let values: Vec<f32> = (0..nj * nk).into_par_iter().flat_map_iter(row).collect();
    let values = match sample {
        SampleType::F32 => values.into(),
        SampleType::U8 => NumericColumn::from(in_bytes(&values)),
    };
    let array = Array { name: "value".to_owned(), association: Association::Point, components: 1, values };
    Volume::new(dims, lattice, vec![array])
}

/// From lowest to highest as 0 to 255.
fn in_bytes(values: &[f32]) -> Vec<u8> {
    let low = values.par_iter().copied().reduce(|| f32::INFINITY, f32::min);
    let high = values.par_iter().copied().reduce(|| f32::NEG_INFINITY, f32::max);
    let scale = if high > low { 255.0 / (high - low) } else { 0.0 };
    values.par_iter().map(|&value| ((value - low) * scale).round() as u8).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_span_the_signal_and_sides_are_checked() {
        let bytes = volume([12, 7, 9], Signal::Orbital(Orbital::default()), SampleType::U8).unwrap();
        let single = volume([12, 7, 9], Signal::Orbital(Orbital::default()), SampleType::F32).unwrap();
        let (NumericColumn::U8(bytes), NumericColumn::F32(single)) =
            (&bytes.arrays[0].values, &single.arrays[0].values)
        else {
            panic!("of other types");
        };
        assert_eq!((bytes.iter().min(), bytes.iter().max()), (Some(&0), Some(&255)));
        let highest = |values: &[f32]| values.iter().copied().fold(0.0, f32::max);
        let near = |(&byte, &value): (&u8, &f32)| {
            (f32::from(byte) / 255.0 * highest(single) - value).abs() <= highest(single) / 255.0
        };
        assert!(bytes.iter().zip(single.iter()).all(near));
        assert!(volume([1, 2, 2], Signal::Buckyball, SampleType::U8).unwrap_err().to_string().contains("--dims"));
        assert!(volume([usize::MAX; 3], Signal::Buckyball, SampleType::U8).is_err());
    }
}
