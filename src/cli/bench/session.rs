//! What all benchmarks share: how often to run, when to stop, what was left out.

use std::path::PathBuf;
use std::time::Instant;

use cellfan::profile::free_memory_bytes;
use clap::Args;

use crate::cli::numbers::bytes;

/// Options of every benchmark.
#[derive(Args)]
#[command(next_help_heading = "Benchmark")]
pub(super) struct Common {
    /// Small sizes and few runs: shows that everything works, not how fast it is.
    #[arg(long, global = true)]
    quick: bool,
    /// Runs that count, for each figure [default: fewer for larger sizes].
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    runs: Option<u32>,
    /// Runs before them that do not.
    #[arg(long, global = true, value_name = "N", default_value_t = 1)]
    warm_up: u32,
    /// Start nothing that would end later than this, by the time of what came before it.
    #[arg(long, global = true, value_name = "SECONDS", value_parser = seconds)]
    time: Option<f64>,
    /// Write JSON; - is stdout, instead of the tables.
    #[arg(long, global = true, value_name = "OUT.json", allow_hyphen_values = true)]
    pub(super) json: Option<PathBuf>,
    /// Put the JSON into DIR/<processor>/<date>.json, beside the other benchmarks of that day.
    #[arg(long, global = true, value_name = "DIR")]
    pub(super) record: Option<PathBuf>,
    /// A remark for the record.
    #[arg(long, global = true, value_name = "TEXT")]
    pub(super) label: Option<String>,
}

impl Common {
    pub(super) fn is_quick(&self) -> bool {
        self.quick
    }
}

/// A positive number of seconds.
fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds.is_finite() && seconds > 0.0);
    seconds.ok_or_else(|| "expected a positive number of seconds".to_owned())
}

/// One benchmark as it goes on.
pub(super) struct Session {
    pub(super) is_quick: bool,
    pub(super) warm_up: usize,
    runs: Option<usize>,
    time_s: Option<f64>,
    start: Instant,
    /// What was not measured, and why.
    pub(super) left_out: Vec<String>,
}

impl Session {
    pub(super) fn new(common: &Common) -> Self {
        Self {
            is_quick: common.quick,
            warm_up: common.warm_up as usize,
            runs: common.runs.map(|runs| runs as usize),
            time_s: common.time,
            start: Instant::now(),
            left_out: Vec::new(),
        }
    }

    /// Runs of something that takes `usual` where nobody says how many.
    pub(super) fn runs(&self, usual: usize) -> usize {
        self.runs.unwrap_or(if self.is_quick { usual.min(3) } else { usual })
    }

    /// Whether `what` fits into the memory that is free and the time that is left; if not, it is left out.
    pub(super) fn admits(&mut self, what: &str, needs_bytes: u64, expected_s: f64) -> bool {
        let free = free_memory_bytes();
        if needs_bytes > free {
            self.leave_out(
                what,
                &format!("it takes about {} of memory, and {} are free", bytes(needs_bytes), bytes(free)),
            );
            return false;
        }
        let left_s = self.time_s.map_or(f64::INFINITY, |time_s| time_s - self.start.elapsed().as_secs_f64());
        if expected_s > left_s {
            let left_s = left_s.max(0.0);
            self.leave_out(
                what,
                &format!("it would take about {expected_s:.0} s, and {left_s:.0} s are left (--time)"),
            );
            return false;
        }
        true
    }

    /// Says that `what` is not measured, and why.
    fn leave_out(&mut self, what: &str, why: &str) {
        let text = format!("{what}: {why}");
        tracing::warn!("left out: {text}");
        self.left_out.push(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session(time_s: Option<f64>) -> Session {
        Session { is_quick: false, warm_up: 1, runs: None, time_s, start: Instant::now(), left_out: Vec::new() }
    }

    #[test]
    fn what_does_not_fit_is_left_out_and_said() {
        let mut session = session(Some(100.0));
        assert!(session.admits("a little", 1000, 1.0));
        assert!(!session.admits("a lot", 1 << 60, 1.0) && !session.admits("a long run", 1000, 101.0));
        assert_eq!(session.left_out.len(), 2);
        assert!(session.left_out[0].starts_with("a lot: it takes about 1152921504.6 GB"), "{:?}", session.left_out);
        assert!(session.left_out[1].contains("about 101 s"), "{:?}", session.left_out);
    }

    #[test]
    fn quick_means_few_runs_unless_told() {
        let mut session = session(None);
        assert_eq!(session.runs(7), 7);
        session.is_quick = true;
        assert_eq!((session.runs(7), session.runs(2)), (3, 2));
        session.runs = Some(11);
        assert_eq!(session.runs(7), 11);
    }
}
