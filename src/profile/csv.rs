//! A [`Report`] as CSV: a row a frame, a column a stage.

use std::path::Path;

use super::Report;
use crate::Result;
use crate::atomic::{io_at, write_atomically};

impl Report {
    /// A row for each frame that counts: `frame`, `view`, `frame_ms`, `drawn_cells`, `covered_px`, then a column for each stage,
    /// `STAGE_ms`, 0 where it did not run.
    ///
    /// ```
    /// # use cellfan::profile::{FrameRecord, Profile, Report};
    /// let mut profile = Profile::default();
    /// profile.add("cull", std::time::Duration::from_millis(2), 0);
    /// let report = Report { frames: vec![FrameRecord::new(7, 3.5, &profile)], ..Report::default() };
    /// assert_eq!(report.to_csv(), "frame,view,frame_ms,drawn_cells,covered_px,cull_ms\n0,7,3.5,0,0,2.0\n");
    /// ```
    pub fn to_csv(&self) -> String {
        let stages = self.stages();
        let mut writer = csv::Writer::from_writer(Vec::new());
        let head = ["frame", "view", "frame_ms", "drawn_cells", "covered_px"].map(str::to_owned);
        let columns = stages.iter().map(|stage| format!("{}_ms", stage.name));
        // Memory takes any row.
        let _ = writer.write_record(head.into_iter().chain(columns));
        for (i, frame) in self.frames.iter().enumerate() {
            let head = [i.to_string(), frame.view.to_string(), format!("{:?}", frame.ms)];
            let counts = [frame.drawn_cells, frame.covered_px].map(|count| count.to_string());
            let times = stages.iter().map(|stage| format!("{:?}", frame.stage_ms(&stage.name)));
            let _ = writer.write_record(head.into_iter().chain(counts).chain(times));
        }
        writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
    }

    /// Writes it; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) where the system refuses to write.
    pub fn save_csv(&self, path: impl AsRef<Path>) -> Result<()> {
        use std::io::Write;
        let path = path.as_ref();
        write_atomically(path, |writer| writer.write_all(self.to_csv().as_bytes()).map_err(io_at(path)))
    }
}
