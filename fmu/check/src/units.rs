//! Units, types and enumerations.

use super::finding::Findings;
use super::model::{Declared, Model};
use super::rules::{
    ENUMERATION_UNIQUE, TYPE_DEFINED, TYPE_UNIQUE, UNIT_BASE, UNIT_DEFINED, UNIT_DERIVATIVE,
    UNIT_DISPLAY, UNIT_FACTOR, UNIT_INVERSE, UNIT_MEANING, UNIT_TYPE, UNIT_UNIQUE,
};
use octant_fmu_host::description::units::{dimension, known};
use octant_fmu_host::description::xml::Element;
use octant_fmu_host::description::{BaseUnit, VariableType};
use std::collections::{BTreeMap, BTreeSet};

/// Largest relative distance of the factor of a common name from its common meaning: the digits
/// that tools write.
const MEANING: f64 = 1e-4;

/// Checks units, types, and their use in variables.
pub(super) fn check(model: &Model<'_, '_>, findings: &mut Findings) {
    definitions(model, findings);
    let types = types(model, findings);
    for declared in &model.variables {
        variable(model, declared, &types, findings);
    }
}

fn definitions(model: &Model<'_, '_>, findings: &mut Findings) {
    let mut names = BTreeSet::new();
    for unit in model.root.child("UnitDefinitions").into_iter().flat_map(Element::children) {
        let Some(name) = unit.text("name") else { continue };
        let place = model.at(unit, name);
        if !names.insert(name) {
            findings.add(&UNIT_UNIQUE, place, "the unit is there twice", "one of each name");
            continue;
        }
        // A dimensionless number needs no base unit, and half exponents are impossible.
        let plain = known(name).first().is_some_and(|unit| unit.exponents == [0; 8]);
        let fraction = name.contains("sqrt(") || name.contains("/2)");
        if unit.child("BaseUnit").is_none() && !plain && !fraction {
            findings.add(&UNIT_BASE, place, "a unit without BaseUnit", "what it is in SI");
        } else if let Some(base) = model.unit(name).and_then(|unit| unit.base) {
            meaning(model, unit, name, &base, findings);
        }
        let mut displays = BTreeSet::new();
        for child in unit.children() {
            let display = child.text("name").unwrap_or("BaseUnit");
            let place = model.at(child, display);
            if !matches!(child.name(), "BaseUnit" | "DisplayUnit") {
                continue;
            }
            let number = |name, missing| child.real(name).ok().flatten().unwrap_or(missing);
            let (factor, offset) = (number("factor", 1.0), number("offset", 0.0));
            if factor == 0.0 || !factor.is_finite() || !offset.is_finite() {
                let found = format!("factor {factor}, offset {offset}");
                let expected = "a finite factor but 0, and a finite offset";
                findings.add(&UNIT_FACTOR, place, found, expected);
            }
            if child.name() != "DisplayUnit" {
                continue;
            }
            if !displays.insert(display) {
                let found = format!("the display unit is there twice in {name:?}");
                findings.add(&UNIT_UNIQUE, place, found, "one of each name");
            }
            if child.boolean("inverse").unwrap_or(false) && offset != 0.0 {
                let found = format!("inverse with offset {offset}");
                findings.add(&UNIT_INVERSE, place, found, "no offset");
            }
        }
    }
}

/// Reports a unit with a common name but another meaning: importers that know the name convert it
/// wrongly.
fn meaning(
    model: &Model<'_, '_>,
    element: Element<'_, '_>,
    name: &str,
    base: &BaseUnit,
    findings: &mut Findings,
) {
    // Single letters have too many meanings, and the standard itself has Hz as 2π rad/s.
    if (name.len() == 1 && !"msAKNWVJ".contains(name)) || name.contains("Hz") {
        return;
    }
    let meanings = known(name);
    let close = |a: f64, b: f64| (a - b).abs() <= MEANING * b.abs();
    let same = |known: &BaseUnit| {
        known.exponents[..7] == base.exponents[..7]
            // Tools leave out the radian, which is no dimension in SI.
            && (known.exponents[7] == base.exponents[7] || base.exponents[7] == 0)
            && close(base.factor, known.factor)
            && close(base.offset, known.offset)
    };
    if let Some(first) = meanings.first()
        && !meanings.iter().any(same)
    {
        let say = |unit: &BaseUnit| match unit.offset {
            0.0 => format!("{} of {}", unit.factor, dimension(unit.exponents)),
            offset => format!("{} of {} + {offset}", unit.factor, dimension(unit.exponents)),
        };
        findings.add(&UNIT_MEANING, model.at(element, name), say(base), say(first));
    }
}

/// Reads the types by name, with the element that has unit and limits.
fn types<'a, 't>(
    model: &Model<'a, 't>,
    findings: &mut Findings,
) -> BTreeMap<&'a str, Element<'a, 't>> {
    let mut types = BTreeMap::new();
    for element in model.root.child("TypeDefinitions").into_iter().flat_map(Element::children) {
        let Some(name) = element.text("name") else { continue };
        let place = model.at(element, name);
        let definition = if model.is_fmi2() { element.children().next() } else { Some(element) };
        let Some(definition) = definition else { continue };
        if types.insert(name, definition).is_some() {
            findings.add(&TYPE_UNIQUE, place, "the type is there twice", "one of each name");
        }
        if model.by_name.contains_key(name) {
            let found = "a variable has the same name";
            findings.add(&TYPE_UNIQUE, place, found, "names that differ from those of variables");
        }
        let unit = definition.text("unit").filter(|unit| !unit.is_empty());
        let display = definition.text("displayUnit").filter(|unit| !unit.is_empty());
        units(model, definition, name, unit, display, findings);
        if matches!(definition.name(), "Enumeration" | "EnumerationType") {
            items(model, definition, name, findings);
        }
    }
    types
}

fn items(model: &Model<'_, '_>, element: Element<'_, '_>, name: &str, findings: &mut Findings) {
    let mut names = BTreeSet::new();
    let mut values = BTreeSet::new();
    for item in element.children().filter(|child| child.name() == "Item") {
        for (attribute, seen) in [("name", &mut names), ("value", &mut values)] {
            if let Some(text) = item.text(attribute)
                && !seen.insert(text.trim())
            {
                let found = format!("two items with {attribute} {text:?}");
                findings.add(&ENUMERATION_UNIQUE, model.at(item, name), found, "one of each");
            }
        }
    }
}

/// Checks unit and display unit of a type or a variable.
fn units(
    model: &Model<'_, '_>,
    element: Element<'_, '_>,
    subject: &str,
    unit: Option<&str>,
    display: Option<&str>,
    findings: &mut Findings,
) {
    let place = model.at(element, subject);
    match (unit, display) {
        (None, Some(display)) => {
            let found = format!("display unit {display:?} without a unit");
            findings.add(&UNIT_DISPLAY, place, found, "a unit");
        }
        (Some(unit), display) => match model.unit(unit) {
            None => findings.add(
                &UNIT_DEFINED,
                place,
                format!("unit {unit:?} is not defined"),
                "a Unit of this name in UnitDefinitions",
            ),
            Some(definition) => {
                if let Some(display) = display
                    && !definition.display.iter().any(|other| other.name == display)
                {
                    let found = format!("display unit {display:?} is not defined");
                    let expected = format!("a DisplayUnit of this name in Unit {unit:?}");
                    findings.add(&UNIT_DEFINED, place, found, expected);
                }
            }
        },
        (None, None) => {}
    }
}

fn variable(
    model: &Model<'_, '_>,
    declared: &Declared<'_, '_>,
    types: &BTreeMap<&str, Element<'_, '_>>,
    findings: &mut Findings,
) {
    let (variable, value) = (declared.variable, declared.value);
    let own = value.text("unit").filter(|unit| !unit.is_empty());
    let own_display = value.text("displayUnit").filter(|unit| !unit.is_empty());
    if own.is_some() || own_display.is_some() {
        // The unit from its type was checked there.
        let unit = variable.unit.as_deref();
        let display = if own.is_some() { variable.display_unit.as_deref() } else { own_display };
        units(model, declared.element, &variable.name, unit, display, findings);
    }
    for alias in &variable.aliases {
        if alias.display_unit.is_some() {
            let unit = variable.unit.as_deref();
            let display = alias.display_unit.as_deref();
            units(model, declared.element, &alias.name, unit, display, findings);
        }
    }
    let base = |unit: Option<&str>| model.unit(unit?)?.base;
    if let Some(name) = variable.declared_type.as_deref() {
        match types.get(name) {
            None => {
                let found = format!("type {name:?} is not defined");
                model.broken(findings, &TYPE_DEFINED, declared, found, "one of TypeDefinitions");
            }
            Some(definition) => {
                let kind = definition.name();
                if kind.strip_suffix("Type").unwrap_or(kind) != declared.type_name() {
                    let found = format!("type {name:?} is {kind}");
                    let expected = format!("one of kind {}", declared.type_name());
                    model.broken(findings, &TYPE_DEFINED, declared, found, expected);
                }
                let theirs = definition.text("unit");
                if let (Some(mine), Some(other)) = (base(own), base(theirs))
                    && mine.exponents != other.exponents
                {
                    let found =
                        format!("{:?} ({})", own.unwrap_or_default(), dimension(mine.exponents));
                    let expected = format!(
                        "a unit like {:?} of its type {name:?} ({})",
                        theirs.unwrap_or_default(),
                        dimension(other.exponents)
                    );
                    model.broken(findings, &UNIT_TYPE, declared, found, expected);
                }
            }
        }
    }
    derivative(model, declared, base, findings);
}

fn derivative(
    model: &Model<'_, '_>,
    declared: &Declared<'_, '_>,
    base: impl Fn(Option<&str>) -> Option<BaseUnit>,
    findings: &mut Findings,
) {
    let variable = declared.variable;
    let Some(&of) = variable.derivative_of.as_ref().and_then(|r| model.by_reference.get(r)) else {
        return;
    };
    let state = model.variables[of].variable;
    // With an independent variable other than time the derivative is by that variable.
    if model.independent_unit.is_some_and(|unit| unit != "s")
        || variable.kind != VariableType::Float64
    {
        return;
    }
    if let (Some(rate), Some(value)) = (base(variable.unit.as_deref()), base(state.unit.as_deref()))
    {
        let mut expected = value.exponents;
        expected[2] = expected[2].saturating_sub(1);
        // The radian may be left out.
        if rate.exponents[..7] != expected[..7] {
            let found =
                format!("{} for the derivative of {:?}", dimension(rate.exponents), state.name);
            model.broken(findings, &UNIT_DERIVATIVE, declared, found, dimension(expected));
        }
    }
}
