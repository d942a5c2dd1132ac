//! The stages as a table for a terminal: milliseconds, share of the frame, bytes, bytes per second.

use std::fmt::{Display, Formatter, Result};

use super::{Profile, StageTime, Stats};

impl Display for Profile {
    /// A line a stage, then their sum, of which the shares are.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let width = name_width(self.stages());
        head(f, width)?;
        for stage in self.stages() {
            line(f, width, stage, Some(self.total_ms()))?;
        }
        total(f, width, "sum", self.total_ms())
    }
}

impl Display for Stats {
    /// A line a stage, then the median frame, of which the shares are; stages outside the frame have none.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let width = name_width(self.stages().stages());
        let frame_ms = self.frame_ms().unwrap_or(0.0);
        head(f, width)?;
        for (profile, whole_ms) in [(&self.before, None), (&self.frame, Some(frame_ms)), (&self.after, None)] {
            for stage in profile.stages() {
                line(f, width, stage, whole_ms)?;
            }
        }
        total(f, width, "frame", frame_ms)
    }
}

/// The widest name; "stage" and "frame" have five letters.
fn name_width(stages: &[StageTime]) -> usize {
    stages.iter().map(|s| s.name.chars().count()).max().unwrap_or(0).max(5)
}

fn head(f: &mut Formatter<'_>, width: usize) -> Result {
    writeln!(f, "{:width$} {:>11} {:>8} {:>10} {:>8}", "stage", "ms", "share", "bytes", "GB/s")
}

fn line(f: &mut Formatter<'_>, width: usize, stage: &StageTime, whole_ms: Option<f64>) -> Result {
    let ms = stage.duration_ms;
    let share = match whole_ms {
        Some(whole) if whole > 0.0 => format!("{:.1} %", 100.0 * ms / whole),
        _ => "-".into(),
    };
    let (bytes, rate) = match stage.bytes {
        0 => ("-".into(), "-".into()),
        bytes if ms > 0.0 => (in_units(bytes), format!("{:.2}", bytes as f64 / ms * 1e-6)),
        bytes => (in_units(bytes), "-".into()),
    };
    writeln!(f, "{:width$} {ms:>11.3} {share:>8} {bytes:>10} {rate:>8}", stage.name)
}

/// The last line, without a newline.
fn total(f: &mut Formatter<'_>, width: usize, name: &str, ms: f64) -> Result {
    let share = if ms > 0.0 { "100.0 %" } else { "-" };
    write!(f, "{name:width$} {ms:>11.3} {share:>8}")
}

/// Bytes in powers of 1000.
pub(super) fn in_units(bytes: u64) -> String {
    if bytes < 1000 {
        return format!("{bytes} B");
    }
    let bytes = bytes as f64;
    // The limits lie where rounding to one decimal would give 1000.0.
    [("kB", 1e3, 999.95e3), ("MB", 1e6, 999.95e6), ("GB", 1e9, 999.95e9)]
        .into_iter()
        .find(|&(_, _, limit)| bytes < limit)
        .map_or_else(|| format!("{:.1} TB", bytes / 1e12), |(unit, size, _)| format!("{:.1} {unit}", bytes / size))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn table_is_aligned() {
        let mut stats = Stats { frames: vec![10.0], ..Stats::default() };
        stats.before.add("read", Duration::from_millis(1234), 12_345_678);
        stats.frame.add("cull", Duration::from_micros(1250), 2_500_000);
        stats.frame.add("composite", Duration::from_micros(8500), 0);
        let expected = "\
stage              ms    share      bytes     GB/s
read         1234.000        -    12.3 MB     0.01
cull            1.250   12.5 %     2.5 MB     2.00
composite       8.500   85.0 %          -        -
frame          10.000  100.0 %";
        assert_eq!(stats.to_string(), expected);
        let expected = "\
stage              ms    share      bytes     GB/s
cull            1.250   12.8 %     2.5 MB     2.00
composite       8.500   87.2 %          -        -
sum             9.750  100.0 %";
        assert_eq!(stats.frame.to_string(), expected);
    }

    #[test]
    fn nothing_to_show() {
        let expected = "stage          ms    share      bytes     GB/s\nsum         0.000        -";
        assert_eq!(Profile::default().to_string(), expected);
    }

    #[test]
    fn bytes_in_units() {
        let known =
            [(999, "999 B"), (1000, "1.0 kB"), (999_949, "999.9 kB"), (999_950, "1.0 MB"), (2_500_000_000, "2.5 GB")];
        for (bytes, text) in known {
            assert_eq!(in_units(bytes), text);
        }
        assert_eq!(in_units(u64::MAX), "18446744.1 TB");
    }
}
