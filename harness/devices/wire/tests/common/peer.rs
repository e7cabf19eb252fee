//! A device and a harness of a few lines each, by the rules of `README.md`, as peers of the clients.

use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{
    GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters, Reference,
};
use octant_test_processes::{HANGS, Started, start};
use octant_wire::message::*;
use octant_wire::requests::{RequestDecision, Requests};
use octant_wire::serial::{DecodeEvent, SerialDecoder, SerialEncoder};
use std::collections::VecDeque;
use std::io::{Read, Write};
use std::process::{ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// A client as a child process, with its standard input and output as the line.
pub(crate) struct Peer {
    pub(crate) child: Started,
    input: Option<ChildStdin>,
    output: Receiver<Vec<u8>>,
    encoder: SerialEncoder,
    pub(crate) decoder: SerialDecoder,
    waiting: VecDeque<Message>,
    begun: Instant,
}

impl Peer {
    pub(crate) fn spawn(command: &mut Command) -> Self {
        let mut child =
            start(command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()));
        let mut stdout = child.stdout.take().expect("it is piped");
        let (sender, output) = channel();
        std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = stdout.read(&mut bytes) {
                if sender.send(bytes[..count].to_vec()).is_err() {
                    return;
                }
            }
        });
        Self {
            input: child.stdin.take(),
            child,
            output,
            encoder: SerialEncoder::new(),
            decoder: SerialDecoder::new(),
            waiting: VecDeque::new(),
            begun: Instant::now(),
        }
    }

    pub(crate) fn write(&mut self, bytes: &[u8]) {
        if let Some(input) = &mut self.input {
            // A child that is gone shows by its missing answers.
            let _ = input.write_all(bytes).and_then(|()| input.flush());
        }
    }

    pub(crate) fn send(&mut self, message: &Message) {
        let clock = ClockTime::from_ns(self.begun.elapsed().as_nanos() as u64);
        let frame = self.encoder.encode(message, clock).to_vec();
        self.write(&frame);
    }

    /// Receives the next message within a time; `None`: none arrived, or the child is gone.
    pub(crate) fn receive(&mut self, within: Duration) -> Option<Message> {
        let until = Instant::now() + within;
        loop {
            if let Some(message) = self.waiting.pop_front() {
                return Some(message);
            }
            let left = until.saturating_duration_since(Instant::now());
            match self.output.recv_timeout(left) {
                Ok(bytes) => {
                    let mut rest = &bytes[..];
                    while let Some(event) = self.decoder.next(&mut rest) {
                        if let DecodeEvent::Received(received) = event {
                            self.waiting.push_back(received.message);
                        }
                    }
                }
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return None,
            }
        }
    }

    /// Sends messages repeatedly until the answer arrives.
    pub(crate) fn ask<T>(
        &mut self,
        messages: &[Message],
        mut answer: impl FnMut(&Message) -> Option<T>,
    ) -> T {
        let begun = Instant::now();
        while begun.elapsed() < HANGS {
            for message in messages {
                self.send(message);
            }
            let until = Instant::now() + Duration::from_millis(400);
            while let Some(message) = self.receive(until.saturating_duration_since(Instant::now()))
            {
                if let Some(found) = answer(&message) {
                    return found;
                }
            }
        }
        panic!("no answer; received {:?}", self.decoder.counters());
    }

    /// Closes the line; returns the exit status and the stderr of the child.
    pub(crate) fn finish(mut self) -> (i32, String) {
        self.input = None;
        let output = self.child.output();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code().unwrap_or(-1), said)
    }
}

/// Echo that replaces a core in the clients, see "Testing an implementation".
pub(crate) struct Echo {
    revision: u32,
    announced: Option<u32>,
    offset: [f64; 30],
    last: OutputMessage,
}

impl Echo {
    pub(crate) fn new(offset: Option<Parameters>) -> Self {
        let mut last = OutputMessage::default();
        last.output.nis = f64::from_bits(0x7FF8_0000_0000_0000);
        let offset = offset.unwrap_or_default().to_array();
        Self { revision: 0, announced: None, offset, last }
    }

    pub(crate) fn sample(
        &mut self,
        message: &SampleMessage,
        aiding: Option<&AidingMessage>,
    ) -> Vec<Message> {
        let sample = &message.sample;
        let reference = match aiding.map(|message| message.aiding.reference) {
            None => [0.0; 3],
            Some(Reference::Velocity(velocity)) => velocity,
            Some(Reference::Position { latitude_rad, longitude_rad, height_m }) => {
                [latitude_rad, longitude_rad, height_m]
            }
        };
        self.revision += u32::from(aiding.is_some());
        let theta = sample.delta_theta.map(|count| f64::from(count) * DELTA_THETA_LSB_RAD);
        let aided = if aiding.is_some() { 1.0 } else { 0.0 };
        let output = Output {
            sequence: sample.sequence,
            device_time: sample.device_time,
            mode: Mode::Aligning,
            stop: 0,
            moving: false,
            gimbal_command: GimbalCommand {
                target: GimbalAngles { azimuth: sample.gimbal.azimuth, roll: sample.gimbal.roll },
            },
            navigation: Navigation {
                latitude_rad: theta[0],
                longitude_rad: theta[1],
                height_m: theta[2],
                velocity_mps: sample
                    .delta_velocity
                    .map(|count| f64::from(count) * DELTA_VELOCITY_LSB_MPS),
                q_nb: [aided, reference[0], reference[1], reference[2]],
            },
            health: Health::from_bits_retain(sample.status.bits().into()),
            nis: f64::from_bits(0x7FF8_0000_0000_0000),
            parameters_revision: self.revision,
        };
        self.last = OutputMessage { step: message.step, output, ..OutputMessage::default() };
        self.answer()
    }

    pub(crate) fn end(&mut self, step: StepNumber) -> Vec<Message> {
        self.last.step = step;
        self.last.output.mode = Mode::Done;
        self.answer()
    }

    fn answer(&mut self) -> Vec<Message> {
        let changed = self.announced != Some(self.revision);
        self.announced = Some(self.revision);
        self.last.parameters_follow = changed;
        let mut messages = vec![Message::Output(self.last)];
        if changed {
            let value = |i: usize| f64::from(self.revision) + i as f64 + self.offset[i];
            let parameters = Parameters::from_array(&std::array::from_fn(value));
            // The integer −0 is zero, not minus zero.
            let sigma = std::array::from_fn(|i| if i == 0 { 0.0 } else { -(i as f64) });
            let all = ParametersSegment::all(self.last.step, self.revision, &parameters, &sigma);
            messages.extend(all.map(Message::Parameters));
        }
        messages
    }
}

/// Hello that fits any other of these tests.
pub(crate) fn hello(role: EndRole, session: u32) -> Hello {
    Hello {
        role,
        session,
        capabilities: Capabilities::all(),
        sample_period_ns: 5_000_000,
        ..Hello::default()
    }
}

/// Answers a harness in lock-step until it says bye. With `lost`, one message of the harness in `lost`
/// is ignored, and one answer in `lost` is damaged.
pub(crate) fn serve(peer: &mut Peer, lost: Option<usize>) {
    let (mut session, mut echo, mut heard) = (0, Echo::new(None), 0);
    let mut requests = Requests::new(StepPacing::LockStep);
    let mut answer: Vec<Message> = Vec::new();
    while let Some(message) = peer.receive(HANGS) {
        heard += 1;
        if lost.is_some_and(|n| heard % n == n / 2) {
            continue;
        }
        let verdict = match &message {
            Message::Bye(_) => return,
            Message::Hello(theirs) => {
                if theirs.session != session {
                    session = theirs.session;
                    (requests, echo) = (Requests::new(StepPacing::LockStep), Echo::new(None));
                }
                let ours = hello(EndRole::Device, session);
                agree(&ours, theirs).expect("the client is a harness");
                peer.send(&Message::Hello(ours));
                continue;
            }
            Message::Aiding(aiding) => {
                requests.aiding(aiding);
                continue;
            }
            Message::Sample(sample) => requests.sample(sample),
            Message::Restart(Restart { step, .. }) | Message::End(End { step }) => {
                requests.other(*step)
            }
            _ => continue,
        };
        match (verdict, &message) {
            (RequestDecision::Do(aiding), Message::Sample(sample)) => {
                let aiding = aiding.map(|aiding| AidingMessage { step: sample.step, aiding });
                answer = echo.sample(sample, aiding.as_ref());
            }
            (RequestDecision::Do(_), Message::Restart(restart)) => {
                echo = Echo::new(restart.offset);
                answer = vec![Message::Ready(Ready { step: restart.step })];
            }
            (RequestDecision::Do(_), _) => answer = echo.end(requests.last()),
            (RequestDecision::Again, _) => {}
            (RequestDecision::Nothing, _) => continue,
        }
        for (i, message) in answer.iter().enumerate() {
            if lost.is_some_and(|n| (heard + i) % n == 0) {
                // A damaged frame replaces the answer.
                peer.write(&[0, 3, 1, 0, 7]);
            } else {
                peer.send(message);
            }
        }
    }
    panic!("the harness went without a bye");
}
