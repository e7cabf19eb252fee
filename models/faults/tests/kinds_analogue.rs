//! Every analogue kind alters samples as documented, by independent arithmetic.

use crate::common::counts::*;
use crate::common::{self, clean, fault, run};
use octant_faults::catalogue::Dimension::*;
use octant_faults::trigger::Trigger;
use octant_faults::{Channels, Value};
use octant_sample::imu::Status;

const X: Channels = Channels::gyro(0);
const Y: Channels = Channels::gyro(1);

#[test]
fn a_bias_step_adds_its_integral_and_fades() {
    let values = [channels(Channels::GYRO), quantity("amplitude", rate(0.37), GyroBias)];
    let outcome = run(&[fading(fault("bias-step", &values, 11, 100), 40)], 300);
    follows(&outcome, &[0, 1, 2], |k, _| 0.37 * strength(k, 11, 100, 40));
    let z = Channels::accelerometer(2);
    let values = [channels(z), quantity("amplitude", acceleration(-70.3), AccelBias)];
    let outcome = run(&[fault("bias-step", &values, 1, 50)], 80);
    follows(&outcome, &[5], |k, _| -70.3 * strength(k, 1, 50, 0));
}

#[test]
fn what_leaves_the_format_saturates_and_is_flagged() {
    // 2³¹ counts on top of 100 000: beyond.
    for (sign, limit) in [(1.0, i32::MAX), (-1.1, i32::MIN)] {
        let values = [channels(X), quantity("amplitude", rate(sign * 2f64.powi(31)), GyroBias)];
        let outcome = run(&[fault("bias-step", &values, 5, 3)], 20);
        for (k, epoch) in &outcome.delivered {
            let clean = clean(*k).sample;
            if (5..8).contains(k) {
                let others = [epoch.sample.delta_theta[1], epoch.sample.delta_theta[2]];
                assert_eq!(epoch.sample.delta_theta[0], limit);
                assert_eq!(others, [clean.delta_theta[1], clean.delta_theta[2]]);
                assert_eq!(epoch.sample.status, Status::GYRO_SATURATED);
            } else {
                assert_eq!(epoch.sample, clean);
            }
        }
    }
    let values = [channels(Channels::accelerometer(2)), quantity("error", 100.0, Ratio)];
    let outcome = run(&[fault("scale-step", &values, 5, 1)], 10);
    let sample = outcome.at(5)[0].sample;
    assert_eq!(sample.delta_velocity[2], i32::MAX);
    assert_eq!(sample.status, Status::ACCELEROMETER_SATURATED);
}

#[test]
fn a_ramp_is_the_integral_of_a_ramp() {
    // Rise of 31.4 samples: its end lies within a sample.
    let values = [
        channels(Y),
        quantity("amplitude", rate(-25.0), GyroBias),
        quantity("rise", 31.4 * DT, Time),
    ];
    let outcome = run(&[fading(fault("bias-ramp", &values, 21, 60), 10)], 120);
    // Integral of the ramp up to n samples after the onset.
    let integral = |n: f64| if n < 31.4 { n * n / 62.8 } else { n - 15.7 };
    follows(&outcome, &[1], |k, _| {
        let n = k as f64 - 21.0;
        -25.0 * strength(k, 21, 60, 10) * (integral(n + 1.0) - integral(n))
    });
}

/// Size of steps of the bias in counts per sample; rounding to counts (variance 1/6 of the
/// differences) is negligible beside it.
const STEP: f64 = 3000.0;

#[test]
fn the_random_walk_of_the_rate_has_its_allan_variance() {
    const N: u64 = 100_000;
    let k = STEP * RAD / DT / DT.sqrt();
    let values = [channels(Channels::GYRO), quantity("coefficient", k, RateRandomWalk)];
    let spec = fault("rate-random-walk", &values, 3, N);
    let steps = added(&run(&[spec], N + 10));
    assert!(steps[..2].iter().chain(&steps[N as usize + 2..]).all(|step| step.0 == [0; 6]));
    let mut differences = Vec::new();
    for axis in 0..3 {
        let y: Vec<f64> = steps[2..N as usize + 2].iter().map(|step| step.0[axis] as f64).collect();
        // Means of a Wiener process over samples: its differences have the variance 2/3 K² dt and
        // the covariance 1/6 K² dt of neighbours. Standard error of a variance of Gaussians with
        // the correlation 1/4: √(2 (1 + 2/16) / n).
        let d: Vec<f64> = y.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let bound = 5.0 * (2.25 / N as f64).sqrt();
        assert!((product(&d, 0) / (STEP * STEP * 2.0 / 3.0) - 1.0).abs() < bound);
        assert!((product(&d, 1) / (STEP * STEP / 6.0) - 1.0).abs() < 4.0 * bound);
        // Allan variance K² τ/3 at τ of 100 samples.
        let means: Vec<f64> =
            y.chunks_exact(100).map(|chunk| chunk.iter().sum::<f64>() / 100.0).collect();
        let halves: f64 = means.windows(2).map(|p| 0.5 * (p[1] - p[0]).powi(2)).sum();
        let allan = halves / (means.len() - 1) as f64;
        let bound = 5.0 * (2.25 / means.len() as f64).sqrt();
        assert!((allan / (STEP * STEP * 100.0 / 3.0) - 1.0).abs() < bound, "{allan}");
        differences.push(d);
    }
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        let both: f64 = differences[a].iter().zip(&differences[b]).map(|(a, b)| a * b).sum();
        let correlation = both / N as f64 / (STEP * STEP * 2.0 / 3.0);
        assert!(correlation.abs() < 5.0 * (1.125 / N as f64).sqrt(), "{correlation}");
    }
}

/// Sums of the additions to a channel in each of many firings of 10 samples.
fn firings(kind: &str, values: &[(&'static str, Value)], channel: usize) -> Vec<Vec<f64>> {
    let mut spec = fault(kind, values, 1, 10);
    spec.schedule.trigger = Trigger::Periodic { first: 1, period: 12, last: None };
    let all = series(spec, channel, 1, 12 * 4000);
    let chunks = all.chunks_exact(12);
    chunks.inspect(|chunk| assert_eq!(chunk[10..], [0.0; 2])).map(|c| c[..10].to_vec()).collect()
}

/// Five standard errors of a variance of 4000 Gaussian numbers.
const FIVE_OF_4000: f64 = 5.0 * 0.022_360_68;

#[test]
fn every_firing_of_a_walk_starts_from_zero() {
    let k = STEP * MPS / DT / DT.sqrt();
    let z = Channels::accelerometer(2);
    let values = [channels(z), quantity("coefficient", k, AccelRandomWalk)];
    let sums: Vec<f64> =
        firings("rate-random-walk", &values, 5).iter().map(|f| f.iter().sum()).collect();
    // The integral of a Wiener process over T has the variance K² T³/3.
    let ratio = product(&sums, 0) / (STEP * STEP * 1000.0 / 3.0);
    assert!((ratio - 1.0).abs() < FIVE_OF_4000, "{ratio}");
}

#[test]
fn a_markov_bias_is_correlated_exponentially() {
    const N: u64 = 200_000;
    let values = [
        channels(X),
        quantity("sigma", rate(STEP), GyroBias),
        quantity("correlation_time", 20.0 * DT, Time),
        choice("start", "drawn"),
    ];
    let b = series(fault("gauss-markov", &values, 1, N), 0, 1, N);
    // Standard error of the covariances of such a process (Bartlett): below
    // √(2/N · coth(dt/τ)).
    let bound = 5.0 * (2.0 / N as f64 / (1.0f64 / 20.0).tanh()).sqrt();
    for lag in [0, 1, 10, 40] {
        let found = product(&b, lag) / (STEP * STEP);
        assert!((found - (-(lag as f64) / 20.0).exp()).abs() < bound, "{lag} {found}");
    }
}

#[test]
fn a_markov_bias_starts_from_where_it_is_told() {
    for (start, expected) in
        [("zero", [1.0 - (-0.1f64).exp(), 1.0 - (-1f64).exp()]), ("drawn", [1.0, 1.0])]
    {
        let values = [
            channels(X),
            quantity("sigma", rate(STEP), GyroBias),
            quantity("correlation_time", 20.0 * DT, Time),
            choice("start", start),
        ];
        let all = firings("gauss-markov", &values, 0);
        for (sample, expected) in [(0, expected[0]), (9, expected[1])] {
            let values: Vec<f64> = all.iter().map(|firing| firing[sample]).collect();
            let ratio = product(&values, 0) / (STEP * STEP * expected);
            assert!((ratio - 1.0).abs() < FIVE_OF_4000, "{start} {sample} {ratio}");
        }
    }
}

#[test]
fn noise_is_multiplied_as_a_root_of_squares() {
    const N: u64 = 100_000;
    let setup = common::setup();
    let values = [channels(Channels::ALL), quantity("gain", 3.0, Ratio)];
    let spec = fading(fault("noise-gain", &values, 5, N), N);
    let steps = added(&run(&[spec], 2 * N + 10));
    assert!(steps[..4].iter().all(|step| step.0 == [0; 6]));
    assert!(steps[2 * N as usize + 4..].iter().all(|step| step.0 == [0; 6]));
    for channel in 0..6 {
        let sigma = 8f64.sqrt()
            * DT.sqrt()
            * if channel < 3 {
                setup.angle_random_walk / RAD
            } else {
                setup.velocity_random_walk / MPS
            };
        let part = |from: u64, strong: f64| -> Vec<f64> {
            // A thousand samples of the fade have nearly the same strength; each is divided by its
            // own.
            let each = |k: u64| {
                let s = strength(k, 5, N, N);
                if s < strong { f64::NAN } else { steps[k as usize - 1].0[channel] as f64 / s }
            };
            (from..from + N).map(each).filter(|value| value.is_finite()).collect()
        };
        // While the fault lasts, and the first nine tenths of its fading.
        for (series, white) in [(part(5, 1.0), true), (part(5 + N, 0.1), false)] {
            let n = series.len() as f64;
            let ratio = product(&series, 0) / (sigma * sigma);
            assert!((ratio - 1.0).abs() < 5.0 * (2.0 / n).sqrt(), "{channel} {ratio}");
            let neighbours = product(&series, 1) / (sigma * sigma);
            assert!(!white || neighbours.abs() < 5.0 / n.sqrt(), "{neighbours}");
        }
    }
}

#[test]
fn scale_factor_errors_multiply_the_count() {
    let values = [channels(Channels::ALL), quantity("error", -37e-6, Ratio)];
    let outcome = run(&[fading(fault("scale-step", &values, 30, 200), 77)], 400);
    follows(&outcome, &[0, 1, 2, 3, 4, 5], |k, channel| {
        -37e-6 * strength(k, 30, 200, 77) * clean_count(k, channel)
    });
}

#[test]
fn asymmetry_parts_the_signs() {
    // The y gyro changes its sign at epoch 18 182.
    let values = [channels(Y), quantity("error", 4e-3, Ratio)];
    let outcome = run(&[fading(fault("asymmetry", &values, 18_000, 500), 50)], 18_600);
    follows(&outcome, &[1], |k, channel| {
        let count = clean_count(k, channel);
        let half = if count > 0.0 { 2e-3 } else { -2e-3 };
        strength(k, 18_000, 500, 50) * half * count
    });
    let receipt = &outcome.receipts[0];
    assert!(receipt.first_sample.unwrap() < 18_182 && receipt.last_sample.unwrap() > 18_182);
}

#[test]
fn a_tilted_sensor_feels_another_axis() {
    let angle = 40.0 / 3600.0 * std::f64::consts::PI / 180.0;
    for (from, into, channel, source) in [
        (Channels::gyro(2), X, 0, 2),
        (Channels::accelerometer(2), Channels::accelerometer(1), 4, 5),
    ] {
        let values = [
            ("from", Value::Channels(from)),
            ("into", Value::Channels(into)),
            quantity("angle", angle, SmallAngle),
        ];
        let outcome = run(&[fading(fault("cross-axis", &values, 30, 200), 20)], 400);
        follows(&outcome, &[channel], |k, _| {
            angle * strength(k, 30, 200, 20) * clean_count(k, source)
        });
    }
}

#[test]
fn g_dependence_multiplies_the_specific_force_of_the_sample() {
    let g = [2e-9, -3e-9, 5e-10];
    let values = [channels(Y), ("coefficients", Value::Vector(g, GDependent))];
    let outcome = run(&[fading(fault("g-sensitivity", &values, 30, 200), 20)], 400);
    follows(&outcome, &[1], |k, _| {
        let dv = clean(k).sample.delta_velocity.map(|count| f64::from(count) * MPS);
        let rad = g[0] * dv[0] + g[1] * dv[1] + g[2] * dv[2];
        strength(k, 30, 200, 20) * rad / RAD
    });
}

#[test]
fn a_smaller_range_cuts_and_says_so_or_not() {
    for (says, status) in [(true, Status::GYRO_SATURATED), (false, Status::empty())] {
        let values = [
            channels(Channels::GYRO),
            quantity("limit", rate(250_000.7), AngularRate),
            flag("flag", says),
        ];
        // x stays within, y too, z falls through the limit at epoch 3847.
        let outcome = run(&[fault("saturation", &values, 3700, 300)], 4100);
        for (index, (step, found)) in added(&outcome).iter().enumerate() {
            let k = index as u64 + 1;
            let excess =
                if (3700..4000).contains(&k) { (300_000 - 13 * k as i64) - 250_000 } else { 0 };
            assert_eq!(*step, [0, 0, -excess.max(0), 0, 0, 0], "{k}");
            assert_eq!(*found, if excess > 0 { status } else { Status::empty() });
        }
        assert_eq!(outcome.receipts[0].last_sample, Some(3846));
    }
    // On the negative side, and of an accelerometer.
    let values = [
        channels(Channels::accelerometer(1)),
        quantity("limit", acceleration(2500.2), Acceleration),
        flag("flag", true),
    ];
    let outcome = run(&[fault("saturation", &values, 1, 100)], 100);
    for (k, epoch) in outcome.delivered {
        let count = -2000 - 19 * k as i32;
        assert_eq!(epoch.sample.delta_velocity[1], count.max(-2500));
        assert_eq!(epoch.sample.status.is_empty(), count >= -2500);
    }
}

#[test]
fn a_dead_zone_swallows_small_input() {
    for (beyond, whole) in [("whole", true), ("excess", false)] {
        let values =
            [channels(Y), quantity("threshold", rate(1000.3), GyroBias), choice("beyond", beyond)];
        let spec = fading(fault("dead-zone", &values, 18_000, 400), 30);
        let outcome = run(&[spec], 18_500);
        let change = |count: f64| match count {
            count if count.abs() <= 1000.3 => -count,
            _ if whole => 0.0,
            count => -1000.3 * count.signum(),
        };
        follows(&outcome, &[1], |k, channel| {
            strength(k, 18_000, 400, 30) * change(clean_count(k, channel))
        });
        assert_eq!(outcome.at(18_100)[0].sample.delta_theta[1], 0);
    }
}

#[test]
fn coarse_steps_carry_their_remainder() {
    let values = [channels(Channels::GYRO), quantity("resolution", 70_001.2 * RAD, SmallAngle)];
    let outcome = run(&[fault("quantization", &values, 10, 500)], 600);
    let mut sums = [[0i64; 3]; 2];
    for (k, epoch) in &outcome.delivered {
        let clean = clean(*k);
        if !(10..510).contains(k) {
            assert_eq!(*epoch, clean);
            continue;
        }
        let mut same = *epoch;
        same.sample.delta_theta = clean.sample.delta_theta;
        assert_eq!(same, clean);
        for axis in 0..3 {
            assert_eq!(epoch.sample.delta_theta[axis] % 70_001, 0);
            sums[0][axis] += i64::from(clean.sample.delta_theta[axis]);
            sums[1][axis] += i64::from(epoch.sample.delta_theta[axis]);
            assert!(2 * (sums[0][axis] - sums[1][axis]).abs() <= 70_001, "{k}");
        }
    }
}

#[test]
fn a_step_as_wide_as_the_format_saturates() {
    // 1.5e9 of z: 52 million a sample reach half of it after 15 samples; two of them don't fit.
    let values =
        [channels(Channels::accelerometer(2)), quantity("resolution", 1.5e9 * MPS, Velocity)];
    let bias = [
        channels(Channels::accelerometer(2)),
        quantity("amplitude", acceleration(2.05e9), AccelBias),
    ];
    let mut first = fault("bias-step", &bias, 1, 5);
    first.id = "first".into();
    let outcome = run(&[first, fault("quantization", &values, 1, 5)], 5);
    let counts: Vec<_> =
        outcome.delivered.iter().map(|(_, epoch)| epoch.sample.delta_velocity[2]).collect();
    // 2.102e9 a sample: 1, 2, 1, 2, 1 steps; remainders 0.602, −0.296, 0.306, −0.592, 0.010e9.
    assert_eq!(counts, [1_500_000_000, i32::MAX, 1_500_000_000, i32::MAX, 1_500_000_000]);
    let flags: Vec<_> =
        outcome.delivered.iter().map(|(_, epoch)| !epoch.sample.status.is_empty()).collect();
    assert_eq!(flags, [false, true, false, true, false]);
}

#[test]
fn contradictions_are_refused() {
    let gain = |gain| [channels(X), quantity("gain", gain, Ratio)];
    assert_eq!(refused("noise-gain", &gain(1.0)), "gain");
    let cross = |from, into| {
        [
            ("from", Value::Channels(from)),
            ("into", Value::Channels(into)),
            quantity("angle", 1e-4, SmallAngle),
        ]
    };
    assert_eq!(refused("cross-axis", &cross(X, X)), "into");
    assert_eq!(refused("cross-axis", &cross(X, Channels::accelerometer(1))), "into");
    assert_eq!(refused("cross-axis", &cross(Channels::GYRO, X)), "from");
    let g =
        |channels_of, g| [channels(channels_of), ("coefficients", Value::Vector(g, GDependent))];
    assert_eq!(refused("g-sensitivity", &g(X, [0.0; 3])), "coefficients");
    assert_eq!(refused("g-sensitivity", &g(Channels::ALL, [1e-9; 3])), "channels");
    let limit = |limit| [channels(X), quantity("limit", limit, AngularRate), flag("flag", true)];
    assert_eq!(refused("saturation", &limit(6.25)), "limit");
    assert_eq!(refused("saturation", &limit(1e-12)), "limit");
    let step = |step| [channels(X), quantity("resolution", step, SmallAngle)];
    assert_eq!(refused("quantization", &step(RAD)), "resolution");
    assert_eq!(refused("quantization", &step(1.0)), "resolution");
    let bias = [channels(Channels::ALL), quantity("amplitude", 1e-6, GyroBias)];
    assert_eq!(refused("bias-step", &bias), "amplitude");
    let recovers = fading(fault("quantization", &step(100.0 * RAD), 1, 10), 5);
    let error = octant_faults::Station::new(&[recovers], &common::setup()).unwrap_err().1;
    assert!(error.to_string().starts_with("recovery"), "{error}");
}
