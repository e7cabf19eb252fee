//! Variables that are set or got together, and the positions of their numbers.

use super::super::description::{
    Causality, Description, Standard, Variability, Variable, VariableType,
};
use super::call::Base;
use super::error::InstanceError;
use super::number::Number;
use super::whole;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Time at which variables can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Access {
    /// Between steps.
    Step,
    /// At events, if the FMU has them (FMI 3.0 with event mode): discrete inputs, tunable
    /// parameters, clocks and clocked variables.
    Event,
    /// In configuration mode: structural parameters.
    Configuration,
}

/// Variables of one type that are set or got together.
///
/// Numbers of every type, Booleans, enumerations and clocks are exchanged as f64 (whole numbers
/// exact up to 2⁵³, or as their bits); text and bytes by separate functions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariableGroup {
    /// Type of the variables.
    pub kind: VariableType,
    /// Time at which they can be set.
    pub access: Access,
    /// Value references.
    pub references: Vec<u32>,
    /// Number of elements of all of them together.
    pub elements: usize,
    /// True if numbers of a [wide](super::whole) type are exchanged as their bits.
    pub bits: bool,
}

impl VariableGroup {
    /// Makes a group of one variable.
    ///
    /// # Errors
    /// If the number of its elements is unknown.
    pub fn of(description: &Description, variable: &Variable) -> Result<Self, InstanceError> {
        Ok(Self {
            kind: variable.kind,
            access: access(description, variable),
            references: vec![variable.reference],
            elements: elements(description, variable)?,
            bits: false,
        })
    }

    /// Exchanges whole numbers of 64 bits as their bits: see [`super::whole`].
    #[must_use]
    pub fn exactly(mut self) -> Self {
        self.bits = whole::is_wide(self.kind);
        self
    }
}

/// Smallest set of groups for a list of variables, and the position of each variable in the
/// concatenated numbers of all groups.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AccessPlan {
    /// Groups, for [`super::Instance::exchange`].
    pub groups: Vec<VariableGroup>,
    /// Positions of the elements of each variable, in the order of the list.
    pub places: Vec<Range<usize>>,
    /// Number of elements of all groups together.
    pub elements: usize,
}

impl AccessPlan {
    /// Groups variables that are numbers.
    ///
    /// # Errors
    /// If a variable is a String or a Binary, or the number of its elements is unknown.
    pub fn new(description: &Description, variables: &[&Variable]) -> Result<Self, InstanceError> {
        Self::of(description, variables, |group| group)
    }

    /// Groups as [`Self::new`], and exchanges whole numbers of 64 bits as their bits.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn exactly(
        description: &Description,
        variables: &[&Variable],
    ) -> Result<Self, InstanceError> {
        Self::of(description, variables, VariableGroup::exactly)
    }

    fn of(
        description: &Description,
        variables: &[&Variable],
        form: fn(VariableGroup) -> VariableGroup,
    ) -> Result<Self, InstanceError> {
        let mut groups: Vec<VariableGroup> = Vec::new();
        let mut within = Vec::with_capacity(variables.len());
        for variable in variables {
            if matches!(variable.kind, VariableType::String | VariableType::Binary) {
                return Err(InstanceError::unsupported(
                    &description.model_name,
                    format!("exchange {} as a number", variable.name),
                    format!("it is a {:?}", variable.kind),
                ));
            }
            let one = form(VariableGroup::of(description, variable)?);
            let place = groups
                .iter()
                .position(|group| group.kind == one.kind && group.access == one.access)
                .unwrap_or_else(|| {
                    groups.push(VariableGroup {
                        references: Vec::new(),
                        elements: 0,
                        ..one.clone()
                    });
                    groups.len() - 1
                });
            let group = &mut groups[place];
            within.push((place, group.elements, one.elements));
            group.references.extend(one.references);
            group.elements += one.elements;
        }
        let mut starts = Vec::with_capacity(groups.len());
        let mut elements = 0;
        for group in &groups {
            starts.push(elements);
            elements += group.elements;
        }
        let places = within
            .into_iter()
            .map(|(group, first, count)| starts[group] + first..starts[group] + first + count)
            .collect();
        Ok(Self { groups, places, elements })
    }
}

/// Time at which a variable can be set.
fn access(description: &Description, variable: &Variable) -> Access {
    let discrete = match variable.causality {
        Causality::StructuralParameter => return Access::Configuration,
        Causality::Input => variable.variability == Variability::Discrete,
        Causality::Parameter => variable.variability == Variability::Tunable,
        _ => false,
    };
    let clocked = !variable.clocks.is_empty() || variable.kind == VariableType::Clock;
    if description.standard == Standard::Fmi3 && (discrete || clocked) {
        Access::Event
    } else {
        Access::Step
    }
}

/// Number of elements of a variable, with structural parameters at their start values.
fn elements(description: &Description, variable: &Variable) -> Result<usize, InstanceError> {
    description.elements(variable).map_err(|error| {
        InstanceError::unsupported(
            &description.model_name,
            format!("tell how many elements {} has", variable.name),
            error.to_string(),
        )
    })
}

/// Name of the variable to which an element of a group belongs, with the element's number if the
/// group has arrays.
pub(super) fn element_name(
    description: &Description,
    group: &VariableGroup,
    element: usize,
) -> String {
    let mut first = 0;
    for reference in &group.references {
        let Some(variable) = description
            .variables
            .iter()
            .find(|variable| variable.reference == *reference && variable.kind == group.kind)
        else {
            return format!("value reference {reference}");
        };
        let count = elements(description, variable).unwrap_or(1);
        if element < first + count {
            return if variable.dimensions.is_empty() {
                variable.name.clone()
            } else {
                format!("element {} of {}", element - first + 1, variable.name)
            };
        }
        first += count;
    }
    format!("element {element}")
}

/// Error for a number of values that doesn't fit the groups.
pub(crate) fn unfitting(fmu: &str, groups: &[VariableGroup], found: usize) -> InstanceError {
    let expected: usize = groups.iter().map(|group| group.elements).sum();
    let kinds: Vec<String> = groups.iter().map(|group| format!("{:?}", group.kind)).collect();
    InstanceError::unsupported(
        fmu,
        format!("exchange {found} values of {}", kinds.join(", ")),
        format!("its variables have {expected} elements"),
    )
}

/// Checks that the number of values fits the group.
pub(super) fn expect_elements(
    base: &Base,
    group: &VariableGroup,
    values: usize,
) -> Result<(), InstanceError> {
    if values == group.elements {
        Ok(())
    } else {
        Err(unfitting(&base.name, std::slice::from_ref(group), values))
    }
}

/// Checks that the number of values fits the group, which has no arrays.
pub(super) fn expect_scalars(
    base: &Base,
    group: &VariableGroup,
    values: usize,
) -> Result<(), InstanceError> {
    if group.references.len() == group.elements {
        expect_elements(base, group, values)
    } else {
        Err(InstanceError::unsupported(
            &base.name,
            format!("exchange {} elements", group.elements),
            format!("{} variables without dimensions have as many", group.references.len()),
        ))
    }
}

/// Names the variables of a group that an FMU refused to give: after an error it can't be asked for them
/// one by one.
#[cold]
pub(crate) fn of_variables(
    error: InstanceError,
    description: &Description,
    group: &VariableGroup,
) -> InstanceError {
    const NAMED: usize = 3;
    let InstanceError::Failed { fmu, function, status, said } = error else { return error };
    let all = &group.references;
    let names: Vec<String> = all
        .iter()
        .take(NAMED)
        .map(|reference| {
            let one = VariableGroup { references: vec![*reference], elements: 1, ..group.clone() };
            variable_name(description, &one)
        })
        .collect();
    let more = match all.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" or one of {more} more"),
    };
    let status = format!("{status} for {}{more}", names.join(", "));
    InstanceError::Failed { fmu, function, status, said }
}

/// Name of the first variable of a group.
fn variable_name(description: &Description, group: &VariableGroup) -> String {
    let named = description.variables.iter().find(|variable| {
        Some(&variable.reference) == group.references.first() && variable.kind == group.kind
    });
    named.map_or_else(|| element_name(description, group, 0), |variable| variable.name.clone())
}

/// Converts numbers of the FMU to f64.
pub(super) fn numbers_to_f64<T: Number>(
    base: &Base,
    group: &VariableGroup,
    numbers: &[T],
    values: &mut [f64],
) -> Result<(), InstanceError> {
    for (i, (number, value)) in numbers.iter().zip(values).enumerate() {
        let found = if group.bits { Some(number.to_bits()) } else { number.to_f64() };
        *value = found.ok_or_else(|| misfit(base, group, i, number.to_string()))?;
    }
    Ok(())
}

/// Converts f64 to numbers for the FMU.
pub(super) fn numbers_from_f64<T: Number>(
    base: &Base,
    group: &VariableGroup,
    values: &[f64],
    numbers: &mut Vec<T>,
) -> Result<(), InstanceError> {
    numbers.resize_with(values.len(), T::default);
    for (i, (number, value)) in numbers.iter_mut().zip(values).enumerate() {
        let found = if group.bits { T::from_bits(*value) } else { T::from_f64(*value) };
        *number = found.ok_or_else(|| misfit(base, group, i, told(group, *value)))?;
    }
    Ok(())
}

/// Returns a number of a group in words.
#[cold]
fn told(group: &VariableGroup, value: f64) -> String {
    if group.bits {
        return whole::from_bits(group.kind, value).to_string();
    }
    value.to_string()
}

#[cold]
fn misfit(base: &Base, group: &VariableGroup, element: usize, value: String) -> InstanceError {
    InstanceError::Value {
        fmu: base.name.clone(),
        variable: element_name(&base.description, group, element),
        value,
        kind: format!("{:?}", group.kind),
    }
}
