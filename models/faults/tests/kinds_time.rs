//! Stamps and numbers.

use crate::common::{Outcome, PERIOD_NS, clean, fault, refused, run, seconds};
use octant_faults::catalogue::Dimension;
use octant_faults::trigger::{Repeat, Trigger};
use octant_faults::{FaultSpec, Value};
use octant_sample::{DeviceTime, Epoch};

const PERIOD: i64 = PERIOD_NS as i64;

fn clock(name: &'static str) -> (&'static str, Value) {
    ("clock", Value::Choice(name))
}

fn afterwards(name: &'static str) -> (&'static str, Value) {
    ("afterwards", Value::Choice(name))
}

/// Error of the sample's stamp, ns; checks that everything else is unaltered.
fn error(at: u64, epoch: &Epoch) -> i64 {
    let clean = clean(at);
    let mut same = *epoch;
    same.sample.device_time = clean.sample.device_time;
    assert!(same.same_bits(&clean), "{at}: more than the stamp is altered");
    epoch.sample.device_time.ns as i64 - clean.sample.device_time.ns as i64
}

fn errors(outcome: &Outcome) -> Vec<i64> {
    outcome.delivered.iter().map(|(at, epoch)| error(*at, epoch)).collect()
}

/// Error of the aiding's stamp at an epoch, ns; checks that everything else is unaltered.
fn aiding_error(outcome: &Outcome, at: u64) -> i64 {
    let (mut found, clean) = (outcome.at(at)[0], clean(at));
    let (was, is) = (clean.aiding.unwrap().device_time, found.aiding.unwrap().device_time);
    found.aiding.as_mut().unwrap().device_time = was;
    assert!(found.same_bits(&clean));
    is.ns as i64 - was.ns as i64
}

#[test]
fn an_offset_is_there_while_it_lasts_and_is_slewed_back() {
    let mut spec =
        fault("time-offset", &[("offset", seconds(-1.5e-3)), clock("instrument")], 11, 5);
    spec.schedule.recovery = 4;
    let outcome = run(&[spec], 30);
    let mut expected = [0; 30];
    expected[10..15].fill(-1_500_000);
    // Falls linearly from full height one sample before to 0 one sample after.
    expected[15..19].copy_from_slice(&[-1_200_000, -900_000, -600_000, -300_000]);
    assert_eq!(errors(&outcome), expected);
    assert_eq!(outcome.receipts[0].samples_altered, 9);
}

#[test]
fn an_offset_never_makes_a_stamp_negative() {
    let spec = fault("time-offset", &[("offset", seconds(-1.0)), clock("instrument")], 1, 3);
    let outcome = run(&[spec], 4);
    assert!(outcome.delivered[..3].iter().all(|(_, e)| e.sample.device_time.ns == 0));
}

#[test]
fn a_reference_can_have_a_clock_of_its_own() {
    let offset = ("offset", seconds(0.02));
    let outcome = run(&[fault("time-offset", &[offset, clock("reference")], 150, 100)], 300);
    assert_eq!(aiding_error(&outcome, 200), 20_000_000);
    assert_eq!(outcome.receipts[0].samples_altered, 1, "one message in these epochs");
    let outcome = run(&[fault("time-offset", &[offset, clock("both")], 150, 100)], 300);
    let both = outcome.at(200)[0];
    assert_eq!(both.sample.device_time, DeviceTime::from_ns(200 * PERIOD_NS + 20_000_000));
    assert_eq!(both.aiding.unwrap().device_time, both.sample.device_time);
    assert_eq!(outcome.receipts[0].samples_altered, 100);
}

#[test]
fn a_step_stays_and_steps_add() {
    let mut spec = fault("time-step", &[("step", seconds(7e-3)), clock("instrument")], 10, 1);
    spec.schedule.repeat = Repeat::Times { times: 2, every: 20 };
    let found = errors(&run(&[spec], 60));
    let expected: Vec<i64> = (1..=60)
        .map(|k| match k {
            1..10 => 0,
            10..30 => 7_000_000,
            _ => 14_000_000,
        })
        .collect();
    assert_eq!(found, expected);
}

#[test]
fn a_skewed_clock_drifts_from_the_onset_and_keeps_its_error_or_not() {
    let skew = ("skew", Value::Quantity(100e-6, Dimension::Ratio));
    for (then, left) in [("stays", 500 * 20), ("corrected", 0)] {
        let spec = fault("clock-skew", &[skew, clock("instrument"), afterwards(then)], 101, 20);
        let found = errors(&run(&[spec], 150));
        // 100 ppm of 5 ms are 500 ns a sample.
        for (k, error) in (1i64..).zip(&found) {
            let expected = match k {
                ..101 => 0,
                101..121 => 500 * (k - 100),
                _ => left,
            };
            assert_eq!(*error, expected, "{then} {k}");
        }
    }
}

#[test]
fn skew_does_not_accumulate_rounding() {
    // 0.1 ppm: half a nanosecond a sample, which rounding of each sample would lose or double.
    let skew = ("skew", Value::Quantity(-0.1e-6, Dimension::Ratio));
    let spec = fault("clock-skew", &[skew, clock("instrument"), afterwards("stays")], 1, 100_000);
    let found = errors(&run(&[spec], 100_000));
    assert_eq!(found[99_999], -50_000);
    assert!((1..).zip(&found).all(|(k, error)| (*error as f64 + 0.5 * f64::from(k)).abs() <= 0.5));
}

#[test]
fn errors_of_several_onsets_add_where_they_stay() {
    let skew = ("skew", Value::Quantity(200e-6, Dimension::Ratio));
    let mut spec = fault("clock-skew", &[skew, clock("instrument"), afterwards("stays")], 11, 10);
    spec.schedule.repeat = Repeat::Times { times: 2, every: 30 };
    let found = errors(&run(&[spec], 100));
    assert_eq!((found[19], found[39], found[40], found[49]), (10_000, 10_000, 11_000, 20_000));
    assert_eq!(found[99], 20_000);
}

#[test]
fn a_frozen_clock_shows_one_time() {
    for (then, left) in [("corrected", 0), ("stays", -15 * PERIOD)] {
        let spec = fault("frozen-clock", &[clock("instrument"), afterwards(then)], 21, 15);
        let outcome = run(&[spec], 60);
        for (k, error) in (1i64..).zip(errors(&outcome)) {
            match k {
                ..21 => assert_eq!(error, 0),
                21..36 => assert_eq!(k * PERIOD + error, 20 * PERIOD),
                _ => assert_eq!(error, left),
            }
        }
    }
}

#[test]
fn a_clock_runs_backwards() {
    let speed = ("speed", Value::Quantity(0.5, Dimension::Ratio));
    for (then, left) in [("corrected", 0), ("stays", -15 * PERIOD)] {
        let spec = fault("time-backwards", &[speed, clock("both"), afterwards(then)], 195, 10);
        let outcome = run(&[spec], 230);
        for (at, epoch) in &outcome.delivered {
            let (k, stamp) = (*at as i64, epoch.sample.device_time.ns as i64);
            let expected = match k {
                ..195 => k * PERIOD,
                195..205 => 194 * PERIOD - (k - 194) * PERIOD / 2,
                _ => k * PERIOD + left,
            };
            assert_eq!(stamp, expected, "{then} {k}");
            if let Some(aiding) = epoch.aiding {
                assert_eq!(aiding.device_time, epoch.sample.device_time);
            }
        }
    }
}

fn jitter(sigma_s: f64, monotonic: bool, epochs: u64) -> Vec<i64> {
    let values =
        [("sigma", seconds(sigma_s)), ("monotonic", Value::Flag(monotonic)), clock("instrument")];
    errors(&run(&[fault("time-jitter", &values, 101, epochs - 200)], epochs))
}

#[test]
fn jitter_has_its_sigma_is_white_and_ends() {
    let found = jitter(20e-6, true, 40_200);
    assert!(found[..100].iter().chain(&found[40_100..]).all(|error| *error == 0));
    let noise: Vec<f64> = found[100..40_100].iter().map(|error| *error as f64).collect();
    let n = noise.len() as f64;
    let mean = noise.iter().sum::<f64>() / n;
    let sigma = (noise.iter().map(|x| x * x).sum::<f64>() / n).sqrt();
    let lag: f64 = noise.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n / (sigma * sigma);
    // Five standard errors each.
    assert!(mean.abs() < 5.0 * 20_000.0 / n.sqrt(), "{mean}");
    assert!((sigma / 20_000.0 - 1.0).abs() < 5.0 / (2.0 * n).sqrt(), "{sigma}");
    assert!(lag.abs() < 5.0 / n.sqrt(), "{lag}");
}

#[test]
fn monotonic_jitter_never_goes_back_and_free_jitter_does() {
    let stamps = |errors: Vec<i64>| -> Vec<i64> {
        (1..).zip(errors).map(|(k, error)| k * PERIOD + error).collect()
    };
    let goes_back = |stamps: &[i64]| stamps.windows(2).filter(|w| w[1] <= w[0]).count();
    let kept = jitter(10e-3, true, 2200);
    assert!(kept.contains(&((PERIOD - 1) / 2)), "2 sigma of half a period");
    assert_eq!(goes_back(&stamps(kept)), 0);
    assert!(goes_back(&stamps(jitter(10e-3, false, 2200))) > 500);
}

#[test]
fn a_fifth_of_a_period_is_clipped_as_often_as_the_page_says() {
    let found = jitter(1e-3, true, 50_200);
    let clipped = found.iter().filter(|error| error.abs() == (PERIOD - 1) / 2).count() as f64;
    // P(|n| > 2.5) = 1.242 %.
    assert!((clipped - 621.0).abs() < 5.0 * 621f64.sqrt(), "{clipped}");
}

#[test]
fn a_stamp_is_repeated() {
    let single = fault("duplicate-stamp", &[("run", Value::Integer(2))], 31, 1);
    let found = errors(&run(&[single], 40));
    let expected: Vec<i64> = (1..=40).map(|k| if k == 31 { -PERIOD } else { 0 }).collect();
    assert_eq!(found, expected);
    let threes = fault("duplicate-stamp", &[("run", Value::Integer(3))], 31, 7);
    let found = errors(&run(&[threes], 40));
    assert_eq!(found[30..37], [-1, -2, 0, -1, -2, 0, -1].map(|n| n * PERIOD));
    assert_eq!((found[29], found[37]), (0, 0));
}

#[test]
fn a_repeated_stamp_is_the_one_that_the_source_gave_even_at_the_first_sample() {
    let first = fault("duplicate-stamp", &[("run", Value::Integer(2))], 1, 1);
    assert_eq!(errors(&run(&[first], 3)), [-PERIOD, 0, 0]);
}

/// Error of the sequence numbers; checks that everything else is unaltered.
fn number_errors(outcome: &Outcome) -> Vec<i64> {
    let error = |(at, epoch): &(u64, Epoch)| {
        let mut same = *epoch;
        same.sample.sequence = *at;
        assert!(same.same_bits(&clean(*at)));
        epoch.sample.sequence as i64 - *at as i64
    };
    outcome.delivered.iter().map(error).collect()
}

#[test]
fn numbers_skip_and_stay_or_are_damaged_once() {
    let skip = ("skip", Value::Integer(1000));
    let mut spec = fault("sequence-gap", &[skip, afterwards("stays")], 10, 1);
    spec.schedule.repeat = Repeat::Times { times: 2, every: 10 };
    let outcome = run(&[spec], 30);
    let expected: Vec<i64> = (1..=30).map(|k| 1000 * (k / 10).min(2)).collect();
    assert_eq!(number_errors(&outcome), expected);
    assert_eq!(outcome.receipts[0].samples_altered, 21);
    let back = ("skip", Value::Integer(-5));
    let mut spec = fault("sequence-gap", &[back, afterwards("corrected")], 10, 1);
    spec.schedule.trigger = Trigger::Periodic { first: 10, period: 7, last: Some(20) };
    let expected: Vec<i64> = (1..=30).map(|k| if k == 10 || k == 17 { -5 } else { 0 }).collect();
    assert_eq!(number_errors(&run(&[spec], 30)), expected);
}

#[test]
fn what_would_do_nothing_is_refused() {
    let offset = fault("time-offset", &[("offset", seconds(1e-10)), clock("both")], 1, 1);
    assert!(refused(&offset).starts_with("offset: 0.0000000001 s, at least half"));
    let step = fault("time-step", &[("step", seconds(0.0)), clock("both")], 1, 1);
    assert!(refused(&step).starts_with("step: 0 s"));
    let skew = ("skew", Value::Quantity(-1.0, Dimension::Ratio));
    let skew = fault("clock-skew", &[skew, clock("both"), afterwards("stays")], 1, 1);
    assert!(refused(&skew).contains("frozen-clock"));
    let skip = fault("sequence-gap", &[("skip", Value::Integer(0)), afterwards("stays")], 1, 1);
    assert!(refused(&skip).starts_with("skip: 0"));
}

#[test]
fn an_onset_that_meets_two_epochs_at_once_is_one_onset() {
    // Every epoch arrives twice: the first of the pair repeats the stamp before, the second has its
    // own, as the next sample of the run.
    let copies = [("copies", Value::Integer(1)), ("delay", Value::Quantity(0.0, Dimension::Time))];
    let doubled = FaultSpec { id: "doubled".into(), ..fault("duplicate", &copies, 1, 20) };
    let stamp = fault("duplicate-stamp", &[("run", Value::Integer(2))], 10, 2);
    let outcome = run(&[doubled, stamp], 20);
    let found: Vec<i64> = [9, 10, 11, 12]
        .iter()
        .flat_map(|at| outcome.at(*at).into_iter().map(|epoch| error(*at, &epoch)))
        .collect();
    assert_eq!(found, [0, 0, -PERIOD, 0, -PERIOD, 0, 0, 0]);
}

#[test]
fn an_instant_in_which_nothing_arrives_happens_to_the_next_epoch() {
    let loss = ("loss", Value::Quantity(1.0, Dimension::Ratio));
    let lost = fault("dropout", &[loss, ("aiding", Value::Choice("lost"))], 10, 5);
    let step = fault("time-step", &[("step", seconds(1.0)), clock("instrument")], 12, 1);
    let outcome = run(&[FaultSpec { id: "lost".into(), ..lost }, step], 20);
    let found = errors(&outcome);
    assert_eq!(found[..9], [0; 9]);
    assert_eq!(found[9..], [1_000_000_000; 6]);
}
