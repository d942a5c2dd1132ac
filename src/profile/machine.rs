//! [`Machine`] and [`Program`]: what a figure was measured on, as far as a reader needs it to compare: no names of hosts or users.

use serde::{Deserialize, Serialize};
#[cfg(feature = "cli")]
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

#[cfg(feature = "cli")]
use crate::memory;

/// The machine that figures were measured on.
///
/// ```
/// # use cellfan::profile::Machine;
/// let machine = Machine::here();
/// assert!(machine.threads >= 1);
/// let json = serde_json::to_string(&machine)?;
/// assert_eq!(serde_json::from_str::<Machine>(&json)?, machine);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Machine {
    /// The processor's name, where the system says (only Linux does here).
    pub cpu: Option<String>,
    /// Physical cores, where the system says (feature `cli`).
    pub cores: Option<usize>,
    /// Threads that run at once.
    pub threads: usize,
    /// Memory in bytes, where the system says (feature `cli`).
    pub memory_bytes: Option<u64>,
    /// The operating system, with its version where that is known (feature `cli`).
    pub os: String,
    /// The architecture, such as `x86_64`.
    pub architecture: String,
    /// The widest vector instructions that the processor has: `avx512` (F, BW, DQ, VL), `avx2` or `sse2`; `neon`; else
    /// `scalar`.
    pub instruction_set: String,
}

impl Machine {
    /// The machine this runs on.
    pub fn here() -> Self {
        let cpu = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| cpu_name(&text));
        let machine = Self {
            cpu,
            cores: None,
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            memory_bytes: None,
            os: std::env::consts::OS.to_owned(),
            architecture: std::env::consts::ARCH.to_owned(),
            instruction_set: instruction_set().to_owned(),
        };
        #[cfg(feature = "cli")]
        let machine = machine.with_details();
        machine
    }

    #[cfg(feature = "cli")]
    fn with_details(self) -> Self {
        let memory = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
        let memory_bytes = System::new_with_specifics(memory).total_memory();
        Self {
            cores: System::physical_core_count(),
            memory_bytes: (memory_bytes > 0).then_some(memory_bytes),
            os: System::long_os_version().unwrap_or(self.os),
            ..self
        }
    }

    /// The processor's name as part of a file's: small letters, digits, and a `-` for anything else.
    ///
    /// ```
    /// # use cellfan::profile::Machine;
    /// let machine = Machine { cpu: Some("AMD EPYC(tm) 9B45".into()), ..Machine::here() };
    /// assert_eq!(machine.slug(), "amd-epyc-tm-9b45");
    /// ```
    pub fn slug(&self) -> String {
        let cpu = self.cpu.as_deref().unwrap_or("unknown processor");
        let words = cpu.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        words.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
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

/// Bytes of memory that can be taken without swapping, of the machine and of the control group that this process is in.
///
/// ```
/// # use cellfan::profile::free_memory_bytes;
/// assert!(free_memory_bytes() > 1 << 20);
/// ```
#[cfg(feature = "cli")]
pub fn free_memory_bytes() -> u64 {
    memory::free_bytes().unwrap_or_else(|| {
        let wanted = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
        System::new_with_specifics(wanted).available_memory()
    })
}

/// How many threads of all processes wanted to run in the last minute, on average: more than few before a measurement, and the
/// machine is not quiet. None where the system does not count them.
///
/// ```
/// # use cellfan::profile::load_average;
/// assert!(load_average().is_none_or(|threads| threads >= 0.0));
/// ```
#[cfg(feature = "cli")]
pub fn load_average() -> Option<f64> {
    cfg!(unix).then(|| System::load_average().one)
}

fn instruction_set() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        let has_avx512 = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        match () {
            () if has_avx512 => "avx512",
            () if is_x86_feature_detected!("avx2") => "avx2",
            () => "sse2",
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    if cfg!(target_arch = "aarch64") { "neon" } else { "scalar" }
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
