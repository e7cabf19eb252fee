//! Value references: aliases of FMI 2.0, unique ones of FMI 3.0, sizes of arrays, clocked variables.

use super::finding::Findings;
use super::model::{Declared, Model};
use super::rules::{
    VARIABLE_ALIAS, VARIABLE_CLOCKS, VARIABLE_DIMENSION, VARIABLE_PREVIOUS, VARIABLE_REFERENCE,
    VARIABLE_SIZE, VARIABLE_START_COUNT, VARIABLE_STRUCTURAL,
};
use octant_fmu_host::description::{
    ArrayDimension, Causality, ELEMENTS_MAX, Initial, Variability, Variable, VariableType,
};
use std::collections::{BTreeMap, BTreeSet};

/// Checks the references between variables.
pub(super) fn check(model: &Model<'_, '_>, findings: &mut Findings) {
    if model.is_fmi2() {
        aliases(model, findings);
        return;
    }
    let mut lines: BTreeMap<u32, u32> = BTreeMap::new();
    let mut previous: BTreeMap<u32, u32> = BTreeMap::new();
    let sizes: BTreeSet<u32> = model
        .variables
        .iter()
        .flat_map(|declared| &declared.variable.dimensions)
        .filter_map(|dimension| match dimension {
            ArrayDimension::Of(reference) => Some(*reference),
            ArrayDimension::Fixed(_) => None,
        })
        .collect();
    for declared in &model.variables {
        let variable = declared.variable;
        if let Some(line) = lines.insert(variable.reference, variable.line) {
            let found = format!("value reference {} of line {line} as well", variable.reference);
            model.broken(findings, &VARIABLE_REFERENCE, declared, found, "a reference of its own");
        }
        array(model, declared, findings);
        if variable.causality == Causality::StructuralParameter {
            structural(model, declared, sizes.contains(&variable.reference), findings);
        }
        clocked(model, declared, findings);
        if let Some(reference) = variable.previous {
            has_previous(model, declared, reference, &mut previous, findings);
        }
    }
}

/// Checks aliases: variables of FMI 2.0 that share a value reference are one variable.
fn aliases(model: &Model<'_, '_>, findings: &mut Findings) {
    // Enumerations are read as integers.
    let base = |kind: VariableType| match kind {
        VariableType::Enumeration => VariableType::Int32,
        kind => kind,
    };
    let mut sets: BTreeMap<(&str, u32), Vec<&Declared<'_, '_>>> = BTreeMap::new();
    for declared in &model.variables {
        let key = (base(declared.variable.kind).name(), declared.variable.reference);
        sets.entry(key).or_default().push(declared);
    }
    for set in sets.values().filter(|set| set.len() > 1) {
        let first = set[0].variable;
        let settable = |variable: &Variable| {
            variable.variability != Variability::Constant
                && (matches!(variable.causality, Causality::Input | Causality::Parameter)
                    || matches!(variable.initial, Some(Initial::Exact | Initial::Approx)))
        };
        let mut set_by = set.iter().filter(|declared| settable(declared.variable));
        if let (Some(one), Some(other)) = (set_by.next(), set_by.next()) {
            let found = format!(
                "it can be set, and so can {:?} with the same reference",
                one.variable.name
            );
            model.broken(findings, &VARIABLE_ALIAS, other, found, "one that can be set");
        }
        for declared in &set[1..] {
            let variable = declared.variable;
            if variable.unit != first.unit {
                let unit = |variable: &Variable| match &variable.unit {
                    Some(unit) => format!("unit {unit:?}"),
                    None => "no unit".to_owned(),
                };
                let expected =
                    format!("{} as {:?} with the same reference", unit(first), first.name);
                model.broken(findings, &VARIABLE_ALIAS, declared, unit(variable), expected);
            }
            let constant = |variable: &Variable| variable.variability == Variability::Constant;
            if constant(variable) != constant(first) {
                let found = format!(
                    "only one of it and {:?} with the same reference is constant",
                    first.name
                );
                model.broken(findings, &VARIABLE_ALIAS, declared, found, "all or none");
            } else if constant(variable) && variable.start != first.start {
                let found = format!("another value than {:?} with the same reference", first.name);
                model.broken(findings, &VARIABLE_ALIAS, declared, found, "the same constant");
            }
        }
    }
}

fn array(model: &Model<'_, '_>, declared: &Declared<'_, '_>, findings: &mut Findings) {
    let variable = declared.variable;
    let mut elements = Some(1u64);
    for dimension in &variable.dimensions {
        let size = match *dimension {
            ArrayDimension::Fixed(0) => {
                let expected = "at least one element";
                model.broken(
                    findings,
                    &VARIABLE_DIMENSION,
                    declared,
                    "a dimension of size 0",
                    expected,
                );
                return;
            }
            ArrayDimension::Fixed(size) => Some(size),
            ArrayDimension::Of(reference) => {
                let parameter =
                    model.by_reference.get(&reference).map(|&i| model.variables[i].variable);
                let is_size = parameter.is_some_and(|parameter| {
                    parameter.kind == VariableType::UInt64
                        && (parameter.causality == Causality::StructuralParameter
                            || parameter.variability == Variability::Constant)
                });
                if !is_size {
                    let found = match parameter {
                        Some(p) => format!("a dimension given by {:?} ({})", p.name, p.kind.name()),
                        None => format!(
                            "a dimension given by value reference {reference}, which no variable has"
                        ),
                    };
                    let expected = "a UInt64 that is a structural parameter or constant";
                    model.broken(findings, &VARIABLE_DIMENSION, declared, found, expected);
                    return;
                }
                parameter.and_then(|parameter| parameter.start.first()?.trim().parse().ok())
            }
        };
        elements = elements.zip(size).map(|(a, b): (u64, u64)| a.saturating_mul(b));
    }
    let Some(elements) = elements else { return };
    if elements > ELEMENTS_MAX {
        let found = format!("{elements} elements");
        model.broken(findings, &VARIABLE_SIZE, declared, found, format!("at most {ELEMENTS_MAX}"));
    }
    let count = variable.start.len() as u64;
    if count > 1 && count != elements {
        let expected = match elements {
            1 => "one".to_owned(),
            _ => format!("one, or {elements}"),
        };
        model.broken(
            findings,
            &VARIABLE_START_COUNT,
            declared,
            format!("{count} start values"),
            expected,
        );
    }
}

fn structural(
    model: &Model<'_, '_>,
    declared: &Declared<'_, '_>,
    is_size: bool,
    findings: &mut Findings,
) {
    let variable = declared.variable;
    if !variable.dimensions.is_empty() {
        let found = "a structural parameter that is an array";
        model.broken(findings, &VARIABLE_STRUCTURAL, declared, found, "a scalar");
    }
    if is_size && variable.start.first().is_some_and(|start| start.trim() == "0") {
        let found = "start 0 of what is the size of an array";
        model.broken(findings, &VARIABLE_STRUCTURAL, declared, found, "at least 1");
    }
}

fn clocked(model: &Model<'_, '_>, declared: &Declared<'_, '_>, findings: &mut Findings) {
    let variable = declared.variable;
    if variable.clocks.is_empty() {
        return;
    }
    if !matches!(variable.variability, Variability::Discrete | Variability::Tunable) {
        let found =
            format!("a clocked variable that is {}", super::variables::word(variable.variability));
        model.broken(findings, &VARIABLE_CLOCKS, declared, found, "discrete or tunable");
    }
    for reference in &variable.clocks {
        let clock = model.by_reference.get(reference).map(|&i| model.variables[i].variable);
        let found = match clock {
            Some(clock) if clock.kind == VariableType::Clock => continue,
            Some(other) => format!("clock {:?}, which is {}", other.name, other.kind.name()),
            None => format!("clock {reference}, a value reference that no variable has"),
        };
        model.broken(findings, &VARIABLE_CLOCKS, declared, found, "a clock");
    }
}

fn has_previous(
    model: &Model<'_, '_>,
    declared: &Declared<'_, '_>,
    reference: u32,
    seen: &mut BTreeMap<u32, u32>,
    findings: &mut Findings,
) {
    let variable = declared.variable;
    let previous = model.by_reference.get(&reference).map(|&index| model.variables[index].variable);
    let found = if variable.clocks.is_empty() {
        "a previous value of what isn't clocked".to_owned()
    } else if variable.variability != Variability::Discrete {
        "a previous value of what isn't discrete".to_owned()
    } else {
        match previous {
            None => format!("previous {reference}, a value reference that no variable has"),
            Some(other) if std::ptr::eq(other, variable) => {
                "the previous value of itself".to_owned()
            }
            Some(other) if other.kind != variable.kind => {
                format!("previous {:?}, which is {}", other.name, other.kind.name())
            }
            Some(other) if other.variability != Variability::Discrete => {
                format!("previous {:?}, which isn't discrete", other.name)
            }
            Some(other) if other.causality == Causality::Input => {
                format!("previous {:?}, which is an input", other.name)
            }
            Some(other) => match seen.insert(reference, variable.line) {
                Some(line) => format!("previous {:?}, as line {line} has", other.name),
                None => return,
            },
        }
    };
    let expected = "a clocked discrete variable, with another discrete variable of its kind";
    model.broken(findings, &VARIABLE_PREVIOUS, declared, found, expected);
}
