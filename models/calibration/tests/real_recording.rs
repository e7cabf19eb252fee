//! The least-squares estimator on a real recording: a MEMS unit turned by hand through some forty
//! attitudes. The reference values come from an independent program (see the recording's README).

use octant_calibration::config::{GyroReference, LeastSquares, Site, StaticIntervals};
use octant_calibration::least_squares::raw::{self, Nominal};
use octant_calibration::least_squares::{Adjustment, AdjustmentRefusal, LeastSquaresEstimator};
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{DeviceTime, Parameters, Sample};
use std::path::{Path, PathBuf};

/// Samples per row: the unit was turned by hand at up to 390 °/s, and an increment at 100 Hz holds
/// 179 °/s.
const PARTS: usize = 2;
const PERIOD_NS: u64 = 10_000_000 / PARTS as u64;
const GYRO: Nominal = Nominal { bias_counts: [32768.0; 3], scale: [1.0 / 6258.0; 3] };
const ACCELEROMETER: Nominal = Nominal { bias_counts: [32768.0; 3], scale: [0.00242; 3] };

fn folder() -> PathBuf {
    std::env::var_os("OCTANT_RECORDINGS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings"),
        PathBuf::from,
    )
}

/// Reads a table with columns time, x, y, z.
fn table(path: &Path) -> Vec<[f64; 4]> {
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text.lines().map(|line| {
        let mut fields = line.split_whitespace().map(|field| field.parse::<f64>().unwrap());
        core::array::from_fn(|_| fields.next().unwrap())
    });
    rows.collect()
}

/// Makes samples over the intervals between rows. The rate of a row applies to the interval before
/// it.
fn samples(folder: &Path) -> Vec<(Sample, f64)> {
    let accelerometer = table(&folder.join("accelerometer.txt"));
    let gyroscope = table(&folder.join("gyroscope.txt"));
    assert_eq!(accelerometer.len(), gyroscope.len());
    let mut carry = [Accumulator::default(); 6];
    let mut all = Vec::new();
    for part in PARTS..PARTS * gyroscope.len() {
        let k = part / PARTS;
        let dt_s = (gyroscope[k][0] - gyroscope[k - 1][0]) / PARTS as f64;
        let sequence = all.len() as u64 + 1;
        let mut sample = Sample {
            sequence,
            device_time: DeviceTime::from_ns(sequence * PERIOD_NS),
            ..Sample::default()
        };
        for axis in 0..3 {
            let rate = GYRO.scale[axis] * (gyroscope[k][axis + 1] - GYRO.bias_counts[axis]);
            let force = ACCELEROMETER.scale[axis]
                * (accelerometer[k][axis + 1] - ACCELEROMETER.bias_counts[axis]);
            let theta = carry[axis].count(rate * dt_s / DELTA_THETA_LSB_RAD);
            let velocity = carry[axis + 3].count(force * dt_s / DELTA_VELOCITY_LSB_MPS);
            assert!(!theta.saturated && !velocity.saturated, "row {k} is out of range");
            sample.delta_theta[axis] = theta.value;
            sample.delta_velocity[axis] = velocity.value;
        }
        all.push((sample, dt_s));
    }
    all
}

fn pass(samples: &[(Sample, f64)], initial: &Parameters) -> Result<Adjustment, AdjustmentRefusal> {
    let settings = LeastSquares {
        gravity_mps2: Some(9.81744),
        gyro: GyroReference::RotatedGravity,
        intervals: StaticIntervals::Detected {
            initial_s: 50.0,
            window_s: 1.0,
            threshold: 3.0,
            shortest_s: 1.0,
        },
    };
    let site = Site { latitude_rad: 0.0, longitude_rad: 0.0, height_m: 0.0 };
    let mut estimator = LeastSquaresEstimator::new(&settings, &site, PERIOD_NS, initial)?;
    for (sample, dt_s) in samples {
        estimator.step(sample, *dt_s, None);
    }
    estimator.finish()
}

#[test]
fn the_values_of_an_independent_program_are_reproduced() {
    let folder = folder().join("xsens-multiposition");
    if !folder.join("gyroscope.txt").is_file() {
        println!("skipped: no recording in {} (set OCTANT_RECORDINGS)", folder.display());
        return;
    }
    let samples = samples(&folder);
    // Nominal scales are wrong by a quarter: several passes, until a pass changes nothing.
    let mut estimate = pass(&samples, &Parameters::default()).unwrap();
    for number in 2..10 {
        let before = estimate.parameters.to_array();
        estimate = pass(&samples, &estimate.parameters).unwrap();
        let after = estimate.parameters.to_array();
        let change = before.iter().zip(&after).map(|(b, a)| (b - a).abs()).fold(0.0, f64::max);
        println!("pass {number}: largest change {change:.1e}");
        if change < 1e-9 {
            break;
        }
    }
    let accelerometer = raw::accelerometer(&estimate.parameters, &ACCELEROMETER).unwrap();
    let gyroscope = raw::gyroscope(&estimate.parameters, &GYRO).unwrap();
    println!("{estimate:#?}\n{accelerometer:#?}\n{gyroscope:#?}");

    let near = |what: &str, found: f64, expected: f64, tolerance: f64| {
        println!("{what}: {found:.7} (reference {expected:.7}, {:+.2e})", found - expected);
        assert!((found - expected).abs() <= tolerance, "{what}: {found}, expected {expected}");
    };
    let (k, t) = (accelerometer.scale, accelerometer.cross);
    for (axis, expected) in [33123.8, 33275.1, 32364.5].into_iter().enumerate() {
        near("accelerometer bias", accelerometer.bias_counts[axis], expected, 0.5);
    }
    for (axis, expected) in [0.0024129, 0.0024264, 0.0024125].into_iter().enumerate() {
        near("accelerometer scale", k[axis], expected, 1e-7);
    }
    near("T yx", t[1][0], -0.00359, 5e-4);
    near("T zx", t[2][0], -0.00918, 5e-4);
    near("T zy", t[2][1], -0.02134, 5e-4);
    near("gravity residual", estimate.gravity_residual_rms_mps2, 1.03e-3, 1e-4);

    let (k, t) = (gyroscope.scale, gyroscope.cross);
    for (axis, expected) in [32777.14, 32459.81, 32511.84].into_iter().enumerate() {
        near("gyro bias", gyroscope.bias_counts[axis], expected, 0.5);
    }
    for (axis, expected) in [2.0935e-4, 2.0982e-4, 2.0962e-4].into_iter().enumerate() {
        near("gyro scale", k[axis], expected, 0.01 * expected);
    }
    let cross = [
        ("xy", t[0][1], 0.0093),
        ("xz", t[0][2], 0.0102),
        ("yx", t[1][0], 0.0052),
        ("yz", t[1][2], -0.0322),
        ("zx", t[2][0], 0.0159),
        ("zy", t[2][1], -0.0240),
    ];
    for (what, found, expected) in cross {
        near(what, found, expected, 3e-3);
    }
}
