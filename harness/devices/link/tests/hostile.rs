//! A device that receives arbitrary bytes and messages: it continues to serve.

use crate::common::{Echo, PERIOD_NS, facts, sample};
use octant_link::device::{Device, Notice};
use octant_link::port::{Bytes, Port};
use octant_link::{PortError, Wire};
use octant_wire::message::*;
use octant_wire::serial::{DecodeEvent, SerialDecoder, SerialEncoder};
use proptest::prelude::*;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// A line in memory that delivers these pieces, and then stops the device.
#[derive(Debug)]
struct Line {
    pieces: VecDeque<Vec<u8>>,
    sent: Arc<Mutex<Vec<u8>>>,
    stop: Arc<AtomicBool>,
    datagrams: bool,
}

impl Bytes for Line {
    fn send(&mut self, bytes: &[u8], _: Duration) -> Result<bool, PortError> {
        self.sent.lock().unwrap().extend_from_slice(bytes);
        Ok(true)
    }

    fn receive(&mut self, buffer: &mut [u8], _: Duration) -> Result<usize, PortError> {
        let Some(piece) = self.pieces.pop_front() else {
            self.stop.store(true, Ordering::Relaxed);
            return Ok(0);
        };
        let count = piece.len().min(buffer.len());
        buffer[..count].copy_from_slice(&piece[..count]);
        Ok(count)
    }

    fn datagrams(&self) -> bool {
        self.datagrams
    }

    fn reached_at(&self) -> String {
        "memory".to_owned()
    }

    fn hold_peer(&mut self, _: bool) {}

    fn close(&mut self) {}

    fn reopen(&mut self) -> Result<(), PortError> {
        Ok(())
    }
}

/// Messages that a device sends in answer to these pieces, and the number of its steps.
fn serve(pieces: Vec<Vec<u8>>, datagrams: bool) -> (Vec<Message>, u64) {
    let (sent, stop) = (Arc::default(), Arc::new(AtomicBool::new(false)));
    let pieces = pieces.into_iter().filter(|piece| !piece.is_empty()).collect();
    let line = Line { pieces, sent: Arc::clone(&sent), stop: Arc::clone(&stop), datagrams };
    let wire = Wire::new("memory", Port::Bytes(Box::new(line)), EndRole::Device);
    let mut echo = Echo::default();
    let mut notice = |_: &Notice| {};
    let mut device = Device::new(wire, facts(), &mut echo, &mut notice).unwrap();
    device.serve(&stop).unwrap();
    drop(device);
    let bytes = sent.lock().unwrap().clone();
    let (mut decoder, mut rest, mut said) = (SerialDecoder::new(), bytes.as_slice(), Vec::new());
    while let Some(event) = decoder.next(&mut rest) {
        let DecodeEvent::Received(received) = event else {
            panic!("a device sends messages alone")
        };
        said.push(received.message);
    }
    (said, echo.steps)
}

fn hello(session: u32) -> Message {
    Message::Hello(Hello { session, sample_period_ns: PERIOD_NS, ..Hello::default() })
}

fn frames(messages: &[Message]) -> Vec<Vec<u8>> {
    let mut encoder = SerialEncoder::new();
    messages.iter().map(|m| encoder.encode(m, ClockTime::default()).to_vec()).collect()
}

/// Messages that a harness may send, sensible or not.
fn message() -> impl Strategy<Value = Message> {
    let step = || (0..6u16).prop_map(StepNumber::new);
    prop_oneof![
        (0..4u32).prop_map(hello),
        (step(), any::<bool>(), 1..9u64).prop_map(|(step, aided, k)| {
            Message::Sample(SampleMessage { step, aided, sample: sample(k).0 })
        }),
        step().prop_map(|step| {
            Message::Aiding(AidingMessage { step, aiding: sample(10).1.unwrap() })
        }),
        step().prop_map(|step| Message::Restart(Restart { step, offset: None })),
        step().prop_map(|step| Message::End(End { step })),
        step().prop_map(|step| Message::Ready(Ready { step })),
        any::<u16>().prop_map(|id| Message::TimeRequest(TimeRequest { id, ..Default::default() })),
        any::<u8>()
            .prop_map(|reason| Message::Bye(Bye { reason: Reason(reason), ..Bye::default() })),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_came_before_a_harness_is_served(
        garbage in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..700), 0..8),
        messages in proptest::collection::vec(message(), 0..20),
        datagrams: bool,
    ) {
        let mut pieces = Vec::new();
        let mut noise = garbage.iter().cycle();
        for frame in frames(&messages) {
            pieces.extend(noise.next().cloned());
            pieces.push(frame);
        }
        let session = 77;
        let (one, _) = sample(1);
        let step = StepNumber::new(1);
        let asked = [hello(session), Message::Sample(SampleMessage { step, aided: false, sample: one })];
        pieces.extend(frames(&asked));
        let (said, _) = serve(pieces, datagrams);
        let greeted = |m: &Message| matches!(m, Message::Hello(theirs) if theirs.session == session);
        let at = said.iter().position(greeted).expect("the last hello is answered");
        let answers = said[at..].iter().filter(|m| matches!(m, Message::Output(_))).count();
        prop_assert_eq!(answers, 1);
    }

    #[test]
    fn no_step_is_done_twice(order in proptest::collection::vec(1..8u64, 1..60)) {
        // Requests in any order, repeatedly: each step is done once, and in its turn.
        let requests: Vec<Message> = order
            .iter()
            .map(|k| {
                let step = StepNumber::new(*k as u16);
                Message::Sample(SampleMessage { step, aided: false, sample: sample(*k).0 })
            })
            .collect();
        let all: Vec<Message> = std::iter::once(hello(5)).chain(requests).collect();
        let (said, steps) = serve(frames(&all), false);
        let mut last = 0;
        for k in &order {
            last += u64::from(*k == last + 1);
        }
        prop_assert_eq!(steps, last);
        for message in &said {
            if let Message::Output(answer) = message {
                prop_assert_eq!(u64::from(answer.step.number()), answer.output.sequence);
            }
        }
    }
}
