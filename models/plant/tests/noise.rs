//! Noise of the streams: size, slopes of the Allan deviation, independence.

use super::common::*;
use octant_earth::units::{DEG, DEG_PER_HOUR, MICRO_G};
use octant_plant::config::*;
use octant_plant::{Plant, PlantStep};
use octant_sample::Reference;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};

fn golden(name: &str) -> f64 {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/golden/sensor_noise.json");
    let text = std::fs::read_to_string(path).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    json[name].as_f64().unwrap()
}

/// Increments of gyro and accelerometer without those of a noiseless plant, in SI.
fn noise_of(config: &PlantConfig, samples: u64) -> Vec<[f64; 6]> {
    let mut quiet = config.clone();
    quiet.imu.angle_random_walk = 0.0;
    quiet.imu.velocity_random_walk = 0.0;
    quiet.imu.extensions = Extensions::default();
    let (mut plant, mut quiet) = (Plant::new(config).unwrap(), Plant::new(&quiet).unwrap());
    let level = command(0.0, 0.0);
    (0..samples)
        .map(|_| {
            let (a, b) = (plant.step(&level).sample, quiet.step(&level).sample);
            core::array::from_fn(|i| {
                if i < 3 {
                    f64::from(a.delta_theta[i] - b.delta_theta[i]) * DELTA_THETA_LSB_RAD
                } else {
                    let (a, b) = (a.delta_velocity[i - 3], b.delta_velocity[i - 3]);
                    f64::from(a - b) * DELTA_VELOCITY_LSB_MPS
                }
            })
        })
        .collect()
}

#[test]
fn sigma_is_that_of_the_specification() {
    let n = 400_000;
    let noise = noise_of(&noisy(), n);
    for axis in 0..6 {
        let expected =
            golden(if axis < 3 { "sigma_delta_theta_rad" } else { "sigma_delta_velocity_ms" });
        let mean = noise.iter().map(|x| x[axis]).sum::<f64>() / n as f64;
        let variance = noise.iter().map(|x| (x[axis] - mean).powi(2)).sum::<f64>() / n as f64;
        // Five standard errors, 1/√(2n), and the two roundings to counts, below 1e-6 of it.
        let bound = 5.0 / (2.0 * n as f64).sqrt();
        assert!((variance.sqrt() / expected - 1.0).abs() < bound, "axis {axis}");
        assert!(mean.abs() < 5.0 * expected / (n as f64).sqrt());
        let lag: f64 = noise.windows(2).map(|w| w[0][axis] * w[1][axis]).sum();
        assert!((lag / n as f64 / expected.powi(2)).abs() < 5.0 / (n as f64).sqrt());
        for other in 0..axis {
            let scale = (noise.iter().map(|x| x[other].powi(2)).sum::<f64>() * variance).sqrt();
            let product: f64 = noise.iter().map(|x| x[axis] * x[other]).sum();
            assert!((product / scale).abs() < 5.0, "axes {axis} and {other}");
        }
    }
}

/// Overlapping Allan deviation of the rate at a cluster of `m` samples (IEEE 647, annex C).
fn allan(increments: &[[f64; 6]], axis: usize, m: usize) -> f64 {
    let mut angle = vec![0.0];
    for x in increments {
        angle.push(angle[angle.len() - 1] + x[axis]);
    }
    let tau = m as f64 * DT;
    let n = angle.len() - 2 * m;
    let sum: f64 = (0..n).map(|k| (angle[k + 2 * m] - 2.0 * angle[k + m] + angle[k]).powi(2)).sum();
    (sum / (2.0 * tau * tau * n as f64)).sqrt()
}

#[test]
fn white_noise_falls_with_the_root_of_time() {
    let config = noisy();
    let noise = noise_of(&config, 400_000);
    for m in [1, 10, 100, 1000] {
        let tau = m as f64 * DT;
        // 400 clusters of 1000: 5 standard errors of the deviation are 18 %.
        let bound = 5.0 / (2.0 * 400_000.0 / m as f64).sqrt();
        let expected = config.imu.angle_random_walk / tau.sqrt();
        assert!((allan(&noise, 1, m) / expected - 1.0).abs() < bound, "{m}");
        let expected = config.imu.velocity_random_walk / tau.sqrt();
        assert!((allan(&noise, 4, m) / expected - 1.0).abs() < bound, "{m}");
    }
}

#[test]
fn rate_random_walk_rises_with_the_root_of_time() {
    let mut config = perfect();
    let k = 1.0 * DEG_PER_HOUR;
    config.imu.extensions.gyro_rate_random_walk = k;
    let noise = noise_of(&config, 800_000);
    for m in [200, 1000, 4000] {
        let tau = m as f64 * DT;
        let expected = k * (tau / 3.0).sqrt();
        let bound = 5.0 / (2.0 * 800_000.0 / m as f64).sqrt();
        let found = (0..3).map(|axis| allan(&noise, axis, m).powi(2)).sum::<f64>() / 3.0;
        assert!((found.sqrt() / expected - 1.0).abs() < bound, "{m} {}", found.sqrt() / expected);
    }
}

/// With enough dither the rounding is uniform and white: variance q²/12 of the angle, and the
/// Allan deviation √3 · (q/√12) / τ falls with time itself.
#[test]
fn quantization_falls_with_time() {
    let mut config = noisy();
    let quantum = 6.0 * golden("sigma_delta_theta_rad");
    config.imu.extensions.gyro_quantization_rad = quantum;
    let coarse = noise_of(&config, 200_000);
    let fine = noise_of(&noisy(), 200_000);
    let rounding: Vec<[f64; 6]> = coarse
        .iter()
        .zip(&fine)
        .map(|(a, b)| core::array::from_fn(|axis| a[axis] - b[axis]))
        .collect();
    for m in [20, 100, 500] {
        let tau = m as f64 * DT;
        let expected = 3.0f64.sqrt() * quantum / 12.0f64.sqrt() / tau;
        let ratio = allan(&rounding, 0, m) / expected;
        assert!((ratio - 1.0).abs() < 0.1, "{m} {ratio}");
    }
    assert!(rounding.iter().all(|x| x[3] == 0.0));
}

#[test]
fn gauss_markov_has_its_variance_and_correlation() {
    let mut config = perfect();
    let process = GaussMarkov { sigma: 1.0 * DEG_PER_HOUR, correlation_time_s: 0.5 };
    config.imu.extensions.gyro_gauss_markov = Some(process);
    config.imu.extensions.accel_gauss_markov =
        Some(GaussMarkov { sigma: 100.0 * MICRO_G, correlation_time_s: 0.5 });
    let n = 1_000_000usize;
    let noise = noise_of(&config, n as u64);
    // The increment is ½ dt (x(k) + x(k+1)) but for (dt/τ)²/12: 8e-6.
    let a = libm::exp(-DT / 0.5);
    for (axis, sigma) in [(0, process.sigma), (1, process.sigma), (4, 100.0 * MICRO_G)] {
        let x = |k: usize| noise[k][axis] / (sigma * DT);
        // Variance of a variance estimate over T: 2 τ / T, with τ = 100 samples.
        let bound = 5.0 * (2.0 * 100.0 / n as f64).sqrt();
        let variance = (0..n).map(|k| x(k) * x(k)).sum::<f64>() / n as f64;
        assert!((variance - 0.5 * (1.0 + a)).abs() < bound, "{axis} {variance}");
        let lag = 100;
        let covariance = (0..n - lag).map(|k| x(k) * x(k + lag)).sum::<f64>() / (n - lag) as f64;
        assert!((covariance - libm::exp(-1.0)).abs() < bound, "{axis} {covariance}");
    }
}

#[test]
fn gauss_markov_starts_in_its_stationary_distribution() {
    let mut sum = 0.0;
    let seeds = 400;
    for seed in 0..seeds {
        let mut config = perfect();
        config.seed = seed;
        config.imu.extensions.gyro_gauss_markov =
            Some(GaussMarkov { sigma: 1.0 * DEG_PER_HOUR, correlation_time_s: 3600.0 });
        for x in &noise_of(&config, 1)[0][..3] {
            sum += (x / (DEG_PER_HOUR * DT)).powi(2);
        }
    }
    let n = 3.0 * seeds as f64;
    // Both plants round to counts, of which 1 °/h in 5 ms is 1670: this adds 1/6 of a count².
    let count = DELTA_THETA_LSB_RAD / (DEG_PER_HOUR * DT);
    let expected = 1.0 + count * count / 6.0;
    assert!((sum / n - expected).abs() < 5.0 * (2.0 / n).sqrt() * expected, "{}", sum / n);
}

/// Autocovariance of averages over τ that are `lag` clusters apart, of a sum of Gauss-Markov
/// processes: for one of variance s² and correlation time T, with x = τ / T, the integral of
/// `s² exp(−|t − t'| / T)` over both clusters, divided by τ².
fn cluster_covariance(processes: &[GaussMarkov], tau: f64, lag: usize) -> f64 {
    let of_one = |process: &GaussMarkov| {
        let (s2, x) = (process.sigma.powi(2), tau / process.correlation_time_s);
        match lag {
            0 => 2.0 * s2 / (x * x) * (x + (-x).exp_m1()),
            _ => s2 / (x * x) * (-x).exp_m1().powi(2) * (-x * (lag - 1) as f64).exp(),
        }
    };
    processes.iter().map(of_one).sum()
}

/// Allan variance of a sum of Gauss-Markov processes (IEEE Std 952-1997, C.1.5, with s² = q² T / 2).
fn allan_variance(processes: &[GaussMarkov], tau: f64) -> f64 {
    let of_one = |process: &GaussMarkov| {
        let (s2, t) = (process.sigma.powi(2), process.correlation_time_s);
        let x = tau / t;
        let bracket = 1.0 - (3.0 - 4.0 * (-x).exp() + (-2.0 * x).exp()) / (2.0 * x);
        2.0 * s2 * t / tau * bracket
    };
    processes.iter().map(of_one).sum()
}

/// Relative standard deviation of an Allan variance from `clusters` clusters without overlap: the
/// differences of neighbours are Gaussian, so that the mean of their squares has the variance
/// `2 Σ R(j − k)² / n²`.
fn allan_spread(processes: &[GaussMarkov], tau: f64, clusters: usize) -> f64 {
    let c = |lag: isize| cluster_covariance(processes, tau, lag.unsigned_abs());
    let n = clusters as isize - 1;
    let difference = |lag: isize| 2.0 * c(lag) - c(lag - 1) - c(lag + 1);
    let at_zero = difference(0);
    let sum: f64 =
        (1 - n..n).map(|lag| (n - lag.abs()) as f64 * (difference(lag) / at_zero).powi(2)).sum();
    (2.0 * sum).sqrt() / n as f64
}

/// √(2 ln 2 / π): the floor of the Allan deviation of flicker noise of coefficient 1.
const FLOOR: f64 = 0.664_282;

/// The band of the documentation: within 1 % from 16 s to 9 h, within 3 % from 8 s to 18 h.
#[test]
fn the_processes_of_a_bias_instability_have_a_flat_floor() {
    let processes = octant_plant::flicker::processes(1.0);
    for step in 0..=260 {
        let tau = 8.0 * (step as f64 * 0.05 * std::f64::consts::LN_2).exp();
        let found = allan_variance(&processes, tau).sqrt() / FLOOR;
        let slack = if (16.0..=32_768.0).contains(&tau) { 0.01 } else { 0.03 };
        assert!((found - 1.0).abs() < slack, "{tau} s: {found}");
        let other = cluster_covariance(&processes, tau, 0) - cluster_covariance(&processes, tau, 1);
        assert!((allan_variance(&processes, tau) / other - 1.0).abs() < 1e-6, "{tau} s");
    }
    let sigma = processes.iter().map(|process| process.sigma.powi(2)).sum::<f64>().sqrt();
    assert!((sigma - 2.065).abs() < 1e-3, "{sigma}");
}

/// 42 h at 10 Hz: the six axes have independent noise of the same shape.
#[test]
fn bias_instability_has_the_floor_of_its_coefficient() {
    let mut config = perfect();
    config.sample_period_ns = 100_000_000;
    let (gyro, accelerometer) = (1.0 * DEG_PER_HOUR, 50.0 * MICRO_G);
    config.imu.extensions.gyro_bias_instability = gyro;
    config.imu.extensions.accel_bias_instability = accelerometer;
    let noise = noise_of(&config, 1_500_000);
    let processes = octant_plant::flicker::processes(1.0);
    for m in [160, 640, 2560, 10_240] {
        let tau = m as f64 * 0.1;
        let clusters = noise.len() / m;
        let mut variance = 0.0;
        for axis in 0..6 {
            let unit = if axis < 3 { gyro } else { accelerometer } * tau;
            let averages: Vec<f64> = noise
                .chunks_exact(m)
                .map(|cluster| cluster.iter().map(|x| x[axis]).sum::<f64>() / unit)
                .collect();
            let squares: f64 = averages.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
            variance += squares / (2.0 * (clusters - 1) as f64) / 6.0;
        }
        // Five standard errors of the mean of six.
        let bound = 5.0 * allan_spread(&processes, tau, clusters) / 6.0f64.sqrt();
        let found = variance / allan_variance(&processes, tau);
        assert!((found - 1.0).abs() < bound, "{tau} s: {found}, bound {bound}");
        let floor = variance / FLOOR.powi(2);
        assert!((floor - 1.0).abs() < bound + 0.02, "{tau} s: {floor}, bound {bound}");
    }
}

#[test]
fn bias_instability_starts_in_its_stationary_distribution() {
    let (mut sums, seeds) = ([0.0; 2], 300);
    for seed in 0..seeds {
        let mut config = perfect();
        config.seed = seed;
        config.imu.extensions.gyro_bias_instability = 10.0 * DEG_PER_HOUR;
        config.imu.extensions.accel_bias_instability = 1000.0 * MICRO_G;
        for (axis, x) in noise_of(&config, 1)[0].iter().enumerate() {
            let unit = if axis < 3 { 10.0 * DEG_PER_HOUR } else { 1000.0 * MICRO_G } * DT;
            sums[axis / 3] += (x / unit).powi(2);
        }
    }
    let n = 3.0 * seeds as f64;
    let processes = octant_plant::flicker::processes(1.0);
    let expected: f64 = processes.iter().map(|process| process.sigma.powi(2)).sum();
    for sum in sums {
        // The average over one sample has less than the variance of an instant, by a third of
        // dt / T for each process: 2e-4 of it. Rounding to counts adds below 1e-6.
        let bound = 5.0 * (2.0 / n).sqrt() + 3e-4;
        assert!((sum / n / expected - 1.0).abs() < bound, "{}", sum / n / expected);
    }
}

fn steps(config: &PlantConfig, samples: u64) -> Vec<PlantStep> {
    run(&mut Plant::new(config).unwrap(), &command(0.0, 0.0), samples)
}

#[test]
fn what_is_added_to_one_sensor_moves_no_other() {
    let base = steps(&noisy(), 2000);
    let mut config = noisy();
    config.imu.extensions.gyro_gauss_markov =
        Some(GaussMarkov { sigma: DEG_PER_HOUR, correlation_time_s: 100.0 });
    config.imu.extensions.gyro_rate_random_walk = DEG_PER_HOUR;
    config.imu.extensions.gyro_bias_instability = DEG_PER_HOUR;
    config.imu.extensions.gyro_quantization_rad = 1e-8;
    config.aiding.period_ns = PERIOD_NS;
    config.turntable.encoder_sigma_rad = 1e-5;
    let other = steps(&config, 2000);
    for (a, b) in base.iter().zip(&other) {
        assert_eq!(a.sample.delta_velocity, b.sample.delta_velocity);
        if let Some(aiding) = a.aiding {
            assert_eq!(Some(aiding), b.aiding, "the noise of a stamp is that of its sample");
        }
    }
    assert!(base.iter().zip(&other).any(|(a, b)| a.sample.delta_theta != b.sample.delta_theta));
    // The gyros' white noise doesn't change when a random walk is added.
    let mut config = noisy();
    config.imu.extensions.gyro_rate_random_walk = DEG_PER_HOUR;
    let mut alone = perfect();
    alone.imu.extensions.gyro_rate_random_walk = DEG_PER_HOUR;
    let (both, alone) = (noise_of(&config, 2000), noise_of(&alone, 2000));
    for ((both, alone), white) in both.iter().zip(&alone).zip(noise_of(&noisy(), 2000)) {
        assert!((both[0] - alone[0] - white[0]).abs() < 4.0 * DELTA_THETA_LSB_RAD);
    }
}

#[test]
fn navigation_meets_the_same_noise_after_any_calibration() {
    let navigation = |calibration_samples: u64| {
        let mut config = noisy();
        config.calibration_samples = calibration_samples;
        let all = noise_of(&config, calibration_samples + 1000);
        all[calibration_samples as usize..].to_vec()
    };
    let (short, long) = (navigation(500), navigation(1700));
    for (a, b) in short.iter().zip(&long) {
        for axis in 0..6 {
            // The remainders carried into the navigation differ: by a few counts.
            let lsb = if axis < 3 { DELTA_THETA_LSB_RAD } else { DELTA_VELOCITY_LSB_MPS };
            assert!((a[axis] - b[axis]).abs() <= 4.0 * lsb);
        }
    }
    let all = noise_of(&noisy(), 1000);
    assert!((all[3][0] - short[3][0]).abs() > 4.0 * DELTA_THETA_LSB_RAD, "another phase");
}

#[test]
fn the_reference_has_its_period_noise_and_end() {
    let mut config = noisy();
    config.aiding.period_ns = 10_000_000;
    config.motion = Motion::Dockside(octant_plant::motion::dockside_default(1));
    config.calibration_samples = 40_000;
    for kind in [
        AidingKind::ZeroVelocity { sigma_mps: 0.001 },
        AidingKind::Velocity { sigma_mps: 0.001 },
        AidingKind::DockPosition { sigma_m: 0.2 },
    ] {
        config.aiding.kind = kind;
        let mut plant = Plant::new(&config).unwrap();
        let (mut sum, mut n) = ([0.0; 3], 0.0);
        for k in 1..=40_400u64 {
            let step = plant.step(&command(0.0, 0.0));
            assert_eq!(step.aiding.is_some(), k % 2 == 0 && k <= 40_000);
            let Some(aiding) = step.aiding else { continue };
            assert_eq!(aiding.device_time, step.sample.device_time);
            let truth = plant.truth();
            let error: [f64; 3] = match (aiding.reference, kind) {
                (Reference::Velocity(v), AidingKind::Velocity { .. }) => {
                    core::array::from_fn(|i| (v[i] - truth.velocity_mps[i]) / 0.001)
                }
                (Reference::Velocity(v), _) => v.map(|v| v / 0.001),
                (Reference::Position { latitude_rad, longitude_rad, height_m }, _) => [
                    (latitude_rad - config.site.latitude_rad) * 6_352_000.0 / 0.2,
                    (longitude_rad - config.site.longitude_rad)
                        * 6_383_700.0
                        * libm::cos(30.5 * DEG)
                        / 0.2,
                    (height_m - config.site.height_m) / 0.2,
                ],
            };
            n += 1.0;
            for axis in 0..3 {
                sum[axis] += error[axis] * error[axis];
            }
        }
        for total in sum {
            assert!((total / n - 1.0).abs() < 5.0 * (2.0f64 / n).sqrt(), "{kind:?} {}", total / n);
        }
    }
}
