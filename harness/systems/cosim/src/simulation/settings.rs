//! Settings of the stepping, and abilities and counts of its FMUs.

use crate::solve::IterationLimits;
use octant_fmu_host::description::Interface;

/// Settings of the stepping.
#[derive(Clone, Debug, PartialEq)]
pub struct SteppingSettings {
    /// The FMUs in their order.
    pub order: Vec<usize>,
    /// True if all FMUs step from the same values.
    pub jacobi: bool,
    /// Start, s.
    pub start_s: f64,
    /// Communication step, s.
    pub step_s: f64,
    /// Number of steps.
    pub steps: u64,
    /// Relative tolerance that is passed to FMUs.
    pub tolerance: Option<f64>,
    /// Limits at which the solution of a loop is given up.
    pub loops: IterationLimits,
    /// Maximum number of times that a step is halved.
    pub halvings: u32,
    /// Maximum number of values that are no numbers (NaN) from outputs into inputs; `None`: any.
    pub no_numbers_max: Option<u64>,
}

/// Abilities of an FMU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Abilities {
    /// The FMU can save its states and return to them.
    pub state: bool,
    /// Steps may have any length.
    pub variable_step: bool,
}

impl Abilities {
    /// Returns the abilities of the interface in use; model exchange is integrated over steps of
    /// any length.
    #[must_use]
    pub const fn of(interface: &Interface, model_exchange: bool) -> Self {
        Self { state: interface.state, variable_step: interface.variable_step || model_exchange }
    }
}

/// Counts of events of an FMU in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EventCounts {
    /// Steps that the FMU discarded.
    pub discarded: u64,
    /// Values that the FMU refused; each was altered by a fault.
    pub refused: u64,
}
