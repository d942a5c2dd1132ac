//! The JSON of a benchmark: what was measured on which machine, by which commit, with which settings.
//!
//! `--record DIR` puts it under its name into `DIR/<processor>/<date>.json`, in which each benchmark of a day has a place.

use std::fs;
use std::path::{Path, PathBuf};

use cellfan::Error;
use cellfan::io::{check_target, write_text};
use cellfan::profile::{Machine, load_average};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::session::{Common, Session};
use super::tables::Table;
use crate::cli::Outcome;

/// What a benchmark found.
pub(super) struct Report {
    /// Its name on the command line.
    pub(super) benchmark: &'static str,
    pub(super) settings: Value,
    pub(super) results: Value,
    pub(super) tables: Vec<Table>,
}

/// Anything as JSON.
pub(super) fn value(of: impl Serialize) -> Value {
    // Structs, sequences and maps with string keys: nothing in here can fail.
    serde_json::to_value(of).unwrap_or_default()
}

/// A record to be: what is known before the first run.
pub(super) struct Record {
    machine: Machine,
    date: String,
    load_average: Option<f64>,
    label: Option<String>,
    json: Option<PathBuf>,
    /// The file of today.
    file: Option<PathBuf>,
}

impl Record {
    /// Finds out before anything runs whether it can be written.
    pub(super) fn begin(common: &Common) -> cellfan::Result<Self> {
        let machine = Machine::here();
        let date = now();
        let file = match &common.record {
            None => None,
            Some(folder) => {
                let folder = folder.join(machine.slug());
                fs::create_dir_all(&folder).map_err(|source| Error::Io { path: folder.clone(), source })?;
                let path = folder.join(format!("{}.json", &date[..10]));
                read(&path)?;
                Some(path)
            }
        };
        let json = common.json.clone();
        json.as_deref().filter(|path| !is_stdout(path)).map(check_target).transpose()?;
        Ok(Self { machine, date, load_average: load_average(), label: common.label.clone(), json, file })
    }

    /// Writes what is asked for; the text for stdout.
    pub(super) fn finish(self, session: &Session, report: &Report) -> Outcome<String> {
        let record = json!({
            "benchmark": report.benchmark,
            "cellfan": env!("CARGO_PKG_VERSION"),
            "commit": commit(),
            "label": self.label,
            "build": if cfg!(debug_assertions) { "debug" } else { "release" },
            "date": self.date,
            "machine": self.machine,
            "load_average_before": self.load_average,
            "threads": rayon::current_num_threads(),
            "is_quick": session.is_quick,
            "warm_up": session.warm_up,
            "settings": report.settings,
            "results": report.results,
            "left_out": session.left_out,
        });
        if let Some(path) = &self.file {
            let mut of_today = read(path)?;
            of_today.insert(report.benchmark.to_owned(), record.clone());
            write_text(path, &pretty(&Value::Object(of_today)))?;
            tracing::info!("recorded in {}", path.display());
        }
        if let Some(path) = &self.json {
            if is_stdout(path) {
                return Ok(pretty(&record));
            }
            write_text(path, &pretty(&record))?;
            tracing::info!("wrote {}", path.display());
        }
        let tables: Vec<String> = report.tables.iter().map(ToString::to_string).collect();
        Ok(tables.join("\n"))
    }
}

fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}

/// Seconds of the present in UTC, as in `2026-01-31T12:00:00Z`.
fn now() -> String {
    let now = jiff::Timestamp::now();
    jiff::Timestamp::from_second(now.as_second()).unwrap_or(now).to_string()
}

/// The commit that was built, or that the environment says was.
fn commit() -> Option<String> {
    option_env!("CELLFAN_COMMIT").map(str::to_owned).or_else(|| std::env::var("CELLFAN_COMMIT").ok())
}

/// The records of a day; none where there is no file.
fn read(path: &Path) -> cellfan::Result<Map<String, Value>> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Map::new()),
        Err(source) => return Err(Error::Io { path: path.to_owned(), source }),
    };
    serde_json::from_str(&text).map_err(|error| Error::Malformed {
        path: path.to_owned(),
        place: format!("line {}", error.line()),
        problem: format!("this is no record of benchmarks, nothing is added to it: {error}"),
    })
}
