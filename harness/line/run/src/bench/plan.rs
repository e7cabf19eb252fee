//! Plan of a run: its subject, and its policies, each named once.

use super::error::SetupError;
use super::faulted::Faulted;
use super::host::RunHost;
use super::recording::StreamKeeping;
use crate::observers::Charts;
use crate::observers::at_rest::AtRest;
use crate::observers::filtered::FilteredSeries;
use crate::observers::session::Session;
use octant_base::control::Control;
use octant_recorder::RecorderTrouble;
use octant_scenario::{Method, Scenario};

/// How often a run in simulated time looks at its control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looks {
    /// About once a millisecond of wall time; before every epoch where the source moves equipment, or a person attends.
    Seldom,
    /// Before every epoch.
    Always,
}

/// A run to be opened.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Its scenario.
    pub scenario: &'a Scenario,
    /// Method.
    pub method: Method,
    /// Seed.
    pub seed: u64,
    /// Progress, and the request to end it.
    pub control: &'a Control,
    /// Parts of the stream that are kept.
    pub recording: StreamKeeping<'a>,
    /// Whether a trace is kept, for the comparison with a twin.
    pub trace: bool,
    /// Whether the series are kept that only a report shows.
    pub charts: bool,
    /// How often it looks at its control.
    pub looks: Looks,
    /// Whether the scenario's faults act in the run itself. Beside a run that others branch off from, they wait.
    pub faults: bool,
    /// The session, where it is compared with another one of a unit that is in another process or device, and may
    /// remember.
    pub session: Option<Session>,
}

/// Faults of a run, set up: from the start of its session a device waits for its first sample.
#[derive(Debug, Default)]
pub(crate) struct Ready {
    pub(crate) faulted: Option<Faulted>,
    pub(super) trouble: RecorderTrouble,
}

impl<'a> Plan<'a> {
    /// Plans a run with the policies of what is kept of it: a run whose stream's hashes are compared has a trace, a
    /// recorded one charts.
    #[must_use]
    pub fn of(
        scenario: &'a Scenario,
        method: Method,
        seed: u64,
        recording: StreamKeeping<'a>,
        control: &'a Control,
    ) -> Self {
        let trace = match recording {
            StreamKeeping::HashAlone => false,
            StreamKeeping::Hash => true,
            StreamKeeping::File(_) | StreamKeeping::None => !scenario.faults.is_empty(),
        };
        let charts = matches!(recording, StreamKeeping::File(_));
        let looks = Looks::Seldom;
        Self {
            scenario,
            method,
            seed,
            control,
            recording,
            trace,
            charts,
            looks,
            faults: true,
            session: None,
        }
    }

    /// Sets up the faults, with the host that they act on.
    pub(crate) fn ready(&self) -> Result<Ready, SetupError> {
        let trouble = RecorderTrouble::default();
        let mut faulted = if self.faults { Faulted::of(self.scenario, self.seed)? } else { None };
        if let Some(faulted) = &mut faulted {
            faulted.host = RunHost::new(self.scenario, &self.recording, &trouble)?;
        }
        Ok(Ready { faulted, trouble })
    }

    /// The observers that only a report needs.
    pub(super) fn drawn(&self) -> Charts {
        if !self.charts {
            return Charts::default();
        }
        // Both methods have the same instrument.
        let at_rest = self.method == Method::Primary;
        Charts {
            at_rest: at_rest.then(|| Box::new(AtRest::of(self.scenario))),
            filtered: FilteredSeries::of(self.scenario, self.method),
        }
    }
}
