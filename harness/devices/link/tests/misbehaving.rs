//! Devices that break the protocol: late, repeated, missing and wrong answers.

use crate::common::{LONG, PERIOD_NS, options, sample};
use octant_link::harness::{Harness, Patience, SessionError, SessionOptions};
use octant_link::{Uri, Wire};
use octant_sample::Output;
use octant_wire::VERSION;
use octant_wire::message::*;
use octant_wire::serial::{DecodeEvent, SerialDecoder, SerialEncoder};
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A peer on UDP that answers each message as a script decides, with messages or bytes.
struct Scripted {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    uri: Uri,
}

/// Reaction of a script to a message.
#[allow(clippy::large_enum_variant)]
enum Say {
    Message(Message),
    Bytes(Vec<u8>),
    Wait(Duration),
}

impl Scripted {
    fn new(mut script: impl FnMut(&Message) -> Vec<Say> + Send + 'static) -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_read_timeout(Some(Duration::from_millis(10))).unwrap();
        let uri = format!("udp:{}", socket.local_addr().unwrap()).parse().unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let until = Arc::clone(&stop);
        let thread = std::thread::spawn(move || {
            let (mut encoder, mut decoder) = (SerialEncoder::new(), SerialDecoder::new());
            let mut bytes = [0; 2000];
            while !until.load(Ordering::Relaxed) {
                let Ok((count, from)) = socket.recv_from(&mut bytes) else { continue };
                let mut rest = &bytes[..count];
                while let Some(event) = decoder.next(&mut rest) {
                    let DecodeEvent::Received(received) = event else { continue };
                    for say in script(&received.message) {
                        let sent = match say {
                            Say::Message(message) => {
                                socket.send_to(encoder.encode(&message, ClockTime::default()), from)
                            }
                            Say::Bytes(bytes) => socket.send_to(&bytes, from),
                            Say::Wait(time) => {
                                std::thread::sleep(time);
                                continue;
                            }
                        };
                        // The harness may be gone.
                        let _ = sent;
                    }
                }
            }
        });
        Self { stop, thread: Some(thread), uri }
    }
}

impl Drop for Scripted {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let _ = self.thread.take().unwrap().join();
    }
}

fn hello(session: u32) -> Message {
    Message::Hello(Hello {
        role: EndRole::Device,
        session,
        capabilities: Capabilities::all(),
        sample_period_ns: PERIOD_NS,
        ..Hello::default()
    })
}

fn output(step: StepNumber, sequence: u64) -> Message {
    let output = Output { sequence, ..Output::default() };
    Message::Output(OutputMessage { step, parameters_follow: false, output, computing_ns: 0 })
}

/// Answers a hello itself, and each sample as the script decides.
fn device(mut on_sample: impl FnMut(&SampleMessage) -> Vec<Say> + Send + 'static) -> Scripted {
    Scripted::new(move |message| match message {
        Message::Hello(theirs) => vec![Say::Message(hello(theirs.session))],
        Message::Sample(sample) => on_sample(sample),
        _ => Vec::new(),
    })
}

/// Patience for an answer that never comes.
const SHORT: Duration = Duration::from_millis(500);

/// Opens a session with given patience for the hello and for an answer.
fn open_within(
    peer: &Scripted,
    hello: Duration,
    answer: Duration,
) -> Result<Harness, SessionError> {
    let patience = Patience { hello, answer, repeat: Duration::from_millis(20) };
    let options = SessionOptions { patience, ..options() };
    Harness::open(Wire::open(&peer.uri, EndRole::Harness).unwrap(), options)
}

fn open(peer: &Scripted) -> Result<Harness, SessionError> {
    open_within(peer, LONG, LONG)
}

/// Opens a session with a device that won't answer.
fn open_impatient(peer: &Scripted) -> Harness {
    open_within(peer, LONG, SHORT).unwrap()
}

/// Checks that the harness waited for `expected`, long enough, and for nothing else.
fn no_answer(error: &SessionError, expected: &str) {
    let SessionError::NoAnswer { waited_for, waited, .. } = error else { panic!("{error}") };
    assert_eq!(waited_for, expected);
    assert!(*waited >= SHORT, "{error}");
    assert!(error.to_string().contains(&format!("no {expected} within ")), "{error}");
}

/// Makes steps until one fails.
fn steps(harness: &mut Harness, count: u64) -> Result<(), SessionError> {
    let mut output = Output::default();
    for k in 1..=count {
        let (sample, _) = sample(k);
        harness.step(&sample, None, &mut output)?;
        assert_eq!(output.sequence, k, "the answer is of another sample");
    }
    Ok(())
}

#[test]
fn one_that_never_answers() {
    let peer = Scripted::new(|_| Vec::new());
    let error = open_within(&peer, SHORT, SHORT).unwrap_err();
    no_answer(&error, "hello");
    assert!(error.to_string().contains("nothing at all"), "{error}");
    let peer = device(|_| Vec::new());
    let error = steps(&mut open_impatient(&peer), 1).unwrap_err();
    no_answer(&error, "output to step 1");
}

#[test]
fn one_that_answers_late() {
    // Each answer takes longer than the interval of repetition: it arrives after repeated requests.
    let peer = device(|sample| {
        let answer = output(sample.step, sample.sample.sequence);
        vec![Say::Wait(Duration::from_millis(35)), Say::Message(answer)]
    });
    let mut harness = open(&peer).unwrap();
    steps(&mut harness, 5).unwrap();
    assert!(harness.effort().repeated > 0);
}

#[test]
fn one_that_is_slower_than_it_is_asked_is_asked_less_often() {
    // A repeated request takes the device as long as any other. With a constant interval each step
    // would leave more of them on the line than the one before.
    let peer = device(|sample| {
        let answer = output(sample.step, sample.sample.sequence);
        vec![Say::Wait(Duration::from_millis(50)), Say::Message(answer)]
    });
    let mut harness = open(&peer).unwrap();
    steps(&mut harness, 12).unwrap();
    let repeated = harness.effort().repeated;
    assert!(repeated < 100, "asked {repeated} times again");
}

#[test]
fn one_that_hears_of_a_harness_that_waits() {
    // The device gives up a harness that is silent, and its answer takes longer than that.
    let mut waiting: Option<SampleMessage> = None;
    let mut heard = 0;
    let peer = Scripted::new(move |message| match message {
        Message::Hello(theirs) => {
            let Message::Hello(ours) = hello(theirs.session) else { unreachable!() };
            let limits = EndLimits { silence_ms: 200, ..ours.limits };
            vec![Say::Message(Message::Hello(Hello { limits, ..ours }))]
        }
        Message::Sample(sample) => {
            waiting = Some(*sample);
            Vec::new()
        }
        Message::Heartbeat(_) => {
            heard += 1;
            let answer = waiting.take_if(|_| heard % 3 == 0);
            let said = |sample: SampleMessage| output(sample.step, sample.sample.sequence);
            answer.map(|sample| Say::Message(said(sample))).into_iter().collect()
        }
        _ => Vec::new(),
    });
    let patience = Patience { hello: LONG, answer: LONG, repeat: LONG };
    let options = SessionOptions { patience, ..options() };
    let wire = Wire::open(&peer.uri, EndRole::Harness).unwrap();
    let mut harness = Harness::open(wire, options).unwrap();
    steps(&mut harness, 2).unwrap();
    assert_eq!(harness.effort().repeated, 0);
}

#[test]
fn one_that_answers_twice_and_with_old_answers() {
    let mut last = None;
    let peer = device(move |sample| {
        let answer = output(sample.step, sample.sample.sequence);
        let old = last.replace(answer);
        old.into_iter().chain([answer, answer]).map(Say::Message).collect()
    });
    steps(&mut open(&peer).unwrap(), 50).unwrap();
}

#[test]
fn one_that_answers_other_steps() {
    let peer = device(|sample| {
        let other = StepNumber::new(sample.step.number() + 7);
        vec![Say::Message(output(other, 99)), Say::Bytes(vec![0xA5; 300]), Say::Bytes(vec![0; 9])]
    });
    let mut harness = open_impatient(&peer);
    let begun = Instant::now();
    loop {
        let error = steps(&mut harness, 1).unwrap_err();
        assert!(matches!(error, SessionError::NoAnswer { .. }), "{error}");
        // On a busy host, less of the traffic may arrive in this time, or none.
        if error.to_string().contains("other messages were received, and") {
            break;
        }
        assert!(begun.elapsed() < LONG, "{error}");
    }
}

#[test]
fn one_that_started_anew() {
    let peer = device(|sample| match sample.step.number() {
        1 => vec![Say::Message(output(sample.step, 1))],
        _ => vec![Say::Message(hello(0))],
    });
    let error = steps(&mut open(&peer).unwrap(), 2).unwrap_err();
    assert!(matches!(error, SessionError::StartedAnew { .. }), "{error}");
}

#[test]
fn one_hello_after_a_restart_is_enough() {
    let begun = Instant::now();
    loop {
        let mut said = false;
        let peer = device(move |sample| match sample.step.number() {
            1 => vec![Say::Message(output(sample.step, 1))],
            // Switched on again: one hello, and no session.
            _ if !std::mem::replace(&mut said, true) => vec![Say::Message(hello(0))],
            _ => Vec::new(),
        });
        let error = steps(&mut open_impatient(&peer), 2).unwrap_err();
        if matches!(error, SessionError::StartedAnew { .. }) {
            break;
        }
        // On a busy host the answer didn't come in time, or the hello.
        assert!(matches!(error, SessionError::NoAnswer { .. }), "{error}");
        assert!(begun.elapsed() < LONG, "{error}");
    }
}

/// The frame of a bye whose text is no UTF-8, on the line.
fn bye_in_no_utf8(sequence: u8) -> Vec<u8> {
    let mut frame = vec![13, sequence, 0];
    frame.extend([0; 8]);
    frame.extend([7, 0, 0, 0]);
    frame.extend([0xC3; 2]);
    frame.extend([0; 38]);
    let crc = frame.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
        })
    });
    frame.extend((!crc).to_le_bytes());
    // Blocks up to each zero, of which there is one behind the frame; none is longer than 254 here.
    let stuffed = frame.split(|byte| *byte == 0).flat_map(|block| {
        std::iter::once(block.len() as u8 + 1).chain(block.iter().copied()).collect::<Vec<u8>>()
    });
    std::iter::once(0).chain(stuffed).chain([0]).collect()
}

#[test]
fn what_came_in_place_of_an_answer_is_named() {
    let mut sequence = 0;
    let peer = device(move |_| {
        // Every other frame is left out.
        sequence += 2;
        vec![Say::Bytes(bye_in_no_utf8(sequence))]
    });
    let mut harness = open_impatient(&peer);
    let begun = Instant::now();
    loop {
        let error = steps(&mut harness, 1).unwrap_err().to_string();
        assert!(error.contains("no output to step"), "{error}");
        // On a busy host, less of the traffic may arrive in this time, or none.
        if error.contains(
            "intact messages could not be read, the last: a message bye has a text that is no text",
        ) && error.contains("frames or segments never arrived")
        {
            break;
        }
        assert!(begun.elapsed() < LONG, "{error}");
    }
}

#[test]
fn an_old_hello_that_comes_again_is_no_new_start() {
    let mut last = None;
    let peer = device(move |sample| {
        let answer = output(sample.step, sample.sample.sequence);
        // Once a step, however often a busy host repeats the request: a hello at each request would
        // mean a restart.
        let old = (last.replace(sample.step) != Some(sample.step)).then(|| hello(0));
        old.into_iter().chain([answer]).map(Say::Message).collect()
    });
    steps(&mut open(&peer).unwrap(), 20).unwrap();
}

#[test]
fn one_that_announces_parameters_and_sends_none() {
    let peer = device(|sample| {
        let output = Output { sequence: 1, ..Output::default() };
        let parameters_follow = true;
        vec![Say::Message(Message::Output(OutputMessage {
            step: sample.step,
            parameters_follow,
            output,
            computing_ns: 0,
        }))]
    });
    let error = steps(&mut open_impatient(&peer), 1).unwrap_err();
    assert!(matches!(error, SessionError::NoAnswer { .. }), "{error}");
}

#[test]
fn one_that_says_bye_in_the_middle() {
    let peer = device(|_| {
        let text = octant_wire::Text::fitting("the motor is on fire");
        vec![Say::Message(Message::Bye(Bye { reason: Reason::FAILED, text }))]
    });
    let error = steps(&mut open(&peer).unwrap(), 1).unwrap_err().to_string();
    assert!(error.contains("said bye while output was waited for"), "{error}");
    assert!(error.contains("failed (the motor is on fire)"), "{error}");
}

#[test]
fn one_that_is_newer() {
    let peer = Scripted::new(|message| match message {
        Message::Hello(theirs) => {
            let Message::Hello(ours) = hello(theirs.session) else { unreachable!() };
            vec![Say::Message(Message::Hello(Hello { version: VERSION + 1, ..ours }))]
        }
        _ => Vec::new(),
    });
    let error = open(&peer).unwrap_err();
    assert!(matches!(error, SessionError::Newer { .. }), "{error}");
    assert!(error.to_string().contains("update this program"), "{error}");
}

#[test]
fn one_that_can_not_restart_says_so_before_it_is_asked() {
    let peer = Scripted::new(|message| match message {
        Message::Hello(theirs) => {
            let Message::Hello(ours) = hello(theirs.session) else { unreachable!() };
            let capabilities = Capabilities::LOCK_STEP;
            vec![Say::Message(Message::Hello(Hello { capabilities, ..ours }))]
        }
        _ => Vec::new(),
    });
    let mut harness = open(&peer).unwrap();
    let error = harness.restart(None).unwrap_err().to_string();
    assert!(error.contains("the device doesn't do restarts of its core"), "{error}");
    assert!(harness.end().unwrap().is_none(), "it doesn't conclude");
}

#[test]
fn a_stale_bye_doesn_t_end_a_session_that_begins() {
    let mut said = false;
    let peer = Scripted::new(move |message| match message {
        Message::Hello(theirs) => {
            let stale = Bye { reason: Reason::SILENCE, ..Bye::default() };
            let first = (!std::mem::replace(&mut said, true)).then_some(Message::Bye(stale));
            first.into_iter().chain([hello(theirs.session)]).map(Say::Message).collect()
        }
        Message::Sample(sample) => vec![Say::Message(output(sample.step, sample.sample.sequence))],
        _ => Vec::new(),
    });
    steps(&mut open(&peer).unwrap(), 3).unwrap();
}
