//! Drivers with simulated controllers: moves, limits, errors.

use crate::common::*;
use octant_sample::{GimbalAngles, GimbalCommand};
use octant_turntable::simulate::{ControllerBehaviour, SimulatedServer};
use octant_turntable::{
    Dialect, Driver, DriverSettings, Error, Follower, Supervisor, TableAxis, TablePort, Turntable,
};
use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Tests all functions of a table, in one language.
fn all_it_does(server: &SimulatedServer, mut table: impl Turntable) {
    for axis in TableAxis::ALL {
        let status = *table.status().unwrap().of(axis);
        assert_eq!(
            (status.enabled, status.moving, status.fault),
            (Some(true), Some(false), Some(0))
        );
    }
    table.goto(TableAxis::Roll, degrees(30.0), None).unwrap();
    wait_for("the end of the move", || {
        table.status().unwrap().of(TableAxis::Roll).moving == Some(false)
    });
    assert!((angle(server, TableAxis::Roll) - 30.0).abs() < 1e-5);
    let status = table.status().unwrap();
    assert!((status.of(TableAxis::Roll).angle_rad - degrees(30.0)).abs() < 1e-6);
    assert_eq!(status.of(TableAxis::Azimuth).angle_rad, 0.0);

    // Slow, within the limits: a busy host may take long until it sends the stop.
    table.rate(TableAxis::Azimuth, degrees(-2.0)).unwrap();
    wait_for("the rate", || {
        let really = server.with(|c, now_ns| c.motion(TableAxis::Azimuth, now_ns).rate_radps);
        (really - degrees(-2.0)).abs() < 1e-9
    });
    if let Some(rate) = table.status().unwrap().of(TableAxis::Azimuth).rate_radps {
        assert!((rate - degrees(-2.0)).abs() < 1e-6);
    }
    table.stop().unwrap();
    wait_for("rest", || rests(server));
    // Moves back, and homes.
    table.goto(TableAxis::Roll, degrees(30.0), Some(degrees(1.0))).unwrap();
    assert_eq!(table.status().unwrap().of(TableAxis::Roll).homed, Some(false));
    table.home(TableAxis::Roll).unwrap();
    wait_for("home", || {
        let status = *table.status().unwrap().of(TableAxis::Roll);
        status.homed == Some(true) && status.moving == Some(false)
    });
    assert!(angle(server, TableAxis::Roll).abs() < 1e-5);
}

#[test]
fn two_languages_over_tcp() {
    for dialect in [ensemble(), invented()] {
        let (server, name) = tcp(dialect.clone());
        let driver = drive(&name, dialect, settings());
        all_it_does(&server, driver);
    }
}

#[test]
fn supervised() {
    for dialect in [ensemble(), invented()] {
        // In real time: one of the languages has no rate, which then follows from the angles.
        let (server, name) = tcp_at(dialect.clone(), 1.0);
        let watched = DriverSettings { watchdog: Some(Duration::from_secs(600)), ..settings() };
        let driver = drive(&name, dialect, watched);
        let table = Supervisor::new(driver, Duration::from_millis(10)).unwrap();
        all_it_does(&server, table);
        wait_for("rest after the end", || rests(&server));
    }
}

#[cfg(unix)]
#[test]
fn two_languages_over_a_pseudo_terminal() {
    for dialect in [ensemble(), invented()] {
        let (near, far, _) = octant_base::serial::SerialPort::pair().unwrap();
        let server = SimulatedServer::line(controller(dialect.clone()), near, 10.0).unwrap();
        let driver = Driver::new(far, "pty", dialect, settings()).unwrap();
        all_it_does(&server, driver);
    }
}

/// A port that gives prepared replies, and records the bytes sent.
#[derive(Clone, Default)]
struct Script {
    sent: Arc<Mutex<Vec<u8>>>,
    replies: Arc<Mutex<VecDeque<u8>>>,
}

impl Read for Script {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut replies = self.replies.lock().unwrap();
        let count = replies.len().min(bytes.len());
        for byte in &mut bytes[..count] {
            *byte = replies.pop_front().unwrap();
        }
        if count > 0 { Ok(count) } else { Err(io::ErrorKind::TimedOut.into()) }
    }
}

impl Write for Script {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.sent.lock().unwrap().extend(bytes);
        let mut replies = self.replies.lock().unwrap();
        // Reply of an Ensemble controller.
        let line = String::from_utf8_lossy(bytes).into_owned();
        let reply = match line.trim_end() {
            "AXISSTATUS(@0)" => "%7\n",
            "AXISSTATUS(@1)" => "%11\n",
            "PFBKPROG(@0)" => "%-0.25\n",
            "PFBKPROG(@1)" => "%180.5\n",
            "VFBK(@0)" | "AXISFAULT(@0)" | "AXISFAULT(@1)" => "%0\n",
            "VFBK(@1)" => "%-3\n",
            _ => "%\n",
        };
        replies.extend(reply.bytes());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl TablePort for Script {
    fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(Box::new(self.clone()))
    }

    fn set_wait(&mut self, _: Duration) -> io::Result<()> {
        Ok(())
    }

    #[cfg(unix)]
    fn duplicate(&self) -> io::Result<std::os::fd::OwnedFd> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

/// Lines that an Ensemble controller is sent, letter by letter, and the meaning of its replies.
#[test]
fn ensemble_to_the_letter() {
    let script = Script::default();
    let sent = Arc::clone(&script.sent);
    let said = move || String::from_utf8(std::mem::take(&mut *sent.lock().unwrap())).unwrap();
    let watched = DriverSettings { watchdog: Some(Duration::from_millis(500)), ..settings() };
    let mut driver = Driver::new(script, "script", ensemble(), watched).unwrap();
    let questions = "AXISSTATUS(@0)\nPFBKPROG(@0)\nVFBK(@0)\nAXISFAULT(@0)\n\
                     AXISSTATUS(@1)\nPFBKPROG(@1)\nVFBK(@1)\nAXISFAULT(@1)\n";
    let beginning = "WAIT MODE NOWAIT\nFAULTACK @0\nENABLE @0\nRAMP MODE @0 RATE\n\
                     FAULTACK @1\nENABLE @1\nRAMP MODE @1 RATE\nIGLOBAL(34) = 500\n";
    assert_eq!(said(), format!("{beginning}{questions}"));
    let status = driver.status().unwrap();
    said();
    let [azimuth, roll] = status.axes;
    // Bits 7: enabled, homed, in position; 11: enabled, homed, moving.
    assert_eq!(
        (azimuth.enabled, azimuth.homed, azimuth.moving),
        (Some(true), Some(true), Some(false))
    );
    assert_eq!((roll.enabled, roll.homed, roll.moving), (Some(true), Some(true), Some(true)));
    assert_eq!((azimuth.angle_rad, roll.rate_radps), (degrees(-0.25), Some(-3.0 * degrees(1.0))));
    driver.goto(TableAxis::Roll, degrees(180.5), Some(degrees(10.0))).unwrap();
    assert_eq!(said(), "ABS\nRAMP RATE 30.000000\nLINEAR @1 180.500000 F10.000000\n");
    driver.rate(TableAxis::Azimuth, degrees(-7.5)).unwrap();
    assert_eq!(said(), "RAMP RATE @0 30.000000\nFREERUN @0 -7.500000\n");
    driver.rate(TableAxis::Azimuth, -0.0).unwrap();
    assert_eq!(said(), "RAMP RATE @0 30.000000\nFREERUN @0 0.000000\n");
    driver.home(TableAxis::Azimuth).unwrap();
    assert_eq!(said(), "IGLOBAL(32) = 1\nIGLOBAL(33) = 0\nPROGRAM RUN 5, \"HomeAsync.bcx\"\n");
    driver.stop().unwrap();
    assert_eq!(said(), "ABORT @0\nABORT @1\n");
    driver.emergency().trip("test");
    assert_eq!(said(), "\nABORT @0\nABORT @1\n\nABORT @0\nABORT @1\n");
}

#[test]
fn beyond_the_limits_nothing_is_sent() {
    let (server, name) = tcp(ensemble());
    let mut driver = drive(&name, ensemble(), settings());
    let heard = || server.with(|controller, _| controller.log().len());
    let before = heard();
    let say = |result: Result<(), Error>| result.unwrap_err().to_string();
    assert_eq!(
        say(driver.goto(TableAxis::Roll, degrees(365.1), None)),
        "roll 365.1000° is beyond its limits, -185° to 365°"
    );
    assert_eq!(
        say(driver.goto(TableAxis::Azimuth, degrees(10.0), Some(degrees(21.0)))),
        "azimuth at 21.0000 °/s is faster than its limit, 20° to 20°"
            .replace("20° to 20°", "20 °/s")
    );
    assert!(matches!(driver.rate(TableAxis::Roll, degrees(-20.1)), Err(Error::Rate { .. })));
    for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(matches!(driver.goto(TableAxis::Roll, nonsense, None), Err(Error::Angle { .. })));
        assert!(matches!(
            driver.goto(TableAxis::Roll, 0.0, Some(nonsense)),
            Err(Error::Rate { .. })
        ));
        assert!(matches!(driver.rate(TableAxis::Roll, nonsense), Err(Error::Rate { .. })));
    }
    assert!(matches!(driver.goto(TableAxis::Roll, 0.0, Some(0.0)), Err(Error::Rate { .. })));
    assert_eq!(heard(), before);
    let mut unkept = settings();
    unkept.limits.axes[1].rate_radps = f64::NAN;
    let error = Driver::new(octant_turntable::open(&name).unwrap(), "x", ensemble(), unkept);
    assert!(error.err().unwrap().to_string().starts_with("the limits of roll can't be kept"));
}

/// An axis turned with a rate comes to rest before its soft limit, even if its language doesn't report
/// the rate.
fn ends_at_the_soft_limit(dialect: Dialect) {
    // In real time: the looks are as old as on a real line.
    let (server, name) = tcp_at(dialect.clone(), 1.0);
    let mut near = settings();
    near.limits.axes[0].most_rad = degrees(65.0);
    let driver = drive(&name, dialect, near);
    // The axis is stopped when two more periods of 10 °/s and the braking distance, 1.7°, would end
    // beyond the limit: at 23.3°, or a period later, at 43.3°. A busy host then still has the second
    // period to look.
    let mut table = Supervisor::new(driver, Duration::from_secs(2)).unwrap();
    table.rate(TableAxis::Azimuth, degrees(10.0)).unwrap();
    wait_for("the stop", || table.emergency().is_tripped());
    wait_for("rest", || rests(&server));
    let at = angle(&server, TableAxis::Azimuth);
    assert!((23.0..65.0).contains(&at), "{at}");
    wait_for("the fault", || table.fault().is_some());
    let fault = table.fault().unwrap();
    assert!(fault.starts_with("azimuth ") && fault.contains("beyond its limits"), "{fault}");
    // The stop lasts until somebody resets it.
    let error = table.goto(TableAxis::Azimuth, 0.0, None).unwrap_err().to_string();
    assert!(error.starts_with("the table was stopped: azimuth"), "{error}");
    table.emergency().reset();
    table.goto(TableAxis::Azimuth, 0.0, None).unwrap();
    wait_for("the way back", || angle(&server, TableAxis::Azimuth).abs() < 1e-5);
}

#[test]
fn a_rate_ends_at_the_soft_limit() {
    std::thread::scope(|scope| {
        for dialect in [ensemble(), invented()] {
            scope.spawn(|| ends_at_the_soft_limit(dialect));
        }
    });
}

#[test]
fn nonsense_is_not_believed() {
    let (server, name) = tcp(ensemble());
    let mut quick = settings();
    // Long enough for a busy host, and short enough for three waits.
    quick.reply_within = Duration::from_secs(2);
    let mut driver = drive(&name, ensemble(), quick);
    let behave = |behaviour| server.with(|controller, _| controller.behave(behaviour));
    behave(ControllerBehaviour::Nonsense("%twelve".into()));
    let error = driver.status().unwrap_err().to_string();
    assert_eq!(
        error,
        format!("{name}: found the reply `%twelve` to `AXISSTATUS(@0)`, expected `%{{bits}}`")
    );
    behave(ControllerBehaviour::Nonsense("!".into()));
    let error = driver.goto(TableAxis::Roll, 0.5, None).unwrap_err().to_string();
    assert_eq!(error, format!("{name}: the controller refused `ABS` with `!`"));
    behave(ControllerBehaviour::Nonsense("x".repeat(9000)));
    let error = driver.home(TableAxis::Roll).unwrap_err();
    assert!(matches!(error, Error::Nonsense { .. }), "{error}");
    behave(ControllerBehaviour::Silent);
    let error = driver.status().unwrap_err().to_string();
    assert_eq!(error, format!("{name}: no reply to `AXISSTATUS(@0)` within 2s"));
    assert!(!driver.emergency().is_tripped());
    // A stop without an answer trips the emergency stop.
    assert!(driver.stop().is_err());
    assert!(driver.emergency().is_tripped());
    // After its return, bytes that it sent meanwhile aren't taken for replies.
    behave(ControllerBehaviour::Well);
    driver.emergency().reset();
    let status = driver.status().unwrap();
    assert_eq!(status.of(TableAxis::Azimuth).fault, Some(0));
}

#[test]
fn a_lost_port_is_said() {
    let (server, name) = tcp(ensemble());
    let mut driver = drive(&name, ensemble(), settings());
    server.with(|controller, _| controller.behave(ControllerBehaviour::HangUp));
    let error = driver.status().unwrap_err();
    assert!(matches!(error, Error::Gone { .. }), "{error}");
    assert!(error.to_string().starts_with(&format!("{name} went away: ")), "{error}");
    drop(server);
    let error = octant_turntable::open(&name).err().unwrap().to_string();
    assert!(error.starts_with(&format!("open {name}: ")), "{error}");
    // A format that is right is not explained.
    assert!(!error.contains("expected") && !error.contains("HOST:PORT"), "{error}");
    let error = octant_turntable::open("serial:/no/such/device").err().unwrap().to_string();
    assert!(error.starts_with("open serial:/no/such/device?baud=115200: "), "{error}");
    for wrong in ["can:can0", "serial:/dev/null?speed=3", "tcp:nowhere", "tcp:::1:8000"] {
        assert!(matches!(octant_turntable::open(wrong), Err(Error::Address(_))), "{wrong}");
    }
}

#[test]
fn a_table_of_patterns_that_is_none() {
    let wrong = |from: &str, to: &str| {
        let text = INVENTED.replace(from, to);
        assert_ne!(text, INVENTED, "{from}");
        Dialect::parse("invented.toml", &text).unwrap_err().to_string()
    };
    assert_eq!(
        wrong("MOVE {angle}", "MOVE {angel}"),
        "invented.toml: commands.goto: found a field {angel} in `{axis}:MOVE {angel}`, expected one of \
         axis, angle, rate, acceleration, ms, bits, fault, moving, homed, enabled, any"
    );
    assert_eq!(
        wrong("MOVE {angle}", "MOVE"),
        "invented.toml: commands.goto: found no line with a field {angle}, expected one"
    );
    assert_eq!(
        wrong("\"deg/min\"", "\"rpm\""),
        "invented.toml: rate: found the unit `rpm`, expected one of deg/s, deg/min, rad/s"
    );
    assert_eq!(
        wrong("[\"HALT\"]", "[]"),
        "invented.toml: commands.stop: found no line, expected one: every table has this command"
    );
    assert_eq!(
        wrong("ST {angle} {moving}", "ST {angle}{moving}"),
        "invented.toml: status 1: `ST {angle}{moving} {homed} {enabled} {fault}` has two fields without a \
         character between them"
    );
    assert_eq!(
        wrong("\"WD {ms}\"", "\"WD {ms\""),
        "invented.toml: watchdog.feed: `WD {ms` has a { without its }"
    );
    let hone = wrong("home =", "hone =");
    assert!(hone.starts_with("invented.toml:20: unknown field `hone`"), "{hone}");
    let without = INVENTED.replace("[watchdog]\nfeed = [\"WD {ms}\"]", "");
    let dialect = Dialect::parse("invented.toml", &without).unwrap();
    let (_server, name) = tcp(dialect.clone());
    let watched = DriverSettings { watchdog: Some(Duration::from_secs(1)), ..settings() };
    let error = Driver::new(octant_turntable::open(&name).unwrap(), &name, dialect, watched).err();
    assert_eq!(error.unwrap().to_string(), "the command language `invented` has no watchdog");
}

proptest::proptest! {
    /// A controller accepts any line and continues.
    #[test]
    fn any_line(lines in proptest::collection::vec("\\PC{0,40}", 0..30)) {
        for dialect in [ensemble(), invented()] {
            let mut controller = controller(dialect);
            for (number, line) in lines.iter().enumerate() {
                controller.line(line, number as u64 * 1_000_000);
            }
        }
    }

    /// A table of patterns with some changed characters is read or refused.
    #[test]
    fn a_damaged_table_of_patterns(strikes in proptest::collection::vec((proptest::prelude::any::<proptest::sample::Index>(), 32u8..127), 1..6)) {
        let mut bytes = INVENTED.as_bytes().to_vec();
        for (at, byte) in strikes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(dialect) = Dialect::parse("damaged.toml", std::str::from_utf8(&bytes).unwrap()) {
            let mut controller = controller(dialect);
            controller.line("INNER:MOVE 3", 5);
            controller.line("INNER:ST?", 6);
        }
    }
}

#[test]
fn the_core_moves_the_table() {
    let (server, name) = tcp(ensemble());
    let mut driver = drive(&name, ensemble(), settings());
    let mut follower = Follower::new();
    let target = GimbalAngles::from_rad(degrees(90.0), degrees(-45.0));
    let command = GimbalCommand { target };
    assert!(follower.command(&mut driver, &command).unwrap());
    let heard = server.with(|controller, _| controller.log().len());
    // Every further output has the same set point.
    for _ in 0..100 {
        assert!(!follower.command(&mut driver, &command).unwrap());
    }
    assert_eq!(server.with(|controller, _| controller.log().len()), heard);
    wait_for("the position", || {
        let found = driver.status().unwrap().gimbal();
        // Tolerance: six decimals of a degree, in counts of 2⁻²⁷ rad.
        (found.azimuth - target.azimuth).abs() <= 3 && (found.roll - target.roll).abs() <= 3
    });
    // Only one gimbal moves.
    let lines = server.with(|controller, _| controller.log().len());
    let on = GimbalCommand { target: GimbalAngles { azimuth: 0, ..target } };
    assert!(follower.command(&mut driver, &on).unwrap());
    let told = server.with(|controller, _| controller.log()[lines..].to_vec());
    assert!(told.iter().any(|line| line.starts_with("LINEAR @0 0.000000")), "{told:?}");
    assert!(!told.iter().any(|line| line.starts_with("LINEAR @1")), "{told:?}");
    // A set point beyond the limits is refused, each time.
    let far = GimbalCommand { target: GimbalAngles::from_rad(degrees(400.0), degrees(-45.0)) };
    for _ in 0..2 {
        assert!(matches!(follower.command(&mut driver, &far), Err(Error::Angle { .. })));
    }
}
