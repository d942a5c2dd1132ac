//! Gaseous phenomena (Röttger and Ertl 2003, figures 2 and 6): light-emitting gas in tetrahedra, prisms or hexahedra.
//!
//! In: a [`Phenomenon`] and [`PhenomenonSettings`] (how many cells, which shape, seed, time). Out: a [`CellMesh`] with the point array `value`,
//! the emission from 0 to 1, and `cell_value`, the mean at a cell's corners. Cells that emit nothing are left out, as in the paper.
//! To add one: a file with its place and emission as functions of block coordinates, a [`Phenomenon`] and its line in [`phenomenon`].

mod aurora;
mod block;
mod camp_fire;
mod laser_cone;
mod search_light;

use std::fmt;
use std::str::FromStr;

use crate::columns::CellMesh;
use crate::error::{Error, Result};
use crate::memory;

/// What glows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phenomenon {
    /// A beam whose light falls off with the square of the distance; it sweeps with time.
    SearchLight,
    /// A thin cone of light in drifting smoke.
    LaserCone,
    /// A flame of rising Perlin noise.
    CampFire,
    /// Polar light: curtains that hang from a ceiling down to where particles penetrate.
    Aurora,
}

/// What the cells are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CellShape {
    /// Six a box.
    Tetrahedra,
    /// Two a box: wedges.
    Prisms,
    /// One a box.
    #[default]
    Hexahedra,
}

/// What shapes a phenomenon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhenomenonSettings {
    /// Cells wanted; there are the fewest boxes that give as many, those included that are left out.
    pub cells: u64,
    /// What the cells are.
    pub shape: CellShape,
    /// Seed of everything random.
    pub seed: u64,
    /// When, in seconds.
    pub time_s: f64,
}

impl Default for PhenomenonSettings {
    fn default() -> Self {
        Self { cells: 4_000, shape: CellShape::default(), seed: 1, time_s: 0.0 }
    }
}

impl Phenomenon {
    /// All, in the order in which help lists them.
    pub const ALL: [Self; 4] = [Self::SearchLight, Self::LaserCone, Self::CampFire, Self::Aurora];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SearchLight => "search-light",
            Self::LaserCone => "laser-cone",
            Self::CampFire => "camp-fire",
            Self::Aurora => "aurora",
        }
    }

    /// What it is, in a line of help.
    pub const fn description(self) -> &'static str {
        match self {
            Self::SearchLight => "beam of light that falls off with the square of the distance and sweeps (--time)",
            Self::LaserCone => "thin cone of light in drifting smoke (--time)",
            Self::CampFire => "flame of rising Perlin noise (--time)",
            Self::Aurora => "polar light, curtains that fold (--time)",
        }
    }
}

impl fmt::Display for Phenomenon {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Phenomenon {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| Error::Option {
            option: "KIND",
            problem: format!("there is no {text:?}; choose one of: {}", Self::ALL.map(Self::name).join(", ")),
        })
    }
}

/// Generates a phenomenon at a time: the same bytes for the same settings, on any number of threads.
///
/// ```
/// # use cellfan::generate::{CellShape, Phenomenon, PhenomenonSettings, phenomenon};
/// let settings = PhenomenonSettings { cells: 3_375, shape: CellShape::Hexahedra, ..Default::default() };
/// let fire = phenomenon(Phenomenon::CampFire, &settings)?;
/// // The paper's 16×16×16 points; boxes where nothing burns are left out.
/// assert_eq!(fire.points.len(), 16 * 16 * 16);
/// assert!(fire.hexahedra.len() < 3_375);
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// [`Error::Option`] where a setting is out of range, [`Error::TooLarge`] where 32 bits cannot number the cells.
pub fn phenomenon(kind: Phenomenon, settings: &PhenomenonSettings) -> Result<CellMesh> {
    settings.check()?;
    match kind {
        Phenomenon::SearchLight => search_light::search_light(settings),
        Phenomenon::LaserCone => laser_cone::laser_cone(settings),
        Phenomenon::CampFire => camp_fire::camp_fire(settings),
        Phenomenon::Aurora => aurora::aurora(settings),
    }
}

/// What generating and writing a cell takes at most.
const BYTES_PER_CELL: u64 = 160;

impl PhenomenonSettings {
    fn check(&self) -> Result<()> {
        if self.cells == 0 {
            return Err(Error::Option { option: "--cells", problem: "a mesh needs at least 1 cell".to_owned() });
        }
        if !self.time_s.is_finite() || self.time_s.abs() > 1e6 {
            let problem = format!("{} is not within a million seconds", self.time_s);
            return Err(Error::Option { option: "--time", problem });
        }
        let limit = u64::from(u32::MAX) - 1;
        if self.cells > limit {
            return Err(Error::TooLarge { column: "cells", len: self.cells, limit });
        }
        memory::check(|| format!("a mesh of {} cells", self.cells), self.cells.checked_mul(BYTES_PER_CELL))
    }
}

#[cfg(test)]
mod tests;
