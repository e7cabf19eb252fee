//! The end that tests: it sends samples and gets outputs.
//!
//! In lock-step [`Harness::step`] waits for the answer and asks again until it is there. In real time
//! [`Harness::send_sample`] and [`Harness::poll`] are called on their own, and wait for nothing. None of
//! them allocates, but for an error.

use crate::asking::Taken;
use crate::clock::Stamps;
use crate::port::PortError;
use crate::wire::{Counts, Incoming, Wire};
use octant_sample::{Aiding, Output, Parameters, Sample};
use octant_wire::Text;
use octant_wire::message::{
    Agreement, AidingMessage, Bye, Capabilities, ClockTime, Condition, End, Gathered, Gathering,
    Heartbeat, Hello, Limits, Message, OutputMessage, Pacing, Reason, Refusal, Restart, Role,
    SampleMessage, Status, Step, TimeRequest, agree,
};
use std::fmt;
use std::time::{Duration, Instant};

/// How a session is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// How steps are paced.
    pub pacing: Pacing,
    /// Sample period, ns.
    pub sample_period_ns: u64,
    /// Hash of the configuration that the core should have; zeros: anything goes.
    pub configuration: [u8; 32],
    /// Name of this program.
    pub name: Text<24>,
    /// With its version.
    pub firmware: Text<24>,
    /// What is waited for how long.
    pub patience: Patience,
}

impl Options {
    /// A session in lock-step with a device of this sample period.
    #[must_use]
    pub fn lock_step(sample_period_ns: u64) -> Self {
        Self {
            pacing: Pacing::LockStep,
            sample_period_ns,
            configuration: [0; 32],
            name: Text::fitting("octant"),
            firmware: Text::fitting(concat!("octant ", env!("CARGO_PKG_VERSION"))),
            patience: Patience::default(),
        }
    }
}

/// What is waited for how long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// For the first hello.
    pub hello: Duration,
    /// For an answer, however often it is asked for.
    pub answer: Duration,
    /// For an answer before it is asked for again. A device that is slow is given longer.
    pub repeat: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self {
            hello: Duration::from_secs(10),
            answer: Duration::from_secs(5),
            repeat: Duration::from_millis(200),
        }
    }
}

/// Why a session can't begin or go on.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The port.
    #[error(transparent)]
    Port(#[from] PortError),
    /// Nothing came that was waited for.
    #[error(
        "{port}: no {waited_for} within {:.1} s, asked for {asked} times; {heard}",
        waited.as_secs_f64()
    )]
    NoAnswer {
        /// The port.
        port: String,
        /// What was waited for.
        waited_for: String,
        /// How long.
        waited: Duration,
        /// How often it was asked for.
        asked: u32,
        /// What came instead.
        heard: Heard,
    },
    /// The two ends don't fit together.
    #[error("{port}: {reason}")]
    Refused {
        /// The port.
        port: String,
        /// Why.
        reason: Refusal,
    },
    /// A name that a terminal would obey, or that no file may hold.
    #[error(
        "{port}: the device's {field} {found:?} has the control character {character:?}, expected text that can be printed"
    )]
    Control {
        /// The port.
        port: String,
        /// `name` or `firmware`.
        field: &'static str,
        /// What it said.
        found: String,
        /// The first of them.
        character: char,
    },
    /// The other end speaks a newer version.
    #[error("{port}: {reason}")]
    Newer {
        /// The port.
        port: String,
        /// Which versions met, and what to do.
        reason: octant_wire::Unreadable,
    },
    /// The other end said bye.
    #[error("{port}: the device said bye while {during} was waited for: {}", Said(bye))]
    Bye {
        /// The port.
        port: String,
        /// What was waited for.
        during: String,
        /// What it said.
        bye: Bye,
    },
    /// The other end has no session any more.
    #[error(
        "{port}: the device started anew in the middle of the session, or gave it up: what its core \
         knew is lost"
    )]
    StartedAnew {
        /// The port.
        port: String,
    },
    /// The other end can't do what is asked for.
    #[error("{port}: the device doesn't do {what}")]
    Unsupported {
        /// The port.
        port: String,
        /// What it was asked for.
        what: &'static str,
    },
}

/// What a bye says.
struct Said<'a>(&'a Bye);

impl fmt::Display for Said<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.reason.name())?;
        match self.0.text.as_str() {
            "" => Ok(()),
            text => write!(f, " ({text})"),
        }
    }
}

/// What came while something else was waited for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard {
    /// Messages.
    pub messages: u64,
    /// Bytes or frames that were no message.
    pub lost: u64,
    /// Damaged frames or messages.
    pub damaged: u64,
    /// Messages that the port did not take.
    pub not_sent: u64,
    /// The CAN controller is off the bus.
    pub off_bus: bool,
    /// An end that said bye before.
    pub bye: Option<Reason>,
}

impl fmt::Display for Heard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { messages, lost, damaged, not_sent, off_bus, bye } = *self;
        match (messages, lost + damaged) {
            (0, 0) => f.write_str("nothing at all was received")?,
            (0, _) => write!(
                f,
                "no message was received, but {lost} bytes or frames that are none ({damaged} \
                 damaged): is it the right rate, and is it our protocol?"
            )?,
            (_, 0) => write!(f, "{messages} other messages were received")?,
            _ => write!(
                f,
                "{messages} other messages were received, and {lost} bytes or frames that are none"
            )?,
        }
        if not_sent > 0 {
            write!(f, "; {not_sent} messages were not taken by the port")?;
        }
        if off_bus {
            f.write_str("; the controller is off the bus")?;
        }
        match bye {
            Some(reason) => write!(f, "; a bye came before: {}", reason.name()),
            None => Ok(()),
        }
    }
}

/// What was heard of the other end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "the large variant is the one that comes")]
pub enum Event {
    /// It answered a sample, or the end.
    Output(OutputMessage),
    /// All parameters are there.
    Parameters(Gathered),
    /// It started anew, as it was asked to.
    Ready(Step),
    /// What it has done and lost.
    Status(Status),
    /// It is there.
    Heartbeat(Heartbeat),
    /// It told the time.
    Time(Stamps),
    /// An instrument measured.
    Sample(SampleMessage),
    /// The reference that goes with an instrument's next sample.
    Aiding(AidingMessage),
    /// It said hello without a session: it started anew, or this is an old frame that came again. Who
    /// gets no answers any more either knows which.
    Anew,
    /// Something without meaning here.
    Other,
}

/// What became of a sample that was sent without waiting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sending {
    /// It is on its way.
    Sent(Step),
    /// The port did not take it whole: the device counts a step that never came.
    NotTaken(Step),
    /// As many are underway as the device takes: it was not sent, and has no step.
    WindowFull,
}

/// What happened beside the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Requests that were sent again.
    pub repeated: u64,
    /// Answers that came after another was there already.
    pub doubled: u64,
    /// How often the port went away and came back.
    pub reconnected: u32,
    /// How long it was away, all together.
    pub away: Duration,
}

/// A session, seen from the harness.
#[derive(Debug)]
pub struct Harness {
    wire: Wire,
    options: Options,
    theirs: Hello,
    agreement: Agreement,
    /// The last step that was sent, and answered.
    step: Step,
    answered: Step,
    /// What is repeated.
    request: Option<Message>,
    aiding: Option<AidingMessage>,
    gathering: Gathering,
    parameters: Option<Gathered>,
    status: Option<Status>,
    effort: Effort,
    taken: Taken,
    time_id: u16,
    bye: Option<Reason>,
    said_bye: bool,
}

impl Harness {
    /// Begins a session: says hello until the other end answers, and looks whether it fits.
    ///
    /// # Errors
    /// If nobody answers, or the two ends don't fit together.
    pub fn open(mut wire: Wire, options: Options) -> Result<Self, SessionError> {
        let session = draw_session();
        let ours = Hello {
            role: Role::Harness,
            pacing: options.pacing,
            session,
            capabilities: Capabilities::empty(),
            sample_period_ns: options.sample_period_ns,
            limits: Limits::default(),
            configuration: options.configuration,
            name: options.name,
            firmware: options.firmware,
            ..Hello::default()
        };
        let mut stale = None;
        let theirs = say_hello(&mut wire, &ours, &options.patience, &mut stale)?;
        for (field, text) in
            [("name", theirs.name.as_str()), ("firmware", theirs.firmware.as_str())]
        {
            let Some(character) = text.chars().find(|c| is_control(*c)) else { continue };
            let bye =
                Bye { reason: Reason::FAILED, text: Text::fitting("control characters in a name") };
            let _ = wire.send(&Message::Bye(bye), options.patience.repeat);
            return Err(SessionError::Control {
                port: wire.name().to_owned(),
                field,
                found: text.to_owned(),
                character,
            });
        }
        let agreement = agree(&ours, &theirs).map_err(|reason| {
            // It may be gone before it hears it.
            let _ = wire.send(&Message::Bye(reason.bye()), options.patience.repeat);
            SessionError::Refused { port: wire.name().to_owned(), reason }
        })?;
        Ok(Self {
            wire,
            options,
            theirs,
            agreement,
            step: Step::default(),
            answered: Step::default(),
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

    /// What the other end said of itself.
    #[must_use]
    pub fn theirs(&self) -> &Hello {
        &self.theirs
    }

    /// What both agreed on.
    #[must_use]
    pub fn agreement(&self) -> Agreement {
        self.agreement
    }

    /// How the port is called.
    #[must_use]
    pub fn name(&self) -> &str {
        self.wire.name()
    }

    /// What went over the wire.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.wire.counts()
    }

    /// What happened beside the steps.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// The last status of the device.
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        self.status
    }

    /// The parameters that came last, with their σ.
    #[must_use]
    pub fn parameters(&self) -> Option<&Gathered> {
        self.parameters.as_ref()
    }

    /// The wire, for its clock and its faults.
    pub fn wire(&mut self) -> &mut Wire {
        &mut self.wire
    }

    /// Requests that are sent and not answered.
    #[must_use]
    pub fn underway(&self) -> u16 {
        self.step.since(self.answered).unsigned_abs()
    }

    /// A step in lock-step: sends the sample, waits for the answer, asks again where none comes.
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

    /// The core starts anew, in lock-step.
    ///
    /// # Errors
    /// If the device or the port is gone, or it can't restart its core.
    pub fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), SessionError> {
        self.needs(Capabilities::RESTART, "restarts of its core")?;
        let step = self.step.next();
        self.ask(step, Message::Restart(Restart { step, offset: offset.copied() }));
        self.parameters = None;
        self.send_request(self.options.patience.repeat)?;
        self.wait_for(step, "ready", |_, event| {
            matches!(event, Event::Ready(ready) if *ready == step).then_some(())
        })
    }

    /// No sample comes any more, in lock-step. `None`: the device doesn't conclude.
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

    /// Sends a sample, and waits for nothing.
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

    /// What came from the device, within a time; with no time, what is there already.
    ///
    /// # Errors
    /// If the port or the device is gone.
    pub fn poll(&mut self, wait: Duration) -> Result<Option<Event>, SessionError> {
        match self.wire.receive(wait)? {
            Some(incoming) => self.take(incoming, "output").map(Some),
            None => Ok(None),
        }
    }

    /// Lets the device know that this end is there, if it hasn't heard of it for a while. To be
    /// called in pauses.
    ///
    /// # Errors
    /// If the port is gone.
    pub fn keep_alive(&mut self) -> Result<(), SessionError> {
        let silence = Duration::from_millis(self.theirs.limits.silence_ms.into());
        if !silence.is_zero() && self.wire.quiet() >= silence / 4 {
            let heartbeat = Heartbeat {
                step: self.step,
                condition: if self.step == Step::default() {
                    Condition::Ready
                } else {
                    Condition::Stepping
                },
                queued: 0,
                clock: self.wire.now(),
            };
            self.wire.send(&Message::Heartbeat(heartbeat), Duration::ZERO)?;
        }
        Ok(())
    }

    /// How long nothing intact was received.
    #[must_use]
    pub fn silence(&self) -> Duration {
        self.wire.silence()
    }

    /// Asks the other end for the time; the answer is an [`Event::Time`].
    ///
    /// # Errors
    /// If the port is gone.
    pub fn request_time(&mut self) -> Result<(), SessionError> {
        self.time_id = self.time_id.wrapping_add(1);
        let request = TimeRequest { id: self.time_id, harness_sent: self.wire.now() };
        self.wire.send(&Message::TimeRequest(request), Duration::ZERO)?;
        Ok(())
    }

    /// Says bye; the session is over.
    pub fn bye(&mut self, reason: Reason, text: &str) {
        if !std::mem::replace(&mut self.said_bye, true) {
            let bye = Bye { reason, text: Text::fitting(text) };
            // Who goes doesn't care whether the other is still there.
            let _ = self.wire.send(&Message::Bye(bye), Duration::from_millis(100));
        }
    }

    /// The port went away: opens it again, `away` after that. What wasn't answered is asked for by
    /// [`Self::step_again`]; a device that kept its session goes on where it was.
    ///
    /// # Errors
    /// If it isn't back.
    pub fn reopen(&mut self, away: Duration) -> Result<(), PortError> {
        self.wire.reopen()?;
        self.effort.reconnected += 1;
        self.effort.away += away;
        Ok(())
    }

    /// The answer to the last request, which is sent again: after [`Self::reopen`].
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

    /// That the device has no session any more.
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

    fn ask(&mut self, step: Step, request: Message) {
        self.step = step;
        self.request = Some(request);
        self.aiding = None;
    }

    fn next_sample(&mut self, sample: &Sample, aiding: Option<&Aiding>) -> Step {
        let step = self.step.next();
        let message = SampleMessage { step, aided: aiding.is_some(), sample: *sample };
        self.ask(step, Message::Sample(message));
        self.aiding = aiding.map(|aiding| AidingMessage { step, aiding: *aiding });
        step
    }

    /// Sends the request that is remembered, its aiding before it.
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
        step: Step,
        what: &'static str,
    ) -> Result<OutputMessage, SessionError> {
        let mut answer: Option<OutputMessage> = None;
        self.wait_for(step, what, |this, event| {
            match event {
                Event::Output(output) if output.step == step => {
                    this.effort.doubled += u64::from(answer.is_some());
                    answer = Some(*output);
                }
                Event::Parameters(_) => {}
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

    /// Waits for the answer to the last request, and asks again where it isn't there in time.
    fn wait_for<T>(
        &mut self,
        step: Step,
        what: &'static str,
        mut found: impl FnMut(&mut Self, &Event) -> Option<T>,
    ) -> Result<T, SessionError> {
        let Patience { repeat, answer, .. } = self.options.patience;
        let silence = Duration::from_millis(self.theirs.limits.silence_ms.into());
        let mut intervals = self.taken.ask(repeat, answer);
        let before = self.wire.counts();
        let begun = Instant::now();
        let (mut asked_at, mut asked, mut anew) = (begun, 1, 0);
        loop {
            let left = answer.saturating_sub(begun.elapsed());
            let mut wait = intervals.now().saturating_sub(asked_at.elapsed()).min(left);
            if !silence.is_zero() {
                // It is waited for longer than the device may think that nobody is there.
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
                // A device without a session says so each time that it is asked; a frame that came
                // again on its way does not.
                anew += u32::from(event == Event::Anew);
                if anew >= ANEW {
                    return Err(self.started_anew());
                }
            }
            let waited = begun.elapsed();
            if waited >= answer {
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

    #[cold]
    fn no_answer(
        &self,
        before: &Counts,
        step: Step,
        what: &str,
        waited: Duration,
        asked: u32,
    ) -> SessionError {
        SessionError::NoAnswer {
            port: self.wire.name().to_owned(),
            waited_for: format!("{what} to step {}", step.number()),
            waited,
            asked,
            heard: heard(&self.wire, before, self.bye),
        }
    }

    /// Takes what came.
    fn take(&mut self, incoming: Incoming, during: &str) -> Result<Event, SessionError> {
        let message = match incoming {
            Incoming::Message(message) => message,
            // The two agreed on a version: on a bus a spoilt frame can look like that.
            Incoming::Newer(_) => return Ok(Event::Other),
        };
        Ok(match message {
            Message::Output(output) => {
                if self.options.pacing == Pacing::RealTime
                    && output.step.since(self.answered) > 0
                    && output.step.since(self.step) <= 0
                {
                    self.answered = output.step;
                }
                Event::Output(output)
            }
            Message::Parameters(segment) => match self.gathering.add(&segment) {
                Some(gathered) => {
                    self.parameters = Some(gathered);
                    Event::Parameters(gathered)
                }
                None => Event::Other,
            },
            Message::Ready(ready) => {
                if self.options.pacing == Pacing::RealTime {
                    self.answered = ready.step;
                }
                Event::Ready(ready.step)
            }
            Message::Status(status) => {
                self.status = Some(status);
                Event::Status(status)
            }
            Message::Heartbeat(heartbeat) => Event::Heartbeat(heartbeat),
            Message::TimeReply(reply) => {
                Event::Time(Stamps { reply, harness_received: self.wire.now() })
            }
            // The answer to a hello that was said twice.
            Message::Hello(hello) if hello.session == self.agreement.session => Event::Other,
            Message::Hello(hello) if hello.role != Role::Harness => Event::Anew,
            Message::Bye(bye) => {
                self.said_bye = true;
                return Err(SessionError::Bye {
                    port: self.wire.name().to_owned(),
                    during: during.to_owned(),
                    bye,
                });
            }
            Message::Sample(sample) => Event::Sample(sample),
            Message::Aiding(aiding) => Event::Aiding(aiding),
            _ => Event::Other,
        })
    }

    /// The harness's clock now.
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

/// Hellos without a session after which a device has none.
pub const ANEW: u32 = 2;

/// A number of a session, not 0, that no other has had lately.
fn draw_session() -> u32 {
    use std::hash::{BuildHasher, Hasher};
    // Keyed by the system's random numbers, anew each time.
    let mut hasher = std::collections::hash_map::RandomState::new().build_hasher();
    hasher.write_u32(std::process::id());
    (hasher.finish() as u32).max(1)
}

fn newer(wire: &Wire, found: u16) -> SessionError {
    SessionError::Newer {
        port: wire.name().to_owned(),
        reason: octant_wire::Unreadable::NewerVersion { found },
    }
}

fn heard(wire: &Wire, before: &Counts, bye: Option<Reason>) -> Heard {
    let now = wire.counts();
    Heard {
        messages: now.received - before.received,
        lost: now.lost - before.lost,
        damaged: now.damaged - before.damaged,
        not_sent: now.not_sent - before.not_sent,
        off_bus: wire.is_off_bus(),
        bye,
    }
}

/// Reasons that refuse, and say goodbye to no session that was.
fn refuses(reason: Reason) -> bool {
    matches!(
        reason,
        Reason::VERSION
            | Reason::ROLE
            | Reason::SESSION
            | Reason::PACING
            | Reason::PERIOD
            | Reason::CONFIGURATION
            | Reason::UNSUPPORTED
    )
}

/// Whether a terminal obeys a character, or writes the line in another order for it.
fn is_control(c: char) -> bool {
    c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn say_hello(
    wire: &mut Wire,
    ours: &Hello,
    patience: &Patience,
    stale: &mut Option<Reason>,
) -> Result<Hello, SessionError> {
    let before = wire.counts();
    let begun = Instant::now();
    let mut intervals = Taken::default().ask(patience.repeat, patience.hello);
    let (mut asked, mut newer_seen) = (0, None);
    loop {
        wire.send(&Message::Hello(*ours), patience.repeat)?;
        asked += 1;
        let asked_at = Instant::now();
        loop {
            let left = intervals.now().saturating_sub(asked_at.elapsed());
            match wire.receive(left)? {
                // Nothing protects the version of a hello on a bus: it has to be said twice.
                Some(Incoming::Newer(found)) if newer_seen.replace(found) == Some(found) => {
                    return Err(newer(wire, found));
                }
                Some(Incoming::Message(Message::Hello(theirs)))
                    if theirs.session == ours.session =>
                {
                    return Ok(theirs);
                }
                // What a device says that gives up an earlier session may still lie on the line.
                Some(Incoming::Message(Message::Bye(bye))) if !refuses(bye.reason) => {
                    *stale = Some(bye.reason);
                }
                Some(Incoming::Message(Message::Bye(bye))) => {
                    return Err(SessionError::Bye {
                        port: wire.name().to_owned(),
                        during: "its hello".to_owned(),
                        bye,
                    });
                }
                _ => {}
            }
            if asked_at.elapsed() >= intervals.now() {
                break;
            }
        }
        intervals.again();
        let waited = begun.elapsed();
        if waited >= patience.hello {
            return Err(SessionError::NoAnswer {
                port: wire.name().to_owned(),
                waited_for: "hello".to_owned(),
                waited,
                asked,
                heard: heard(wire, &before, *stale),
            });
        }
    }
}
