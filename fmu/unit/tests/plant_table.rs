//! The table of the Plant.

use crate::tables::check;
use octant_faults::catalogue::Acts;
use octant_faults::kinds;
use octant_fmu::plant::table::{FAULT_KIND, FAULT_SLOTS, MODEL, SINUSOIDS_MAX, slot};
use octant_fmu::table::{DeclaredCausality, Model};
use octant_sample::Status;

#[test]
fn every_variable_is_described_once_and_starts_within_its_range() {
    check(&MODEL);
}

/// A tool connects both models by name: each output of the plant has the type of the core's
/// input.
#[test]
fn outputs_are_the_inputs_of_the_calibrator_and_its_command_is_the_input() {
    let of = |model: &'static Model, causality| {
        model.variables.iter().filter(move |variable| variable.causality == causality)
    };
    let calibrator = &octant_fmu::calibrator::table::MODEL;
    for input in of(calibrator, DeclaredCausality::Input) {
        let (_, output) = MODEL.find(input.name).unwrap();
        assert_eq!(output.causality, DeclaredCausality::Output, "{}", input.name);
        assert_eq!(
            (output.kind, output.elements, output.quantity),
            (input.kind, input.elements, input.quantity),
            "{}",
            input.name
        );
    }
    for input in
        of(&MODEL, DeclaredCausality::Input).filter(|input| !input.name.starts_with("fault"))
    {
        let (_, output) = calibrator.find(input.name).unwrap();
        assert_eq!((output.kind, output.elements), (input.kind, input.elements));
        assert_eq!(output.quantity, input.quantity);
    }
}

#[test]
fn what_comes_several_times_has_equal_strides() {
    for fault in 1..=FAULT_SLOTS {
        let at = |name: &str| MODEL.slot(&format!("fault[{fault}].{name}"));
        let behind = fault - 1;
        assert_eq!(at("kind"), slot::FAULT_KIND + behind * slot::FAULT_STRIDE);
        assert_eq!(at("values"), slot::FAULT_VALUES + behind * slot::FAULT_STRIDE);
        assert_eq!(at("armed"), slot::FAULT_ARMED + behind * slot::RECEIPT_STRIDE);
        assert_eq!(at("samples_altered"), slot::FAULT_ALTERED + behind * slot::RECEIPT_STRIDE);
        assert_eq!(at("fire"), slot::FAULT_FIRE + behind);
    }
    for (index, motion) in
        ["roll", "pitch", "yaw", "surge", "sway", "heave"].into_iter().enumerate()
    {
        let count = MODEL.slot(&format!("motion.{motion}.count"));
        assert_eq!(count, slot::ROLL_COUNT + index * slot::MOTION_STRIDE);
        for (place, part) in ["amplitude", "period", "phase"].into_iter().enumerate() {
            let slot = MODEL.slot(&format!("motion.{motion}.{part}"));
            assert_eq!(slot, count + 1 + place * SINUSOIDS_MAX);
        }
    }
}

#[test]
fn flags_are_described_with_their_values() {
    let (_, status) = MODEL.find("imu.status").unwrap();
    for bit in Status::all().iter() {
        assert!(status.description.contains(&format!(" {}: ", bit.bits())), "{bit:?}");
    }
}

#[test]
fn the_items_are_the_kinds_that_can_act_by_their_places() {
    let all: Vec<_> = kinds::all().collect();
    for (value, name, summary) in &FAULT_KIND.items[1..] {
        let kind = all[*value as usize - 1];
        assert_eq!((kind.name, kind.summary), (*name, *summary));
    }
    let mut left: Vec<_> = all
        .iter()
        // Inside an FMU there is no wire, and no harness.
        .filter(|kind| !matches!(kind.acts, Acts::Wire | Acts::Host | Acts::Power))
        .filter(|kind| !FAULT_KIND.items.iter().any(|item| item.1 == kind.name))
        .map(|kind| kind.name)
        .collect();
    left.sort_unstable();
    assert_eq!(
        left,
        ["brown-out", "duplicate", "late-delivery", "reorder", "restart", "stale-table"]
    );
}
