//! [`Machine`]: what a figure was measured on, as far as a reader needs it to compare: no names of hosts or users.

use serde::{Deserialize, Serialize};
use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

use crate::memory;

/// The machine that a figure was measured on.
///
/// ```
/// # use cellfan::profile::Machine;
/// let machine = Machine::here();
/// assert!(machine.threads >= 1 && machine.memory_bytes > 1 << 20);
/// let json = serde_json::to_string(&machine)?;
/// assert_eq!(serde_json::from_str::<Machine>(&json)?, machine);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's name, as it tells it.
    pub cpu: String,
    /// Physical cores, where the system says.
    pub cores: Option<usize>,
    /// Threads that run at once.
    pub threads: usize,
    /// Memory in bytes.
    pub memory_bytes: u64,
    /// The operating system with its version.
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
        let wanted = RefreshKind::nothing()
            .with_cpu(CpuRefreshKind::nothing())
            .with_memory(MemoryRefreshKind::nothing().with_ram());
        let system = System::new_with_specifics(wanted);
        let cpu = system.cpus().first().map(|cpu| cpu.brand().trim()).filter(|name| !name.is_empty());
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Self {
            cpu: cpu.unwrap_or("unknown processor").to_owned(),
            cores: System::physical_core_count(),
            threads,
            memory_bytes: system.total_memory(),
            os: System::long_os_version().unwrap_or_else(|| std::env::consts::OS.to_owned()),
            architecture: std::env::consts::ARCH.to_owned(),
            instruction_set: instruction_set().to_owned(),
        }
    }

    /// The processor's name as part of a file's: small letters, digits, and a `-` for anything else.
    ///
    /// ```
    /// # use cellfan::profile::Machine;
    /// let machine = Machine { cpu: "AMD EPYC(tm) 9B45".into(), ..Machine::here() };
    /// assert_eq!(machine.slug(), "amd-epyc-tm-9b45");
    /// ```
    pub fn slug(&self) -> String {
        let words = self.cpu.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        words.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
    }
}

/// Bytes of memory that can be taken without swapping, of the machine and of the control group that this process is in.
///
/// ```
/// # use cellfan::profile::free_memory_bytes;
/// assert!(free_memory_bytes() > 1 << 20);
/// ```
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
