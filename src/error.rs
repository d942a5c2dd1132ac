//! The one error type: what went wrong, where, and what to do about it.
//!
//! An error is raised at the edge that sees it, carries its facts as fields, and is printed once, by the program.

mod vol;

use std::path::PathBuf;

pub use vol::VolCondition;

/// Most characters of a sentence about a file: it may quote what the file holds, which may be long.
const LONGEST_PROBLEM: usize = 600;

/// Most names that a message lists.
const MOST_NAMES: usize = 50;

/// A sentence about input, as it can be shown: without characters that a terminal would obey, and without its middle where
/// it is too long.
pub(crate) fn presentable(problem: String) -> String {
    let half = LONGEST_PROBLEM / 2;
    let problem = without_controls(problem);
    // In bytes first: most messages are not even counted.
    if problem.len() <= LONGEST_PROBLEM || problem.chars().count() <= LONGEST_PROBLEM {
        return problem;
    }
    let start: String = problem.chars().take(half).collect();
    let end: Vec<char> = problem.chars().rev().take(half).collect();
    start + " … " + &end.into_iter().rev().collect::<String>()
}

/// `text` with a replacement character for each control character.
pub(crate) fn without_controls(text: String) -> String {
    if text.contains(char::is_control) { text.replace(char::is_control, "\u{fffd}") } else { text }
}

/// Names that can be chosen from, each and all of bearable length.
fn list(names: &[String]) -> String {
    let shown: Vec<String> = names.iter().take(MOST_NAMES).map(|name| name.chars().take(80).collect()).collect();
    let more = names.len().saturating_sub(MOST_NAMES);
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

fn gibibytes(bytes: u64) -> String {
    format!("{:.1} GiB", bytes as f64 / f64::from(1 << 30))
}

/// A result with cellfan's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Everything that can go wrong, with the facts a caller needs to act on it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to read or write.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },

    /// A file does not hold what its format says it must.
    #[error("{}: {place}: {problem}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Where in it: an element, a line, a byte.
        place: String,
        /// What is wrong and what was expected.
        problem: String,
    },

    /// A format, encoding or cell kind that cellfan does not read.
    #[error("{}: {what} is not supported; {advice}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What it holds.
        what: String,
        /// What to do instead.
        advice: String,
    },

    /// An error in the contents of a file that was read in full.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with its contents.
        source: Box<Error>,
    },

    /// A file that is used in place is no longer what it was when it was opened.
    #[error("{}: the file {problem} while it was in use; open it again, or read it whole with --no-mmap", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
        /// What happened to it.
        problem: &'static str,
    },

    /// A cell names a vertex that does not exist.
    #[error(
        "{column}: cell {cell} refers to point {index}, but there are only {len} points (0 to {}); the file is damaged or truncated",
        len.saturating_sub(1)
    )]
    IndexOutOfRange {
        /// The column that holds the index.
        column: &'static str,
        /// The cell, in file order.
        cell: u64,
        /// The index found.
        index: i64,
        /// How many points there are.
        len: u64,
    },

    /// A column is longer or shorter than what it describes.
    #[error("{column}: has {len} entries where {expected} are needed; the file is damaged or truncated")]
    LengthMismatch {
        /// The column.
        column: String,
        /// Its length.
        len: u64,
        /// The length it must have.
        expected: u64,
    },

    /// The faces of a polyhedron do not close it.
    #[error(
        "faces: cell {cell} is open: the edge between points {} and {} is not shared by two of its faces; repair its list of faces",
        edge[0], edge[1]
    )]
    OpenCell {
        /// The cell, in file order.
        cell: u64,
        /// The ends of an edge where it is open.
        edge: [u32; 2],
    },

    /// A vertex of a cell has a coordinate that is NaN or infinite.
    #[error(
        "points: point {point} is used by a cell but its position is not finite ({position:?}); remove or repair it"
    )]
    NonFinitePosition {
        /// The point, in file order.
        point: u64,
        /// Its coordinates.
        position: [f64; 3],
    },

    /// More points or cells than the 32-bit index maps can name.
    #[error("{column}: {len} entries are more than the {limit} that this version can index; split the mesh")]
    TooLarge {
        /// The column.
        column: &'static str,
        /// Its length.
        len: u64,
        /// The largest length supported.
        limit: u64,
    },

    /// What was asked for needs more memory than there is.
    #[error(
        "{what} takes {} of memory{}; ask for less",
        gibibytes(*bytes),
        free.map_or(", which the system refuses".to_owned(), |free| format!(", and {} are free", gibibytes(free)))
    )]
    OutOfMemory {
        /// What needs it.
        what: String,
        /// How much it needs at once.
        bytes: u64,
        /// How much is free, where that is known.
        free: Option<u64>,
    },

    /// Nothing is left to draw.
    #[error("{}", VolCondition::NotVolumetric.said(&format!("the mesh has no cell with a volume: {found}")))]
    NoCells {
        /// What was found instead.
        found: String,
    },

    /// The array asked for does not exist.
    #[error("there is no array {name:?}; {}", if available.is_empty() {
        "the mesh has no arrays: leave --array out to draw it homogeneous".to_owned()
    } else {
        format!("choose one of: {}", list(available))
    })]
    UnknownArray {
        /// The name given.
        name: String,
        /// The names there are.
        available: Vec<String>,
    },

    /// An array that cannot be drawn: no finite value, or no such component.
    #[error("array {name:?}: {problem}")]
    UnusableArray {
        /// The array.
        name: String,
        /// Why, and what to do.
        problem: String,
    },

    /// A transfer function that is not one.
    #[error("transfer function: {problem}")]
    TransferFunction {
        /// What is wrong, where, and what was expected.
        problem: String,
    },

    /// A profile that is not one.
    #[error("profile: {problem}")]
    Profile {
        /// What is wrong, where, and what was expected.
        problem: String,
    },

    /// Wavelength bands that are none.
    #[error("bands: {problem}")]
    Bands {
        /// What is wrong, where, and what was expected.
        problem: String,
    },

    /// A camera that cannot look at anything.
    #[error("camera: {problem}")]
    Camera {
        /// What is wrong and what was expected.
        problem: String,
    },

    /// What Vol (Amidon 1995) refuses of a z-buffer file or an external picture, with its number.
    #[error("{}", condition.said(problem))]
    Vol {
        /// Which of the paper's conditions.
        condition: VolCondition,
        /// What is wrong and what was expected.
        problem: String,
    },

    /// Options that contradict each other or lie out of range.
    #[error("{option}: {problem}")]
    Option {
        /// The option, as it is written on the command line.
        option: &'static str,
        /// What is wrong and what was expected.
        problem: String,
    },

    /// A picture could not be encoded.
    #[error("{}: could not encode the picture: {problem}", path.display())]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// What the encoder said.
        problem: String,
    },

    /// Two pictures that are to be compared differ in size.
    #[error(
        "pictures of {}x{} and {}x{} pixels cannot be compared; draw both at one size",
        size.0, size.1, other_size.0, other_size.1
    )]
    ImageSize {
        /// Width and height of the one, in pixels.
        size: (u32, u32),
        /// Width and height of the other.
        other_size: (u32, u32),
    },

    /// The memory budget is too small for the frame.
    #[error(
        "--memory: {budget_bytes} bytes are not enough: {what} takes {needed_bytes}; give that much, or draw {advice}"
    )]
    Memory {
        /// The budget.
        budget_bytes: u64,
        /// What would do for `what`.
        needed_bytes: u64,
        /// What does not fit.
        what: &'static str,
        /// What takes less.
        advice: &'static str,
    },

    /// Whoever asked for the picture wants it no more: see [`CancelToken`](crate::CancelToken).
    #[error("cancelled")]
    Cancelled,

    /// No device can run what was asked for.
    #[error("no usable device: {problem}")]
    NoDevice {
        /// What is missing and what to do instead.
        problem: String,
    },
}

impl Error {
    /// Adds the file in whose contents the error was found, unless it names one already.
    ///
    /// ```
    /// # use cellfan::Error;
    /// let error = Error::TransferFunction { problem: "no points".into() }.in_file("tf.json");
    /// assert_eq!(error.to_string(), "tf.json: transfer function: no points");
    /// ```
    #[must_use]
    pub fn in_file(self, path: impl Into<PathBuf>) -> Self {
        match self {
            Self::Io { .. }
            | Self::Malformed { .. }
            | Self::Unsupported { .. }
            | Self::InFile { .. }
            | Self::Changed { .. }
            | Self::Encode { .. } => self,
            other => Self::InFile { path: path.into(), source: Box::new(other) },
        }
    }

    /// Whether the cause is a device that is missing rather than the input: the program's exit code 2.
    pub fn is_device(&self) -> bool {
        match self {
            Self::NoDevice { .. } => true,
            Self::InFile { source, .. } => source.is_device(),
            _ => false,
        }
    }
}
