//! Generated meshes: analytic fields on grids of tetrahedra and on Delaunay meshes, the same bytes for the same seed.
//!
//! In: a [`Kind`] and [`Settings`] (how many cells, which seed). Out: [`TetMesh`] in the unit cube, or a [`CellMesh`](crate::columns::CellMesh)
//! of polyhedra ([`honeycomb`], [`voronoi`]), with the point
//! array `value` and the cell array `cell_value` (the field at the cell's centroid); every cell has a volume and is
//! positive. To add one: a file with its field as a function of a point, a [`Kind`] and its line in [`generate`]. The
//! field is sampled in parallel; elementary functions come from `libm`, so no platform changes a digit.

mod buckyball;
mod delaunay;
mod field;
mod grid;
mod hilbert;
mod honeycomb;
pub(crate) mod noise;
mod orbital;
mod phenomena;
mod random;
mod settings;
mod tets;
mod triangulation;
mod volume;
mod voronoi;

pub use buckyball::{Buckyball, buckyball};
pub use delaunay::delaunay;
pub use honeycomb::honeycomb;
pub use orbital::{Orbital, orbital};
pub use phenomena::{CellShape, Phenomenon, PhenomenonSettings, phenomenon};
pub use settings::{MAX_JITTER, Scheme, Settings};
pub use tets::{marschner_lobb, tets};
pub use triangulation::tetrahedralize;
pub use volume::{SampleType, Signal, volume};
pub use voronoi::voronoi;

use std::fmt;
use std::str::FromStr;

use field::GridSource;
use grid::Lattice;

use crate::columns::{CellSource, TetMesh};
use crate::error::{Error, Result};

/// What can be generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A jittered grid of tetrahedra with the [`marschner_lobb`] signal.
    Tets,
    /// The electron density of C60 ([`Buckyball`]) on such a grid.
    Buckyball,
    /// The density of a hydrogen [`Orbital`] on such a grid.
    Orbital,
    /// The Delaunay mesh of random points with the [`marschner_lobb`] signal.
    Delaunay,
}

impl Kind {
    /// All kinds, in the order in which help lists them.
    pub const ALL: [Self; 4] = [Self::Tets, Self::Buckyball, Self::Orbital, Self::Delaunay];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tets => "tets",
            Self::Buckyball => "buckyball",
            Self::Orbital => "orbital",
            Self::Delaunay => "delaunay",
        }
    }

    /// What it is, in a line of help.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Tets => "jittered grid of tetrahedra, Marschner-Lobb signal",
            Self::Buckyball => "electron density of C60, Gaussians at its 60 atoms",
            Self::Orbital => "density of a hydrogen orbital n, l, m",
            Self::Delaunay => "Delaunay mesh of random points, Marschner-Lobb signal",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Kind {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| Error::Option {
            option: "KIND",
            problem: format!("there is no {text:?}; choose one of: {}", Self::ALL.map(Self::name).join(", ")),
        })
    }
}

/// Generates a mesh in the unit cube: the same bytes for the same settings, on any number of threads.
///
/// ```
/// # use cellfan::generate::{Kind, Settings, generate};
/// let mesh = generate(Kind::Tets, &Settings { cells: 1000, ..Settings::default() })?;
/// assert_eq!(mesh.tets.len(), 6 * 6 * 6 * 6); // 5 boxes along an edge would make 750
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// [`Error::Option`] where a setting is out of range, [`Error::TooLarge`] where 32 bits cannot number the cells.
pub fn generate(kind: Kind, settings: &Settings) -> Result<TetMesh> {
    match kind {
        Kind::Tets => tets(settings),
        Kind::Buckyball => buckyball(settings),
        Kind::Orbital => orbital(settings),
        Kind::Delaunay => delaunay(settings),
    }
}

/// As [`generate`], but cells and values are made when they are asked for, where the kind allows it (all but
/// [`Kind::Delaunay`]): for meshes larger than memory, of which only the points are kept.
///
/// ```
/// # use cellfan::generate::{Kind, Settings, source};
/// let source = source(Kind::Tets, &Settings { cells: 1000, ..Settings::default() })?;
/// assert_eq!((source.tets(), source.points().len()), (1296, 343));
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// As [`generate`].
pub fn source(kind: Kind, settings: &Settings) -> Result<Box<dyn CellSource>> {
    let field: field::Field = match kind {
        Kind::Tets => Box::new(marschner_lobb),
        Kind::Buckyball => buckyball::field(),
        Kind::Orbital => orbital::field(settings)?,
        Kind::Delaunay => return Ok(Box::new(delaunay(settings)?)),
    };
    Ok(Box::new(GridSource::new(Lattice::new(settings)?, field)))
}

#[cfg(test)]
mod tests;
