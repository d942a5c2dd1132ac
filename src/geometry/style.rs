//! What of a mesh is drawn as opaque geometry, and how.

use std::str::FromStr;

use crate::error::{Error, Result};

/// Which sides of a surface are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceFaces {
    /// Those that face away from the eye: the far walls, with the volume in front of them.
    #[default]
    Back,
    /// All: the near walls hide the volume.
    All,
}

impl SurfaceFaces {
    /// Both, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Back, Self::All];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Back => "back",
            Self::All => "all",
        }
    }
}

impl FromStr for SurfaceFaces {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|faces| faces.name() == name);
        let problem = || format!("there is no {name:?}; choose one of: back, all");
        found.ok_or_else(|| Error::Option { option: "--surface-faces", problem: problem() })
    }
}

/// Opaque geometry in the volume; the colours are linear RGB from 0 to 1, none draws nothing.
///
/// It is drawn to colour and depth, and every cell is cut at its depth in every pixel. Behind what lies in front of it, light models
/// show its colour as their background, and opacity is 1; maximum intensity shows it where no cell lies in front; in the absorption model
/// it lets no light through: intensity is 0, and an optical depth ends at it.
///
/// ```
/// # use cellfan::geometry::GeometryOptions;
/// let edges = GeometryOptions { edges: Some([1.0; 3]), ..GeometryOptions::default() };
/// assert!(edges.is_any() && !GeometryOptions::default().is_any());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeometryOptions {
    /// The boundary surface, lit by a lamp at the eye, on both sides.
    pub surface: Option<[f32; 3]>,
    /// Which of its sides.
    pub surface_faces: SurfaceFaces,
    /// All edges of all cells, but for the diagonals that cut their faces.
    pub edges: Option<[f32; 3]>,
    /// The points that cells use.
    pub points: Option<[f32; 3]>,
    /// Width of an edge in pixels, 1 to [`GeometryOptions::MAX_PX`].
    pub line_px: f32,
    /// Side of a point, a square, in pixels, 1 to [`GeometryOptions::MAX_PX`].
    pub point_px: f32,
}

impl Default for GeometryOptions {
    fn default() -> Self {
        Self::NONE
    }
}

impl GeometryOptions {
    /// The widest edge and the largest point in pixels.
    pub const MAX_PX: f32 = 64.0;

    /// Nothing is drawn; edges would be 1 pixel wide, points 3.
    pub const NONE: Self = Self {
        surface: None,
        surface_faces: SurfaceFaces::Back,
        edges: None,
        points: None,
        line_px: 1.0,
        point_px: 3.0,
    };

    /// Whether anything is drawn.
    pub fn is_any(&self) -> bool {
        self.surface.or(self.edges).or(self.points).is_some()
    }

    /// Whether it can be drawn.
    ///
    /// # Errors
    /// [`Error::Option`] where a width or a colour is out of range.
    pub fn check(&self) -> Result<()> {
        let range = 1.0..=Self::MAX_PX;
        for (option, px) in [("--line-px", self.line_px), ("--point-px", self.point_px)] {
            if !range.contains(&px) {
                let problem = format!("{px}; from 1 to {} pixels", Self::MAX_PX);
                return Err(Error::Option { option, problem });
            }
        }
        for (option, color) in [("--surface", self.surface), ("--edges", self.edges), ("--points", self.points)] {
            if let Some(color) = color.filter(|color| !color.iter().all(|channel| (0.0..=1.0).contains(channel))) {
                return Err(Error::Option { option, problem: format!("{color:?}; each channel from 0 to 1") });
            }
        }
        Ok(())
    }
}
