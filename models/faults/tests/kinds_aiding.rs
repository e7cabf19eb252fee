//! References that are wrong, noisy, lost or late.

use crate::common::{Log, Outcome, PERIOD_NS, clean, fault, run, setup};
use octant_faults::catalogue::Dimension;
use octant_faults::station::Delivered;
use octant_faults::trigger::Repeat;
use octant_faults::{FaultSpec, Station, Value};
use octant_sample::{Aiding, DeviceTime, Epoch, GimbalCommand, Output, Reference};

const DEG: f64 = std::f64::consts::PI / 180.0;
/// 30.5° N, 114.3° E, 20 m.
const HERE: [f64; 3] = [30.5 * DEG, 114.3 * DEG, 20.0];

/// The bench's epoch, with aiding by position every 200.
fn at_position(k: u64) -> Epoch {
    let mut epoch = clean(k);
    if let Some(aiding) = &mut epoch.aiding {
        let [latitude_rad, longitude_rad, height_m] = HERE;
        aiding.reference = Reference::Position { latitude_rad, longitude_rad, height_m };
    }
    epoch
}

/// Runs the bench on another stream.
fn run_on(specs: &[FaultSpec], epochs: u64, source: impl Fn(u64) -> Epoch) -> Outcome {
    let mut station = Station::new(specs, &setup()).unwrap();
    let (mut outcome, mut world) = (Outcome::default(), Log::default());
    for k in 1..=epochs {
        let output = Output::default();
        station.before(&mut GimbalCommand::default(), &output, &mut world);
        let epoch = source(k);
        match station.after(&epoch, &output, &mut world).delivered {
            Delivered::Untouched => outcome.delivered.push((k, epoch)),
            Delivered::These(epochs) => outcome.delivered.extend(epochs.iter().map(|e| (k, *e))),
        }
        station.told();
    }
    outcome.receipts = station.receipts();
    outcome
}

fn velocity(epoch: &Epoch) -> [f64; 3] {
    match epoch.aiding.unwrap().reference {
        Reference::Velocity(velocity) => velocity,
        Reference::Position { .. } => panic!("a velocity is expected"),
    }
}

fn position(epoch: &Epoch) -> [f64; 3] {
    match epoch.aiding.unwrap().reference {
        Reference::Position { latitude_rad, longitude_rad, height_m } => {
            [latitude_rad, longitude_rad, height_m]
        }
        Reference::Velocity(_) => panic!("a position is expected"),
    }
}

/// ECEF coordinates of a geodetic position on WGS-84 (the closed form of any textbook).
fn ecef([latitude, longitude, height]: [f64; 3]) -> [f64; 3] {
    let e2 = 6.694_379_990_14e-3;
    let n = 6_378_137.0 / (1.0 - e2 * latitude.sin().powi(2)).sqrt();
    [
        (n + height) * latitude.cos() * longitude.cos(),
        (n + height) * latitude.cos() * longitude.sin(),
        (n * (1.0 - e2) + height) * latitude.sin(),
    ]
}

/// Displacement from HERE in north, east, down, m.
fn displacement(to: [f64; 3]) -> [f64; 3] {
    let (a, b) = (ecef(HERE), ecef(to));
    let d: [f64; 3] = std::array::from_fn(|i| b[i] - a[i]);
    let (sl, cl, so, co) = (HERE[0].sin(), HERE[0].cos(), HERE[1].sin(), HERE[1].cos());
    [
        -sl * co * d[0] - sl * so * d[1] + cl * d[2],
        -so * d[0] + co * d[1],
        -cl * co * d[0] - cl * so * d[1] - sl * d[2],
    ]
}

fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
    for axis in 0..3 {
        assert!((found[axis] - expected[axis]).abs() < tolerance, "{found:?} {expected:?}");
    }
}

/// Returns whether only the reference of the aiding differs.
fn same_but_reference(mut epoch: Epoch, clean: &Epoch) -> bool {
    if let (Some(aiding), Some(was)) = (&mut epoch.aiding, &clean.aiding) {
        aiding.reference = was.reference;
    }
    epoch.same_bits(clean)
}

fn wrong(error: [f64; 3], dimension: Dimension, first: u64, epochs: u64) -> FaultSpec {
    fault("aiding-wrong", &[("error", Value::Vector(error, dimension))], first, epochs)
}

#[test]
fn a_wrong_velocity_is_off_by_its_error_and_fades() {
    let error = [0.1, -0.2, 0.05];
    let mut spec = wrong(error, Dimension::Velocity, 350, 400);
    spec.schedule.recovery = 399;
    let outcome = run(&[spec], 1400);
    for (at, epoch) in &outcome.delivered {
        assert!(same_but_reference(*epoch, &clean(*at)));
        let Some(_) = epoch.aiding else { continue };
        let factor = match at {
            400 | 600 => 1.0,
            // Falls linearly from 1 at 749 to 0 at 1149.
            800 | 1000 => (1149 - at) as f64 / 400.0,
            _ => 0.0,
        };
        let was = velocity(&clean(*at));
        let expected = std::array::from_fn(|axis| was[axis] + factor * error[axis]);
        assert_near(velocity(epoch), expected, 1e-15);
        assert!(factor != 0.0 || epoch.same_bits(&clean(*at)));
    }
    assert_eq!(outcome.receipts[0].samples_altered, 4);
}

#[test]
fn a_wrong_position_is_off_by_metres_on_the_ellipsoid() {
    let error = [40.0, -30.0, 5.0];
    let outcome = run_on(&[wrong(error, Dimension::Length, 150, 100)], 400, at_position);
    // The distance of the tangent plane from the ellipsoid is d²/2R: 0.2 mm.
    assert_near(displacement(position(&outcome.at(200)[0])), error, 1e-3);
    assert!(same_but_reference(outcome.at(200)[0], &at_position(200)));
    assert!(outcome.at(400)[0].same_bits(&at_position(400)));
    assert_eq!(outcome.receipts[0].samples_altered, 1);
}

#[test]
fn an_error_of_the_other_sort_does_nothing_and_the_receipt_says_so() {
    let outcome = run(&[wrong([1.0; 3], Dimension::Length, 1, 1000)], 1000);
    assert!(outcome.delivered.iter().all(|(at, epoch)| epoch.same_bits(&clean(*at))));
    assert!(!outcome.receipts[0].fired());
}

#[test]
fn an_error_of_any_size_leaves_numbers() {
    let outcome = run_on(&[wrong([1e12, 1e12, 0.0], Dimension::Length, 1, 300)], 300, at_position);
    let [latitude, longitude, height] = position(&outcome.at(200)[0]);
    assert_eq!(latitude, std::f64::consts::FRAC_PI_2);
    assert!(longitude.is_finite() && height == HERE[2]);
}

#[test]
fn positions_jump_stay_there_and_jump_again() {
    let jump = [3.0, 4.0, -1.0];
    let mut spec =
        fault("position-jump", &[("jump", Value::Vector(jump, Dimension::Length))], 201, 1);
    spec.schedule.repeat = Repeat::Times { times: 2, every: 400 };
    let outcome = run_on(&[spec], 1000, at_position);
    for (at, n) in [(200, 0.0), (400, 1.0), (600, 1.0), (800, 2.0), (1000, 2.0)] {
        let epoch = outcome.at(at)[0];
        assert!(same_but_reference(epoch, &at_position(at)));
        assert_near(displacement(position(&epoch)), jump.map(|j| n * j), 1e-4);
    }
    assert!(outcome.at(200)[0].same_bits(&at_position(200)));
    assert_eq!(outcome.receipts[0].samples_altered, 4);
}

/// Aiding with every sample, of zero velocity.
fn standing(k: u64) -> Epoch {
    let device_time = DeviceTime::from_ns(k * PERIOD_NS);
    let reference = Reference::Velocity([0.0; 3]);
    Epoch { aiding: Some(Aiding { device_time, reference }), ..clean(k) }
}

#[test]
fn noise_has_its_sigma_on_every_axis() {
    let sigma = ("sigma", Value::Quantity(0.02, Dimension::Velocity));
    let outcome = run_on(&[fault("aiding-noise", &[sigma], 1001, 20_000)], 22_000, standing);
    let mut squares = [0.0; 3];
    let mut product = 0.0;
    for (at, epoch) in &outcome.delivered {
        assert!(same_but_reference(*epoch, &standing(*at)));
        if (1001..21_001).contains(at) {
            let v = velocity(epoch);
            for axis in 0..3 {
                squares[axis] += v[axis] * v[axis];
            }
            product += v[0] * v[1];
        } else {
            assert!(epoch.same_bits(&standing(*at)));
        }
    }
    for square in squares {
        let sigma = (square / 20_000.0f64).sqrt();
        assert!((sigma / 0.02 - 1.0).abs() < 5.0 / 40_000f64.sqrt(), "{sigma}");
    }
    assert!((product / 20_000.0 / 4e-4).abs() < 5.0 / 20_000f64.sqrt());
}

#[test]
fn noise_of_a_position_is_in_metres() {
    let sigma = ("sigma", Value::Quantity(2.0, Dimension::Length));
    let source = |k| Epoch { aiding: at_position(200).aiding, ..clean(k) };
    let outcome = run_on(&[fault("aiding-noise", &[sigma], 1, 10_000)], 10_000, source);
    let mut squares = [0.0; 3];
    for (_, epoch) in &outcome.delivered {
        let d = displacement(position(epoch));
        for axis in 0..3 {
            squares[axis] += d[axis] * d[axis];
        }
    }
    for square in squares {
        let sigma = (square / 10_000.0f64).sqrt();
        assert!((sigma / 2.0 - 1.0).abs() < 5.0 / 20_000f64.sqrt(), "{sigma}");
    }
}

fn lost(loss: f64, first: u64, epochs: u64) -> FaultSpec {
    let loss = ("loss", Value::Quantity(loss, Dimension::Ratio));
    fault("aiding-lost", &[loss], first, epochs)
}

#[test]
fn lost_aiding_is_missing_and_nothing_else() {
    let outcome = run(&[lost(1.0, 300, 400)], 1000);
    for (at, epoch) in &outcome.delivered {
        let aiding = clean(*at).aiding.filter(|_| !(300..700).contains(at));
        assert_eq!(*epoch, Epoch { aiding, ..clean(*at) });
    }
    assert_eq!(outcome.receipts[0].samples_altered, 2);
    let outcome = run_on(&[lost(0.25, 1, 20_000)], 20_000, standing);
    let count = outcome.delivered.iter().filter(|(_, e)| e.aiding.is_none()).count() as f64;
    assert!((count - 5000.0).abs() < 5.0 * (20_000.0f64 * 0.25 * 0.75).sqrt(), "{count}");
}

fn late(samples: f64, stamp: &'static str, first: u64, epochs: u64) -> FaultSpec {
    let delay = ("delay", Value::Quantity(samples, Dimension::Samples));
    fault("aiding-late", &[delay, ("stamp", Value::Choice(stamp))], first, epochs)
}

/// Aiding of each epoch with the epoch of its measurement: third velocity over 1e-6.
fn measured_at(outcome: &Outcome) -> Vec<(u64, u64)> {
    let aided = outcome.delivered.iter().filter(|(_, epoch)| epoch.aiding.is_some());
    aided.map(|(at, epoch)| (*at, (velocity(epoch)[2] * 1e6).round() as u64)).collect()
}

#[test]
fn late_aiding_goes_with_a_later_sample() {
    let outcome = run(&[late(30.0, "old", 300, 320)], 1000);
    let expected = [(200, 200), (430, 400), (630, 600), (800, 800), (1000, 1000)];
    assert_eq!(measured_at(&outcome), expected);
    for (at, epoch) in &outcome.delivered {
        assert_eq!(epoch.sample, clean(*at).sample);
        if let Some(aiding) = epoch.aiding {
            let of = (velocity(epoch)[2] * 1e6).round() as u64;
            assert!(aiding.same_bits(&clean(of).aiding.unwrap()), "old stamp, same values");
        }
    }
    // Epochs that lost their message and epochs that received it.
    assert_eq!(outcome.receipts[0].samples_altered, 4);
}

#[test]
fn late_aiding_can_be_restamped() {
    let outcome = run(&[late(30.0, "new", 300, 320)], 1000);
    assert!(outcome.delivered.iter().all(|(_, epoch)| {
        epoch.aiding.is_none_or(|aiding| aiding.device_time == epoch.sample.device_time)
    }));
    assert_eq!(outcome.at(430)[0].aiding.unwrap().device_time.ns, 430 * PERIOD_NS);
}

#[test]
fn late_aiding_waits_for_a_sample_without_aiding() {
    // Delayed by one period of the aiding: each message is replaced by the one before; at the end
    // two coincide, and the late one waits for the next sample.
    let outcome = run(&[late(200.0, "old", 300, 400)], 1000);
    let expected = [(200, 200), (600, 400), (800, 800), (801, 600), (1000, 1000)];
    assert_eq!(measured_at(&outcome), expected);
}

#[test]
fn errors_of_nothing_are_refused() {
    let problem = |spec: FaultSpec| Station::new(&[spec], &setup()).unwrap_err().1.to_string();
    assert!(problem(wrong([0.0; 3], Dimension::Length, 1, 1)).starts_with("error: 0 on all axes"));
    assert!(problem(lost(1.5, 1, 1)).starts_with("loss: 1.5"));
    assert!(problem(late(5000.0, "old", 1, 1)).contains("1 to 4096"));
}
