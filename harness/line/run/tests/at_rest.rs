//! Stretches at rest, and the Allan variance in them.

use octant_earth::units::DEG;
use octant_run::observers::at_rest::AtRest;
use octant_sample::DeviceTime;
use octant_sample::counts::DELTA_THETA_LSB_RAD;
use octant_sample::{GimbalAngles, Sample, Status};

const PERIOD_NS: u64 = 5_000_000;

/// Makes samples of an instrument at rest, in order.
struct Source {
    sequence: u64,
    gimbal: GimbalAngles,
    status: Status,
}

impl Source {
    fn new() -> Self {
        let (gimbal, status) = (GimbalAngles::default(), Status::empty());
        Self { sequence: 0, gimbal, status }
    }

    /// Gives samples of this rate to the estimate; gimbal angles flicker by 100 counts (0.15″).
    fn give(&mut self, to: &mut AtRest, samples: u64, rate_counts: i32) {
        for _ in 0..samples {
            self.sequence += 1;
            let flicker = (self.sequence * 7919 % 201) as i32 - 100;
            to.push(&Sample {
                sequence: self.sequence,
                device_time: DeviceTime { ns: self.sequence * PERIOD_NS },
                delta_theta: [rate_counts + flicker, -rate_counts, 3],
                delta_velocity: [0, 0, -52_000_000],
                gimbal: GimbalAngles { azimuth: self.gimbal.azimuth + flicker, ..self.gimbal },
                status: self.status,
            });
        }
    }
}

#[test]
fn a_dwell_counts_but_for_a_second_at_both_ends() {
    let (mut source, mut rest) = (Source::new(), AtRest::new(PERIOD_NS, false));
    assert_eq!(rest.block_samples(), 16);
    source.give(&mut rest, 20_000, 25_000);
    let found = rest.record();
    assert_eq!(found.stretches, 1);
    // 100 s; the first block has none before it, and a guard has 13 blocks of 0.08 s.
    assert!((found.at_rest_s - (100.0 - 27.0 * 0.08)).abs() < 0.081, "{}", found.at_rest_s);
    assert_eq!(found.longest_s, found.at_rest_s);
    assert_eq!(found.octaves[0].tau_s, 0.005);
    assert_eq!(found.octaves[3].tau_s, 0.04);
    assert_eq!(found.octaves[4].tau_s, 0.08);
    let times: Vec<f64> = found.octaves.iter().map(|octave| octave.tau_s).collect();
    assert!(times.windows(2).all(|pair| (pair[1] / pair[0] - 2.0).abs() < 1e-12), "{times:?}");
    // Channels that don't scatter have no variance, whatever their mean.
    assert!(found.octaves.iter().all(|octave| octave.variance[1..] == [0.0; 5]));
    assert!(found.octaves[0].variance[0] > 0.0);
}

/// Rotation during a move must not enter the variance: its counts are 10⁵ times the scatter.
#[test]
fn a_move_leaves_no_trace() {
    let (mut source, mut rest) = (Source::new(), AtRest::new(PERIOD_NS, false));
    let mut calm = AtRest::new(PERIOD_NS, false);
    Source::new().give(&mut calm, 20_000, 25_000);
    let largest = calm.record().octaves[0].variance[0];
    for stop in 1..=6 {
        source.give(&mut rest, 4000, 25_000);
        // A move at first slower than the tolerance: 0.5 s with 1°/s², then fast.
        for step in 1..=100i32 {
            source.gimbal.roll += step * 58;
            source.give(&mut rest, 1, 25_000 + step * 60_000);
        }
        for step in 1..=60 {
            source.gimbal.roll = (stop - 1) * 210_000_000 + step * 3_500_000;
            source.give(&mut rest, 1, 60_000_000);
        }
    }
    let found = rest.record();
    assert_eq!(found.stretches, 6);
    // 20 s, and 63 samples of the move: 58 counts · n (n + 1)/2 reach the tolerance of 117 000 there. The guards
    // and half a block are left out.
    let expected_s = 6.0 * (20.0 + 63.0 * 0.005 - 27.5 * 0.08);
    assert!((found.at_rest_s - expected_s).abs() < 6.0 * 0.08, "{}", found.at_rest_s);
    for octave in &found.octaves {
        assert!(octave.variance[0] <= 4.0 * largest, "{octave:?}");
        assert_eq!(octave.variance[1..], [0.0; 5], "{octave:?}");
    }
}

#[test]
fn missing_and_flagged_samples_end_a_stretch() {
    let flags = [Status::GYRO_SATURATED, Status::ACCELEROMETER_SATURATED, Status::INERTIAL_INVALID];
    let (mut source, mut rest) = (Source::new(), AtRest::new(PERIOD_NS, false));
    source.give(&mut rest, 2000, 0);
    for (stretches, flag) in flags.into_iter().enumerate() {
        assert_eq!(rest.record().stretches, stretches as u64 + 1);
        source.status = flag;
        source.give(&mut rest, 1, 0);
        source.status = Status::empty();
        source.give(&mut rest, 2000, 0);
    }
    source.sequence += 1;
    source.give(&mut rest, 2000, 0);
    assert_eq!(rest.record().stretches, 5);
}

/// Without valid gimbal angles the unit's word and the sensors decide, whatever their biases; a base
/// that moves turns.
#[test]
fn without_gimbal_angles_the_unit_and_the_sensors_decide() {
    let (mut source, mut rest) = (Source::new(), AtRest::new(PERIOD_NS, false));
    source.status = Status::GIMBAL_INVALID;
    // A bias of 5 °/s, and a turn 1 °/s faster.
    let counts = |rate_dps: f64| (rate_dps * DEG * 0.005 / DELTA_THETA_LSB_RAD) as i32;
    let (bias, turn) = (counts(5.0), counts(6.0));
    source.give(&mut rest, 2000, bias);
    rest.unit_moves(true);
    source.give(&mut rest, 1, bias);
    rest.unit_moves(false);
    source.give(&mut rest, 2000, bias);
    assert_eq!(rest.record().stretches, 2);
    source.give(&mut rest, 32, turn);
    source.give(&mut rest, 2000, bias);
    assert_eq!(rest.record().stretches, 3);
    let mut moving = AtRest::new(PERIOD_NS, true);
    for _ in 0..100 {
        source.give(&mut moving, 100, bias);
        source.give(&mut moving, 100, turn);
    }
    assert_eq!(moving.record().stretches, 1);
}

#[test]
fn slow_samples_are_blocks_of_their_own() {
    let mut rest = AtRest::new(1_000_000_000, false);
    for sequence in 1..=100 {
        rest.push(&Sample {
            sequence,
            device_time: DeviceTime { ns: sequence * 1_000_000_000 },
            ..Sample::default()
        });
    }
    let found = rest.record();
    assert_eq!((found.stretches, found.at_rest_s), (1, 97.0));
    assert_eq!(found.octaves[0].tau_s, 1.0);
}
