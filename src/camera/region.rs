//! `Region`: the part of a picture that is drawn, as if the rest were there.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Columns `x0..x1` and rows `y0..y1` of a picture's pixels, ends exclusive.
///
/// As a [`Camera::region`](super::Camera::region) it is all that is drawn: for a wall of displays, or for a picture that is
/// larger than memory. Every pixel has the bits that it has in the whole picture.
///
/// ```
/// use cellfan::{Camera, Dataset, Projection, Region, RenderOptions, Renderer, Scene, TransferFunction, generate};
/// // The unit cube, of extinction 2 per unit and one unit thick along the axis.
/// let dataset = Dataset::from_tets(generate::tets(&generate::Settings { cells: 1_000, ..Default::default() })?)?;
/// let field = dataset.homogeneous_field();
/// let scene = Scene::new(dataset, field, &TransferFunction::constant([1.0; 3], 2.0)?);
/// let mut camera = Camera::looking_at([3.0, 0.5, 0.5].into(), [0.5; 3].into(), 3840, 1024);
/// camera.projection = Projection::Orthographic { height_world: 0.5 };
/// // The middle of a picture of 3840×1024 pixels, of which nothing else is drawn.
/// camera.region = Some(Region { x0: 1910, y0: 505, x1: 1930, y1: 520 });
/// let image = Renderer::new(RenderOptions::default()).render(&scene, &camera)?.image;
/// assert_eq!([image.width, image.height], [20, 15]);
/// // Column 1910 + 9 and row 505 + 6 of the whole.
/// assert!((image.pixel(9, 6)[3] - (1.0 - (-2.0_f32).exp())).abs() < 1e-6);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(from = "[u32; 4]", into = "[u32; 4]")]
pub struct Region {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Region {
    /// All of a picture of this width and height.
    pub fn whole([width, height]: [u32; 2]) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Width and height in pixels; 0 where it ends before it begins.
    ///
    /// ```
    /// # use cellfan::Region;
    /// assert_eq!("1280,0,2560,1024".parse::<Region>()?.size_px(), [1280, 1024]);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn size_px(self) -> [u32; 2] {
        [self.x1.saturating_sub(self.x0), self.y1.saturating_sub(self.y0)]
    }

    /// Whether it is a part of a picture of this width and height.
    ///
    /// # Errors
    /// [`Error::Option`] where it is empty, ends before it begins, or reaches beyond the picture.
    pub fn check(self, [width, height]: [u32; 2]) -> Result<()> {
        let problem = if self.x0 >= self.x1 || self.y0 >= self.y1 {
            format!("{self} holds no pixel; X0 must be less than X1, and Y0 less than Y1")
        } else if self.x1 > width || self.y1 > height {
            format!(
                "{self} reaches beyond the picture of {width}x{height} pixels; X1 may be {width} and Y1 {height} at most"
            )
        } else {
            return Ok(());
        };
        Err(Error::Option { option: "--region", problem })
    }

    /// The same part of a picture of half the width and height, at least a pixel.
    pub(crate) fn halved(self) -> Self {
        Self { x0: self.x0 / 2, y0: self.y0 / 2, x1: self.x1.div_ceil(2), y1: self.y1.div_ceil(2) }
    }
}

impl From<[u32; 4]> for Region {
    fn from([x0, y0, x1, y1]: [u32; 4]) -> Self {
        Self { x0, y0, x1, y1 }
    }
}

impl From<Region> for [u32; 4] {
    fn from(Region { x0, y0, x1, y1 }: Region) -> Self {
        [x0, y0, x1, y1]
    }
}

/// `X0,Y0,X1,Y1`.
impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { x0, y0, x1, y1 } = self;
        write!(f, "{x0},{y0},{x1},{y1}")
    }
}

/// Reads `X0,Y0,X1,Y1`; whether there are such pixels is for [`Region::check`] to say.
impl FromStr for Region {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        let four: Option<[u32; 4]> = numbers.and_then(|numbers| numbers.try_into().ok());
        four.map(Self::from).ok_or_else(|| Error::Option {
            option: "--region",
            problem: "expected X0,Y0,X1,Y1, four whole numbers of pixels from 0 on, such as 0,0,1280,1024".to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_there_and_back() {
        let region = Region { x0: 3, y0: 0, x1: 32_768, y1: 5 };
        assert_eq!(region.to_string().parse::<Region>().unwrap(), region);
        assert_eq!(" 3, 0,32768,5".parse::<Region>().unwrap(), region);
        for bad in ["", "1,2,3", "1,2,3,4,5", "-1,0,5,5", "0,0,5.5,5", "a,0,5,5", "0,0,5,", "0,0,4294967296,1"] {
            let error = bad.parse::<Region>().unwrap_err();
            assert!(matches!(error, Error::Option { option: "--region", .. }), "{bad}: {error}");
        }
    }

    #[test]
    fn only_parts_of_the_picture_pass() {
        let check = |numbers: [u32; 4]| Region::from(numbers).check([64, 48]);
        for good in [[0, 0, 64, 48], [63, 47, 64, 48], [0, 0, 1, 1]] {
            assert!(check(good).is_ok(), "{good:?}");
        }
        let empty = [[5, 5, 5, 6], [5, 5, 6, 5], [6, 0, 5, 9], [0, 9, 9, 8], [9, 9, 8, 8]];
        let outside = [[0, 0, 65, 48], [0, 0, 64, 49], [64, 0, 65, 1], [0, 0, u32::MAX, u32::MAX]];
        for (bad, why) in empty.map(|bad| (bad, "no pixel")).into_iter().chain(outside.map(|bad| (bad, "beyond"))) {
            let error = check(bad).unwrap_err().to_string();
            assert!(error.starts_with("--region: ") && error.contains(why), "{bad:?}: {error}");
        }
        assert_eq!(Region::from([9, 9, 8, 8]).size_px(), [0, 0]);
    }

    #[test]
    fn half_of_a_region_lies_in_half_of_the_picture() {
        for region in [[0, 0, 1, 1], [62, 46, 63, 47], [0, 0, 63, 47], [7, 8, 9, 11]] {
            let half = Region::from(region).halved();
            assert!(half.check([63_u32.div_ceil(2), 47_u32.div_ceil(2)]).is_ok(), "{region:?}: {half}");
        }
    }
}
