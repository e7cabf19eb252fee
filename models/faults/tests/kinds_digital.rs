//! Every digital kind alters samples as documented, by independent arithmetic.

use crate::common::counts::*;
use crate::common::{self, Outcome, clean, fault, run};
use octant_faults::catalogue::Dimension::*;
use octant_faults::station::Delivered;
use octant_faults::trigger::Trigger;
use octant_faults::{Channels, FaultSpec, Station, Value};
use octant_sample::imu::Status;
use octant_sample::{Aiding, Epoch, GimbalCommand, Output, Reference};

const X: Channels = Channels::gyro(0);
const Z_ACCELEROMETER: Channels = Channels::accelerometer(2);

/// Checks that while the fault lasts every delivered epoch is the clean one altered by `expected`,
/// and outside the clean one.
fn becomes(outcome: &Outcome, lasts: std::ops::Range<u64>, expected: impl Fn(u64, &mut Epoch)) {
    for (k, epoch) in &outcome.delivered {
        let mut right = clean(*k);
        if lasts.contains(k) {
            expected(*k, &mut right);
        }
        assert!(epoch.same_bits(&right), "{k}: {epoch:?} {right:?}");
    }
}

#[test]
fn a_stuck_channel_repeats_what_it_read_before() {
    let which = X.union(Z_ACCELEROMETER);
    let outcome = run(&[fault("stuck-at-current", &[channels(which)], 50, 20)], 100);
    becomes(&outcome, 50..70, |_, epoch| {
        epoch.sample.delta_theta[0] = clean(49).sample.delta_theta[0];
        epoch.sample.delta_velocity[2] = clean(49).sample.delta_velocity[2];
    });
    // At the first sample of a run there is no earlier value.
    let outcome = run(&[fault("stuck-at-current", &[channels(X)], 1, 3)], 10);
    becomes(&outcome, 1..4, |_, epoch| epoch.sample.delta_theta[0] = 0);
    // Each firing has its own value.
    let mut again = fault("stuck-at-current", &[channels(X)], 1, 5);
    again.schedule.trigger = Trigger::Periodic { first: 20, period: 10, last: None };
    becomes(&run(&[again], 100), 20..101, |k, epoch| {
        if k % 10 < 5 {
            epoch.sample.delta_theta[0] = clean(k - k % 10 - 1).sample.delta_theta[0];
        }
    });
}

#[test]
fn a_channel_sticks_at_a_value() {
    for (counts, stuck) in [(0.0, 0), (123_456.4, 123_456), (-2_000_000_000.6, -2_000_000_001)] {
        let values = [channels(Channels::GYRO), quantity("value", rate(counts), AngularRate)];
        let outcome = run(&[fault("stuck-at-value", &values, 50, 20)], 100);
        becomes(&outcome, 50..70, |_, epoch| epoch.sample.delta_theta = [stuck; 3]);
    }
    let values = [channels(Z_ACCELEROMETER), quantity("value", acceleration(77.0), Acceleration)];
    let outcome = run(&[fault("stuck-at-value", &values, 50, 20)], 100);
    becomes(&outcome, 50..70, |_, epoch| epoch.sample.delta_velocity[2] = 77);
    let values = [channels(X), quantity("value", 6.26, AngularRate)];
    assert_eq!(refused("stuck-at-value", &values), "value");
}

#[test]
fn a_channel_reads_the_limit_of_the_format() {
    for (at, limits) in [
        ("upper", [i32::MAX; 2]),
        ("lower", [i32::MIN; 2]),
        // The x gyro is positive, the y gyro negative.
        ("sign", [i32::MAX, i32::MIN]),
    ] {
        for (says, status) in [(true, Status::GYRO_SATURATED), (false, Status::empty())] {
            let which = X.union(Channels::gyro(1));
            let values = [channels(which), choice("at", at), flag("flag", says)];
            let outcome = run(&[fault("out-of-range", &values, 50, 20)], 100);
            becomes(&outcome, 50..70, |_, epoch| {
                epoch.sample.delta_theta[..2].copy_from_slice(&limits);
                epoch.sample.status = status;
            });
        }
    }
    let values = [channels(Channels::ALL), choice("at", "upper"), flag("flag", true)];
    let outcome = run(&[fault("out-of-range", &values, 2, 1)], 2);
    let both = Status::GYRO_SATURATED | Status::ACCELEROMETER_SATURATED;
    assert_eq!(outcome.at(2)[0].sample.status, both);
}

#[test]
fn dropouts_are_filled_with_zeros_or_the_last_value() {
    for gimbal in [false, true] {
        let values = [channels(Channels::ALL), flag("gimbal", gimbal)];
        let outcome = run(&[fault("dropout-zero", &values, 195, 20)], 300);
        becomes(&outcome, 195..215, |_, epoch| {
            epoch.sample.delta_theta = [0; 3];
            epoch.sample.delta_velocity = [0; 3];
            if gimbal {
                (epoch.sample.gimbal.azimuth, epoch.sample.gimbal.roll) = (0, 0);
            }
        });
        let outcome = run(&[fault("dropout-held", &values, 195, 20)], 300);
        becomes(&outcome, 195..215, |_, epoch| {
            let last = clean(194).sample;
            epoch.sample.delta_theta = last.delta_theta;
            epoch.sample.delta_velocity = last.delta_velocity;
            if gimbal {
                epoch.sample.gimbal = last.gimbal;
            }
        });
    }
    let values = [channels(X), flag("gimbal", false)];
    let outcome = run(&[fault("dropout-zero", &values, 5, 20)], 30);
    becomes(&outcome, 5..25, |_, epoch| epoch.sample.delta_theta[0] = 0);
}

fn intermittent(fill: &'static str, out: f64, inside: f64, epochs: u64) -> FaultSpec {
    let values = [
        channels(Channels::ALL),
        flag("gimbal", true),
        choice("fill", fill),
        quantity("mean_out", out * DT, Time),
        quantity("mean_in", inside * DT, Time),
    ];
    fault("intermittent", &values, 11, epochs)
}

#[test]
fn a_loose_contact_has_its_mean_times() {
    const N: u64 = 200_000;
    let outcome = run(&[intermittent("zero", 7.0, 30.0, N)], N + 20);
    let out = |k: u64| outcome.delivered[k as usize - 1].1.sample.delta_velocity[2] == 0;
    becomes(&outcome, 11..N + 11, |k, epoch| {
        if out(k) {
            epoch.sample.delta_theta = [0; 3];
            epoch.sample.delta_velocity = [0; 3];
            (epoch.sample.gimbal.azimuth, epoch.sample.gimbal.roll) = (0, 0);
        }
    });
    assert!(out(11), "out at the onset");
    let (mut runs, mut length) = ([Vec::new(), Vec::new()], 0.0);
    for k in 11..N + 10 {
        length += 1.0;
        if out(k) != out(k + 1) {
            runs[usize::from(out(k))].push(length);
            length = 0.0;
        }
    }
    for (lengths, mean) in runs.iter().zip([30.0f64, 7.0]) {
        // Geometric: mean 1/p, variance (1 − p)/p², and the chance of a single sample p.
        let n = lengths.len() as f64;
        let found = lengths.iter().sum::<f64>() / n;
        assert!((found - mean).abs() < 5.0 * (mean * (mean - 1.0) / n).sqrt(), "{found} {mean}");
        let single = lengths.iter().filter(|length| **length == 1.0).count() as f64 / n;
        let p = 1.0 / mean;
        assert!((single - p).abs() < 5.0 * (p * (1.0 - p) / n).sqrt(), "{single} {p}");
    }
}

#[test]
fn a_loose_contact_holds_the_last_sample_that_passed() {
    let outcome = run(&[intermittent("held", 5.0, 5.0, 2000)], 2100);
    let mut last = clean(10);
    let mut repeats = 0;
    for (k, epoch) in &outcome.delivered {
        let clean = clean(*k);
        if epoch.same_bits(&clean) {
            last = clean;
            continue;
        }
        assert!((11..2011).contains(k));
        repeats += 1;
        let mut right = clean;
        right.sample.delta_theta = last.sample.delta_theta;
        right.sample.delta_velocity = last.sample.delta_velocity;
        right.sample.gimbal = last.sample.gimbal;
        assert!(epoch.same_bits(&right), "{k}");
    }
    assert!((800..1200).contains(&repeats), "{repeats}");
    let FaultSpec { values, .. } = intermittent("zero", 0.5, 5.0, 1);
    let values: Vec<_> = values.iter().collect();
    assert_eq!(refused("intermittent", &values), "mean_out");
}

#[test]
fn signs_flip_and_axes_swap() {
    let which = X.union(Channels::accelerometer(1));
    let outcome = run(&[fault("sign-flip", &[channels(which)], 50, 20)], 100);
    becomes(&outcome, 50..70, |_, epoch| {
        epoch.sample.delta_theta[0] *= -1;
        epoch.sample.delta_velocity[1] *= -1;
    });
    // The smallest count has no opposite.
    let values = [channels(X), choice("at", "lower"), flag("flag", false)];
    let mut lowest = fault("out-of-range", &values, 5, 1);
    lowest.id = "lowest".into();
    let outcome = run(&[lowest, fault("sign-flip", &[channels(X)], 5, 1)], 5);
    let sample = outcome.at(5)[0].sample;
    assert_eq!(sample.delta_theta[0], i32::MAX);
    assert_eq!(sample.status, Status::GYRO_SATURATED);

    let swap =
        |first, second| [("first", Value::Channels(first)), ("second", Value::Channels(second))];
    let outcome = run(&[fault("axis-swap", &swap(X, Channels::gyro(2)), 50, 20)], 100);
    becomes(&outcome, 50..70, |_, epoch| epoch.sample.delta_theta.swap(0, 2));
    let values = swap(Z_ACCELEROMETER, Channels::accelerometer(0));
    let outcome = run(&[fault("axis-swap", &values, 50, 20)], 100);
    becomes(&outcome, 50..70, |_, epoch| epoch.sample.delta_velocity.swap(0, 2));
    assert_eq!(refused("axis-swap", &swap(X, X)), "second");
    assert_eq!(refused("axis-swap", &swap(X, Z_ACCELEROMETER)), "second");
    assert_eq!(refused("axis-swap", &swap(X, Channels::GYRO)), "second");
}

fn bit(
    which: Channels,
    bit: i64,
    becomes: &'static str,
    probability: f64,
    epochs: u64,
) -> FaultSpec {
    let values = [
        channels(which),
        ("bit", Value::Integer(bit)),
        choice("becomes", becomes),
        quantity("probability", probability, Ratio),
    ];
    fault("bit-flip", &values, 11, epochs)
}

#[test]
fn bits_flip_and_stick() {
    for number in [0, 5, 17, 31] {
        let weight = 1i64 << number;
        // The bit by division, from the two's complement as a number from 0 to 2³² − 1.
        let with = |count: i32, wish: fn(bool) -> bool| {
            let unsigned = i64::from(count).rem_euclid(1 << 32);
            let is = unsigned / weight % 2 == 1;
            let unsigned = unsigned + weight * (i64::from(wish(is)) - i64::from(is));
            if unsigned >= 1 << 31 { (unsigned - (1 << 32)) as i32 } else { unsigned as i32 }
        };
        let wishes: [fn(bool) -> bool; 3] = [|is| !is, |_| true, |_| false];
        for (name, wish) in ["inverted", "set", "cleared"].into_iter().zip(wishes) {
            let outcome = run(&[bit(Channels::GYRO, number, name, 1.0, 100)], 200);
            becomes(&outcome, 11..111, |_, epoch| {
                epoch.sample.delta_theta = epoch.sample.delta_theta.map(|c| with(c, wish));
            });
        }
    }
}

#[test]
fn bits_flip_with_their_probability_each_channel_by_itself() {
    const N: u64 = 100_000;
    let outcome = run(&[bit(Channels::ALL, 9, "inverted", 0.2, N)], N + 20);
    let steps = added(&outcome);
    let hits: Vec<[bool; 6]> = steps.iter().map(|(step, _)| step.map(|c| c.abs() == 512)).collect();
    assert!(steps.iter().all(|(step, _)| step.iter().all(|c| *c == 0 || c.abs() == 512)));
    let share = |hit: &dyn Fn(&[bool; 6]) -> bool, p: f64| {
        let found = hits[10..N as usize + 10].iter().filter(|hits| hit(hits)).count() as f64;
        let bound = 5.0 * (N as f64 * p * (1.0 - p)).sqrt();
        assert!((found - N as f64 * p).abs() < bound, "{found} {p}");
    };
    for a in 0..6 {
        share(&|hits| hits[a], 0.2);
        for b in 0..a {
            share(&|hits| hits[a] && hits[b], 0.04);
        }
    }
    let nothing = bit(X, 1, "set", 0.0, 1).values;
    let values: Vec<_> = nothing.iter().collect();
    assert_eq!(refused("bit-flip", &values), "probability");
}

#[test]
fn a_slow_channel_repeats_loses_or_sums() {
    let slow = |between| {
        let values = [
            channels(X.union(Z_ACCELEROMETER)),
            ("every", Value::Integer(7)),
            choice("between", between),
        ];
        fault("slow-rate", &values, 20, 40)
    };
    // Epochs 26, 33, 40, 47 and 54 are fresh.
    let fresh = |k: u64| (k - 19).is_multiple_of(7);
    becomes(&run(&[slow("repeated")], 100), 20..60, |k, epoch| {
        let source = clean(19 + (k - 19) / 7 * 7).sample;
        epoch.sample.delta_theta[0] = source.delta_theta[0];
        epoch.sample.delta_velocity[2] = source.delta_velocity[2];
    });
    becomes(&run(&[slow("zero")], 100), 20..60, |k, epoch| {
        if !fresh(k) {
            epoch.sample.delta_theta[0] = 0;
            epoch.sample.delta_velocity[2] = 0;
        }
    });
    becomes(&run(&[slow("summed")], 100), 20..60, |k, epoch| {
        let sum = |count: fn(&Epoch) -> i32| match fresh(k) {
            true => (k - 6..=k).map(|k| count(&clean(k))).sum(),
            false => 0,
        };
        epoch.sample.delta_theta[0] = sum(|epoch| epoch.sample.delta_theta[0]);
        epoch.sample.delta_velocity[2] = sum(|epoch| epoch.sample.delta_velocity[2]);
    });
}

#[test]
fn a_sum_outside_the_format_saturates() {
    // 52 million a sample: 41 of them fit into the format, 42 don't.
    let values =
        [channels(Z_ACCELEROMETER), ("every", Value::Integer(42)), choice("between", "summed")];
    let outcome = run(&[fault("slow-rate", &values, 1, 84)], 84);
    becomes(&outcome, 1..85, |k, epoch| {
        epoch.sample.delta_velocity[2] = if k % 42 == 0 { i32::MAX } else { 0 };
        epoch.sample.status.set(Status::ACCELEROMETER_SATURATED, k % 42 == 0);
    });
}

#[test]
fn a_flag_lies() {
    for (name, flag) in [
        ("gyro-saturated", Status::GYRO_SATURATED),
        ("accelerometer-saturated", Status::ACCELEROMETER_SATURATED),
        ("gimbal-invalid", Status::GIMBAL_INVALID),
        ("inertial-invalid", Status::INERTIAL_INVALID),
    ] {
        let lie = |becomes| {
            fault("lying-status", &[choice("flag", name), choice("becomes", becomes)], 50, 20)
        };
        let outcome = run(&[lie("set")], 100);
        becomes(&outcome, 50..70, |_, epoch| epoch.sample.status = flag);
        // The flag was not set: clearing it alters nothing, and the receipt shows that.
        let outcome = run(&[lie("cleared")], 100);
        becomes(&outcome, 50..70, |_, _| {});
        assert_eq!((outcome.receipts[0].firings, outcome.receipts[0].samples_altered), (1, 0));
        let mut earlier = lie("set");
        earlier.id = "earlier".into();
        let outcome = run(&[earlier, lie("cleared")], 100);
        becomes(&outcome, 50..70, |_, _| {});
        assert_eq!(outcome.receipts[1].samples_altered, 20);
    }
}

#[test]
fn the_reference_is_not_a_number() {
    for (component, hit) in [
        ("all", [true; 3]),
        ("first", [true, false, false]),
        ("second", [false, true, false]),
        ("third", [false, false, true]),
    ] {
        for (name, bits) in [
            ("not-a-number", 0x7FF8_0000_0000_0000u64),
            ("infinity", 0x7FF0_0000_0000_0000),
            ("minus-infinity", 0xFFF0_0000_0000_0000),
        ] {
            let values = [choice("component", component), choice("value", name)];
            // Aiding comes at 400 and at 600, not at 800.
            let outcome = run(&[fault("aiding-nan", &values, 300, 301)], 900);
            becomes(&outcome, 300..601, |k, epoch| {
                if k % 200 == 0 {
                    let mut velocity = [1e-3, -2e-3, k as f64 * 1e-6];
                    for axis in 0..3 {
                        if hit[axis] {
                            velocity[axis] = f64::from_bits(bits);
                        }
                    }
                    let device_time = epoch.sample.device_time;
                    let reference = Reference::Velocity(velocity);
                    epoch.aiding = Some(Aiding { device_time, reference });
                }
            });
            assert_eq!(outcome.receipts[0].samples_altered, 2);
        }
    }
}

#[test]
fn components_of_a_position_are_latitude_longitude_and_height() {
    let clean = |k: u64| {
        let reference =
            Reference::Position { latitude_rad: 0.5, longitude_rad: -2.0, height_m: 40.0 };
        let device_time = clean(k).sample.device_time;
        Epoch { aiding: Some(Aiding { device_time, reference }), ..clean(k) }
    };
    for (component, position) in [
        ("all", [f64::INFINITY; 3]),
        ("first", [f64::INFINITY, -2.0, 40.0]),
        ("second", [0.5, f64::INFINITY, 40.0]),
        ("third", [0.5, -2.0, f64::INFINITY]),
    ] {
        let values = [choice("component", component), choice("value", "infinity")];
        let spec = fault("aiding-nan", &values, 2, 1);
        let mut station = Station::new(&[spec], &common::setup()).unwrap();
        let output = Output::default();
        for k in 1..=3 {
            station.before(&mut GimbalCommand::default(), &output, &mut common::Log::default());
            let epoch = clean(k);
            let mut right = clean(k);
            if k == 2 {
                let [latitude_rad, longitude_rad, height_m] = position;
                let reference = Reference::Position { latitude_rad, longitude_rad, height_m };
                right.aiding = right.aiding.map(|aiding| Aiding { reference, ..aiding });
            }
            match station.after(&epoch, &output, &mut common::Log::default()).delivered {
                Delivered::Untouched => assert_ne!(k, 2),
                Delivered::These(out) => assert_eq!((k, out), (2, &[right][..])),
            }
        }
    }
}
