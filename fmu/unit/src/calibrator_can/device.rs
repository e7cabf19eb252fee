//! Device end of a session, on messages; `README.md` of octant-wire defines the answers.

use super::controller::Controller;
use octant_calibration::state_machine::CoreConfigError;
use octant_calibration::{Core, CoreConfig};
use octant_sample::{Mode, Output, Parameters};
use octant_state::{State, StateError, StateReader, Writer, check_count};
use octant_wire::can::{self, CanTraffic};
use octant_wire::message::{
    Agreement, Bye, Capabilities, ClockTime, DeviceStatus, End, EndCondition, EndLimits, Heartbeat,
    Hello, OutputMessage, ParametersSegment, Ready, Reason, Restart, SampleMessage, StepPacing,
    TimeReply, TimeRequest, agree,
};
use octant_wire::requests::{RequestDecision, Requests};
use octant_wire::{EndRole, Message, MessageKind, StepNumber, Text};

/// Largest number of samples accepted ahead of the first answer: each is answered at once, and the
/// bound is for answers that wait for the bus.
const WINDOW: u16 = 64;
/// Time between two status messages, ns.
const STATUS_NS: u64 = 1_000_000_000;

/// Capabilities: all of them.
const CAPABILITIES: Capabilities = Capabilities::all();

/// Last answer, to be repeated on request.
#[derive(Clone, Debug, Default)]
enum Answer {
    #[default]
    None,
    Output(OutputMessage, Option<Box<[ParametersSegment; 6]>>),
    Ready(StepNumber),
}

/// Counts of the bus in a status: received, lost, damaged, missing, out of order, unreadable.
type Counts = [u64; 6];

fn counts(counters: &CanTraffic) -> Counts {
    let CanTraffic { messages, orphaned, missing, duplicated, disordered, unreadable, .. } =
        *counters;
    let out_of_order = duplicated.saturating_add(disordered);
    [messages, orphaned, counters.damaged(), missing, out_of_order, unreadable]
}

/// A session.
#[derive(Clone, Debug)]
struct Session {
    number: u32,
    requests: Requests,
    /// Counts of the bus at the start of the session.
    before: Counts,
    /// Longest time without a message of the device, ns; 0: unlimited.
    beat_ns: u64,
    condition: EndCondition,
}

/// The device.
#[derive(Clone, Debug)]
pub(super) struct Device {
    config: Box<CoreConfig>,
    core: Core,
    output: Output,
    /// Revision of the parameters that were sent last.
    revision: Option<u32>,
    session: Option<Session>,
    answer: Answer,
    status_due_ns: u64,
    beat_due_ns: u64,
    mode: Mode,
    remark: Option<String>,
}

/// True if the core is another one than before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Changed(pub bool);

impl Device {
    pub(super) fn new(config: CoreConfig) -> Result<Self, CoreConfigError> {
        let core = Core::new(&config)?;
        let output = core.latest();
        Ok(Self {
            config: Box::new(config),
            mode: output.mode,
            output,
            core,
            revision: None,
            session: None,
            answer: Answer::None,
            status_due_ns: 0,
            beat_due_ns: 0,
            remark: None,
        })
    }

    /// Changes the core, and the configuration of those that a restart makes.
    pub(super) fn tune(&mut self, config: CoreConfig) -> Result<(), CoreConfigError> {
        self.core.tune(&config)?;
        *self.config = config;
        Ok(())
    }

    pub(super) fn core(&self) -> &Core {
        &self.core
    }

    pub(super) fn output(&self) -> &Output {
        &self.output
    }

    pub(super) fn remark(&mut self) -> Option<String> {
        self.remark.take()
    }

    fn hello(&self, session: u32, pacing: StepPacing) -> Hello {
        Hello {
            role: EndRole::Device,
            pacing,
            session,
            capabilities: CAPABILITIES,
            sample_period_ns: self.config.sample_period_ns,
            // The device never considers the harness gone, and keeps up with any period: its
            // computation takes no time.
            limits: EndLimits { window: WINDOW, silence_ms: 0, shortest_period_ns: 0 },
            configuration: [0; 32],
            name: Text::fitting("calibrator_can"),
            firmware: Text::fitting(concat!("octant ", env!("CARGO_PKG_VERSION"))),
            ..Hello::default()
        }
    }

    /// Sends the hello of a device just switched on, which shows the restart to a harness in the
    /// middle of a session.
    pub(super) fn power_on(&mut self, to: &mut Controller) {
        let hello = self.hello(0, StepPacing::LockStep);
        self.say(&Message::Hello(hello), 0, to);
    }

    fn say(&mut self, message: &Message, now_ns: u64, to: &mut Controller) {
        // Messages that a device doesn't send have no frames.
        if let Ok(frames) = can::segments(message, EndRole::Device, to.format()) {
            frames.for_each(|frame| to.push(frame));
        }
        if let Some(session) = &self.session {
            self.beat_due_ns = now_ns.saturating_add(session.beat_ns);
        }
    }

    /// Handles a message of the harness. Returns whether the core is another one than before.
    pub(super) fn take(
        &mut self,
        message: &Message,
        now_ns: u64,
        counters: &CanTraffic,
        to: &mut Controller,
    ) -> Changed {
        match message {
            Message::Hello(hello) => return self.begin(hello, now_ns, counters, to),
            Message::Bye(_) => self.session = None,
            Message::TimeRequest(TimeRequest { id, harness_sent }) if self.session.is_some() => {
                let now = ClockTime::from_ns(now_ns);
                let reply =
                    TimeReply { id: *id, harness_sent: *harness_sent, received: now, sent: now };
                self.say(&Message::TimeReply(reply), now_ns, to);
            }
            Message::Aiding(aiding) => {
                if let Some(session) = &mut self.session {
                    session.requests.aiding(aiding);
                }
            }
            Message::Sample(sample) => return self.sample(sample, now_ns, to),
            Message::Restart(restart) => return self.restart(restart, now_ns, counters, to),
            Message::End(End { step }) => return self.end(*step, now_ns, to),
            _ => {}
        }
        Changed(false)
    }

    /// Answers a hello that only a newer version understands.
    pub(super) fn too_new(&mut self, now_ns: u64, to: &mut Controller) {
        let text = Text::fitting("version 1 is spoken here");
        self.say(&Message::Bye(Bye { reason: Reason::VERSION, text }), now_ns, to);
        self.session = None;
    }

    fn begin(
        &mut self,
        theirs: &Hello,
        now_ns: u64,
        counters: &CanTraffic,
        to: &mut Controller,
    ) -> Changed {
        // A harness draws a number other than 0.
        if theirs.role != EndRole::Harness || theirs.session == 0 {
            return Changed(false);
        }
        let ours = self.hello(theirs.session, theirs.pacing);
        self.say(&Message::Hello(ours), now_ns, to);
        let Agreement { session: number, pacing, .. } = match agree(&ours, theirs) {
            Ok(agreement) => agreement,
            Err(refusal) => {
                self.say(&Message::Bye(refusal.bye()), now_ns, to);
                self.session = None;
                self.remark = Some(format!("no session: {refusal}"));
                return Changed(false);
            }
        };
        if self.session.as_ref().is_some_and(|session| session.number == number) {
            return Changed(false);
        }
        let beat_ns = u64::from(theirs.limits.silence_ms) * 1_000_000 / 4;
        let requests = Requests::new(pacing);
        let (before, condition) = (counts(counters), EndCondition::Ready);
        self.session = Some(Session { number, requests, before, beat_ns, condition });
        self.status_due_ns = now_ns.saturating_add(STATUS_NS);
        self.beat_due_ns = now_ns.saturating_add(beat_ns);
        // The configuration has made a core before.
        Changed(self.anew(None).is_ok())
    }

    /// Makes a core as at power on, with stored parameters that differ by `offset`.
    fn anew(&mut self, offset: Option<&Parameters>) -> Result<(), CoreConfigError> {
        let mut config = CoreConfig::clone(&self.config);
        if let Some(offset) = offset {
            let (stored, offset) = (config.initial_parameters.to_array(), offset.to_array());
            config.initial_parameters =
                Parameters::from_array(&core::array::from_fn(|i| stored[i] + offset[i]));
        }
        self.core = Core::new(&config)?;
        self.output = self.core.latest();
        self.mode = self.output.mode;
        self.revision = None;
        self.answer = Answer::None;
        Ok(())
    }

    fn sample(&mut self, sample: &SampleMessage, now_ns: u64, to: &mut Controller) -> Changed {
        let Some(session) = &mut self.session else { return Changed(false) };
        let aiding = match session.requests.sample(sample) {
            RequestDecision::Do(aiding) => aiding,
            verdict => return self.without_step(verdict, now_ns, to),
        };
        session.condition = EndCondition::Stepping;
        self.core.step_into(&sample.sample, aiding.as_ref(), &mut self.output);
        self.answer_with_output(sample.step, now_ns, to)
    }

    fn end(&mut self, step: StepNumber, now_ns: u64, to: &mut Controller) -> Changed {
        let Some(session) = &mut self.session else { return Changed(false) };
        match session.requests.other(step) {
            RequestDecision::Do(_) => {}
            verdict => return self.without_step(verdict, now_ns, to),
        }
        session.condition = EndCondition::Ended;
        self.output = self.core.end_of_stream();
        self.answer_with_output(step, now_ns, to)
    }

    fn restart(
        &mut self,
        restart: &Restart,
        now_ns: u64,
        counters: &CanTraffic,
        to: &mut Controller,
    ) -> Changed {
        let Some(session) = &mut self.session else { return Changed(false) };
        match session.requests.other(restart.step) {
            RequestDecision::Do(_) => {}
            verdict => return self.without_step(verdict, now_ns, to),
        }
        session.condition = EndCondition::Ready;
        if let Err(reason) = self.anew(restart.offset.as_ref()) {
            self.say_status(now_ns, counters, to);
            let text = Text::fitting("the parameters make no core");
            self.say(&Message::Bye(Bye { reason: Reason::FAILED, text }), now_ns, to);
            self.session = None;
            self.remark = Some(format!("no restart: {reason}"));
            return Changed(false);
        }
        self.answer = Answer::Ready(restart.step);
        self.repeat(now_ns, to);
        Changed(true)
    }

    fn without_step(
        &mut self,
        verdict: RequestDecision,
        now_ns: u64,
        to: &mut Controller,
    ) -> Changed {
        if verdict == RequestDecision::Again {
            self.repeat(now_ns, to);
        }
        Changed(false)
    }

    fn answer_with_output(
        &mut self,
        step: StepNumber,
        now_ns: u64,
        to: &mut Controller,
    ) -> Changed {
        let revision = self.output.parameters_revision;
        let follow = self.revision != Some(revision);
        let parameters = follow.then(|| {
            let (parameters, sigma) = (self.core.parameters(), self.core.sigma());
            Box::new(ParametersSegment::all(step, revision, parameters, sigma))
        });
        self.revision = Some(revision);
        let message =
            OutputMessage { step, parameters_follow: follow, output: self.output, computing_ns: 0 };
        self.answer = Answer::Output(message, parameters);
        if self.output.mode != self.mode {
            self.mode = self.output.mode;
            let sequence = self.output.sequence;
            self.remark = Some(match self.core.refusal() {
                Some(refusal) if self.mode == Mode::Refused => {
                    format!("refused at sample {sequence}: {refusal}")
                }
                _ => format!("{} from sample {sequence} on", self.mode.name()),
            });
        }
        self.repeat(now_ns, to);
        Changed(true)
    }

    /// Sends the last answer again.
    fn repeat(&mut self, now_ns: u64, to: &mut Controller) {
        let answer = core::mem::take(&mut self.answer);
        match &answer {
            Answer::None => {}
            Answer::Ready(step) => self.say(&Message::Ready(Ready { step: *step }), now_ns, to),
            Answer::Output(output, parameters) => {
                self.say(&Message::Output(*output), now_ns, to);
                for segment in parameters.iter().flat_map(|segments| segments.iter()) {
                    self.say(&Message::Parameters(*segment), now_ns, to);
                }
            }
        }
        self.answer = answer;
    }

    /// Sends the counts of steps, and those of the frames, since the session began.
    fn say_status(&mut self, now_ns: u64, counters: &CanTraffic, to: &mut Controller) {
        let Some(session) = &self.session else { return };
        let (now, before) = (counts(counters), session.before);
        let since = core::array::from_fn(|i| {
            u32::try_from(now[i].saturating_sub(before[i])).unwrap_or(u32::MAX)
        });
        let [received, lost, damaged, missing, out_of_order, unreadable] = since;
        let status = DeviceStatus {
            received,
            lost,
            damaged,
            missing,
            out_of_order,
            unreadable,
            ..session.requests.status()
        };
        self.say(&Message::Status(status), now_ns, to);
    }

    /// Time of the next message that the device sends on its own, ns.
    pub(super) fn due_ns(&self) -> Option<u64> {
        let session = self.session.as_ref()?;
        Some(match session.beat_ns {
            0 => self.status_due_ns,
            _ => self.status_due_ns.min(self.beat_due_ns),
        })
    }

    /// Sends the messages due at this time.
    pub(super) fn on_time(&mut self, now_ns: u64, counters: &CanTraffic, to: &mut Controller) {
        let Some(session) = &self.session else { return };
        if self.status_due_ns <= now_ns {
            let late_ns = now_ns - self.status_due_ns;
            self.status_due_ns = now_ns.saturating_add(STATUS_NS - late_ns % STATUS_NS);
            self.say_status(now_ns, counters, to);
        } else if session.beat_ns > 0 && self.beat_due_ns <= now_ns {
            let heartbeat = Heartbeat {
                step: session.requests.last(),
                condition: session.condition,
                queued: 0,
                clock: ClockTime::from_ns(now_ns),
            };
            self.say(&Message::Heartbeat(heartbeat), now_ns, to);
        }
    }
}

/// Saves a message as its payload.
fn save_message(to: &mut Writer, name: &'static str, message: &Message) {
    to.value(name, message.payload().bytes());
}

fn load_message(
    from: &mut StateReader<'_>,
    name: &'static str,
    kind: MessageKind,
) -> Result<Message, StateError> {
    Message::read(kind, from.value(name)?)
        .map_err(|error| StateError::value(name, error.to_string()))
}

impl State for Device {
    fn save(&self, to: &mut Writer) {
        let mut core = Vec::new();
        self.core.save(&mut core);
        to.value("core", &core);
        to.value("revision", &self.revision);
        to.value("status due", &self.status_due_ns);
        to.value("beat due", &self.beat_due_ns);
        let session = self.session.as_ref();
        to.value("session", &session.map(|s| (s.number, s.beat_ns, s.condition as u8)));
        if let Some(session) = session {
            to.value("before", &session.before);
            to.part("requests", &session.requests);
        }
        match &self.answer {
            Answer::None => to.value("answer", &0_u8),
            Answer::Ready(step) => {
                to.value("answer", &1_u8);
                to.value("step", &step.number());
            }
            Answer::Output(output, parameters) => {
                to.value("answer", &2_u8);
                save_message(to, "output", &Message::Output(*output));
                to.value("parameters", &parameters.is_some());
                for segment in parameters.iter().flat_map(|segments| segments.iter()) {
                    save_message(to, "segment", &Message::Parameters(*segment));
                }
            }
        }
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        let core: Vec<u8> = from.value("core")?;
        self.core = Core::load(&core)?;
        self.output = self.core.latest();
        self.mode = self.output.mode;
        self.revision = from.value("revision")?;
        self.status_due_ns = from.value("status due")?;
        check_count("status due", self.status_due_ns)?;
        self.beat_due_ns = from.value("beat due")?;
        check_count("beat due", self.beat_due_ns)?;
        let session: Option<(u32, u64, u8)> = from.value("session")?;
        self.session = None;
        if let Some((number, beat_ns, condition)) = session {
            check_count("beat", beat_ns)?;
            let condition = EndCondition::ALL.get(usize::from(condition));
            let condition =
                *condition.ok_or_else(|| StateError::value("session", "a condition of no kind"))?;
            let before: Counts = from.value("before")?;
            let mut requests = Requests::new(StepPacing::LockStep);
            from.part("requests", &mut requests)?;
            self.session = Some(Session { number, requests, before, beat_ns, condition });
        }
        self.answer = match from.value::<u8>("answer")? {
            0 => Answer::None,
            1 => Answer::Ready(StepNumber::new(from.value("step")?)),
            2 => {
                let Message::Output(output) = load_message(from, "output", MessageKind::Output)?
                else {
                    return Err(StateError::value("output", "it is none"));
                };
                let mut parameters = None;
                if from.value("parameters")? {
                    let mut segments = Box::new([ParametersSegment::default(); 6]);
                    for segment in segments.iter_mut() {
                        if let Message::Parameters(read) =
                            load_message(from, "segment", MessageKind::Parameters)?
                        {
                            *segment = read;
                        }
                    }
                    parameters = Some(segments);
                }
                Answer::Output(output, parameters)
            }
            _ => return Err(StateError::value("answer", "0 to 2 is expected")),
        };
        Ok(())
    }
}
