//! A [`Report`] as a table for a terminal, with its hints below.

use std::fmt::{Display, Formatter, Result};

use super::table::in_units;
use super::{Distribution, Report, StageSummary};
use crate::camera::Region;

impl Display for Report {
    /// What was measured, the frame times, a line a stage, what ran beside them, hints.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Some(frame) = self.frame_ms() else { return write!(f, "no frames") };
        writeln!(f, "{}", self.heading())?;
        writeln!(f, "{}\n", self.origin())?;

        writeln!(f, "{:16} {:>10} {:>10} {:>10} {:>10} {:>10}", "", "median", "95 %", "99 %", "least", "most")?;
        let Distribution { median, p95, p99, least, most, .. } = frame;
        let times = [median, p95, p99, least, most];
        numbers(f, "frame, ms", times, 3)?;
        numbers(f, "frames/s", times.map(|ms| 1e3 / ms), 2)?;
        numbers(f, "million cells/s", times.map(|ms| self.mesh.cells as f64 / ms * 1e-3), 3)?;

        let (in_frame, beside): (Vec<_>, Vec<_>) = self.stages().into_iter().partition(|stage| stage.track.is_frame());
        let width = in_frame.iter().chain(&beside).map(|stage| stage.name.chars().count()).max().unwrap_or(0).max(16);
        writeln!(
            f,
            "\n{:width$} {:>10} {:>8} {:>10} {:>10} {:>8}",
            "stage", "median ms", "share", "95 % ms", "bytes", "GB/s"
        )?;
        for stage in &in_frame {
            line(f, width, stage)?;
        }
        if let Some(other) = self.other_ms() {
            let share = format!("{:.1} %", 100.0 * other.median / median);
            writeln!(
                f,
                "{:width$} {:>10.3} {share:>8} {:>10.3} {:>10} {:>8}",
                "other", other.median, other.p95, "-", "-"
            )?;
        }
        if !beside.is_empty() {
            writeln!(f, "meanwhile, on the GPU or a thread of its own:")?;
            for stage in &beside {
                line(f, width, stage)?;
            }
        }
        for hint in self.hints() {
            write!(f, "\n- {}", hint.text)?;
        }
        Ok(())
    }
}

impl Report {
    /// What was drawn.
    pub(super) fn heading(&self) -> String {
        let side = |name: &str| self.views.camera.get(name).and_then(serde_json::Value::as_u64);
        let region: Option<Region> =
            self.views.camera.get("region").and_then(|region| serde_json::from_value(region.clone()).ok());
        let part = region.map_or_else(String::new, |region| format!(" (region {region})"));
        let size = side("width").zip(side("height")).map(|(width, height)| format!(", {width}x{height}{part}"));
        let orbit = match self.views.orbit_degrees {
            0.0 => String::new(),
            degrees => format!(" over {degrees} degrees"),
        };
        format!(
            "{}: {} cells{}, {} frames{orbit}{}",
            self.mesh.name,
            grouped(self.mesh.cells),
            size.unwrap_or_default(),
            self.frames.len(),
            self.setting("adapter").or_else(|| self.setting("backend")).map(|by| format!(", {by}")).unwrap_or_default(),
        )
    }

    /// By what it was drawn.
    pub(super) fn origin(&self) -> String {
        let threads = self.setting("threads").map(|threads| format!(", {threads} threads")).unwrap_or_default();
        let commit = self.program.commit.as_ref().map(|commit| format!(" ({commit})")).unwrap_or_default();
        format!(
            "{}, {} cores{threads}, {} {}; cellfan {}{commit}",
            self.machine.cpu.as_deref().unwrap_or("unknown processor"),
            self.machine.cores.unwrap_or(self.machine.threads),
            self.machine.os,
            self.machine.architecture,
            self.program.version
        )
    }

    /// A setting in words.
    pub(super) fn setting(&self, name: &str) -> Option<String> {
        match self.settings.get(name)? {
            serde_json::Value::Null => None,
            serde_json::Value::String(text) => Some(text.clone()),
            other => Some(other.to_string()),
        }
    }
}

fn numbers(f: &mut Formatter<'_>, name: &str, values: [f64; 5], digits: usize) -> Result {
    write!(f, "{name:16}")?;
    values.iter().try_for_each(|value| write!(f, " {value:>10.digits$}"))?;
    writeln!(f)
}

fn line(f: &mut Formatter<'_>, width: usize, stage: &StageSummary) -> Result {
    let StageSummary { name, ms, bytes, share, .. } = stage;
    let share = format!("{:.1} %", 100.0 * share);
    let (bytes, rate) = match *bytes {
        0 => ("-".into(), "-".into()),
        bytes if ms.median > 0.0 => (in_units(bytes), format!("{:.2}", bytes as f64 / ms.median * 1e-6)),
        bytes => (in_units(bytes), "-".into()),
    };
    writeln!(f, "{name:width$} {:>10.3} {share:>8} {:>10.3} {bytes:>10} {rate:>8}", ms.median, ms.p95)
}

/// Digits in groups of three.
pub(super) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(",")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::{FrameRecord, Profile, Track};
    use super::*;

    #[test]
    fn table_is_aligned() {
        let mut report = Report::default();
        report.mesh.name = "m.vtu".to_owned();
        report.mesh.cells = 1_234_567;
        report.machine.threads = 2;
        report.views.camera = serde_json::json!({"width": 64, "height": 32});
        report.views.orbit_degrees = 360.0;
        report.settings.insert("backend".to_owned(), "gpu".into());
        report.settings.insert("threads".to_owned(), 2.into());
        for view in 0..3 {
            let mut profile = Profile::default();
            profile.add("cull", Duration::from_millis(2), 4_000_000);
            profile.add("composite", Duration::from_millis(7), 0);
            profile.add_beside(Track::Gpu, "gpu_draw", Duration::from_millis(5), 0);
            report.frames.push(FrameRecord::new(view, 10.0, &profile));
        }
        let text = report.to_string();
        let table = text.split("\n- ").next().unwrap();
        let expected = "\
m.vtu: 1,234,567 cells, 64x32, 3 frames over 360 degrees, gpu
unknown processor, 2 cores, 2 threads,  ; cellfan 

                     median       95 %       99 %      least       most
frame, ms            10.000     10.000     10.000     10.000     10.000
frames/s             100.00     100.00     100.00     100.00     100.00
million cells/s     123.457    123.457    123.457    123.457    123.457

stage             median ms    share    95 % ms      bytes     GB/s
cull                  2.000   20.0 %      2.000     4.0 MB     2.00
composite             7.000   70.0 %      7.000          -        -
other                 1.000   10.0 %      1.000          -        -
meanwhile, on the GPU or a thread of its own:
gpu_draw              5.000   50.0 %      5.000          -        -
";
        assert_eq!(table, expected);
        assert_eq!(Report::default().to_string(), "no frames");
        report.views.camera = serde_json::json!({"width": 64, "height": 32, "region": [0, 0, 32, 16]});
        assert!(report.to_string().starts_with("m.vtu: 1,234,567 cells, 64x32 (region 0,0,32,16), 3 frames"));
    }

    #[test]
    fn digits_in_groups() {
        assert_eq!([0, 999, 1000, 12_345_678].map(grouped), ["0", "999", "1,000", "12,345,678"]);
    }
}
