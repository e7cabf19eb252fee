//! An FMU of a scenario, as source or as endpoint.

use super::file_name::FileName;
use super::port::{ChannelElement, Code, EntryPlace, Setting};
use crate::channel::Channel;
use octant_sample::Mode;

/// An FMU of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Fmu {
    /// The file.
    pub file: FileName,
    /// Interface to use.
    pub interface: InterfaceChoice,
    /// Process in which it runs.
    pub process: Process,
    /// Wall time limit of a call in a separate process, s.
    pub time_limit_s: f64,
    /// True to run it although it needs the tool that made it.
    pub allow_tool: bool,
    /// Communication step, ns; at an endpoint, the sample period.
    pub step_ns: u64,
    /// Relative tolerance of the solver.
    pub tolerance: Option<f64>,
    /// Settings, applied before the start.
    pub settings: Vec<Setting>,
    /// Channels with their ports.
    pub map: Vec<Mapped>,
    /// Values of the mode's variable by mode; empty: the codes of [`Mode`].
    pub modes: Vec<(Mode, Vec<Code>)>,
    /// Place where the FMU is named.
    pub at: EntryPlace,
}

/// Interface of an FMU to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InterfaceChoice {
    /// Co-simulation if the FMU has it, else model exchange.
    #[default]
    Auto,
    /// Co-simulation.
    CoSimulation,
    /// Model exchange.
    ModelExchange,
}

/// Process in which an FMU runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Process {
    /// A separate process.
    #[default]
    Own,
    /// This process.
    Shared,
}

/// A channel with its ports.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapped {
    /// The channel.
    pub channel: &'static Channel,
    /// One port for all elements, or one for each.
    pub ports: Vec<ChannelElement>,
    /// Place of the entry.
    pub at: EntryPlace,
}

impl Fmu {
    /// Ports of a channel, if the scenario maps it.
    #[must_use]
    pub fn mapped(&self, channel: &Channel) -> Option<&Mapped> {
        self.map.iter().find(|mapped| mapped.channel.name == channel.name)
    }

    /// True if the FMU gives the motion of the case, on which the plant stands.
    #[must_use]
    pub fn is_motion(&self) -> bool {
        self.map.iter().any(|mapped| mapped.channel.name.starts_with("case."))
    }
}
