//! [`Report`]: what each of many frames took, where, and with which settings; PROFILE.json.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Distribution, Machine, Profile, Program, Track};
use crate::atomic::{io_at, write_atomically};
use crate::{Error, Result};

/// What one stage took in one frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageRecord {
    /// The stage.
    pub name: String,
    /// Milliseconds.
    pub ms: f64,
    /// Bytes read and written, as the stage counts them; 0 where it does not.
    #[serde(default)]
    pub bytes: u64,
    /// Where it ran.
    #[serde(default, skip_serializing_if = "Track::is_frame")]
    pub track: Track,
}

/// What one frame took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameRecord {
    /// The view: frames of two runs with the same views and numbers show the same.
    pub view: u32,
    /// From the camera to the finished picture, in milliseconds.
    pub ms: f64,
    /// Cells that were composited.
    pub drawn_cells: u64,
    /// Pixels that show something.
    pub covered_px: u64,
    /// The stages, in order.
    pub stages: Vec<StageRecord>,
}

impl FrameRecord {
    /// A frame of `ms` milliseconds with the stages of `profile`.
    pub fn new(view: u32, ms: f64, profile: &Profile) -> Self {
        let record = |stage: &super::StageTime| StageRecord {
            name: stage.name.to_owned(),
            ms: stage.duration_ms,
            bytes: stage.bytes,
            track: stage.track,
        };
        Self { view, ms, stages: profile.stages().iter().map(record).collect(), ..Self::default() }
    }

    /// What a stage took in milliseconds; 0 where it did not run.
    pub fn stage_ms(&self, name: &str) -> f64 {
        self.stages.iter().find(|stage| stage.name == name).map_or(0.0, |stage| stage.ms)
    }

    /// What no stage of the frame accounts for, in milliseconds.
    pub fn other_ms(&self) -> f64 {
        let stages: f64 = self.stages.iter().filter(|stage| stage.track.is_frame()).map(|stage| stage.ms).sum();
        (self.ms - stages).max(0.0)
    }
}

/// The mesh that was drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct MeshRecord {
    /// What it is called.
    pub name: String,
    /// Cells, those included that are not drawn.
    pub cells: u64,
    /// Vertices.
    pub vertices: u64,
}

/// From where it was drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Views {
    /// The first camera, as a camera file.
    pub camera: Value,
    /// How far the eye turns over all frames, in degrees.
    pub orbit_degrees: f64,
    /// Frames that count.
    pub frames: u32,
}

/// One stage over all frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageSummary {
    /// The stage.
    pub name: String,
    /// Where it runs.
    pub track: Track,
    /// Milliseconds a frame; 0 in frames without it.
    pub ms: Distribution,
    /// Median of bytes a frame.
    pub bytes: u64,
    /// Median milliseconds over the median frame's.
    pub share: f64,
}

/// What many frames took.
///
/// Its [`Display`](std::fmt::Display) is a table for a terminal.
///
/// ```
/// use std::time::Duration;
/// use cellfan::profile::{FrameRecord, Profile, Report};
/// let mut report = Report::default();
/// for view in 0..100 {
///     let mut profile = Profile::default();
///     profile.add("composite", Duration::from_millis(6 + u64::from(view % 3)), 0);
///     report.frames.push(FrameRecord::new(view, 10.0, &profile));
/// }
/// assert_eq!(report.frame_ms().unwrap().p95, 10.0);
/// assert_eq!(report.stages()[0].share, 0.7);
/// assert_eq!(Report::from_json(&report.to_json())?, report);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The program.
    #[serde(default)]
    pub program: Program,
    /// The machine.
    #[serde(default)]
    pub machine: Machine,
    /// The mesh.
    #[serde(default)]
    pub mesh: MeshRecord,
    /// The views.
    #[serde(default)]
    pub views: Views,
    /// Everything else that was chosen: backend, threads, model …, by name.
    #[serde(default)]
    pub settings: BTreeMap<String, Value>,
    /// Stages before the first frame: reading, ordering in space.
    #[serde(default)]
    pub before: Vec<StageRecord>,
    /// Frames that do not count, the first of all first.
    #[serde(default)]
    pub warm_up: Vec<FrameRecord>,
    /// Frames that count.
    pub frames: Vec<FrameRecord>,
    /// Some of the views again, at half the width and height, after all others.
    #[serde(default)]
    pub half_size: Vec<FrameRecord>,
    /// The most memory the process held, in bytes; mapped files included.
    #[serde(default)]
    pub peak_rss_bytes: Option<u64>,
    /// The most memory a look in the frames found, in bytes; mapped files left out.
    #[serde(default)]
    pub peak_anonymous_bytes: Option<u64>,
}

/// The first key of the file: what it is.
const FORMAT: &str = "cellfan profile 1";

impl Report {
    /// Frame times in milliseconds; none without a frame.
    pub fn frame_ms(&self) -> Option<Distribution> {
        Distribution::of(self.frames.iter().map(|frame| frame.ms))
    }

    /// Frames a second, by the median frame.
    pub fn frames_per_second(&self) -> Option<f64> {
        self.frame_ms().map(|ms| 1e3 / ms.median)
    }

    /// Cells of the mesh over the time of the median frame, a second.
    pub fn cells_per_second(&self) -> Option<f64> {
        self.frames_per_second().map(|rate| rate * self.mesh.cells as f64)
    }

    /// The stages in the order in which they run.
    pub fn stages(&self) -> Vec<StageSummary> {
        let Some(frame) = self.frame_ms() else { return Vec::new() };
        let summary = |(name, track): (String, Track)| {
            let ms = Distribution::of(self.frames.iter().map(|frame| frame.stage_ms(&name)))?;
            let bytes =
                |frame: &FrameRecord| frame.stages.iter().find(|s| s.name == name).map_or(0, |s| s.bytes) as f64;
            let bytes = Distribution::of(self.frames.iter().map(bytes))?.median as u64;
            Some(StageSummary { track, ms, bytes, share: ms.median / frame.median, name })
        };
        self.stage_names().into_iter().filter_map(summary).collect()
    }

    /// What no stage accounts for, in milliseconds a frame.
    pub fn other_ms(&self) -> Option<Distribution> {
        Distribution::of(self.frames.iter().map(FrameRecord::other_ms))
    }

    /// Names of all stages of frames that count: one that only later frames have stands behind the one it followed.
    fn stage_names(&self) -> Vec<(String, Track)> {
        let mut names: Vec<(String, Track)> = Vec::new();
        for frame in &self.frames {
            let mut place = 0;
            for stage in &frame.stages {
                let known = names.iter().position(|(name, _)| *name == stage.name);
                if known.is_none() {
                    names.insert(place, (stage.name.clone(), stage.track));
                }
                place = known.unwrap_or(place) + 1;
            }
        }
        names
    }

    /// PROFILE.json, indented, with a newline at the end: the report, and what it comes to.
    pub fn to_json(&self) -> String {
        #[derive(Serialize)]
        struct Figures {
            frames_per_second: Option<f64>,
            cells_per_second: Option<f64>,
            frame_ms: Option<Distribution>,
            other_ms: Option<Distribution>,
            stages: Vec<StageSummary>,
            hints: Vec<super::Hint>,
        }
        #[derive(Serialize)]
        struct File<'a> {
            format: &'static str,
            figures: Figures,
            #[serde(flatten)]
            report: &'a Report,
        }
        let figures = Figures {
            frames_per_second: self.frames_per_second(),
            cells_per_second: self.cells_per_second(),
            frame_ms: self.frame_ms(),
            other_ms: self.other_ms(),
            stages: self.stages(),
            hints: self.hints(),
        };
        // Maps with string keys and numbers: nothing in here can fail.
        let mut json =
            serde_json::to_string_pretty(&File { format: FORMAT, figures, report: self }).unwrap_or_default();
        json.push('\n');
        json
    }

    /// Reads what [`Report::to_json`] wrote; what it comes to is found again.
    ///
    /// # Errors
    /// [`Error::Profile`] where it is something else.
    pub fn from_json(text: &str) -> Result<Self> {
        #[derive(Deserialize)]
        struct Head {
            format: Option<String>,
        }
        let refuse = |problem: String| Error::Profile { problem };
        let not_json = |error: serde_json::Error| refuse(format!("it cannot be read: {error}"));
        let head: Head = serde_json::from_str(text).map_err(not_json)?;
        if head.format.as_deref() != Some(FORMAT) {
            let found = head.format.map_or("says nothing".to_owned(), |format| format!("says {format:?}"));
            let problem =
                format!("its \"format\" {found}, not {FORMAT:?}; write one with cellfan profile MESH --stats OUT.json");
            return Err(refuse(problem));
        }
        let report: Self = serde_json::from_str(text).map_err(not_json)?;
        let all = report.frames.iter().chain(&report.warm_up).chain(&report.half_size);
        let mut times = all.flat_map(|frame| frame.stages.iter().map(|stage| stage.ms).chain([frame.ms]));
        if times.any(|ms| !ms.is_finite() || ms < 0.0) {
            return Err(refuse("a time in it is negative or not a number".to_owned()));
        }
        Ok(report)
    }

    /// Reads PROFILE.json.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Profile`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(io_at(path))?;
        Self::from_json(&text).map_err(|error| error.in_file(path))
    }

    /// Writes PROFILE.json; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`] where the system refuses to write.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        write_atomically(path, |writer| writer.write_all(self.to_json().as_bytes()).map_err(io_at(path)))
    }
}

#[cfg(test)]
mod tests;
