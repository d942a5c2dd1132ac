//! The command line: one file per verb, and what they share.
//!
//! In: arguments. Out: files; machine output on stdout where it was asked for; messages and progress on stderr.
//! To add a verb: a file with its arguments and `run`, its variant in [`Command`] and its line in [`run`].
//! Exit codes are in [`failure`], log levels in [`messages`], stdout in [`stdout`].

mod arguments;
mod bench;
mod completions;
mod convert;
mod drivers;
mod failure;
mod fog;
mod generate;
mod info;
mod meshes;
mod messages;
mod numbers;
mod profile;
mod progress;
mod render;
mod scene;
mod stdout;

use std::ffi::OsString;

use cellfan::Error;
use clap::{ArgAction, Args, CommandFactory, FromArgMatches, Parser, Subcommand};

pub(crate) use failure::Failure;

/// What a verb returns.
type Outcome<T = ()> = Result<T, Failure>;

#[derive(Parser)]
#[command(name = "cellfan", version, about, max_term_width = 100, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    everywhere: Everywhere,
}

#[derive(Subcommand)]
enum Command {
    /// Draw a mesh, or several as one.
    Render(Box<render::Arguments>),
    /// Measure frame times over many views, and say where they go; or compare two runs.
    Profile(Box<profile::Arguments>),
    /// Say what is in a mesh file and what of it would be drawn.
    Info(info::Arguments),
    /// Write a mesh, or several as one, as a container, which is opened at once and drawn in place.
    Convert(convert::Arguments),
    /// Write a mesh with an analytic field.
    Generate(generate::Arguments),
    /// Draw ground fog over a terrain, or fly through it.
    Fog(Box<fog::Arguments>),
    /// Measure sorting, frames and each stage, beside the papers' figures.
    Bench(bench::Arguments),
    /// Write a completion script for a shell to stdout.
    Completions(completions::Arguments),
}

/// Options of every verb.
#[derive(Args)]
struct Everywhere {
    /// Threads to work on [default: one a core].
    #[arg(long, global = true, value_name = "N", help_heading = "General", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Say more: -v what is done, -vv all details. `RUST_LOG` goes before it.
    #[arg(short, long, global = true, action = ArgAction::Count, help_heading = "General")]
    verbose: u8,
    /// Say nothing but errors.
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "General")]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  cellfan generate buckyball --cells 1000000 -o c60.vtu
  cellfan info c60.vtu
  cellfan render c60.vtu -o c60.png
  cellfan profile c60.vtu

Exit codes: 0 done, 1 bad input or usage, 2 no usable device.";

/// Does what the arguments say.
pub(crate) fn run(arguments: impl Iterator<Item = OsString>) -> Outcome {
    drivers::be_quiet();
    let command = Cli::command().mut_subcommand("profile", profile::with_conflicts);
    let Cli { command, everywhere } = Cli::from_arg_matches(&command.try_get_matches_from(arguments)?)?;
    let recorder = match &command {
        Command::Profile(arguments) => arguments.recorder(),
        _ => None,
    };
    messages::start(everywhere.verbose, everywhere.quiet, recorder.as_ref());
    let threads = usize::from(everywhere.threads.unwrap_or(0)); // 0: rayon's choice
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).thread_name(|i| format!("worker {i}"));
    let pool = pool.build().map_err(|error| Error::Option {
        option: "--threads",
        problem: format!("the system does not start that many: {error}"),
    })?;
    pool.install(|| match &command {
        Command::Render(arguments) => render::run(arguments),
        Command::Profile(arguments) => profile::run(arguments, recorder.as_ref()),
        Command::Info(arguments) => info::run(arguments),
        Command::Convert(arguments) => convert::run(arguments),
        Command::Generate(arguments) => generate::run(arguments),
        Command::Fog(arguments) => fog::run(arguments),
        Command::Bench(arguments) => bench::run(arguments),
        Command::Completions(arguments) => completions::run(arguments),
    })
}
