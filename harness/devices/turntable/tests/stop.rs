//! The table stops when the harness ends, is killed or hangs, and when the line is cut.

use crate::common::*;
use octant_turntable::simulate::ControllerBehaviour;
use octant_turntable::{DriverSettings, Supervisor, TableAxis, Turntable};
use std::time::Duration;

#[test]
fn a_dropped_driver_stops_it() {
    let (server, name) = tcp(ensemble());
    let mut driver = drive(&name, ensemble(), settings());
    driver.rate(TableAxis::Roll, degrees(1.0)).unwrap();
    wait_for("the rate", || turns(&server, TableAxis::Roll));
    drop(driver);
    wait_for("rest", || rests(&server));
}

#[test]
fn whoever_has_the_stop_can_trip_it() {
    let (server, name) = tcp(ensemble());
    let mut driver = drive(&name, ensemble(), settings());
    let stop = driver.emergency();
    driver.rate(TableAxis::Azimuth, degrees(1.0)).unwrap();
    // Slow, so that the move is still in progress at any look.
    driver.goto(TableAxis::Roll, degrees(300.0), Some(degrees(1.0))).unwrap();
    wait_for("both", || TableAxis::ALL.iter().all(|axis| turns(&server, *axis)));
    // Tripped from another thread, while the driver is busy with queries.
    let tripping = std::thread::spawn(move || stop.trip("the button"));
    for _ in 0..20 {
        driver.status().unwrap();
    }
    assert!(tripping.join().unwrap());
    wait_for("rest", || rests(&server));
    assert!(driver.goto(TableAxis::Roll, 0.0, None).is_err());
    // A stop is always permitted.
    driver.stop().unwrap();
}

/// The line is dead in both directions: only the controller can stop the table.
fn watched(behaviour: ControllerBehaviour) {
    // In real time: a host that is busy for seconds would feed the watchdog too late.
    let (server, name) = tcp_at(ensemble(), 1.0);
    let watched = DriverSettings { watchdog: Some(Duration::from_secs(5)), ..settings() };
    let driver = drive(&name, ensemble(), watched);
    let mut table = Supervisor::new(driver, Duration::from_millis(10)).unwrap();
    table.rate(TableAxis::Azimuth, degrees(2.0)).unwrap();
    wait_for("the rate", || turns(&server, TableAxis::Azimuth));
    server.with(|controller, _| controller.behave(behaviour));
    wait_for("rest", || rests(&server));
    wait_for("the fault", || table.fault().is_some());
    // The error was noticed: nothing is moved any more.
    assert!(table.goto(TableAxis::Azimuth, 0.0, None).is_err());
}

#[test]
fn the_watchdog_stops_it_when_nothing_is_heard() {
    std::thread::scope(|scope| {
        for behaviour in [ControllerBehaviour::Deaf, ControllerBehaviour::HangUp] {
            scope.spawn(|| watched(behaviour));
        }
    });
}

#[test]
fn a_silent_controller_is_told_to_stop() {
    let (server, name) = tcp(ensemble());
    let driver = drive(&name, ensemble(), settings());
    let mut table = Supervisor::new(driver, Duration::from_millis(10)).unwrap();
    table.rate(TableAxis::Roll, degrees(1.0)).unwrap();
    wait_for("the rate", || turns(&server, TableAxis::Roll));
    server.with(|controller, _| controller.behave(ControllerBehaviour::Silent));
    // The table stops without an answer from it, and without a watchdog.
    wait_for("rest", || rests(&server));
    wait_for("the fault", || table.fault().is_some());
    assert!(table.fault().unwrap().contains("no reply to"));
}

#[test]
fn the_end_leaves_it_at_rest() {
    let (server, name) = tcp(ensemble());
    let watched = DriverSettings { watchdog: Some(Duration::from_secs(600)), ..settings() };
    let driver = drive(&name, ensemble(), watched);
    let mut table = Supervisor::new(driver, Duration::from_millis(10)).unwrap();
    table.rate(TableAxis::Roll, degrees(1.0)).unwrap();
    wait_for("the rate", || turns(&server, TableAxis::Roll));
    table.finish().unwrap();
    assert!(rests(&server));
    // The watchdog was switched off, so that it causes no fault later.
    assert!(
        server.with(|controller, _| controller.log().iter().any(|line| line == "IGLOBAL(34) = 0"))
    );
}

#[cfg(unix)]
mod processes {
    use super::*;
    use octant_test_processes::{Started, command};
    use std::process::{Child, Stdio};

    const ADDRESS: &str = "OCTANT_TABLE_UNDER_TEST";
    const GUARDED: &str = "OCTANT_TABLE_GUARDED";

    /// Harness for the tests below, in a separate process: turns the table until it is ended.
    #[test]
    #[ignore = "run by the other tests"]
    fn harness() {
        let Ok(name) = std::env::var(ADDRESS) else { return };
        octant_turntable::on_signals().unwrap();
        let mut driver = drive(&name, ensemble(), settings());
        if std::env::var_os(GUARDED).is_some() {
            // A guard outlives what it guards: no command of the tests.
            let program = env!("CARGO_BIN_EXE_octant-turntable");
            let mut program = octant_base::child::command(program);
            driver.guard(program.arg("guard"), Duration::from_secs(5)).unwrap();
        }
        driver.rate(TableAxis::Roll, degrees(0.5)).unwrap();
        loop {
            driver.feed().unwrap();
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    fn start(name: &str, guarded: bool) -> Started {
        start_with(name, guarded, Stdio::null())
    }

    fn start_with(name: &str, guarded: bool, stderr: Stdio) -> Started {
        let mut command = command(std::env::current_exe().unwrap());
        command.args(["--exact", "stop::processes::harness", "--ignored", "--nocapture"]);
        command.env(ADDRESS, name).stdout(Stdio::null()).stderr(stderr);
        if guarded {
            command.env(GUARDED, "1");
        }
        octant_test_processes::start(&mut command)
    }

    fn signal(child: &Child, signal: &str) {
        let status = command("kill").args([signal, &child.id().to_string()]).status().unwrap();
        assert!(status.success());
    }

    fn ended_by(signal_name: &str, guarded: bool) {
        let (server, name) = tcp(ensemble());
        let mut child = start(&name, guarded);
        wait_for("the rate", || turns(&server, TableAxis::Roll));
        // The guard is already running: it is started before the table turns.
        signal(&child, signal_name);
        wait_for("rest", || rests(&server));
        if signal_name == "-STOP" {
            signal(&child, "-KILL");
        }
        let status = child.wait().unwrap();
        assert!(!status.success());
    }

    #[test]
    fn signals_stop_it() {
        for name in ["-TERM", "-INT", "-HUP", "-QUIT"] {
            ended_by(name, false);
        }
    }

    #[test]
    fn the_guard_stops_it_when_the_harness_is_killed() {
        ended_by("-KILL", true);
    }

    #[test]
    fn the_guard_stops_it_when_the_harness_hangs() {
        ended_by("-STOP", true);
    }

    #[test]
    fn a_harness_that_goes_on_after_a_pause_is_told_that_the_guard_has_acted() {
        let (server, name) = tcp(ensemble());
        let mut child = start_with(&name, true, Stdio::piped());
        wait_for("the rate", || turns(&server, TableAxis::Roll));
        signal(&child, "-STOP");
        wait_for("rest", || rests(&server));
        signal(&child, "-CONT");
        let mut said = String::new();
        std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut said).unwrap();
        assert!(!child.wait().unwrap().success());
        let expected = "it stopped the table, because this program gave no sign of life for 5 s";
        assert!(said.contains(expected), "{said}");
    }

    #[test]
    fn by_hand() {
        let (server, name) = tcp(ensemble());
        let mut child = start(&name, false);
        wait_for("the rate", || turns(&server, TableAxis::Roll));
        signal(&child, "-KILL");
        child.wait().unwrap();
        // Without guard and watchdog the table continues to turn.
        assert!(turns(&server, TableAxis::Roll));
        let program = env!("CARGO_BIN_EXE_octant-turntable");
        let status = command(program).args(["stop", &name]).status().unwrap();
        assert!(status.success());
        wait_for("rest", || rests(&server));
        let status =
            command(program).args(["stop", "tcp:127.0.0.1:1"]).stderr(Stdio::null()).status();
        assert_eq!(status.unwrap().code(), Some(4));
    }
}
