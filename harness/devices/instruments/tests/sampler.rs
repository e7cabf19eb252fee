//! Conversion of readings to samples: counts with remainders, axes, numbers and time.

use crate::common::{self, frames, only, reading};
use octant_instruments::{
    Axes, MeasuredTriad, Protocol, Reading, Sampler, SamplerSettings, Stamp, Unusable,
};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};
use proptest::prelude::*;

const PERIOD_NS: u64 = 5_000_000;

fn sampler(axes: &str) -> Sampler {
    Sampler::new(SamplerSettings { axes: Axes::parse(axes).unwrap(), rate_hz: 200.0 })
}

/// The rate is constant and far below a count: the sum of the counts equals the closed form within half
/// a count.
#[test]
fn counts_follow_the_integral() {
    // Rotation of the Earth at a latitude of 30°; down is the unit's z.
    let (rate, g) = (7.292115e-5 * 0.5, -9.793);
    let mut sampler = sampler("x y z");
    let mut sums = [0i64; 2];
    for number in 1..=20_000u64 {
        let told = Reading {
            rotation: Some(MeasuredTriad::mean([0.0, 0.0, rate])),
            velocity: Some(MeasuredTriad::mean([0.0, 0.0, g])),
            interval_s: None,
            ..reading(number)
        };
        let sample = sampler.sample(&told, None).unwrap();
        sums[0] += i64::from(sample.delta_theta[2]);
        sums[1] += i64::from(sample.delta_velocity[2]);
        let time_s = number as f64 * 0.005;
        let off = sums[0] as f64 - rate * time_s / DELTA_THETA_LSB_RAD;
        assert!(off.abs() <= 0.5 + 1e-6, "{off}");
        let off = sums[1] as f64 - g * time_s / DELTA_VELOCITY_LSB_MPS;
        assert!(off.abs() <= 0.5 + 1e-3, "{off}");
    }
    assert_eq!(sampler.counters().missing + sampler.counters().irregular, 0);
}

proptest! {
    /// A sample sent over the Octant wire is received unchanged, count for count.
    #[test]
    fn counts_are_exact_on_our_own_wire(
        all in proptest::collection::vec(any::<([i32; 3], [i32; 3], i32, i32)>(), 1..30),
    ) {
        let mut encoder = octant_instruments::own::OwnEncoder::new();
        let mut sampler = sampler("x y z");
        for (number, (delta_theta, delta_velocity, azimuth, roll)) in (1..).zip(all) {
            let most = |count: i32| count.clamp(-i32::MAX + 1, i32::MAX - 1);
            let sample = Sample {
                sequence: number,
                device_time: DeviceTime { ns: number * PERIOD_NS },
                delta_theta: delta_theta.map(most),
                delta_velocity: delta_velocity.map(most),
                gimbal: GimbalAngles { azimuth, roll },
                status: Status::empty(),
            };
            let frame = encoder.encode(&Reading::of_sample(&sample)).unwrap();
            let said = only(Protocol::Octant, frame);
            prop_assert_eq!(sampler.sample(&said, None).unwrap(), sample);
        }
    }
}

#[test]
fn the_unit_is_turned_to_the_body() {
    // Mounted upside down with a quarter turn: body x is the unit's −y.
    let mut sampler = sampler("-y -x -z");
    let told = Reading {
        rotation: Some(MeasuredTriad::increment([1e-3, 2e-3, 3e-3])),
        velocity: Some(MeasuredTriad::increment([0.1, 0.2, 0.3])),
        ..reading(1)
    };
    let sample = sampler.sample(&told, Some(GimbalAngles { azimuth: 4, roll: 5 })).unwrap();
    let near = |count: i32, lsb: f64, value: f64| {
        assert!((f64::from(count) * lsb - value).abs() <= 0.5 * lsb, "{count} {value}");
    };
    for (axis, factor) in [(0, -2.0), (1, -1.0), (2, -3.0)] {
        near(sample.delta_theta[axis], DELTA_THETA_LSB_RAD, factor * 1e-3);
        near(sample.delta_velocity[axis], DELTA_VELOCITY_LSB_MPS, factor * 0.1);
    }
    assert_eq!(sample.gimbal, GimbalAngles { azimuth: 4, roll: 5 });
    assert_eq!(sample.status, Status::empty());
}

#[test]
fn gaps_show_in_number_and_time() {
    // Gaps found by sequence number.
    let mut with_number = sampler("x y z");
    // Gaps found by stamps alone.
    let mut with_stamp = sampler("x y z");
    for (told, expected) in [(100, 1), (101, 2), (105, 6), (106, 7)] {
        let told = reading(told);
        let sample = with_number.sample(&told, None).unwrap();
        assert_eq!((sample.sequence, sample.device_time.ns), (expected, expected * PERIOD_NS));
        assert_eq!(sample.status, Status::GIMBAL_INVALID);
        let sample = with_stamp.sample(&Reading { sequence: None, ..told }, None).unwrap();
        assert_eq!((sample.sequence, sample.device_time.ns), (expected, expected * PERIOD_NS));
    }
    assert_eq!((with_number.counters().missing, with_stamp.counters().missing), (3, 3));
    for mut sampler in [with_number, with_stamp] {
        for late in [106, 103] {
            assert_eq!(sampler.sample(&reading(late), None), Err(Unusable::Behind));
        }
        assert_eq!(sampler.counters().behind, 2);
        assert_eq!(sampler.sample(&reading(107), None).unwrap().sequence, 8);
    }
    // Stamps that jitter by two fifths of a period are no gaps.
    let mut jittering = sampler("x y z");
    for number in 1..1000u64 {
        let ns = number * PERIOD_NS + (number * 7919) % 2_000_000;
        let stamp = Some(Stamp { ns, ..reading(1).stamp.unwrap() });
        let told = Reading { sequence: None, stamp, ..reading(number) };
        assert_eq!(jittering.sample(&told, None).unwrap().sequence, number);
    }
    // Without number and stamp, readings are numbered consecutively.
    let mut blind = sampler("x y z");
    for number in 1..10 {
        let told = Reading { sequence: None, stamp: None, ..reading(number) };
        let sample = blind.sample(&told, None).unwrap();
        assert_eq!((sample.sequence, sample.device_time.ns), (number, number * PERIOD_NS));
    }
}

#[test]
fn what_cannot_be_used_is_said() {
    let mut sampler = sampler("x y z");
    let lacking = Reading { rotation: None, ..reading(1) };
    assert_eq!(sampler.sample(&lacking, None), Err(Unusable::NoRotation));
    let lacking = Reading { velocity: None, ..reading(1) };
    assert_eq!(sampler.sample(&lacking, None), Err(Unusable::NoVelocity));
    assert_eq!(sampler.counters().incomplete, 2);
    let long = Reading { interval_s: Some(0.0053), ..reading(1) };
    assert!(sampler.sample(&long, None).is_ok());
    assert_eq!(sampler.counters().irregular, 1);
    let nan =
        Reading { rotation: Some(MeasuredTriad::increment([f64::NAN, 0.0, 0.0])), ..reading(2) };
    let sample = sampler.sample(&nan, None).unwrap();
    assert!(sample.status.contains(Status::INERTIAL_INVALID | Status::GYRO_SATURATED));
    assert_eq!(sample.delta_theta[0], 0);
    let fast = Reading { rotation: Some(MeasuredTriad::increment([0.1, 0.0, 0.0])), ..reading(3) };
    let sample = sampler.sample(&fast, None).unwrap();
    assert_eq!(
        (sample.delta_theta[0], sample.status.contains(Status::GYRO_SATURATED)),
        (i32::MAX, true)
    );
}

/// With each protocol, the sums of the counts agree with those of the true increments.
#[test]
fn every_protocol_makes_the_same_samples() {
    for protocol in Protocol::ALL {
        let mut sampler = sampler("x y z");
        let mut decoder = octant_instruments::AnyDecoder::new(protocol);
        let mut sums = [0.0; 2];
        for (number, frame) in (1..).zip(frames(protocol, 400)) {
            let said = common::readings(&common::events(&mut decoder, &frame))[0];
            let sample = sampler.sample(&said, None).unwrap();
            assert_eq!((sample.sequence, sample.device_time.ns), (number, number * PERIOD_NS));
            let told = reading(number);
            sums[0] += f64::from(sample.delta_theta[0]) * DELTA_THETA_LSB_RAD
                - told.rotation.unwrap().value[0];
            sums[1] += f64::from(sample.delta_velocity[2]) * DELTA_VELOCITY_LSB_MPS
                - told.velocity.unwrap().value[2];
        }
        // Tolerance: half a count of the sample plus one unit of the protocol's resolution.
        assert!(sums[0].abs() < 2e-10 && sums[1].abs() < 1e-8, "{protocol:?} {sums:?}");
    }
}

/// A unit that sends means, whose clock is off: the increments are those of its own clock's intervals, by which the core divides
/// them again.
#[test]
fn means_are_multiplied_by_the_interval_of_the_stamps() {
    for ppm in [-500.0, -100.0, 100.0, 500.0] {
        let mut sampler = sampler("x y z");
        let (mut sum, mut first_ns, mut last_ns) = (0_i64, 0, 0);
        for number in 1..=20_000_u64 {
            let ns = 1_000_000_000 + (number as f64 * 5e6 * (1.0 + ppm * 1e-6)).round() as u64;
            let stamp = Some(Stamp { ns, ..reading(1).stamp.unwrap() });
            let told = Reading {
                rotation: Some(MeasuredTriad::mean([1e-3, 0.0, 0.0])),
                velocity: Some(MeasuredTriad::mean([0.0, 0.0, -9.8])),
                interval_s: None,
                sequence: None,
                stamp,
                ..reading(number)
            };
            let sample = sampler.sample(&told, None).unwrap();
            if number == 100 {
                first_ns = sample.device_time.ns;
            } else if number > 100 {
                sum += i64::from(sample.delta_velocity[2]);
                last_ns = sample.device_time.ns;
            }
        }
        let force = sum as f64 * DELTA_VELOCITY_LSB_MPS / ((last_ns - first_ns) as f64 * 1e-9);
        // 1e-8 of 9.8 m/s^2 is a hundredth of a microgravity.
        assert!((force + 9.8).abs() < 1e-7, "{ppm} ppm: {force}");
        let rate = sampler.timeline().rate().unwrap();
        assert!((rate.ppm + ppm).abs() < 0.3 + 1e-3 * ppm.abs(), "{ppm}: {rate:?}");
        assert_eq!(sampler.counters().missing + sampler.counters().behind, 0);
    }
}

#[test]
fn a_late_reading_is_left_out_and_a_restart_is_told() {
    let told = |number: u64, has_counter: bool| {
        let stamp = Some(Stamp { ns: number * PERIOD_NS, ..reading(1).stamp.unwrap() });
        Reading { stamp, sequence: has_counter.then_some(number), ..reading(number) }
    };
    for has_counter in [true, false] {
        let mut sampler = sampler("x y z");
        for number in 1000..1200 {
            sampler.sample(&told(number, has_counter), None).unwrap();
        }
        // Late by a second, once and once more.
        for number in [1000, 1001] {
            assert_eq!(sampler.sample(&told(number, has_counter), None), Err(Unusable::Behind));
        }
        sampler.sample(&told(1200, has_counter), None).unwrap();
        let mut restarted = (1..10).map(|number| sampler.sample(&told(number, has_counter), None));
        assert_eq!(restarted.next(), Some(Err(Unusable::Behind)));
        assert_eq!(restarted.next(), Some(Err(Unusable::Behind)));
        let Some(Err(Unusable::Restarted { from_s, to_s })) = restarted.next() else { panic!() };
        assert!((from_s - 6.0).abs() < 0.01 && (to_s - 0.015).abs() < 0.01, "{from_s} {to_s}");
    }
}
