//! Set points on their way to the turntable.

use crate::common::{Outcome, clean, fault, run_with};
use octant_faults::catalogue::Dimension;
use octant_faults::trigger::{Repeat, Trigger};
use octant_faults::{FaultSpec, Value};
use octant_sample::{GimbalAngles, GimbalCommand, Mode, Output};

/// Set points of the stops, azimuth and roll.
const STOPS: [(i32, i32); 7] =
    [(0, 0), (0, 1000), (0, 2000), (500, 2000), (900, 2000), (900, 1500), (0, 0)];

fn set_point(stop: usize) -> GimbalCommand {
    let (azimuth, roll) = STOPS[stop];
    GimbalCommand { target: GimbalAngles { azimuth, roll } }
}

/// A core that sets out for a stop every 100 epochs and arrives 20 later: its answer to epoch 100 n
/// has stop n.
fn core(k: u64) -> Output {
    let stop = (k / 100).min(6);
    Output {
        mode: Mode::Calibrating,
        stop: stop as u16,
        moving: k % 100 < 20 && (1..=6).contains(&(k / 100)),
        gimbal_command: set_point(stop as usize),
        ..Output::default()
    }
}

fn run(spec: FaultSpec) -> Outcome {
    let outcome = run_with(&[spec], 800, core);
    assert!(outcome.delivered.iter().all(|(at, epoch)| epoch.same_bits(&clean(*at))));
    outcome
}

/// Set point that the core commands at an epoch.
fn wanted(epoch: u64) -> GimbalCommand {
    core(epoch - 1).gimbal_command
}

/// Each stretch in which the set point differs from the core's, as first epoch, last epoch and set
/// point.
fn departures(outcome: &Outcome) -> Vec<(u64, u64, (i32, i32))> {
    let mut found: Vec<(u64, u64, (i32, i32))> = Vec::new();
    for (k, command) in (1u64..).zip(&outcome.commands) {
        if *command == wanted(k) {
            continue;
        }
        let got = (command.target.azimuth, command.target.roll);
        match found.last_mut() {
            Some((_, last, set)) if *last + 1 == k && *set == got => *last = k,
            _ => found.push((k, k, got)),
        }
    }
    let altered: u64 = found.iter().map(|(first, last, _)| last - first + 1).sum();
    assert_eq!(outcome.receipts[0].samples_altered, altered);
    found
}

fn moving_to(stop: u16) -> Trigger {
    Trigger::Move { stop, mode: Mode::Calibrating, delay: 0 }
}

fn positions(kind: &str, positions: i64, first: u64) -> FaultSpec {
    let mut spec = fault(kind, &[("positions", Value::Integer(positions))], first, 1);
    spec.schedule.duration = None;
    spec
}

#[test]
fn a_position_is_skipped() {
    // From a dwell on: the next new stop is the third, commanded from epoch 301 to 400.
    let expected = [(301, 400, STOPS[2])];
    assert_eq!(departures(&run(positions("skipped-position", 1, 250))), expected);
    // From the epoch on at which the stop is new.
    let mut spec = positions("skipped-position", 1, 1);
    spec.schedule.trigger = moving_to(3);
    assert_eq!(departures(&run(spec)), expected);
    let two = departures(&run(positions("skipped-position", 2, 250)));
    assert_eq!(two, [(301, 500, STOPS[2])]);
}

#[test]
fn a_skip_that_ends_goes_to_the_set_point_of_that_moment() {
    let mut spec = positions("skipped-position", 1, 250);
    spec.schedule.duration = Some(80);
    assert_eq!(departures(&run(spec)), [(301, 329, STOPS[2])]);
}

#[test]
fn each_onset_skips_one() {
    let mut spec = positions("skipped-position", 1, 150);
    spec.schedule.duration = Some(200);
    spec.schedule.repeat = Repeat::Times { times: 2, every: 200 };
    // The first ignores stop 2 until stop 3 comes, the second stop 4 until 5.
    assert_eq!(departures(&run(spec)), [(201, 300, STOPS[1]), (401, 500, STOPS[3])]);
}

#[test]
fn a_position_is_repeated() {
    // Instead of going to stop 3 the turntable returns from stop 2 to stop 1.
    let expected = [(301, 400, STOPS[1])];
    assert_eq!(departures(&run(positions("repeated-position", 1, 250))), expected);
    let mut spec = positions("repeated-position", 1, 1);
    spec.schedule.trigger = moving_to(3);
    assert_eq!(departures(&run(spec)), expected);
    let two = departures(&run(positions("repeated-position", 2, 250)));
    assert_eq!(two, [(301, 500, STOPS[1])]);
}

#[test]
fn without_a_position_before_it_stays() {
    let first = departures(&run(positions("repeated-position", 1, 1)));
    assert_eq!(first, [(101, 200, STOPS[0])]);
}

fn direction(gimbal: &'static str) -> FaultSpec {
    fault("wrong-direction", &[("gimbal", Value::Choice(gimbal))], 250, 200)
}

#[test]
fn moves_go_the_other_way() {
    // From stop 2 at (0, 2000): 500 becomes -500, 900 becomes -900; the roll isn't moved.
    let mirrored = [(301, 400, (-500, 2000)), (401, 449, (-900, 2000))];
    assert_eq!(departures(&run(direction("both"))), mirrored);
    assert_eq!(departures(&run(direction("azimuth"))), mirrored);
    let mut spec = direction("both");
    spec.schedule.trigger = moving_to(3);
    assert_eq!(departures(&run(spec)), [(301, 400, (-500, 2000)), (401, 500, (-900, 2000))]);
    // From stop 4 at (900, 2000) roll falls by 500, and with the fault rises by as much.
    let mut spec = direction("roll");
    spec.schedule.trigger = Trigger::Epoch(450);
    assert_eq!(departures(&run(spec)), [(501, 600, (900, 2500)), (601, 649, (0, 4000))]);
}

#[test]
fn a_mirrored_set_point_saturates() {
    let core = |k: u64| {
        let roll = if k < 50 { i32::MIN } else { i32::MAX };
        let target = GimbalAngles { azimuth: 0, roll };
        Output { gimbal_command: GimbalCommand { target }, ..Output::default() }
    };
    let spec = fault("wrong-direction", &[("gimbal", Value::Choice("both"))], 20, 60);
    let outcome = run_with(&[spec], 100, core);
    assert_eq!(outcome.commands[60].target.roll, i32::MIN);
}

#[test]
fn set_points_come_late() {
    let delay = ("delay", Value::Quantity(0.15, Dimension::Time));
    let late = |first, epochs| departures(&run(fault("command-late", &[delay], first, epochs)));
    // 0.15 s are 30 epochs.
    let expected = [(301, 330, STOPS[2]), (401, 430, STOPS[3])];
    assert_eq!(late(250, 200), expected);
    // The fault begins 10 epochs before a change and ends 15 after another: at the end there is no
    // delay any more.
    assert_eq!(late(291, 125), [(301, 330, STOPS[2]), (401, 415, STOPS[3])]);
    // The fault begins after the change: the set point from before the onset isn't taken back.
    assert!(late(310, 60).is_empty());
}

#[test]
fn lost_set_points_are_missed_until_the_end() {
    let lost = |first, epochs| departures(&run(fault("command-lost", &[], first, epochs)));
    assert_eq!(lost(250, 200), [(301, 449, STOPS[2])]);
    assert_eq!(lost(301, 10), [(301, 310, STOPS[2])]);
    assert!(lost(310, 50).is_empty(), "in a dwell nothing is missed");
}

#[test]
fn the_turntable_is_what_counts_for_the_next_fault() {
    // While set points are lost the turntable stays at stop 2, from where the next fault starts.
    let mut skip = positions("skipped-position", 1, 420);
    skip.id = "skip".into();
    let outcome = run_with(&[fault("command-lost", &[], 250, 160), skip], 800, core);
    let at =
        |k: usize| (outcome.commands[k - 1].target.azimuth, outcome.commands[k - 1].target.roll);
    assert_eq!(
        (at(350), at(405), at(415), at(501), at(601)),
        (STOPS[2], STOPS[2], STOPS[4], STOPS[4], STOPS[6])
    );
}

#[test]
fn a_set_point_that_changes_alone_is_known() {
    // A core that doesn't report its stops: only the set point shows that it went on.
    let silent = |k: u64| Output { gimbal_command: core(k).gimbal_command, ..Output::default() };
    let outcome = run_with(&[fault("command-lost", &[], 350, 80)], 800, silent);
    assert_eq!(departures(&outcome), [(401, 429, STOPS[3])]);
}
