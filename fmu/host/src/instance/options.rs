//! Options for opening an FMU.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Duration;

/// Interface to be used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum InterfaceKind {
    /// Co-simulation if available, else model exchange.
    #[default]
    Any,
    /// Co-simulation.
    CoSimulation,
    /// Model exchange, with Octant's solver.
    ModelExchange,
    /// Scheduled execution (FMI 3.0): the caller activates each model partition.
    ScheduledExecution,
}

/// Process in which the code of an FMU runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProcessPlace {
    /// In a process of its own, in which it can crash, hang and print without harm. On Linux only.
    #[default]
    OwnProcess,
    /// In this process: faster, but only for trusted code.
    ThisProcess,
}

/// Options for opening an FMU.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OpenOptions {
    /// Interface to be used.
    pub interface: InterfaceKind,
    /// Process of the code.
    pub place: ProcessPlace,
    /// Name of the instance; `None`: the model's name.
    pub instance_name: Option<String>,
    /// True to switch on logging.
    pub log: bool,
    /// True to use the FMU's event mode if it has one (FMI 3.0); otherwise the FMU handles events
    /// by itself.
    pub event_mode: bool,
    /// True to allow early returns from a step (FMI 3.0).
    pub early_return: bool,
    /// True to run an FMU that needs the tool that made it.
    pub allow_tool: bool,
    /// Longest time for loading, instantiation and initialization, together with each reset.
    pub start_limit: Duration,
    /// Longest time for any other call.
    pub time_limit: Duration,
    /// Program that hosts an FMU in a process of its own; `None`: this program, or the `octant`
    /// beside it. The program has to be an `octant` of the same version.
    pub program: Option<PathBuf>,
}

impl OpenOptions {
    /// Describes the limits of time in the help of a command, with their defaults.
    #[must_use]
    pub fn limits_help() -> String {
        let Self { time_limit, start_limit, .. } = Self::default();
        format!(
            "Longest time of a call in a process of its own, and of loading with instantiation, without the time in which \
             the process waits for a processor; what takes longer counts as hung. By default {} s, and {} s for loading \
             and initializing",
            time_limit.as_secs(),
            start_limit.as_secs()
        )
    }
}

impl Default for OpenOptions {
    fn default() -> Self {
        Self {
            interface: InterfaceKind::Any,
            place: ProcessPlace::OwnProcess,
            instance_name: None,
            log: true,
            event_mode: true,
            early_return: true,
            allow_tool: false,
            start_limit: Duration::from_mins(1),
            time_limit: Duration::from_secs(10),
            program: None,
        }
    }
}
