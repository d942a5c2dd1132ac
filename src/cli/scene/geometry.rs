//! Opaque geometry of the mesh and of other files: its arguments, and what the library takes.

use std::path::{Path, PathBuf};

use cellfan::geometry::{GeometryOptions, SurfaceFaces, TriangleMesh};
use cellfan::render::VolumeScene;
use cellfan::{Scene, io};
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
    /// Draw the triangles of other files (.stl, .ply, .obj) into the volume, opaque, from both sides, lit from the eye: in this colour,
    /// or in those of their vertices, or gray. Once for each file.
    #[arg(long, value_name = "FILE[=COLOR]", help_heading = "Geometry", value_parser = file_and_color)]
    mesh: Vec<FileAndColor>,
    /// Width of edges in pixels.
    #[arg(long, value_name = "PIXELS", help_heading = "Geometry", default_value = "1", value_parser = pixels, allow_hyphen_values = true)]
    line_px: f32,
    /// Side of points in pixels.
    #[arg(long, value_name = "PIXELS", help_heading = "Geometry", default_value = "3", value_parser = pixels, allow_hyphen_values = true)]
    point_px: f32,
}

/// A file of triangles, and the colour they are drawn in.
#[derive(Clone, Debug, PartialEq)]
struct FileAndColor {
    path: PathBuf,
    color: Option<Srgb>,
}

/// `FILE`, or `FILE=COLOR`; a file's name may have `=` in it where no colour follows.
fn file_and_color(text: &str) -> Result<FileAndColor, String> {
    let whole = || FileAndColor { path: text.into(), color: None };
    let Some((path, color)) = text.rsplit_once('=').filter(|(path, _)| !path.is_empty()) else { return Ok(whole()) };
    match srgb(color) {
        Ok(color) => Ok(FileAndColor { path: path.into(), color: Some(color) }),
        Err(_) if Path::new(text).exists() => Ok(whole()),
        Err(problem) => Err(format!("{problem} after FILE=")),
    }
}

/// Triangles that were read, and the colour they are drawn in, linear.
pub(super) struct ReadTriangles(Vec<(TriangleMesh, Option<[f32; 3]>)>);

impl ReadTriangles {
    /// Gives them to a scene.
    ///
    /// # Errors
    /// Those of [`Scene::add_triangles`].
    pub(super) fn give_to(&self, scene: &mut Scene) -> cellfan::Result<()> {
        self.0.iter().try_for_each(|(mesh, color)| scene.add_triangles(mesh, *color))
    }

    /// Gives them to the scene of a volume.
    ///
    /// # Errors
    /// Those of [`VolumeScene::add_triangles`].
    pub(super) fn give_to_volume(&self, scene: &mut VolumeScene) -> cellfan::Result<()> {
        self.0.iter().try_for_each(|(mesh, color)| scene.add_triangles(mesh, *color))
    }

    /// Whether there is none.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Geometry {
    /// Reads the files of triangles.
    ///
    /// # Errors
    /// Those of [`io::open_triangles`].
    pub(super) fn read(&self) -> cellfan::Result<ReadTriangles> {
        let read = |file: &FileAndColor| Ok((io::open_triangles(&file.path)?, file.color.map(Srgb::linear)));
        self.mesh.iter().map(read).collect::<cellfan::Result<_>>().map(ReadTriangles)
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_and_its_color() {
        let of = |text: &str| file_and_color(text).map(|file| (file.path, file.color.map(|color| color.0)));
        assert_eq!(of("a.stl"), Ok(("a.stl".into(), None)));
        assert_eq!(of("a=b.stl=#ff0000"), Ok(("a=b.stl".into(), Some([1.0, 0.0, 0.0]))));
        assert_eq!(of("a.ply=0,1,0"), Ok(("a.ply".into(), Some([0.0, 1.0, 0.0]))));
        assert!(of("a.stl=red").is_err_and(|problem| problem.contains("after FILE=")));
    }
}
