//! Faults of a run: their station, the host that they act on, and their events.

use super::error::SetupError;
use super::host::RunHost;
use octant_endpoint::Endpoint;
use octant_faults::Station;
use octant_faults::rule::Hosted;
use octant_faults::station::World;
use octant_faults::wire::Wired;
use octant_recorder::Event;
use octant_sample::Truth;
use octant_sample::disturbance::Disturbed;
use octant_scenario::Scenario;
use octant_score::summary::results;
use octant_source::Source;

/// Station with the faults that are triggered by hand.
#[derive(Debug)]
pub struct Faulted {
    /// The pipeline.
    pub station: Station,
    /// Epochs at which faults are triggered by hand, in order, with their ids.
    pub fires: Vec<(u64, String)>,
    /// Target of the host faults.
    pub host: RunHost,
}

impl Faulted {
    /// Builds the station of a scenario, with a host without targets; `None` without faults.
    ///
    /// # Errors
    /// If a fault can't be injected.
    pub fn of(scenario: &Scenario, seed: u64) -> Result<Option<Self>, SetupError> {
        let station = scenario
            .station(seed)
            .map_err(|(id, error)| SetupError::Fault { id, reason: error.to_string() })?;
        let mut fires: Vec<(u64, String)> = (scenario.faults.iter())
            .flat_map(|fault| fault.fires.iter().map(|at| (*at, fault.spec.id.clone())))
            .collect();
        fires.sort_unstable();
        Ok(station.map(|station| Self { station, fires, host: RunHost::default() }))
    }

    /// Returns the events that are recorded at the end of a run.
    pub(crate) fn last_words(&self) -> Vec<Event> {
        let receipts = Event::Receipts(results(&self.station.receipts()));
        self.host.event().into_iter().chain([receipts]).collect()
    }
}

/// Source, endpoint and host, as seen by the station.
pub(crate) struct Behind<'a, S: ?Sized, E: ?Sized>(
    pub(crate) &'a mut S,
    pub(crate) &'a mut E,
    pub(crate) &'a mut RunHost,
);

impl<S: Source + ?Sized, E: Endpoint + ?Sized> World for Behind<'_, S, E> {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        self.0.disturbed()
    }

    fn wired(&mut self) -> Option<&mut dyn Wired> {
        self.1.wired()
    }

    fn host(&mut self) -> Option<&mut dyn Hosted> {
        Some(self.2)
    }

    fn truth(&self) -> Option<Truth> {
        self.0.truth()
    }
}

/// Builds the event for the onset or the end of a fault.
pub(crate) fn occurrence_event(id: &str, kind: &str, begins: bool, sample: u64) -> Event {
    Event::Fault { begins, id: id.to_owned(), kind: kind.to_owned(), sample }
}
