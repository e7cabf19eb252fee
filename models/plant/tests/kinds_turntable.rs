//! Kinds of faults of gimbals, drives and encoders against independent closed forms of their
//! documentation.

use super::common::bench::*;
use super::common::*;
use octant_earth::units::{ARCSEC, DEG};
use octant_faults::Value;
use octant_faults::catalogue::Dimension::*;
use octant_plant::Plant;
use octant_sample::Status;
use octant_sample::counts::{DELTA_THETA_LSB_RAD as RAD, GIMBAL_LSB_RAD};
use std::f64::consts::PI;

const ROLL: (&str, Value) = ("gimbal", Value::Choice("roll"));

fn roll(degrees: f64) -> octant_sample::GimbalCommand {
    command(0.0, degrees)
}

/// Checks that gyros, accelerometers and truth are bit for bit those of the twin.
fn nothing_moves(pairs: &[Pair]) {
    for pair in pairs {
        assert_eq!(pair.step.sample.delta_theta, pair.twin.sample.delta_theta);
        assert_eq!(pair.step.sample.delta_velocity, pair.twin.sample.delta_velocity);
        assert_eq!(pair.step.aiding, pair.twin.aiding);
        assert_eq!(pair.truth, pair.twin_truth);
    }
}

/// Difference of the encoder's reading from that of the twin, counts.
fn encoder(pair: &Pair) -> i32 {
    pair.step.sample.gimbal.roll - pair.twin.sample.gimbal.roll
}

fn truth(pair: &Pair) -> f64 {
    pair.truth.gimbal_rad[1]
}

#[test]
fn a_slip_is_felt_and_stays_and_the_encoder_sees_it_or_not() {
    let angle = 0.5 * DEG;
    for seat in ["drive", "body"] {
        let spec = fault(
            "gimbal-slip",
            &[
                ROLL,
                ("angle", quantity(angle, Angle)),
                ("within", quantity(0.2, Time)),
                ("encoder", Value::Choice(seat)),
            ],
            101,
            1,
        );
        let to = |k| if k < 400 { roll(0.0) } else { roll(10.0) };
        let pairs = run_pair(&noisy(), &[spec], 1000, to);
        nothing_before(&pairs, 101);
        let felt = gathered(&pairs, 0);
        for (k, pair) in pairs.iter().enumerate() {
            let slipped = angle * rise((k as f64 - 99.0) * DT / 0.2).0;
            assert!((truth(pair) - pair.twin_truth.gimbal_rad[1] - slipped).abs() < 1e-15);
            assert!((felt[k] - slipped).abs() <= 1.01 * RAD, "{k}");
            let seen = if seat == "body" { slipped / GIMBAL_LSB_RAD } else { 0.0 };
            // Each reading is rounded on its own.
            assert!((f64::from(encoder(pair)) - seen).abs() <= 1.0, "{k} {seen}");
        }
        // Every later position is wrong by the slip.
        assert!((truth(&pairs[999]) - (to(1000).target.roll_rad() + angle)).abs() < 1e-15);
    }
}

/// An encoder that slipped by some angle reads the same as one that was turned by it.
#[test]
fn an_encoder_slip_turns_the_encoder_alone() {
    let mut config = noisy();
    config.turntable.encoder_sigma_rad = 18.0 * ARCSEC;
    let counts = 123_456;
    let angle = f64::from(counts) * GIMBAL_LSB_RAD;
    let spec = fault("encoder-slip", &[ROLL, ("angle", quantity(angle, Angle))], 501, 1000);
    let pairs = run_pair(&config, &[spec], 2000, |_| roll(20.0));
    nothing_before(&pairs, 501);
    nothing_moves(&pairs);
    nothing_after(&pairs, 1501);
    let mut turned = Plant::new(&config).unwrap();
    let mut there = roll(20.0);
    there.target.roll += counts;
    let expected = run(&mut turned, &there, 1500)[1499].sample.gimbal.roll;
    assert_eq!(pairs[1499].step.sample.gimbal.roll, expected);
    assert!(
        pairs[500..1500]
            .iter()
            .all(|pair| encoder(pair) != 0 && pair.step.sample.status.is_empty())
    );
}

#[test]
fn an_encoder_without_index_counts_from_zero() {
    for flagged in [true, false] {
        let spec = fault("index-loss", &[ROLL, ("flagged", Value::Flag(flagged))], 701, 600);
        let to = |k| if k < 850 { roll(20.0) } else { roll(30.0) };
        let pairs = run_pair(&noisy(), &[spec], 1500, to);
        nothing_before(&pairs, 701);
        nothing_moves(&pairs);
        nothing_after(&pairs, 1301);
        let lost = &pairs[700..1300];
        // At 20° the encoder starts from zero, at 30° it reads 10°.
        assert_eq!(lost[0].step.sample.gimbal.roll, 0);
        let ten = roll(30.0).target.roll - roll(20.0).target.roll;
        assert_eq!(lost[599].step.sample.gimbal.roll, ten);
        for pair in lost {
            assert_eq!(encoder(pair), -roll(20.0).target.roll);
            let expected = if flagged { Status::GIMBAL_INVALID } else { Status::empty() };
            assert_eq!(pair.step.sample.status, expected);
        }
    }
}

#[test]
fn backlash_lags_by_half_of_the_play_and_closes() {
    let play = 40.0 * ARCSEC;
    let spec = fault("backlash", &[ROLL, ("play", quantity(play, SmallAngle))], 101, 1900);
    let to = |k| match k {
        0..200 => roll(0.0),
        200..1000 => roll(10.0),
        _ => roll(5.0),
    };
    let pairs = run_pair(&noisy(), &[spec], 2600, to);
    nothing_before(&pairs, 101);
    for (k, lag) in [(150, 0.0), (800, -0.5), (1800, 0.5)] {
        let body = truth(&pairs[k]) - pairs[k].twin_truth.gimbal_rad[1];
        assert!((body - lag * play).abs() < 1e-15, "{k}");
    }
    // The body rests until the drive has turned by half of the play: ½ a t² with 10 °/s².
    let delay = (play / (10.0 * DEG)).sqrt();
    let stands = (delay / DT) as usize;
    assert_eq!(truth(&pairs[199 + stands]), 0.0);
    assert!(truth(&pairs[201 + stands]) > 0.0);
    // Sample 2001 is the first after the end; 0.1 s later the play has closed.
    let felt = gathered(&pairs, 0);
    for k in 0..40 {
        let left = 0.5 * play * (1.0 - rise(f64::from(k + 1) * DT / 0.1).0);
        let pair = &pairs[2000 + k as usize];
        assert!((truth(pair) - pair.twin_truth.gimbal_rad[1] - left).abs() < 1e-15, "{k}");
        assert!((felt[2000 + k as usize] - left).abs() <= 1.01 * RAD, "{k}");
    }
    assert!(pairs.iter().all(|pair| encoder(pair) == 0));
    let sums = |channel| {
        let all = gathered(&pairs[2021..], channel);
        all.into_iter().fold(0.0f64, |worst, sum| worst.max(sum.abs()))
    };
    assert!(sums(0) <= RAD && sums(1) <= RAD && sums(2) <= RAD);
}

/// Brakes from 10 °/s with 10 °/s² in 1 s and 5°; later completes the way as from rest.
#[test]
fn a_stalled_drive_stands_and_goes_on_when_it_can() {
    let spec = fault("stall", &[ROLL], 601, 1400);
    let to = |k| if k < 1500 { roll(90.0) } else { roll(60.0) };
    let pairs = run_pair(&perfect(), &[spec], 4000, to);
    nothing_before(&pairs, 601);
    // The move begins with sample 2; at sample 600 it is 599 periods old.
    let at_onset = 10.0 * (599.0 * DT - 0.5);
    for k in [801, 1500, 1999] {
        assert!((truth(&pairs[k]) - (at_onset + 5.0) * DEG).abs() < 1e-8, "{k}");
        assert_eq!(pairs[k].truth.gimbal_rad, pairs[801].truth.gimbal_rad);
        assert_eq!(pairs[k].step.sample.gimbal.roll, pairs[801].step.sample.gimbal.roll);
    }
    let braking = (truth(&pairs[700]) / DEG - at_onset) - (10.0 * 0.505 - 5.0 * 0.505 * 0.505);
    assert!(braking.abs() < 1e-7, "{braking}");
    // 60° − 34.95° take 1 s + their degrees / 10 °/s.
    let way = 60.0 - at_onset - 5.0;
    let arrival = 2000.0 + (1.0 + way / 10.0) / DT;
    let before = &pairs[arrival.floor() as usize - 2];
    assert!(truth(before) < 60.0 * DEG - 1e-7);
    assert_eq!(truth(&pairs[arrival.ceil() as usize]), roll(60.0).target.roll_rad());
    assert_eq!(pairs[3999].step.sample.gimbal, roll(60.0).target);
}

#[test]
fn a_stall_in_a_dwell_shows_at_the_next_move() {
    let spec = fault("stall", &[ROLL], 101, 400);
    let to = |k| if k < 300 { roll(0.0) } else { roll(-10.0) };
    let pairs = run_pair(&noisy(), &[spec], 1200, to);
    for pair in &pairs[..300] {
        assert!(pair.is_twin());
    }
    assert!(pairs[300..500].iter().all(|pair| truth(pair) == 0.0));
    assert_eq!(pairs[1100].step.sample.gimbal, roll(-10.0).target);
    // The gyros' total is the total turn.
    let felt = gathered(&pairs, 0);
    assert!(felt[1199].abs() < 2.0 * RAD);
}

/// From rest with 10 °/s² to −15 °/s, constant, and back.
#[test]
fn a_runaway_runs_and_comes_back() {
    let rate = ("rate", quantity(-15.0 * DEG, AngularRate));
    let spec = fault("runaway", &[ROLL, rate], 201, 800);
    let pairs = run_pair(&noisy(), &[spec], 3000, |_| roll(0.0));
    nothing_before(&pairs, 201);
    for (k, pair) in pairs[..1000].iter().enumerate().skip(200) {
        let t = (k as f64 - 199.0) * DT;
        let angle = if t < 1.5 { 5.0 * t * t } else { 11.25 + 15.0 * (t - 1.5) };
        assert!((truth(pair) + angle * DEG).abs() < 1e-13, "{k}");
        let counts = f64::from(pair.step.sample.gimbal.roll);
        assert!((counts * GIMBAL_LSB_RAD + angle * DEG).abs() <= 0.51 * GIMBAL_LSB_RAD);
    }
    // 4 s: 48.75°; brakes 1.5 s, 11.25°; 60° back in 7 s.
    let farthest = pairs.iter().map(truth).fold(0.0, f64::min);
    assert!((farthest + 60.0 * DEG).abs() < 1e-12, "{farthest}");
    assert!(truth(&pairs[2697]) < -1e-7);
    nothing_after(&pairs, 2701);
    let felt = gathered(&pairs, 0);
    assert!((felt[999] - truth(&pairs[999])).abs() <= 1.01 * RAD);
    assert!(felt[2999].abs() <= 1.01 * RAD);
}

#[test]
fn an_overshoot_goes_beyond_and_comes_back() {
    let beyond = 0.4 * DEG;
    let spec = fault("overshoot", &[ROLL, ("angle", quantity(beyond, Angle))], 101, 500);
    let to = |k| match k {
        0..200 => roll(0.0),
        200..1500 => roll(40.0),
        _ => roll(20.0),
    };
    let pairs = run_pair(&noisy(), &[spec], 2500, to);
    // No effect until the next move.
    assert!(pairs[..200].iter().all(Pair::is_twin));
    let target = to(200).target.roll_rad();
    let farthest = pairs.iter().map(truth).fold(0.0, f64::max);
    // Seen at stamps: within ½ a dt² of the turning point.
    assert!(farthest <= target + beyond + 1e-15);
    assert!(farthest > target + beyond - 5.0 * DEG * DT * DT);
    // 40.4° in 5.04 s, and 0.4° back in 2 √(0.4/10) = 0.4 s. The move begins with sample 201.
    let arrival = 200 + (5.44 / DT) as usize;
    assert!(truth(&pairs[arrival - 2]) > target + 1e-8);
    assert_eq!(truth(&pairs[arrival]), target);
    // The move after the end of the fault has no overshoot; no effect remains.
    nothing_after(&pairs, arrival as u64 + 2);
    let felt = gathered(&pairs, 0);
    let moved = truth(&pairs[1240]) - pairs[1240].twin_truth.gimbal_rad[1];
    assert!((felt[1240] - moved).abs() <= 1.01 * RAD);
}

#[test]
fn the_body_rings_after_the_move() {
    let (amplitude, frequency, decay) = (20.0 * ARCSEC, 4.0, 0.3);
    let spec = fault(
        "short-settle",
        &[
            ROLL,
            ("amplitude", quantity(amplitude, SmallAngle)),
            ("frequency", quantity(frequency, Frequency)),
            ("decay", quantity(decay, Time)),
        ],
        101,
        800,
    );
    let to = |k| match k {
        0..200 => roll(0.0),
        200..3500 => roll(10.0),
        _ => roll(0.0),
    };
    let pairs = run_pair(&noisy(), &[spec], 4500, to);
    assert!(pairs[..600].iter().all(Pair::is_twin));
    let felt = gathered(&pairs, 0);
    // The set point is 10° to half a count, by which the end of the move shifts.
    let way = roll(10.0).target.roll_rad() / DEG;
    let end = 200.0 * DT + 1.0 + way / 10.0;
    for k in 600..4500 {
        let t = (k as f64 + 1.0) * DT - end;
        let ring = if t < 0.0 || t > 30.0 * decay {
            0.0
        } else {
            let swell = rise(4.0 * frequency * t).0;
            amplitude * swell * (-t / decay).exp() * (2.0 * PI * frequency * t).sin()
        };
        let pair: &Pair = &pairs[k];
        assert!((truth(pair) - pair.twin_truth.gimbal_rad[1] - ring).abs() < 1e-15, "{k}");
        assert!((felt[k] - ring).abs() <= 1.01 * RAD, "{k}");
        assert_eq!(encoder(pair), 0);
    }
    let largest = felt.iter().fold(0.0f64, |most, angle| most.max(angle.abs()));
    assert!(largest > 0.7 * amplitude);
    // 30 τ after the move, and the next one, which begins after the fault's end, doesn't ring.
    nothing_after(&pairs, 200 + 400 + 1800 + 2);
}
