//! A [`Trace`] as a file.

use std::io::Write;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::{Lane, Trace, TraceSpan};
use crate::Result;
use crate::atomic::{io_at, write_atomically};

/// Numbers of the two "processes": threads, and the GPU.
const CPU: u32 = 1;
const GPU: u32 = 2;

impl Trace {
    /// The file: JSON in the Trace Event Format, times in microseconds.
    ///
    /// # Errors
    /// Those of `writer`.
    pub fn write(&self, mut writer: impl Write) -> std::io::Result<()> {
        let mut separator = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";
        let mut event = |event: Value| {
            writer.write_all(std::mem::replace(&mut separator, ",\n").as_bytes())?;
            serde_json::to_writer(&mut writer, &event).map_err(std::io::Error::from)
        };
        let name = |kind: &str, pid: u32, tid: u32, name: &str| json!({"ph": "M", "name": kind, "pid": pid, "tid": tid, "args": {"name": name}});
        event(name("process_name", CPU, 0, "cellfan"))?;
        for (&thread, thread_name) in &self.threads {
            event(name("thread_name", CPU, thread, thread_name))?;
        }
        if self.spans.iter().any(|span| span.lane == Lane::Gpu) {
            event(name("process_name", GPU, 0, "GPU"))?;
            event(name("thread_name", GPU, 0, "passes, by the GPU's clock, as early as their submission allows"))?;
        }
        for TraceSpan { name, lane, begin_ns, end_ns, which } in &self.spans {
            let (pid, tid) = match lane {
                Lane::Thread(number) => (CPU, *number),
                Lane::Gpu => (GPU, 0),
            };
            let us = |ns: u64| ns as f64 * 1e-3;
            let arguments: Map<String, Value> =
                which.iter().map(|&(key, value)| (key.to_owned(), value.into())).collect();
            let dur = us(end_ns.saturating_sub(*begin_ns));
            event(
                json!({"ph": "X", "name": name, "pid": pid, "tid": tid, "ts": us(*begin_ns), "dur": dur, "args": arguments}),
            )?;
        }
        writer.write_all(b"\n]}\n")
    }

    /// Writes the file; it appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) where the system refuses to write.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        write_atomically(path, |writer| self.write(writer).map_err(io_at(path)))
    }
}
