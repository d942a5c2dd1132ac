//! The conditions that Vol names (Amidon 1995, appendix C): a number each, which stands in the message.

/// What Vol, the depth-plane renderer of Amidon (1995), refuses, by its numbers 100 to 113.
///
/// Here 100 to 106 are [`Error::Vol`](crate::Error::Vol), of z-buffer files and external pictures ([`ZBuffer`](crate::image::ZBuffer),
/// [`DepthImage`](crate::image::DepthImage)). The others are conditions of any picture, and stand in the messages of the errors that they
/// are here: 107, a data set that is not volumetric, is [`Error::NoCells`](crate::Error::NoCells); 108 (near and far plane are equal),
/// 109 (perspective angle zero), 110 (an increment of zero: a pixel without width), 111 (eye and target are one point) and 112 (`up` is
/// zero or runs along the view) are [`Error::Camera`](crate::Error::Camera). 113, a light without a
/// direction, is [`Error::Option`](crate::Error::Option) of the depth planes' lights; the lamp at the eye always has one.
///
/// ```
/// use cellfan::error::VolCondition;
/// let numbers: Vec<u16> = VolCondition::ALL.iter().map(|condition| condition.number()).collect();
/// assert_eq!(numbers, (100..=113).collect::<Vec<_>>());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolCondition {
    /// 100: file read error.
    Read,
    /// 101: z-buffer file has wrong magic number.
    Magic,
    /// 102: z-buffer size is not compatible with image size.
    Size,
    /// 103: could not allocate z-buffer memory.
    Memory,
    /// 104: premature end of file on z-buffer read.
    EndOfFile,
    /// 105: could not open z-buffer file.
    Open,
    /// 106: could not allocate image memory.
    ImageMemory,
    /// 107: data set is not volumetric.
    NotVolumetric,
    /// 108: far and near clipping planes are equal.
    PlanesEqual,
    /// 109: perspective angle is zero.
    NoAngle,
    /// 110: increment value of zero detected.
    NoIncrement,
    /// 111: view direction vector is null.
    NoViewDirection,
    /// 112: up direction vector is null.
    NoUp,
    /// 113: light source direction vector is null.
    NoLight,
}

impl VolCondition {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 14] = [
        Self::Read,
        Self::Magic,
        Self::Size,
        Self::Memory,
        Self::EndOfFile,
        Self::Open,
        Self::ImageMemory,
        Self::NotVolumetric,
        Self::PlanesEqual,
        Self::NoAngle,
        Self::NoIncrement,
        Self::NoViewDirection,
        Self::NoUp,
        Self::NoLight,
    ];

    /// The paper's number.
    pub fn number(self) -> u16 {
        100 + self as u16
    }

    /// `problem`, with the number behind it.
    pub(crate) fn said(self, problem: &str) -> String {
        format!("{problem} (Vol's error {})", self.number())
    }
}

#[cfg(test)]
mod tests {
    use crate::Error;

    #[test]
    fn error_107_no_cell_with_a_volume() {
        let message = Error::NoCells { found: "3 triangles".to_owned() }.to_string();
        assert_eq!(message, "the mesh has no cell with a volume: 3 triangles (Vol's error 107)");
    }
}
