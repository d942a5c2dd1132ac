//! [`Profile`]: what each stage took, under the stage's own name; [`Stats`]: what one run did, as a table and as JSON.
//! [`Report`]: what many frames took, one by one, with [hints](Report::hints); [`Comparison`]: what changed between two of them.
//!
//! In: durations, bytes and counts from whoever runs the stages. Out: tables for a terminal, JSON and CSV for programs, a
//! [plot], a [trace](mod@trace) (feature `trace`).
//! To add a stage: time it under its file's name, it appears in its place. To add a figure: a field in `stats` or `report`.

mod clock;
mod compare;
mod csv;
mod distribution;
mod hints;
mod machine;
mod memory;
pub mod plot;
mod report;
mod report_table;
mod resample;
mod stats;
mod table;
#[cfg(feature = "trace")]
pub mod trace;

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

#[cfg(feature = "gpu")]
pub(crate) use clock::clock_ns;
pub use compare::{Change, Comparison, Difference, Ratio};
pub use distribution::{Distribution, quantile};
pub use hints::Hint;
pub use machine::{Machine, Program};
#[cfg(feature = "cli")]
pub use machine::{free_memory_bytes, load_average};
pub use memory::{anonymous_bytes, peak_rss_bytes};
pub use report::{FrameRecord, MeshRecord, Report, StageRecord, StageSummary, Views};
pub use stats::{CellStats, Exactness, GeometryStats, OrderStats, Stats};

/// Target of the `tracing` events, at `trace` level, that tell what a pass took on a GPU: `name`, `begin_ns` and `end_ns` on the clock of
/// [`trace`](mod@trace).
pub const GPU_PASS: &str = "gpu_pass";

/// Where a stage runs, and so whether its time is part of the frame's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Track {
    /// One after the other: the frame's time is the sum of these, and little else.
    #[default]
    Frame,
    /// On a thread of its own, while other stages run.
    Thread,
    /// On the GPU, by its own clock, while other stages run.
    Gpu,
}

impl Track {
    /// Whether it is [`Track::Frame`].
    pub fn is_frame(&self) -> bool {
        *self == Self::Frame
    }
}

/// What one stage took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageTime {
    /// The stage: its file, its benchmark group and its span bear the same name.
    pub name: &'static str,
    /// Wall time in milliseconds.
    pub duration_ms: f64,
    /// Bytes read and written, as the stage counts them; 0 where it does not.
    pub bytes: u64,
    /// Where it runs.
    pub track: Track,
}

/// The stages in the order in which they first ran, each once.
///
/// ```
/// use std::time::Duration;
/// use cellfan::profile::Profile;
/// let mut profile = Profile::default();
/// let sum = profile.time("cull", || (1..=4).sum::<u32>());
/// profile.add("sort", Duration::from_millis(3), 800);
/// profile.add("sort", Duration::from_millis(1), 200);
/// let sort = profile.get("sort").unwrap();
/// assert_eq!((sum, sort.duration_ms, sort.bytes), (10, 4.0, 1000));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    stages: Vec<StageTime>,
    /// The most of [`anonymous_bytes`] that a look at it found.
    peak_anonymous_bytes: Option<u64>,
}

impl Profile {
    /// Runs `work` in a span and adds its wall time to `stage`.
    pub fn time<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let _span = tracing::debug_span!("stage", name = stage).entered();
        let start = Instant::now();
        let value = work();
        self.add(stage, start.elapsed(), 0);
        value
    }

    /// Adds wall time and bytes to `stage`; a stage that is new comes last.
    pub fn add(&mut self, stage: &'static str, elapsed: Duration, bytes: u64) {
        self.add_beside(Track::Frame, stage, elapsed, bytes);
    }

    /// The same for a stage that ran on `track`.
    pub fn add_beside(&mut self, track: Track, stage: &'static str, elapsed: Duration, bytes: u64) {
        let end = self.stages.len();
        let stage = self.stage(stage, track, end);
        stage.duration_ms += elapsed.as_secs_f64() * 1e3;
        stage.bytes += bytes;
    }

    /// Looks at how much memory the process holds now.
    pub fn sample_memory(&mut self) {
        self.note_memory(anonymous_bytes());
    }

    /// Takes note of a look at [`anonymous_bytes`].
    pub fn note_memory(&mut self, bytes: Option<u64>) {
        self.peak_anonymous_bytes = self.peak_anonymous_bytes.max(bytes);
    }

    /// The most memory without a file behind it that a look found; none where nobody looked or the system does not say.
    pub fn peak_anonymous_bytes(&self) -> Option<u64> {
        self.peak_anonymous_bytes
    }

    /// The stages, in order.
    pub fn stages(&self) -> &[StageTime] {
        &self.stages
    }

    /// One stage; none where it never ran.
    pub fn get(&self, stage: &str) -> Option<&StageTime> {
        self.stages.iter().find(|s| s.name == stage)
    }

    /// The sum over the stages in milliseconds: more than the wall time where stages overlap.
    pub fn total_ms(&self) -> f64 {
        self.stages.iter().fold(0.0, |sum, s| sum + s.duration_ms)
    }

    /// Forgets every stage and keeps the memory: for the next frame.
    pub fn clear(&mut self) {
        self.stages.clear();
        self.peak_anonymous_bytes = None;
    }

    /// Adds all stages of `other`; those that are new come last.
    pub fn append(&mut self, other: &Self) {
        self.note_memory(other.peak_anonymous_bytes);
        for theirs in &other.stages {
            let end = self.stages.len();
            let ours = self.stage(theirs.name, theirs.track, end);
            ours.duration_ms += theirs.duration_ms;
            ours.bytes += theirs.bytes;
        }
    }

    /// The median frame: of each stage the median time and the median bytes; of the memory the peak of all frames.
    ///
    /// A frame without the stage counts as 0. A stage that only later frames have stands behind the one it followed.
    ///
    /// ```
    /// use std::time::Duration;
    /// use cellfan::profile::Profile;
    /// let frames = [1, 9, 2].map(|ms| {
    ///     let mut frame = Profile::default();
    ///     frame.add("cull", Duration::from_millis(ms), 100);
    ///     frame
    /// });
    /// assert_eq!(Profile::median(&frames).get("cull").unwrap().duration_ms, 2.0);
    /// ```
    #[must_use]
    pub fn median(frames: &[Self]) -> Self {
        let mut median = Self::default();
        for frame in frames {
            median.note_memory(frame.peak_anonymous_bytes);
            let mut place = 0;
            for stage in &frame.stages {
                median.stage(stage.name, stage.track, place);
                place = 1 + median.stages.iter().position(|s| s.name == stage.name).unwrap_or(place);
            }
        }
        for stage in &mut median.stages {
            let of = |value: fn(&StageTime) -> f64| {
                let mut values: Vec<_> = frames.iter().map(|frame| frame.get(stage.name).map_or(0.0, value)).collect();
                middle(&mut values).unwrap_or(0.0)
            };
            (stage.duration_ms, stage.bytes) = (of(|s| s.duration_ms), of(|s| s.bytes as f64) as u64);
        }
        median
    }

    /// The stage of that name, put in at `place` if it is new.
    fn stage(&mut self, name: &'static str, track: Track, place: usize) -> &mut StageTime {
        let i = self.stages.iter().position(|s| s.name == name).unwrap_or_else(|| {
            self.stages.insert(place, StageTime { name, duration_ms: 0.0, bytes: 0, track });
            place
        });
        &mut self.stages[i]
    }
}

/// The median; the mean of the middle two of an even number; none of none.
fn middle(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[half]),
        _ => Some(f64::midpoint(values[half - 1], values[half])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(stages: &[(&'static str, u64, u64)]) -> Profile {
        let mut profile = Profile::default();
        for &(name, ms, bytes) in stages {
            profile.add(name, Duration::from_millis(ms), bytes);
        }
        profile
    }

    #[test]
    fn stages_keep_their_order_and_add_up() {
        let mut p = profile(&[("read", 1, 5), ("cull", 2, 0), ("read", 3, 5)]);
        assert_eq!(p, profile(&[("read", 4, 10), ("cull", 2, 0)]));
        p.append(&profile(&[("write", 1, 1), ("cull", 1, 1)]));
        assert_eq!(p, profile(&[("read", 4, 10), ("cull", 3, 1), ("write", 1, 1)]));
        assert!((p.total_ms() - 8.0).abs() < 1e-12);
        p.clear();
        assert_eq!((p.get("cull"), p.stages().len()), (None, 0));
    }

    #[test]
    fn time_measures_and_returns() {
        let mut p = Profile::default();
        let value: Result<u8, ()> = p.time("cull", || {
            std::thread::sleep(Duration::from_millis(5));
            Ok(7)
        });
        assert_eq!(value, Ok(7));
        assert!(p.get("cull").unwrap().duration_ms >= 5.0);
    }

    #[test]
    fn what_runs_beside_the_frame_keeps_its_track() {
        let mut p = profile(&[("fans", 4, 0)]);
        p.add_beside(Track::Gpu, "gpu_draw", Duration::from_millis(9), 0);
        let mut sum = Profile::default();
        sum.append(&p);
        for kept in [&p, &sum, &Profile::median(&[p.clone(), p.clone()])] {
            assert_eq!(kept.stages().iter().map(|s| s.track).collect::<Vec<_>>(), [Track::Frame, Track::Gpu]);
        }
    }

    #[test]
    fn median_of_frames() {
        let a = profile(&[("upload", 50, 900), ("cull", 4, 10), ("draw", 6, 0)]);
        let b = profile(&[("cull", 8, 20), ("sort", 1, 30), ("draw", 2, 0)]);
        assert_eq!(Profile::median(&[]), Profile::default());
        assert_eq!(Profile::median(std::slice::from_ref(&a)), a);
        // Sort stands behind cull though the first frame had none; a missing stage counts as 0.
        let mut two = profile(&[("upload", 25, 450), ("cull", 6, 15), ("sort", 0, 15), ("draw", 4, 0)]);
        two.stages[2].duration_ms = 0.5;
        assert_eq!(Profile::median(&[a.clone(), b.clone()]), two);
        let three = profile(&[("upload", 0, 0), ("cull", 8, 20), ("sort", 1, 30), ("draw", 2, 0)]);
        assert_eq!(Profile::median(&[b.clone(), a, b]), three);
    }
}
