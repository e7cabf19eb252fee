//! Builds `modelDescription.xml` for both standards from one table.

mod fmi2;
mod fmi3;
mod types;

pub(super) use fmi2::fmi2;
pub(super) use fmi3::fmi3;
pub(super) use types::{base_unit, units};

use super::element::Element;
use octant_fmu::c::CATEGORIES;
use octant_fmu::table::{DeclaredCausality, DeclaredVariability, DeclaredVariable, Model};

/// Name and version of the generating program.
pub(super) const TOOL: &str = concat!("Octant ", env!("CARGO_PKG_VERSION"));

/// End of the default experiment, s, equal to that of the reference result: the alignment with the
/// start values takes a minute, and ten measurements follow.
pub(super) const STOP_S: f64 = 70.0;
/// Step of the default experiment, s: the sample period of the start values.
pub(super) const STEP_S: f64 = 0.005;

/// Builds the root element with the attributes common to both standards.
fn root(model: &Model, version: &str) -> Element {
    Element::new("fmiModelDescription")
        .with("fmiVersion", version)
        .with("modelName", model.name)
        .with("description", model.description)
        .with("author", "The Octant developers")
        .with("version", env!("CARGO_PKG_VERSION"))
        .with("copyright", super::licences::COPYRIGHT)
        .with("license", env!("CARGO_PKG_LICENSE"))
        // The time of generation is left out: the same source gives the same bytes.
        .with("generationTool", TOOL)
        .with("variableNamingConvention", "structured")
}

/// Log categories that the library knows.
fn log_categories() -> Element {
    let category = |(name, description)| {
        Element::new("Category").with("name", name).with("description", description)
    };
    Element::new("LogCategories").children(CATEGORIES.map(category))
}

/// Builds the experiment that a tool runs by default.
fn default_experiment() -> Element {
    Element::new("DefaultExperiment")
        .with("startTime", "0")
        .with("stopTime", super::element::number(STOP_S))
        .with("stepSize", super::element::number(STEP_S))
}

/// Returns the name of the causality in the schema.
fn causality(variable: &DeclaredVariable) -> &'static str {
    match variable.causality {
        DeclaredCausality::Parameter => "parameter",
        DeclaredCausality::CalculatedParameter => "calculatedParameter",
        DeclaredCausality::Input => "input",
        DeclaredCausality::Output => "output",
        DeclaredCausality::Local => "local",
    }
}

/// Returns the name of the variability in the schema.
fn variability(variable: &DeclaredVariable) -> &'static str {
    match variable.variability {
        DeclaredVariability::Fixed => "fixed",
        DeclaredVariability::Tunable => "tunable",
        DeclaredVariability::Discrete => "discrete",
    }
}

/// True if a variable's first value is given; false if it is calculated at the end of
/// initialization. No third case is needed, because there are no iterations.
pub(super) fn has_start(variable: &DeclaredVariable) -> bool {
    matches!(variable.causality, DeclaredCausality::Parameter | DeclaredCausality::Input)
}

/// Lists the unknowns of the initialization, in the order of the table.
fn initial_unknowns(model: &Model) -> impl Iterator<Item = (usize, &DeclaredVariable)> {
    model.variables.iter().enumerate().filter(|(_, variable)| {
        matches!(variable.causality, DeclaredCausality::Output | DeclaredCausality::CalculatedParameter)
            // A clocked variable has values at ticks only, and none before the first.
            && !variable.is_clocked()
    })
}

/// Lists the variables on which the unknowns of the initialization depend: parameters, and no
/// input, because the first outputs exist before a sample has come.
fn initial_knowns(model: &Model) -> impl Iterator<Item = (usize, &DeclaredVariable)> {
    model.variables.iter().enumerate().filter(|(_, v)| v.causality == DeclaredCausality::Parameter)
}

/// Returns the start value of an element.
fn start(variable: &DeclaredVariable, element: usize) -> f64 {
    variable.start_of(element).unwrap_or(0.0)
}

/// Returns the index of a variable by its name.
fn index_of(model: &Model, name: &str) -> Option<usize> {
    model.variables.iter().position(|variable| variable.name == name)
}

/// Returns the first slot of each variable.
pub(super) fn first_slots(model: &Model) -> Vec<usize> {
    model.with_slots().map(|(slot, _)| slot).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::super::sample::SAMPLE;
    use super::*;

    #[test]
    fn integers_are_written_as_integers() {
        for description in [fmi2(&SAMPLE, "{token}"), fmi3(&SAMPLE, "{token}")] {
            let text = String::from_utf8(description.document().unwrap()).unwrap();
            let file = roxmltree::Document::parse(&text).unwrap();
            let mut seen = 0;
            for node in file.descendants() {
                if !matches!(node.tag_name().name(), "Integer" | "Int32" | "UInt64" | "Enumeration")
                {
                    continue;
                }
                for name in ["min", "max", "start"] {
                    for number in node.attribute(name).unwrap_or_default().split(' ') {
                        assert!(number.is_empty() || number.parse::<i64>().is_ok(), "{number}");
                        seen += usize::from(!number.is_empty());
                    }
                }
            }
            assert!(seen >= 5, "{seen}");
        }
    }
}
