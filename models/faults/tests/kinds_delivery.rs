//! Samples that are lost, late, doubled, in another order.

use crate::common::{Outcome, clean, fault, refused, run, setup};
use octant_faults::catalogue::Dimension;
use octant_faults::station::FLIGHT_MAX;
use octant_faults::trigger::Repeat;
use octant_faults::{FaultSpec, Station, Value};

fn samples(n: f64) -> Value {
    Value::Quantity(n, Dimension::Samples)
}

/// Numbers of the epochs delivered in each step; checks that each epoch is unaltered.
fn steps(outcome: &Outcome, epochs: u64) -> Vec<Vec<u64>> {
    let mut steps = vec![Vec::new(); epochs as usize + 1];
    for (at, epoch) in &outcome.delivered {
        assert!(epoch.same_bits(&clean(epoch.sample.sequence)), "an epoch was altered");
        steps[*at as usize].push(epoch.sample.sequence);
    }
    steps
}

fn dropout(loss: f64, aiding: &'static str, first: u64, epochs: u64) -> FaultSpec {
    let loss = ("loss", Value::Quantity(loss, Dimension::Ratio));
    fault("dropout", &[loss, ("aiding", Value::Choice(aiding))], first, epochs)
}

#[test]
fn all_samples_of_a_dropout_are_lost_and_no_other() {
    let outcome = run(&[dropout(1.0, "lost", 195, 10)], 300);
    let expected: Vec<u64> = (1..195).chain(205..=300).collect();
    let found: Vec<u64> = outcome.delivered.iter().map(|(at, _)| *at).collect();
    assert_eq!(found, expected);
    assert!(steps(&outcome, 300).iter().enumerate().all(|(k, s)| s.is_empty() || s == &[k as u64]));
    let receipt = &outcome.receipts[0];
    assert_eq!(
        (receipt.samples_altered, receipt.first_sample, receipt.last_sample),
        (10, Some(195), Some(204))
    );
    assert_eq!(receipt.faulted_crc32, 0, "of no bytes at all");
}

#[test]
fn aiding_of_a_lost_sample_is_lost_or_goes_with_the_next() {
    let outcome = run(&[dropout(1.0, "kept", 195, 10)], 300);
    let next = outcome.at(205)[0];
    assert_eq!(next.aiding, clean(200).aiding);
    assert_eq!(next.sample, clean(205).sample);
    assert_eq!(outcome.receipts[0].samples_altered, 11, "ten lost, one with aiding not its own");
    // A newer message of the sample itself has priority.
    let outcome = run(&[dropout(1.0, "kept", 195, 205)], 450);
    assert!(outcome.at(400)[0].same_bits(&clean(400)));
    assert!(outcome.at(401)[0].same_bits(&clean(401)));
    let outcome = run(&[dropout(1.0, "lost", 195, 10)], 300);
    assert!(outcome.delivered.iter().all(|(at, epoch)| epoch.same_bits(&clean(*at))));
}

#[test]
fn samples_are_lost_at_random_with_their_probability() {
    let outcome = run(&[dropout(0.1, "lost", 1, 50_000)], 50_000);
    let lost = 50_000.0 - outcome.delivered.len() as f64;
    assert!((lost - 5000.0).abs() < 5.0 * (50_000.0f64 * 0.1 * 0.9).sqrt(), "{lost}");
    assert_eq!(outcome.receipts[0].samples_altered as f64, lost);
    let again = run(&[dropout(0.1, "lost", 1, 20_000)], 20_000);
    assert_eq!(again.delivered[..], outcome.delivered[..again.delivered.len()]);
}

fn reorder(window: i64, order: &'static str, first: u64, epochs: u64) -> FaultSpec {
    let values = [("window", Value::Integer(window)), ("order", Value::Choice(order))];
    fault("reorder", &values, first, epochs)
}

#[test]
fn neighbours_are_swapped() {
    let outcome = run(&[reorder(2, "reversed", 3, 4)], 9);
    let none: Vec<u64> = vec![];
    let expected = [vec![1], vec![2], none.clone(), vec![4, 3], none, vec![6, 5], vec![7]];
    assert_eq!(steps(&outcome, 9)[1..8], expected);
    let receipt = &outcome.receipts[0];
    assert_eq!((receipt.first_sample, receipt.last_sample), (Some(3), Some(6)));
}

#[test]
fn what_a_window_holds_at_the_end_comes_out() {
    let outcome = run(&[reorder(4, "reversed", 11, 6)], 30);
    let found = steps(&outcome, 30);
    assert_eq!((&found[14], &found[17]), (&vec![14, 13, 12, 11], &vec![16, 15, 17]));
    assert_eq!(outcome.delivered.len(), 30);
    assert!((18..=30).all(|k| found[k as usize] == [k]));
}

#[test]
fn a_window_is_shuffled_evenly() {
    let outcome = run(&[reorder(3, "random", 1, 30_000)], 30_000);
    let mut counts = [0u32; 6];
    for (k, step) in steps(&outcome, 30_000).iter().enumerate().skip(1) {
        if k % 3 != 0 {
            assert!(step.is_empty());
            continue;
        }
        let order: Vec<u64> = step.iter().map(|n| n + 2 - k as u64).collect();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2]);
        // The first number decides among three, the second between the remaining two.
        counts[(2 * order[0] + u64::from(order[1] > order[2])) as usize] += 1;
    }
    let expected = 10_000.0 / 6.0;
    let chi2: f64 = counts.iter().map(|n| (f64::from(*n) - expected).powi(2) / expected).sum();
    // 5 degrees of freedom: 25 has a probability of 1.4e-4.
    assert!(chi2 < 25.0, "{counts:?}");
}

fn late(delay: Value, catch_up: &'static str, first: u64, epochs: u64) -> FaultSpec {
    fault(
        "late-delivery",
        &[("delay", delay), ("catch_up", Value::Choice(catch_up))],
        first,
        epochs,
    )
}

#[test]
fn late_samples_come_late_and_all_at_once_at_the_end() {
    // 14 ms are 2.8 periods: three samples.
    let delay = Value::Quantity(0.014, Dimension::Time);
    let found = steps(&run(&[late(delay, "at once", 11, 10)], 30), 30);
    for k in 1..=30u64 {
        let expected = match k {
            11..14 => vec![],
            14..21 => vec![k - 3],
            21 => vec![18, 19, 20, 21],
            _ => vec![k],
        };
        assert_eq!(found[k as usize], expected, "{k}");
    }
}

#[test]
fn late_samples_catch_up_gradually() {
    let found = steps(&run(&[late(samples(3.0), "gradually", 11, 10)], 30), 30);
    let expected = [vec![17], vec![18, 19], vec![20, 21], vec![22, 23], vec![24]];
    assert_eq!(found[20..25], expected);
}

#[test]
fn late_samples_are_overtaken() {
    let outcome = run(&[late(samples(3.0), "overtaken", 11, 10)], 30);
    let expected = [vec![17], vec![18, 21], vec![19, 22], vec![20, 23], vec![24]];
    assert_eq!(steps(&outcome, 30)[20..25], expected);
    assert_eq!(outcome.receipts[0].last_sample, Some(23));
}

#[test]
fn a_fault_that_lasts_stays_late_to_the_end() {
    let mut spec = late(samples(100.0), "at once", 11, 1);
    spec.schedule.duration = None;
    let outcome = run(&[spec], 500);
    assert_eq!(outcome.delivered.len(), 400);
    assert!((111..=500).all(|k| outcome.at(k)[0].same_bits(&clean(k - 100))));
}

#[test]
fn an_onset_before_all_have_caught_up_keeps_the_order() {
    let mut spec = late(samples(8.0), "gradually", 11, 10);
    spec.schedule.repeat = Repeat::Times { times: 3, every: 13 };
    let outcome = run(&[spec], 200);
    let found: Vec<u64> = outcome.delivered.iter().map(|(_, e)| e.sample.sequence).collect();
    assert_eq!(found, (1..=200).collect::<Vec<_>>());
}

fn duplicate(copies: i64, delay: f64, first: u64, epochs: u64) -> FaultSpec {
    let values = [("copies", Value::Integer(copies)), ("delay", samples(delay))];
    fault("duplicate", &values, first, epochs)
}

#[test]
fn samples_are_doubled_at_once_or_later() {
    let outcome = run(&[duplicate(2, 0.0, 3, 2)], 6);
    let expected = [vec![1], vec![2], vec![3, 3, 3], vec![4, 4, 4], vec![5], vec![6]];
    assert_eq!(steps(&outcome, 6)[1..], expected);
    assert_eq!(outcome.receipts[0].samples_altered, 2);
    let outcome = run(&[duplicate(1, 2.0, 3, 3)], 9);
    let expected =
        [vec![2], vec![3], vec![4], vec![5, 3], vec![6, 4], vec![7, 5], vec![8], vec![9]];
    assert_eq!(steps(&outcome, 9)[2..], expected);
    let receipt = &outcome.receipts[0];
    assert_eq!((receipt.first_sample, receipt.last_sample), (Some(5), Some(7)));
}

#[test]
fn a_doubled_sample_has_its_aiding_twice() {
    let outcome = run(&[duplicate(1, 0.0, 200, 1)], 201);
    let twice = outcome.at(200);
    assert_eq!(twice.len(), 2);
    assert!(twice.iter().all(|epoch| epoch.same_bits(&clean(200))));
}

#[test]
fn a_late_link_delivers_in_time_what_a_lossy_one_leaves() {
    // In the steps of the dropout no epoch comes in, but late ones still come out.
    let mut drop = dropout(1.0, "lost", 20, 5);
    drop.id = "drop".into();
    let outcome = run(&[drop, late(samples(4.0), "at once", 11, 30)], 60);
    let found = steps(&outcome, 60);
    for k in 15..=40u64 {
        let expected = if (24..29).contains(&k) { vec![] } else { vec![k - 4] };
        assert_eq!(found[k as usize], expected, "{k}");
    }
}

#[test]
fn what_can_not_be_held_is_refused() {
    let message = refused(&late(samples(0.4), "at once", 1, 1));
    assert_eq!(message, "delay: 0 samples of 0.005 s, 1 to 4096 are expected");
    let message = refused(&late(Value::Quantity(3600.0, Dimension::Time), "at once", 1, 1));
    assert_eq!(message, "delay: 720000 samples of 0.005 s, 1 to 4096 are expected");
    assert!(refused(&dropout(0.0, "lost", 1, 1)).starts_with("loss: 0"));
    let avalanche: Vec<FaultSpec> =
        (0..6).map(|i| FaultSpec { id: format!("{i}"), ..duplicate(8, 0.0, 1, 1) }).collect();
    let (id, error) = Station::new(&avalanche, &setup()).unwrap_err();
    assert_eq!(id, "5", "nine to the sixth is above the limit");
    assert!(error.to_string().contains("531441 epochs"), "{error}");
}

#[test]
fn the_longest_delay_fits() {
    let mut spec = late(samples(FLIGHT_MAX as f64), "at once", 1, 5000);
    spec.schedule.duration = Some(5000);
    let outcome = run(&[spec], 5001);
    assert_eq!(outcome.at(4096).len(), 0);
    assert!(outcome.at(4097)[0].same_bits(&clean(1)));
    assert_eq!(outcome.at(5001).len(), 4097);
}
