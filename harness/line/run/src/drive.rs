//! The loop: source → faults → endpoint → recorder and watcher, one step of the source at a time.
//!
//! `Steps::step` is the only body of a loop over samples. Its type parameters are the choices, so that each
//! combination is compiled for itself: [`Source`] and [`Endpoint`]; `Injects` for what happens
//! between them (nothing, faults, events of a recording); `Keeps` for the results and the pace: in
//! time ([`in_time`](super::in_time)), by the clock ([`realtime`](super::realtime)), compared with a recording
//! ([`replayed`](super::replayed)) or dropped ([`passes`](super::passes)).

pub use super::ended::{Ended, RunError};

use super::faulted::{Behind, Faulted, occurrence_event};
use super::measured::Measured;
use super::unit;
use super::watch::Watcher;
use octant_endpoint::{Endpoint, Sent};
use octant_faults::catalogue::Acts;
use octant_faults::rule::UnitEvent;
use octant_faults::station::{Delivered, Occurrence, Passed};
use octant_realtime::clock::MonotonicTime;
use octant_recorder::{EpochFrame, Extra, Recorder, RecorderError};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{DeviceTime, GimbalCommand, Output, Truth};
use octant_source::{Epoch, Source};

/// Parts of a run that its samples go through.
#[derive(Debug)]
pub struct Line<'a, S: ?Sized, E: ?Sized> {
    /// Source of samples.
    pub source: &'a mut S,
    /// Faults.
    pub faulted: Option<&'a mut Faulted>,
    /// Endpoint with the core.
    pub endpoint: &'a mut E,
}

/// Drives the source through the endpoint until one of them ends.
pub(super) fn drive<S, F, E, K>(
    source: &mut S,
    faults: &mut F,
    endpoint: &mut E,
    keeper: &mut K,
) -> Result<Ended, RunError>
where
    S: Source + ?Sized,
    F: Injects<S, E>,
    E: Endpoint + ?Sized,
    K: Keeps<S, E>,
{
    let total = source.samples_total().filter(|_| F::INJECTS || K::PACED);
    Steps::new(total).go_on(source, faults, endpoint, keeper)
}

/// State of the loop between two steps.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    epoch: Epoch,
    output: Output,
    powered: bool,
    /// Number of steps after which the loop ends before it asks the source.
    total: u64,
    number: u64,
}

impl Steps {
    /// Creates the state before the first step.
    pub(super) fn new(total: Option<u64>) -> Self {
        Self {
            epoch: Epoch::default(),
            output: Output::default(),
            powered: true,
            total: total.unwrap_or(u64::MAX),
            number: 0,
        }
    }

    /// Sets the number of steps after which the loop ends.
    pub(super) fn last(&mut self, total: u64) {
        self.total = total;
    }

    /// Epoch that the source delivered in the last step.
    pub(super) fn epoch(&self) -> &Epoch {
        &self.epoch
    }

    /// Last answer of the endpoint.
    pub(super) fn output(&self) -> &Output {
        &self.output
    }

    /// Number of steps so far.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Takes steps until one of them ends the run.
    pub(super) fn go_on<S, F, E, K>(
        &mut self,
        source: &mut S,
        faults: &mut F,
        endpoint: &mut E,
        keeper: &mut K,
    ) -> Result<Ended, RunError>
    where
        S: Source + ?Sized,
        F: Injects<S, E>,
        E: Endpoint + ?Sized,
        K: Keeps<S, E>,
    {
        loop {
            if let Some(ended) = self.step(source, faults, endpoint, keeper)? {
                return Ok(ended);
            }
        }
    }

    /// Takes one step of the source; returns the end of the run, where this was the last one.
    #[inline(always)]
    pub(super) fn step<S, F, E, K>(
        &mut self,
        source: &mut S,
        faults: &mut F,
        endpoint: &mut E,
        keeper: &mut K,
    ) -> Result<Option<Ended>, RunError>
    where
        S: Source + ?Sized,
        F: Injects<S, E>,
        E: Endpoint + ?Sized,
        K: Keeps<S, E>,
    {
        let Self { epoch, output, powered, total, number } = self;
        // No fault sets in after the last sample, and no frame begins.
        if number == total {
            return keeper.drain(endpoint, output).map(Some);
        }
        if keeper.begin(*number, output, endpoint)? {
            return Ok(Some(Ended::Cancelled));
        }
        *number += 1;
        // The turntable keeps the command of the last output while the core gives no answer.
        let mut command = output.gimbal_command;
        faults.before(*number, &mut command, output, (source, endpoint));
        if !source.next(&command, epoch)? {
            return Ok(Some(Ended::SourceEnded));
        }
        if endpoint.feels() {
            let temperature_c = source.temperature_c()?.ok_or(RunError::Untold)?;
            endpoint.feel(temperature_c);
        }
        let epoch = &*epoch;
        for event in faults.unit_events(source)? {
            let happened = unit::happen(event, *number, endpoint)?;
            *powered = *event != UnitEvent::PowerOff;
            if let Some(event) = happened {
                keeper.unit(&event, *number);
            }
        }
        let passed = faults.after(epoch, output, (source, endpoint));
        let these = match passed.delivered {
            _ if !*powered => &[],
            Delivered::Untouched => std::slice::from_ref(epoch),
            Delivered::These(these) => these,
        };
        let clean = Clean { source: epoch, undisturbed: passed.undisturbed.unwrap_or(epoch) };
        let delivered = deliver(source, (clean, these), endpoint, output, keeper);
        faults.exchanged(endpoint);
        let ended = delivered?;
        faults.tell(|occurrence| keeper.occurrence(occurrence));
        Ok(ended)
    }
}

/// Gives the epochs of one step of the source to the endpoint, and the answers to the keeper;
/// returns the end of the run, where an answer is one.
#[inline(always)]
fn deliver<S, E, K>(
    source: &S,
    (clean, these): (Clean<'_>, &[Epoch]),
    endpoint: &mut E,
    output: &mut Output,
    keeper: &mut K,
) -> Result<Option<Ended>, RunError>
where
    S: Source + ?Sized,
    E: Endpoint + ?Sized,
    K: Keeps<S, E>,
{
    let step_ns = clean.source.sample.device_time.ns;
    let (mut told, mut ended) = (false, None);
    for sent in these {
        if keeper.send(endpoint, step_ns, sent, output)? == Sent::Answered {
            let step = if told { InStep::Further { step_ns } } else { InStep::First(clean) };
            told = true;
            ended = keeper.answered(source, endpoint, (step, sent), output)?;
            if ended.is_some() {
                break;
            }
        }
    }
    while ended.is_none()
        && let Some(owed) = keeper.owed(endpoint, output)?
    {
        let first = !told && owed.step_ns == step_ns;
        let further = InStep::Further { step_ns: owed.step_ns };
        let step = if first { InStep::First(clean) } else { further };
        told |= first;
        ended = keeper.answered(source, endpoint, (step, &owed.epoch), output)?;
    }
    if !told {
        keeper.lost(source, clean)?;
    }
    keeper.end(endpoint)?;
    Ok(ended)
}

/// Acts between source and endpoint. Every method can do nothing.
pub(super) trait Injects<S: ?Sized, E: ?Sized> {
    /// True if something can be injected, so that the loop ends with the source's last sample.
    const INJECTS: bool = false;

    /// Acts before the source makes the epoch of this number: on source, endpoint and command.
    fn before(
        &mut self,
        _number: u64,
        _command: &mut GimbalCommand,
        _output: &Output,
        _on: (&mut S, &mut E),
    ) {
    }

    /// Returns the events of the unit before it gets the epoch that the source has just made.
    fn unit_events(&mut self, _source: &S) -> Result<&[UnitEvent], RunError> {
        Ok(&[])
    }

    /// Acts on the epoch of the source on its way to the core.
    fn after(&mut self, _epoch: &Epoch, _output: &Output, _on: (&mut S, &mut E)) -> Passed<'_> {
        Passed { delivered: Delivered::Untouched, undisturbed: None }
    }

    /// Takes up what happened on the wire to the endpoint, on the way there and back.
    fn exchanged(&mut self, _endpoint: &mut E) {}

    /// Tells the onsets and ends of faults in this step.
    fn tell(&mut self, _to: impl FnMut(&Occurrence)) {}
}

/// Nothing between source and endpoint.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoFaults;

impl<S: ?Sized, E: ?Sized> Injects<S, E> for NoFaults {}

impl<S: Source + ?Sized, E: Endpoint + ?Sized> Injects<S, E> for Faulted {
    const INJECTS: bool = true;

    fn before(
        &mut self,
        number: u64,
        command: &mut GimbalCommand,
        output: &Output,
        (source, endpoint): (&mut S, &mut E),
    ) {
        for (_, id) in self.fires.iter().filter(|(at, _)| *at == number) {
            self.station.fire(id);
        }
        self.station.before(command, output, &mut Behind(source, endpoint, &mut self.host));
    }

    fn unit_events(&mut self, _source: &S) -> Result<&[UnitEvent], RunError> {
        Ok(self.station.unit_events())
    }

    fn after(
        &mut self,
        epoch: &Epoch,
        output: &Output,
        (source, endpoint): (&mut S, &mut E),
    ) -> Passed<'_> {
        self.station.after(epoch, output, &mut Behind(source, endpoint, &mut self.host))
    }

    fn exchanged(&mut self, endpoint: &mut E) {
        if let Some(wire) = endpoint.wired()
            && self.station.acts_on(Acts::Wire)
        {
            self.station.exchanged(wire);
        }
    }

    fn tell(&mut self, to: impl FnMut(&Occurrence)) {
        if !self.station.occurrences().is_empty() || !self.station.unit_events().is_empty() {
            self.station.occurrences().iter().for_each(to);
            self.station.told();
        }
    }
}

/// Epoch of one step before faults altered it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clean<'a> {
    /// Epoch that the source delivered.
    pub(super) source: &'a Epoch,
    /// Epoch that it would have delivered without the faults inside its plant.
    pub(super) undisturbed: &'a Epoch,
}

/// Place of an answered epoch among those that one step of the source delivers.
#[derive(Clone, Copy, Debug)]
pub(super) enum InStep<'a> {
    /// The first one of the step with this clean epoch.
    First(Clean<'a>),
    /// A further one of the step with this stamp, or one of an earlier step.
    Further {
        /// Stamp of the source's epoch, ns.
        step_ns: u64,
    },
}

/// Epoch that was sent and not answered at once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Owed {
    /// The epoch.
    pub(super) epoch: Epoch,
    /// Stamp of the source's epoch in that step, ns.
    pub(super) step_ns: u64,
    /// Time at which it was sent.
    pub(super) at: MonotonicTime,
}

/// Keeps the results of the steps, and sets their pace: by default none, with each answer at once.
pub(super) trait Keeps<S: ?Sized, E: Endpoint + ?Sized> {
    /// True if steps begin at times of the host.
    const PACED: bool = false;

    /// Begins a step after this number of them and this answer; true if the run is to end instead.
    fn begin(&mut self, _done: u64, _output: &Output, _to: &mut E) -> Result<bool, RunError> {
        Ok(false)
    }

    /// Sends an epoch of the step with this stamp to the endpoint.
    fn send(
        &mut self,
        endpoint: &mut E,
        _step_ns: u64,
        epoch: &Epoch,
        output: &mut Output,
    ) -> Result<Sent, RunError> {
        endpoint.step(epoch, output)?;
        Ok(Sent::Answered)
    }

    /// Waits for an owed answer until the end of the step; `None`: none came.
    fn owed(&mut self, _from: &mut E, _output: &mut Output) -> Result<Option<Owed>, RunError> {
        Ok(None)
    }

    /// Takes the answer to an epoch with its place; returns the end of the run, if it is one.
    fn answered(
        &mut self,
        source: &S,
        endpoint: &E,
        sent: (InStep<'_>, &Epoch),
        output: &Output,
    ) -> Result<Option<Ended>, RunError>;

    /// Takes an epoch of the source that reached no core in its step, or isn't answered yet.
    fn lost(&mut self, _source: &S, _clean: Clean<'_>) -> Result<(), RunError> {
        Ok(())
    }

    /// Takes an event of the unit before the epoch of this number.
    fn unit(&mut self, _event: &UnitEvent, _number: u64) {}

    /// Takes the onset or the end of a fault.
    fn occurrence(&mut self, _occurrence: &Occurrence) {}

    /// Ends a step.
    fn end(&mut self, _endpoint: &E) -> Result<(), RunError> {
        Ok(())
    }

    /// Waits for the answers still owed after the source's last sample.
    fn drain(&mut self, _endpoint: &mut E, _output: &mut Output) -> Result<Ended, RunError> {
        Ok(Ended::SourceEnded)
    }
}

/// Recorder and watcher of a run.
#[derive(Debug)]
pub(super) struct Books<'a> {
    /// The recorder.
    pub(super) recorder: &'a mut Recorder,
    /// The watcher, which scores.
    pub(super) watcher: &'a mut Watcher,
    /// Ids and kinds of the faults, in order.
    pub(super) names: Vec<(String, String)>,
}

impl<'a> Books<'a> {
    /// Opens the books of a run.
    pub(super) fn new(
        recorder: &'a mut Recorder,
        watcher: &'a mut Watcher,
        faulted: Option<&Faulted>,
    ) -> Self {
        let names = faulted.into_iter().flat_map(|faulted| faulted.station.names());
        let names = names.map(|(id, kind)| (id.to_owned(), kind.to_owned())).collect();
        Self { recorder, watcher, names }
    }

    /// Takes the answer to an epoch, what the filter tells about a measurement, and the parameters where
    /// they are new; asks for the truth where it is needed. `altered` tells whether faults changed the epoch.
    #[inline(always)]
    pub(super) fn answered(
        &mut self,
        (step, sent, altered): (InStep<'_>, &Epoch, bool),
        output: &Output,
        (measured, estimate): (&Measured, Option<&ParameterEstimate>),
        truth: impl FnOnce() -> Option<Truth>,
    ) -> Result<(), RecorderError> {
        let (recorder, watcher) = (&mut *self.recorder, &mut *self.watcher);
        match step {
            InStep::First(clean) => {
                watcher.source(clean.source);
                recorder.push(EpochFrame { clean: clean.undisturbed, faulted: sent, output })?;
            }
            InStep::Further { step_ns } => {
                watcher.source_time = Some(DeviceTime { ns: step_ns });
                recorder.added(step_ns, sent, output)?;
            }
        }
        let watched = watcher.answer(sent, altered, output);
        if let Some(innovation) = &measured.innovation {
            recorder.extra(&Extra::Innovation(*innovation));
            watcher.innovation(output, innovation);
        }
        if let Some(covariance) = &measured.covariance {
            recorder.extra(&Extra::Covariance(*covariance));
            watcher.covariance(sent, output, covariance);
        }
        if let Some(estimate) = estimate {
            recorder.extra(&Extra::Parameters(*estimate));
            watcher.parameters(output, estimate);
        }
        if (watched || recorder.truth_due())
            && let Some(truth) = truth()
        {
            if recorder.truth_due() {
                recorder.extra(&Extra::Truth(truth));
            }
            if watched {
                watcher.truth(output, &truth);
            }
        }
        Ok(())
    }

    /// Takes an epoch of the source that reached no core in its step, or isn't answered yet.
    pub(super) fn lost(
        &mut self,
        clean: Clean<'_>,
        truth: impl FnOnce() -> Option<Truth>,
    ) -> Result<(), RecorderError> {
        self.watcher.source(clean.source);
        self.recorder.lost(clean.undisturbed)?;
        if self.recorder.truth_due()
            && let Some(truth) = truth()
        {
            self.recorder.extra(&Extra::Truth(truth));
        }
        Ok(())
    }

    /// Takes an event of the unit before the epoch of this number.
    #[cold]
    pub(super) fn unit(&mut self, event: &UnitEvent, number: u64) {
        if *event != UnitEvent::PowerOff {
            self.watcher.restarted();
        }
        self.recorder.event(unit::event(event, number));
    }

    /// Takes the onset or the end of a fault.
    #[cold]
    pub(super) fn occurrence(&mut self, occurrence: &Occurrence) {
        if let Some((id, kind)) = self.names.get(occurrence.fault) {
            let Occurrence { begins, epoch, .. } = *occurrence;
            self.recorder.event(occurrence_event(id, kind, begins, epoch));
        }
    }
}
