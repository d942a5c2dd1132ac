//! The Delaunay mesh of a point set: the driver around [`bowyer_watson`].
//!
//! In: f32 points, any at all. Out: positive tetrahedra whose union is the convex hull and whose circumspheres hold no
//! point; where more than four points lie on one sphere, one of the possible meshes. No cell is flat, on the hull
//! neither.
//!
//! Points are inserted in rounds, each twice as long as the last and ordered along a Hilbert curve (Amenta, Choi, Rote,
//! Incremental constructions con BRIO, 2003): the search from the last point is short, and no order of the input makes
//! the mesh pass through large intermediate stages.
//!
//! Why not a crate: of those with a free licence, `delaunay` 0.7.8 took 13 s for 2,000 points; `simple_delaunay_lib`
//! 0.2.0 is fast and right for points in general position (0.4 s for 40,000), but leaves flat cells where points lie in
//! one plane, searches all cells then (600 s for 60,000 points, half of them on faces of a cube), and never ends where
//! two coincide; the others bind C or C++ code. The predicates are the crate `robust`'s.

mod bowyer_watson;

use self::bowyer_watson::Triangulation;
use super::hilbert::{self, hilbert};
use super::random;
use super::settings::check_len;
use crate::error::{Error, Result};

/// Tetrahedra of the Delaunay mesh of `points`, each (b−a)×(c−a)·(d−a) > 0; of points that coincide one is used.
///
/// Exact on the f32 coordinates, deterministic, on one core.
///
/// ```
/// # use cellfan::generate::tetrahedralize;
/// // The middle of an octahedron's six corners makes eight cells.
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0],
///     [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
/// let tets = tetrahedralize(&points)?;
/// assert_eq!(tets.len(), 8);
/// assert!(tets.iter().all(|tet| tet.contains(&0)));
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// [`Error::NonFinitePosition`]; [`Error::NoCells`] where all points lie in one plane; [`Error::TooLarge`].
pub fn tetrahedralize(points: &[[f32; 3]]) -> Result<Vec<[u32; 4]>> {
    check_len("points", points.len() as u128)?;
    if let Some(point) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        return Err(Error::NonFinitePosition { point: point as u64, position: points[point].map(f64::from) });
    }
    let mut order = insertion_order(points);
    let wide = |v: u32| points[v as usize].map(f64::from);
    let Some(first) = first_tetrahedron(&order, wide) else {
        return Err(Error::NoCells { found: format!("{} points in one plane", points.len()) });
    };
    order.retain(|v| !first.contains(v));

    // Neighbours in space are neighbours in memory: the mesh is built on points in insertion order.
    order.splice(0..0, first);
    let positions: Vec<[f64; 3]> = order.iter().map(|&v| wide(v)).collect();
    let mut triangulation = Triangulation::new(&positions);
    for v in 4..positions.len() as u32 {
        triangulation.insert(v)?;
    }
    // Shewchuk's orientation is the negative of ours.
    Ok(triangulation.finish().map(|[a, b, c, d]| [a, b, d, c].map(|v| order[v as usize])).collect())
}

/// Rounds of 1, 1/2, 1/4 … of the points, the shortest first; along the curve within a round.
fn insertion_order(points: &[[f32; 3]]) -> Vec<u32> {
    let bound = |pick: fn(f32, f32) -> f32| {
        points
            .iter()
            .copied()
            .reduce(|a, b| std::array::from_fn(|i| pick(a[i], b[i])))
            .unwrap_or_default()
            .map(f64::from)
    };
    let (low, high) = (bound(f32::min), bound(f32::max));
    let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(f64::MIN_POSITIVE, f64::max);
    let cells = f64::from((1_u32 << hilbert::BITS) - 1);
    let longest = points.len().checked_ilog2().unwrap_or(0);
    let mut keyed: Vec<(u32, u64, u32)> = (0..points.len() as u32)
        .map(|v| {
            let p = points[v as usize];
            let cell = std::array::from_fn(|axis| ((f64::from(p[axis]) - low[axis]) / extent * cells) as u32);
            let coin = random::bits(0, ROUNDS, u64::from(v)).trailing_zeros().min(longest);
            (longest - coin, hilbert(cell), v)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, _, v)| v).collect()
}

/// Stream of the random numbers that deal points to rounds.
const ROUNDS: u64 = 0xb10;

/// The first four points of `order` that do not lie in one plane, positive for Shewchuk's predicate.
fn first_tetrahedron(order: &[u32], position: impl Fn(u32) -> [f64; 3]) -> Option<[u32; 4]> {
    let flat = |p: [f64; 3], drop: usize| robust::Coord { x: p[(drop + 1) % 3], y: p[(drop + 2) % 3] };
    let on_a_line = |points: [[f64; 3]; 3]| {
        (0..3).all(|drop| {
            let [a, b, c] = points.map(|p| flat(p, drop));
            robust::orient2d(a, b, c) == 0.0
        })
    };
    let &a = order.first()?;
    let b = order.iter().copied().find(|&b| !bowyer_watson::coincide(position(a), position(b)))?;
    let c = order.iter().copied().find(|&c| !on_a_line([a, b, c].map(&position)))?;
    let orient = |d| bowyer_watson::orient([a, b, c, d].map(&position));
    let d = order.iter().copied().find(|&d| orient(d) != 0.0)?;
    Some(if orient(d) > 0.0 { [a, b, c, d] } else { [a, c, b, d] })
}

#[cfg(test)]
mod tests;
