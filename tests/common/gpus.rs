//! The adapters that tests run on.

use std::io::Write;

use cellfan::backends::gpu::{Gpu, adapters};

/// Every adapter of this machine; without one the caller skips, and says so.
///
/// # Panics
/// If there is none and `CELLFAN_GPU` says `required`.
pub(crate) fn gpus(test: &str) -> Vec<Gpu> {
    let found = adapters();
    if found.is_empty() {
        assert!(std::env::var_os("CELLFAN_GPU").is_none_or(|gpu| gpu != "required"), "{test}: there is no adapter");
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED: there is no driver for Vulkan, Metal or Direct3D 12, so {test} did not run"
        );
    }
    found.iter().map(|adapter| Gpu::open(Some(&adapter.name)).unwrap_or_else(|error| panic!("{error}"))).collect()
}
