//! Data of the slots.

use super::layout::{Layout, Settable, name};
use octant_fmu::calibrator::table::MODEL;
use octant_fmu::table::{DeclaredCausality, DeclaredVariable};

#[test]
fn slots_are_those_of_the_table() {
    let layout = Layout::of(&MODEL);
    assert_eq!(layout.slots.len(), MODEL.slots());
    let slot = MODEL.slot("gyro.delta_theta");
    assert_eq!(layout.slots[slot].elements, 3);
    assert_eq!(layout.slots[slot + 1].elements, 0);
    assert_eq!(layout.slots[slot].settable, Settable::Always);
    assert_eq!(name(&MODEL, slot + 1), "gyro.delta_theta[2]");
    assert_eq!(name(&MODEL, MODEL.slot("mode")), "mode");
    assert_eq!(layout.slots[MODEL.slot("mode")].settable, Settable::Never);
    assert_eq!(layout.slots[MODEL.slot("site.latitude")].settable, Settable::Fixed);
    assert!(layout.slots[MODEL.slot("reference.height")].any);
    assert_eq!(layout.slots[0].elements, 1);
    let outputs: usize = MODEL
        .variables
        .iter()
        .filter(|variable| variable.causality == DeclaredCausality::Output)
        .map(DeclaredVariable::slots)
        .sum();
    assert_eq!(layout.outputs.len(), outputs);
}
