//! The arguments of `profile`.

use std::path::PathBuf;

use cellfan::profile::trace::Recorder;
use clap::{Args, Command, Id, ValueHint};

use crate::cli::arguments::finite;
use crate::cli::meshes::FORMATS;
use crate::cli::scene;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Arguments {
    #[arg(required_unless_present = "compare", conflicts_with = "compare", value_name = "MESH", help = FORMATS)]
    pub(super) meshes: Vec<PathBuf>,
    /// Instead of measuring: say what changed from one run to another beyond the noise of their frames; files that --stats wrote.
    #[arg(long, num_args = 2, value_names = ["A.json", "B.json"], value_hint = ValueHint::FilePath)]
    pub(super) compare: Vec<PathBuf>,

    #[command(flatten)]
    pub(super) scene: scene::Arguments,

    #[command(flatten)]
    pub(super) geometry: scene::Geometry,

    /// Draw N frames that count.
    #[arg(long, value_name = "N", help_heading = "Frames", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(super) frames: u32,
    /// How far the eye turns about the target over them; 0 draws one view again and again.
    #[arg(long, value_name = "DEGREES", help_heading = "Frames", default_value = "360", value_parser = finite, allow_hyphen_values = true)]
    pub(super) orbit: f64,
    /// Draw N frames before them, which do not count.
    #[arg(long, value_name = "N", help_heading = "Frames", default_value_t = 3, value_parser = clap::value_parser!(u32).range(..=1_000_000))]
    pub(super) warm_up: u32,
    /// Draw N of the views again at half the width and height, to tell what goes with pixels from what goes with cells.
    #[arg(long, value_name = "N", help_heading = "Frames", default_value_t = 5, value_parser = clap::value_parser!(u32).range(..=1000))]
    pub(super) half_size: u32,

    /// Write the figures of every frame as JSON; - is stdout, in place of the table.
    #[arg(long, value_name = "OUT.json", help_heading = "Output", allow_hyphen_values = true)]
    pub(super) stats: Option<PathBuf>,
    /// Write a row for each frame: its time and that of each stage.
    #[arg(long, value_name = "OUT.csv", help_heading = "Output")]
    pub(super) csv: Option<PathBuf>,
    /// Draw frame rate and stages over the frames: .png or .svg.
    #[arg(long, value_name = "OUT", help_heading = "Output")]
    pub(super) plot: Option<PathBuf>,
    /// Write what every thread and the GPU did when, for ui.perfetto.dev or the tracing page of Chrome. The GPU's clock has no common zero with the
    /// processor's: its passes are shown as early as their submission allows.
    #[arg(long, value_name = "OUT.json", help_heading = "Output")]
    pub(super) trace: Option<PathBuf>,
}

/// The verb with `--compare` set against everything else that may be said of it: a comparison measures nothing.
pub(in crate::cli) fn with_conflicts(command: Command) -> Command {
    let others: Vec<Id> = command.get_arguments().map(|argument| argument.get_id().clone()).collect();
    let others: Vec<Id> = others.into_iter().filter(|id| *id != "compare").collect();
    command.mut_arg("compare", |compare| compare.conflicts_with_all(others))
}

const EXAMPLES: &str = "\
Examples:
  cellfan profile mesh.cells
  cellfan profile mesh.cells --orbit 360 --frames 200 --size 1024x1024 --plot rates.png --stats before.json
  cellfan profile mesh.cells --backend gpu --frames 20 --trace trace.json
  cellfan profile --compare before.json after.json
  cellfan profile mesh.cells --stats - | jq .figures.frame_ms";

impl Arguments {
    /// Where spans go, if a trace is asked for.
    pub(in crate::cli) fn recorder(&self) -> Option<Recorder> {
        self.trace.as_ref().map(|_| Recorder::new(Recorder::MOST))
    }
}
