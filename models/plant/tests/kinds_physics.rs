//! Kinds of faults of motion and environment against independent closed forms of their
//! documentation.

use super::common::bench::*;
use super::common::*;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{DEG, DEG_PER_HOUR, MICRO_G, PPM, STANDARD_GRAVITY_MPS2};
use octant_faults::catalogue::Dimension::*;
use octant_faults::{FaultSpec, Value};
use octant_plant::config::*;
use octant_sample::Reference;
use octant_sample::counts::{DELTA_THETA_LSB_RAD as RAD, DELTA_VELOCITY_LSB_MPS as MPS};
use std::f64::consts::PI;

fn level(_: u64) -> octant_sample::GimbalCommand {
    command(0.0, 0.0)
}

fn sine(
    acceleration: [f64; 3],
    angle: [f64; 3],
    phase: f64,
    first: u64,
    samples: u64,
) -> FaultSpec {
    fault(
        "vibration-sine",
        &[
            ("frequency", quantity(37.0, Frequency)),
            ("acceleration", vector(acceleration, Acceleration)),
            ("angle", vector(angle, Angle)),
            ("phase", quantity(phase, Angle)),
            ("edge", quantity(0.25, Time)),
        ],
        first,
        samples,
    )
}

/// The integral of the gyro is the angle, that of the accelerometer the velocity, swelling and
/// fading included.
#[test]
fn sine_vibration_is_the_sine_of_its_page() {
    let (a, alpha, phase) = (5.0, 2e-4, 0.7);
    let spec = sine([0.0, 0.0, a], [0.0, 0.0, alpha], phase, 201, 400);
    let pairs = run_pair(&noisy(), &[spec], 1000, level);
    nothing_before(&pairs, 201);
    // The fault ends with sample 601 and fades over 50 more.
    nothing_after(&pairs, 652);
    let omega = 2.0 * PI * 37.0;
    let (angles, speeds) = (gathered(&pairs, 2), gathered(&pairs, 5));
    for k in 0..1000 {
        let t = (k as f64 - 199.0) * DT;
        let (up, up_rate) = rise(t / 0.25);
        let (down, down_rate) = rise((t - 2.0) / 0.25);
        let w = up * (1.0 - down);
        let w_rate = (up_rate * (1.0 - down) - up * down_rate) / 0.25;
        let angle = w * alpha * (omega * t + phase).sin();
        let r = -a / (omega * omega);
        let speed = r * (w_rate * (omega * t).sin() + w * omega * (omega * t).cos());
        assert!((angles[k] - angle).abs() <= 1.01 * RAD, "{k}");
        assert!((speeds[k] - speed).abs() <= 1.01 * MPS, "{k} {}", speeds[k] - speed);
    }
    // At full window velocity has the amplitude a/Ω.
    let largest = speeds[300..500].iter().fold(0.0f64, |m, s| m.max(s.abs()));
    assert!((largest / (a / omega) - 1.0).abs() < 0.01);
}

/// In phase: −½ cos φ α × a, and the swing's curvature ¼ α² g across the axis.
#[test]
fn sine_vibration_sculls_as_its_page_says() {
    let (a, alpha) = (20.0, 1e-3);
    for phase in [0.0, 1.0, PI] {
        let spec = sine([0.0, a, 0.0], [alpha, 0.0, 0.0], phase, 1, 3000);
        let pairs = run_pair(&perfect(), &[spec], 2200, level);
        // From 1 s on, 10 s: 370 periods.
        let speeds = gathered(&pairs, 5);
        let mean = (speeds[2199] - speeds[199]) / 10.0;
        let gravity = Ellipsoid::at(LATITUDE, 40.0).gravity_mps2;
        let expected = -0.5 * phase.cos() * alpha * a + 0.25 * alpha * alpha * gravity;
        // Fourth order: α² of it; and one count in 10 s.
        assert!((mean - expected).abs() < 2e-6 * expected.abs() + 1e-9, "{mean} {expected}");
    }
}

/// One-sided spectrum by Welch's method, Hann window, half overlap; power per Hz at k/(n dt).
fn welch(signal: &[f64], n: usize, dt: f64) -> Vec<f64> {
    let window: Vec<f64> =
        (0..n).map(|i| 0.5 - 0.5 * (2.0 * PI * i as f64 / n as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let turn: Vec<(f64, f64)> =
        (0..n).map(|i| (2.0 * PI * i as f64 / n as f64).sin_cos()).collect();
    let mut psd = vec![0.0; n / 2];
    let mut segments = 0.0;
    for start in (0..=signal.len() - n).step_by(n / 2) {
        segments += 1.0;
        for (k, bin) in psd.iter_mut().enumerate() {
            let (mut re, mut im) = (0.0, 0.0);
            for i in 0..n {
                let x = signal[start + i] * window[i];
                let (s, c) = turn[k * i % n];
                re += x * c;
                im -= x * s;
            }
            *bin += 2.0 * dt * (re * re + im * im) / power;
        }
    }
    psd.iter().map(|bin| bin / segments).collect()
}

#[test]
fn random_vibration_has_its_spectrum() {
    let mut config = perfect();
    config.sample_period_ns = 1_000_000;
    let dt = 1e-3;
    let level_si = 0.002 * STANDARD_GRAVITY_MPS2 * STANDARD_GRAVITY_MPS2;
    let (low, high, lines) = (30.0, 180.0, 75);
    let spec = fault(
        "vibration-random",
        &[
            ("psd", vector([level_si, 0.0, 0.5 * level_si], AccelerationPsd)),
            ("rate", vector([0.0, 0.0, 0.02], AngularRate)),
            ("low_frequency", quantity(low, Frequency)),
            ("high_frequency", quantity(high, Frequency)),
            ("lines", Value::Integer(lines)),
            ("edge", quantity(0.1, Time)),
        ],
        101,
        20_000,
    );
    let pairs = run_pair(&config, &[spec], 16_584, level);
    nothing_before(&pairs, 101);
    // 16 s at full window.
    let channel = |of: &dyn Fn(&Pair) -> f64| -> Vec<f64> {
        pairs[200..].iter().map(|pair| of(pair) / dt).collect()
    };
    let x = channel(&|pair| pair.velocity(0) as f64 * MPS);
    let z = channel(&|pair| pair.velocity(2) as f64 * MPS);
    let rate = channel(&|pair| pair.theta(2) as f64 * RAD);
    let n = 1024;
    let width = 1.0 / (n as f64 * dt);
    // A sample is a mean over dt: sinc² of power.
    let mean_of = |frequency: f64| {
        let x = PI * frequency * dt;
        (x.sin() / x).powi(2)
    };
    for (signal, expected) in
        [(&x, level_si), (&z, 0.5 * level_si), (&rate, 0.02 * 0.02 / (high - low))]
    {
        let psd = welch(signal, n, dt);
        // Bands of 15 lines. Leakage at their ends and lines that beat in 16 s: a tenth.
        for band in 0..5 {
            let from = low + 30.0 * f64::from(band);
            let bins = (from / width).round() as usize..((from + 30.0) / width).round() as usize;
            let count = bins.len() as f64;
            let mean: f64 =
                bins.map(|bin| psd[bin] / mean_of(bin as f64 * width)).sum::<f64>() / count;
            assert!((mean / expected - 1.0).abs() < 0.1, "{from} Hz: {}", mean / expected);
        }
        for outside in [5.0, 15.0, 22.0, 200.0, 300.0, 450.0] {
            let bin = (outside / width).round() as usize;
            assert!(psd[bin] < 1e-3 * expected, "{outside} Hz: {}", psd[bin] / expected);
        }
    }
    // Rms √(S (f2 − f1)), less the power lost by the mean over a sample.
    let rms = (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    let steps = 1000;
    let taken = (0..steps)
        .map(|i| mean_of(low + (high - low) * (f64::from(i) + 0.5) / f64::from(steps)))
        .sum::<f64>()
        / f64::from(steps);
    let expected = (level_si * (high - low) * taken).sqrt();
    assert!((rms / expected - 1.0).abs() < 0.02, "{}", rms / expected);
    // Axes are independent.
    let product: f64 = x.iter().zip(&z).map(|(x, z)| x * z).sum::<f64>() / x.len() as f64;
    assert!(product.abs() < 0.05 * rms * rms, "{}", product / rms / rms);
}

#[test]
fn a_shock_gives_its_velocity_and_takes_it_back() {
    let (peak, width, recoil) = (2.0, 0.1, 0.3);
    let spec = fault(
        "shock",
        &[
            ("peak", vector([peak, 0.0, -0.5 * peak], Acceleration)),
            ("width", quantity(width, Time)),
            ("recoil", quantity(recoil, Time)),
        ],
        101,
        1,
    );
    let pairs = run_pair(&noisy(), &[spec], 400, level);
    nothing_before(&pairs, 101);
    nothing_after(&pairs, 181);
    for (axis, peak) in [(0, peak), (2, -0.5 * peak)] {
        let speed = gathered(&pairs, 3 + axis);
        for k in 0..20 {
            let t = f64::from(k + 1) * DT;
            let expected = peak * width / PI * (1.0 - (PI * t / width).cos());
            // Coriolis on the other axis' motion, 1.5e-4 rad/s times 6 mm: 1e-6 m/s.
            assert!((speed[100 + k as usize] - expected).abs() < 1e-6);
        }
        assert!((speed[119] - 2.0 * peak * width / PI).abs() < 1e-6);
        // The recoil takes back the whole velocity, with the part by Coriolis.
        assert!(speed[180].abs() <= 1.01 * MPS, "{}", speed[180]);
        // Truth is that of the block: level and heading north.
        let truth = |k: usize| pairs[k].truth.velocity_mps[axis];
        assert!((truth(119) - 2.0 * peak * width / PI).abs() < 1e-9);
    }
    let moved = (pairs[119].truth.latitude_rad - pairs[119].twin_truth.latitude_rad)
        * Ellipsoid::at(LATITUDE, 40.0).meridian_radius_m;
    assert!((moved - peak * width * width / PI).abs() < 1e-8, "{moved}");
    for pair in &pairs {
        // No rotation.
        assert_eq!(pair.step.sample.delta_theta, pair.twin.sample.delta_theta);
    }
}

/// −ω² p along the arm in the cruise of a turn, α p across it when the turn ends.
#[test]
fn a_lever_arm_feels_the_turn() {
    let p = 0.05;
    let spec = fault(
        "lever-arm",
        &[
            ("accelerometer_x", vector([p, 0.0, 0.0], Length)),
            ("accelerometer_y", vector([p, 0.0, 0.0], Length)),
            ("accelerometer_z", vector([0.0; 3], Length)),
        ],
        501,
        2000,
    );
    let pairs = run_pair(&perfect(), &[spec], 2700, |_| command(90.0, 0.0));
    nothing_before(&pairs, 501);
    nothing_after(&pairs, 2501);
    let (along, across) = (gathered(&pairs, 3), gathered(&pairs, 4));
    let spin = 10.0 * DEG - EARTH_RATE * LATITUDE.sin();
    let expected = -spin * spin * p * 5.0;
    // The horizontal Earth rate across the arm adds 4e-9 of its square.
    assert!((along[1500] - along[500] - expected).abs() < 3e-9, "{}", along[1500] - along[500]);
    assert!(across[1500].abs() < 3e-9);
    // The move brakes from 9 s to 10 s, and begins with sample 2: tangential −10 °/s · p.
    assert!((across[2100] + 10.0 * DEG * p).abs() < 3e-9, "{}", across[2100]);
    for pair in &pairs {
        assert_eq!(pair.step.sample.delta_theta, pair.twin.sample.delta_theta);
    }
}

/// The integral of the temperature: up, on the plateau, and back at the same rate.
#[test]
fn temperature_goes_up_and_comes_back() {
    let (ramp, plateau) = (0.5, 2.0);
    let bias = [DEG_PER_HOUR, -2.0 * DEG_PER_HOUR, 0.0];
    let accelerometer = [100.0 * MICRO_G, 0.0, -50.0 * MICRO_G];
    let (gyro_scale, accelerometer_scale) = ([0.0, 0.0, 1e-3], [0.0, 0.0, 10.0 * PPM]);
    let spec = fault(
        "temperature-ramp",
        &[
            ("ramp", quantity(ramp, TemperatureRate)),
            ("plateau", quantity(plateau, Temperature)),
            ("gyro_bias", vector(bias, GyroBiasPerK)),
            ("accelerometer_bias", vector(accelerometer, AccelBiasPerK)),
            ("gyro_scale", vector(gyro_scale, ScalePerK)),
            ("accelerometer_scale", vector(accelerometer_scale, ScalePerK)),
        ],
        201,
        1300,
    );
    let pairs = run_pair(&perfect(), &[spec], 3000, level);
    nothing_before(&pairs, 201);
    // 6.5 s, and 4 s back.
    nothing_after(&pairs, 201 + 2100);
    // Kelvin-seconds from the onset.
    let gathered_k_s = |t: f64| {
        let up = |t: f64| {
            let t = t.max(0.0);
            if t < 4.0 { 0.5 * ramp * t * t } else { 4.0 + plateau * (t - 4.0) }
        };
        up(t) - up(t - 6.5)
    };
    let gravity = Ellipsoid::at(LATITUDE, 40.0).gravity_mps2;
    let rate = [EARTH_RATE * LATITUDE.cos(), 0.0, -EARTH_RATE * LATITUDE.sin()];
    for axis in 0..3 {
        let (theta, velocity) = (gathered(&pairs, axis), gathered(&pairs, 3 + axis));
        let force = if axis == 2 { -gravity } else { 0.0 };
        for k in 0..3000 {
            let sum = gathered_k_s((k as f64 - 199.0) * DT);
            let gyro = sum * (bias[axis] + gyro_scale[axis] * rate[axis]);
            let accel = sum * (accelerometer[axis] + accelerometer_scale[axis] * force);
            assert!((theta[k] - gyro).abs() <= 1.01 * RAD, "{axis} {k}");
            assert!((velocity[k] - accel).abs() <= 1.01 * MPS, "{axis} {k}");
        }
    }
}

/// 64 u³ (1 − u)³ and its derivative.
fn bump(u: f64) -> (f64, f64) {
    if !(0.0..=1.0).contains(&u) {
        return (0.0, 0.0);
    }
    let p = u * (1.0 - u);
    (64.0 * p.powi(3), 192.0 * p * p * (1.0 - 2.0 * u))
}

#[test]
fn a_jerk_of_the_mooring_moves_truth_and_sensors_and_not_the_reference() {
    let (north, turn, length) = (0.3, 0.02, 5.0);
    let spec = || {
        fault(
            "mooring-jerk",
            &[
                ("displacement", vector([north, 0.0, 0.0], Length)),
                ("turn", vector([0.0, 0.0, turn], Angle)),
                ("length", quantity(length, Time)),
            ],
            201,
            1,
        )
    };
    let pairs = run_pair(&noisy(), &[spec()], 1500, level);
    nothing_before(&pairs, 201);
    nothing_after(&pairs, 1201);
    let radius = Ellipsoid::at(LATITUDE, 40.0).meridian_radius_m;
    let heading = gathered(&pairs, 2);
    let mut aided = 0;
    for (k, pair) in pairs.iter().enumerate() {
        let t = (k as f64 - 199.0) * DT;
        let (value, slope) = bump(t / length);
        let moved = (pair.truth.latitude_rad - pair.twin_truth.latitude_rad) * radius;
        // A double resolves 0.4 nm in latitude.
        assert!((moved - north * value).abs() < 2e-9, "{k}");
        let speed = pair.truth.velocity_mps[0];
        // The meridian's radius changes by 6e-9 of itself.
        assert!((speed - north * slope / length).abs() < 1e-8, "{k}");
        // The gyro about the vertical has turned with the case. Further north the vertical Earth
        // rate differs: Ω cos L · 0.3 m / R over 64/140 of the length, 7e-12 rad.
        let error = heading[k] - turn * value;
        assert!(error.abs() <= 1.01 * RAD + 7e-12, "{k} {error:e}");
        assert_eq!(pair.step.aiding, pair.twin.aiding);
        aided += usize::from(pair.step.aiding.is_some());
    }
    assert_eq!(aided, 7);

    // A reference of velocity shows the motion.
    let mut config = noisy();
    config.aiding.kind = AidingKind::Velocity { sigma_mps: 1e-3 };
    let pairs = run_pair(&config, &[spec()], 1500, level);
    for pair in &pairs {
        let (Some(a), Some(b)) = (pair.step.aiding, pair.twin.aiding) else { continue };
        let (Reference::Velocity(a), Reference::Velocity(b)) = (a.reference, b.reference) else {
            panic!()
        };
        assert!((a[0] - b[0] - pair.truth.velocity_mps[0]).abs() < 1e-15);
    }
}

/// Without knowledge of the phase: at full window a sine and the same sine a quarter of a period
/// later are the sides of a right angle.
#[test]
fn sway_has_its_amplitudes_and_periods_and_the_reference_denies_it() {
    let values = |angles: [f64; 3], displacement: [f64; 3]| {
        fault(
            "sway",
            &[
                ("angles", vector(angles, Angle)),
                ("angle_periods", vector([8.0, 6.0, 10.0], Time)),
                ("displacement", vector(displacement, Length)),
                ("displacement_periods", vector([6.0, 7.0, 8.0], Time)),
                ("edge", quantity(2.0, Time)),
            ],
            101,
            3000,
        )
    };
    let square = |series: &dyn Fn(usize) -> f64, period: f64| {
        let quarter = (0.25 * period / DT).round() as usize;
        let mut sizes = (600..2500).map(|k| series(k).hypot(series(k + quarter)));
        let first = sizes.next().unwrap();
        assert!(sizes.all(|size| (size / first - 1.0).abs() < 1e-6));
        first
    };
    let heave = run_pair(&noisy(), &[values([0.0; 3], [0.0, 0.0, 0.2])], 3800, level);
    nothing_before(&heave, 101);
    nothing_after(&heave, 3501);
    let height = |k: usize| heave[k].truth.height_m - heave[k].twin_truth.height_m;
    assert!((square(&height, 8.0) - 0.2).abs() < 1e-9);
    assert!(heave.iter().all(|pair| pair.step.aiding == pair.twin.aiding));
    // The gyro along the roll axis measures the roll; Earth rate along it is unchanged.
    let roll = run_pair(&perfect(), &[values([3.0 * DEG, 0.0, 0.0], [0.0; 3])], 3800, level);
    let angle = gathered(&roll, 0);
    assert!((square(&|k| angle[k], 8.0) - 3.0 * DEG).abs() < 1e-9);
    // All six at once: each onset draws other numbers.
    let all = || values([3.0 * DEG, 1.5 * DEG, 1.0 * DEG], [0.2; 3]);
    let once = run_pair(&perfect(), &[all()], 1000, level);
    let mut other = perfect();
    other.seed = 2;
    let differently = run_pair(&other, &[all()], 1000, level);
    assert_ne!(once[900].truth, differently[900].truth);
    assert_eq!(once[900].truth, run_pair(&perfect(), &[all()], 1000, level)[900].truth);
}
