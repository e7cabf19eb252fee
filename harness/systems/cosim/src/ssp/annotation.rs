//! Settings of a structure for this program alone: an annotation of the whole description.
//!
//! ```xml
//! <ssc:Annotation type="octant.co-simulation">
//!   <CoSimulation xmlns="urn:octant:co-simulation:1" step="5 ms"
//!                 order="gauss-seidel=plant,calibrator" seed="1">
//!     <Faults source="resources/faults.toml"/>
//!     <Requirements source="resources/requirements.toml"/>
//!   </CoSimulation>
//! </ssc:Annotation>
//! ```

use super::SspError;
use super::package::Package;
use super::xml::{Element, SSC, SSD};
use crate::order::{OrderError, SteppingOrder};
use octant_scenario::quantity;

/// Type of the annotation.
pub const TYPE: &str = "octant.co-simulation";
/// Namespace of the annotation's content.
pub const NAMESPACE: &str = "urn:octant:co-simulation:1";

/// Settings of the annotation; the command line takes precedence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoSimulation {
    /// Communication step, s.
    pub step_s: Option<f64>,
    /// Order of the FMUs.
    pub order: Option<SteppingOrder>,
    /// Seed of the faults' random streams.
    pub seed: Option<u64>,
    /// Faults on connections.
    pub faults: Option<TomlText>,
    /// Requirements on signals.
    pub requirements: Option<TomlText>,
}

/// List of faults or requirements as text.
#[derive(Clone, Debug, PartialEq)]
pub struct TomlText {
    /// The file, for messages.
    pub file: String,
    /// TOML text; its lines have the same numbers as in the file.
    pub text: String,
}

/// Reads the annotation of a description; annotations of other programs are ignored.
pub(super) fn of(root: &Element<'_>, package: &Package) -> Result<CoSimulation, SspError> {
    let mut read = CoSimulation::default();
    let mut found = false;
    for list in root.children().filter(|child| child.is(SSD, "Annotations")) {
        for annotation in list.children().filter(|child| child.is(SSC, "Annotation")) {
            if annotation.optional("type") != Some(TYPE) {
                continue;
            }
            if std::mem::replace(&mut found, true) {
                return Err(annotation.error(format!("a second annotation {TYPE:?} was found")));
            }
            for element in annotation.children() {
                element.expect(NAMESPACE, "CoSimulation")?;
                read = co_simulation(&element, package)?;
            }
        }
    }
    Ok(read)
}

fn co_simulation(element: &Element<'_>, package: &Package) -> Result<CoSimulation, SspError> {
    let parts = [(NAMESPACE, "Faults"), (NAMESPACE, "Requirements")];
    element.only(&["step", "order", "seed"], &parts)?;
    let step_s = element.optional("step").map(step).transpose().map_err(|e| element.error(e))?;
    let order = element.optional("order").map(str::parse).transpose();
    let seed = element.optional("seed").map(|text| text.trim().parse::<u64>());
    let seed = seed.transpose().map_err(|_| {
        let found = element.optional("seed").unwrap_or_default();
        element.error(format!("seed is {found:?}, expected a whole number"))
    })?;
    let text = |name: &str| {
        let found = element.child(NAMESPACE, name)?;
        found.map(|found| toml_text(&found, package)).transpose()
    };
    let (faults, requirements) = (text("Faults")?, text("Requirements")?);
    Ok(CoSimulation {
        step_s,
        order: order.map_err(|error: OrderError| element.error(error.to_string()))?,
        seed,
        faults,
        requirements,
    })
}

/// Returns the step, s, in the annotation of the Open Simulation Platform, which libcosim and
/// others read.
pub(super) fn osp_step_s(experiment: &Element<'_>) -> Result<Option<f64>, SspError> {
    const TYPE: &str = "com.opensimulationplatform";
    const NAMESPACE: &str = "http://opensimulationplatform.com/SSP/OSPAnnotations";
    let lists = experiment.children().filter(|child| child.is(SSD, "Annotations"));
    let ours = |annotation: &Element<'_>| annotation.optional("type") == Some(TYPE);
    for annotation in lists.flat_map(|list| list.children()).filter(ours) {
        for algorithm in annotation.children().filter(|child| child.is(NAMESPACE, "Algorithm")) {
            if let Some(fixed) = algorithm.child(NAMESPACE, "FixedStepAlgorithm")? {
                return fixed.finite("baseStepSize");
            }
        }
    }
    Ok(None)
}

/// Returns the step, s, in OMSimulator's annotation of a system: that of its master, or the longest one of
/// its solver, with a warning.
pub(super) fn oms_step_s(system: &Element<'_>) -> Result<Option<f64>, SspError> {
    const TYPE: &str = "org.openmodelica";
    let lists = system.children().filter(|child| child.is(SSD, "Annotations"));
    let theirs = |annotation: &Element<'_>| annotation.optional("type") == Some(TYPE);
    for annotation in lists.flat_map(|list| list.children()).filter(theirs) {
        // Versions of OMSimulator differ in namespaces, and in an element around it.
        let inside = annotation.node.descendants().filter(roxmltree::Node::is_element);
        for node in inside {
            let element = Element { node, ..annotation };
            match element.name() {
                "FixedStepMaster" => return element.finite("stepSize"),
                "VariableStepSolver" | "VariableStepMaster" => {
                    let step_s = element.finite("maximumStepSize")?;
                    if let Some(step_s) = step_s {
                        element.warn(format!(
                            "OMSimulator varies its step up to {step_s} s: that is taken as the communication step"
                        ));
                    }
                    return Ok(step_s);
                }
                _ => {}
            }
        }
    }
    Ok(None)
}

/// Parses a communication step as the user writes it, s.
pub(crate) fn step(text: &str) -> Result<f64, String> {
    let expected = "expected a time above 0 such as \"5 ms\"";
    match quantity::parse(text) {
        Ok(quantity) if quantity.is(quantity::UnitDimension::TIME) && quantity.si > 0.0 => {
            Ok(quantity.si)
        }
        _ => Err(format!("step is {text:?}, {expected}")),
    }
}

/// Reads a list in TOML: from the file that the element names, or from its text.
fn toml_text(element: &Element<'_>, package: &Package) -> Result<TomlText, SspError> {
    element.only(&["source"], &[])?;
    let inline =
        element.node.children().find(|node| node.text().is_some_and(|t| !t.trim().is_empty()));
    match (element.optional("source"), inline) {
        (Some(source), None) => {
            let path = package.resolve(source).map_err(|error| element.error(error.to_string()))?;
            Ok(TomlText { file: package.name_of(&path), text: package.text_of(&path)? })
        }
        (None, Some(text)) => {
            let line = text.document().text_pos_at(text.range().start).row as usize;
            let mut lines = "\n".repeat(line.saturating_sub(1));
            lines.push_str(text.text().unwrap_or_default());
            Ok(TomlText { file: element.file.to_owned(), text: lines })
        }
        (Some(_), Some(_)) => Err(element.error("both a source and a text were found")),
        (None, None) => Err(element.error("neither a source nor a text was found")),
    }
}
