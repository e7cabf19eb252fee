//! Random spikes and slips: no published parameter moves by more than three of its published σ,
//! whatever the calibration.
//!
//! A point is a calibration of Table 1 in eight positions with one fault, compared with the same
//! calibration without it. Points are numbered: a number always gives the same point.

use octant_calibration::config::TurntableRates;
use octant_calibration::positions::{SEQUENCES, from_degrees, named};
use octant_calibration::schedule::{Cursor, dwell_s};
use octant_earth::units::*;
use octant_random::normal::{uniform, words};
use octant_random::stream::{Phase, key};
use octant_sample::Mode;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::disturbance::{Disturbance, Gimbal, GimbalAction};
use octant_sample::parameters::NAMES;
use octant_test_loop::draws;
use octant_test_loop::instrument::{InstrumentCase, dockside};
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};
use std::collections::BTreeMap;

/// Largest allowed shift of a published parameter, in its published σ.
const SHIFT_SIGMAS_MAX: f64 = 3.0;
/// Number of snapshots of a run without a fault: a point starts from the last one before its fault.
const SNAPSHOTS: u64 = 24;
const EIGHT: &str = "eight";
/// Sequence whose moves turn both gimbals at once.
const BOTH_GIMBALS: &str = "eight-same-plane";

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Setup {
    seed: u64,
    hz: u64,
    hours: u64,
    moored: bool,
    /// Name in `octant_calibration::positions::SEQUENCES`.
    sequence: &'static str,
}

#[derive(Clone, Copy, Debug)]
enum What {
    Nothing,
    /// Spike: channel (gyros, accelerometers), height (deg/h or µg) and length.
    Spike {
        channel: usize,
        height: f64,
        samples: u64,
    },
    /// Slip of the body against its drive within 0.1 s.
    Slip {
        gimbal: Gimbal,
        angle_deg: f64,
        seen: bool,
    },
}

#[derive(Clone, Copy, Debug)]
struct Point {
    setup: Setup,
    what: What,
    at_s: f64,
}

struct Outcome {
    parameters: [f64; 30],
    sigma: [f64; 30],
    published: bool,
    noticed: bool,
    ended: String,
}

fn start(setup: &Setup) -> ClosedLoop {
    let case = InstrumentCase {
        calibration_h: setup.hours as f64,
        ..InstrumentCase::table_1(setup.seed, named(setup.sequence).unwrap())
    };
    let (mut plant, mut core) =
        if setup.moored { dockside(&case) } else { (case.plant(), case.core()) };
    plant.sample_period_ns = 1_000_000_000 / setup.hz;
    plant.calibration_samples = setup.hours * 3600 * setup.hz;
    core.sample_period_ns = plant.sample_period_ns;
    ClosedLoop::new(&plant, &core)
}

fn end(setup: &Setup) -> u64 {
    setup.hours * 3600 * setup.hz
}

fn finish(mut run: ClosedLoop, point: &Point) -> Outcome {
    let hz = point.setup.hz;
    let from = (point.at_s * hz as f64) as u64;
    let (mut sigma, mut noticed, mut carried) = ([f64::NAN; 30], false, 0.0);
    while run.output.sequence < end(&point.setup) {
        if let What::Slip { gimbal, angle_deg, seen } = point.what
            && run.output.sequence == from
        {
            let action = GimbalAction::Slip { angle_rad: angle_deg * DEG, within_s: 0.1, seen };
            run.plant.begin(1, &Disturbance::Gimbal { gimbal, action });
        }
        let output = run.step_altered(|mut sample, aiding| {
            if let What::Spike { channel, height, samples } = point.what
                && (1..=samples).contains(&sample.sequence.saturating_sub(from))
            {
                let (count, lsb) = if channel < 3 {
                    (&mut sample.delta_theta[channel], DEG_PER_HOUR / DELTA_THETA_LSB_RAD)
                } else {
                    (&mut sample.delta_velocity[channel - 3], MICRO_G / DELTA_VELOCITY_LSB_MPS)
                };
                carried += height * lsb / hz as f64;
                let whole = f64::round(carried);
                carried -= whole;
                *count = (f64::from(*count) + whole) as i32;
            }
            Some((sample, aiding))
        });
        noticed |= output.is_some_and(|output| !output.health.is_empty());
        if run.output.sequence.is_multiple_of(hz)
            && let Some(filter) = run.core.filter()
        {
            sigma = filter.parameter_sigmas();
        }
    }
    Outcome {
        parameters: run.core.parameters().to_array(),
        sigma,
        published: run.output.mode == Mode::Done,
        noticed,
        ended: run.core.refusal().map_or("published".to_owned(), |why| format!("refused: {why}")),
    }
}

/// Returns the largest shift of a parameter in its own σ, with its name.
fn shift(faulted: &Outcome, clean: &Outcome) -> (f64, &'static str) {
    (0..30)
        .map(|i| {
            let moved = (faulted.parameters[i] - clean.parameters[i]).abs();
            (moved / faulted.sigma[i], NAMES[i])
        })
        .fold((0.0, ""), |largest, one| if one.0 > largest.0 { one } else { largest })
}

/// Returns starts and ends of all moves, s.
fn moves(sequence: &str, hours: u64) -> Vec<(f64, f64)> {
    let (sequence, period_s) = (from_degrees(named(sequence).unwrap(), 1).unwrap(), 0.01);
    let rates = TurntableRates { rate_radps: 10.0 * DEG, acceleration_radps2: 10.0 * DEG };
    let duration_s = hours as f64 * 3600.0;
    let dwell = dwell_s(&sequence, duration_s, &rates).unwrap();
    let mut cursor = Cursor::new(sequence, Default::default(), rates, dwell, period_s, false);
    let mut all = Vec::new();
    for tick in 0..(duration_s / period_s) as u64 {
        let stop = cursor.stop();
        cursor.advance(tick);
        if cursor.stop() != stop {
            all.push((tick as f64 * period_s, cursor.arrival_s()));
        }
    }
    all
}

/// Draws point `n`: rates, lengths, bases and seeds in turn; every second point is in a move, the
/// moves in turn, the others at any time. Heights and lengths are spread evenly over their decades.
fn draw(n: u64, slip: bool, sequence: &'static str) -> Point {
    let key = key(77, if slip { "slips" } else { "spikes" }, Phase::Draw);
    let u = |i: u64| uniform(words(key, n * 8 + i / 4)[(i % 4) as usize]);
    let setup = Setup {
        seed: 1 + n / 12 % 3,
        hz: [50, 100, 200][(n % 3) as usize],
        hours: [1, 4][(n / 3 % 2) as usize],
        moored: n / 6 % 2 == 1,
        sequence,
    };
    let moves = moves(sequence, setup.hours);
    let at_s = if u(0) < 0.5 {
        let (from, to) = moves[((n / 2) % moves.len() as u64) as usize];
        from - 1.0 + u(1) * (to - from + 2.0)
    } else {
        5.0 + u(1) * (setup.hours as f64 * 3600.0 - 20.0)
    };
    let sign = if u(4) < 0.5 { 1.0 } else { -1.0 };
    let what = if slip {
        What::Slip {
            gimbal: if u(2) < 0.5 { Gimbal::Roll } else { Gimbal::Azimuth },
            angle_deg: sign * 0.01 * 3000f64.powf(u(3)),
            seen: u(5) < 0.5,
        }
    } else {
        let channel = (u(2) * 6.0) as usize;
        let samples = (10.0 * setup.hz as f64).powf(u(3)).round() as u64;
        let height = if channel < 3 { 1e5f64.powf(u(5)) } else { 10.0 * 1e6f64.powf(u(5)) };
        What::Spike { channel, height: sign * height, samples }
    };
    Point { setup, what, at_s }
}

/// Runs points beside their twins; returns the published ones that moved by too much, and prints
/// the sums.
fn try_all(points: &[Point]) -> Vec<String> {
    let mut groups: BTreeMap<Setup, Vec<Point>> = BTreeMap::new();
    for point in points {
        groups.entry(point.setup).or_default().push(*point);
    }
    let (mut failures, mut published, mut noticed, mut worst) = (Vec::new(), 0, 0, 0.0f64);
    for (setup, points) in &groups {
        let mut run = start(setup);
        let mut snapshots = vec![run.clone()];
        for k in 1..SNAPSHOTS {
            run.run_to(end(setup) * k / SNAPSHOTS);
            snapshots.push(run.clone());
        }
        let clean = finish(run, &Point { setup: *setup, what: What::Nothing, at_s: 0.0 });
        assert!(clean.published && !clean.noticed, "{setup:?}: {}", clean.ended);
        let outcomes = on_two_threads(points, |point| {
            let from = (point.at_s * setup.hz as f64) as u64;
            let before = snapshots.iter().rev().find(|run| run.output.sequence <= from).unwrap();
            finish(before.clone(), point)
        });
        for (point, outcome) in points.iter().zip(&outcomes) {
            noticed += u32::from(outcome.noticed);
            if !outcome.published {
                continue;
            }
            published += 1;
            let (sigmas, parameter) = shift(outcome, &clean);
            worst = worst.max(sigmas);
            if !(sigmas <= SHIFT_SIGMAS_MAX) {
                failures.push(format!(
                    "{point:?}: {parameter} moved by {sigmas:.2} σ, noticed: {}",
                    outcome.noticed
                ));
            }
        }
    }
    println!(
        "{} points: {noticed} noticed, {} refused, {published} published, the worst moved by {worst:.2} \
         σ, {} by more than {SHIFT_SIGMAS_MAX}",
        points.len(),
        points.len() - published,
        failures.len()
    );
    failures
}

#[test]
fn spikes_and_slips_at_random() {
    let (spikes, slips) = draws((36, 12), (18, 6));
    let spikes = (0..spikes).map(|n| draw(n, false, EIGHT));
    let points: Vec<Point> = spikes.chain((0..slips).map(|n| draw(n, true, EIGHT))).collect();
    let failures = try_all(&points);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn spikes_where_both_gimbals_turn() {
    let spikes = (0..12).map(|n| draw(n, false, BOTH_GIMBALS));
    let points: Vec<Point> = spikes.chain((0..6).map(|n| draw(n, true, BOTH_GIMBALS))).collect();
    let failures = try_all(&points);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn no_sequence_raises_an_alarm_by_itself() {
    let setups: Vec<Setup> = SEQUENCES
        .iter()
        .enumerate()
        .flat_map(|(n, &(sequence, ..))| {
            let (seed, moored) = (7 + n as u64, n % 2 == 1);
            [20, 50, 200].map(|hz| Setup { seed, hz, hours: 1, moored, sequence })
        })
        .collect();
    assert_clean(&setups);
}

/// Half a second of 200 °/h in a turn moved a scale factor by a hundred σ before edges were
/// screened.
#[test]
fn spikes_in_a_turn_are_taken_back() {
    let setup = Setup { seed: 1, hz: 200, hours: 4, moored: false, sequence: EIGHT };
    let points: Vec<Point> = [20, 100, 400]
        .into_iter()
        .flat_map(|samples| [20.0, 50.0, 100.0, 200.0].map(|height| (samples, height)))
        .map(|(samples, height)| Point {
            setup,
            what: What::Spike { channel: 2, height, samples },
            at_s: 5480.0,
        })
        .collect();
    let failures = try_all(&points);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Study of docs/faults.md, which contains its results.
#[test]
#[ignore = "a study: docs/testing.md"]
fn study_of_three_thousand_points() {
    let spikes = (0..2400).map(|n| draw(n, false, EIGHT));
    let points: Vec<Point> = spikes.chain((0..600).map(|n| draw(n, true, EIGHT))).collect();
    for failure in try_all(&points) {
        println!("{failure}");
    }
}

/// Eighty calibrations without a fault: all rates, lengths and bases.
#[test]
#[ignore = "minutes: run by tests/run"]
fn eighty_clean_calibrations_raise_no_alarm() {
    let setups: Vec<Setup> = (0..draws(80, 48))
        .map(|n| Setup { seed: 1 + n / 12, ..draw(n, false, EIGHT).setup })
        .collect();
    assert_clean(&setups);
}

fn assert_clean(setups: &[Setup]) {
    let outcomes = on_two_threads(setups, |setup| {
        finish(start(setup), &Point { setup: *setup, what: What::Nothing, at_s: 0.0 })
    });
    let alarms: Vec<String> = setups
        .iter()
        .zip(outcomes)
        .filter(|(_, outcome)| outcome.noticed || !outcome.published)
        .map(|(setup, outcome)| format!("{setup:?}: {}", outcome.ended))
        .collect();
    assert!(alarms.is_empty(), "{}", alarms.join("\n"));
}
