//! Lock-step over a line that loses, doubles and reorders messages gives the result of a line without
//! faults; real time continues with the messages that arrive.

use octant_sample::{Aiding, DeviceTime, Reference, Sample};
use octant_wire::message::{
    AidingMessage, ClockTime, Message, Offset, SampleMessage, StepNumber, StepPacing, TimeReply,
};
use octant_wire::requests::{RequestDecision, Requests};
use proptest::prelude::*;
use std::collections::VecDeque;

fn aiding(step: StepNumber) -> AidingMessage {
    let reference = Reference::Velocity([f64::from(step.number()), 0.0, 0.0]);
    let device_time = DeviceTime { ns: u64::from(step.number()) };
    AidingMessage { step, aiding: Aiding { device_time, reference } }
}

fn sample(step: StepNumber, aided: bool) -> SampleMessage {
    let sequence = u64::from(step.number());
    SampleMessage { step, aided, sample: Sample { sequence, ..Sample::default() } }
}

/// Fate of a message on a line.
#[derive(Clone, Copy, Debug)]
enum Fate {
    Arrives,
    Lost,
    Doubled,
    /// Arrives after the next message.
    Late,
}

/// Random fates, half of them good; a regular pattern could always hit the same message.
fn fates(seed: u64) -> impl Iterator<Item = Fate> {
    let mut state = seed | 1;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        match state >> 40 & 7 {
            0..4 => Fate::Arrives,
            4 | 5 => Fate::Lost,
            6 => Fate::Doubled,
            _ => Fate::Late,
        }
    })
}

/// A line with messages on it.
struct Line<T> {
    late: Vec<T>,
    there: VecDeque<T>,
}

impl<T: Copy> Line<T> {
    fn send(&mut self, message: T, fate: Fate) {
        match fate {
            Fate::Lost => {}
            Fate::Late => {
                self.late.push(message);
                return;
            }
            Fate::Doubled => self.there.extend([message, message]),
            Fate::Arrives => self.there.push_back(message),
        }
        self.there.extend(self.late.drain(..));
    }
}

proptest! {
    #[test]
    fn in_lock_step_nothing_is_lost_and_nothing_is_done_twice(
        first in prop_oneof![Just(0u16), Just(0x7FF0), any::<u16>()],
        every in 1..5u16,
        seeds: (u64, u64),
    ) {
        let mut fates = (fates(seeds.0), fates(seeds.1));
        let mut to_device = Line { late: Vec::new(), there: VecDeque::new() };
        let mut to_harness = Line { late: Vec::new(), there: VecDeque::new() };
        // Earlier steps are done first, so that the session begins in the middle of the numbers.
        let mut requests = Requests::new(StepPacing::LockStep);
        for number in 1..first & 0x7FFF {
            prop_assert_eq!(requests.other(StepNumber::new(number)), RequestDecision::Do(None));
        }
        let before = requests.status().steps;
        let mut done: Vec<(StepNumber, Option<Aiding>)> = Vec::new();
        let mut step = requests.last();
        let mut expected = Vec::new();
        for k in 0..30u16 {
            step = step.next();
            let aided = k % every == 0;
            expected.push((step, aided.then(|| aiding(step).aiding)));
            // The request is repeated until it is answered.
            let mut answered = false;
            for attempt in 0.. {
                prop_assert!(attempt < 2000, "step {step:?} is never answered");
                if aided {
                    to_device.send(Message::Aiding(aiding(step)), fates.0.next().unwrap());
                }
                to_device.send(Message::Sample(sample(step, aided)), fates.0.next().unwrap());
                while let Some(message) = to_device.there.pop_front() {
                    match message {
                        Message::Aiding(message) => requests.aiding(&message),
                        Message::Sample(message) => match requests.sample(&message) {
                            RequestDecision::Do(aiding) => {
                                done.push((message.step, aiding));
                                to_harness.send(message.step, fates.1.next().unwrap());
                            }
                            RequestDecision::Again => to_harness.send(message.step, fates.1.next().unwrap()),
                            RequestDecision::Nothing => {}
                        },
                        _ => unreachable!(),
                    }
                }
                while let Some(answer) = to_harness.there.pop_front() {
                    answered |= answer == step;
                }
                if answered {
                    break;
                }
            }
        }
        prop_assert_eq!(&done, &expected);
        let status = requests.status();
        prop_assert_eq!((status.steps - before, status.skipped), (30, 0));
    }

    #[test]
    fn in_real_time_steps_only_go_forward_and_every_gap_is_counted(
        seed: u64,
        every in 1..5u16,
    ) {
        let mut requests = Requests::new(StepPacing::RealTime);
        let mut line = Line { late: Vec::new(), there: VecDeque::new() };
        let mut fates = fates(seed);
        let (mut done, mut last) = (0, 0);
        for k in 1..=60u16 {
            let step = StepNumber::new(k);
            let aided = k % every == 0;
            if aided {
                line.send(Message::Aiding(aiding(step)), fates.next().unwrap());
            }
            line.send(Message::Sample(sample(step, aided)), fates.next().unwrap());
            while let Some(message) = line.there.pop_front() {
                match message {
                    Message::Aiding(message) => requests.aiding(&message),
                    Message::Sample(message) => match requests.sample(&message) {
                        RequestDecision::Do(found) => {
                            prop_assert!(message.step.number() > last);
                            last = message.step.number();
                            done += 1;
                            prop_assert!(found.is_none_or(|found| found == aiding(message.step).aiding));
                            prop_assert!(message.aided || found.is_none());
                        }
                        RequestDecision::Nothing => {}
                        RequestDecision::Again => prop_assert!(false, "nothing is asked for again"),
                    },
                    _ => unreachable!(),
                }
            }
        }
        let status = requests.status();
        prop_assert_eq!(status.steps, done);
        prop_assert_eq!(status.steps + status.skipped, u32::from(last));
    }
}

#[test]
fn a_clock_that_is_ahead_is_found_within_the_error() {
    // Clock ahead by 1000; delays of 30 there, 50 back, and 7 between.
    let reply = TimeReply {
        id: 1,
        harness_sent: ClockTime::from_ns(500),
        received: ClockTime::from_ns(1530),
        sent: ClockTime::from_ns(1537),
    };
    let offset = reply.offset(ClockTime::from_ns(587));
    assert_eq!(offset, Offset { ahead_ns: 990, error_ns: 40 });
    assert!((offset.ahead_ns - 1000).abs() <= offset.error_ns);
    // The largest possible offset between two clocks.
    let far = TimeReply { received: ClockTime::from_ns(u64::MAX), ..reply };
    assert!(far.offset(ClockTime::from_ns(0)).ahead_ns > i128::from(u64::MAX) / 2);
}
