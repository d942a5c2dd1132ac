//! `bench`: sorting, frames and each stage, measured and checked, beside what the papers measured.
//!
//! In: sizes and runs. Out: tables on stdout, or JSON with machine, commit and settings ([`record`]). Every figure is the median of
//! runs after some that are not counted ([`spread`]); the answer of every run is checked, and a wrong one ends the program. What does not
//! fit into memory or time is left out and said ([`session`]).
//! To add a benchmark: a file with its arguments and `run`, its variant in [`Benchmark`] and its line in [`run`].

mod bandwidth;
mod cellfast;
mod curvilinear;
mod device;
mod frames;
mod hexahedra;
mod hierarchy;
mod polyhedra;
mod record;
mod scaling;
mod session;
mod sort;
mod spread;
mod stages;
mod subject;
mod tables;

use cellfan::Error;
use cellfan::profile::load_average;
use clap::{Args, Subcommand};

use super::{Failure, Outcome, stdout};
use record::Record;
use session::{Common, Session};

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(subcommand)]
    benchmark: Benchmark,
    #[command(flatten)]
    common: Common,
}

#[derive(Subcommand)]
enum Benchmark {
    /// Sort keys with indices: the library's sorts against ours (CellFast, table 1).
    Sort(sort::Arguments),
    /// Frames of tetrahedra: culled share, frames/s, megapixels/s (CellFast, tables 2 and 3).
    Cellfast(cellfast::Arguments),
    /// Classify and draw hexahedra: cases and times (Max 2006, section 6).
    Hexahedra(hexahedra::Arguments),
    /// The octree of a regular grid: error, cubes, triangles, selection and rendering (Schussman and Max 2001, figure 9).
    Hierarchy(hierarchy::Arguments),
    /// Draw polyhedra without and with an order: frames/s, MIP to emission (Roettger and Ertl 2003, figure 4).
    Polyhedra(polyhedra::Arguments),
    /// Frames by cells, by threads and by pixels.
    Scaling(scaling::Arguments),
    /// Each stage alone: ns a cell, GB/s, share of the machine's measured memory bandwidth.
    Stages(stages::Arguments),
}

const EXAMPLES: &str = "\
Examples:
  cellfan bench sort --max-keys 10000000
  cellfan bench cellfast spx.vtk --json - | jq .results
  cellfan bench scaling --max-cells 100000000 --time 1800
  cellfan bench hierarchy engine.raw --raw 256x256x110:u8
  cellfan bench stages --threads 8 --record benches/records

With CELLFAN_COMMIT in the environment, of the build or of the run, records name that commit.";

/// More of a thread than this at work before the measurement starts is said.
const BUSY_THREADS: f64 = 0.5;

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let common = &arguments.common;
    let record = Record::begin(common)?;
    let load_before = load_average();
    let mut session = Session::new(common);
    let report = match &arguments.benchmark {
        Benchmark::Sort(arguments) => sort::run(arguments, &mut session),
        Benchmark::Cellfast(arguments) => cellfast::run(arguments, &mut session),
        Benchmark::Hexahedra(arguments) => hexahedra::run(arguments, &mut session),
        Benchmark::Hierarchy(arguments) => hierarchy::run(arguments, &mut session),
        Benchmark::Polyhedra(arguments) => polyhedra::run(arguments, &mut session),
        Benchmark::Scaling(arguments) => scaling::run(arguments, &mut session),
        Benchmark::Stages(arguments) => stages::run(arguments, &mut session),
    }?;
    if cfg!(debug_assertions) && !common.is_quick() {
        tracing::warn!("this program was built with checks (a debug build): it is slower than a release build");
    }
    if let Some(load) = load_before.filter(|&load| load > BUSY_THREADS) {
        tracing::warn!("{load:.1} threads were at work on this machine in the minute before: the figures are noisy");
    }
    let text = record.finish(&session, &report)?;
    stdout::write(&text)
}

/// Ends the program where an answer is wrong.
fn ensure(is_right: bool, what: impl FnOnce() -> String) -> Outcome {
    if is_right { Ok(()) } else { Err(Failure::WrongAnswer(what())) }
}

/// A pool of so many threads of its own.
fn pool(threads: usize) -> cellfan::Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| Error::Option {
        option: "--threads",
        problem: format!("the system does not start {threads}: {error}"),
    })
}
