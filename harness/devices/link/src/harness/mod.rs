//! Harness end of a session: sends samples and receives outputs.
//!
//! In lock-step, [`Harness::step`] waits for the answer and repeats the request until it is there. In
//! real time, [`Harness::send_sample`] and [`Harness::poll`] are called separately: sending waits for
//! nothing, and polling no longer than it is told to. None of them allocates, except for an error.

mod error;
mod event;
mod greeting;
mod incoming;
mod options;
mod power;

pub use error::{HeardTraffic, SessionError};
pub use event::{Effort, LinkEvent, Sending};
pub use options::{Patience, SessionOptions};
pub use power::SignOfLife;

use crate::asking::Taken;
use crate::port::PortError;
use crate::wire::{TrafficCounts, Wire};
use greeting::greet;
use octant_sample::{Aiding, Output, Parameters, Sample};
use octant_wire::Text;
use octant_wire::message::{
    Agreement, AidingMessage, Bye, Capabilities, ClockTime, DeviceStatus, End, EndCondition,
    Gathered, Gathering, Heartbeat, Hello, Message, OutputMessage, Reason, Restart, SampleMessage,
    StepNumber, TimeRequest,
};
use std::time::{Duration, Instant};

/// A session, seen from the harness.
#[derive(Debug)]
pub struct Harness {
    wire: Wire,
    options: SessionOptions,
    theirs: Hello,
    agreement: Agreement,
    /// Last step sent; `answered` is the last step answered.
    step: StepNumber,
    answered: StepNumber,
    /// Request that is repeated until answered.
    request: Option<Message>,
    aiding: Option<AidingMessage>,
    gathering: Gathering,
    parameters: Option<Gathered>,
    status: Option<DeviceStatus>,
    effort: Effort,
    taken: Taken,
    time_id: u16,
    bye: Option<Reason>,
    said_bye: bool,
}

impl Harness {
    /// Begins a session: says hello until the other end answers, and checks that the two fit together.
    ///
    /// # Errors
    /// If nobody answers, or the two ends don't fit together.
    pub fn open(mut wire: Wire, options: SessionOptions) -> Result<Self, SessionError> {
        let (theirs, agreement) = greet(&mut wire, &options, options.patience.hello)?;
        Ok(Self {
            wire,
            options,
            theirs,
            agreement,
            step: StepNumber::default(),
            answered: StepNumber::default(),
            request: None,
            aiding: None,
            gathering: Gathering::new(),
            parameters: None,
            status: None,
            effort: Effort::default(),
            taken: Taken::default(),
            time_id: 0,
            bye: None,
            said_bye: false,
        })
    }

    /// Hello of the other end.
    #[must_use]
    pub fn theirs(&self) -> &Hello {
        &self.theirs
    }

    /// Agreement of both ends.
    #[must_use]
    pub fn agreement(&self) -> Agreement {
        self.agreement
    }

    /// Name of the port.
    #[must_use]
    pub fn name(&self) -> &str {
        self.wire.name()
    }

    /// Counts of the traffic on the wire.
    #[must_use]
    pub fn counts(&self) -> TrafficCounts {
        self.wire.counts()
    }

    /// Counts of repetitions and reconnections.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Last status of the device.
    #[must_use]
    pub fn status(&self) -> Option<DeviceStatus> {
        self.status
    }

    /// Parameters received last, with their σ.
    #[must_use]
    pub fn parameters(&self) -> Option<&Gathered> {
        self.parameters.as_ref()
    }

    /// Wire of this session, for its clock and its faults.
    pub fn wire(&mut self) -> &mut Wire {
        &mut self.wire
    }

    /// Number of requests sent and not yet answered.
    #[must_use]
    pub fn underway(&self) -> u16 {
        self.step.since(self.answered).unsigned_abs()
    }

    /// Makes a step in lock-step: sends the sample, waits for the answer, and repeats the request if
    /// none comes.
    ///
    /// # Errors
    /// If the device or the port is gone.
    pub fn step(
        &mut self,
        sample: &Sample,
        aiding: Option<&Aiding>,
        output: &mut Output,
    ) -> Result<OutputMessage, SessionError> {
        let step = self.next_sample(sample, aiding);
        self.send_request(self.options.patience.repeat)?;
        let answer = self.wait_for_output(step, "output")?;
        *output = answer.output;
        Ok(answer)
    }

    /// Restarts the core, in lock-step.
    ///
    /// # Errors
    /// If the device or the port is gone, or the device can't restart its core.
    pub fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), SessionError> {
        self.needs(Capabilities::RESTART, "restarts of its core")?;
        let step = self.step.next();
        self.ask(step, Message::Restart(Restart { step, offset: offset.copied() }));
        self.parameters = None;
        self.send_request(self.options.patience.repeat)?;
        self.wait_for(step, "ready", |_, event| {
            matches!(event, LinkEvent::Ready(ready) if *ready == step).then_some(())
        })
    }

    /// Tells the device that no sample follows, in lock-step. `None`: the device can't conclude.
    ///
    /// # Errors
    /// If the device or the port is gone.
    pub fn end(&mut self) -> Result<Option<Output>, SessionError> {
        if !self.theirs.capabilities.contains(Capabilities::END) {
            return Ok(None);
        }
        let step = self.step.next();
        self.ask(step, Message::End(End { step }));
        self.send_request(self.options.patience.repeat)?;
        Ok(Some(self.wait_for_output(step, "output after the end")?.output))
    }

    /// Sends a sample without waiting for its answer.
    ///
    /// # Errors
    /// If the port is gone.
    pub fn send_sample(
        &mut self,
        sample: &Sample,
        aiding: Option<&Aiding>,
    ) -> Result<Sending, SessionError> {
        let window = self.theirs.limits.window.max(1);
        if self.underway() >= window {
            return Ok(Sending::WindowFull);
        }
        let step = self.next_sample(sample, aiding);
        let sent = self.send_request(Duration::ZERO)?;
        Ok(if sent { Sending::Sent(step) } else { Sending::NotTaken(step) })
    }

    /// Receives the next event from the device within a time; with zero wait, only what is already
    /// there.
    ///
    /// # Errors
    /// If the port or the device is gone.
    pub fn poll(&mut self, wait: Duration) -> Result<Option<LinkEvent>, SessionError> {
        match self.wire.receive(wait)? {
            Some(incoming) => self.take(incoming, "output").map(Some),
            None => Ok(None),
        }
    }

    /// Sends a sign of life if nothing was sent for a quarter of the device's limit of silence. To be
    /// called in pauses.
    ///
    /// # Errors
    /// If the port is gone.
    pub fn keep_alive(&mut self) -> Result<(), SessionError> {
        let silence = Duration::from_millis(self.theirs.limits.silence_ms.into());
        if !silence.is_zero() && self.wire.quiet() >= silence / 4 {
            let heartbeat = Heartbeat {
                step: self.step,
                condition: if self.step == StepNumber::default() {
                    EndCondition::Ready
                } else {
                    EndCondition::Stepping
                },
                queued: 0,
                clock: self.wire.now(),
            };
            self.wire.send(&Message::Heartbeat(heartbeat), Duration::ZERO)?;
        }
        Ok(())
    }

    /// Asks the other end for the time; the answer arrives as an [`LinkEvent::Time`].
    ///
    /// # Errors
    /// If the port is gone.
    pub fn request_time(&mut self) -> Result<(), SessionError> {
        self.time_id = self.time_id.wrapping_add(1);
        let request = TimeRequest { id: self.time_id, harness_sent: self.wire.now() };
        self.wire.send(&Message::TimeRequest(request), Duration::ZERO)?;
        Ok(())
    }

    /// Says bye, which ends the session.
    pub fn bye(&mut self, reason: Reason, text: &str) {
        if !std::mem::replace(&mut self.said_bye, true) {
            let bye = Bye { reason, text: Text::fitting(text) };
            // A failure doesn't matter: the session is over either way.
            let _ = self.wire.send(&Message::Bye(bye), Duration::from_millis(100));
        }
    }

    /// Opens the port again after it was away for `away`. [`Self::step_again`] then repeats an
    /// unanswered request; a device that kept its session continues where it was.
    ///
    /// # Errors
    /// If the port isn't back.
    pub fn reopen(&mut self, away: Duration) -> Result<(), PortError> {
        self.wire.reopen()?;
        self.effort.reconnected += 1;
        self.effort.away += away;
        Ok(())
    }

    /// Repeats the last request and waits for its answer: after [`Self::reopen`].
    ///
    /// # Errors
    /// If the device or the port is gone.
    pub fn step_again(&mut self, output: &mut Output) -> Result<OutputMessage, SessionError> {
        self.effort.repeated += 1;
        self.send_request(self.options.patience.repeat)?;
        let answer = self.wait_for_output(self.step, "output")?;
        *output = answer.output;
        Ok(answer)
    }

    /// Error for a device that has no session any more.
    #[must_use]
    pub fn started_anew(&self) -> SessionError {
        SessionError::StartedAnew { port: self.wire.name().to_owned() }
    }

    fn needs(&self, what: Capabilities, name: &'static str) -> Result<(), SessionError> {
        if self.theirs.capabilities.contains(what) {
            return Ok(());
        }
        Err(SessionError::Unsupported { port: self.wire.name().to_owned(), what: name })
    }

    fn ask(&mut self, step: StepNumber, request: Message) {
        self.step = step;
        self.request = Some(request);
        self.aiding = None;
    }

    fn next_sample(&mut self, sample: &Sample, aiding: Option<&Aiding>) -> StepNumber {
        let step = self.step.next();
        let message = SampleMessage { step, aided: aiding.is_some(), sample: *sample };
        self.ask(step, Message::Sample(message));
        self.aiding = aiding.map(|aiding| AidingMessage { step, aiding: *aiding });
        step
    }

    /// Sends the remembered request, preceded by its aiding.
    fn send_request(&mut self, wait: Duration) -> Result<bool, SessionError> {
        let mut taken = true;
        if let Some(aiding) = self.aiding {
            taken &= self.wire.send(&Message::Aiding(aiding), wait)?;
        }
        if let Some(request) = self.request {
            taken &= self.wire.send(&request, wait)?;
        }
        Ok(taken)
    }

    fn wait_for_output(
        &mut self,
        step: StepNumber,
        what: &'static str,
    ) -> Result<OutputMessage, SessionError> {
        let mut answer: Option<OutputMessage> = None;
        self.wait_for(step, what, |this, event| {
            match event {
                LinkEvent::Output(output) if output.step == step => {
                    this.effort.doubled += u64::from(answer.is_some());
                    answer = Some(*output);
                }
                LinkEvent::Parameters(_) => {}
                _ => return None,
            }
            let answer = answer?;
            let there = |gathered: &Gathered| {
                gathered.step == step && gathered.revision == answer.output.parameters_revision
            };
            let complete = !answer.parameters_follow || this.parameters.as_ref().is_some_and(there);
            complete.then_some(answer)
        })
    }

    /// Waits for the answer to the last request, and repeats the request when the answer is late.
    fn wait_for<T>(
        &mut self,
        step: StepNumber,
        what: &'static str,
        mut found: impl FnMut(&mut Self, &LinkEvent) -> Option<T>,
    ) -> Result<T, SessionError> {
        let Patience { repeat, answer, .. } = self.options.patience;
        let silence = Duration::from_millis(self.theirs.limits.silence_ms.into());
        let mut intervals = self.taken.ask(repeat, answer);
        let before = self.wire.counts();
        let begun = Instant::now();
        // Patience is for the device: a time in which this process is stopped doesn't count.
        let waited_before = self.wire.waited.total();
        let (mut asked_at, mut asked, mut anew) = (begun, 1, 0);
        loop {
            let left = answer.saturating_sub(self.wire.waited.total() - waited_before);
            let mut wait = intervals.now().saturating_sub(asked_at.elapsed()).min(left);
            if !silence.is_zero() {
                // The wait may be longer than the silence after which the device gives up this harness.
                self.keep_alive()?;
                wait = wait.min(silence / 4);
            }
            if let Some(incoming) = self.wire.receive(wait)? {
                let event = self.take(incoming, what)?;
                if let Some(found) = found(self, &event) {
                    self.answered = step;
                    self.taken.add(begun.elapsed());
                    return Ok(found);
                }
                // A device without a session says so at each request; a frame repeated on its way does
                // not.
                anew += u32::from(event == LinkEvent::Anew);
                if anew >= ANEW {
                    return Err(self.started_anew());
                }
            }
            let waited = self.wire.waited.total() - waited_before;
            if waited >= answer {
                // One is enough where no answer came.
                if anew > 0 {
                    return Err(self.started_anew());
                }
                return Err(self.no_answer(&before, step, what, waited, asked));
            }
            if asked_at.elapsed() < intervals.now() {
                continue;
            }
            intervals.again();
            self.send_request(repeat)?;
            self.effort.repeated += 1;
            asked_at = Instant::now();
            asked += 1;
        }
    }

    /// Time of the harness's clock.
    #[must_use]
    pub fn now(&self) -> ClockTime {
        self.wire.now()
    }
}

impl Drop for Harness {
    fn drop(&mut self) {
        self.bye(Reason::STOPPED, "the harness stopped");
    }
}

/// Number of hellos without a session after which the session counts as lost.
pub const ANEW: u32 = 2;
