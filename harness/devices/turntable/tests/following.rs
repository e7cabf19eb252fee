//! A table that follows a run: it goes to the set points, reports its angles, and stops in every case.

use crate::common::*;
use octant_sample::{GimbalAngles, GimbalCommand};
use octant_turntable::simulate::ControllerBehaviour;
use octant_turntable::{Following, TableAxis, TablePlan, press, stop_by_hand};
use std::time::{Duration, Instant};

fn plan(port: &str) -> TablePlan {
    TablePlan {
        port: port.to_owned(),
        dialect: ensemble(),
        settings: settings(),
        period: Duration::from_millis(10),
        guard: None,
        home: true,
        start: octant_test_processes::HANGS,
        tolerance_rad: degrees(0.001),
        units: 1,
    }
}

fn start(plan: &TablePlan) -> Following {
    Following::start(plan, &mut octant_base::child::command("none")).unwrap()
}

fn set_point(azimuth: f64, roll: f64) -> GimbalCommand {
    GimbalCommand { target: GimbalAngles::from_rad(degrees(azimuth), degrees(roll)) }
}

#[test]
fn it_goes_where_it_is_told_and_says_where_it_was() {
    // In real time, so that the looks can be compared with the true angles.
    let (server, name) = tcp_at(ensemble(), 1.0);
    let mut table = start(&plan(&name));
    let begun = Instant::now();
    let homed = server.with(|controller, _| {
        controller.log().iter().filter(|line| line.starts_with("PROGRAM RUN")).count()
    });
    assert_eq!(homed, 2);
    let (mut compared, mut moves) = (0, 0);
    for (azimuth, roll) in [(0.0, 12.0), (-7.0, 12.0), (0.0, 0.0)].into_iter().cycle() {
        // A busy host looks seldom: the moves are repeated until there were enough comparisons.
        if moves >= 3 && (compared > 10 || begun.elapsed() > octant_test_processes::HANGS) {
            break;
        }
        moves += 1;
        table.command(&set_point(azimuth, roll));
        wait_for("the move", || {
            table.take_looks();
            // True angles before and after a moment: the turn between them is a tolerance of the
            // comparison.
            let before = angle(&server, TableAxis::Roll);
            let when = Instant::now();
            let after = angle(&server, TableAxis::Roll);
            if let Some(place) = table.at(TableAxis::Roll, when)
                && place.age < Duration::from_millis(50)
            {
                // Tolerance beyond the last look: a·t²/2 with 30 °/s². The time of a look is the middle
                // of query and reply: the angle may be wrong by a turn of 20 °/s for half of that, and
                // the rate accordingly.
                let (age_s, within_s) = (place.age.as_secs_f64(), place.within.as_secs_f64());
                let missed = 15.0 * (age_s + within_s).powi(2) + 1e-4;
                // The rate is queried a moment after the angle.
                let moment = 20.0 * within_s + 30.0 * 4.0 * within_s * age_s;
                let found = place.angle_rad.to_degrees();
                let (least, most) = (before.min(after), before.max(after));
                assert!(
                    found >= least - missed - moment && found <= most + missed + moment,
                    "{found} {least} {most} {place:?}"
                );
                compared += 1;
            }
            let there = |axis, expected: f64| (angle(&server, axis) - expected).abs() < 1e-5;
            there(TableAxis::Azimuth, azimuth) && there(TableAxis::Roll, roll)
        });
    }
    assert!(compared > 10, "{compared}");
    assert_eq!(table.traffic().commands, moves);
    assert_eq!(table.stopped(), None);
    table.finish().unwrap();
    assert!(rests(&server));
}

#[test]
fn what_is_beyond_its_limits_stops_it() {
    let (server, name) = tcp_at(ensemble(), 1.0);
    let table = start(&plan(&name));
    table.command(&set_point(0.0, 300.0));
    wait_for("the turn", || turns(&server, TableAxis::Roll));
    table.command(&set_point(0.0, 500.0));
    wait_for("the stop", || table.is_stopped());
    assert_eq!(table.stopped().unwrap(), "roll 500.0000° is beyond its limits, -185° to 365°");
    wait_for("rest", || rests(&server));
    // Later set points move nothing.
    table.command(&set_point(0.0, 10.0));
    let commands = table.traffic().commands;
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(table.traffic().commands, commands);
}

#[test]
fn who_drops_it_stops_it_and_so_does_a_silent_controller() {
    let (server, name) = tcp_at(ensemble(), 1.0);
    let table = start(&plan(&name));
    table.command(&set_point(0.0, 300.0));
    wait_for("the turn", || turns(&server, TableAxis::Roll));
    drop(table);
    wait_for("rest", || rests(&server));

    let table = start(&plan(&name));
    table.command(&set_point(0.0, 300.0));
    wait_for("the turn", || turns(&server, TableAxis::Roll));
    server.with(|controller, _| controller.behave(ControllerBehaviour::Silent));
    wait_for("the stop", || table.is_stopped());
    assert!(table.stopped().unwrap().contains("no reply to"), "{:?}", table.stopped());
    wait_for("rest", || rests(&server));
}

#[test]
fn a_table_that_does_not_arrive_does_not_start() {
    let (server, name) = tcp_at(ensemble(), 1.0);
    let mut hasty = plan(&name);
    let table = start(&hasty);
    table.command(&set_point(0.0, 20.0));
    wait_for("the way", || angle(&server, TableAxis::Roll) > 15.0);
    drop(table);
    wait_for("rest", || rests(&server));
    // The table was stopped at some angle: the way to zero takes longer than permitted, on any host.
    (hasty.start, hasty.home) = (Duration::from_millis(300), false);
    hasty.settings.limits.axes[1].rate_radps = degrees(0.1);
    let error =
        Following::start(&hasty, &mut octant_base::child::command("none")).unwrap_err().to_string();
    assert!(error.ends_with("the table still moves after 300ms"), "{error}");
    let mut narrow = plan(&name);
    narrow.settings.limits.axes[1].least_rad = degrees(5.0);
    let error = Following::start(&narrow, &mut octant_base::child::command("none"))
        .unwrap_err()
        .to_string();
    assert_eq!(error, "roll 0.0000° is beyond its limits, 5° to 365°");
}

/// Connections that say nothing, more of them than have a place.
#[cfg(unix)]
#[test]
fn silent_connections_hold_up_no_stop() {
    let (server, name) = tcp_at(ensemble(), 1.0);
    let table = start(&plan(&name));
    let hash = name.bytes().fold(0xCBF2_9CE4_8422_2325u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
    });
    let place = format!("/tmp/octant-tables/{hash:016x}");
    let silent: Vec<_> =
        (0..40).map(|_| std::os::unix::net::UnixStream::connect(&place).unwrap()).collect();
    let pressed = press(Some(&name)).unwrap();
    assert!(pressed[0].written && table.is_stopped());
    drop((silent, server));
}

/// The controller accepts one peer at a time: only the driving program can stop it.
#[cfg(unix)]
#[test]
fn another_program_can_press_the_stop() {
    let (server, name) = tcp_at(ensemble(), 1.0);
    assert_eq!(press(Some(&name)).unwrap(), []);
    let table = start(&plan(&name));
    let error = Following::start(&plan(&name), &mut octant_base::child::command("none"));
    // The second one isn't served: the controller listens to the first.
    assert!(error.is_err());
    assert!(!table.is_stopped());
    table.command(&set_point(0.0, 300.0));
    wait_for("the turn", || turns(&server, TableAxis::Roll));
    let told = stop_by_hand(&name, &ensemble()).unwrap();
    assert_eq!(told[0], format!("the program that drives {name}"));
    wait_for("rest", || rests(&server));
    assert_eq!(table.stopped().unwrap(), "stop command on the command line");
    drop(table);
    assert_eq!(press(Some(&name)).unwrap(), []);
}
