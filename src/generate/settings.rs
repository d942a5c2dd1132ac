//! `Settings`: everything that shapes a generated mesh, and the check of it.

use super::Orbital;
use crate::error::{Error, Result};
use crate::memory;

/// The largest jitter, in spacings of the grid; beyond half a spacing neighbours would change places.
pub const MAX_JITTER: f64 = 0.35;

/// How a box of a grid is cut into tetrahedra.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// Five: one in the middle, four at every other corner; neighbouring boxes are mirrored, so that faces agree.
    Five,
    /// Six around the main diagonal (Kuhn 1960): all of one volume, every box alike.
    #[default]
    Six,
}

impl Scheme {
    /// Tetrahedra a box.
    pub const fn tets_per_box(self) -> u64 {
        match self {
            Self::Five => 5,
            Self::Six => 6,
        }
    }
}

/// What shapes a generated mesh; each kind reads what concerns it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Cells wanted. A grid has the fewest equal boxes along its edges that give as many; a Delaunay mesh comes
    /// within 3 % from 10,000 cells on.
    pub cells: u64,
    /// Seed of everything random.
    pub seed: u64,
    /// How far a vertex of a grid moves along each axis, in spacings: at most this, 0 to [`MAX_JITTER`].
    pub jitter: f64,
    /// How a grid's boxes are cut.
    pub scheme: Scheme,
    /// Delaunay: corners, edges and faces of the cube get points of their own, so that the mesh fills it.
    pub fill_cube: bool,
    /// Which orbital.
    pub orbital: Orbital,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            cells: 100_000,
            seed: 1,
            jitter: 0.25,
            scheme: Scheme::Six,
            fill_cube: true,
            orbital: Orbital::default(),
        }
    }
}

impl Settings {
    /// Checks what every kind reads.
    pub(super) fn check(&self) -> Result<()> {
        if self.cells == 0 {
            return Err(Error::Option { option: "--cells", problem: "a mesh needs at least 1 cell".to_owned() });
        }
        if !(0.0..=MAX_JITTER).contains(&self.jitter) {
            let problem = format!("{} is not between 0 and {MAX_JITTER} spacings", self.jitter);
            return Err(Error::Option { option: "--jitter", problem });
        }
        // More than 32 bits can number are refused as that, once the kind of mesh says how many there will be.
        let cells = if self.cells <= LIMIT { self.cells } else { 0 };
        memory::check(|| format!("a mesh of {cells} cells"), cells.checked_mul(BYTES_PER_CELL))
    }
}

/// What a polyhedron takes while it is generated and written, and its faces: measured with `generate voronoi --cells 100000`, and as much
/// again.
pub(super) fn check_polyhedra(cells: u64) -> Result<()> {
    memory::check(|| format!("a mesh of {cells} polyhedra"), cells.checked_mul(4000))
}

/// What generating and writing takes at most: 83 to 86 MB for a million cells of any kind (`generate KIND --cells 1000000`).
const BYTES_PER_CELL: u64 = 80;

/// The number of entries a 32-bit index map can name, as `columns` has it.
const LIMIT: u64 = u32::MAX as u64 - 1;

/// Refuses more entries than 32 bits can number.
pub(super) fn check_len(column: &'static str, len: u128) -> Result<()> {
    if len > u128::from(LIMIT) {
        let len = u64::try_from(len).unwrap_or(u64::MAX);
        return Err(Error::TooLarge { column, len, limit: LIMIT });
    }
    Ok(())
}
