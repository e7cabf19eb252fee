//! The table of the Calibrator: every variable with its name, meaning, unit and range.

mod enumerations;
mod parameters;
mod ports;
pub(crate) mod slot;

pub use enumerations::*;
pub(crate) use parameters::PARAMETERS;
pub(crate) use ports::OUTPUTS;

use crate::table::{DeclaredVariable, Model, concatenated};

const COUNT: usize = ports::INPUTS.len() + ports::OUTPUTS.len() + parameters::PARAMETERS.len();

static VARIABLES: [DeclaredVariable; COUNT] =
    concatenated(&[&ports::INPUTS, &ports::OUTPUTS, &parameters::PARAMETERS]);

/// The Calibrator.
pub static MODEL: Model = Model {
    name: "Calibrator",
    stem: "calibrator",
    description: "Calibration core of a dual-axis rotational inertial navigation system: it aligns, \
                  turns the gimbals through a position sequence, estimates its sensors' errors, \
                  compensates them and navigates.",
    variables: &VARIABLES,
    periods_per_step: (1, 1),
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{DeclaredCausality, ElementType};
    use octant_sample::parameters::ParameterGroup;
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

    #[test]
    fn groups_of_parameters_lie_one_after_another() {
        for group in ParameterGroup::ALL {
            let range = group.range();
            for (prefix, first) in [
                ("parameters", slot::PARAMETERS),
                ("sigma", slot::SIGMA),
                ("initial_parameters", slot::INITIAL_PARAMETERS),
            ] {
                let (slot, variable) = MODEL.find(&format!("{prefix}.{}", group.name())).unwrap();
                assert_eq!(slot, first + range.start);
                assert_eq!(variable.slots(), range.len());
            }
            for (prefix, first) in
                [("estimated", slot::ESTIMATED), ("prior", slot::PRIOR_PARAMETERS)]
            {
                let name = format!("procedure.calibration.{prefix}.{}", group.name());
                assert_eq!(MODEL.find(&name).unwrap().0, first + group as usize);
            }
        }
    }
}
