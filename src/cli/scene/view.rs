//! Where the picture is taken from: a camera file, a direction, or the default direction.

use cellfan::{Camera, Error, Region, Result};
use glam::DVec3;

use super::Arguments;

/// Azimuth and elevation where neither `--camera` nor `--view` is given, in degrees: three sides of a box are seen.
const DEFAULT_VIEW: [f64; 2] = [35.0, 20.0];

/// Width and height without `--size` or a camera file, in pixels: those of a camera file that does not say.
const DEFAULT_SIZE: [u32; 2] = [512, 512];

/// What the arguments say about the view.
pub(super) enum ViewSource {
    /// A camera file, read and checked.
    Camera(Camera),
    /// A direction and a size, from which the mesh is framed, and what is drawn of it.
    Framing { view: [f64; 2], size: [u32; 2], region: Option<Region> },
}

impl ViewSource {
    /// Reads what can be read before the mesh.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Camera`]; [`Error::Option`] where the region is no part of the picture.
    pub(super) fn load(arguments: &Arguments) -> Result<Self> {
        let Some(path) = &arguments.camera else {
            let view = arguments.view.unwrap_or(DEFAULT_VIEW);
            let size = arguments.size.unwrap_or(DEFAULT_SIZE);
            arguments.region.map(|region| region.check(size)).transpose()?;
            return Ok(Self::Framing { view, size, region: arguments.region });
        };
        let text = std::fs::read_to_string(path).map_err(|source| Error::Io { path: path.clone(), source })?;
        let mut camera = Camera::from_json(&text).map_err(|error| error.in_file(path))?;
        if let Some([width, height]) = arguments.size {
            (camera.width, camera.height) = (width, height);
        }
        camera.region = arguments.region.or(camera.region);
        camera.frame()?;
        Ok(Self::Camera(camera))
    }

    /// The size of the whole picture in pixels, and the part of it that is drawn.
    pub(super) fn size_and_region(&self) -> ([u32; 2], Region) {
        let (size, region) = match self {
            Self::Camera(camera) => ([camera.width, camera.height], camera.region),
            Self::Framing { size, region, .. } => (*size, *region),
        };
        (size, region.unwrap_or(Region::whole(size)))
    }

    /// The camera on what has these corners, and what to call it.
    ///
    /// # Errors
    /// [`Error::Camera`] where the mesh cannot be framed.
    pub(super) fn make(self, corners: &[DVec3]) -> Result<(Camera, String)> {
        let (camera, note) = match self {
            Self::Camera(camera) => (camera, "camera file".to_owned()),
            Self::Framing { view: [azimuth, elevation], size: [width, height], region } => {
                let camera = Camera { region, ..Camera::framing(corners, azimuth, elevation, width, height) };
                camera.frame()?;
                (camera, format!("view {azimuth},{elevation}"))
            }
        };
        let part = camera.region.map(|region| format!(", region {region} of {}x{}", camera.width, camera.height));
        Ok((camera, note + &part.unwrap_or_default()))
    }
}
