//! One clock for all threads: nanoseconds since its first use.

use std::sync::OnceLock;
use std::time::Instant;

/// Now.
#[cfg_attr(not(any(feature = "gpu", feature = "trace")), expect(dead_code, reason = "traces and GPUs ask for it"))]
pub(crate) fn clock_ns() -> u64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_nanos() as u64
}
