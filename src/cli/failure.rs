//! Why the program ends early, what it says then, and its exit code.

use std::io::{self, ErrorKind, Write};

use cellfan::Error;
use clap::error::ErrorKind as Usage;

/// Anything that ends the program before it is done; help and version are among it.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The arguments are wrong, or ask for help.
    Arguments(clap::Error),
    /// The library refused.
    Library(Error),
    /// Stdout refused.
    Stdout(io::Error),
    /// A benchmark's run gave another answer than it must.
    WrongAnswer(String),
}

impl Failure {
    /// 0 done, 1 bad input or usage, 2 no usable device.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Arguments(error) => u8::from(error.use_stderr()),
            _ if self.is_closed_pipe() => 0,
            Self::Library(error) if error.is_device() => 2,
            Self::Library(_) | Self::Stdout(_) | Self::WrongAnswer(_) => 1,
        }
    }

    /// Says it: help on stdout, everything else on stderr. A closed pipe is no news.
    pub(crate) fn report(&self) {
        // Nobody is left to tell where even this cannot be written.
        let _ = match self {
            _ if self.is_closed_pipe() => Ok(()),
            Self::Arguments(error) if error.kind() == Usage::DisplayHelpOnMissingArgumentOrSubcommand => {
                writeln!(io::stderr(), "error: nothing to do\n\n{error}")
            }
            Self::Arguments(error) => error.print(),
            Self::Library(error) => writeln!(io::stderr(), "error: {error}"),
            Self::Stdout(error) => writeln!(io::stderr(), "error: stdout: {error}"),
            Self::WrongAnswer(what) => writeln!(io::stderr(), "error: wrong answer: {what}"),
        };
    }

    fn is_closed_pipe(&self) -> bool {
        match self {
            Self::Stdout(error) | Self::Library(Error::Io { source: error, .. }) => {
                error.kind() == ErrorKind::BrokenPipe
            }
            Self::Arguments(_) | Self::Library(_) | Self::WrongAnswer(_) => false,
        }
    }
}

impl From<clap::Error> for Failure {
    fn from(error: clap::Error) -> Self {
        Self::Arguments(error)
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Library(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes() {
        let broken = || io::Error::from(ErrorKind::BrokenPipe);
        let library = |error| Failure::Library(error);
        for (failure, code) in [
            (Failure::Arguments(clap::Error::new(Usage::DisplayHelp)), 0),
            (Failure::Arguments(clap::Error::new(Usage::DisplayVersion)), 0),
            (Failure::Arguments(clap::Error::new(Usage::UnknownArgument)), 1),
            (Failure::Stdout(broken()), 0),
            (library(Error::Io { path: "pipe".into(), source: broken() }), 0),
            (Failure::Stdout(ErrorKind::StorageFull.into()), 1),
            (Failure::WrongAnswer(String::new()), 1),
            (library(Error::NoCells { found: String::new() }), 1),
            (library(Error::NoDevice { problem: String::new() }), 2),
            (library(Error::NoDevice { problem: String::new() }.in_file("a")), 2),
        ] {
            assert_eq!(failure.exit_code(), code, "{failure:?}");
        }
    }
}
