//! The loop: source → faults → endpoint → recorder and observers, one step of the source at a time.
//!
//! `Steps::step` is the only body of a loop over samples. Its type parameters are the choices, so that each
//! combination is compiled for itself: [`Source`] and [`Endpoint`]; `Injects` for what happens
//! between them (nothing, faults, events of a recording); [`Keeps`] for the results and the pace: in
//! simulated time ([`Records`](super::Records)), by the clock, compared with a recording, or dropped.

use super::ended::{Ended, RunError};
use super::faulted::{Behind, Faulted};
use super::unit;
use octant_endpoint::{Endpoint, Sent};
use octant_faults::catalogue::Acts;
use octant_faults::rule::UnitEvent;
use octant_faults::station::{Delivered, Occurrence, Passed};
use octant_realtime::clock::MonotonicTime;
use octant_sample::{GimbalCommand, Output};
use octant_scenario::PowerCycle;
use octant_source::{Epoch, Source};

/// State of the loop between two steps.
#[derive(Clone, Debug)]
pub(crate) struct Steps {
    epoch: Epoch,
    output: Output,
    powered: bool,
    /// Number of steps after which the loop ends before it asks the source.
    total: u64,
    number: u64,
    /// Switching of the unit that the procedure has, from the last one to the next.
    cycles: Vec<PowerCycle>,
    /// Number of the step before which the unit is switched next.
    next_switch: u64,
}

impl Steps {
    /// Creates the state before the first step.
    pub(crate) fn new(total: Option<u64>) -> Self {
        Self {
            epoch: Epoch::default(),
            output: Output::default(),
            powered: true,
            total: total.unwrap_or(u64::MAX),
            number: 0,
            cycles: Vec::new(),
            next_switch: u64::MAX,
        }
    }

    /// Sets when the procedure switches the unit off and on, in the order of time.
    pub(crate) fn switch(&mut self, mut cycles: Vec<PowerCycle>) {
        cycles.reverse();
        self.next_switch = cycles.last().map_or(u64::MAX, |cycle| cycle.off_before);
        self.cycles = cycles;
    }

    /// Switches the unit before a step of this number, as far as the procedure has it there.
    #[cold]
    fn switched<S, E, K>(&mut self, endpoint: &mut E, keeper: &mut K) -> Result<(), RunError>
    where
        S: Source + ?Sized,
        E: Endpoint + ?Sized,
        K: Keeps<S, E>,
    {
        let number = self.number;
        let mut happen = |event: UnitEvent| -> Result<(), RunError> {
            if let Some(event) = unit::happen(&event, number, endpoint)? {
                keeper.unit(&event, number);
            }
            Ok(())
        };
        let Some(PowerCycle { off_before, on_before }) = self.cycles.last().copied() else {
            return Ok(());
        };
        if number == off_before {
            happen(UnitEvent::PowerOff)?;
            self.powered = false;
            self.next_switch = on_before;
        }
        if number == on_before {
            happen(UnitEvent::PowerOn)?;
            self.powered = true;
            self.cycles.pop();
            self.next_switch = self.cycles.last().map_or(u64::MAX, |cycle| cycle.off_before);
        }
        Ok(())
    }

    /// Sets the number of steps after which the loop ends.
    pub(crate) fn last(&mut self, total: u64) {
        self.total = total;
    }

    /// Epoch that the source delivered in the last step.
    pub(crate) fn epoch(&self) -> &Epoch {
        &self.epoch
    }

    /// Last answer of the endpoint.
    pub(crate) fn output(&self) -> &Output {
        &self.output
    }

    /// Number of steps so far.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Takes steps until one of them ends the run.
    pub(crate) fn go_on<S, F, E, K>(
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
    pub(crate) fn step<S, F, E, K>(
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
        let Self { output, total, number, .. } = self;
        // No fault sets in after the last sample, and no frame begins.
        if number == total {
            return keeper.drain(endpoint, output).map(Some);
        }
        if keeper.begin(*number, output, endpoint)? {
            return Ok(Some(Ended::Cancelled));
        }
        *number += 1;
        if *number == self.next_switch {
            self.switched(endpoint, keeper)?;
        }
        let Self { epoch, output, powered, number, .. } = self;
        // The turntable keeps the command of the last output while the core gives no answer.
        let mut command = output.gimbal_command;
        faults.before(*number, &mut command, output, source, endpoint);
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
        let passed = faults.after(epoch, output, source, endpoint);
        let these = match passed.delivered {
            _ if !*powered => &[],
            Delivered::Untouched => std::slice::from_ref(epoch),
            Delivered::These(these) => these,
        };
        let clean = Clean { source: epoch, undisturbed: passed.undisturbed.unwrap_or(epoch) };
        let delivered = deliver(source, clean, these, endpoint, output, keeper);
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
    clean: Clean<'_>,
    these: &[Epoch],
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
            ended = keeper.answered(source, endpoint, step, sent, output)?;
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
        ended = keeper.answered(source, endpoint, step, &owed.epoch, output)?;
    }
    if !told {
        keeper.lost(source, clean)?;
    }
    keeper.end(endpoint)?;
    Ok(ended)
}

/// Acts between source and endpoint. Every method can do nothing.
pub(crate) trait Injects<S: ?Sized, E: ?Sized> {
    /// Acts before the source makes the epoch of this number: on source, endpoint and command.
    fn before(
        &mut self,
        _number: u64,
        _command: &mut GimbalCommand,
        _output: &Output,
        _source: &mut S,
        _endpoint: &mut E,
    ) {
    }

    /// Returns the events of the unit before it gets the epoch that the source has just made.
    fn unit_events(&mut self, _source: &S) -> Result<&[UnitEvent], RunError> {
        Ok(&[])
    }

    /// Acts on the epoch of the source on its way to the core.
    fn after(
        &mut self,
        _epoch: &Epoch,
        _output: &Output,
        _source: &mut S,
        _endpoint: &mut E,
    ) -> Passed<'_> {
        Passed { delivered: Delivered::Untouched, undisturbed: None }
    }

    /// Takes up what happened on the wire to the endpoint, on the way there and back.
    fn exchanged(&mut self, _endpoint: &mut E) {}

    /// Tells the onsets and ends of faults in this step.
    fn tell(&mut self, _to: impl FnMut(&Occurrence)) {}
}

/// Nothing between source and endpoint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoFaults;

impl<S: ?Sized, E: ?Sized> Injects<S, E> for NoFaults {}

impl<S: Source + ?Sized, E: Endpoint + ?Sized> Injects<S, E> for Faulted {
    fn before(
        &mut self,
        number: u64,
        command: &mut GimbalCommand,
        output: &Output,
        source: &mut S,
        endpoint: &mut E,
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
        source: &mut S,
        endpoint: &mut E,
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
pub struct Clean<'a> {
    /// Epoch that the source delivered.
    pub source: &'a Epoch,
    /// Epoch that it would have delivered without the faults inside its plant.
    pub undisturbed: &'a Epoch,
}

/// Place of an answered epoch among those that one step of the source delivers.
#[derive(Clone, Copy, Debug)]
pub enum InStep<'a> {
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
pub struct Owed {
    /// The epoch.
    pub epoch: Epoch,
    /// Stamp of the source's epoch in that step, ns.
    pub step_ns: u64,
    /// Time at which it was sent.
    pub at: MonotonicTime,
}

/// Keeps the results of the steps, and sets their pace: by default none, with each answer at once.
pub trait Keeps<S: ?Sized, E: Endpoint + ?Sized> {
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

    /// Takes the answer to an epoch with its place in the step; returns the end of the run, if it is one.
    fn answered(
        &mut self,
        source: &S,
        endpoint: &E,
        step: InStep<'_>,
        sent: &Epoch,
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
