//! The table of the Plant: every variable with its name, meaning, unit and range.

mod enumerations;
mod faults;
mod instrument;
mod ports;
pub(crate) mod slot;
mod world;

pub(crate) use enumerations::acts_in_plant;
pub use enumerations::{AIDING, FAULT_KIND, MOTION, REFERENCE_KIND};
pub use faults::{FAULT_NUMBERS, FAULT_SLOTS};
pub use world::SINUSOIDS_MAX;

use crate::table::{DeclaredVariable, Model, concatenated, count};

const PARTS: &[&[DeclaredVariable]] = &[
    &ports::INPUTS,
    &faults::INPUTS,
    &ports::OUTPUTS,
    &faults::OUTPUTS,
    &world::PARAMETERS,
    &instrument::PARAMETERS,
    &faults::PARAMETERS,
];

const COUNT: usize = count(PARTS);

static VARIABLES: [DeclaredVariable; COUNT] = concatenated(PARTS);

/// The Plant.
pub static MODEL: Model = Model {
    name: "Plant",
    stem: "plant",
    description: "The truth of a dual-axis rotational inertial navigation system: motion of the \
                  case, two-axis turntable, gyros and accelerometers with their errors, the \
                  reference of a calibration, and faults in all of them.",
    variables: &VARIABLES,
    periods_per_step: (1, 1),
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{DeclaredCausality, ElementType};
    use std::collections::BTreeSet;

    #[test]
    fn every_variable_is_described_once_and_starts_within_its_range() {
        let mut names = BTreeSet::new();
        for variable in MODEL.variables {
            let name = variable.name;
            assert!(names.insert(name), "{name} twice");
            assert!(variable.description.ends_with('.'), "{name}");
            let has_start = matches!(
                variable.causality,
                DeclaredCausality::Parameter | DeclaredCausality::Input
            );
            assert_eq!(variable.start.is_empty(), !has_start, "{name}");
            assert!(
                variable.start.len() <= 1 || variable.start.len() == variable.slots(),
                "{name}"
            );
            for start in variable.start {
                assert!(variable.min.is_none_or(|min| *start >= min), "{name}: {start}");
                assert!(variable.max.is_none_or(|max| *start <= max), "{name}: {start}");
                if let ElementType::Enumeration(of) = variable.kind {
                    assert!(of.items.iter().any(|item| f64::from(item.0) == *start), "{name}");
                }
            }
            assert_eq!(MODEL.find(name).unwrap().0, MODEL.slot(name));
        }
        // No name may be a part of another's.
        for name in &names {
            let inner = format!("{name}.");
            assert!(!names.iter().any(|other| other.starts_with(&inner)), "{name}");
        }
    }

    /// A tool connects both models by name: each output of the plant has the type of the core's
    /// input.
    #[test]
    fn outputs_are_the_inputs_of_the_calibrator_and_its_command_is_the_input() {
        let of = |model: &'static Model, causality| {
            model.variables.iter().filter(move |variable| variable.causality == causality)
        };
        let calibrator = &crate::calibrator::table::MODEL;
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
}
