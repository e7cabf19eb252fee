//! Any combination of faults of delivery: no epoch is invented, lost or doubled beyond the kinds'
//! models, order is kept where they keep it, and receipts agree.

use crate::common::{self, Outcome, bytes, clean, fault, run};
use octant_faults::catalogue::Dimension;
use octant_faults::trigger::{Repeat, Trigger};
use octant_faults::{FaultSpec, Receipt, Value};
use octant_sample::Epoch;
use proptest::prelude::*;

/// Epochs of a run, and of its first part, in which faults may set in and end.
const EPOCHS: u64 = 900;
const FAULTY: u64 = 300;

/// Permitted effects of a fault, for the test's own account.
#[derive(Clone, Debug)]
struct Part {
    spec: FaultSpec,
    loses: bool,
    copies: usize,
    /// True if epochs may overtake others.
    disorders: bool,
}

fn samples(n: u64) -> Value {
    Value::Quantity(n as f64, Dimension::Samples)
}

/// A kind with its values; its schedule is filled in later.
fn kind() -> impl Strategy<Value = Part> {
    let part = |kind: &str, values: &[(&'static str, Value)]| Part {
        spec: fault(kind, values, 1, 1),
        loses: kind == "dropout",
        copies: 0,
        disorders: kind == "reorder",
    };
    prop_oneof![
        (0.05..1.0, any::<bool>()).prop_map(move |(loss, kept)| {
            let aiding = Value::Choice(if kept { "kept" } else { "lost" });
            part(
                "dropout",
                &[("loss", Value::Quantity(loss, Dimension::Ratio)), ("aiding", aiding)],
            )
        }),
        (2i64..20, any::<bool>()).prop_map(move |(window, random)| {
            let order = Value::Choice(if random { "random" } else { "reversed" });
            part("reorder", &[("window", Value::Integer(window)), ("order", order)])
        }),
        (1u64..40, 0usize..3).prop_map(move |(delay, which)| {
            let catch_up = ["at once", "gradually", "overtaken"][which];
            let values = [("delay", samples(delay)), ("catch_up", Value::Choice(catch_up))];
            Part { disorders: which == 2, ..part("late-delivery", &values) }
        }),
        (1i64..3, 0u64..30).prop_map(move |(copies, delay)| {
            let values = [("copies", Value::Integer(copies)), ("delay", samples(delay))];
            let copies = copies as usize;
            Part { copies, disorders: delay > 0, ..part("duplicate", &values) }
        }),
    ]
}

fn part() -> impl Strategy<Value = Part> {
    (kind(), 1..FAULTY / 2, 1..60u64, 1u32..4, 0..20u64).prop_map(
        |(mut part, first, epochs, times, pause)| {
            part.spec.schedule.trigger = Trigger::Epoch(first);
            part.spec.schedule.duration = Some(epochs);
            let every = (epochs + pause).min(FAULTY / 6);
            part.spec.schedule.repeat = Repeat::Times { times, every };
            part
        },
    )
}

fn parts() -> impl Strategy<Value = Vec<Part>> {
    proptest::collection::vec(part(), 1..=4).prop_map(|mut parts| {
        for (index, part) in parts.iter_mut().enumerate() {
            part.spec.id = format!("f{index}");
        }
        parts
    })
}

/// Epochs by the step in which they were delivered.
fn by_step(outcome: &Outcome) -> Vec<Vec<Epoch>> {
    let mut steps = vec![Vec::new(); EPOCHS as usize + 1];
    outcome.delivered.iter().for_each(|(at, epoch)| steps[*at as usize].push(*epoch));
    steps
}

/// Checks the receipt of a stage against its input and output.
fn check_receipt(receipt: &Receipt, before: &[Vec<Epoch>], after: &[Vec<Epoch>]) {
    let differs = |step: &usize| before[*step] != after[*step];
    let altered: Vec<usize> = (0..before.len()).filter(differs).collect();
    let (mut clean, mut faulted) = (crc32fast::Hasher::new(), crc32fast::Hasher::new());
    for step in &altered {
        clean.update(&bytes(&before[*step]));
        faulted.update(&bytes(&after[*step]));
    }
    assert_eq!(receipt.samples_altered, altered.len() as u64);
    assert_eq!(receipt.first_sample, altered.first().map(|step| *step as u64));
    assert_eq!(receipt.last_sample, altered.last().map(|step| *step as u64));
    assert_eq!(receipt.clean_crc32, clean.finalize());
    assert_eq!(receipt.faulted_crc32, faulted.finalize());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn nothing_is_invented_lost_or_doubled_but_as_documented(parts in parts()) {
        let specs: Vec<FaultSpec> = parts.iter().map(|part| part.spec.clone()).collect();
        let outcome = run(&specs, EPOCHS);
        let loses = parts.iter().any(|part| part.loses);
        let most: usize = parts.iter().map(|part| 1 + part.copies).product();
        let ordered = !parts.iter().any(|part| part.disorders);
        let mut counts = vec![0usize; EPOCHS as usize + 1];
        let mut last = 0;
        for (at, epoch) in &outcome.delivered {
            let number = epoch.sample.sequence;
            prop_assert_eq!(epoch.sample, clean(number).sample);
            prop_assert!(number <= *at, "an epoch came before it was made");
            match (epoch.aiding, clean(number).aiding) {
                (Some(found), Some(own)) => prop_assert!(found.same_bits(&own)),
                (Some(found), None) => {
                    // Aiding kept from an epoch that was lost.
                    let of = found.device_time.ns / common::PERIOD_NS;
                    prop_assert!(loses && found.same_bits(&clean(of).aiding.unwrap()));
                }
                (None, own) => prop_assert!(own.is_none()),
            }
            counts[number as usize] += 1;
            prop_assert!(!ordered || number >= last, "{number} after {last}");
            last = number;
        }
        for (number, count) in counts.iter().enumerate().skip(1) {
            prop_assert!(*count <= most, "{number} came {count} times");
            // All holds ended long before.
            prop_assert!(*count >= 1 || loses, "{number} never came");
            prop_assert!(number <= 2 * FAULTY as usize || *count == 1);
        }
    }

    #[test]
    fn receipts_are_what_went_in_and_what_came_out(parts in parts()) {
        let specs: Vec<FaultSpec> = parts.iter().map(|part| part.spec.clone()).collect();
        let receipts = run(&specs, EPOCHS).receipts;
        let mut before = by_step(&run(&[], EPOCHS));
        for stage in 0..specs.len() {
            let after = by_step(&run(&specs[..=stage], EPOCHS));
            check_receipt(&receipts[stage], &before, &after);
            before = after;
        }
    }

    #[test]
    fn a_lingering_fault_meets_every_epoch_whatever_came_before(
        mut parts in parts(),
        at in 1..FAULTY,
    ) {
        // The counter jumps once: from some epoch in the order of delivery on, all numbers are
        // wrong, and none is wrong twice.
        parts.retain(|part| !part.loses);
        let mut specs: Vec<FaultSpec> = parts.iter().map(|part| part.spec.clone()).collect();
        let unshifted = run(&specs, EPOCHS).delivered;
        let values = [("skip", Value::Integer(100_000)), ("afterwards", Value::Choice("stays"))];
        specs.push(fault("sequence-gap", &values, at, 1));
        let shifted = run(&specs, EPOCHS).delivered;
        prop_assert_eq!(shifted.len(), unshifted.len());
        let first = unshifted.iter().position(|(step, _)| *step >= at).unwrap();
        for (index, ((step, found), (was_step, was))) in shifted.iter().zip(&unshifted).enumerate() {
            let mut expected = *was;
            expected.sample.sequence += if index >= first { 100_000 } else { 0 };
            prop_assert_eq!(step, was_step);
            prop_assert!(found.same_bits(&expected), "{} {:?} {:?}", index, found, expected);
        }
    }

    #[test]
    fn one_damaged_number_is_one(mut parts in parts(), at in 1..FAULTY) {
        parts.retain(|part| !part.loses);
        let mut specs: Vec<FaultSpec> = parts.iter().map(|part| part.spec.clone()).collect();
        let values = [("skip", Value::Integer(100_000)), ("afterwards", Value::Choice("corrected"))];
        specs.push(fault("sequence-gap", &values, at, 1));
        let outcome = run(&specs, EPOCHS);
        let damaged = outcome.delivered.iter().filter(|(_, e)| e.sample.sequence > EPOCHS).count();
        prop_assert_eq!(damaged, 1);
        prop_assert_eq!(outcome.receipts.last().unwrap().samples_altered, 1);
    }
}
