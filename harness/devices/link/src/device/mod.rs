//! Device end of a session: steps a core once for each sample, never twice.
//!
//! A device serves one harness at a time, until the harness says bye or is silent for too long, or a
//! hello begins another session. Nothing else that arrives over the line stops it from serving.

mod notice;
mod stepped;

pub use notice::Notice;
pub use stepped::{Facts, Steps};

use crate::port::{self, PortError};
use crate::uri::Uri;
use crate::wire::{Incoming, TrafficCounts, Wire};
use octant_sample::{Aiding, Output, Parameters, Sample};
use octant_wire::message::{
    Bye, DeviceStatus, EndCondition, EndRole, Heartbeat, Hello, Message, OutputMessage,
    PARAMETERS_SEGMENTS, ParametersSegment, Ready, Reason, StepNumber, StepPacing, TimeReply,
    agree,
};
use octant_wire::requests::{RequestDecision, Requests};
use octant_wire::{Text, VERSION};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Complete answer to a request, remembered so that it can be sent again.
#[derive(Clone, Copy, Debug, Default)]
struct Answer {
    output: Option<OutputMessage>,
    ready: Option<Ready>,
    segments: Option<[ParametersSegment; PARAMETERS_SEGMENTS]>,
}

/// A session, seen from the device.
#[derive(Debug)]
struct Session {
    id: u32,
    requests: Requests,
    /// Silence after which the harness gives up this device; zero: never.
    their_silence: Duration,
    counts_before: TrafficCounts,
    answer: Answer,
    revision: Option<u32>,
    late: u32,
    condition: EndCondition,
    status_sent: Instant,
}

/// A device that serves over a wire.
pub struct Device<'a> {
    wire: Wire,
    facts: Facts,
    steps: &'a mut dyn Steps,
    notice: &'a mut dyn FnMut(&Notice),
    session: Option<Session>,
    output: Output,
    /// Newer protocol version that was heard last.
    newer: Option<u16>,
    /// Time of the last hello that told a harness that there is no session.
    lost_since: Option<Instant>,
    /// Datagrams without the secret's seal that were told of.
    unsealed_told: u64,
}

/// Longest time for the port to accept a message before it is dropped: the harness asks again.
const SEND_WAIT: Duration = Duration::from_millis(200);
/// Longest wait for a message, which bounds the reaction time to a stop request.
const WAIT: Duration = Duration::from_millis(20);
/// Interval between two status messages of a session.
const STATUS_EVERY: Duration = Duration::from_secs(1);
/// Datagrams without the secret's seal that are worth a notice.
const UNSEALED_TOLD: u64 = 10;

impl<'a> Device<'a> {
    /// Makes a device without a session, and says hello, so that a harness in the middle of a session
    /// sees that the device restarted.
    ///
    /// If the port is gone.
    /// If the port is gone already.
    pub fn new(
        wire: Wire,
        facts: Facts,
        steps: &'a mut dyn Steps,
        notice: &'a mut dyn FnMut(&Notice),
    ) -> Result<Self, PortError> {
        let mut device = Self {
            wire,
            facts,
            steps,
            notice,
            session: None,
            output: Output::default(),
            newer: None,
            lost_since: None,
            unsealed_told: 0,
        };
        device.say_hello(0, StepPacing::LockStep, Duration::ZERO)?;
        Ok(device)
    }

    /// Serves until it is stopped.
    ///
    /// If the port goes away. The session stays, and continues when the port is [open
    /// again](Wire::reopen).
    /// on.
    pub fn serve(&mut self, stop: &AtomicBool) -> Result<(), PortError> {
        let mut looked = Instant::now();
        while !stop.load(Ordering::Relaxed) {
            if let Some(incoming) = self.wire.receive(WAIT)? {
                self.take(incoming)?;
            }
            // Messages in an unbroken row must not delay status, heartbeat and the check for silence.
            if looked.elapsed() >= WAIT / 2 {
                self.look_after()?;
                looked = Instant::now();
            }
        }
        self.leave(Reason::STOPPED, "the device was stopped")
    }

    /// Wire of this device.
    #[must_use]
    pub fn wire(&self) -> &Wire {
        &self.wire
    }

    fn say_hello(
        &mut self,
        session: u32,
        pacing: StepPacing,
        wait: Duration,
    ) -> Result<(), PortError> {
        let hello = self.hello(session, pacing);
        self.wire.send(&Message::Hello(hello), wait).map(|_| ())
    }

    fn hello(&self, session: u32, pacing: StepPacing) -> Hello {
        Hello {
            version: VERSION,
            role: EndRole::Device,
            pacing,
            session,
            capabilities: self.facts.capabilities,
            sample_period_ns: self.facts.sample_period_ns,
            limits: self.facts.limits,
            configuration: self.facts.configuration,
            name: self.facts.name,
            firmware: self.facts.firmware,
        }
    }

    fn say_bye(&mut self, reason: Reason, text: &str) -> Result<(), PortError> {
        let bye = Bye { reason, text: Text::fitting(text) };
        self.wire.send(&Message::Bye(bye), SEND_WAIT).map(|_| ())
    }

    fn take(&mut self, incoming: Incoming) -> Result<(), PortError> {
        let arrived = Instant::now();
        let message = match incoming {
            Incoming::Message(message) => message,
            // No checksum protects the version of a hello on a bus: in a session it must arrive twice.
            Incoming::Newer(found)
                if self.session.is_some() && self.newer.replace(found) != Some(found) =>
            {
                return Ok(());
            }
            Incoming::Newer(found) => {
                (self.notice)(&Notice::Refused(format!(
                    "it speaks version {found}, this device version {VERSION}"
                )));
                return self.say_bye(Reason::VERSION, "version 1 is spoken here");
            }
        };
        match message {
            Message::Hello(theirs) => return self.greet(&theirs),
            Message::Bye(bye) => {
                let why = match bye.text.as_str() {
                    "" => format!("the harness said bye, {}", bye.reason.name()),
                    text => format!("the harness said bye, {} ({text})", bye.reason.name()),
                };
                self.over(&why);
                return Ok(());
            }
            _ => {}
        }
        if self.session.is_none() {
            return self.no_session(&message);
        }
        match message {
            Message::Aiding(aiding) => {
                if let Some(session) = &mut self.session {
                    session.requests.aiding(&aiding);
                }
                Ok(())
            }
            Message::Sample(sample) => {
                let verdict = self.decide(|requests| requests.sample(&sample));
                self.follow(verdict, sample.step, |device, aiding| {
                    device.step(&sample.sample, aiding.as_ref(), arrived)
                })
            }
            Message::End(end) => {
                let verdict = self.decide(|requests| requests.other(end.step));
                self.follow(verdict, end.step, |device, _| device.end(end.step))
            }
            Message::Restart(restart) => {
                let verdict = self.decide(|requests| requests.other(restart.step));
                self.follow(verdict, restart.step, |device, _| {
                    device.restart(restart.step, restart.offset.as_ref())
                })
            }
            Message::TimeRequest(request) => {
                let reply = TimeReply {
                    id: request.id,
                    harness_sent: request.harness_sent,
                    received: self.wire.at(arrived),
                    sent: self.wire.now(),
                };
                self.wire.send(&Message::TimeReply(reply), SEND_WAIT).map(|_| ())
            }
            _ => Ok(()),
        }
    }

    /// Answers a request without a session by a hello of session 0, at most once in [`SEND_WAIT`].
    #[cold]
    fn no_session(&mut self, message: &Message) -> Result<(), PortError> {
        let asks = matches!(message, Message::Sample(_) | Message::End(_) | Message::Restart(_));
        let lately = self.lost_since.is_some_and(|at| at.elapsed() < SEND_WAIT);
        if asks && !lately {
            self.lost_since = Some(Instant::now());
            self.say_hello(0, StepPacing::LockStep, SEND_WAIT)?;
        }
        Ok(())
    }

    /// Answers a hello: begins a session or refuses it.
    fn greet(&mut self, theirs: &Hello) -> Result<(), PortError> {
        if theirs.role == EndRole::Harness
            && self.session.as_ref().is_some_and(|session| session.id == theirs.session)
        {
            // The same hello again: its answer was lost.
            return self.say_hello(theirs.session, theirs.pacing, SEND_WAIT);
        }
        self.over("another harness said hello");
        let ours = self.hello(theirs.session, theirs.pacing);
        self.say_hello(theirs.session, theirs.pacing, SEND_WAIT)?;
        if let Err(refusal) = agree(&ours, theirs) {
            (self.notice)(&Notice::Refused(refusal.to_string()));
            let bye = refusal.bye();
            return self.wire.send(&Message::Bye(bye), SEND_WAIT).map(|_| ());
        }
        if let Err(reason) = self.steps.restart(None) {
            (self.notice)(&Notice::Refused(reason.clone()));
            return self.say_bye(Reason::FAILED, &reason);
        }
        self.wire.hold_peer(true);
        self.session = Some(Session {
            id: theirs.session,
            requests: Requests::new(theirs.pacing),
            their_silence: Duration::from_millis(theirs.limits.silence_ms.into()),
            counts_before: self.wire.counts(),
            answer: Answer::default(),
            revision: None,
            late: 0,
            condition: EndCondition::Ready,
            status_sent: Instant::now(),
        });
        (self.notice)(&Notice::Began {
            name: theirs.name,
            firmware: theirs.firmware,
            pacing: theirs.pacing,
        });
        Ok(())
    }

    fn decide(&mut self, decide: impl FnOnce(&mut Requests) -> RequestDecision) -> RequestDecision {
        self.session
            .as_mut()
            .map_or(RequestDecision::Nothing, |session| decide(&mut session.requests))
    }

    /// Acts on the verdict about a request: `make` computes its answer, which is remembered.
    fn follow(
        &mut self,
        verdict: RequestDecision,
        step: StepNumber,
        make: impl FnOnce(&mut Self, Option<Aiding>) -> Result<Answer, String>,
    ) -> Result<(), PortError> {
        match verdict {
            RequestDecision::Nothing => Ok(()),
            RequestDecision::Again => self.answer(),
            RequestDecision::Do(aiding) => match make(self, aiding) {
                Ok(answer) => {
                    if let Some(session) = &mut self.session {
                        debug_assert_eq!(session.requests.last(), step);
                        session.answer = answer;
                    }
                    self.answer()
                }
                Err(reason) => self.leave(Reason::FAILED, &reason),
            },
        }
    }

    fn step(
        &mut self,
        sample: &Sample,
        aiding: Option<&Aiding>,
        arrived: Instant,
    ) -> Result<Answer, String> {
        self.steps.step(sample, aiding, &mut self.output);
        let took = arrived.elapsed();
        let computing_ns = u32::try_from(took.as_nanos()).unwrap_or(u32::MAX).max(1);
        let late = took > Duration::from_nanos(self.facts.sample_period_ns);
        if let Some(session) = &mut self.session {
            session.late = session.late.saturating_add(late.into());
            session.condition = EndCondition::Stepping;
        }
        Ok(self.output_answer(computing_ns))
    }

    fn end(&mut self, _: StepNumber) -> Result<Answer, String> {
        self.output = self.steps.end();
        if let Some(session) = &mut self.session {
            session.condition = EndCondition::Ended;
        }
        Ok(self.output_answer(0))
    }

    fn restart(&mut self, step: StepNumber, offset: Option<&Parameters>) -> Result<Answer, String> {
        self.steps.restart(offset)?;
        if let Some(session) = &mut self.session {
            session.revision = None;
            session.condition = EndCondition::Ready;
        }
        Ok(Answer { ready: Some(Ready { step }), ..Answer::default() })
    }

    /// Answer with the present output, and with the parameters if their revision changed.
    fn output_answer(&mut self, computing_ns: u32) -> Answer {
        let Some(session) = &mut self.session else { return Answer::default() };
        let step = session.requests.last();
        let revision = self.output.parameters_revision;
        let parameters_follow = session.revision != Some(revision);
        session.revision = Some(revision);
        let output = OutputMessage { step, parameters_follow, output: self.output, computing_ns };
        let segments = parameters_follow.then(|| {
            let (parameters, sigma) = self.steps.parameters();
            ParametersSegment::all(step, revision, &parameters, &sigma)
        });
        Answer { output: Some(output), ready: None, segments }
    }

    /// Sends the remembered answer.
    fn answer(&mut self) -> Result<(), PortError> {
        let Some(session) = &self.session else { return Ok(()) };
        let answer = session.answer;
        if let Some(output) = answer.output {
            self.wire.send(&Message::Output(output), SEND_WAIT)?;
        }
        if let Some(ready) = answer.ready {
            self.wire.send(&Message::Ready(ready), SEND_WAIT)?;
        }
        for segment in answer.segments.iter().flatten() {
            self.wire.send(&Message::Parameters(*segment), SEND_WAIT)?;
        }
        Ok(())
    }

    /// Does what is due beside requests: sends status and heartbeat, and ends the session of a silent
    /// harness.
    fn look_after(&mut self) -> Result<(), PortError> {
        let unsealed = self.wire.unsealed();
        let Some(session) = &mut self.session else {
            // The first of a harness that has the secret is one too.
            if unsealed >= self.unsealed_told + UNSEALED_TOLD {
                self.unsealed_told = unsealed;
                (self.notice)(&Notice::Refused(format!(
                    "{unsealed} datagrams without the seal of the secret came: do both ends have the same one?"
                )));
            }
            return Ok(());
        };
        self.unsealed_told = unsealed;
        let silence = Duration::from_millis(self.facts.limits.silence_ms.into());
        if !silence.is_zero() && self.wire.waited.silence() >= silence {
            let text = format!("nothing heard for {:.1} s", silence.as_secs_f64());
            return self.leave(Reason::SILENCE, &text);
        }
        if session.status_sent.elapsed() >= STATUS_EVERY {
            session.status_sent = Instant::now();
            let status = self.status();
            self.wire.send(&Message::Status(status), Duration::ZERO)?;
        } else if !session.their_silence.is_zero() && self.wire.quiet() >= session.their_silence / 4
        {
            let heartbeat = Heartbeat {
                step: session.requests.last(),
                condition: session.condition,
                queued: 0,
                clock: self.wire.now(),
            };
            self.wire.send(&Message::Heartbeat(heartbeat), Duration::ZERO)?;
        }
        Ok(())
    }

    fn status(&self) -> DeviceStatus {
        let Some(session) = &self.session else { return DeviceStatus::default() };
        let of_wire = self.wire.status(&session.counts_before);
        let of_steps = session.requests.status();
        DeviceStatus {
            step: of_steps.step,
            steps: of_steps.steps,
            repeated: of_steps.repeated,
            skipped: of_steps.skipped,
            aiding_missing: of_steps.aiding_missing,
            late: session.late,
            ..of_wire
        }
    }

    /// Ends the session from this end, with a last status and a bye.
    fn leave(&mut self, reason: Reason, text: &str) -> Result<(), PortError> {
        if self.session.is_some() {
            let status = self.status();
            self.wire.send(&Message::Status(status), Duration::ZERO)?;
            self.say_bye(reason, text)?;
            self.over(text);
        }
        Ok(())
    }

    /// Ends the session and reports it.
    fn over(&mut self, why: &str) {
        let status = self.status();
        if self.session.take().is_some() {
            self.wire.hold_peer(false);
            (self.notice)(&Notice::Over { why: why.to_owned(), status });
        }
    }
}

/// Serves over the port named by a URI until stopped. A port that goes away is opened again when it is
/// back, and the session continues; standard input doesn't come back.
///
/// # Errors
/// If the port can't be opened the first time.
pub fn serve(
    uri: &Uri,
    facts: Facts,
    steps: &mut dyn Steps,
    notice: &mut dyn FnMut(&Notice),
    stop: &AtomicBool,
) -> Result<(), PortError> {
    let opened = port::open(uri, EndRole::Device)?;
    notice(&Notice::Listening(port::announcement(uri, &opened)));
    let mut device =
        Device::new(Wire::new(uri.to_string(), opened, EndRole::Device), facts, steps, notice)?;
    while let Err(error) = device.serve(stop) {
        (device.notice)(&Notice::PortGone(error.to_string()));
        if *uri == Uri::Stdio {
            // The harness that started this program is gone, and no other comes.
            device.over("standard input has ended");
            return Ok(());
        }
        while device.wire.reopen().is_err() {
            if stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            device.look_for_silence();
            let begun = Instant::now();
            std::thread::sleep(REOPEN_EVERY);
            device.wire.waited.add(begun, REOPEN_EVERY);
        }
        (device.notice)(&Notice::Listening(device.wire.reached_at()));
    }
    Ok(())
}

/// Interval between two attempts to open a port that went away.
const REOPEN_EVERY: Duration = Duration::from_millis(100);

impl Device<'_> {
    /// Gives up a harness that is silent for too long while the port is away.
    fn look_for_silence(&mut self) {
        let silence = Duration::from_millis(self.facts.limits.silence_ms.into());
        if !silence.is_zero() && self.wire.waited.silence() >= silence {
            self.over("the port was away for too long");
        }
    }
}
