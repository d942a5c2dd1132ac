//! [`Comparison`]: what changed between two [`Report`]s beyond the noise of their frames.
//!
//! Where both drew the same views, frames are compared view by view, by the median of b/a: how views differ then cancels. Else by the
//! ratio of medians. Intervals are [resampled in blocks](super::resample) and hold together: each is wide enough that with the
//! chance of [`CONFIDENCE`] all of them hold the truth. They know the noise within two runs, not what differs from one start of a
//! program to the next (where memory lies, how warm the machine is): only more runs tell that.

use std::fmt::{self, Display, Formatter};

use serde_json::Value;

use super::report_table::grouped;
use super::resample::{FEWEST, median_interval, ratio_interval};
use super::{FrameRecord, Report, quantile};

/// The chance that all intervals of a comparison hold.
const CONFIDENCE: f64 = 0.95;

/// Something that is not the same in both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// What: `mesh.cells`, `settings.sort`.
    pub what: String,
    /// In the first.
    pub a: String,
    /// In the second.
    pub b: String,
}

/// How many times longer something took in the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// As measured.
    pub value: f64,
    /// The interval's lower end.
    pub low: f64,
    /// The interval's upper end.
    pub high: f64,
}

/// The frame, or a stage, in both.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The stage, or `frame`.
    pub name: String,
    /// Median milliseconds in the first; none where it did not run.
    pub a_ms: Option<f64>,
    /// The same in the second.
    pub b_ms: Option<f64>,
    /// b/a; none where there are too few frames or a time is 0.
    pub ratio: Option<Ratio>,
}

impl Change {
    /// Whether it took longer, or less long, than noise explains.
    pub fn is_beyond_noise(&self) -> bool {
        self.ratio.is_some_and(|ratio| ratio.low > 1.0 || ratio.high < 1.0)
    }

    fn verdict(&self) -> String {
        match (self.a_ms, self.b_ms, self.ratio) {
            (Some(_), None, _) => "only in a".to_owned(),
            (None, Some(_), _) => "only in b".to_owned(),
            (.., None) => "cannot be told".to_owned(),
            (.., Some(ratio)) if self.is_beyond_noise() && ratio.value > 1.0 => {
                format!("slower by {}", percent(ratio.value - 1.0))
            }
            (.., Some(ratio)) if self.is_beyond_noise() => format!("faster by {}", percent(1.0 - ratio.value)),
            _ => "within the noise".to_owned(),
        }
    }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// Two reports, side by side.
///
/// Its [`Display`] is a table for a terminal.
///
/// ```
/// use cellfan::profile::{Comparison, FrameRecord, Profile, Report};
/// let report = |scale: f64| {
///     let ms = |view: u32| scale * (10.0 + f64::from(view % 7));
///     let frames = (0..50).map(|view| FrameRecord::new(view, ms(view), &Profile::default())).collect();
///     Report { frames, ..Report::default() }
/// };
/// let comparison = Comparison::new(&report(1.0), &report(1.1));
/// assert!(comparison.is_paired && comparison.changes[0].is_beyond_noise());
/// assert!((comparison.changes[0].ratio.unwrap().value - 1.1).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What is not the same: mesh, views, machine, program, settings.
    pub differences: Vec<Difference>,
    /// Whether frames were compared view by view.
    pub is_paired: bool,
    /// Frames in each.
    pub frames: [usize; 2],
    /// The frame, then the stages, then what no stage accounts for.
    pub changes: Vec<Change>,
}

impl Comparison {
    /// Compares `b` with `a`.
    pub fn new(a: &Report, b: &Report) -> Self {
        let views = |report: &Report| report.frames.iter().map(|frame| frame.view).collect::<Vec<_>>();
        let is_paired = a.views == b.views && views(a) == views(b);
        let names = names(a, b);
        // Bonferroni: each may be wrong with its part of what all may.
        let confidence = 1.0 - (1.0 - CONFIDENCE) / (names.len() + 2) as f64;
        let change = |name: &str, of: &dyn Fn(&FrameRecord) -> Option<f64>| {
            let times = [a, b].map(|report| report.frames.iter().map(of).collect::<Option<Vec<f64>>>());
            change(name, times, is_paired, confidence)
        };
        let mut changes = vec![change("frame", &|frame| Some(frame.ms))];
        for name in &names {
            // A frame without a stage that others have: it took no time.
            let has = |report: &Report| report.frames.iter().any(|f| f.stages.iter().any(|s| s.name == *name));
            let (in_a, in_b) = (has(a), has(b));
            let mut row = change(name, &|frame| Some(frame.stage_ms(name)));
            (row.a_ms, row.b_ms) = (row.a_ms.filter(|_| in_a), row.b_ms.filter(|_| in_b));
            changes.push(row);
        }
        changes.push(change("other", &|frame| Some(frame.other_ms())));
        Self { differences: differences(a, b), is_paired, frames: [a.frames.len(), b.frames.len()], changes }
    }

    /// What changed beyond noise, the frame first.
    pub fn beyond_noise(&self) -> impl Iterator<Item = &Change> {
        self.changes.iter().filter(|change| change.is_beyond_noise())
    }
}

/// Names of the stages of both, in the order of the first.
fn names(a: &Report, b: &Report) -> Vec<String> {
    let mut names: Vec<String> = a.stages().into_iter().map(|stage| stage.name).collect();
    for stage in b.stages() {
        if !names.contains(&stage.name) {
            names.push(stage.name);
        }
    }
    names
}

fn change(name: &str, times: [Option<Vec<f64>>; 2], is_paired: bool, confidence: f64) -> Change {
    let [a, b] = times.map(Option::unwrap_or_default);
    let ratio = if is_paired {
        let ratios: Vec<f64> = a.iter().zip(&b).filter(|&(&a, &b)| a > 0.0 && b > 0.0).map(|(a, b)| b / a).collect();
        // A stage that runs in some frames only says nothing of the others.
        let is_enough = 2 * ratios.len() > a.len();
        median(&ratios).zip(median_interval(&ratios, confidence)).filter(|_| is_enough)
    } else {
        let value = median(&a).zip(median(&b)).map(|(a, b)| b / a);
        value.zip(ratio_interval(&a, &b, confidence))
    };
    let finite = |(value, [low, high]): (f64, [f64; 2])| {
        [value, low, high].iter().all(|x| x.is_finite() && *x > 0.0).then_some(Ratio { value, low, high })
    };
    Change { name: name.to_owned(), a_ms: median(&a), b_ms: median(&b), ratio: ratio.and_then(finite) }
}

fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, 0.5)
}

/// Everything that was recorded beside times and is not the same.
fn differences(a: &Report, b: &Report) -> Vec<Difference> {
    let facts = |report: &Report| {
        let mut facts = Vec::new();
        // Numbers and names only: nothing in here can fail.
        let value = |part: serde_json::Result<Value>| part.unwrap_or_default();
        for (name, part) in [
            ("mesh", value(serde_json::to_value(&report.mesh))),
            ("views", value(serde_json::to_value(&report.views))),
            ("machine", value(serde_json::to_value(&report.machine))),
            ("program", value(serde_json::to_value(&report.program))),
            ("settings", value(serde_json::to_value(&report.settings))),
        ] {
            flatten(name, &part, &mut facts);
        }
        facts
    };
    let (a, b) = (facts(a), facts(b));
    let find = |facts: &[(String, Value)], what: &str| {
        facts.iter().find(|(name, _)| name == what).map(|(_, value)| value.clone())
    };
    let mut all: Vec<&String> = a.iter().chain(&b).map(|(name, _)| name).collect();
    let mut seen = std::collections::HashSet::new();
    all.retain(|name| seen.insert(*name));
    let of = |name: &String| (name.clone(), find(&a, name).unwrap_or_default(), find(&b, name).unwrap_or_default());
    let differ =
        |(what, a, b): (String, Value, Value)| (a != b).then(|| Difference { what, a: in_words(&a), b: in_words(&b) });
    all.into_iter().map(of).filter_map(differ).collect()
}

/// Values by dotted names; lists are values.
fn flatten(name: &str, value: &Value, facts: &mut Vec<(String, Value)>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| flatten(&format!("{name}.{key}"), value, facts)),
        other => facts.push((name.to_owned(), other.clone())),
    }
}

fn in_words(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        Value::String(text) => text.clone(),
        Value::Number(number) => number.as_u64().map_or_else(|| number.to_string(), grouped),
        other => other.to_string(),
    }
}

impl Display for Comparison {
    /// What differs, a line for the frame and each stage, and in a sentence what changed.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for Difference { what, a, b } in &self.differences {
            writeln!(f, "differs: {what}: {a} -> {b}")?;
        }
        if self.differences.is_empty() {
            writeln!(f, "same mesh, views, machine, program and settings")?;
        }
        let [a, b] = self.frames;
        if self.is_paired {
            writeln!(f, "{a} frames, compared view by view")?;
        } else {
            writeln!(f, "{a} and {b} frames of other views, compared by their medians")?;
        }
        let width = self.changes.iter().map(|change| change.name.chars().count()).max().unwrap_or(0).max(5);
        writeln!(f, "\n{:width$} {:>10} {:>10} {:>7}   {:15}", "", "a, ms", "b, ms", "b/a", "interval")?;
        for change in &self.changes {
            let ms = |ms: Option<f64>| ms.map_or("-".to_owned(), |ms| format!("{ms:.3}"));
            let (value, interval) =
                change.ratio.map_or(("-".to_owned(), "-".to_owned()), |Ratio { value, low, high }| {
                    (format!("{value:.3}"), format!("{low:.3} to {high:.3}"))
                });
            let (a, b, verdict) = (ms(change.a_ms), ms(change.b_ms), change.verdict());
            writeln!(f, "{:width$} {a:>10} {b:>10} {value:>7}   {interval:15}  {verdict}", change.name)?;
        }
        let changed: Vec<String> = self.beyond_noise().map(|c| format!("{} {}", c.name, c.verdict())).collect();
        if a.min(b) < FEWEST {
            write!(f, "\nnothing can be told from fewer than {FEWEST} frames")
        } else if changed.is_empty() {
            write!(f, "\nnothing changed beyond the noise of these two runs")
        } else {
            write!(f, "\nbeyond the noise of these two runs: {}", changed.join(", "))
        }?;
        let percent = 100.0 * CONFIDENCE;
        write!(
            f,
            "\n(all intervals hold with {percent:.0} %; what differs from one start of the program to the next is not in them)"
        )
    }
}

#[cfg(test)]
mod tests;
