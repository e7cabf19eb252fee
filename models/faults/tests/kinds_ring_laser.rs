//! Every ring laser kind alters samples as documented, by independent arithmetic.

use crate::common::counts::*;
use crate::common::{fault, run};
use octant_faults::catalogue::Dimension::*;
use octant_faults::{Channels, FaultSpec, Value};
use std::f64::consts::{PI, TAU};

fn lock_in(threshold_counts: f64, which: Channels, first: u64, epochs: u64) -> FaultSpec {
    let values = [channels(which), quantity("threshold", rate(threshold_counts), GyroBias)];
    fault("lock-in", &values, first, epochs)
}

#[test]
fn slow_rotation_is_lost_and_faster_one_is_seen_too_slow() {
    // y is locked from epoch 17 273 to 19 090, when its rate is below 10 000.3 counts.
    let spec = fading(lock_in(10_000.3, Channels::gyro(1), 17_000, 2_200), 100);
    let outcome = run(&[spec], 19_400);
    let seen = |count: f64| {
        let square = count * count - 10_000.3 * 10_000.3;
        if square > 0.0 { count.signum() * square.sqrt() } else { 0.0 }
    };
    follows(&outcome, &[1], |k, channel| {
        let count = clean_count(k, channel);
        strength(k, 17_000, 2_200, 100) * (seen(count) - count)
    });
    for k in [17_273, 18_182, 19_090] {
        assert_eq!(outcome.at(k)[0].sample.delta_theta[1], 0);
    }
    assert!(outcome.at(17_272)[0].sample.delta_theta[1] < -80);
}

#[test]
fn the_rate_is_the_mean_of_adlers_equation() {
    // z turns with 299 987 counts a sample at epoch 1: in units of the lock-in rate 1.2.
    let limit = 299_987.0 / 1.2;
    let outcome = run(&[lock_in(limit, Channels::gyro(2), 1, 1)], 1);
    let found = f64::from(outcome.at(1)[0].sample.delta_theta[2]) / limit;
    // dψ/dt = 1.2 − sin ψ by the classical Runge-Kutta method over 50 whole beats.
    let (mut psi, mut t, h) = (0.0f64, 0.0, 1e-3);
    let rate = |psi: f64| 1.2 - psi.sin();
    let (mut before, mut last) = (psi, t);
    while psi < 50.0 * TAU {
        (before, last) = (psi, t);
        let a = rate(psi);
        let b = rate(psi + 0.5 * h * a);
        let c = rate(psi + 0.5 * h * b);
        let d = rate(psi + h * c);
        psi += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        t += h;
    }
    let end = last + h * (50.0 * TAU - before) / (psi - before);
    let mean = 50.0 * TAU / end;
    assert!((found - mean).abs() < 1e-5, "{found} {mean}");
    assert!((mean - 0.663_325).abs() < 1e-5);
}

#[test]
fn far_from_lock_in_the_scale_factor_error_is_half_the_square() {
    let outcome = run(&[lock_in(3_000.0, Channels::gyro(2), 1, 1000)], 1000);
    let steps = added(&outcome);
    let sum: i64 = steps.iter().map(|(step, _)| step[2]).sum();
    let expected: f64 =
        (1..=1000).map(|k| clean_count(k, 2)).map(|c| -0.5 * 3_000.0 * 3_000.0 / c).sum();
    // The next term of the series is (ω_L/ω)²/4 of this one.
    assert!((sum as f64 - expected).abs() < 0.5 + 3e-5 * expected.abs(), "{sum} {expected}");
}

fn residual(frequency: f64, phase: f64, walk: f64, which: Channels) -> [(&'static str, Value); 5] {
    [
        channels(which),
        quantity("amplitude", 5000.0 * RAD, SmallAngle),
        quantity("frequency", frequency, Frequency),
        quantity("phase", phase, Angle),
        quantity("phase_random_walk", walk, AngleRandomWalk),
    ]
}

#[test]
fn the_residual_angle_is_a_sine_and_no_drift() {
    let values = residual(413.7, 0.9, 0.0, Channels::GYRO);
    let spec = fault("dither-residual", &values, 101, 5000);
    let outcome = run(std::slice::from_ref(&spec), 5200);
    let angle = |n: f64| 5000.0 * (TAU * 413.7 * n * DT + 0.9).sin();
    let real = |k: u64| angle(k as f64 - 100.0) - angle(k as f64 - 101.0);
    follows(&outcome, &[0, 1, 2], |k, _| if (101..5101).contains(&k) { real(k) } else { 0.0 });
    let steps = added(&outcome);
    let largest = steps.iter().map(|(step, _)| step[0].abs()).max().unwrap() as f64;
    let expected = 10_000.0 * (PI * 413.7 * DT).sin().abs();
    assert!((largest - expected).abs() < 2.0, "{largest} {expected}");
    // The residual also fades.
    let outcome = run(&[fading(spec, 300)], 5500);
    follows(&outcome, &[0, 1, 2], |k, _| strength(k, 101, 5000, 300) * real(k));
}

#[test]
fn a_walking_phase_loses_its_memory() {
    const N: u64 = 200_000;
    // The correlation falls as e^(−κ² t/2): to 1/e in 20 samples.
    let walk = (2.0 / (20.0 * DT)).sqrt();
    let steps =
        run(&[fault("dither-residual", &residual(437.0, 0.0, walk, Channels::GYRO), 1, N)], N);
    let steps = added(&steps);
    let mut angles = Vec::new();
    for axis in 0..3 {
        let mut angle = 0i64;
        let series: Vec<f64> = steps
            .iter()
            .map(|(step, _)| {
                angle += step[axis];
                angle as f64 / 5000.0
            })
            .collect();
        // Independent pieces of about 20 samples on either side: standard error below √(40/N)
        // of the variance ½.
        let bound = 5.0 * (40.0 / N as f64).sqrt() * 0.5;
        for lag in [0usize, 1, 7, 20, 60] {
            let t = lag as f64 * DT;
            let expected = 0.5 * (TAU * 437.0 * t).cos() * (-0.5 * walk * walk * t).exp();
            let found = product(&series, lag);
            assert!((found - expected).abs() < bound, "{axis} {lag} {found} {expected}");
        }
        angles.push(series);
    }
    // Every gyro has its own phase.
    let both: f64 = angles[0].iter().zip(&angles[1]).map(|(a, b)| a * b).sum();
    assert!((both / N as f64).abs() < 5.0 * (40.0 / N as f64).sqrt() * 0.5, "{both}");
}

#[test]
fn contradictions_are_refused() {
    let x = Channels::gyro(0);
    assert_eq!(refused("dither-residual", &residual(400.0, 0.1, 0.0, x)), "frequency");
    assert_eq!(refused("dither-residual", &residual(410.0, 0.1, 0.0, Channels::ALL)), "channels");
    // With a walking phase the residual is visible.
    let walking = fault("dither-residual", &residual(400.0, 0.1, 0.5, x), 1, 50);
    assert!(run(&[walking], 50).receipts[0].fired());
    let values = [channels(Channels::accelerometer(0)), quantity("threshold", 1e-5, GyroBias)];
    assert_eq!(refused("lock-in", &values), "channels");
}
