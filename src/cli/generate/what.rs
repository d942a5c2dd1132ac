//! What can be generated, by name.

use std::fmt;
use std::str::FromStr;

use cellfan::Error;
use cellfan::generate::{Kind, Phenomenon};

/// What is generated.
#[derive(Clone, Copy, Debug)]
pub(super) enum What {
    /// An analytic field on a mesh of tetrahedra.
    Mesh(Kind),
    /// Light-emitting gas.
    Phenomenon(Phenomenon),
    /// Truncated octahedra.
    Honeycomb,
    /// The Voronoi cells of random points.
    Voronoi,
    /// A regular grid of samples.
    Volume,
}

impl What {
    /// All, in the order in which help lists them.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        Kind::ALL.into_iter().map(Self::Mesh).chain(Phenomenon::ALL.into_iter().map(Self::Phenomenon)).chain([
            Self::Honeycomb,
            Self::Voronoi,
            Self::Volume,
        ])
    }

    /// Its name on the command line.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Mesh(kind) => kind.name(),
            Self::Phenomenon(phenomenon) => phenomenon.name(),
            Self::Honeycomb => "honeycomb",
            Self::Voronoi => "voronoi",
            Self::Volume => "volume",
        }
    }

    /// What it is, in a line of help.
    pub(super) const fn description(self) -> &'static str {
        match self {
            Self::Mesh(kind) => kind.description(),
            Self::Phenomenon(phenomenon) => phenomenon.description(),
            Self::Honeycomb => "truncated octahedra, Marschner-Lobb signal, as .vtu",
            Self::Voronoi => "Voronoi cells of random points, Marschner-Lobb signal, as .vtu",
            Self::Volume => "regular grid of samples of a signal, as .nrrd",
        }
    }
}

impl fmt::Display for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for What {
    type Err = Error;

    fn from_str(text: &str) -> cellfan::Result<Self> {
        Self::all().find(|what| what.name() == text).ok_or_else(|| Error::Option {
            option: "KIND",
            problem: format!(
                "there is no {text:?}; choose one of: {}",
                Self::all().map(Self::name).collect::<Vec<_>>().join(", ")
            ),
        })
    }
}
