//! `completions`: a completion script on stdout.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::{Cli, Outcome, stdout};

#[derive(Args)]
#[command(after_help = "Example:\n  cellfan completions bash > ~/.local/share/bash-completion/completions/cellfan")]
pub(super) struct Arguments {
    /// The shell.
    shell: Shell,
}

pub(super) fn run(arguments: &Arguments) -> Outcome {
    // The generator panics where its writer fails, which a vector does not.
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "cellfan", &mut script);
    stdout::write(&String::from_utf8_lossy(&script))
}
