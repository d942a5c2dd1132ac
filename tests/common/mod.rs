//! What the integration tests share.

use std::io::Write;
use std::path::PathBuf;

/// The folder of real data that `CELLFAN_DATA` names; without it the caller skips, and says so.
///
/// # Panics
/// If the variable names something that is no folder: then the tests that should run would not.
pub(crate) fn data_folder(test: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("CELLFAN_DATA").map(PathBuf::from) else {
        // Past the test harness, which would keep the line to itself.
        let _ = writeln!(std::io::stderr(), "SKIPPED: CELLFAN_DATA is not set, so {test} ran without its real files");
        return None;
    };
    assert!(folder.is_dir(), "CELLFAN_DATA={} is no folder", folder.display());
    Some(folder)
}
