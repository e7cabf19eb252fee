//! Each variable alone: causality, variability, initial, start and limits.

use super::finding::Findings;
use super::model::{Declared, Model};
use super::rules::{
    ENUMERATION_START, VARIABLE_CAUSALITY, VARIABLE_CONTINUOUS, VARIABLE_DERIVATIVE,
    VARIABLE_INDEPENDENT, VARIABLE_INITIAL, VARIABLE_INTERMEDIATE, VARIABLE_MULTIPLE_SET,
    VARIABLE_NO_START, VARIABLE_NOMINAL, VARIABLE_NOMINAL_SIGN, VARIABLE_RANGE, VARIABLE_REINIT,
    VARIABLE_START, VARIABLE_START_FINITE, VARIABLE_START_RANGE,
};
use octant_fmu_host::description::xml::{real, shortened};
use octant_fmu_host::description::{Causality, Initial, Standard, Variability, VariableType};
use std::collections::BTreeSet;

/// Checks every variable.
pub(super) fn check(model: &Model<'_, '_>, findings: &mut Findings) {
    let states: BTreeSet<u32> = model
        .description
        .structure
        .derivatives
        .iter()
        .filter_map(|unknown| model.by_reference.get(&unknown.reference))
        .filter_map(|&index| model.variables[index].variable.derivative_of)
        .collect();
    for declared in &model.variables {
        if causality(model, declared, findings) {
            start(model, declared, findings);
        }
        limits(model, declared, findings);
        derivative(model, declared, findings);
        let variable = declared.variable;
        let flag = |name: &str| declared.value.boolean(name).unwrap_or(false);
        if flag("reinit")
            && (model.description.model_exchange.is_none() || !states.contains(&variable.reference))
        {
            let found = "reinit of what is no state of model exchange";
            model.broken(findings, &VARIABLE_REINIT, declared, found, "a state");
        }
        if declared.element.text("canHandleMultipleSetPerTimeInstant").is_some()
            && variable.causality != Causality::Input
        {
            let found = "canHandleMultipleSetPerTimeInstant of what is no input";
            model.broken(findings, &VARIABLE_MULTIPLE_SET, declared, found, "an input");
        }
        if flag("intermediateUpdate") && variable.causality == Causality::Parameter {
            let found = "intermediateUpdate of a parameter";
            model.broken(findings, &VARIABLE_INTERMEDIATE, declared, found, "another variable");
        }
    }
    independent(model, findings);
}

/// Literal `variability`: FMI 2.0 has one default for all types.
fn variability(model: &Model<'_, '_>, declared: &Declared<'_, '_>) -> Variability {
    match declared.element.text("variability") {
        None if model.is_fmi2() => Variability::Continuous,
        _ => declared.variable.variability,
    }
}

/// Checks causality, variability and initial; false if they make no sense, so that no later check
/// depends on them.
fn causality(model: &Model<'_, '_>, declared: &Declared<'_, '_>, findings: &mut Findings) -> bool {
    let variable = declared.variable;
    let variability = variability(model, declared);
    if variable.kind == VariableType::Clock {
        return false;
    }
    let allowed = allowed_variability(variable.causality);
    if !allowed.contains(&variability) {
        let found = format!("{} and {}", variable.causality.name(), variability.name());
        let words: Vec<&str> = allowed.iter().map(|&one| one.name()).collect();
        let expected = format!("{} and {}", variable.causality.name(), words.join(" or "));
        model.broken(findings, &VARIABLE_CAUSALITY, declared, found, expected);
        return false;
    }
    if variability == Variability::Continuous && !variable.kind.is_float() {
        let found = format!("{} is continuous", declared.type_name());
        model.broken(findings, &VARIABLE_CONTINUOUS, declared, found, "discrete, or a real number");
        return false;
    }
    if let Some(text) = declared.element.text("initial") {
        let allowed = allowed_initial(model.standard(), variable.causality, variability);
        if !variable.initial.is_some_and(|initial| allowed.contains(&initial)) {
            let found =
                format!("initial {text:?} of {} {}", variability.name(), variable.causality.name());
            let expected = match allowed {
                [] => "no initial".to_owned(),
                _ => allowed.iter().map(|&one| one.name()).collect::<Vec<_>>().join(" or "),
            };
            model.broken(findings, &VARIABLE_INITIAL, declared, found, expected);
            return false;
        }
    }
    true
}

/// Table of causality and variability of both standards.
fn allowed_variability(causality: Causality) -> &'static [Variability] {
    use Variability::{Constant, Continuous, Discrete, Fixed, Tunable};
    match causality {
        Causality::StructuralParameter | Causality::Parameter | Causality::CalculatedParameter => {
            &[Fixed, Tunable]
        }
        Causality::Input => &[Discrete, Continuous],
        Causality::Output => &[Constant, Discrete, Continuous],
        Causality::Local => &[Constant, Fixed, Tunable, Discrete, Continuous],
        Causality::Independent => &[Continuous],
    }
}

/// Table of initial of both standards.
fn allowed_initial(
    standard: Standard,
    causality: Causality,
    variability: Variability,
) -> &'static [Initial] {
    use Initial::{Approx, Calculated, Exact};
    match (causality, variability) {
        (Causality::Parameter | Causality::StructuralParameter, _)
        | (Causality::Output | Causality::Local, Variability::Constant) => &[Exact],
        (Causality::CalculatedParameter, _)
        | (Causality::Local, Variability::Fixed | Variability::Tunable) => &[Calculated, Approx],
        (Causality::Output | Causality::Local, _) => &[Calculated, Exact, Approx],
        (Causality::Input, _) if standard == Standard::Fmi3 => &[Exact],
        (Causality::Input | Causality::Independent, _) => &[],
    }
}

fn start(model: &Model<'_, '_>, declared: &Declared<'_, '_>, findings: &mut Findings) {
    let variable = declared.variable;
    let has_start = !variable.start.is_empty();
    let needs = variable.causality == Causality::Input
        || matches!(variable.initial, Some(Initial::Exact | Initial::Approx));
    let forbids = variable.causality == Causality::Independent
        || variable.initial == Some(Initial::Calculated);
    if needs && !has_start {
        let what = match (variable.causality, variable.initial) {
            (Causality::Input | Causality::Parameter | Causality::StructuralParameter, _)
            | (_, None) => variable.causality.name(),
            (_, Some(initial)) => initial.name(),
        };
        model.broken(
            findings,
            &VARIABLE_START,
            declared,
            format!("no start, but it is {what}"),
            "a start value",
        );
    }
    if forbids && has_start {
        let what = match variable.causality {
            Causality::Independent => "independent",
            _ => "calculated",
        };
        let found = format!("start {:?}, but it is {what}", shortened(&variable.start[0]));
        model.broken(findings, &VARIABLE_NO_START, declared, found, "no start value");
        return;
    }
    values(model, declared, findings);
}

/// Checks the start values.
fn values(model: &Model<'_, '_>, declared: &Declared<'_, '_>, findings: &mut Findings) {
    let variable = declared.variable;
    if matches!(
        variable.kind,
        VariableType::String | VariableType::Binary | VariableType::Boolean | VariableType::Clock
    ) {
        return;
    }
    let items = variable.enumeration.as_deref().and_then(|name| model.enumeration(name));
    for (index, text) in variable.start.iter().enumerate() {
        let of = if variable.start.len() > 1 {
            format!(" of element {}", index + 1)
        } else {
            String::new()
        };
        // A value that isn't a number breaks the schema, which reports it.
        let Some(value) = real(text) else { continue };
        if variable.kind == VariableType::Enumeration
            && let (Some(items), Ok(value)) = (items, text.trim().parse::<i64>())
            && !items.iter().any(|(item, _)| *item == value)
        {
            let names: Vec<String> =
                items.iter().take(12).map(|(value, name)| format!("{value} ({name})")).collect();
            let found = format!("start {value}{of}");
            model.broken(
                findings,
                &ENUMERATION_START,
                declared,
                found,
                format!("one of {}", names.join(", ")),
            );
            return;
        }
        if !value.is_finite() {
            let found = format!("start {text}{of}");
            model.broken(findings, &VARIABLE_START_FINITE, declared, found, "a finite number");
            return;
        }
        if variable.min.zip(variable.max).is_some_and(|(min, max)| !(min <= max)) {
            return;
        }
        let below = variable.min.filter(|&min| value < min);
        let above = variable.max.filter(|&max| value > max);
        if below.is_some() || above.is_some() {
            let limit = |limit: Option<f64>| limit.map_or("…".into(), |limit| limit.to_string());
            let expected = format!("{} to {}", limit(variable.min), limit(variable.max));
            model.broken(
                findings,
                &VARIABLE_START_RANGE,
                declared,
                format!("start {value}{of}"),
                expected,
            );
            return;
        }
    }
}

fn limits(model: &Model<'_, '_>, declared: &Declared<'_, '_>, findings: &mut Findings) {
    let variable = declared.variable;
    if let (Some(min), Some(max)) = (variable.min, variable.max)
        && !(min <= max)
    {
        model.broken(findings, &VARIABLE_RANGE, declared, format!("{min} to {max}"), "min ≤ max");
    } else if variable.min.is_some_and(f64::is_nan) || variable.max.is_some_and(f64::is_nan) {
        model.broken(findings, &VARIABLE_RANGE, declared, "a limit that is NaN", "a number");
    }
    if let Some(nominal) = variable.nominal {
        if nominal == 0.0 || !nominal.is_finite() {
            let expected = "a finite number but 0";
            model.broken(
                findings,
                &VARIABLE_NOMINAL,
                declared,
                format!("nominal {nominal}"),
                expected,
            );
        } else if nominal < 0.0 {
            let found = format!("nominal {nominal}");
            model.broken(findings, &VARIABLE_NOMINAL_SIGN, declared, found, "a positive number");
        }
    }
}

fn derivative(model: &Model<'_, '_>, declared: &Declared<'_, '_>, findings: &mut Findings) {
    let variable = declared.variable;
    let Some(reference) = variable.derivative_of else {
        if let Some(index) = declared.value.text("derivative") {
            let expected = format!("1 to {}", model.variables.len());
            let found = format!("derivative of index {index}");
            model.broken(findings, &VARIABLE_DERIVATIVE, declared, found, expected);
        }
        return;
    };
    let Some(&index) = model.by_reference.get(&reference) else {
        let found = format!("derivative of value reference {reference}, which no variable has");
        model.broken(findings, &VARIABLE_DERIVATIVE, declared, found, "one of a variable");
        return;
    };
    let state = model.variables[index].variable;
    let found = if std::ptr::eq(state, variable) {
        "the derivative of itself".to_owned()
    } else if !variable.kind.is_float() {
        format!("a derivative that is {}, of {:?}", declared.type_name(), state.name)
    } else if !state.kind.is_float() {
        format!("the derivative of {:?} ({})", state.name, state.kind.name())
    } else if variable.dimensions != state.dimensions {
        format!("the derivative of {:?}, which has other dimensions", state.name)
    } else {
        return;
    };
    let expected = "the derivative of another real variable of its size";
    model.broken(findings, &VARIABLE_DERIVATIVE, declared, found, expected);
}

/// Checks the independent variable: FMI 3.0 needs one, FMI 2.0 may have one.
fn independent(model: &Model<'_, '_>, findings: &mut Findings) {
    let all: Vec<&Declared<'_, '_>> =
        model.variables.iter().filter(|d| d.variable.causality == Causality::Independent).collect();
    for (index, declared) in all.iter().enumerate() {
        let variable = declared.variable;
        let found = if index > 0 {
            format!("a second independent variable beside {:?}", all[0].variable.name)
        } else if !variable.kind.is_float() {
            format!("an independent variable that is {}", declared.type_name())
        } else if !variable.dimensions.is_empty() {
            "an independent variable that is an array".to_owned()
        } else {
            continue;
        };
        model.broken(findings, &VARIABLE_INDEPENDENT, declared, found, "one real scalar");
    }
    if all.is_empty() && !model.is_fmi2() {
        let place = model.at(model.root.child("ModelVariables").unwrap_or(model.root), "");
        findings.add(&VARIABLE_INDEPENDENT, place, "no independent variable", "one, usually time");
    }
}
