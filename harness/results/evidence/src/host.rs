//! The machine of a run.

use serde::{Deserialize, Serialize};

/// A machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Name.
    pub name: String,
    /// Operating system.
    pub os: String,
    /// Architecture of the program.
    pub arch: String,
    /// Model of the processor; `null` if the operating system doesn't tell.
    pub cpu: Option<String>,
    /// Number of processors that the run could use.
    pub cpus: usize,
}

impl Machine {
    /// Describes this machine.
    #[must_use]
    pub fn this() -> Self {
        Self {
            name: name(),
            os: std::env::consts::OS.into(),
            arch: std::env::consts::ARCH.into(),
            cpu: cpu_model(),
            cpus: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }
}

#[cfg(target_os = "linux")]
fn name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

#[cfg(not(target_os = "linux"))]
fn name() -> String {
    gethostname::gethostname().to_string_lossy().into_owned()
}

/// Reads the processor's model from `/proc/cpuinfo` on Linux; other systems would need a library,
/// so the manifest has `null`.
fn cpu_model() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, model)| model.trim().to_owned())
}
