//! Sessions over pseudo terminals and UDP: the answers equal those of the core, bit for bit.

use crate::common::{self, LONG, Served, bits, drive, facts, harness, options, sample};
use octant_link::device::Facts;
use octant_link::harness::{Harness, LinkEvent, Sending, SessionError};
use octant_link::{Uri, Wire};
use octant_sample::Output;
use octant_wire::Text;
use octant_wire::message::{Capabilities, EndRole, Reason, SessionRefusal, StepPacing};
use std::time::{Duration, Instant};

/// Ports that need no hardware.
const URIS: [&str; 2] = ["pty:", "udp:0"];

#[test]
fn a_session_in_lock_step_is_the_core_itself() {
    for uri in URIS {
        let (mut served, uri) = Served::on(uri, facts());
        let mut harness = harness(&uri);
        assert_eq!(harness.theirs().name.as_str(), "echo");
        drive(&mut harness, 400);
        let counts = harness.counts();
        assert_eq!((counts.lost, counts.damaged, counts.missing), (0, 0, 0), "{uri}");
        drop(harness);
        served.stop();
        let said = served.said().join("\n");
        assert!(said.contains("a session in lock-step began with octant"), "{said}");
        assert!(said.contains("the session is over"), "{said}");
    }
}

/// Names are printed to terminals and written into files.
#[test]
fn a_name_that_a_terminal_would_obey_is_refused() {
    for (name, firmware, field) in
        [("a\u{1b}[2Jb", "1", "name"), ("a", "1\u{9b}31m", "firmware"), ("a\u{202e}b", "1", "name")]
    {
        let bad = Facts { name: Text::fitting(name), firmware: Text::fitting(firmware), ..facts() };
        let (_served, uri) = Served::on("pty:", bad);
        let error = match Harness::open(Wire::open(&uri, EndRole::Harness).unwrap(), options()) {
            Ok(_) => panic!("{name:?} {firmware:?} was taken"),
            Err(error) => error,
        };
        assert!(matches!(error, SessionError::Control { .. }), "{error}");
        let told = error.to_string();
        assert!(told.contains(field) && told.contains("control character"), "{told}");
        assert!(!told.chars().any(char::is_control), "{told:?}");
    }
    // Any other text is a valid name.
    let good = Facts { name: Text::fitting("Gerät 7/β"), ..facts() };
    let (_served, uri) = Served::on("pty:", good);
    assert_eq!(harness(&uri).theirs().name.as_str(), "Gerät 7/β");
}

#[test]
fn a_device_serves_one_harness_after_the_other() {
    for uri in URIS {
        let (_served, uri) = Served::on(uri, facts());
        for _ in 0..3 {
            drive(&mut harness(&uri), 40);
        }
    }
}

/// The device end of TCP has one connection at a time.
#[test]
fn an_idle_connection_gives_way_to_a_harness() {
    let (_served, uri) = Served::on("tcp:0", facts());
    let address = uri.to_string().replace("tcp:", "");
    let idle = std::net::TcpStream::connect(&address).unwrap();
    drive(&mut harness(&uri), 40);
    drop(idle);
}

#[test]
fn a_harness_that_is_gone_without_a_word_is_given_up() {
    let short = Facts {
        // Longer than a busy host takes between two steps, and short enough for a test.
        limits: octant_wire::message::EndLimits { silence_ms: 5000, ..facts().limits },
        ..facts()
    };
    let (served, uri) = Served::on("udp:0", short);
    let mut first = harness(&uri);
    let mut output = Output::default();
    let (one, aiding) = sample(1);
    first.step(&one, aiding.as_ref(), &mut output).unwrap();
    // Like a kill -9: the harness sends nothing more, and closes nothing in order.
    std::mem::forget(first);
    // The second harness is not served until the first is given up.
    drive(&mut harness(&uri), 4);
    let said = served.said().join("\n");
    assert!(said.contains("nothing heard for 5.0 s"), "{said}");
}

#[test]
fn two_that_don_t_fit_part_with_a_reason() {
    let fails = |facts: Facts, change: fn(&mut octant_link::harness::SessionOptions)| {
        let (_served, uri) = Served::on("pty:", facts);
        let mut options = options();
        change(&mut options);
        Harness::open(Wire::open(&uri, EndRole::Harness).unwrap(), options).unwrap_err()
    };
    let period = fails(facts(), |options| options.sample_period_ns = 1_000_000);
    assert!(matches!(period, SessionError::Refused { reason: SessionRefusal::Period { .. }, .. }));
    let other = Facts { configuration: [7; 32], ..facts() };
    let configuration = fails(other, |options| options.configuration = [8; 32]);
    let told = configuration.to_string();
    assert!(told.contains("configuration 0808") && told.contains("has 0707"), "{told}");
    let slow = Facts { capabilities: Capabilities::LOCK_STEP, ..facts() };
    let pacing = fails(slow, |options| options.pacing = StepPacing::RealTime);
    assert!(pacing.to_string().contains("asks for real-time steps"), "{pacing}");
}

#[test]
fn nobody_at_the_other_end_is_told_with_what_was_heard() {
    let (_near, _far, name) = octant_base::serial::SerialPort::pair().unwrap();
    let uri: Uri = format!("serial:{name}").parse().unwrap();
    let mut options = options();
    options.patience.hello = Duration::from_millis(300);
    let wire = Wire::open(&uri, EndRole::Harness).unwrap();
    let error = Harness::open(wire, options).unwrap_err();
    let SessionError::NoAnswer { waited, .. } = &error else { panic!("{error}") };
    assert!(*waited >= Duration::from_millis(300), "{error}");
    let error = error.to_string();
    assert!(error.contains(&name) && error.contains("no hello within "), "{error}");
    assert!(error.contains("nothing at all was received"), "{error}");
}

#[test]
fn a_device_that_goes_in_the_middle_is_an_error_that_says_what_was_waited_for() {
    for uri in URIS {
        let (mut served, uri) = Served::on(uri, facts());
        let mut harness = harness(&uri);
        let mut output = Output::default();
        let (one, aiding) = sample(1);
        harness.step(&one, aiding.as_ref(), &mut output).unwrap();
        served.stop();
        let (two, aiding) = sample(2);
        let error = harness.step(&two, aiding.as_ref(), &mut output).unwrap_err();
        // The device said bye, or its pseudo terminal vanished first.
        let told = error.to_string();
        assert!(told.contains("bye") || told.contains("went away"), "{told}");
        if let SessionError::Bye { bye, .. } = error {
            assert_eq!(bye.reason, Reason::STOPPED);
        }
    }
}

#[test]
fn in_real_time_nothing_waits() {
    for uri in URIS {
        let (_served, uri) = Served::on(uri, facts());
        let options =
            octant_link::harness::SessionOptions { pacing: StepPacing::RealTime, ..options() };
        let mut harness =
            Harness::open(Wire::open(&uri, EndRole::Harness).unwrap(), options).unwrap();
        let mut echo = common::Echo::default();
        let (mut sent, mut got, mut times) = (0, 0, 0);
        let begun = Instant::now();
        while got < 200 && begun.elapsed() < LONG {
            if sent < 200 {
                let (sample, aiding) = sample(sent + 1);
                match harness.send_sample(&sample, aiding.as_ref()).unwrap() {
                    Sending::Sent(_) => {
                        sent += 1;
                        // One request in 50 samples: a flood of them would leave a busy device no room
                        // for samples.
                        if sent % 50 == 0 {
                            harness.request_time().unwrap();
                        }
                    }
                    Sending::WindowFull => assert!(harness.underway() >= 16),
                    Sending::NotTaken(_) => panic!("the port has room for a window"),
                }
            }
            while let Some(event) = harness.poll(Duration::ZERO).unwrap() {
                match event {
                    LinkEvent::Output(answer) => {
                        got += 1;
                        let (sample, aiding) = sample(got);
                        let mut expected = Output::default();
                        octant_link::device::Steps::step(
                            &mut echo,
                            &sample,
                            aiding.as_ref(),
                            &mut expected,
                        );
                        assert_eq!(bits(&answer.output), bits(&expected));
                    }
                    LinkEvent::Time(stamps) => {
                        let found = stamps.reply.offset(stamps.harness_received);
                        assert!(found.error_ns >= 0, "{found:?}");
                        times += 1;
                    }
                    _ => {}
                }
            }
        }
        assert_eq!(got, 200, "{uri}");
        assert!(times > 0);
    }
}
