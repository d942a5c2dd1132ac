//! Opaque geometry of the mesh: its arguments, and what the library takes.

use cellfan::geometry::{GeometryOptions, SurfaceFaces};
use clap::Args;

use crate::cli::arguments::{Srgb, one_of, pixels, srgb};

#[derive(Args)]
#[group(id = "geometry")]
pub(in crate::cli) struct Geometry {
    /// Draw the mesh's boundary surface into the volume, opaque, lit from the eye, in this colour: #rrggbb or R,G,B from 0 to 1. What
    /// lies behind it does not show.
    #[arg(long, value_name = "COLOR", help_heading = "Geometry", num_args = 0..=1, require_equals = true, default_missing_value = "#b4b8c0", value_parser = srgb)]
    surface: Option<Srgb>,
    /// Which sides of the surface: those that face away from the eye, with the volume in front of them, or all, which hide it.
    #[arg(long, value_name = "SIDES", help_heading = "Geometry", default_value = "back", value_parser = one_of(SurfaceFaces::ALL.map(|faces| (faces.name(), faces))))]
    surface_faces: SurfaceFaces,
    /// Draw the edges of all cells in this colour.
    #[arg(long, value_name = "COLOR", help_heading = "Geometry", num_args = 0..=1, require_equals = true, default_missing_value = "#404852", value_parser = srgb)]
    edges: Option<Srgb>,
    /// Draw the points of all cells in this colour.
    #[arg(long, value_name = "COLOR", help_heading = "Geometry", num_args = 0..=1, require_equals = true, default_missing_value = "#ffb000", value_parser = srgb)]
    points: Option<Srgb>,
    /// Width of edges in pixels.
    #[arg(long, value_name = "PIXELS", help_heading = "Geometry", default_value = "1", value_parser = pixels, allow_hyphen_values = true)]
    line_px: f32,
    /// Side of points in pixels.
    #[arg(long, value_name = "PIXELS", help_heading = "Geometry", default_value = "3", value_parser = pixels, allow_hyphen_values = true)]
    point_px: f32,
}

impl Geometry {
    /// What the library takes.
    pub(super) fn options(&self) -> GeometryOptions {
        let linear = |color: Option<Srgb>| color.map(Srgb::linear);
        GeometryOptions {
            surface: linear(self.surface),
            surface_faces: self.surface_faces,
            edges: linear(self.edges),
            points: linear(self.points),
            line_px: self.line_px,
            point_px: self.point_px,
        }
    }
}
