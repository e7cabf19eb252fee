//! The model structure: outputs, derivatives, initial unknowns and their dependencies.

use super::finding::Findings;
use super::model::Model;
use super::rules::{
    Rule, STRUCTURE_CLOCKED, STRUCTURE_DEPENDENCIES, STRUCTURE_DEPENDENCY_ORDER,
    STRUCTURE_DERIVATIVES, STRUCTURE_DUPLICATE, STRUCTURE_INDICATORS, STRUCTURE_INITIAL,
    STRUCTURE_INITIAL_ORDER, STRUCTURE_KINDS, STRUCTURE_OUTPUT_ORDER, STRUCTURE_OUTPUTS,
    STRUCTURE_REFERENCE, STRUCTURE_STATE,
};
use octant_fmu_host::description::xml::Element;
use octant_fmu_host::description::{Causality, Initial, Variability};
use std::collections::BTreeSet;

/// Largest number of variable names in a message.
const NAMED: usize = 5;

/// The lists of both standards.
#[derive(Clone, Copy, PartialEq, Eq)]
enum List {
    Outputs,
    Derivatives,
    ClockedStates,
    InitialUnknowns,
    EventIndicators,
}

impl List {
    /// Finds a list by an element: the one around the list in FMI 2.0, that of each entry in FMI
    /// 3.0.
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "Outputs" | "Output" => Self::Outputs,
            "Derivatives" | "ContinuousStateDerivative" => Self::Derivatives,
            "ClockedState" => Self::ClockedStates,
            "InitialUnknowns" | "InitialUnknown" => Self::InitialUnknowns,
            "EventIndicator" => Self::EventIndicators,
            _ => return None,
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Outputs => "the outputs",
            Self::Derivatives => "the state derivatives",
            Self::ClockedStates => "the clocked states",
            Self::InitialUnknowns => "the initial unknowns",
            Self::EventIndicators => "the event indicators",
        }
    }
}

/// An entry of a list.
struct Entry<'a, 't> {
    list: List,
    element: Element<'a, 't>,
    /// Index of its variable.
    index: usize,
}

/// Checks the structure.
pub(super) fn check(model: &Model<'_, '_>, findings: &mut Findings) {
    let Some(root) = model.root.child("ModelStructure") else { return };
    let entries = entries(model, root, findings);
    let of = |list: List| entries.iter().filter(move |entry| entry.list == list);
    outputs(model, root, of(List::Outputs), findings);
    let states = derivatives(model, of(List::Derivatives), findings);
    let rates = of(List::Derivatives).map(|entry| entry.index);
    let continuous: BTreeSet<usize> = rates.chain(states.iter().copied()).collect();
    initial_unknowns(model, root, &entries, &continuous, findings);
    indicators(model, of(List::EventIndicators), findings);
    clocked_states(model, root, of(List::ClockedStates), findings);
    // By value reference: an alias of a state counts as the state.
    let states: BTreeSet<u32> = states
        .into_iter()
        .chain(of(List::ClockedStates).map(|entry| entry.index))
        .map(|index| model.variables[index].variable.reference)
        .collect();
    for entry in &entries {
        dependencies(model, entry, &states, findings);
    }
}

/// Reads all entries that refer to a variable, each list without repetitions.
fn entries<'a, 't: 'a>(
    model: &Model<'a, 't>,
    root: Element<'a, 't>,
    findings: &mut Findings,
) -> Vec<Entry<'a, 't>> {
    let mut elements = Vec::new();
    for child in root.children() {
        let Some(list) = List::of(child.name()) else { continue };
        if model.is_fmi2() {
            elements.extend(child.children().map(|unknown| (list, unknown)));
        } else {
            elements.push((list, child));
        }
    }
    let mut entries: Vec<Entry<'a, 't>> = Vec::new();
    let mut seen = BTreeSet::new();
    for (list, element) in elements {
        // A value that isn't a number breaks the schema, which reports it.
        let Some(number) = number(model, element) else { continue };
        let Some(index) = index(model, number) else {
            let found = format!("{} {number} in {}", key(model), list.name());
            findings.add(&STRUCTURE_REFERENCE, model.at(element, ""), found, range(model));
            continue;
        };
        if !seen.insert((list as u8, index)) {
            let place = model.at(element, &model.variables[index].variable.name);
            let found = format!("it is in {} twice", list.name());
            findings.add(&STRUCTURE_DUPLICATE, place, found, "once");
            continue;
        }
        entries.push(Entry { list, element, index });
    }
    entries
}

/// Attribute by which an entry refers to its variable.
fn key(model: &Model<'_, '_>) -> &'static str {
    if model.is_fmi2() { "index" } else { "valueReference" }
}

fn range(model: &Model<'_, '_>) -> String {
    match model.is_fmi2() {
        true => format!("1 to {}", model.variables.len()),
        false => "the value reference of a variable".into(),
    }
}

fn number(model: &Model<'_, '_>, element: Element<'_, '_>) -> Option<u32> {
    element.text(key(model))?.trim().parse().ok()
}

/// Index of the variable for an index of FMI 2.0, from 1, or a value reference of FMI 3.0.
fn index(model: &Model<'_, '_>, number: u32) -> Option<usize> {
    if model.is_fmi2() {
        let index = (number as usize).checked_sub(1)?;
        (index < model.variables.len()).then_some(index)
    } else {
        model.by_reference.get(&number).copied()
    }
}

/// Reports surplus and missing entries of a list.
fn compare(
    model: &Model<'_, '_>,
    root: Element<'_, '_>,
    rule: &'static Rule,
    list: List,
    [found, expected, allowed]: [&BTreeSet<usize>; 3],
    findings: &mut Findings,
) {
    let names = |indices: Vec<&usize>| {
        let count = indices.len();
        let mut names: Vec<String> = indices
            .into_iter()
            .take(NAMED)
            .map(|&index| format!("{:?}", model.variables[index].variable.name))
            .collect();
        if count > NAMED {
            names.push(format!("{} more", count - NAMED));
        }
        names.join(", ")
    };
    let missing: Vec<&usize> = expected.difference(found).collect();
    if !missing.is_empty() {
        let message = format!("{} without {}", list.name(), names(missing));
        findings.add(rule, model.at(root, ""), message, "all of them");
    }
    let extra: Vec<&usize> = found.difference(allowed).collect();
    if !extra.is_empty() {
        let message = format!("{} with {}", list.name(), names(extra));
        findings.add(rule, model.at(root, ""), message, "no other");
    }
}

fn outputs<'m, 'a: 'm, 't: 'a>(
    model: &Model<'a, 't>,
    root: Element<'a, 't>,
    entries: impl Iterator<Item = &'m Entry<'a, 't>>,
    findings: &mut Findings,
) {
    let listed: Vec<usize> = entries.map(|entry| entry.index).collect();
    let found: BTreeSet<usize> = listed.iter().copied().collect();
    let expected: BTreeSet<usize> = (0..model.variables.len())
        .filter(|&index| model.variables[index].variable.causality == Causality::Output)
        .collect();
    let sets = [&found, &expected, &expected];
    compare(model, root, &STRUCTURE_OUTPUTS, List::Outputs, sets, findings);
    if let Some(pair) = listed.windows(2).find(|pair| pair[0] > pair[1]) {
        let name = |index: usize| format!("{:?}", model.variables[index].variable.name);
        let found = format!("{} after {}", name(pair[1]), name(pair[0]));
        findings.add(
            &STRUCTURE_OUTPUT_ORDER,
            model.at(root, ""),
            found,
            "the order of the variables",
        );
    }
}

/// Checks the derivatives, and returns the states.
fn derivatives<'m, 'a: 'm, 't: 'a>(
    model: &Model<'a, 't>,
    entries: impl Iterator<Item = &'m Entry<'a, 't>>,
    findings: &mut Findings,
) -> Vec<usize> {
    let mut seen = BTreeSet::new();
    let mut states = Vec::new();
    for entry in entries {
        let declared = &model.variables[entry.index];
        let place = model.at(entry.element, &declared.variable.name);
        let expected = "the derivative of a state";
        let Some(reference) = declared.variable.derivative_of else {
            let found = "a state derivative without the attribute derivative";
            findings.add(&STRUCTURE_DERIVATIVES, place, found, expected);
            continue;
        };
        let Some(&state) = model.by_reference.get(&reference) else { continue };
        // FMI 2.0 refers to the state by index: an alias of the state is another variable.
        let state =
            match declared.value.text("derivative").and_then(|text| text.trim().parse().ok()) {
                Some(number) if model.is_fmi2() => index(model, number).unwrap_or(state),
                _ => state,
            };
        if declared.variable.variability != Variability::Continuous
            || !declared.variable.kind.is_float()
        {
            let found = "a state derivative that isn't a continuous real variable";
            findings.add(&STRUCTURE_DERIVATIVES, place, found, "continuous");
        }
        if !seen.insert(model.variables[state].variable.reference) {
            let found =
                format!("a second derivative of {:?}", model.variables[state].variable.name);
            findings.add(&STRUCTURE_DERIVATIVES, place, found, "one of each state");
        }
        states.push(state);
        let variable = model.variables[state].variable;
        let causality = matches!(variable.causality, Causality::Local | Causality::Output);
        if !causality
            || variable.variability != Variability::Continuous
            || !variable.kind.is_float()
        {
            let found = format!(
                "a state that is {}, {}, {}",
                model.variables[state].type_name(),
                variable.causality.name(),
                variable.variability.name()
            );
            let expected = "a continuous real variable, local or an output";
            model.broken(findings, &STRUCTURE_STATE, &model.variables[state], found, expected);
        }
    }
    states
}

fn initial_unknowns<'a, 't: 'a>(
    model: &Model<'a, 't>,
    root: Element<'a, 't>,
    entries: &[Entry<'a, 't>],
    continuous: &BTreeSet<usize>,
    findings: &mut Findings,
) {
    let listed: Vec<usize> = entries
        .iter()
        .filter(|entry| entry.list == List::InitialUnknowns)
        .map(|entry| entry.index)
        .collect();
    let unknown = |index: usize| {
        matches!(
            model.variables[index].variable.initial,
            Some(Initial::Approx | Initial::Calculated)
        )
    };
    let mut expected: BTreeSet<usize> = (0..model.variables.len())
        .filter(|&index| {
            let variable = model.variables[index].variable;
            match variable.causality {
                Causality::Output => {
                    unknown(index) && variable.clocks.is_empty() && variable.clock.is_none()
                }
                Causality::CalculatedParameter => true,
                _ => false,
            }
        })
        .collect();
    expected.extend(continuous.iter().filter(|&&index| unknown(index)));
    // An FMU may initialize clocked variables.
    let clocked = (0..model.variables.len()).filter(|&index| {
        let variable = model.variables[index].variable;
        !variable.clocks.is_empty() || variable.clock.is_some()
    });
    let allowed: BTreeSet<usize> = expected.iter().copied().chain(clocked).collect();
    let found: BTreeSet<usize> = listed.iter().copied().collect();
    let sets = [&found, &expected, &allowed];
    compare(model, root, &STRUCTURE_INITIAL, List::InitialUnknowns, sets, findings);
    if model.is_fmi2()
        && let Some(pair) = listed.windows(2).find(|pair| pair[0] > pair[1])
    {
        let found = format!("index {} after {}", pair[1] + 1, pair[0] + 1);
        findings.add(&STRUCTURE_INITIAL_ORDER, model.at(root, ""), found, "ascending indices");
    }
}

fn indicators<'m, 'a: 'm, 't: 'a>(
    model: &Model<'a, 't>,
    entries: impl Iterator<Item = &'m Entry<'a, 't>>,
    findings: &mut Findings,
) {
    for entry in entries {
        let declared = &model.variables[entry.index];
        let variable = declared.variable;
        if !variable.kind.is_float()
            || variable.variability != Variability::Continuous
            || !matches!(variable.causality, Causality::Local | Causality::Output)
        {
            let found = format!(
                "an event indicator that is {}, {}, {}",
                declared.type_name(),
                variable.causality.name(),
                variable.variability.name()
            );
            let place = model.at(entry.element, &variable.name);
            let expected = "a continuous real variable, local or an output";
            findings.add(&STRUCTURE_INDICATORS, place, found, expected);
        }
    }
}

fn clocked_states<'m, 'a: 'm, 't: 'a>(
    model: &Model<'a, 't>,
    root: Element<'a, 't>,
    entries: impl Iterator<Item = &'m Entry<'a, 't>>,
    findings: &mut Findings,
) {
    let found: BTreeSet<usize> = entries.map(|entry| entry.index).collect();
    let expected: BTreeSet<usize> = (0..model.variables.len())
        .filter(|&index| model.variables[index].variable.previous.is_some())
        .collect();
    let sets = [&found, &expected, &expected];
    compare(model, root, &STRUCTURE_CLOCKED, List::ClockedStates, sets, findings);
}

/// Checks the dependencies of an unknown, and their kinds.
fn dependencies(
    model: &Model<'_, '_>,
    entry: &Entry<'_, '_>,
    states: &BTreeSet<u32>,
    findings: &mut Findings,
) {
    let variable = model.variables[entry.index].variable;
    let place = model.at(entry.element, &variable.name);
    let numbers: Option<Vec<u32>> = entry.element.list("dependencies").ok().flatten();
    for &number in numbers.iter().flatten() {
        let Some(index) = index(model, number) else {
            let found = format!("it depends on {} {number}", key(model));
            findings.add(&STRUCTURE_REFERENCE, place, found, range(model));
            return;
        };
        let known = model.variables[index].variable;
        let is_parameter =
            matches!(known.causality, Causality::Parameter | Causality::StructuralParameter);
        let is_known = match (entry.list, known.causality) {
            (_, Causality::Input | Causality::Independent) => true,
            (List::InitialUnknowns, _) => is_parameter || known.initial == Some(Initial::Exact),
            // FMI 2.0 has parameters among the knowns only during initialization; tools list
            // tunable ones all the same, and importers can use them.
            _ if is_parameter => !model.is_fmi2() || known.variability == Variability::Tunable,
            _ => states.contains(&known.reference) || !known.clocks.is_empty(),
        };
        if !is_known {
            // Both properties decide, and FMI 2.0 tells fixed parameters from tunable ones.
            let found = format!(
                "{:?} in {} depends on {:?}, which is {}, {}",
                variable.name,
                entry.list.name(),
                known.name,
                known.causality.name(),
                known.variability.name()
            );
            let expected = match entry.list {
                List::InitialUnknowns => "inputs, the independent variable, and what is exact",
                _ if model.is_fmi2() => {
                    "inputs, states, the independent variable and tunable parameters; \
                     fixed parameters only in the initial unknowns"
                }
                _ => "inputs, states, parameters and the independent variable",
            };
            findings.add(&STRUCTURE_DEPENDENCIES, place, found, expected);
            return;
        }
    }
    if let Some(numbers) = &numbers
        && model.is_fmi2()
        && !numbers.is_sorted_by(|a, b| a < b)
    {
        let found = "dependencies that aren't in ascending order";
        findings.add(&STRUCTURE_DEPENDENCY_ORDER, place, found, "ascending indices");
    }
    let Some(kinds) = entry.element.text("dependenciesKind") else { return };
    let kinds: Vec<&str> = kinds.split_ascii_whitespace().collect();
    let count = numbers.as_ref().map_or(0, Vec::len);
    let found = if numbers.is_none() {
        "dependenciesKind without dependencies".to_owned()
    } else if kinds.len() != count {
        format!("{} kinds of {count} dependencies", kinds.len())
    } else if let Some(kind) = kinds.iter().find(|kind| {
        let initial = entry.list == List::InitialUnknowns;
        let factor = matches!(**kind, "constant" | "fixed" | "tunable" | "discrete");
        (factor && !variable.kind.is_float()) || (initial && factor && **kind != "constant")
    }) {
        format!("the kind {kind} in {} of {:?}", entry.list.name(), variable.name)
    } else {
        return;
    };
    let expected =
        "a kind for each; factors of real variables only, and constant ones at the start";
    findings.add(&STRUCTURE_KINDS, place, found, expected);
}
