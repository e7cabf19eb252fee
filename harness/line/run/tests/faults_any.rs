//! Any combination of kinds, values, triggers and seeds runs to a verdict, and the receipts agree
//! with the recording.

#[path = "../../../../models/faults/tests/any_fault/draw.rs"]
pub(super) mod draw;

use octant_base::control::Control;
use octant_faults::catalogue::Acts;
use octant_faults::trigger::Trigger;
use octant_faults::{FaultSpec, Receipt};
use octant_recorder::reader::{Epochs, RecordedEpoch, Recording as Reader};
use octant_run::{StreamKeeping, assemble, run_method};
use octant_scenario::{Fault, Method, Place, Scenario};
use proptest::prelude::*;
use std::path::Path;

/// Twelve seconds of calibration with one move, and three of navigation.
pub(super) const EPOCHS: u64 = 3000;
pub(super) const SCENARIO: &str = "schema = 1\n\
    [procedure.calibration]\nduration = \"12 s\"\n\
    stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }, { azimuth = \"0 deg\", roll = \"45 deg\" }]\n\
    [procedure.navigation]\nduration = \"3 s\"\n[record]\nsamples = \"full\"\n";

pub(super) fn scenario(specs: &[FaultSpec]) -> Scenario {
    let mut scenario = Scenario::parse(SCENARIO, "f.toml", Path::new(""), &[]).unwrap();
    assert_eq!(scenario.samples(), Some(EPOCHS));
    scenario.faults = specs
        .iter()
        .map(|spec| Fault { spec: spec.clone(), fires: vec![500], place: Place::Default })
        .collect();
    scenario
}

/// Returns whether a kind's effect is visible between clean and faulted stream; this depends on the
/// kind alone. (Samples of a unit without power are lost.)
fn shows(spec: &FaultSpec) -> bool {
    matches!(spec.kind.acts, Acts::Samples | Acts::Delivery | Acts::Unit)
}

/// Finds the first step of the source in which the epochs that reached the core differ from the
/// source's.
fn first_altered(path: &Path) -> Option<u64> {
    let mut reader = Epochs::new(Reader::open(path).unwrap());
    let mut steps = 0u64;
    while let Some(epoch) = reader.next_epoch().unwrap() {
        let RecordedEpoch { sample, clean_sample, clean_aiding, .. } = &epoch;
        let Some(delivered) = clean_sample.or(*sample) else { continue };
        // Without a fault the source numbers its samples consecutively: another number belongs to
        // an additional epoch.
        if delivered.sequence != steps + 1 {
            return Some(steps);
        }
        steps += 1;
        if clean_sample.is_some() || clean_aiding.is_some() {
            return Some(steps);
        }
    }
    None
}

fn receipts(specs: &[FaultSpec], seed: u64) -> Option<(Vec<Receipt>, Option<u64>)> {
    let scenario = scenario(specs);
    if scenario.station(seed).is_err() {
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.mcap");
    let recording = StreamKeeping::File(&path);
    let run = run_method(&scenario, Method::Primary, seed, recording, &Control::default()).unwrap();
    let receipts = run.receipts.clone();
    let run = assemble(&scenario, seed, run, None).unwrap();
    assert_eq!(run.summary.faults.len(), specs.len());
    // The JSON output can be read again.
    let json = run.summary.to_json().unwrap();
    assert_eq!(
        octant_score::summary::Summary::from_json(&json).unwrap().verdict,
        run.summary.verdict
    );
    Some((receipts, first_altered(&path)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_combination_runs_to_a_verdict(
        mut specs in proptest::collection::vec(draw::spec(), 1..5),
        seed in 0..1000u64,
    ) {
        for (index, spec) in specs.iter_mut().enumerate() {
            spec.id = format!("f{index}");
            if spec.schedule.trigger == (Trigger::After { fault: spec.id.clone(), delay: 0 }) {
                spec.schedule.trigger = Trigger::Epoch(1000);
            }
        }
        let Some((receipts, altered)) = receipts(&specs, seed) else { return Ok(()) };
        let of_stream: Vec<&Receipt> =
            receipts.iter().zip(&specs).filter(|(_, spec)| shows(spec)).map(|(r, _)| r).collect();
        let first = of_stream.iter().filter_map(|receipt| receipt.first_sample).min();
        // The effect of faults inside the plant shows too, in single counts before it counts as one.
        let plant = receipts
            .iter()
            .zip(&specs)
            .any(|(receipt, spec)| spec.kind.acts == Acts::Plant && receipt.firings > 0);
        if let (Some(found), false) = (altered, plant) {
            prop_assert!(first.is_some_and(|first| first <= found), "{receipts:?} {found}");
        }
        for receipt in &receipts {
            prop_assert!(receipt.armed);
            prop_assert!(receipt.firings > 0 || !receipt.fired());
        }
    }

    #[test]
    fn the_receipt_of_one_fault_is_what_the_recording_shows(
        mut spec in draw::spec().prop_filter("in place", |spec| spec.kind.acts == Acts::Samples),
        seed in 0..1000u64,
    ) {
        spec.id = "f0".into();
        if matches!(spec.schedule.trigger, Trigger::After { .. }) {
            spec.schedule.trigger = Trigger::Epoch(1000);
        }
        let Some((receipts, _)) = receipts(std::slice::from_ref(&spec), seed) else { return Ok(()) };
        let scenario = scenario(&[spec]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("recording.mcap");
        let run = run_method(
            &scenario, Method::Primary, seed, StreamKeeping::File(&path), &Control::default(),
        ).unwrap();
        prop_assert_eq!(&run.receipts, &receipts, "the same run twice");
        let mut reader = Epochs::new(Reader::open(&path).unwrap());
        let mut found = Vec::new();
        let mut number = 0;
        while let Some(epoch) = reader.next_epoch().unwrap() {
            number += u64::from(epoch.sample.is_some());
            if epoch.clean_sample.is_some() || epoch.clean_aiding.is_some() {
                found.push(number);
            }
        }
        let receipt = &receipts[0];
        prop_assert_eq!(receipt.samples_altered, found.len() as u64);
        prop_assert_eq!(receipt.first_sample, found.first().copied());
        prop_assert_eq!(receipt.last_sample, found.last().copied());
    }
}
