//! FMI 2.0: every element of an array is a scalar variable.

use super::super::element::{Element, list, number, whole};
use super::types::{quantities, unit_definitions, with_quantity};
use super::{
    causality, default_experiment, has_start, index_of, initial_knowns, initial_unknowns,
    log_categories, root, start, variability,
};
use octant_fmu::table::{
    DeclaredCausality, DeclaredEnumeration, DeclaredVariable, ElementType, Model,
};

/// Builds the description.
pub(in super::super) fn fmi2(model: &Model, token: &str) -> Element {
    // Scalars are counted from 1, in the order of the slots: the position is the slot number.
    let places: Vec<std::ops::Range<usize>> =
        model.with_slots().map(|(slot, variable)| slot..slot + variable.slots()).collect();
    root(model, "2.0")
        .with("guid", token)
        .child(
            Element::new("CoSimulation")
                .with("modelIdentifier", format!("{}_fmi2", model.stem))
                .with("needsExecutionTool", "false")
                .with("canHandleVariableCommunicationStepSize", "false")
                .with("canInterpolateInputs", "false")
                .with("maxOutputDerivativeOrder", "0")
                .with("canRunAsynchronuously", "false")
                .with("canBeInstantiatedOnlyOncePerProcess", "false")
                .with("canNotUseMemoryManagementFunctions", "true")
                .with("canGetAndSetFMUstate", "true")
                .with("canSerializeFMUstate", "true")
                .with("providesDirectionalDerivative", "false"),
        )
        .child(unit_definitions(model))
        .child(type_definitions(model))
        .child(log_categories())
        .child(default_experiment())
        .child(variables(model))
        .child(structure(model, &places))
}

/// Builds the quantities. Enumerations are Integers here (see [`typed`]) and need none.
fn type_definitions(model: &Model) -> Element {
    Element::new("TypeDefinitions").children(quantities(model).into_iter().map(|quantity| {
        Element::new("SimpleType")
            .with("name", quantity.name)
            .child(with_quantity(Element::new("Real"), quantity))
    }))
}

/// Lists all variables except time, which exists without being listed: FMI Library, which many
/// tools use to read descriptions, demands a start value on it that the standard forbids.
fn variables(model: &Model) -> Element {
    Element::new("ModelVariables").children(model.with_slots().flat_map(|(slot, variable)| {
        (0..variable.slots()).map(move |element| scalar(variable, element, slot + element))
    }))
}

fn scalar(variable: &DeclaredVariable, element: usize, slot: usize) -> Element {
    let mut description = variable.description.to_owned();
    if let ElementType::Enumeration(enumeration) = variable.kind {
        description += &format!(" {}.", meanings(enumeration));
    }
    let mut name = variable.name.to_owned();
    if variable.elements > 0 {
        name += &format!("[{}]", element + 1);
        description += &format!(" Element {} of {}.", element + 1, variable.elements);
    }
    let initial = if has_start(variable) { "exact" } else { "calculated" };
    Element::new("ScalarVariable")
        .with("name", name)
        .with("valueReference", slot.to_string())
        .with("description", description)
        .with("causality", causality(variable))
        .with("variability", variability(variable))
        // Inputs must not have `initial`.
        .with_some("initial", (variable.causality != DeclaredCausality::Input).then_some(initial))
        .child(typed(variable, element))
}

/// Builds the type, with limits and start.
///
/// An enumeration is an Integer with the same values: both are set and read by the same functions,
/// and some masters (libcosim, Ecos) can't connect or set enumerations.
fn typed(variable: &DeclaredVariable, element: usize) -> Element {
    let start = has_start(variable).then(|| start(variable, element));
    match variable.kind {
        ElementType::Real | ElementType::Count => {
            let smallest = (variable.kind == ElementType::Count).then_some(0.0);
            Element::new("Real")
                .with_some("declaredType", variable.quantity.map(|quantity| quantity.name))
                .with_some("min", variable.min.or(smallest).map(number))
                .with_some("max", variable.max.map(number))
                .with_some("nominal", variable.nominal.map(number))
                .with_some("start", start.map(number))
        }
        ElementType::Integer => Element::new("Integer")
            .with_some("min", variable.min.map(whole))
            .with_some("max", variable.max.map(whole))
            .with_some("start", start.map(whole)),
        ElementType::Enumeration(enumeration) => {
            let values = || enumeration.items.iter().map(|(value, ..)| *value);
            Element::new("Integer")
                .with_some("min", values().min().map(|value| value.to_string()))
                .with_some("max", values().max().map(|value| value.to_string()))
                .with_some("start", start.map(whole))
        }
        ElementType::Boolean => Element::new("Boolean")
            .with_some("start", start.map(|start| if start == 0.0 { "false" } else { "true" })),
        // FMI 2.0 has neither type: a model with such variables is never built for it.
        ElementType::Binary(_) | ElementType::Clock(_) => Element::new("String"),
    }
}

/// Lists the values of an enumeration: `0: none, 1: velocity, 2: position`.
fn meanings(enumeration: &DeclaredEnumeration) -> String {
    let items = enumeration.items.iter().map(|(value, name, _)| format!("{value}: {name}"));
    items.collect::<Vec<_>>().join(", ")
}

fn structure(model: &Model, places: &[std::ops::Range<usize>]) -> Element {
    let unknowns = |index: usize, dependencies: String| {
        places[index].clone().map(move |place| {
            Element::new("Unknown")
                .with("index", place.to_string())
                .with("dependencies", dependencies.clone())
        })
    };
    let mut outputs = Element::new("Outputs");
    for (index, variable) in model.variables.iter().enumerate() {
        if variable.causality == DeclaredCausality::Output {
            let mut inputs: Vec<usize> = (variable.depends_on.iter())
                .filter_map(|name| index_of(model, name))
                .flat_map(|index| places[index].clone())
                .collect();
            inputs.sort_unstable();
            outputs = outputs.children(unknowns(index, list(inputs)));
        }
    }
    let parameters = list(initial_knowns(model).flat_map(|(index, _)| places[index].clone()));
    let initial = Element::new("InitialUnknowns").children(
        initial_unknowns(model).flat_map(|(index, _)| unknowns(index, parameters.clone())),
    );
    let all = [outputs, initial].into_iter().filter(|element| !element.is_empty());
    Element::new("ModelStructure").children(all)
}
