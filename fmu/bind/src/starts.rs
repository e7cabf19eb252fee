//! Values with which an FMU starts.

use super::bind::start_exactly;
use super::find::count;
use octant_fmu_host::description::{
    Causality, Description, Initial, Variability, Variable, VariableType,
};
use octant_fmu_host::instance::{Instance, InstanceError, VariableGroup};
use std::collections::BTreeMap;

/// Values that are set before an FMU starts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Starts {
    /// Numbers by group, those of configuration mode first.
    pub(super) numbers: Vec<(VariableGroup, Vec<f64>)>,
    /// Texts.
    pub(super) texts: Vec<(VariableGroup, Vec<String>)>,
    /// Bytes.
    pub(super) bytes: Vec<(VariableGroup, Vec<Vec<u8>>)>,
}

impl Starts {
    /// Returns the values as bytes, by type and value reference of each variable: numbers as their 64
    /// bits, little-endian, texts and bytes as they are, with a zero byte after each.
    #[must_use]
    pub fn as_bytes(&self, description: &Description) -> BTreeMap<(&'static str, u32), Vec<u8>> {
        let mut all = BTreeMap::new();
        let mut put = |group: &VariableGroup, elements: Vec<Vec<u8>>| {
            let mut rest = elements.into_iter();
            for reference in &group.references {
                let variable = description
                    .variables
                    .iter()
                    .find(|one| one.kind == group.kind && one.reference == *reference);
                let count = variable.map_or(1, |variable| count(description, variable));
                let bytes: Vec<u8> = rest.by_ref().take(count).flatten().collect();
                all.insert((group.kind.name(), *reference), bytes);
            }
        };
        for (group, numbers) in &self.numbers {
            put(
                group,
                numbers.iter().map(|number| number.to_bits().to_le_bytes().into()).collect(),
            );
        }
        let ended = |bytes: &[u8]| [bytes, &[0]].concat();
        for (group, texts) in &self.texts {
            put(group, texts.iter().map(|text| ended(text.as_bytes())).collect());
        }
        for (group, bytes) in &self.bytes {
            put(group, bytes.iter().map(|bytes| ended(bytes)).collect());
        }
        all
    }

    /// Returns the values with which an FMU starts, as in [`Self::as_bytes`]: those of its parameters and
    /// inputs in the description, where they aren't set.
    #[must_use]
    pub fn effective(&self, description: &Description) -> BTreeMap<(&'static str, u32), Vec<u8>> {
        let mut all = BTreeMap::new();
        for variable in description.variables.iter().filter(|variable| settable(variable)) {
            let bytes = match variable.kind {
                VariableType::Clock => continue,
                VariableType::String | VariableType::Binary => variable
                    .start
                    .iter()
                    .flat_map(|text| [text.as_bytes(), &[0]].concat())
                    .collect(),
                _ => {
                    let mut numbers = vec![0.0; count(description, variable)];
                    start_exactly(variable, &mut numbers);
                    numbers.iter().flat_map(|number| number.to_bits().to_le_bytes()).collect()
                }
            };
            all.insert((variable.kind.name(), variable.reference), bytes);
        }
        all.extend(self.as_bytes(description));
        all
    }

    /// Sets the values.
    ///
    /// # Errors
    /// If the FMU refuses.
    pub fn apply(&self, instance: &mut dyn Instance) -> Result<(), InstanceError> {
        for (group, numbers) in &self.numbers {
            instance.set(group, numbers)?;
        }
        for (group, texts) in &self.texts {
            instance.set_strings(group, texts)?;
        }
        for (group, bytes) in &self.bytes {
            instance.set_binaries(group, bytes)?;
        }
        Ok(())
    }
}

/// Returns whether a variable has a start value that may be changed.
pub(super) fn settable(variable: &Variable) -> bool {
    if variable.variability == Variability::Constant {
        return false;
    }
    match variable.causality {
        Causality::Parameter | Causality::StructuralParameter | Causality::Input => true,
        Causality::CalculatedParameter | Causality::Independent => false,
        Causality::Output | Causality::Local => {
            matches!(variable.initial, Some(Initial::Exact | Initial::Approx))
        }
    }
}
