//! Hostile files: every reader against seeded mutations of good files, and against every one that ever got through.
//!
//! A reader may refuse or accept; it may not panic, take longer than its time, or allocate more than its limit
//! (`targets.rs`). Which inputs come is a function of the seed alone. docs/robustness.md says how to run this for long.
//! What sessions allocate is counted here too, since this is where allocations are. To add a reader: its line in [`targets::TARGETS`], and a function in `seeds.rs` that writes small good files.

mod allocation;
#[path = "../common/mod.rs"]
mod common;
mod harness;
mod memory;
mod mutate;
mod random;
mod regressions;
mod seeds;
mod targets;

use std::time::Duration;

/// How long `cargo test` spends on each reader.
const SHORT: Duration = Duration::from_millis(500);

#[test]
fn every_reader_survives_mutations() {
    let number = |name: &str| {
        let text = std::env::var(name).ok()?;
        Some(text.parse::<u64>().unwrap_or_else(|_| panic!("{name}={text:?} is no whole number")))
    };
    let time = number("CELLFAN_FUZZ_SECONDS").map_or(SHORT, Duration::from_secs);
    let seed = number("CELLFAN_FUZZ_SEED").unwrap_or(1);
    let only = std::env::var("CELLFAN_FUZZ_READER").ok();
    let chosen: Vec<_> =
        targets::TARGETS.iter().filter(|target| only.as_deref().is_none_or(|name| name == target.name)).collect();
    assert!(!chosen.is_empty(), "CELLFAN_FUZZ_READER names none of the readers in targets.rs");
    let failures: Vec<String> = chosen.into_iter().flat_map(|target| harness::fuzz(target, time, seed)).collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
