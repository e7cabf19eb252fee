//! The Calibrator on a CAN bus, as an importer drives it: the frames of the wire protocol in the
//! operations of FMI-LS-BUS, and the outputs of a core in this process, bit for bit.
#![allow(unsafe_code, reason = "C functions are called")]

mod node;

use node::{Node, frame_of, frames, frames_of, operation, operations, slot, transmit};
use octant_calibration::Core;
use octant_fmi::fmi3::{DISCARD, ERROR, OK};
use octant_fmu::c::fmi3::*;
use octant_fmu::values::CellValues;
use octant_fmu::{calibrator, plant};
use octant_plant::Plant;
use octant_sample::{Aiding, Output, Parameters, Sample};
use octant_wire::can::{BusFrame, CanVersion, Reassembler, ReassemblyEvent};
use octant_wire::message::{
    AidingMessage, End, EndCondition, EndLimits, Hello, ParametersSegment, Restart, SampleMessage,
    StepPacing, TimeRequest,
};
use octant_wire::{EndRole, Message, StepNumber};
use std::ptr::null;

const PERIOD_S: f64 = 0.005;

/// The harness's end: what it has put together of the frames that came.
struct Harness {
    format: CanVersion,
    reassembler: Reassembler,
}

impl Harness {
    fn new(format: CanVersion) -> Self {
        Self { format, reassembler: Reassembler::new(&[EndRole::Device], format) }
    }

    fn hear(&mut self, bytes: &[u8]) -> Vec<Message> {
        frames_of(bytes).iter().filter_map(|frame| self.hear_frame(frame)).collect()
    }

    fn hear_frame(&mut self, frame: &BusFrame) -> Option<Message> {
        match self.reassembler.receive(frame) {
            Some(ReassemblyEvent::Received { message, .. }) => Some(message),
            Some(ReassemblyEvent::Lost(lost)) => panic!("{lost:?}"),
            None => None,
        }
    }

    fn hello(&self, session: u32, pacing: StepPacing) -> Vec<u8> {
        let limits = EndLimits { silence_ms: 2000, ..EndLimits::default() };
        let hello =
            Hello { session, pacing, limits, sample_period_ns: 5_000_000, ..Hello::default() };
        frames(&Message::Hello(hello), self.format)
    }

    fn sample(&self, step: StepNumber, sample: &Sample, aiding: Option<&Aiding>) -> Vec<u8> {
        let mut bytes = Vec::new();
        if let Some(aiding) = aiding {
            let aiding = AidingMessage { step, aiding: *aiding };
            bytes = frames(&Message::Aiding(aiding), self.format);
        }
        let message = SampleMessage { step, aided: aiding.is_some(), sample: *sample };
        bytes.extend(frames(&Message::Sample(message), self.format));
        bytes
    }
}

/// A core in this process with what it is calibrated against: the start values of both models.
struct InProcess {
    core: Core,
    plant: Plant,
    sample: Sample,
    aiding: Option<Aiding>,
    output: Output,
    revision: Option<u32>,
}

impl InProcess {
    fn new(offset: Option<&Parameters>) -> Self {
        let mut config = calibrator::config(&CellValues::new(&calibrator::table::MODEL)).unwrap();
        if let Some(offset) = offset {
            let (a, b) = (config.initial_parameters.to_array(), offset.to_array());
            config.initial_parameters =
                Parameters::from_array(&std::array::from_fn(|i| a[i] + b[i]));
        }
        let core = Core::new(&config).unwrap();
        let plant =
            Plant::new(&plant::config(&CellValues::new(&plant::table::MODEL)).unwrap()).unwrap();
        Self {
            output: core.latest(),
            core,
            plant,
            sample: Sample::default(),
            aiding: None,
            revision: None,
        }
    }

    fn next_sample(&mut self) {
        self.plant.command(&self.output.gimbal_command);
        self.plant.sample_into(&mut self.sample, &mut self.aiding);
    }

    /// Answer of the device to the sample.
    fn answer(&mut self, step: StepNumber) -> Vec<Message> {
        self.core.step_into(&self.sample, self.aiding.as_ref(), &mut self.output);
        self.expected(step)
    }

    fn expected(&mut self, step: StepNumber) -> Vec<Message> {
        let revision = self.output.parameters_revision;
        let follow = self.revision.replace(revision) != Some(revision);
        let output = octant_wire::message::OutputMessage {
            step,
            parameters_follow: follow,
            output: self.output,
            computing_ns: 0,
        };
        let mut messages = vec![Message::Output(output)];
        if follow {
            let segments =
                ParametersSegment::all(step, revision, self.core.parameters(), self.core.sigma());
            messages.extend(segments.map(Message::Parameters));
        }
        messages
    }
}

fn same(found: &[Message], expected: &[Message]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!(found.same_bits(expected), "{found:?}\nis expected to be\n{expected:?}");
    }
}

/// Only what answers steps: status and heartbeats come by time.
fn answers(messages: Vec<Message>) -> Vec<Message> {
    let by_time = |message: &Message| matches!(message, Message::Status(_) | Message::Heartbeat(_));
    messages.into_iter().filter(|message| !by_time(message)).collect()
}

#[test]
fn at_power_on_it_says_how_it_is_set_up_and_who_it_is() {
    for (settings, format) in [(&[][..], CanVersion::Classic), (&["can.fd"][..], CanVersion::Fd)] {
        let mut node = Node::new(settings);
        assert_eq!(node.interval(), (0.0, 1), "it was asked before");
        let bytes = node.all_sent();
        let codes: Vec<u32> = operations(&bytes).iter().map(|(code, _)| *code).collect();
        let settings = if format == CanVersion::Fd { 3 } else { 2 };
        assert_eq!(codes[..settings], vec![0x40; settings]);
        assert_eq!(codes[settings], 0x41);
        let [(_, rate), ..] = &operations(&bytes)[..] else { panic!() };
        assert_eq!(rate[..], [&[1][..], &500_000_u32.to_le_bytes()].concat());
        let messages = Harness::new(format).hear(&bytes);
        assert!(matches!(&messages[..], [Message::Hello(hello)] if hello.session == 0));
        assert_eq!(node.interval().1, 0, "nothing more is known");
        assert_eq!(node.item("can.node_state"), 1);
    }
}

/// 70 s from power on: the alignment, and ten measurements. Restarted with other parameters, moved to
/// another instance in the middle of a message, and concluded.
fn lock_step(settings: &[&str], format: CanVersion) {
    let offset = Parameters::from_array(&std::array::from_fn(|i| 1e-9 * i as f64));
    let mut node = Node::new(settings);
    let mut harness = Harness::new(format);
    harness.hear(&node.all_sent());
    node.receive(&harness.hello(77, StepPacing::LockStep));
    let messages = harness.hear(&node.all_sent());
    assert!(matches!(&messages[..], [Message::Hello(hello)] if hello.session == 77));

    let mut step = StepNumber::default();
    let mut own = InProcess::new(None);
    for k in 1..=14_300_u32 {
        step = step.next();
        if k == 300 {
            let restart = Restart { step, offset: Some(offset) };
            node.receive(&frames(&Message::Restart(restart), format));
            let messages = answers(harness.hear(&node.all_sent()));
            assert!(matches!(&messages[..], [Message::Ready(ready)] if ready.step == step));
            own = InProcess::new(Some(&offset));
            step = step.next();
        }
        own.next_sample();
        let request = harness.sample(step, &own.sample, own.aiding.as_ref());
        if k % 5000 == 4321 {
            // Half of a message has come.
            let half: usize = operations(&request)[..operations(&request).len() / 2]
                .iter()
                .map(|(_, arguments)| arguments.len() + 8)
                .sum();
            node.receive(&request[..half]);
            node = node.moved();
            node.receive(&request[half..]);
        } else {
            node.receive(&request);
        }
        let expected = own.answer(step);
        let found = answers(harness.hear(&node.all_sent()));
        same(&found, &expected);
        if k % 1000 == 1 {
            // Nothing came of the answer: it is asked for again.
            node.receive(&request);
            same(&answers(harness.hear(&node.all_sent())), &expected);
        }
        node.step_to(f64::from(k) * PERIOD_S);
    }
    assert!(own.output.parameters_revision > 0, "nothing was measured");
    let latitude = node.reals::<1>("navigation.latitude")[0];
    assert_eq!(latitude.to_bits(), own.output.navigation.latitude_rad.to_bits());
    assert_eq!(node.reals::<3>("sigma.gyro_bias"), own.core.sigma()[..3]);
    assert_eq!(node.count("answer.sequence"), own.output.sequence);

    step = step.next();
    node.receive(&frames(&Message::End(End { step }), format));
    own.output = own.core.end_of_stream();
    let expected = own.expected(step);
    same(&answers(harness.hear(&node.all_sent())), &expected);
    assert_eq!(node.count("can.lost"), 0);
    // SAFETY: a handle.
    unsafe { assert_eq!(fmi3Terminate(node.handle), OK) };
}

#[test]
fn outputs_on_classic_can_are_those_of_the_core() {
    lock_step(&[], CanVersion::Classic);
}

#[test]
fn outputs_on_can_fd_are_those_of_the_core() {
    lock_step(&["can.fd"], CanVersion::Fd);
}

/// A bus that confirms, and now and then lets a frame lose or destroys it. What becomes of the frame
/// that is on it is told when the frame would have ended.
struct Bus {
    random: u64,
    lost: u32,
    destroyed: u32,
}

impl Bus {
    fn draw(&mut self) -> u64 {
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        self.random >> 33
    }

    /// Carries everything that the node wants to send, until it is still.
    fn carry(&mut self, node: &mut Node, harness: &mut Harness) -> Vec<Message> {
        let mut messages = Vec::new();
        let mut bytes = node.all_sent();
        loop {
            let sent: Vec<_> = operations(&bytes);
            let mut on_bus = sent.iter().filter_map(|(code, at)| Some((at, frame_of(*code, at)?)));
            let Some((_, frame)) = on_bus.next() else { return messages };
            assert!(on_bus.next().is_none(), "one frame at a time");
            node.step_to(node.time_s + 270e-6);
            let id = u32::from(frame.id()).to_le_bytes();
            node.receive(&match self.draw() % 50 {
                0 => {
                    self.lost += 1;
                    operation(0x30, &[&id])
                }
                1 => {
                    self.destroyed += 1;
                    operation(0x31, &[&id, &[1, 1, 1]])
                }
                _ => {
                    messages.extend(harness.hear_frame(&frame));
                    operation(0x20, &[&id])
                }
            });
            bytes = node.all_sent();
            if frames_of(&bytes).is_empty() {
                // It tries again after the shortest frame, 47 bits of 2 us.
                let until_s = node.time_s + 95e-6;
                bytes = node.run_to(until_s).into_iter().flat_map(|(_, bytes)| bytes).collect();
            }
        }
    }
}

#[test]
fn with_notifications_every_frame_arrives_in_the_end() {
    let mut node = Node::new(&["can.bus_notifications"]);
    let mut harness = Harness::new(CanVersion::Classic);
    let mut bus = Bus { random: 7, lost: 0, destroyed: 0 };
    let messages = bus.carry(&mut node, &mut harness);
    assert!(matches!(&messages[..], [Message::Hello(_)]));
    node.receive(&harness.hello(5, StepPacing::RealTime));
    let messages = bus.carry(&mut node, &mut harness);
    assert!(matches!(&messages[..], [Message::Hello(_)]));
    let mut own = InProcess::new(None);
    let mut step = StepNumber::default();
    for k in 0..400 {
        step = step.next();
        own.next_sample();
        node.receive(&harness.sample(step, &own.sample, own.aiding.as_ref()));
        if k % 37 == 0 {
            // With a frame on the bus.
            node = node.moved();
        }
        let expected = own.answer(step);
        same(&answers(bus.carry(&mut node, &mut harness)), &expected);
    }
    assert!(bus.lost > 50 && bus.destroyed > 50, "{} {}", bus.lost, bus.destroyed);
    assert!(harness.reassembler.counters().is_clean());
}

#[test]
fn off_the_bus_it_is_silent_until_it_has_heard_enough() {
    let mut node = Node::new(&["can.bus_notifications"]);
    node.all_sent();
    let error = operation(0x31, &[&[0; 4], &[1, 1, 1]]);
    node.receive(&error.repeat(31));
    assert_eq!((node.item("can.node_state"), node.count("can.transmit_errors")), (2, 248));
    assert_eq!(node.all_sent(), operation(0x41, &[&[2]]));
    node.receive(&error);
    assert_eq!(node.item("can.node_state"), 3);
    assert_eq!(node.all_sent(), operation(0x41, &[&[3]]));
    let harness = Harness::new(CanVersion::Classic);
    node.receive(&harness.hello(9, StepPacing::LockStep));
    assert!(node.all_sent().is_empty(), "an answer while it is off");
    // The hello was 14 frames.
    let other = transmit(&BusFrame::new(0x7F, CanVersion::Classic, &[]).unwrap());
    node.receive(&other.repeat(113));
    assert_eq!(node.item("can.node_state"), 3);
    node.receive(&other);
    assert_eq!(node.item("can.node_state"), 1);
    let bytes = node.all_sent();
    assert_eq!(bytes, operation(0x41, &[&[1]]));
    assert!(node.count("can.lost") > 0);
}

#[test]
fn what_it_does_not_rely_on_it_ignores_and_nonsense_it_quotes() {
    let mut node = Node::new(&[]);
    node.all_sent();
    let quiet = [
        operation(0x20, &[&[1, 0, 0, 0]]),
        operation(0x30, &[&[1, 0, 0, 0]]),
        operation(0x31, &[&[1, 0, 0, 0], &[1, 1, 1]]),
        operation(0x40, &[&[1, 0, 0, 0, 0]]),
        operation(0x41, &[&[3]]),
        operation(0x42, &[]),
        operation(0x01, &[&[1, 0, 7]]),
    ]
    .concat();
    node.receive(&quiet);
    node.receive(&[]);
    assert!(node.all_sent().is_empty());
    assert_eq!((node.count("can.transmit_errors"), node.item("can.node_state")), (0, 1));
    let bad = operation(0x77, &[&[1, 2, 3]]);
    node.receive(&[quiet.clone(), bad.clone(), quiet].concat());
    assert_eq!(node.all_sent(), operation(0x01, &[&[11, 0], &bad]));
    // A quotation that can't be read isn't quoted.
    node.receive(&operation(0x01, &[&[9, 0, 7]]));
    assert!(node.all_sent().is_empty());
}

#[test]
fn by_time_it_says_how_it_is() {
    let mut node = Node::new(&["can.fd"]);
    let mut harness = Harness::new(CanVersion::Fd);
    node.all_sent();
    assert!(node.run_to(1.7).is_empty(), "without a session there is nothing to say");
    node.receive(&harness.hello(1, StepPacing::LockStep));
    let mut said = node.run_to(4.0).into_iter();
    assert!((said.next().unwrap().0 - 1.7).abs() < 1e-9);
    // Silent for a quarter of two seconds: a heartbeat; a status once a second.
    let mut times = Vec::new();
    for (time_s, bytes) in said {
        for message in harness.hear(&bytes) {
            let what = match message {
                Message::Heartbeat(beat) => {
                    assert_eq!(beat.condition, EndCondition::Ready);
                    assert_eq!(beat.clock.ns, (time_s * 1e9).round() as u64);
                    'h'
                }
                Message::Status(status) => {
                    assert_eq!(status.received, 0, "nothing but the hello that began the session");
                    's'
                }
                _ => '?',
            };
            times.push(((time_s * 1000.0).round() as u32, what));
        }
    }
    assert_eq!(times, [(2200, 'h'), (2700, 's'), (3200, 'h'), (3700, 's')]);
    let request = TimeRequest { id: 3, ..TimeRequest::default() };
    node.receive(&frames(&Message::TimeRequest(request), CanVersion::Fd));
    let messages = harness.hear(&node.all_sent());
    assert!(
        matches!(&messages[..], [Message::TimeReply(r)] if r.id == 3 && r.sent.ns == 4_000_000_000)
    );
}

#[test]
fn a_harness_that_does_not_fit_is_refused() {
    let mut node = Node::new(&[]);
    let mut harness = Harness::new(CanVersion::Classic);
    harness.hear(&node.all_sent());
    let hello = Hello { session: 4, sample_period_ns: 1, ..Hello::default() };
    node.receive(&frames(&Message::Hello(hello), CanVersion::Classic));
    let messages = harness.hear(&node.all_sent());
    assert!(matches!(&messages[..], [Message::Hello(_), Message::Bye(bye)] if bye.reason.0 == 5));
    // A newer version is readable up to its number.
    let newer = BusFrame::new(0x1E0, CanVersion::Classic, &[2, 0, 0, 0, 0, 0, 0, 0]).unwrap();
    node.receive(&transmit(&newer));
    let messages = harness.hear(&node.all_sent());
    assert!(matches!(&messages[..], [Message::Bye(bye)] if bye.reason.0 == 1));
}

#[test]
fn clocks_and_their_variables_are_accessed_at_ticks_only() {
    let node = Node::new(&[]);
    let (rx, tx) = (slot("can.Rx_Clock"), slot("can.Tx_Clock"));
    let (rx_data, tx_data) = (slot("can.Rx_Data"), slot("can.Tx_Data"));
    let (byte, two) = ([7_u8], 2_u8);
    let (mut active, mut interval, mut qualifier) = (9, 0.0, 0);
    // Each ends with an instance of its own: after an error nothing can be set.
    let status = |work: &dyn Fn(*mut std::ffi::c_void) -> i32| work(Node::new(&[]).handle);
    // SAFETY: one reference, one value.
    unsafe {
        assert_eq!(status(&|i| fmi3SetBinary(i, &rx_data, 1, &1, &byte.as_ptr(), 1)), ERROR);
        assert_eq!(status(&|i| fmi3SetBinary(i, &tx_data, 1, &1, &byte.as_ptr(), 1)), ERROR);
        assert_eq!(status(&|i| fmi3SetBinary(i, &rx, 1, &1, &byte.as_ptr(), 1)), ERROR);
        assert_eq!(status(&|i| fmi3SetClock(i, &rx_data, 1, &1)), ERROR);
        assert_eq!(status(&|i| fmi3GetIntervalDecimal(i, &rx, 1, &mut 0.0, &mut 0)), ERROR);
        assert_eq!(status(&|i| fmi3GetIntervalFraction(i, &tx, 1, &mut 0, &mut 0, &mut 0)), ERROR);
        assert_eq!(status(&|i| fmi3SetIntervalDecimal(i, &tx, 1, &1.0)), ERROR);
        assert_eq!(status(&|i| fmi3GetFloat64(i, &rx_data, 1, &mut 0.0, 1)), ERROR);
        let i = node.handle;
        assert_eq!(fmi3GetClock(i, &rx, 1, &mut active), OK);
        assert_eq!(active, 0);
        assert_eq!(fmi3SetClock(i, &rx, 1, &two), DISCARD);
        assert_eq!(fmi3SetClock(i, &rx, 1, &1), OK);
        assert_eq!(fmi3GetClock(i, &rx, 1, &mut active), OK);
        assert_eq!(active, 1);
        assert_eq!(fmi3SetBinary(i, &rx_data, 1, &65_536, &byte.as_ptr(), 1), DISCARD);
        assert_eq!(fmi3SetBinary(i, &rx_data, 1, &1, &byte.as_ptr(), 1), OK);
        assert_eq!(fmi3GetIntervalDecimal(i, &tx, 1, &mut interval, &mut qualifier), OK);
        assert_eq!(fmi3SetBinary(i, &rx_data, 1, &1, &null(), 1), ERROR);
        // In step mode nothing ticks.
        let stepping = Node::new(&[]);
        assert_eq!(fmi3EnterStepMode(stepping.handle), OK);
        assert_eq!(fmi3SetClock(stepping.handle, &rx, 1, &1), ERROR);
    }
}

#[test]
fn parameters_that_contradict_each_other_are_refused() {
    let node = Node::instantiated();
    let lost = slot("can.arbitration_lost");
    // SAFETY: one reference, one value.
    unsafe {
        assert_eq!(fmi3SetInt64(node.handle, &lost, 1, &2, 1), OK);
        assert_eq!(fmi3EnterInitializationMode(node.handle, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi3ExitInitializationMode(node.handle), ERROR);
    }
}

/// Frames of a tick are sent, whether they are read or not.
#[test]
fn a_tick_without_a_look_is_a_tick() {
    let mut node = Node::new(&[]);
    // SAFETY: one reference, one value.
    unsafe { assert_eq!(fmi3SetClock(node.handle, &slot("can.Tx_Clock"), 1, &1), OK) };
    node.end_event();
    assert_eq!(node.interval().1, 0, "nothing is left to be sent");
    assert_eq!(node.count("can.waiting"), 0);
}

/// Steps of any length, and the same answers.
#[test]
fn time_goes_on_in_steps_of_any_length() {
    let mut node = Node::new(&[]);
    node.all_sent();
    let mut time_s = 0.0;
    for step_s in [1e-9, 0.1, 1.0 / 3.0, 5e-3, 3600.0, 47e-6] {
        time_s += step_s;
        node.step_to(time_s);
    }
    let (mut event, mut terminate, mut early, mut last_s) = (0, 0, 0, 0.0);
    let mut step = |node: &Node, time_s, step_s| {
        // SAFETY: a handle and places.
        unsafe {
            fmi3DoStep(
                node.handle,
                time_s,
                step_s,
                1,
                &mut event,
                &mut terminate,
                &mut early,
                &mut last_s,
            )
        }
    };
    // SAFETY: a handle.
    unsafe { assert_eq!(fmi3EnterStepMode(node.handle), OK) };
    assert_eq!(step(&node, time_s + 1e-3, 1e-3), DISCARD);
    assert_eq!(step(&node, time_s, 1e-3), OK);
    assert_eq!(step(&node, time_s + 1e-3, 0.0), ERROR);
}
