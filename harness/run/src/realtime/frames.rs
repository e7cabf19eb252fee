//! Runs the real-time thread.

use super::entry::{Answer, Broke, Entry};
use crate::drive::{Ended, RunError, over};
use crate::faulted::{Behind, Faulted};
use crate::unit;
use octant_base::control::Control;
use octant_endpoint::{Endpoint, EndpointError, Sent};
use octant_faults::catalogue::Acts;
use octant_faults::rule::UnitEvent;
use octant_faults::station::Delivered;
use octant_realtime::clock::{HostTime, now};
use octant_realtime::lateness::Lateness;
use octant_realtime::pace::FrameClock;
use octant_sample::{GimbalCommand, Output, Truth};
use octant_source::{Epoch, Source};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};

/// Maximum number of epochs whose answers may be outstanding. A device that owes more has stopped
/// answering.
const OUTSTANDING: usize = 256;

/// Lateness from which a frame was starved, however many late frames are allowed, ns.
const STARVED_NS: u64 = 1_000_000_000;

/// Interval of the messages about time keeping, ns.
const PACE_NS: u64 = 1_000_000_000;

/// Epoch that was sent and not answered.
#[derive(Clone, Copy, Debug, Default)]
struct Owed {
    epoch: Epoch,
    /// Stamp of the source's epoch in that step.
    step_ns: u64,
    at: HostTime,
}

/// Measurements of the thread.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) clock: FrameClock,
    /// Times from sending a sample to its answer.
    pub(super) answers: Lateness,
    pub(super) late_answers: u64,
    pub(super) missed_answers: u64,
    pub(super) not_sent: u64,
    pub(super) dropped: u64,
}

/// State of the loop.
pub(super) struct Frames<'a> {
    ring: rtrb::Producer<Entry>,
    stop: &'a AtomicBool,
    found: Found,
    /// Epochs without answer, the oldest first.
    outstanding: VecDeque<Owed>,
    silence_ns: u64,
    output: Output,
    command: GimbalCommand,
    revision: u32,
    powered: bool,
    /// Frames between messages about time keeping, and the largest lateness since the last one.
    pace_every: u64,
    latest_ns: u64,
    /// Number of overruns allowed.
    overruns_max: u64,
    /// Stamp of the last sample of the source.
    step_ns: u64,
    broke: Promise,
}

/// State of the bench's real-time limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Promise {
    Kept,
    /// Violated, but the ring had no room yet for the message.
    Broken(u64, Broke),
    Told,
}

impl<'a> Frames<'a> {
    pub(super) fn new(
        clock: FrameClock,
        period_ns: u64,
        (silence_ns, overruns_max): (u64, u64),
        ring: rtrb::Producer<Entry>,
        stop: &'a AtomicBool,
    ) -> Self {
        Self {
            ring,
            stop,
            found: Found {
                clock,
                answers: Lateness::new(),
                late_answers: 0,
                missed_answers: 0,
                not_sent: 0,
                dropped: 0,
            },
            outstanding: VecDeque::with_capacity(OUTSTANDING),
            silence_ns,
            output: Output::default(),
            command: GimbalCommand::default(),
            revision: 0,
            powered: true,
            pace_every: (PACE_NS / period_ns.max(1)).max(1),
            latest_ns: 0,
            overruns_max,
            step_ns: 0,
            broke: Promise::Kept,
        }
    }

    /// Notes a violation of a real-time limit by the bench.
    fn breaks(&mut self, broke: Broke) {
        if self.broke == Promise::Kept {
            self.broke = Promise::Broken(self.step_ns, broke);
        }
    }

    pub(super) fn found(self) -> Found {
        self.found
    }

    /// Runs frames until source, endpoint or a stop request ends the run.
    pub(super) fn run<S, E>(
        &mut self,
        source: &mut S,
        mut faulted: Option<&mut Faulted>,
        endpoint: &mut E,
        control: &Control,
    ) -> Result<Ended, RunError>
    where
        S: Source + ?Sized,
        E: Endpoint + ?Sized,
    {
        let total = source.samples_total().unwrap_or(u64::MAX);
        let mut fires = faulted.as_mut().map(|f| std::mem::take(&mut f.fires)).unwrap_or_default();
        fires.reverse();
        let mut epoch = Epoch::default();
        // The run starts with the first frame, not with the settings before it.
        self.found.clock.restart();
        for number in 1.. {
            if number > total {
                return self.drain(endpoint);
            }
            let due = self.found.clock.deadline();
            let began = self.found.clock.wait();
            let late_ns = began.since(due);
            if late_ns >= STARVED_NS || self.found.clock.overruns() > self.overruns_max {
                self.breaks(Broke::Late(late_ns));
            }
            self.pace(late_ns);
            if control.look(number - 1) || self.stop.load(Ordering::Relaxed) {
                return Ok(Ended::Cancelled);
            }
            let frame_end = self.found.clock.deadline();
            let ended = match &mut faulted {
                None => {
                    if !source.next(&self.command, &mut epoch)? {
                        return Ok(Ended::SourceEnded);
                    }
                    let these = std::slice::from_ref(&epoch);
                    self.deliver(source, endpoint, &epoch, these, frame_end)?
                }
                Some(faulted) => {
                    while fires.last().is_some_and(|(at, _)| *at == number) {
                        if let Some((_, id)) = fires.pop() {
                            faulted.station.fire(&id);
                        }
                    }
                    match self
                        .faulted_step(source, faulted, endpoint, &mut epoch, number, frame_end)?
                    {
                        Some(ended) => ended,
                        None => return Ok(Ended::SourceEnded),
                    }
                }
            };
            if let Some(ended) = ended {
                return Ok(ended);
            }
        }
        Ok(Ended::SourceEnded)
    }

    /// Notes the lateness of a frame, and sends the message about time keeping if it is due.
    #[inline]
    fn pace(&mut self, late_ns: u64) {
        self.latest_ns = self.latest_ns.max(late_ns);
        let frames = self.found.clock.frames();
        if frames.is_multiple_of(self.pace_every) {
            let (overruns, late_answers) = (self.found.clock.overruns(), self.found.late_answers);
            let latest_ns = std::mem::take(&mut self.latest_ns);
            self.lay(Entry::Pace { frames, latest_ns, overruns, late_answers });
        }
    }

    /// Makes a step with faults; `None` where the source has ended.
    fn faulted_step<S, E>(
        &mut self,
        source: &mut S,
        faulted: &mut Faulted,
        endpoint: &mut E,
        epoch: &mut Epoch,
        number: u64,
        frame_end: HostTime,
    ) -> Result<Option<Option<Ended>>, RunError>
    where
        S: Source + ?Sized,
        E: Endpoint + ?Sized,
    {
        let (station, host) = (&mut faulted.station, &mut faulted.host);
        let mut command = self.command;
        station.before(&mut command, &self.output, &mut Behind(source, endpoint, host));
        if !source.next(&command, epoch)? {
            return Ok(None);
        }
        for event in station.unit_events() {
            unit::happen(event, endpoint)?;
            self.powered = *event != UnitEvent::PowerOff;
            // The restarted unit has forgotten the earlier epochs.
            self.outstanding.clear();
            self.lay(Entry::Unit { event: *event, epoch: number });
        }
        let delivered = match station.after(epoch, &self.output) {
            Delivered::Untouched => {
                self.deliver(source, endpoint, epoch, std::slice::from_ref(epoch), frame_end)
            }
            Delivered::These(these) => self.deliver(source, endpoint, epoch, these, frame_end),
        };
        if station.acts_on(Acts::Wire)
            && let Some(wire) = endpoint.wired()
        {
            station.exchanged(wire);
        }
        let ended = delivered?;
        for occurrence in station.occurrences() {
            let (fault, begins, epoch) = (occurrence.fault, occurrence.begins, occurrence.epoch);
            self.lay(Entry::Occurrence { fault, begins, epoch });
        }
        station.told();
        Ok(Some(ended))
    }

    /// Delivers the epochs of a frame to the core, and takes the answers that come in it.
    fn deliver<S, E>(
        &mut self,
        source: &S,
        endpoint: &mut E,
        clean: &Epoch,
        these: &[Epoch],
        frame_end: HostTime,
    ) -> Result<Option<Ended>, RunError>
    where
        S: Source + ?Sized,
        E: Endpoint + ?Sized,
    {
        let these = if self.powered { these } else { &[] };
        let step_ns = clean.sample.device_time.ns;
        self.step_ns = step_ns;
        let truth = source.truth();
        // Answers that earlier frames are owed come first.
        let mut clean_told = false;
        let mut ended = None;
        for epoch in these {
            if self.outstanding.len() == OUTSTANDING {
                return Err(self.silent(endpoint));
            }
            let at = now();
            let sent = Owed { epoch: *epoch, step_ns, at };
            self.outstanding.push_back(sent);
            match endpoint.send(epoch, &mut self.output)? {
                Sent::Answered => {
                    clean_told = self.answered(endpoint, clean, truth, clean_told, step_ns);
                    ended = ended.or(over(&self.output));
                }
                Sent::Underway => {}
                Sent::NotSent => {
                    self.outstanding.pop_back();
                    self.found.not_sent += 1;
                    self.breaks(Broke::NotSent);
                }
            }
        }
        while !self.outstanding.is_empty() && ended.is_none() {
            let Some(skipped) = endpoint.answer(frame_end, &mut self.output)? else { break };
            self.skip(skipped);
            clean_told = self.answered(endpoint, clean, truth, clean_told, step_ns);
            ended = over(&self.output);
        }
        if !clean_told {
            self.lay(Entry::Lost { clean: *clean, truth });
        }
        if let Some(oldest) = self.outstanding.front() {
            self.found.late_answers += 1;
            if now().since(oldest.at) > self.silence_ns {
                return Err(self.silent(endpoint));
            }
        }
        Ok(ended)
    }

    /// Drops epochs that will have no answer.
    fn skip(&mut self, epochs: usize) {
        let skipped = epochs.min(self.outstanding.len());
        self.outstanding.drain(..skipped);
        self.found.missed_answers += skipped as u64;
    }

    /// Waits for outstanding answers after the end of the source.
    fn drain<E: Endpoint + ?Sized>(&mut self, endpoint: &mut E) -> Result<Ended, RunError> {
        while let Some(oldest) = self.outstanding.front() {
            let (until, clean) = (oldest.at.after(self.silence_ns), oldest.epoch);
            let Some(skipped) = endpoint.answer(until, &mut self.output)? else {
                return Err(self.silent(endpoint));
            };
            self.skip(skipped);
            self.answered(endpoint, &clean, None, true, 0);
            if let Some(ended) = over(&self.output) {
                return Ok(ended);
            }
        }
        Ok(Ended::SourceEnded)
    }

    /// Takes the answer to the oldest epoch without one; returns true once the clean epoch of this
    /// frame has been passed on.
    fn answered<E: Endpoint + ?Sized>(
        &mut self,
        endpoint: &E,
        clean: &Epoch,
        truth: Option<Truth>,
        clean_told: bool,
        step_ns: u64,
    ) -> bool {
        let Some(sent) = self.outstanding.pop_front() else { return clean_told };
        self.found.answers.record(now().since(sent.at));
        let is_new = self.output.parameters_revision != self.revision;
        self.command = self.output.gimbal_command;
        let answer =
            Answer { output: self.output, estimate: is_new.then(|| endpoint.parameters()), truth };
        if sent.step_ns == step_ns && !clean_told {
            self.lay_answer(Entry::Frame { clean: *clean, faulted: sent.epoch, answer });
            return true;
        }
        self.lay_answer(Entry::Added { step_ns: sent.step_ns, faulted: sent.epoch, answer });
        clean_told
    }

    /// Puts an entry into the ring, or counts it as dropped if the ring is full. Returns true if it
    /// is in.
    fn lay(&mut self, entry: Entry) -> bool {
        if let Promise::Broken(step_ns, broke) = self.broke
            && self.ring.push(Entry::Broke { step_ns, broke }).is_ok()
        {
            self.broke = Promise::Told;
        }
        let is_in = self.ring.push(entry).is_ok();
        if !is_in {
            self.found.dropped += 1;
            self.breaks(Broke::Dropped);
        }
        is_in
    }

    /// Puts an entry with the last output into the ring. New parameters that find no room go with
    /// the next entry: the recorder waits for those that an output announces.
    fn lay_answer(&mut self, entry: Entry) {
        if self.lay(entry) {
            self.revision = self.output.parameters_revision;
        }
    }

    #[cold]
    fn silent<E: Endpoint + ?Sized>(&self, endpoint: &E) -> RunError {
        let oldest = self.outstanding.front().copied().unwrap_or_default();
        RunError::Endpoint(EndpointError::Gone {
            uri: endpoint.uri(),
            reason: format!(
                "no answer to sample {} for {:.3} s; {} samples wait for theirs",
                oldest.epoch.sample.sequence,
                now().since(oldest.at) as f64 * 1e-9,
                self.outstanding.len()
            ),
        })
    }
}
