//! [`Stats`]: the figures of one run, and STATS.json.

use std::io::Write;
use std::path::Path;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::{Profile, middle};
use crate::Result;
use crate::atomic::{io_at, write_atomically};
use crate::camera::Region;

/// What became of the cells of one frame; every cell is counted once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CellStats {
    /// Cells in the mesh: the sum of those drawn, culled, degenerate, invalid and skipped.
    pub total: u64,
    /// Cells that were handed to the backend.
    pub drawn: u64,
    /// Cells left out because the transfer function makes them transparent throughout.
    pub culled_transparent: u64,
    /// Cells left out because they lie outside the view.
    pub culled_outside: u64,
    /// Cells without volume.
    pub degenerate: u64,
    /// Cells whose value is NaN or infinite.
    pub invalid: u64,
    /// Cells that are not drawn by their kind: points, lines, faces, ghosts, kinds not supported.
    pub skipped: u64,
    /// Drawn cells by projection class, in the order of the classes.
    #[serde(serialize_with = "as_map")]
    pub by_class: Vec<(&'static str, u64)>,
}

impl CellStats {
    /// The cells whose fate is known: `total`, where the counts are right.
    pub fn accounted(&self) -> u64 {
        self.drawn + self.culled_transparent + self.culled_outside + self.degenerate + self.invalid + self.skipped
    }
}

/// How far an order of the cells can be trusted.
///
/// In JSON `"exact"`, `"unverified"`, `{"cycles_broken": n}` or `{"cells_overlap": n}`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Exactness {
    /// Verified over shared faces, built from the visibility graph, or not needed by the model.
    Exact,
    /// A heuristic, or one whose conditions were not checked.
    #[default]
    Unverified,
    /// Built from the visibility graph, with this many cycles cut.
    CyclesBroken(u64),
    /// Built from the visibility graph of cells that overlap at this many faces; cycles are not told apart.
    CellsOverlap(u64),
}

/// The order in which cells were composited; a figure that nobody asked for is null.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct OrderStats {
    /// The sort, as it is named on the command line.
    pub kind: &'static str,
    /// How far it can be trusted.
    pub exactness: Exactness,
    /// Pairs of cells with a common face that are drawn the wrong way round.
    pub misordered_pairs: Option<u64>,
    /// Cycles in the visibility graph, all of them broken.
    pub cycles: Option<u64>,
    /// Layers of cells that do not overlap.
    pub layers: Option<u32>,
    /// Where the visibility graph has its neighbours from: `"stored"` in a container, or `"built"` from the cells.
    pub adjacency: Option<&'static str>,
    /// Places where compositing met a cell nearer than the one before it.
    pub violations: Option<u64>,
    /// Tiles composited again in another order.
    pub tiles_redone: u64,
}

/// What one run of the renderer did.
///
/// Its [`Display`](std::fmt::Display) is a table of the stages for a terminal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// What became of the cells, in the last frame.
    pub cells: CellStats,
    /// Triangles drawn in the last frame; 0 for a backend without triangles.
    pub triangles: u64,
    /// The order, in the last frame.
    pub order: OrderStats,
    /// Stages before the first frame: reading, ordering in space.
    pub before: Profile,
    /// Stages of the median frame ([`Profile::median`]).
    pub frame: Profile,
    /// Stages after the frames: encoding, writing.
    pub after: Profile,
    /// Wall time of each frame in milliseconds, from a camera to the finished picture in memory.
    pub frames: Vec<f64>,
    /// The backend: `cpu` or `gpu`.
    pub backend: &'static str,
    /// The name of the device; none on the CPU.
    pub adapter: Option<String>,
    /// Threads that ran the stages.
    pub threads: usize,
    /// The most memory the process held, in bytes ([`peak_rss_bytes`](super::peak_rss_bytes)).
    pub peak_rss_bytes: Option<u64>,
    /// The memory budget of a frame in bytes; none where there is none.
    pub memory_bytes: Option<u64>,
    /// Width and height of the whole picture in pixels.
    pub size_px: [u32; 2],
    /// The part of it that was drawn; none where that is all of it.
    pub region: Option<Region>,
}

impl Stats {
    /// The median wall time of a frame in milliseconds; none without a frame.
    ///
    /// ```
    /// # use cellfan::profile::Stats;
    /// let stats = Stats { frames: vec![4.0, 100.0, 5.0], ..Stats::default() };
    /// assert_eq!(stats.frame_ms(), Some(5.0));
    /// ```
    pub fn frame_ms(&self) -> Option<f64> {
        middle(&mut self.frames.clone())
    }

    /// All stages in the order of the pipeline: before, in and after the frame.
    pub fn stages(&self) -> Profile {
        let mut stages = self.before.clone();
        stages.append(&self.frame);
        stages.append(&self.after);
        stages
    }

    /// STATS.json, indented, with a newline at the end.
    ///
    /// ```
    /// # use cellfan::profile::Stats;
    /// let stats = Stats { frames: vec![2.5], backend: "cpu", threads: 2, ..Stats::default() };
    /// let json: serde_json::Value = serde_json::from_str(&stats.to_json())?;
    /// assert_eq!(json["frame_ms"], 2.5);
    /// # Ok::<(), serde_json::Error>(())
    /// ```
    pub fn to_json(&self) -> String {
        // Maps with string keys and numbers: nothing in here can fail.
        let mut json = serde_json::to_string_pretty(self).unwrap_or_default();
        json.push('\n');
        json
    }

    /// Writes STATS.json; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) where the system refuses to write.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        write_atomically(path, |writer| writer.write_all(self.to_json().as_bytes()).map_err(io_at(path)))
    }
}

impl Serialize for Stats {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut record = serializer.serialize_struct("Stats", 14)?;
        record.serialize_field("cells", &self.cells)?;
        record.serialize_field("triangles", &self.triangles)?;
        record.serialize_field("order", &self.order)?;
        record.serialize_field("stages", &self.stages())?;
        record.serialize_field("frame_ms", &self.frame_ms())?;
        record.serialize_field("frames", &self.frames)?;
        record.serialize_field("backend", &self.backend)?;
        record.serialize_field("adapter", &self.adapter)?;
        record.serialize_field("threads", &self.threads)?;
        record.serialize_field("peak_rss_bytes", &self.peak_rss_bytes)?;
        record.serialize_field("peak_anonymous_bytes", &self.stages().peak_anonymous_bytes())?;
        record.serialize_field("memory_bytes", &self.memory_bytes)?;
        record.serialize_field("size", &self.size_px)?;
        record.serialize_field("region", &self.region)?;
        record.end()
    }
}

impl Serialize for Profile {
    /// `{name: {"ms": …, "bytes": …}}`, in order.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Record {
            ms: f64,
            bytes: u64,
        }
        serializer.collect_map(self.stages().iter().map(|s| (s.name, Record { ms: s.duration_ms, bytes: s.bytes })))
    }
}

/// Pairs as a map that keeps their order.
fn as_map<S: Serializer>(pairs: &[(&'static str, u64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().copied())
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn json_is_literally_this() {
        let mut stats = Stats {
            cells: CellStats {
                total: 21,
                drawn: 6,
                culled_transparent: 5,
                culled_outside: 4,
                degenerate: 3,
                invalid: 2,
                skipped: 1,
                by_class: vec![("two", 2), ("one", 4)],
            },
            triangles: 9,
            order: OrderStats {
                kind: "topological",
                exactness: Exactness::CyclesBroken(3),
                misordered_pairs: Some(0),
                cycles: Some(3),
                layers: Some(43),
                adjacency: Some("built"),
                violations: None,
                tiles_redone: 7,
            },
            frames: vec![4.0, 1.5, 2.0, 3.0],
            backend: "cpu",
            threads: 2,
            peak_rss_bytes: Some(4096),
            memory_bytes: Some(8192),
            size_px: [3840, 1024],
            region: Some(Region { x0: 1280, y0: 0, x1: 2560, y1: 1024 }),
            ..Stats::default()
        };
        stats.before.add("read", Duration::from_millis(8), 640);
        stats.frame.add("cull", Duration::from_micros(500), 12);
        stats.frame.add("composite", Duration::from_millis(2), 0);
        stats.after.add("encode", Duration::from_millis(1), 64);
        stats.frame.note_memory(Some(2048));
        stats.after.note_memory(Some(1024));
        assert_eq!(stats.cells.accounted(), stats.cells.total);
        let expected = r#"{"cells":{"total":21,"drawn":6,"culled_transparent":5,"culled_outside":4,"degenerate":3,"invalid":2,"skipped":1,"by_class":{"two":2,"one":4}},"triangles":9,"order":{"kind":"topological","exactness":{"cycles_broken":3},"misordered_pairs":0,"cycles":3,"layers":43,"adjacency":"built","violations":null,"tiles_redone":7},"stages":{"read":{"ms":8.0,"bytes":640},"cull":{"ms":0.5,"bytes":12},"composite":{"ms":2.0,"bytes":0},"encode":{"ms":1.0,"bytes":64}},"frame_ms":2.5,"frames":[4.0,1.5,2.0,3.0],"backend":"cpu","adapter":null,"threads":2,"peak_rss_bytes":4096,"peak_anonymous_bytes":2048,"memory_bytes":8192,"size":[3840,1024],"region":[1280,0,2560,1024]}"#;
        assert_eq!(serde_json::to_string(&stats).unwrap(), expected);

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stats.json");
        stats.save(&path).unwrap();
        let saved = std::fs::read_to_string(&path).unwrap();
        assert!(saved.starts_with("{\n  \"cells\"") && saved.ends_with("}\n"), "{saved}");
        let (saved, expected): (serde_json::Value, serde_json::Value) =
            (serde_json::from_str(&saved).unwrap(), serde_json::from_str(expected).unwrap());
        assert_eq!(saved, expected);
    }

    #[test]
    fn exactness_in_json() {
        let json = |exactness: Exactness| serde_json::to_string(&exactness).unwrap();
        assert_eq!(json(Exactness::Exact), r#""exact""#);
        assert_eq!(json(Exactness::Unverified), r#""unverified""#);
        assert_eq!(json(Exactness::CyclesBroken(3)), r#"{"cycles_broken":3}"#);
        assert_eq!(json(Exactness::CellsOverlap(3)), r#"{"cells_overlap":3}"#);
    }

    #[test]
    fn no_frame_has_no_median() {
        let json: serde_json::Value = serde_json::from_str(&Stats::default().to_json()).unwrap();
        assert!(json["frame_ms"].is_null() && json["peak_rss_bytes"].is_null());
        assert_eq!(json["stages"], serde_json::json!({}));
        assert_eq!(json["frames"], serde_json::json!([]));
    }

    #[test]
    fn unwritable_stats_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = Stats::default().save(folder.path().join("no/stats.json")).unwrap_err().to_string();
        assert!(error.contains("stats.json: there is no folder"), "{error}");
    }
}
