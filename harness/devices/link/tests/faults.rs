//! Faults on a wire: in lock-step the answers equal those of the core bit for bit, and the frames that
//! each fault altered are counted.

use crate::common::{LONG, Served, drive, facts, options, sample};
use octant_faults::wire::{Medium, Ways, WireAction, WireFault};
use octant_link::fault::around;
use octant_link::harness::{Harness, LinkEvent, Patience, SessionError, SessionOptions};
use octant_link::port::{self, Port, Pty, SlcanPort};
use octant_link::{PortError, Uri, Wire};
use octant_sample::Output;
use octant_wire::message::EndRole;
use std::time::{Duration, Instant};

const BOTH: Ways = Ways { to_device: true, to_harness: true };

/// Actions that a session in lock-step survives, each with its chance.
fn actions() -> Vec<(WireAction, f64)> {
    vec![
        (WireAction::Flip, 0.2),
        (WireAction::Insert, 0.2),
        (WireAction::Drop, 0.2),
        (WireAction::Truncate, 0.2),
        (WireAction::Checksum, 0.2),
        (WireAction::Duplicate, 1.0),
        (WireAction::Reorder, 0.2),
        (WireAction::Lose, 0.2),
        (WireAction::Delay { by_s: 1e-4, jitter_s: 1e-3 }, 1.0),
        (WireAction::Replay { age: 3 }, 1.0),
        (WireAction::Split { pieces: 3, apart_s: 2e-4 }, 1.0),
        (WireAction::Coalesce, 0.2),
        (WireAction::Babble { count: 40 }, 1.0),
        (WireAction::Break { lasts_s: 0.02 }, 1.0),
        (WireAction::Framing, 0.2),
        (WireAction::SlowReader { pause_s: 0.05 }, 1.0),
        (WireAction::ErrorFrame, 0.5),
        (WireAction::ArbitrationLost, 0.5),
        (WireAction::BusOff { off_s: 0.05 }, 1.0),
        // Each message is many frames, and one damaged frame costs the whole message.
        (WireAction::Collision, 0.01),
        (WireAction::Overload { frames: 2, each_s: 2e-5 }, 0.2),
    ]
}

fn patient() -> SessionOptions {
    let patience = Patience { repeat: Duration::from_millis(10), ..options().patience };
    SessionOptions { patience, ..options() }
}

/// A device on a medium, and the harness's port to it.
fn pair(medium: Medium) -> (Served, Port) {
    match medium {
        Medium::Line | Medium::Datagrams => {
            let uri = if medium == Medium::Line { "pty:" } else { "udp:0" };
            let (served, uri) = Served::on(uri, facts());
            let port = port::open(&uri, EndRole::Harness).unwrap();
            (served, port)
        }
        // Two adapters with crossed lines: each receives what the other sends.
        Medium::Bus => {
            let pty = Pty::open("").unwrap();
            let uri = format!("slcan:{}?bitrate=500000", pty.name());
            let Uri::Slcan(slcan) = uri.parse().unwrap() else { panic!() };
            let far = slcan.clone();
            let device = std::thread::spawn(move || SlcanPort::over(Box::new(pty), &far).unwrap());
            let near = SlcanPort::open(&slcan).unwrap();
            let device = Port::Frames(Box::new(device.join().unwrap()));
            let served = Served::over(Wire::new("device", device, EndRole::Device), facts());
            (served, Port::Frames(Box::new(near)))
        }
    }
}

/// Opens a session, then begins one fault on its wire.
fn faulted(port: Port, fault: WireFault, options: SessionOptions) -> Harness {
    let wire = Wire::new("faulted", around(port), EndRole::Harness);
    let mut harness = Harness::open(wire, options).unwrap();
    harness.wire().wired().unwrap().begin(7, &fault);
    harness
}

fn survives(medium: Medium) {
    for (action, chance) in actions() {
        if !action.happens_on(medium) {
            continue;
        }
        // These actions last for a time of their own, in which a busy host may send nothing: then try
        // again.
        let passes = matches!(
            action,
            WireAction::Break { .. } | WireAction::SlowReader { .. } | WireAction::BusOff { .. }
        );
        let begun = Instant::now();
        while !survives_one(medium, action, chance) {
            assert!(
                passes && begun.elapsed() < LONG,
                "{action:?} altered nothing on {}",
                medium.name()
            );
        }
    }
}

/// Runs a session under a fault; true if the fault altered any frame.
fn survives_one(medium: Medium, action: WireAction, chance: f64) -> bool {
    let (mut served, port) = pair(medium);
    // On a bus a message has up to 17 frames, and an answer with parameters 89: all of them have to
    // arrive.
    let spoils = matches!(
        action,
        WireAction::Flip
            | WireAction::Lose
            | WireAction::Reorder
            | WireAction::Replay { .. }
            | WireAction::Babble { .. }
    );
    let chance = if spoils && medium == Medium::Bus { 0.01 } else { chance };
    let fault = WireFault { ways: BOTH, chance, action, key: [1, 2] };
    let mut harness = faulted(port, fault, patient());
    drive(&mut harness, 60);
    let wired = harness.wire().wired().unwrap();
    let altered = wired.altered(7);
    if altered.frames == 0 {
        return false;
    }
    assert_eq!(wired.altered(7).frames, 0, "what was told is not told again");
    assert_eq!(wired.altered(8).frames, 0, "there is no such fault");
    let same = altered.clean_crc32 == altered.faulted_crc32;
    let unaltered = matches!(
        action,
        WireAction::Delay { .. } | WireAction::ErrorFrame | WireAction::Split { .. }
    );
    assert_eq!(same, unaltered, "{action:?} on {}", medium.name());
    harness.wire().wired().unwrap().end(7);
    drop(harness);
    served.stop();
    true
}

#[test]
fn a_serial_line_may_be_as_bad_as_it_likes() {
    survives(Medium::Line);
}

#[test]
fn udp_may_be_as_bad_as_it_likes() {
    survives(Medium::Datagrams);
}

#[test]
fn a_bus_may_be_as_bad_as_it_likes() {
    survives(Medium::Bus);
}

#[test]
fn a_bus_without_faults_carries_a_session() {
    let (mut served, port) = pair(Medium::Bus);
    let mut harness = Harness::open(Wire::new("bus", port, EndRole::Harness), options()).unwrap();
    drive(&mut harness, 60);
    let counts = harness.counts();
    assert_eq!((counts.lost, counts.damaged, counts.missing), (0, 0, 0));
    drop(harness);
    served.stop();
}

#[test]
fn where_all_is_lost_the_error_says_so() {
    let (_served, port) = pair(Medium::Datagrams);
    let mut options = patient();
    options.patience.answer = Duration::from_millis(100);
    // In both directions: otherwise, on a busy host, a status of the device arrives before the harness
    // gives up.
    let fault = WireFault { ways: BOTH, chance: 1.0, action: WireAction::Lose, key: [1, 2] };
    let mut harness = faulted(port, fault, options);
    let (one, aiding) = sample(1);
    let error = harness.step(&one, aiding.as_ref(), &mut Output::default()).unwrap_err();
    assert!(
        matches!(&error, SessionError::NoAnswer { waited_for, .. } if waited_for == "output to step 1")
    );
    assert!(error.to_string().contains("nothing at all was received"), "{error}");
}

#[test]
fn garbage_alone_is_told_from_silence() {
    let (_served, port) = pair(Medium::Line);
    let mut options = patient();
    options.patience.answer = Duration::from_millis(200);
    let ways = Ways { to_device: false, to_harness: true };
    let fault = WireFault { ways, chance: 1.0, action: WireAction::Checksum, key: [1, 2] };
    let mut harness = faulted(port, fault, options);
    let (one, aiding) = sample(1);
    let begun = Instant::now();
    loop {
        let error = harness.step(&one, aiding.as_ref(), &mut Output::default()).unwrap_err();
        let told = error.to_string();
        if told.contains("no message was received, but") {
            break;
        }
        // On a busy host no answer arrived in this time, not even a damaged one.
        // Or an intact status came that the device had sent before the fault began.
        assert!(told.contains("no output to step") && begun.elapsed() < LONG, "{told}");
    }
}

#[test]
fn a_plug_that_was_pulled_ends_the_step_and_a_port_that_is_back_goes_on() {
    for medium in [Medium::Line, Medium::Datagrams, Medium::Bus] {
        let (_served, port) = pair(medium);
        let away = |away_s| {
            let action = WireAction::HangUp { away_s };
            WireFault { ways: BOTH, chance: 1.0, action, key: [1, 2] }
        };
        let wire = Wire::new("pulled", around(port), EndRole::Harness);
        let mut harness = Harness::open(wire, patient()).unwrap();
        let mut output = Output::default();
        let (one, aiding) = sample(1);
        harness.step(&one, aiding.as_ref(), &mut output).unwrap();
        harness.wire().wired().unwrap().begin(0, &away(3600.0));
        let (two, aiding) = sample(2);
        let error = harness.step(&two, aiding.as_ref(), &mut output).unwrap_err();
        assert!(matches!(error, SessionError::Port(PortError::Gone { .. })), "{error}");
        assert!(harness.reopen(Duration::ZERO).is_err(), "it is still away");
        // Beginning the fault again replaces its time: away for 0.05 s from now, and no less.
        let begun = Instant::now();
        harness.wire().wired().unwrap().begin(0, &away(0.05));
        while let Err(error) = harness.reopen(Duration::from_millis(50)) {
            assert!(begun.elapsed() < LONG, "{error}");
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(begun.elapsed() >= Duration::from_millis(50));
        harness.step_again(&mut output).unwrap();
        assert_eq!(output.sequence, 2);
        assert_eq!(harness.effort().reconnected, 1);
        assert_eq!(harness.wire().wired().unwrap().altered(0).frames, 1);
        let (three, aiding) = sample(3);
        harness.step(&three, aiding.as_ref(), &mut output).unwrap();
        assert_eq!(output.sequence, 3);
    }
}

#[test]
fn what_was_held_back_goes_on_when_the_fault_ends() {
    let (_served, port) = pair(Medium::Line);
    let fault = WireFault { ways: BOTH, chance: 1.0, action: WireAction::Reorder, key: [1, 2] };
    let mut options = patient();
    options.patience.repeat = Duration::from_secs(5);
    let mut harness = faulted(port, fault, options);
    let (one, aiding) = sample(1);
    assert!(aiding.is_none());
    harness
        .wire()
        .wired()
        .unwrap()
        .begin(7, &WireFault { ways: Ways { to_device: true, to_harness: false }, ..fault });
    harness.send_sample(&one, None).unwrap();
    // Statuses of the device may arrive.
    let is_answer = |event: &LinkEvent| matches!(event, LinkEvent::Output(_));
    let mut said = std::iter::from_fn(|| harness.poll(Duration::from_millis(50)).unwrap());
    assert!(!said.any(|event| is_answer(&event)));
    harness.wire().wired().unwrap().end(7);
    let begun = Instant::now();
    while !harness.poll(LONG).unwrap().is_some_and(|event| is_answer(&event)) {
        assert!(begun.elapsed() < LONG, "no answer came");
    }
}
