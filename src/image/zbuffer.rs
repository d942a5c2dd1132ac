//! `ZBuffer`: the z-buffer files of Vol (Amidon 1995, appendix B), which are those of `RenderMan`.
//!
//! ```text
//! magic number 0x2F0867AB          4 bytes; the order of its bytes is that of the file
//! width, height                    2 bytes each
//! matrix 1, view and perspective   16 × 4 bytes, row by row, for points as rows from the left
//! matrix 2, view                   16 × 4 bytes
//! depth values                     width × height × 4 bytes, row by row
//! ```

use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

use super::DepthImage;
use crate::atomic::{io_at, write_atomically};
use crate::camera::Camera;
use crate::error::{Error, Result, VolCondition};
use crate::memory;

/// A z-buffer with the matrices of its camera.
///
/// What Vol compares is view depth (its section on compositing), so that the values of a file are depths along the view axis in world
/// units, as everywhere here: see [`view_depth`](Self::view_depth) for depths of the screen. Rows are from the top. A file has no
/// colours, and no word for nothing: values from [`DepthImage::NOTHING`] on are nothing, and are written as that.
///
/// ```
/// use cellfan::image::{ByteOrder, ZBuffer};
/// let depths = ZBuffer { width: 3, height: 1, screen_from_world: [[0.0; 4]; 4], view_from_world: [[0.0; 4]; 4],
///                        depth_world: vec![2.0, 0.5, f32::INFINITY] };
/// let mut bytes = Vec::new();
/// depths.write(&mut bytes, ByteOrder::Big)?;
/// assert_eq!(bytes.len(), 4 + 2 * 2 + 2 * 64 + 3 * 4);
/// assert_eq!(bytes[..8], [0x2f, 0x08, 0x67, 0xab, 0, 3, 0, 1]);
/// assert_eq!(ZBuffer::read(&bytes[..]).unwrap(), depths);
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ZBuffer {
    /// Width in pixels, at most [`ZBuffer::MAX_SIDE`].
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Matrix 1, the product of the view and perspective matrices.
    pub screen_from_world: [[f32; 4]; 4],
    /// Matrix 2, the view matrix.
    pub view_from_world: [[f32; 4]; 4],
    /// View depth of each pixel in world units, row by row; infinite where there is nothing.
    pub depth_world: Vec<f32>,
}

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ByteOrder {
    /// As today's processors have it.
    #[default]
    Little,
    /// As the machines of the paper had it.
    Big,
}

impl ByteOrder {
    fn u32(self, bytes: [u8; 4]) -> u32 {
        if self == Self::Little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) }
    }

    fn i16(self, bytes: [u8; 2]) -> i16 {
        if self == Self::Little { i16::from_le_bytes(bytes) } else { i16::from_be_bytes(bytes) }
    }

    /// `N` bytes, least first, in this order.
    fn ordered<const N: usize>(self, mut bytes: [u8; N]) -> [u8; N] {
        if self == Self::Big {
            bytes.reverse();
        }
        bytes
    }
}

/// Bytes before the depths.
const HEADER: usize = 4 + 2 * 2 + 2 * 64;

/// Pixels that are read or written at a time.
const PORTION: usize = 1 << 14;

fn vol(condition: VolCondition, problem: impl Into<String>) -> Error {
    Error::Vol { condition, problem: problem.into() }
}

impl ZBuffer {
    /// What every file begins with.
    pub const MAGIC: u32 = 0x2F08_67AB;

    /// Largest side in pixels: the format has 16 bits with a sign.
    pub const MAX_SIDE: u32 = i16::MAX as u32;

    /// The order of the bytes of a file that begins so, if it is a z-buffer.
    pub fn recognise(head: &[u8]) -> Option<ByteOrder> {
        let magic: [u8; 4] = head.get(..4)?.try_into().ok()?;
        [ByteOrder::Little, ByteOrder::Big].into_iter().find(|order| order.u32(magic) == Self::MAGIC)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::Vol`] with the conditions 100 to 105, with the file's name.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let named = |error: Error| error.in_file(path);
        let file =
            File::open(path).map_err(|error| named(vol(VolCondition::Open, format!("cannot be opened: {error}"))))?;
        Self::read(BufReader::new(file)).map_err(named)
    }

    /// Reads a file's bytes; what follows the depths is left.
    ///
    /// # Errors
    /// [`Error::Vol`] with the conditions 100 to 104.
    pub fn read(mut reader: impl Read) -> Result<Self> {
        let mut header = [0; HEADER];
        let got = fill(&mut reader, &mut header)?;
        let wrong = || vol(VolCondition::Magic, "no z-buffer: it does not begin with 0x2F0867AB, in either byte order");
        let Some(order) = Self::recognise(&header[..got]) else {
            // Less than four bytes may be the beginning of the number.
            let is_cut = got < 4
                && [ByteOrder::Little, ByteOrder::Big]
                    .iter()
                    .any(|order| order.ordered(Self::MAGIC.to_le_bytes()).starts_with(&header[..got]));
            return Err(if is_cut { ends_early(0, 0) } else { wrong() });
        };
        if got < HEADER {
            return Err(ends_early(0, 0));
        }
        let side = |at: usize| order.i16([header[at], header[at + 1]]);
        let [width, height] = [side(4), side(6)];
        let (Ok(width @ 1..), Ok(height @ 1..)) = (u32::try_from(width), u32::try_from(height)) else {
            return Err(vol(VolCondition::Size, format!("a z-buffer of {width}x{height} pixels")));
        };
        let number =
            |at: usize| f32::from_bits(order.u32([header[at], header[at + 1], header[at + 2], header[at + 3]]));
        let matrix = |at: usize| std::array::from_fn(|i| std::array::from_fn(|k| number(at + 16 * i + 4 * k)));
        let (screen_from_world, view_from_world) = (matrix(8), matrix(72));
        let depth_world = read_depths(reader, order, [width, height])?;
        Ok(Self { width, height, screen_from_world, view_from_world, depth_world })
    }

    /// Writes it.
    ///
    /// # Errors
    /// What the writer says.
    ///
    /// # Panics
    /// Where a side is larger than [`ZBuffer::MAX_SIDE`], or the depths are not as many as the sides say.
    pub fn write(&self, mut writer: impl Write, order: ByteOrder) -> std::io::Result<()> {
        assert!(self.width.max(self.height) <= Self::MAX_SIDE, "a z-buffer of {}x{}", self.width, self.height);
        assert_eq!(self.width as usize * self.height as usize, self.depth_world.len(), "depths of a z-buffer");
        writer.write_all(&order.ordered(Self::MAGIC.to_le_bytes()))?;
        for side in [self.width, self.height] {
            writer.write_all(&order.ordered((side as u16).to_le_bytes()))?;
        }
        for number in [self.screen_from_world, self.view_from_world].as_flattened().as_flattened() {
            writer.write_all(&order.ordered(number.to_le_bytes()))?;
        }
        for portion in self.depth_world.chunks(PORTION) {
            let bytes: Vec<[u8; 4]> =
                portion.iter().map(|depth| order.ordered(depth.min(DepthImage::NOTHING).to_le_bytes())).collect();
            writer.write_all(bytes.as_flattened())?;
        }
        Ok(())
    }

    /// Writes it as a file, which appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Vol`] (102) where a side is larger than the format can say; [`Error::Io`].
    pub fn save(&self, path: impl AsRef<Path>, order: ByteOrder) -> Result<()> {
        let path = path.as_ref();
        Self::check_size([self.width, self.height]).map_err(|error| error.in_file(path))?;
        write_atomically(path, |writer| self.write(writer, order).map_err(io_at(path)))
    }

    /// Whether a picture of that size fits into the format.
    ///
    /// # Errors
    /// [`Error::Vol`] (102).
    pub fn check_size([width, height]: [u32; 2]) -> Result<()> {
        if width.max(height) <= Self::MAX_SIDE {
            return Ok(());
        }
        let problem = format!("a z-buffer file holds no {width}x{height} pixels; write .exr, or a --region");
        Err(vol(VolCondition::Size, problem))
    }

    /// The view depth of screen depth `screen`, from 0 at the near plane `near` to 1 at the far plane `far`: −d f / (z (f − d) − f).
    ///
    /// The files hold view depths; this is for those of programs that keep what their hardware compares.
    ///
    /// ```
    /// # use cellfan::image::ZBuffer;
    /// assert_eq!([0.0, 0.4, 1.0].map(|z| ZBuffer::view_depth(z, [4.0, 8.0])), [4.0, 5.0, 8.0]);
    /// ```
    pub fn view_depth(screen: f64, [near, far]: [f64; 2]) -> f64 {
        -near * far / (screen * (far - near) - far)
    }

    /// The z-buffer of a picture that `camera` shows; planes that the camera does not have are those of the nearest and the farthest pixel.
    ///
    /// # Errors
    /// Those of [`Camera::matrices`].
    pub(super) fn of(picture: &DepthImage, camera: &Camera) -> Result<Self> {
        let finite = picture.depth_world.iter().filter(|depth| depth.is_finite());
        let [nearest, farthest] =
            finite.fold([f64::INFINITY, 0.0], |[low, high], &w| [f64::min(low, w.into()), f64::max(high, w.into())]);
        let near = camera.near.unwrap_or(if nearest.is_finite() { nearest } else { 1.0 });
        let far = camera.far.unwrap_or(farthest);
        let far = if far > near { far } else { near + near.abs().max(1e-3) };
        let [screen_from_world, view_from_world] = camera.matrices([near, far])?;
        let (width, height, depth_world) = (picture.image.width, picture.image.height, picture.depth_world.clone());
        Ok(Self { width, height, screen_from_world, view_from_world, depth_world })
    }
}

fn ends_early(read: usize, expected: usize) -> Error {
    let problem = if expected == 0 {
        format!("it ends within its header of {HEADER} bytes")
    } else {
        format!("it ends after {read} of {expected} depths; the file is truncated")
    };
    vol(VolCondition::EndOfFile, problem)
}

/// Reads until the buffer is full or the file ends; how many bytes there were.
fn fill(reader: &mut impl Read, buffer: &mut [u8]) -> Result<usize> {
    let mut got = 0;
    while got < buffer.len() {
        match reader.read(&mut buffer[got..]) {
            Ok(0) => break,
            Ok(more) => got += more,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(vol(VolCondition::Read, format!("cannot be read: {error}"))),
        }
    }
    Ok(got)
}

/// The depths, portion by portion: a file that ends early takes no more memory than it has bytes.
fn read_depths(mut reader: impl Read, order: ByteOrder, [width, height]: [u32; 2]) -> Result<Vec<f32>> {
    let count = width as usize * height as usize;
    allocate(VolCondition::Memory, || format!("a z-buffer of {width}x{height} pixels"), 4 * count as u64)?;
    let mut depths = Vec::new();
    let mut bytes = vec![[0_u8; 4]; PORTION.min(count)];
    while depths.len() < count {
        let portion = &mut bytes[..PORTION.min(count - depths.len())];
        let got = fill(&mut reader, portion.as_flattened_mut())? / 4;
        for (&depth, i) in portion[..got].iter().zip(depths.len()..) {
            let depth = f32::from_bits(order.u32(depth));
            if depth.is_nan() {
                let [x, y] = [i % width as usize, i / width as usize];
                return Err(vol(VolCondition::Read, format!("the depth of pixel ({x}, {y}) is no number")));
            }
            depths.push(DepthImage::known_depth(depth));
        }
        if got < portion.len() {
            return Err(ends_early(depths.len(), count));
        }
    }
    Ok(depths)
}

/// Whether so much memory can be had; where not, `condition` says for what.
pub(super) fn allocate(condition: VolCondition, what: impl FnOnce() -> String, bytes: u64) -> Result<()> {
    memory::check(what, Some(bytes)).map_err(|error| vol(condition, error.to_string()))
}

#[cfg(test)]
mod tests;
