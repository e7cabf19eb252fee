//! The part before the variables: interfaces, log categories, default experiment.

use super::finding::{Findings, Place};
use super::model::Model;
use super::rules::{
    DESCRIPTION_IDENTIFIER, DESCRIPTION_NAME, DESCRIPTION_TOKEN, DESCRIPTION_VERSION,
    EXPERIMENT_RANGE, EXPERIMENT_STEP, INTERFACE_EARLY_RETURN, INTERFACE_SAME_IDENTIFIER,
    INTERFACE_STATE, INTERFACE_STEP, LOG_UNIQUE,
};
use octant_fmu_host::description::xml::Element;
use std::collections::BTreeSet;

/// Checks the head.
pub(super) fn check(model: &Model<'_, '_>, findings: &mut Findings) {
    let description = model.description;
    let root = model.at(model.root, "");
    if description.model_name.trim().is_empty() {
        findings.add(&DESCRIPTION_NAME, root, "no model name", "the name of the model");
    }
    if description.token.trim().is_empty() {
        findings.add(&DESCRIPTION_TOKEN, root, "an empty token", "a text that tells builds apart");
    }
    if !model.is_fmi2() && !description.fmi_version.starts_with("3.0") {
        let found = format!("version {:?}", description.fmi_version);
        findings.add(&DESCRIPTION_VERSION, root, found, "3.0; what is newer is checked as 3.0");
    }
    interfaces(model, findings);
    let mut names = BTreeSet::new();
    for category in model.root.child("LogCategories").into_iter().flat_map(Element::children) {
        let Some(name) = category.text("name") else { continue };
        if !names.insert(name) {
            let place = model.at(category, name);
            findings.add(&LOG_UNIQUE, place, "the category is there twice", "another name");
        }
    }
    experiment(model, findings);
}

fn interfaces(model: &Model<'_, '_>, findings: &mut Findings) {
    let states = if model.is_fmi2() { "FMUstate" } else { "FMUState" };
    let mut identifiers = BTreeSet::new();
    for element in model.root.children() {
        let name = element.name();
        if !matches!(name, "CoSimulation" | "ModelExchange" | "ScheduledExecution") {
            continue;
        }
        let place = model.at(element, name);
        if let Some(identifier) = element.text("modelIdentifier") {
            if !is_c_identifier(identifier) {
                let found = format!("{identifier:?}");
                let expected = "letters, digits and _, no digit first, and no word of C";
                findings.add(&DESCRIPTION_IDENTIFIER, place, found, expected);
            }
            identifiers.insert(identifier);
        }
        let flag = |name: &str| element.boolean(name).unwrap_or(false);
        if flag(&format!("canSerialize{states}")) && !flag(&format!("canGetAndSet{states}")) {
            let found = format!("canSerialize{states} without canGetAndSet{states}");
            findings.add(&INTERFACE_STATE, place, found, "both");
        }
        if flag("canReturnEarlyAfterIntermediateUpdate") && !flag("providesIntermediateUpdate") {
            let found = "canReturnEarlyAfterIntermediateUpdate without providesIntermediateUpdate";
            findings.add(&INTERFACE_EARLY_RETURN, place, found, "both");
        }
        if let Ok(Some(step)) = element.real("fixedInternalStepSize")
            && !(step > 0.0 && step.is_finite())
        {
            findings.add(&INTERFACE_STEP, place, format!("{step} s"), "a positive step");
        }
    }
    let several: Vec<&str> = identifiers.into_iter().collect();
    if several.len() > 1 {
        let place = model.at(model.root, "");
        findings.add(&INTERFACE_SAME_IDENTIFIER, place, several.join(" and "), "one library");
    }
}

fn experiment(model: &Model<'_, '_>, findings: &mut Findings) {
    let Some(element) = model.root.child("DefaultExperiment") else { return };
    let place = model.at(element, "DefaultExperiment");
    let experiment = model.description.default_experiment;
    let mut wrong = |name: &str, value: f64, expected: &str| {
        findings.add(&EXPERIMENT_RANGE, place, format!("{name} {value}"), expected);
    };
    let all = [
        ("startTime", experiment.start_s),
        ("stopTime", experiment.stop_s),
        ("tolerance", experiment.tolerance),
        ("stepSize", experiment.step_s),
    ];
    let mut finite = true;
    for (name, value) in all {
        if let Some(value) = value.filter(|value| !value.is_finite()) {
            wrong(name, value, "a finite number");
            finite = false;
        }
    }
    if !finite {
        return;
    }
    let start = experiment.start_s.unwrap_or(0.0);
    if let Some(stop) = experiment.stop_s.filter(|&stop| stop <= start) {
        wrong("stopTime", stop, &format!("more than startTime {start}"));
        return;
    }
    for (name, value) in [("tolerance", experiment.tolerance), ("stepSize", experiment.step_s)] {
        if let Some(value) = value.filter(|&value| value <= 0.0) {
            wrong(name, value, "a positive number");
        }
    }
    if let (Some(stop), Some(step)) = (experiment.stop_s, experiment.step_s)
        && step > stop - start
    {
        let found = format!("stepSize {step} from {start} to {stop}");
        findings.add(&EXPERIMENT_STEP, place, found, "at least one step");
    }
}

/// Makes a place without line, for a file that isn't XML.
pub(super) fn of_file<'a>(entry: &'a str, subject: &'a str) -> Place<'a> {
    Place { entry, line: None, subject }
}

/// Returns whether a name can be that of a function in C.
#[must_use]
pub fn is_c_identifier(name: &str) -> bool {
    const WORDS: [&str; 44] = [
        "auto",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "else",
        "enum",
        "extern",
        "float",
        "for",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "register",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "while",
        "_Alignas",
        "_Alignof",
        "_Atomic",
        "_Bool",
        "_Complex",
        "_Generic",
        "_Imaginary",
        "_Noreturn",
        "_Static_assert",
        "_Thread_local",
    ];
    let mut bytes = name.bytes();
    bytes.next().is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
        && bytes.all(|b| b.is_ascii_alphanumeric() || b == b'_')
        && !WORDS.contains(&name)
}
