//! Units and types used by a model's variables.

use super::super::element::{Element, number};
use octant_fmu::quantities::TIME;
use octant_fmu::table::{DeclaredEnumeration, DeclaredQuantity, DeclaredUnit, ElementType, Model};

/// Lists the quantities of the variables, each once, in the order of their first use; time first.
pub(super) fn quantities(model: &Model) -> Vec<&'static DeclaredQuantity> {
    once(
        std::iter::once(&TIME).chain(model.variables.iter().filter_map(|v| v.quantity)),
        |quantity| quantity.name,
    )
}

/// Lists the units of the models' quantities, each once.
pub(in super::super) fn units<'a>(
    models: impl IntoIterator<Item = &'a Model>,
) -> Vec<&'static DeclaredUnit> {
    once(models.into_iter().flat_map(quantities).map(|quantity| quantity.unit), |unit| unit.name)
}

/// Lists the enumerations of the variables, each once.
pub(in super::super) fn enumerations(model: &Model) -> Vec<&'static DeclaredEnumeration> {
    let all = model.variables.iter().filter_map(|variable| match variable.kind {
        ElementType::Enumeration(enumeration) => Some(enumeration),
        _ => None,
    });
    once(all, |enumeration| enumeration.name)
}

/// Keeps the first item of each name.
fn once<T: Copy>(all: impl Iterator<Item = T>, name: impl Fn(T) -> &'static str) -> Vec<T> {
    let mut kept: Vec<T> = Vec::new();
    for item in all {
        if kept.iter().all(|other| name(*other) != name(item)) {
            kept.push(item);
        }
    }
    kept
}

/// Builds the element that expresses a unit in SI base units; the same in FMI 2.0, FMI 3.0 and SSP.
/// Exponents are whole numbers in all three, so the unit of a random walk has no such element.
pub(in super::super) fn base_unit(element: &'static str, unit: &DeclaredUnit) -> Option<Element> {
    let names = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
    let mut base = Element::new(element);
    for (name, exponent) in names.into_iter().zip(unit.exponents?) {
        base = base.with_some(name, (exponent != 0).then(|| exponent.to_string()));
    }
    Some(base.with_some("factor", (unit.factor != 1.0).then(|| number(unit.factor))))
}

/// Builds `UnitDefinitions`, the same in both standards.
pub(super) fn unit_definitions(model: &Model) -> Element {
    Element::new("UnitDefinitions").children(units([model]).into_iter().map(|unit| {
        let display = unit.display.iter().map(|(name, factor)| {
            Element::new("DisplayUnit").with("name", *name).with("factor", number(*factor))
        });
        Element::new("Unit")
            .with("name", unit.name)
            .children(base_unit("BaseUnit", unit))
            .children(display)
    }))
}

/// Adds the attributes that a quantity gives a type.
pub(super) fn with_quantity(element: Element, quantity: &DeclaredQuantity) -> Element {
    element
        .with("quantity", quantity.name)
        .with("unit", quantity.unit.name)
        .with_some("displayUnit", quantity.display)
}

/// Builds the items of an enumeration.
pub(super) fn items(enumeration: &'static DeclaredEnumeration) -> impl Iterator<Item = Element> {
    enumeration.items.iter().map(|(value, name, description)| {
        Element::new("Item")
            .with("name", *name)
            .with("value", value.to_string())
            .with("description", *description)
    })
}
