//! Faults on connections: each kind against its documented model.

use octant_faults::catalogue::Dimension;
use octant_faults::connection::kinds::{self, Target};
use octant_faults::connection::{ConnectionFaultSpec, ConnectionStation};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{Receipt, Value, Values};

const PERIOD_S: f64 = 0.01;
const SEED: u64 = 7;

fn schedule(first: u64, duration: u64) -> Schedule {
    Schedule {
        trigger: Trigger::Epoch(first),
        duration: Some(duration),
        recovery: 0,
        repeat: Repeat::Once,
    }
}

fn spec(kind: &str, given: &[(&'static str, Value)], schedule: Schedule) -> ConnectionFaultSpec {
    spec_on(kind, given, schedule, &[Target::Float64])
}

fn spec_on(
    kind: &str,
    given: &[(&'static str, Value)],
    schedule: Schedule,
    targets: &[Target],
) -> ConnectionFaultSpec {
    let mut values = Values::default();
    for (name, value) in given {
        values.set(name, *value);
    }
    ConnectionFaultSpec {
        id: format!("{kind}-1"),
        kind: kinds::named(kind).unwrap(),
        values,
        schedule,
        elements: targets.iter().copied().enumerate().collect(),
    }
}

/// Values that element 0 gets when x(k) = 10 k is sent at epochs 1 to `epochs`.
fn sent(specs: &[ConnectionFaultSpec], epochs: u64) -> (Vec<f64>, Vec<Receipt>) {
    let mut station = ConnectionStation::new(specs, SEED, PERIOD_S).unwrap();
    let got = (1..=epochs)
        .map(|k| {
            station.begin(|_| None);
            let got = station.transfer(0, 10.0 * k as f64, false);
            // A repeated transfer, as when a step is made in parts, gives the same value.
            let again = station.transfer(0, 10.0 * k as f64, true);
            assert_eq!(got.to_bits(), again.to_bits(), "epoch {k}");
            got
        })
        .collect();
    (got, station.receipts())
}

#[test]
fn a_stuck_input_keeps_its_last_value_or_has_the_given_one() {
    let (got, receipts) = sent(&[spec("stuck", &[], schedule(3, 2))], 6);
    assert_eq!(got, [10.0, 20.0, 20.0, 20.0, 50.0, 60.0]);
    let receipt = &receipts[0];
    assert_eq!((receipt.id.as_str(), receipt.kind, receipt.firings), ("stuck-1", "stuck", 1));
    assert_eq!((receipt.first_sample, receipt.last_sample), (Some(3), Some(4)));
    assert_eq!(receipt.samples_altered, 2);
    let bytes = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    assert_eq!(receipt.clean_crc32, crc32fast::hash(&bytes(&[30.0, 40.0])));
    assert_eq!(receipt.faulted_crc32, crc32fast::hash(&bytes(&[20.0, 20.0])));

    let given = [("value", Value::Number(-1.5))];
    assert_eq!(sent(&[spec("stuck", &given, schedule(1, 2))], 3).0, [-1.5, -1.5, 30.0]);
    // Before the first step there is no value: the first transfer counts.
    assert_eq!(sent(&[spec("stuck", &[], schedule(1, 3))], 4).0, [10.0, 10.0, 10.0, 40.0]);
}

#[test]
fn bias_and_scale_act_with_their_strength() {
    let mut fading = schedule(2, 2);
    fading.recovery = 3;
    let (got, _) = sent(&[spec("bias", &[("value", Value::Number(4.0))], fading.clone())], 8);
    // Falls linearly and would reach 0 one step after the last: 3/4, 2/4, 1/4.
    assert_eq!(got, [10.0, 24.0, 34.0, 43.0, 52.0, 61.0, 70.0, 80.0]);
    let (got, _) = sent(&[spec("scale", &[("factor", Value::Number(0.0))], fading)], 8);
    assert_eq!(got, [10.0, 0.0, 0.0, 10.0, 25.0, 45.0, 70.0, 80.0]);
    let sign = [("factor", Value::Number(-1.0))];
    assert_eq!(sent(&[spec("scale", &sign, schedule(2, 1))], 3).0, [10.0, -20.0, 30.0]);
}

#[test]
fn whole_numbers_are_rounded_and_end_at_their_limits() {
    let value = [("value", Value::Number(100.5))];
    let spec = spec_on("bias", &value, schedule(1, 3), &[Target::Integer(-128.0, 127.0)]);
    let mut station = ConnectionStation::new(&[spec], SEED, PERIOD_S).unwrap();
    let got: Vec<f64> = [1.0, 2.0, 100.0]
        .into_iter()
        .map(|value| {
            station.begin(|_| None);
            station.transfer(0, value, false)
        })
        .collect();
    // 101.5 and 102.5 are ties: both go to 102.
    assert_eq!(got, [102.0, 102.0, 127.0]);
}

#[test]
fn a_delay_gives_what_was_sent_before() {
    let samples = [("delay", Value::Quantity(2.0, Dimension::Samples))];
    let (got, _) = sent(&[spec("delay", &samples, schedule(1, 5))], 7);
    assert_eq!(got, [10.0, 10.0, 10.0, 20.0, 30.0, 60.0, 70.0]);
    // 25 ms are two and a half steps of 10 ms, rounded to two.
    let time = [("delay", Value::Quantity(0.025, Dimension::Time))];
    assert_eq!(sent(&[spec("delay", &time, schedule(4, 2))], 6).0[3..], [20.0, 30.0, 60.0]);
    let none = [("delay", Value::Quantity(0.004, Dimension::Time))];
    let error = ConnectionStation::new(&[spec("delay", &none, schedule(1, 1))], SEED, PERIOD_S)
        .unwrap_err();
    assert!(error.1.to_string().contains("0 steps"), "{}", error.1);
}

#[test]
fn dropped_values_are_held_or_zero_and_as_often_as_told() {
    let drop = |probability: f64, becomes: &'static str| {
        [("probability", Value::Number(probability)), ("becomes", Value::Choice(becomes))]
    };
    let (got, _) = sent(&[spec("drop", &drop(1.0, "hold"), schedule(3, 2))], 6);
    assert_eq!(got, [10.0, 20.0, 20.0, 20.0, 50.0, 60.0]);
    let (got, _) = sent(&[spec("drop", &drop(1.0, "zero"), schedule(3, 2))], 6);
    assert_eq!(got, [10.0, 20.0, 0.0, 0.0, 50.0, 60.0]);

    const N: u64 = 100_000;
    let spec = spec("drop", &drop(0.3, "hold"), schedule(1, N));
    let (got, receipts) = sent(std::slice::from_ref(&spec), N);
    let mut last = 10.0;
    for (k, value) in (1..).zip(&got) {
        assert!(*value == 10.0 * f64::from(k) || *value == last, "epoch {k}: {value}");
        last = *value;
    }
    // Five standard deviations of a binomial.
    let lost = receipts[0].samples_altered as f64;
    let (mean, sigma) = (0.3 * N as f64, (0.21 * N as f64).sqrt());
    assert!((lost - mean).abs() < 5.0 * sigma, "{lost} of {N}");
    assert_eq!(sent(&[spec], N).0, got, "the same each time");
}

#[test]
fn noise_is_white_and_normal_and_moves_with_seed_and_id_alone() {
    const N: u64 = 100_000;
    let sigma = [("sigma", Value::Number(2.0))];
    let targets = [Target::Float64; 5];
    let noise = |id: &str, seed: u64| {
        let mut spec = spec_on("noise", &sigma, schedule(1, N), &targets);
        spec.id = id.to_owned();
        let mut station = ConnectionStation::new(&[spec], seed, PERIOD_S).unwrap();
        let mut all: [Vec<f64>; 5] = Default::default();
        for _ in 0..N {
            station.begin(|_| None);
            for (element, values) in all.iter_mut().enumerate() {
                values.push(station.transfer(element, 0.0, false) / 2.0);
            }
        }
        all
    };
    let all = noise("a", 1);
    let n = N as f64;
    let mean = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>() / n;
    for (i, x) in all.iter().enumerate() {
        let average = x.iter().sum::<f64>() / n;
        assert!(average.abs() < 5.0 / n.sqrt(), "mean {average} of {i}");
        let variance = mean(x, x);
        assert!((variance - 1.0).abs() < 5.0 * (2.0 / n).sqrt(), "variance {variance} of {i}");
        let next = mean(&x[1..], &x[..x.len() - 1]);
        assert!(next.abs() < 5.0 / n.sqrt(), "correlation with the next {next} of {i}");
        for (j, y) in all[..i].iter().enumerate() {
            let both = mean(x, y);
            assert!(both.abs() < 5.0 / n.sqrt(), "correlation {both} of {i} and {j}");
        }
    }
    assert_eq!(noise("a", 1), all);
    assert_ne!(noise("b", 1)[0], all[0]);
    assert_ne!(noise("a", 2)[0], all[0]);
}

#[test]
fn numbers_that_are_none_are_on_floats_alone() {
    let infinite = [("value", Value::Choice("minus-infinity"))];
    let (got, _) = sent(&[spec("nan", &infinite, schedule(2, 1))], 3);
    assert_eq!(got, [10.0, f64::NEG_INFINITY, 30.0]);
    let nan = [("value", Value::Choice("not-a-number"))];
    let (got, receipts) = sent(&[spec("nan", &nan, schedule(2, 1))], 3);
    assert_eq!(got[1].to_bits(), 0x7ff8_0000_0000_0000);
    assert_eq!(receipts[0].samples_altered, 1);
    for (kind, given, target) in [
        ("nan", &nan[..], Target::Integer(0.0, 255.0)),
        ("bias", &[("value", Value::Number(1.0))], Target::Boolean),
        ("noise", &[("sigma", Value::Number(1.0))], Target::Enumeration),
    ] {
        let spec = spec_on(kind, given, schedule(1, 1), &[target]);
        let (id, error) = ConnectionStation::new(&[spec], SEED, PERIOD_S).unwrap_err();
        assert_eq!(id, format!("{kind}-1"));
        assert!(error.to_string().contains("can't act on"), "{error}");
    }
}

#[test]
fn faults_on_one_connection_act_in_order() {
    let bias = || spec("bias", &[("value", Value::Number(5.0))], schedule(2, 1));
    let scale = || spec("scale", &[("factor", Value::Number(2.0))], schedule(2, 1));
    assert_eq!(sent(&[bias(), scale()], 3).0, [10.0, 50.0, 30.0]);
    assert_eq!(sent(&[scale(), bias()], 3).0, [10.0, 45.0, 30.0]);
}

#[test]
fn triggers_are_those_of_all_faults() {
    let bias = |id: &str, trigger: Trigger| {
        let mut spec = spec("bias", &[("value", Value::Number(1.0))], schedule(1, 1));
        spec.id = id.to_owned();
        spec.schedule.trigger = trigger;
        spec
    };
    let outside = bias("outside", Trigger::Outside { delay: 1 });
    let after = bias("after", Trigger::After { fault: "outside".into(), delay: 2 });
    let by_hand = bias("by-hand", Trigger::Manual);
    let mut station = ConnectionStation::new(&[outside, after, by_hand], SEED, PERIOD_S).unwrap();
    let mut got = Vec::new();
    for k in 1..=12u64 {
        if k == 10 {
            assert!(station.fire("by-hand"));
            assert!(!station.fire("outside"), "its trigger isn't manual");
        }
        // The condition holds from the end of step 2 on, and is evaluated before step 3.
        station.begin(|fault| (fault == 0).then_some(k >= 3));
        if station.transfer(0, 0.0, false) != 0.0 {
            got.push(k);
        }
    }
    // One step after the crossing; two after the end of that fault, which is known at 5; by hand.
    assert_eq!(got, [4, 7, 10]);
    let told: Vec<(u64, usize, bool)> =
        station.occurrences().iter().map(|o| (o.epoch, o.fault, o.begins)).collect();
    assert_eq!(
        told,
        [(4, 0, true), (5, 0, false), (7, 1, true), (8, 1, false), (10, 2, true), (11, 2, false)]
    );
    let twice = [bias("x", Trigger::Epoch(1)), bias("x", Trigger::Epoch(2))];
    assert!(ConnectionStation::new(&twice, SEED, PERIOD_S).is_err());
    let core = bias("x", Trigger::Mode { mode: octant_sample::Mode::Navigating, delay: 0 });
    assert!(ConnectionStation::new(&[core], SEED, PERIOD_S).is_err());
}

#[test]
fn every_kind_has_its_parameters_documented() {
    for kind in kinds::KINDS {
        assert!(kind.summary.ends_with('.') && kind.model.ends_with('.'), "{}", kind.name);
        assert!(kind.parameters.iter().all(|p| p.doc.ends_with('.')), "{}", kind.name);
        assert!(octant_faults::kinds::named(kind.name).is_none(), "{} is taken", kind.name);
    }
}
