//! The arguments of `render`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::arguments::{color, finite};
use crate::cli::meshes::FORMATS;
use crate::cli::scene;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Arguments {
    #[arg(required = true, value_name = "MESH", help = FORMATS)]
    pub(super) meshes: Vec<PathBuf>,
    /// The picture: .png to look at, .exr or .npy for the linear values [default: the first MESH's name with .png, in this
    /// folder].
    #[arg(short = 'o', long, value_name = "OUT")]
    pub(super) out: Option<PathBuf>,

    #[command(flatten)]
    pub(super) scene: scene::Arguments,

    #[command(flatten)]
    pub(super) geometry: scene::Geometry,

    #[command(flatten)]
    pub(super) composite: scene::Composite,

    /// The colour behind a PNG, as sRGB from 0 to 1 [default: transparent].
    #[arg(long, value_name = "R,G,B", help_heading = "Picture", value_parser = color, allow_hyphen_values = true)]
    pub(super) background: Option<[f32; 3]>,
    /// Draw N frames: OUT.0000.png and so on, or one stacked .npy.
    #[arg(long, value_name = "N", help_heading = "View", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) frames: Option<u32>,
    /// How far the eye turns about the target over all frames.
    #[arg(long, value_name = "DEGREES", help_heading = "View", default_value = "360", requires = "frames", value_parser = finite, allow_hyphen_values = true)]
    pub(super) orbit: f64,
    /// Draw each depth plane of the view alone, from the nearest: OUT.0000.png and so on, or one stacked .npy.
    #[arg(long, help_heading = "Depth planes", conflicts_with = "frames")]
    pub(super) cross_sections: bool,
    /// Write figures as JSON: cells, order, stages, times; - is stdout.
    #[arg(long, value_name = "STATS.json", help_heading = "Method", allow_hyphen_values = true)]
    pub(super) stats: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  cellfan render mesh.vtu
  cellfan render rotor.vtu stator.vtu casing.vts -o machine.png
  cellfan render mesh.vtu -o out.png --array Velocity[2] --transfer cool-warm --view 120,-10
  cellfan render mesh.vtu -o out.exr --transfer tf.json --camera cam.json --size 1920x1080
  cellfan render mesh.vtu -o turn.png --frames 36 --orbit 360 --background 0,0,0
  cellfan render mesh.vtu -o out.npy --model absorption --stats - | jq .frame_ms
  cellfan render mesh.vtu -o both.png --camera cam.json --mesh wing.stl=#c0c0ff --composite other.exr --depth both.exr
  cellfan render mesh.vtu -o xray.exr --model absorption --bands bands.csv --output depth";

impl Arguments {
    /// Where the picture goes; by default the first mesh's name with .png, in the current folder.
    pub(super) fn output_path(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            // A path without a name is no mesh; the reader says so.
            let stem = self.meshes.first().and_then(|mesh| mesh.file_stem());
            let mut name = stem.unwrap_or("mesh".as_ref()).to_owned();
            name.push(".png");
            name.into()
        })
    }
}
