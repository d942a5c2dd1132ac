//! `sort`: the order in which cells are composited, nearest first.
//!
//! In: a block's visible cells and the view. Out: one `u32` key per cell, smaller is nearer: a depth (`centroid`, `power`), or the
//! cell's layer in an order of the whole mesh (`topological`, made once a frame from its `adjacency`); for maxima, which have no order along
//! rays, the largest value comes first ([`largest`]); where a backend wants one
//! global order, `projected_from_drawn` by [`radix`]; [`check`] counts what an order got wrong, [`overlaps`] where none can be right.
//! To add a key: a file with a function from a cell's corners to a depth, and its line in [`SortMethod`], [`SortKey`] and [`KeyMaker`].

pub mod adjacency;
pub mod centroid;
pub mod check;
pub mod delaunay;
mod faces;
pub mod largest;
mod neighbours;
pub mod overlaps;
pub mod power;
pub mod radix;
mod side;
pub mod topological;

use std::fmt;
use std::str::FromStr;

use glam::{DVec3, Vec3};

use crate::columns::{BlockCells, BlockView};
use crate::error::{Error, Result};
use crate::optics::LANES;
use crate::optics::lanes::max;
use crate::stages::footprints::planes::Corners;
use crate::stages::{SceneVertex, View};

/// How cells are put in order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SortMethod {
    /// The cheapest that is exact: nothing for an order-free model, otherwise `Exact` on the processor, and `Topological` for
    /// fans there and on a GPU, whose fragments are not checked.
    #[default]
    Auto,
    /// The order of the cells in memory.
    None,
    /// Distance of the centroid.
    Centroid,
    /// Power distance to the circumsphere; exact for a Delaunay mesh of a convex domain.
    Power,
    /// Williams' order by the graph of shared faces and of what rays meet next; exact where it has no cycle, which is reported.
    Topological,
    /// Right for any set of disjoint cells, cycles included: the better of the two keys for the mesh, every fragment
    /// checked against what its pixel has drawn, and where that fails the fragments sorted per pixel.
    Exact,
}

impl SortMethod {
    /// All methods, in the order of the documentation.
    pub const ALL: [Self; 6] = [Self::Auto, Self::None, Self::Centroid, Self::Power, Self::Topological, Self::Exact];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::None => "none",
            Self::Centroid => "centroid",
            Self::Power => "power",
            Self::Topological => "topological",
            Self::Exact => "exact",
        }
    }
}

impl fmt::Display for SortMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for SortMethod {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name).ok_or_else(|| Error::Option {
            option: "--sort",
            problem: format!("{name:?} is none of {}", Self::ALL.map(Self::name).join(", ")),
        })
    }
}

/// What cells are sorted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SortKey {
    /// Nothing: cells stay in memory order.
    None,
    /// See [`centroid`].
    Centroid,
    /// See [`power`].
    Power,
    /// See [`topological`].
    Topological,
}

impl SortKey {
    /// Its name in statistics.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => SortMethod::None.name(),
            Self::Centroid => SortMethod::Centroid.name(),
            Self::Power => SortMethod::Power.name(),
            Self::Topological => SortMethod::Topological.name(),
        }
    }
}

/// The key of a cell, for one view.
#[derive(Clone, Copy, Debug)]
pub enum KeyMaker<'a> {
    /// No order: cells stay in memory order.
    None,
    /// See [`centroid`].
    Centroid(centroid::Centroid),
    /// See [`power`].
    Power(power::Power),
    /// The layer of each cell of the dataset; see [`topological`].
    Layers(&'a [u32]),
    /// No order along rays, but one by values: see [`largest`].
    Largest(largest::Largest<'a>),
}

impl<'a> KeyMaker<'a> {
    /// The keys of one view; `layer_from_cell` is what [`topological`] found for it, which other keys do not read.
    pub fn new(key: SortKey, view: &View, layer_from_cell: &'a [u32]) -> Self {
        match key {
            SortKey::None => Self::None,
            SortKey::Centroid => Self::Centroid(centroid::Centroid::new(view)),
            SortKey::Power => Self::Power(power::Power::new(view)),
            SortKey::Topological => Self::Layers(layer_from_cell),
        }
    }

    /// What they order rays by.
    pub fn key(&self) -> SortKey {
        match self {
            Self::None | Self::Largest(_) => SortKey::None,
            Self::Centroid(_) => SortKey::Centroid,
            Self::Power(_) => SortKey::Power,
            Self::Layers(_) => SortKey::Topological,
        }
    }

    /// Whether all keys are the same.
    pub fn are_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// A value that cells of this key, or of a greater one, do not exceed.
    #[inline]
    pub fn at_most(&self, key: u32) -> f32 {
        if let Self::Largest(largest) = self { largest.at_most(key) } else { f32::INFINITY }
    }

    /// The keys of the sixteen tetrahedra of `corners`; what they order by must be a depth.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a kernel that is compiled for wider vectors")]
    pub fn of_lanes(&self, corners: &Corners, key: &mut [u32; LANES]) {
        match self {
            Self::None | Self::Layers(_) => key.fill(0),
            Self::Centroid(centroid) => {
                for (i, key) in key.iter_mut().enumerate() {
                    *key = key_of_depth(centroid.depth(corners.positions(i)));
                }
            }
            Self::Power(power) => {
                for (i, key) in key.iter_mut().enumerate() {
                    *key = key_of_depth(power.depth(corners.positions(i)) as f32);
                }
            }
            Self::Largest(largest) => {
                for (i, key) in key.iter_mut().enumerate() {
                    let [a, b, c, d] = corners.scalars(i);
                    *key = largest.key(max(max(a, b), max(c, d)));
                }
            }
        }
    }

    /// Appends the key of each visible cell of `block` to `key_from_visible`.
    pub fn keys(
        &self,
        block: &BlockView,
        vertices: &[SceneVertex],
        cell_from_visible: &[u32],
        key_from_visible: &mut Vec<u32>,
    ) {
        let position = |v: u32| Vec3::from_array(vertices[v as usize].position);
        let cells = cell_from_visible.iter();
        match (self, &block.cells) {
            (Self::None, _) => key_from_visible.extend(cells.map(|_| 0)),
            (Self::Centroid(centroid), BlockCells::Tets(tets)) => {
                let corners = |&cell: &u32| tets.get(cell as usize).map(position);
                key_from_visible.extend(cells.map(|cell| key_of_depth(centroid.depth(corners(cell)))));
            }
            (Self::Centroid(centroid), BlockCells::Hexahedra(hexahedra)) => {
                let corners = |&cell: &u32| hexahedra.get(cell as usize).map(position);
                key_from_visible.extend(cells.map(|cell| key_of_depth(centroid.depth(corners(cell)))));
            }
            (Self::Power(power), BlockCells::Tets(tets)) => {
                let corners = |&cell: &u32| tets.get(cell as usize).map(position);
                key_from_visible.extend(cells.map(|cell| key_of_depth(power.depth(corners(cell)) as f32)));
            }
            (Self::Power(power), BlockCells::Hexahedra(hexahedra)) => {
                // The sphere through four alternate corners: of a box, through all eight.
                let corners = |&cell: &u32| {
                    let corners = hexahedra.get(cell as usize).map(position);
                    [0, 2, 5, 7].map(|i: usize| corners[i])
                };
                key_from_visible.extend(cells.map(|cell| key_of_depth(power.depth(corners(cell)) as f32)));
            }
            (Self::Centroid(centroid), BlockCells::Polyhedra(polyhedra)) => {
                let middle = |&cell: &u32| middle_of(polyhedra.corners(cell as usize), position).0;
                key_from_visible.extend(cells.map(|cell| key_of_depth(centroid.depth([middle(cell)]))));
            }
            (Self::Power(power), BlockCells::Polyhedra(polyhedra)) => {
                let key = |&cell: &u32| {
                    let (middle, radius_squared) = middle_of(polyhedra.corners(cell as usize), position);
                    key_of_depth(power.depth_of_sphere(middle.as_dvec3(), radius_squared.into()) as f32)
                };
                key_from_visible.extend(cells.map(key));
            }
            (Self::Layers(layer_from_cell), _) => {
                key_from_visible.extend(cells.map(|&cell| layer_from_cell[block.base + cell as usize]));
            }
            (Self::Largest(largest), kind) => {
                let of =
                    |corners: &[u32]| corners.iter().map(|&v| vertices[v as usize].scalar).fold(f32::NEG_INFINITY, max);
                let s_max = |cell: usize| match (largest.cell_values(), kind) {
                    (Some(values), _) => values[block.base + cell],
                    (None, BlockCells::Tets(tets)) => of(&tets.get(cell)),
                    (None, BlockCells::Hexahedra(hexahedra)) => of(&hexahedra.get(cell)),
                    (None, BlockCells::Polyhedra(polyhedra)) => of(polyhedra.corners(cell)),
                };
                key_from_visible.extend(cells.map(|&cell| largest.key(s_max(cell as usize))));
            }
        }
    }
}

/// The mean of some corners, and the mean square of their distances from it.
fn middle_of(corners: &[u32], position: impl Fn(u32) -> Vec3) -> (Vec3, f32) {
    let share = 1.0 / corners.len() as f32;
    let middle = corners.iter().map(|&v| position(v)).sum::<Vec3>() * share;
    (middle, corners.iter().map(|&v| position(v).distance_squared(middle)).sum::<f32>() * share)
}

/// A key that orders as the depth does, negative depths included; NaN comes last.
///
/// ```
/// # use cellfan::stages::sort::key_of_depth;
/// assert!(key_of_depth(-2.0) < key_of_depth(-1.0) && key_of_depth(-1.0) < key_of_depth(0.5));
/// ```
#[inline(always)]
#[expect(clippy::inline_always, reason = "part of kernels that are compiled for wider vectors")]
pub fn key_of_depth(depth: f32) -> u32 {
    let bits = depth.to_bits();
    // Positive numbers order as their bits; negative ones the other way round and below them.
    bits ^ (((bits as i32) >> 31) as u32 | 1 << 31)
}

/// The direction along which a view orders: distances from the eye, or depth along parallel rays.
#[derive(Clone, Copy, Debug)]
pub(super) enum Toward {
    Eye(DVec3),
    Along(DVec3),
}

impl Toward {
    pub(super) fn new(view: &View) -> Self {
        if view.is_perspective { Self::Eye(view.eye) } else { Self::Along(view.forward) }
    }
}

#[cfg(test)]
mod tests {
    use super::key_of_depth;

    #[test]
    fn keys_order_like_depths() {
        let depths = [f32::NEG_INFINITY, -1e30, -1.5, -1e-30, 0.0, 1e-40, 0.25, 3.0, f32::INFINITY, f32::NAN];
        assert!(depths.map(key_of_depth).is_sorted());
    }
}
