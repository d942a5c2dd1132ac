//! The program, run as a user runs it: pictures, figures, messages, exit codes.

#[path = "cli/bands.rs"]
mod bands;
#[path = "cli/bench.rs"]
mod bench;
mod common;
#[path = "cli/container.rs"]
mod container;
#[path = "cli/cubes.rs"]
mod cubes;
#[path = "cli/depth_planes.rs"]
mod depth_planes;
#[path = "cli/errors.rs"]
mod errors;
#[path = "cli/fog.rs"]
mod fog;
#[path = "cli/geometry.rs"]
mod geometry;
#[cfg(feature = "gpu")]
#[path = "cli/gpu.rs"]
mod gpu;
#[cfg(feature = "gpu")]
#[path = "common/gpus.rs"]
mod gpus;
#[path = "cli/interrupted.rs"]
mod interrupted;
#[path = "cli/memory.rs"]
mod memory;
#[path = "cli/other_verbs.rs"]
mod other_verbs;
#[path = "cli/polyhedra.rs"]
mod polyhedra;
#[path = "cli/profile.rs"]
mod profile;
#[path = "cli/region.rs"]
mod region;
#[path = "cli/render.rs"]
mod render;
#[path = "cli/several.rs"]
mod several;
#[path = "cli/volumes.rs"]
mod volumes;

use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A folder of its own, in which the program runs.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with `mesh.vtu`, C60 in about 3,000 cells.
    fn with_mesh() -> Self {
        let place = Self::new();
        place.run(["generate", "buckyball", "--cells", "3000", "-o", "mesh.vtu"]).succeeds();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The program on a machine without a GPU, whatever this one has.
    fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_cellfan"));
        command.current_dir(self.0.path()).env_remove("RUST_LOG").env("VK_DRIVER_FILES", "/nowhere");
        command
    }

    fn run(&self, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ran {
        Ran::of(self.command().args(arguments).output().unwrap())
    }

    /// Runs `render mesh.vtu` at 48x40 pixels with more arguments, in a line.
    fn render(&self, more: &str) -> Ran {
        self.run(["render", "mesh.vtu", "--size", "48x40"].into_iter().chain(more.split_whitespace()))
    }

    /// Names in the folder, in order.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// How a run ended.
struct Ran {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Ran {
    fn of(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }

    #[track_caller]
    fn succeeds(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.err);
        self
    }

    /// Ended with `code`, nothing on stdout, and an error that says all of `parts`.
    #[track_caller]
    fn fails(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.code, Some(code), "{}", self.err);
        assert_eq!(self.out, "");
        assert!(self.err.starts_with("error: "), "{}", self.err);
        assert!(!self.err.contains("panicked"), "{}", self.err);
        for part in parts {
            assert!(self.err.contains(part), "{part:?} is not in {:?}", self.err);
        }
    }

    fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}", self.out))
    }
}

/// Shape and values of a .npy file of `float32`.
fn npy(path: &Path) -> (Vec<u64>, Vec<f32>) {
    let mut bytes = Vec::new();
    std::fs::File::open(path).unwrap().read_to_end(&mut bytes).unwrap();
    let file = npyz::NpyFile::new(&bytes[..]).unwrap();
    (file.shape().to_vec(), file.into_vec().unwrap())
}

/// The share of the pixels that differ from the first, which the default view leaves empty.
fn covered(path: &Path) -> f64 {
    let image = image::open(path).unwrap().into_rgba8();
    let first = *image.get_pixel(0, 0);
    image.pixels().filter(|pixel| **pixel != first).count() as f64 / image.pixels().len() as f64
}
