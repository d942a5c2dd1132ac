//! `DepthImage`: a picture that knows how far away each of its pixels is, to be composited with others by depth.

use std::path::Path;

use super::zbuffer::allocate;
use super::{ByteOrder, Image, Picture, ZBuffer, exr, read};
use crate::atomic::write_atomically;
use crate::camera::{Camera, Region};
use crate::error::{Error, Result, VolCondition};

/// A picture with a depth for each pixel.
///
/// Depth is view depth, along the view axis and not along the ray, in world units, as all depths here (a point at `eye + w·forward` and
/// aside has depth w). What has a depth is opaque: nothing behind it shows. Where the depth is infinite nothing ends the ray, and the
/// colour lies behind everything, as a background or as what another program drew of a volume.
///
/// [`Scene::set_external`](crate::Scene::set_external) composites a volume with one; [`Rendered::depth_image`](crate::Rendered::depth_image)
/// is one, so that pictures can be chained.
///
/// ```
/// use cellfan::image::{DepthImage, Image};
/// let wall = DepthImage::new(Image::filled(2, 1, [0.5, 0.5, 0.5, 1.0]), vec![3.0, f32::INFINITY])?;
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("wall.exr");
/// wall.save(&path, None)?;
/// assert_eq!(DepthImage::open(&path, None)?, wall);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DepthImage {
    /// Linear premultiplied RGBA.
    pub image: Image,
    /// View depth of each pixel in world units, row by row; infinite where there is nothing.
    pub depth_world: Vec<f32>,
}

/// A file format of pictures with depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// Colour and depth: channels R, G, B, A, Z.
    Exr,
    /// Depth alone: Vol's.
    ZBuffer,
}

impl Format {
    fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("vol" | "z" | "zbuf") => Ok(Self::ZBuffer),
            _ => {
                let problem = "a picture with depth is .exr (colour and depth) or .vol (a z-buffer)".to_owned();
                Err(Error::Encode { path: path.to_owned(), problem })
            }
        }
    }
}

impl DepthImage {
    /// Depths from here on are nothing: what files without an infinity write instead.
    pub const NOTHING: f32 = 1e30;

    /// A picture and its depths. Where a pixel is transparent it is nothing, however near: programs write some depth there.
    ///
    /// # Errors
    /// [`Error::Vol`] (102) where there are not as many depths as pixels, (100) where one is no number.
    pub fn new(image: Image, depth_world: Vec<f32>) -> Result<Self> {
        let (width, height, len) = (image.width, image.height, depth_world.len());
        if image.pixels.len() != len || width as usize * height as usize != len || len == 0 {
            let problem = format!("{len} depths for a picture of {width}x{height} pixels");
            return Err(Error::Vol { condition: VolCondition::Size, problem });
        }
        if let Some(i) = depth_world.iter().position(|depth| depth.is_nan()) {
            let problem = format!("the depth of pixel ({}, {}) is no number", i % width as usize, i / width as usize);
            return Err(Error::Vol { condition: VolCondition::Read, problem });
        }
        let is_nothing = |pixel: &[f32; 4]| pixel.iter().all(|channel| *channel == 0.0);
        let known = |(depth, pixel)| if is_nothing(pixel) { f32::INFINITY } else { Self::known_depth(depth) };
        let depth_world = depth_world.into_iter().zip(&image.pixels).map(known).collect();
        Ok(Self { image, depth_world })
    }

    /// A depth of a file.
    pub(super) fn known_depth(depth: f32) -> f32 {
        if depth < Self::NOTHING { depth } else { f32::INFINITY }
    }

    /// Reads an EXR with a channel Z, or a z-buffer file (told by its first four bytes), whose colours are those of the picture `colors`
    /// (.png, .exr), or black where there is a depth. With `colors` an EXR gives its depth alone.
    ///
    /// Of an EXR the channels R, G, B, A and Z are read, or the first whose names end so after a dot (`ViewLayer.Depth.Z`); no A is opaque. A
    /// PNG is sRGB with straight alpha.
    ///
    /// # Errors
    /// [`Error::Vol`]: 100 to 105 of the depths; 106 where there is no memory for the colours; 102 where `colors` has another size.
    /// [`Error::Malformed`] and [`Error::Unsupported`] where a file is damaged, or an EXR has no depth.
    pub fn open(path: impl AsRef<Path>, colors: Option<&Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes = read::bytes(path)?;
        let colors = colors.map(read::image).transpose()?;
        Self::decode(&bytes, path, colors)
    }

    /// Reads a file that is in memory, with colours of another.
    ///
    /// # Errors
    /// As [`DepthImage::open`].
    pub fn decode(bytes: &[u8], path: &Path, colors: Option<Image>) -> Result<Self> {
        let named = |error: Error| error.in_file(path);
        let (image, depth_world) = if read::is_exr(bytes) {
            let (image, depth) = exr::decode(bytes, path)?;
            let missing = || Error::Unsupported {
                path: path.to_owned(),
                what: "an EXR without a depth channel Z".to_owned(),
                advice: "write one with depth, or give the depth as another file".to_owned(),
            };
            (colors.unwrap_or(image), depth.ok_or_else(missing)?)
        } else {
            let ZBuffer { width, height, depth_world, .. } = ZBuffer::read(bytes).map_err(named)?;
            let image = if let Some(colors) = colors {
                colors
            } else {
                let what = || format!("a picture of {width}x{height} pixels");
                allocate(VolCondition::ImageMemory, what, 16 * u64::from(width) * u64::from(height)).map_err(named)?;
                let black = |depth: &f32| if depth.is_finite() { [0.0, 0.0, 0.0, 1.0] } else { [0.0; 4] };
                Image { width, height, pixels: depth_world.iter().map(black).collect() }
            };
            if [image.width, image.height] != [width, height] {
                let problem =
                    format!("a z-buffer of {width}x{height} pixels for a picture of {}x{}", image.width, image.height);
                return Err(named(Error::Vol { condition: VolCondition::Size, problem }));
            }
            (image, depth_world)
        };
        Self::new(image, depth_world).map_err(named)
    }

    /// Whether pictures with depth can be written to `path`, of that size.
    ///
    /// # Errors
    /// [`Error::Encode`] for another extension than .exr, .vol, .z and .zbuf, [`Error::Vol`] (102) where it is too large for a z-buffer.
    pub fn check_output(path: impl AsRef<Path>, size_px: [u32; 2]) -> Result<()> {
        let path = path.as_ref();
        if Format::from_path(path)? == Format::ZBuffer {
            ZBuffer::check_size(size_px).map_err(|error| error.in_file(path))?;
        }
        crate::atomic::check_target(path)
    }

    /// Writes .exr (channels R, G, B, A and Z, to the bit), or .vol, .z and .zbuf: the depths as a z-buffer file, little-endian, with the
    /// matrices of `camera`, or zeros.
    ///
    /// # Errors
    /// Those of [`DepthImage::check_output`]; [`Error::Io`].
    pub fn save(&self, path: impl AsRef<Path>, camera: Option<&Camera>) -> Result<()> {
        let path = path.as_ref();
        match Format::from_path(path)? {
            Format::Exr => {
                Picture::check(&self.image, path)?;
                write_atomically(path, |writer| exr::encode_with_depth(self, path, writer))
            }
            Format::ZBuffer => {
                let z_buffer = match camera {
                    Some(camera) => ZBuffer::of(self, camera)?,
                    None => ZBuffer {
                        width: self.image.width,
                        height: self.image.height,
                        screen_from_world: [[0.0; 4]; 4],
                        view_from_world: [[0.0; 4]; 4],
                        depth_world: self.depth_world.clone(),
                    },
                };
                z_buffer.save(path, ByteOrder::Little)
            }
        }
    }

    /// Its pixels in `region` of a picture of `size_px`, of which it may be the whole or just that part.
    ///
    /// # Errors
    /// [`Error::Vol`] (102) where it is neither.
    pub fn part(&self, size_px: [u32; 2], region: Region) -> Result<DepthImagePart<'_>> {
        let [width, height] = [self.image.width, self.image.height];
        let first_px = match [width, height] {
            size if size == size_px => [region.x0, region.y0],
            size if size == region.size_px() => [0, 0],
            _ => {
                let [w, h] = size_px;
                let or_region = if region.size_px() == size_px {
                    String::new()
                } else {
                    let [w, h] = region.size_px();
                    format!(", or {w}x{h} as the region")
                };
                let problem = format!(
                    "the external picture has {width}x{height} pixels; it must have {w}x{h} as the one that is drawn{or_region}"
                );
                return Err(Error::Vol { condition: VolCondition::Size, problem });
            }
        };
        Ok(DepthImagePart { of: self, first_px, region })
    }
}

/// The pixels of a [`DepthImage`] that are in a region of the whole picture.
#[derive(Clone, Copy, Debug)]
pub struct DepthImagePart<'a> {
    of: &'a DepthImage,
    /// Where the region's first pixel is.
    first_px: [u32; 2],
    region: Region,
}

impl DepthImagePart<'_> {
    /// The region, in the whole picture.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Colour and depth of the pixel in column `x` and row `y` of the region.
    ///
    /// # Panics
    /// Outside the region.
    pub fn pixel(&self, x: u32, y: u32) -> ([f32; 4], f32) {
        let [width, height] = self.region.size_px();
        assert!(x < width && y < height, "pixel ({x}, {y}) of a region of {width}x{height}");
        let [first_x, first_y] = self.first_px;
        let i = (first_y + y) as usize * self.of.image.width as usize + (first_x + x) as usize;
        (self.of.image.pixels[i], self.of.depth_world[i])
    }
}
