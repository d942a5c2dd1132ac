//! The memory that the process holds, and the most it ever held.

/// The largest resident set so far, in bytes, mapped files included; none where the system does not say (only Linux
/// does here).
///
/// ```
/// # use cellfan::profile::peak_rss_bytes;
/// assert!(peak_rss_bytes().is_none_or(|bytes| bytes > 100_000));
/// ```
pub fn peak_rss_bytes() -> Option<u64> {
    #[cfg(target_os = "linux")]
    return high_water_mark(&std::fs::read_to_string("/proc/self/status").ok()?);
    #[cfg(not(target_os = "linux"))]
    return None;
}

/// The memory held now that no file stands behind, in bytes: heap, stacks, shared memory; mapped files are left out. None
/// where the system does not say (only Linux does here). Takes some ten microseconds.
///
/// ```
/// # use cellfan::profile::anonymous_bytes;
/// assert!(anonymous_bytes().is_none_or(|bytes| bytes > 10_000));
/// ```
pub fn anonymous_bytes() -> Option<u64> {
    #[cfg(target_os = "linux")]
    return anonymous(&std::fs::read_to_string("/proc/self/status").ok()?);
    #[cfg(not(target_os = "linux"))]
    return None;
}

#[cfg(any(target_os = "linux", test))]
fn anonymous(status: &str) -> Option<u64> {
    in_bytes(status, "RssAnon:")?.checked_add(in_bytes(status, "RssShmem:")?)
}

#[cfg(any(target_os = "linux", test))]
fn high_water_mark(status: &str) -> Option<u64> {
    in_bytes(status, "VmHWM:")
}

/// A line such as `VmHWM:     1234 kB` of proc(5), in bytes.
#[cfg(any(target_os = "linux", test))]
fn in_bytes(status: &str, name: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn high_water_mark_is_found_or_none() {
        assert_eq!(high_water_mark("VmPeak:\t 9 kB\nVmHWM:\t    1234 kB\nVmRSS:\t 5 kB\n"), Some(1_263_616));
        assert_eq!(high_water_mark("VmRSS:\t 5 kB\n"), None);
        assert_eq!(high_water_mark("VmHWM:\t x kB\n"), None);
    }

    #[test]
    fn anonymous_memory_is_found_or_none() {
        let status = "RssAnon:\t    100 kB\nRssFile:\t    7000 kB\nRssShmem:\t       2 kB\n";
        assert_eq!(anonymous(status), Some(102 * 1024));
        assert_eq!(anonymous("RssAnon:\t 100 kB\n"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn peak_rises_with_use_and_stays() {
        let before = peak_rss_bytes().unwrap();
        let bytes = before as usize + (64 << 20);
        let block = vec![1_u8; bytes];
        assert_eq!(std::hint::black_box(&block)[bytes - 1], 1);
        drop(block);
        // The kernel counts pages a thread at a time and adds up late: half of the rise is enough.
        let after = peak_rss_bytes().unwrap();
        assert!(after >= before + (32 << 20), "{before} {after}");
    }
}
