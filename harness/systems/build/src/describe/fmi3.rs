//! FMI 3.0: arrays stay arrays.

use super::super::element::{Element, list, number, whole};
use super::types::{enumerations, items, quantities, unit_definitions, with_quantity};
use super::{
    STEP_S, causality, default_experiment, first_slots, has_start, index_of, initial_knowns,
    initial_unknowns, log_categories, root, start, variability,
};
use octant_fmu::quantities::TIME;
use octant_fmu::table::{
    ClockedBinary, DeclaredCausality, DeclaredVariable, ElementType, Model, Ticks,
};

/// Builds the description.
pub(in super::super) fn fmi3(model: &Model, token: &str) -> Element {
    let slots = first_slots(model);
    root(model, "3.0")
        .with("instantiationToken", token)
        .child(
            Element::new("CoSimulation")
                .with("modelIdentifier", format!("{}_fmi3", model.stem))
                .with("needsExecutionTool", "false")
                .with("canBeInstantiatedOnlyOncePerProcess", "false")
                .with("canGetAndSetFMUState", "true")
                .with("canSerializeFMUState", "true")
                .with("providesDirectionalDerivatives", "false")
                .with("providesAdjointDerivatives", "false")
                .with("providesPerElementDependencies", "false")
                .with("canHandleVariableCommunicationStepSize", model.is_event_driven().to_string())
                .with_some(
                    "fixedInternalStepSize",
                    (!model.is_event_driven()).then(|| number(STEP_S)),
                )
                .with("maxOutputDerivativeOrder", "0")
                .with("recommendedIntermediateInputSmoothness", "0")
                .with("providesIntermediateUpdate", "false")
                .with("mightReturnEarlyFromDoStep", "false")
                .with("canReturnEarlyAfterIntermediateUpdate", "false")
                .with("hasEventMode", "true")
                .with("providesEvaluateDiscreteStates", "false"),
        )
        .child(unit_definitions(model))
        .child(type_definitions(model))
        .child(log_categories())
        .child(default_experiment())
        .child(variables(model, &slots))
        .child(structure(model, &slots))
}

fn type_definitions(model: &Model) -> Element {
    let quantities = quantities(model).into_iter().map(|quantity| {
        with_quantity(Element::new("Float64Type").with("name", quantity.name), quantity)
    });
    let enumerations = enumerations(model).into_iter().map(|enumeration| {
        Element::new("EnumerationType")
            .with("name", enumeration.name)
            .with("description", enumeration.description)
            .children(items(enumeration))
    });
    Element::new("TypeDefinitions").children(quantities).children(enumerations)
}

fn variables(model: &Model, slots: &[usize]) -> Element {
    let time = Element::new("Float64")
        .with("name", "time")
        .with("valueReference", "0")
        .with("description", "Time")
        .with("causality", "independent")
        .with("variability", "continuous")
        .with("declaredType", TIME.name);
    let variables = model.variables.iter().zip(slots).map(|(v, slot)| variable(model, v, *slot));
    Element::new("ModelVariables").child(time).children(variables)
}

fn variable(model: &Model, variable: &DeclaredVariable, slot: usize) -> Element {
    let name = match variable.kind {
        ElementType::Binary(binary) => return binary_variable(model, variable, binary, slot),
        ElementType::Clock(ticks) => return clock(variable, ticks, slot),
        ElementType::Real => "Float64",
        ElementType::Integer => "Int32",
        ElementType::Count => "UInt64",
        ElementType::Boolean => "Boolean",
        ElementType::Enumeration(_) => "Enumeration",
    };
    let declared = match variable.kind {
        ElementType::Real => variable.quantity.map(|quantity| quantity.name),
        ElementType::Enumeration(enumeration) => Some(enumeration.name),
        _ => None,
    };
    let mut element = Element::new(name)
        .with("name", variable.name)
        .with("valueReference", slot.to_string())
        .with("description", variable.description)
        .with("causality", causality(variable))
        .with("variability", variability(variable))
        .with("initial", if has_start(variable) { "exact" } else { "calculated" })
        .with_some("declaredType", declared);
    let limits = |element: Element, write: fn(f64) -> String| {
        element.with_some("min", variable.min.map(write)).with_some("max", variable.max.map(write))
    };
    element = match variable.kind {
        ElementType::Real => {
            limits(element, number).with_some("nominal", variable.nominal.map(number))
        }
        ElementType::Integer | ElementType::Count => limits(element, whole),
        ElementType::Boolean
        | ElementType::Enumeration(_)
        | ElementType::Binary(_)
        | ElementType::Clock(_) => element,
    };
    if has_start(variable) {
        let starts = (0..variable.slots()).map(|index| {
            let start = start(variable, index);
            match variable.kind {
                ElementType::Boolean => (start != 0.0).to_string(),
                ElementType::Real => number(start),
                _ => whole(start),
            }
        });
        element = element.with("start", list(starts));
    }
    if variable.elements > 0 {
        let dimension = Element::new("Dimension").with("start", variable.elements.to_string());
        element = element.child(dimension);
    }
    element
}

/// Starts a variable element with the attributes that every variable has.
fn named(element: &'static str, variable: &DeclaredVariable, slot: usize) -> Element {
    Element::new(element)
        .with("name", variable.name)
        .with("valueReference", slot.to_string())
        .with("description", variable.description)
        .with("causality", causality(variable))
        .with("variability", variability(variable))
}

fn binary_variable(
    model: &Model,
    variable: &DeclaredVariable,
    binary: &ClockedBinary,
    slot: usize,
) -> Element {
    let clock = model.find(binary.clock).map(|(slot, _)| slot.to_string());
    let element = named("Binary", variable, slot)
        .with("initial", if has_start(variable) { "exact" } else { "calculated" })
        .with_some("clocks", clock)
        .with("mimeType", binary.mime_type)
        .with("maxSize", binary.max_bytes.to_string());
    if has_start(variable) {
        return element.child(Element::new("Start").with("value", ""));
    }
    element
}

fn clock(variable: &DeclaredVariable, ticks: Ticks, slot: usize) -> Element {
    named("Clock", variable, slot).with(
        "intervalVariability",
        match ticks {
            Ticks::Triggered => "triggered",
            Ticks::Countdown => "countdown",
        },
    )
}

fn structure(model: &Model, slots: &[usize]) -> Element {
    let unknown = |name, index: usize, dependencies: String| {
        Element::new(name)
            .with("valueReference", slots[index].to_string())
            .with("dependencies", dependencies)
    };
    let mut structure = Element::new("ModelStructure");
    for (index, variable) in model.variables.iter().enumerate() {
        if variable.causality == DeclaredCausality::Output {
            let mut inputs: Vec<usize> = (variable.depends_on.iter())
                .filter_map(|name| index_of(model, name))
                .map(|index| slots[index])
                .collect();
            inputs.sort_unstable();
            structure = structure.child(unknown("Output", index, list(inputs)));
        }
    }
    let parameters = list(initial_knowns(model).map(|(index, _)| slots[index]));
    structure.children(
        initial_unknowns(model)
            .map(|(index, _)| unknown("InitialUnknown", index, parameters.clone())),
    )
}
