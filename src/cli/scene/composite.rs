//! A picture of another program that the volume is composited with by depth: its arguments, and what is read of them.

use std::path::PathBuf;
use std::sync::Arc;

use cellfan::Result;
use cellfan::image::DepthImage;
use clap::Args;

use super::view::ViewSource;

#[derive(Args)]
#[group(id = "external-picture")]
#[expect(clippy::struct_field_names, reason = "the options' names")]
pub(in crate::cli) struct Composite {
    /// Composite the volume with this picture, drawn from the same place and of the same size, by depth: an .exr with a channel Z, or a
    /// z-buffer (.vol) as Vol and `RenderMan` write them. Depths are along the view axis, in world units.
    #[arg(long, value_name = "IMAGE", help_heading = "Geometry", conflicts_with = "frames")]
    composite: Option<PathBuf>,
    /// The colours of that picture, as .png or .exr [default: those of the .exr; black where there is a depth].
    #[arg(long, value_name = "PICTURE", help_heading = "Geometry", requires = "composite")]
    composite_color: Option<PathBuf>,
    /// Also write colour and depth of what is opaque, to be composited with others: .exr (R, G, B, A, Z), or .vol, the z-buffer alone.
    #[arg(long, value_name = "OUT", help_heading = "Picture", conflicts_with = "frames")]
    pub(in crate::cli) depth: Option<PathBuf>,
}

impl Composite {
    /// Reads the picture; checks it, and the depth that is to be written, against the size that is drawn.
    ///
    /// # Errors
    /// Those of [`DepthImage::open`], [`DepthImage::part`] and [`DepthImage::check_output`].
    pub(super) fn read(&self, view: &ViewSource) -> Result<Option<Arc<DepthImage>>> {
        let (size_px, region) = view.size_and_region();
        if let Some(path) = &self.depth {
            DepthImage::check_output(path, region.size_px())?;
        }
        let Some(path) = &self.composite else { return Ok(None) };
        let picture = DepthImage::open(path, self.composite_color.as_deref())?;
        picture.part(size_px, region).map_err(|error| error.in_file(path))?;
        Ok(Some(Arc::new(picture)))
    }
}
