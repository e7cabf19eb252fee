//! The loop with faults: source → station → endpoint → recorder.
//!
//! One step of the source can deliver no epoch, one or several to the core. The source's epochs are
//! recorded beside those that reached the core, where they differ.

use super::drive::{Ended, RunError, answered, look_every, over};
use super::host::Host;
use super::watch::Watcher;
use octant_base::control::Control;
use octant_endpoint::Endpoint;
use octant_faults::Station;
use octant_faults::catalogue::Acts;
use octant_faults::host::Hosted;
use octant_faults::rule::UnitEvent;
use octant_faults::station::{Delivered, World};
use octant_faults::wire::Wired;
use octant_recorder::{Event, Extra, Frame, Recorder};
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, Output, Truth};
use octant_score::summary::results;
use octant_source::{Epoch, Source};

/// Station with the faults that are triggered by hand.
#[derive(Debug)]
pub struct Faulted {
    /// The pipeline.
    pub station: Station,
    /// Epochs at which faults are triggered by hand, in order, with their ids.
    pub fires: Vec<(u64, String)>,
    /// Target of the host faults.
    pub host: Host,
}

impl Faulted {
    /// Returns the events that are recorded at the end of a run.
    pub(super) fn last_words(&self) -> Vec<Event> {
        let receipts = Event::Receipts(results(&self.station.receipts()));
        self.host.event().into_iter().chain([receipts]).collect()
    }
}

/// Source, endpoint and host, as seen by the station.
pub(super) struct Behind<'a, S: ?Sized, E: ?Sized>(
    pub(super) &'a mut S,
    pub(super) &'a mut E,
    pub(super) &'a mut Host,
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

/// Drives as [`drive`](super::drive()), with faults between source and endpoint. Their receipts are
/// recorded at the end, also after a failure.
///
/// # Errors
/// If source, endpoint or recorder fail; epochs recorded before stay readable.
pub fn drive_faulted<S, E>(
    source: &mut S,
    faulted: &mut Faulted,
    endpoint: &mut E,
    recorder: &mut Recorder,
    watcher: &mut Watcher,
    control: &Control,
) -> Result<Ended, RunError>
where
    S: Source + ?Sized,
    E: Endpoint + ?Sized,
{
    let ended = pass(source, faulted, endpoint, recorder, watcher, control);
    faulted.last_words().into_iter().for_each(|event| recorder.event(event));
    ended
}

/// Runs the loop.
fn pass<S, E>(
    source: &mut S,
    faulted: &mut Faulted,
    endpoint: &mut E,
    recorder: &mut Recorder,
    watcher: &mut Watcher,
    control: &Control,
) -> Result<Ended, RunError>
where
    S: Source + ?Sized,
    E: Endpoint + ?Sized,
{
    let mut run = Loop {
        endpoint,
        recorder,
        watcher,
        output: Output::default(),
        command: GimbalCommand::default(),
        revision: 0,
        powered: true,
    };
    let (station, host) = (&mut faulted.station, &mut faulted.host);
    let wires = station.acts_on(Acts::Wire);
    let mut fires = faulted.fires.iter().peekable();
    let mut epochs = 0u64;
    let mut epoch = Epoch::default();
    let look = look_every(source);
    let total = source.samples_total().unwrap_or(u64::MAX);
    loop {
        // No fault sets in after the last sample.
        if epochs == total {
            return Ok(Ended::SourceEnded);
        }
        while let Some((_, id)) = fires.next_if(|(at, _)| *at == epochs + 1) {
            station.fire(id);
        }
        let mut command = run.command;
        station.before(&mut command, &run.output, &mut Behind(source, &mut *run.endpoint, host));
        if !source.next(&command, &mut epoch)? {
            return Ok(Ended::SourceEnded);
        }
        for event in station.unit_events() {
            run.unit(event, epochs + 1)?;
        }
        let delivered = match station.after(&epoch, &run.output) {
            Delivered::Untouched => run.deliver(source, &epoch, std::slice::from_ref(&epoch)),
            Delivered::These(these) => run.deliver(source, &epoch, these),
        };
        if wires && let Some(wire) = run.endpoint.wired() {
            station.exchanged(wire);
        }
        let ended = delivered?;
        epochs += 1;
        if !station.occurrences().is_empty() || !station.unit_events().is_empty() {
            tell(station, run.recorder);
            station.told();
        }
        if let Some(ended) = ended {
            return Ok(ended);
        }
        if epochs.is_multiple_of(look) && control.look(epochs) {
            return Ok(Ended::Cancelled);
        }
    }
}

/// State that the loop carries from epoch to epoch.
struct Loop<'a, E: ?Sized> {
    endpoint: &'a mut E,
    recorder: &'a mut Recorder,
    watcher: &'a mut Watcher,
    output: Output,
    /// Command of the core; the turntable keeps it while the core gives no answer.
    command: GimbalCommand,
    revision: u32,
    powered: bool,
}

impl<E: Endpoint + ?Sized> Loop<'_, E> {
    /// Applies an event of the unit before an epoch.
    #[cold]
    fn unit(&mut self, event: &UnitEvent, epoch: u64) -> Result<(), RunError> {
        super::unit::happen(event, self.endpoint)?;
        self.powered = *event != UnitEvent::PowerOff;
        if self.powered {
            self.watcher.restarted();
        }
        self.recorder.event(super::unit::event(event, epoch));
        Ok(())
    }

    /// Delivers the epochs of one step of the source to the core.
    fn deliver<S: Source + ?Sized>(
        &mut self,
        source: &S,
        clean: &Epoch,
        these: &[Epoch],
    ) -> Result<Option<Ended>, RunError> {
        self.watcher.source(clean);
        let these = if self.powered { these } else { &[] };
        if these.is_empty() {
            self.recorder.lost(clean)?;
            if self.recorder.truth_due()
                && let Some(truth) = source.truth()
            {
                self.recorder.extra(&Extra::Truth(truth));
            }
            return Ok(None);
        }
        for (index, faulted) in these.iter().enumerate() {
            self.endpoint.step(faulted, &mut self.output)?;
            let output = &self.output;
            if index == 0 {
                self.recorder.push(Frame { clean, faulted, output })?;
            } else {
                self.recorder.added(clean.sample.device_time.ns, faulted, output)?;
            }
            let (revision, recorder) = (&mut self.revision, &mut *self.recorder);
            let sent = (faulted, !std::ptr::eq(clean, faulted));
            answered(sent, output, revision, &*self.endpoint, recorder, self.watcher, source);
            if self.watcher.misbehaved.is_some() {
                return Ok(Some(Ended::Misbehaved));
            }
            self.command = output.gimbal_command;
            if let Some(ended) = over(output) {
                return Ok(Some(ended));
            }
        }
        Ok(None)
    }
}

/// Records onsets and ends of faults.
#[cold]
fn tell(station: &Station, recorder: &mut Recorder) {
    for occurrence in station.occurrences() {
        let Some((id, kind)) = station.names().nth(occurrence.fault) else { continue };
        recorder.event(occurrence_event(id, kind, occurrence.begins, occurrence.epoch));
    }
}

/// Builds the event for the onset or the end of a fault.
pub(super) fn occurrence_event(id: &str, kind: &str, begins: bool, sample: u64) -> Event {
    Event::Fault { begins, id: id.to_owned(), kind: kind.to_owned(), sample }
}
