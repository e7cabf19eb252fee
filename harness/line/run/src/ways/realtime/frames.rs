//! Frames of a run by the clock, on the real-time thread.

use super::entry::{Answer, Broke, Entry, Known};
use crate::bench::attended::Attended;
use crate::bench::ended::{Ended, RunError, over};
use crate::bench::records::Measured;
use crate::bench::steps::{Clean, InStep, Keeps, Owed};
use octant_base::control::Control;
use octant_endpoint::{Endpoint, EndpointError, Sent};
use octant_faults::rule::UnitEvent;
use octant_faults::station::Occurrence;
use octant_realtime::clock::{MonotonicTime, now};
use octant_realtime::lateness::LatenessHistogram;
use octant_realtime::pace::FrameClock;
use octant_sample::Output;
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

/// Measurements of the thread.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) clock: FrameClock,
    /// Times from sending a sample to its answer.
    pub(super) answers: LatenessHistogram,
    pub(super) late_answers: u64,
    pub(super) missed_answers: u64,
    pub(super) not_sent: u64,
    pub(super) dropped: u64,
}

/// Limits of a run by the clock.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Longest time without the answer to a sample, ns.
    pub(super) silence_ns: u64,
    /// Number of overruns allowed.
    pub(super) overruns_max: u64,
}

/// State of the loop.
pub(super) struct Frames<'a> {
    ring: rtrb::Producer<Entry>,
    stop: &'a AtomicBool,
    found: Found,
    /// Epochs without answer, the oldest first.
    outstanding: VecDeque<Owed>,
    limits: Limits,
    control: &'a Control,
    /// Person who attends to the run.
    attended: Option<Attended<'a>>,
    revision: u32,
    frame_end: MonotonicTime,
    pace: Pace,
    /// Stamp of the last sample of the source.
    step_ns: u64,
    broke: Promise,
}

/// Messages about time keeping.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// Frames between two of them.
    every: u64,
    /// Largest lateness since the last one, ns.
    latest_ns: u64,
}

/// State of the bench's real-time limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Promise {
    Kept,
    /// Violated, but the ring had no room yet for the message.
    Broken(u64, Broke),
    /// Violated, and the message is in the ring.
    Reported,
}

impl<'a> Frames<'a> {
    pub(super) fn new(
        clock: FrameClock,
        period_ns: u64,
        limits: Limits,
        ring: rtrb::Producer<Entry>,
        stop: &'a AtomicBool,
        control: &'a Control,
        attended: Option<Attended<'a>>,
    ) -> Self {
        Self {
            ring,
            stop,
            found: Found {
                clock,
                answers: LatenessHistogram::new(),
                late_answers: 0,
                missed_answers: 0,
                not_sent: 0,
                dropped: 0,
            },
            outstanding: VecDeque::with_capacity(OUTSTANDING),
            limits,
            control,
            attended,
            revision: 0,
            frame_end: MonotonicTime::default(),
            pace: Pace { every: (PACE_NS / period_ns.max(1)).max(1), latest_ns: 0 },
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

    /// Notes the lateness of a frame, and sends the message about time keeping if it is due.
    #[inline]
    fn note_pace(&mut self, late_ns: u64) {
        self.pace.latest_ns = self.pace.latest_ns.max(late_ns);
        let frames = self.found.clock.frames();
        if frames.is_multiple_of(self.pace.every) {
            let (overruns, late_answers) = (self.found.clock.overruns(), self.found.late_answers);
            let latest_ns = std::mem::take(&mut self.pace.latest_ns);
            self.lay(Entry::Pace { frames, latest_ns, overruns, late_answers });
        }
    }

    /// Takes the answer to the oldest epoch without one off the list, if it has come until then.
    fn take<E: Endpoint + ?Sized>(
        &mut self,
        until: MonotonicTime,
        endpoint: &mut E,
        output: &mut Output,
    ) -> Result<Option<Owed>, RunError> {
        let Some(skipped) = endpoint.answer(until, output)? else { return Ok(None) };
        let skipped = skipped.min(self.outstanding.len());
        // Dropped epochs will have no answer.
        self.outstanding.drain(..skipped);
        self.found.missed_answers += skipped as u64;
        let owed = self.outstanding.pop_front();
        if let Some(owed) = &owed {
            self.found.answers.record(now().since(owed.at));
        }
        Ok(owed)
    }

    /// Passes an answer on. New parameters that find no room go with the next one: the recorder
    /// waits for those that an output announces.
    fn pass_on<E: Endpoint + ?Sized>(
        &mut self,
        endpoint: &E,
        step: InStep<'_>,
        sent: &Epoch,
        output: &Output,
        known: Known,
    ) {
        let is_new = output.parameters_revision != self.revision;
        let estimate = is_new.then(|| endpoint.parameters());
        let measured = Measured::of(endpoint, output);
        let answer = Answer { output: *output, measured, estimate, known };
        let is_in = self.lay(match step {
            InStep::First(clean) => Entry::Frame {
                source: *clean.source,
                undisturbed: *clean.undisturbed,
                faulted: *sent,
                answer,
            },
            InStep::Further { step_ns } => Entry::Added { step_ns, faulted: *sent, answer },
        });
        if is_in {
            self.revision = output.parameters_revision;
        }
    }

    /// Puts an entry into the ring, or counts it as dropped if the ring is full. Returns true if it
    /// is in.
    fn lay(&mut self, entry: Entry) -> bool {
        if let Promise::Broken(step_ns, broke) = self.broke
            && self.ring.push(Entry::Broke { step_ns, broke }).is_ok()
        {
            self.broke = Promise::Reported;
        }
        let is_in = self.ring.push(entry).is_ok();
        if !is_in {
            self.found.dropped += 1;
            self.breaks(Broke::Dropped);
        }
        is_in
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

impl<S: Source + ?Sized, E: Endpoint + ?Sized> Keeps<S, E> for Frames<'_> {
    fn begin(&mut self, done: u64, output: &Output, _: &mut E) -> Result<bool, RunError> {
        if done == 0 {
            // The run starts with the first frame, not with the settings before it.
            self.found.clock.restart();
        }
        let due = self.found.clock.deadline();
        let late_ns = self.found.clock.wait().since(due);
        if late_ns >= STARVED_NS || self.found.clock.overruns() > self.limits.overruns_max {
            self.breaks(Broke::Late(late_ns));
        }
        self.note_pace(late_ns);
        self.frame_end = self.found.clock.deadline();
        if let Some(attended) = &mut self.attended {
            attended.tell(done, output);
        }
        // Once the keeper of the records has been told.
        let lost =
            self.broke == Promise::Reported && self.control.stop_when_lost.load(Ordering::Relaxed);
        Ok(self.control.look(done) || lost || self.stop.load(Ordering::Relaxed))
    }

    fn send(
        &mut self,
        endpoint: &mut E,
        step_ns: u64,
        epoch: &Epoch,
        output: &mut Output,
    ) -> Result<Sent, RunError> {
        self.step_ns = step_ns;
        if self.outstanding.len() == OUTSTANDING {
            return Err(self.silent(endpoint));
        }
        let at = now();
        let sent = endpoint.send(epoch, output)?;
        match sent {
            Sent::Answered => self.found.answers.record(now().since(at)),
            Sent::Underway => self.outstanding.push_back(Owed { epoch: *epoch, step_ns, at }),
            Sent::NotSent => {
                self.found.not_sent += 1;
                self.breaks(Broke::NotSent);
            }
        }
        Ok(sent)
    }

    /// Takes an answer that comes in this frame; those of earlier frames come first.
    fn owed(&mut self, endpoint: &mut E, output: &mut Output) -> Result<Option<Owed>, RunError> {
        if self.outstanding.is_empty() {
            return Ok(None);
        }
        self.take(self.frame_end, endpoint, output)
    }

    fn answered(
        &mut self,
        source: &S,
        endpoint: &E,
        step: InStep<'_>,
        sent: &Epoch,
        output: &Output,
    ) -> Result<Option<Ended>, RunError> {
        let (truth, stands) = (source.truth(), source.truth_stands());
        let known = Known { truth, stands, noise: source.known_noise() };
        self.pass_on(endpoint, step, sent, output, known);
        Ok(over(output))
    }

    fn lost(&mut self, source: &S, clean: Clean<'_>) -> Result<(), RunError> {
        self.step_ns = clean.source.sample.device_time.ns;
        self.lay(Entry::Lost {
            source: *clean.source,
            undisturbed: *clean.undisturbed,
            truth: source.truth(),
        });
        Ok(())
    }

    fn unit(&mut self, event: &UnitEvent, epoch: u64) {
        // The restarted unit has forgotten the earlier epochs.
        self.outstanding.clear();
        self.lay(Entry::Unit { event: *event, epoch });
    }

    fn occurrence(&mut self, occurrence: &Occurrence) {
        self.lay(Entry::Occurrence(*occurrence));
    }

    fn end(&mut self, endpoint: &E) -> Result<(), RunError> {
        let Some(oldest) = self.outstanding.front() else { return Ok(()) };
        self.found.late_answers += 1;
        if now().since(oldest.at) > self.limits.silence_ns {
            return Err(self.silent(endpoint));
        }
        Ok(())
    }

    fn drain(&mut self, endpoint: &mut E, output: &mut Output) -> Result<Ended, RunError> {
        while let Some(oldest) = self.outstanding.front() {
            let until = oldest.at.after(self.limits.silence_ns);
            let Some(owed) = self.take(until, endpoint, output)? else {
                return Err(self.silent(endpoint));
            };
            let step = InStep::Further { step_ns: owed.step_ns };
            self.pass_on(endpoint, step, &owed.epoch, output, Known::default());
            if let Some(ended) = over(output) {
                return Ok(ended);
            }
        }
        Ok(Ended::SourceEnded)
    }
}
