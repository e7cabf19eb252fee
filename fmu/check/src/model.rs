//! A description together with the text of its file: rules need both.

use super::finding::{Findings, Place};
use super::rules::Rule;
use octant_fmu_host::description::xml::Element;
use octant_fmu_host::description::{
    Causality, Description, Standard, UnitDefinition, Variable, VariableType,
};
use std::collections::HashMap;

/// A description and its XML tree.
pub(super) struct Model<'a, 't> {
    /// File inside the FMU.
    pub(super) entry: &'a str,
    /// Description.
    pub(super) description: &'a Description,
    /// Root element.
    pub(super) root: Element<'a, 't>,
    /// Variables.
    pub(super) variables: Vec<Declared<'a, 't>>,
    /// Index of the first variable with each value reference.
    pub(super) by_reference: HashMap<u32, usize>,
    /// Index of the first variable with each name or alias.
    pub(super) by_name: HashMap<&'a str, usize>,
    /// Units by name.
    units: HashMap<&'a str, &'a UnitDefinition>,
    /// Items of the enumeration types by name.
    enumerations: HashMap<&'a str, &'a [(i64, String)]>,
    /// Unit of the independent variable.
    pub(super) independent_unit: Option<&'a str>,
}

/// A variable with its element.
#[derive(Clone, Copy)]
pub(super) struct Declared<'a, 't> {
    /// Element of the variable, with name and causality.
    pub(super) element: Element<'a, 't>,
    /// Element with type, start and limits: in FMI 3.0 the same one.
    pub(super) value: Element<'a, 't>,
    /// Variable of the description.
    pub(super) variable: &'a Variable,
}

impl<'a, 't: 'a> Model<'a, 't> {
    /// Combines description and tree.
    pub(super) fn new(entry: &'a str, description: &'a Description, root: Element<'a, 't>) -> Self {
        let elements = root.child("ModelVariables").into_iter().flat_map(Element::children);
        let variables: Vec<Declared<'a, 't>> = elements
            .filter_map(|element| Some((element, value(element, description.standard)?)))
            .zip(&description.variables)
            .map(|((element, value), variable)| Declared { element, value, variable })
            .collect();
        let mut by_reference = HashMap::new();
        let mut by_name = HashMap::new();
        for (index, declared) in variables.iter().enumerate() {
            by_reference.entry(declared.variable.reference).or_insert(index);
            by_name.entry(declared.variable.name.as_str()).or_insert(index);
        }
        for (index, declared) in variables.iter().enumerate() {
            for alias in &declared.variable.aliases {
                by_name.entry(alias.name.as_str()).or_insert(index);
            }
        }
        let mut units = HashMap::new();
        for unit in &description.units {
            units.entry(unit.name.as_str()).or_insert(unit);
        }
        let mut enumerations = HashMap::new();
        for (name, items) in &description.enumerations {
            enumerations.entry(name.as_str()).or_insert(items.as_slice());
        }
        let independent = description
            .variables
            .iter()
            .find(|variable| variable.causality == Causality::Independent);
        let independent_unit = independent.and_then(|variable| variable.unit.as_deref());
        Self {
            entry,
            description,
            root,
            variables,
            by_reference,
            by_name,
            units,
            enumerations,
            independent_unit,
        }
    }

    /// Finds the unit with this name.
    pub(super) fn unit(&self, name: &str) -> Option<&'a UnitDefinition> {
        self.units.get(name).copied()
    }

    /// Items of an enumeration type: value and name.
    pub(super) fn enumeration(&self, name: &str) -> Option<&'a [(i64, String)]> {
        self.enumerations.get(name).copied()
    }

    /// Standard of the description.
    pub(super) fn standard(&self) -> Standard {
        self.description.standard
    }

    /// Returns whether the description follows FMI 2.0.
    pub(super) fn is_fmi2(&self) -> bool {
        self.standard() == Standard::Fmi2
    }

    /// Place of an element.
    pub(super) fn at<'p>(&'p self, element: Element<'_, '_>, subject: &'p str) -> Place<'p> {
        Place { entry: self.entry, line: Some(element.line()), subject }
    }

    /// Adds a finding at a variable.
    pub(super) fn broken(
        &self,
        findings: &mut Findings,
        rule: &'static Rule,
        declared: &Declared<'_, '_>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) {
        let place = self.at(declared.element, &declared.variable.name);
        findings.add(rule, place, found, expected);
    }
}

/// Finds the element with type, start and limits of a variable's element; `None`: it is no
/// variable.
fn value<'a, 't: 'a>(element: Element<'a, 't>, standard: Standard) -> Option<Element<'a, 't>> {
    let known = |name: &str| VariableType::ALL.iter().any(|kind| kind.name() == name);
    match standard {
        Standard::Fmi3 => known(element.name()).then_some(element),
        Standard::Fmi2 if element.name() == "ScalarVariable" => element.children().find(|child| {
            matches!(child.name(), "Real" | "Integer" | "Boolean" | "String" | "Enumeration")
        }),
        Standard::Fmi2 => None,
    }
}

impl Declared<'_, '_> {
    /// Name of the type, as in its standard.
    pub(super) fn type_name(&self) -> &str {
        self.value.name()
    }
}
