//! The points of a rectilinear grid, which its file gives by their coordinates along three axes.

use super::expansion::Expansion;
use super::structured::points_of;
use crate::columns::{NumericColumn, Points};

/// Every point of the grid, x fastest; in single precision where all axes are. The error is a sentence about the grid.
///
/// A few numbers an axis make many points: they count as if the file held them, compressed.
pub(super) fn points(axes: [&NumericColumn; 3], expansion: &Expansion) -> Result<Points, String> {
    let dims = axes.map(NumericColumn::len);
    let count = points_of(dims).unwrap_or(usize::MAX);
    let single = u64::try_from(size_of::<[f32; 3]>()).unwrap_or(u64::MAX);
    expansion.take(single.saturating_mul(count as u64))?;
    let [x, y, z] = axes;
    Ok(match (x, y, z) {
        (NumericColumn::F32(x), NumericColumn::F32(y), NumericColumn::F32(z)) => {
            Points::F32(product(count, dims, |axis, i| [x, y, z][axis][i]))
        }
        _ => Points::F64(product(count, dims, |axis, i| axes[axis].get(i))),
    })
}

fn product<T: Copy>(count: usize, [ni, nj, nk]: [usize; 3], coordinate: impl Fn(usize, usize) -> T) -> Vec<[T; 3]> {
    let mut points = Vec::with_capacity(count);
    for k in 0..nk {
        for j in 0..nj {
            points.extend((0..ni).map(|i| [coordinate(0, i), coordinate(1, j), coordinate(2, k)]));
        }
    }
    points
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "coordinates are copied bit for bit")]
mod tests {
    use super::*;

    #[test]
    fn x_runs_fastest_and_one_double_axis_makes_all_double() {
        let axis = |values: Vec<f32>| NumericColumn::from(values);
        let (x, y, z) = (axis(vec![0.0, 2.0]), axis(vec![1.0, -1.0]), axis(vec![5.0]));
        let small = Expansion::of(0);
        let Ok(Points::F32(points)) = points([&x, &y, &z], &small) else { panic!("not in single precision") };
        assert_eq!(points, [[0.0, 1.0, 5.0], [2.0, 1.0, 5.0], [0.0, -1.0, 5.0], [2.0, -1.0, 5.0]]);
        let z = NumericColumn::from(vec![0.1_f64]);
        let Ok(Points::F64(points)) = super::points([&x, &y, &z], &small) else { panic!("not in double precision") };
        assert_eq!(points[3], [2.0, -1.0, 0.1]);
    }

    #[test]
    fn axes_that_make_too_many_points_are_refused_before_any_is_made() {
        let long = NumericColumn::from(vec![0_u8; 1 << 22]);
        let error = points([&long, &long, &long], &Expansion::of(3 << 22)).unwrap_err();
        assert!(error.contains("64 times the file"), "{error}");
    }
}
