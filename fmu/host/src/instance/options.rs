//! How an FMU is opened.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Duration;

/// Which of its interfaces is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum InterfaceKind {
    /// Co-simulation where it has it, else model exchange.
    #[default]
    Any,
    /// Co-simulation.
    CoSimulation,
    /// Model exchange, with our solver.
    ModelExchange,
}

/// Where its code runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Place {
    /// In a process of its own: it can crash, hang and print as it likes. On Linux only.
    #[default]
    OwnProcess,
    /// In this process: quicker, and for code that is trusted.
    ThisProcess,
}

/// How an FMU is opened.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Options {
    /// Which of its interfaces is used.
    pub interface: InterfaceKind,
    /// Where its code runs.
    pub place: Place,
    /// The name that the instance is told; `None`: the model's.
    pub instance_name: Option<String>,
    /// It is asked to log.
    pub log: bool,
    /// Its event mode is used where it has one (FMI 3.0); else it handles events by itself.
    pub event_mode: bool,
    /// It may return early from a step (FMI 3.0).
    pub early_return: bool,
    /// Longest time for loading, instantiation and initialization, together with each reset.
    pub start_limit: Duration,
    /// Longest time for any other call.
    pub time_limit: Duration,
    /// The program that holds an FMU in a process of its own; `None`: this program, or the `octant`
    /// beside it. It has to be an `octant` of the same version.
    pub program: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            interface: InterfaceKind::Any,
            place: Place::OwnProcess,
            instance_name: None,
            log: true,
            event_mode: true,
            early_return: true,
            start_limit: Duration::from_mins(1),
            time_limit: Duration::from_secs(10),
            program: None,
        }
    }
}
