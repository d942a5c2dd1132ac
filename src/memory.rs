//! Memory whose size a user chooses: asked for before it is taken, so that too much is an error and not the end of the
//! process.
//!
//! In: what needs it, and how many bytes. Out: an error where the system refuses them (a limit on the process), or where
//! they are more than what is free (a system that promises memory it does not have). Nothing is kept: what was asked for
//! is taken afterwards, as always.

use crate::error::{Error, Result};

/// Below this the system is not asked what is free.
const LARGE: u64 = 1 << 30;

/// Whether `bytes` can be had at once; `what` needs them. A number that overflowed (`None`) can not.
///
/// # Errors
/// [`Error::OutOfMemory`].
pub(crate) fn check(what: impl FnOnce() -> String, bytes: Option<u64>) -> Result<()> {
    let bytes = bytes.unwrap_or(u64::MAX);
    let free = if bytes < LARGE { None } else { free_bytes() };
    let is_free = free.is_none_or(|free| bytes <= free);
    let is_granted = |bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok();
    if is_free && usize::try_from(bytes).is_ok_and(is_granted) {
        return Ok(());
    }
    Err(Error::OutOfMemory { what: what(), bytes, free })
}

/// What can be taken without swapping: of the machine, and of the control group that this process is in.
pub(crate) fn free_bytes() -> Option<u64> {
    #[cfg(target_os = "linux")]
    {
        let read = |path: &str| std::fs::read_to_string(path).ok();
        let machine = read("/proc/meminfo").and_then(|text| available(&text));
        let group = read("/proc/self/cgroup").and_then(|text| {
            let folder = format!("/sys/fs/cgroup{}", text.lines().find_map(|line| line.strip_prefix("0::"))?);
            let of_group = |file: &str| read(&format!("{folder}/memory.{file}"));
            left_in_group(&of_group("max")?, &of_group("current")?, &of_group("stat")?)
        });
        machine.into_iter().chain(group).min()
    }
    #[cfg(not(target_os = "linux"))]
    {
        None
    }
}

/// The lines `MemAvailable:` and `SwapFree:` of proc(5), in bytes.
#[cfg(any(target_os = "linux", test))]
fn available(meminfo: &str) -> Option<u64> {
    let bytes = |name: &str| {
        let line = meminfo.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
    };
    bytes("MemAvailable:")?.checked_add(bytes("SwapFree:").unwrap_or(0))
}

/// What a control group (version 2) leaves: its limit, if it has one, less what it uses; pages of files can be given up.
#[cfg(any(target_os = "linux", test))]
fn left_in_group(max: &str, current: &str, stat: &str) -> Option<u64> {
    // "max", which is no number, where there is no limit.
    let (max, current) = (max.trim().parse::<u64>().ok()?, current.trim().parse::<u64>().ok()?);
    let value = |name: &str| {
        let rest = |line: &str| line.strip_prefix(name)?.trim().parse::<u64>().ok();
        stat.lines().find_map(rest).unwrap_or(0)
    };
    let files = value("active_file ").saturating_add(value("inactive_file "));
    Some(max.saturating_sub(current.saturating_sub(files)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_is_granted_and_too_much_is_an_error() {
        let what = || "a thing".to_owned();
        check(what, Some(1 << 20)).unwrap();
        for bytes in [None, Some(u64::MAX), Some(1 << 50)] {
            let message = check(what, bytes).unwrap_err().to_string();
            assert!(message.starts_with("a thing takes ") && message.contains("GiB"), "{message}");
        }
    }

    #[test]
    fn free_memory_is_found_or_none() {
        assert_eq!(available("MemFree: 1 kB\nMemAvailable:   12 kB\nSwapFree:  1 kB\n"), Some(13 << 10));
        assert_eq!(available("MemAvailable: 12 kB\n"), Some(12 << 10));
        assert_eq!(available("SwapFree: 12 kB\n"), None);
        assert_eq!(available("MemAvailable: many\n"), None);
        let stat = "anon 20\nfile 50\ninactive_file 30\nactive_file 10\n";
        assert_eq!(left_in_group("100\n", "70\n", stat), Some(70));
        assert_eq!(left_in_group("100\n", "70\n", ""), Some(30));
        assert_eq!(left_in_group("100\n", "700\n", ""), Some(0));
        assert_eq!(left_in_group("max\n", "70\n", stat), None);
    }
}
