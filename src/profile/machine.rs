//! [`Machine`] and [`Program`]: where figures come from.

use serde::{Deserialize, Serialize};

/// The machine that figures were measured on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Machine {
    /// The processor's name; none where the system does not say (only Linux does here).
    pub cpu: Option<String>,
    /// Threads that run at once.
    pub cores: usize,
    /// The operating system.
    pub os: String,
    /// The instruction set architecture.
    pub arch: String,
}

impl Machine {
    /// This machine.
    ///
    /// ```
    /// # use cellfan::profile::Machine;
    /// assert!(Machine::this().cores >= 1);
    /// ```
    pub fn this() -> Self {
        Self {
            cpu: std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| cpu_name(&text)),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            os: std::env::consts::OS.to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
        }
    }
}

/// The first `model name : …` of proc(5)'s cpuinfo.
fn cpu_name(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    let name = line.split_once(':')?.1.split_whitespace().collect::<Vec<_>>().join(" ");
    (!name.is_empty()).then_some(name)
}

/// The program that was measured.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Program {
    /// The version of cellfan.
    pub version: String,
    /// The commit, where `CELLFAN_COMMIT` named it in the environment of the build.
    pub commit: Option<String>,
    /// Whether it was built with checks that cost time.
    pub has_debug_assertions: bool,
}

impl Program {
    /// This build.
    pub fn this() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: option_env!("CELLFAN_COMMIT").map(str::to_owned),
            has_debug_assertions: cfg!(debug_assertions),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processor_is_found_or_none() {
        let text = "processor\t: 0\nmodel\t\t: 17\nmodel name\t: AMD  EPYC 9V74\nprocessor\t: 1\n";
        assert_eq!(cpu_name(text), Some("AMD EPYC 9V74".to_owned()));
        assert_eq!(cpu_name("processor: 0\n"), None);
        assert_eq!(cpu_name("model name\t:\n"), None);
    }
}
