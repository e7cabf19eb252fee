//! `octant.ssp`: the two FMI 2.0 FMUs wired to a closed loop, with the parameters of a scenario.
//!
//! SSP 1.0, with the prefixes of its own examples, because some readers know no others (libcosim,
//! Ecos). Connectors are scalars, and enumerations are Integers, as in the descriptions.

use super::describe::{TOOL, base_unit, units};
use super::element::{Element, number};
use super::reference::scalar_names;
use octant_fmu::table::{DeclaredCausality, DeclaredVariable, ElementType, Model};

/// Parameter values of one component, as built by [`super::parameters`].
pub(super) type ParameterValues = Vec<(&'static str, Vec<f64>)>;

/// One FMU of the system.
pub(super) struct Component {
    /// Model; its stem is the name in the system.
    pub(super) model: &'static Model,
    /// File within the archive.
    pub(super) source: String,
    /// File of the parameter values.
    pub(super) parameters: String,
}

const SSD: &str = "http://ssp-standard.org/SSP1/SystemStructureDescription";
const SSC: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";
const SSV: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
/// Annotations from which libcosim reads the step.
const OSP: &str = "http://opensimulationplatform.com/SSP/OSPAnnotations";
const OSP_TYPE: &str = "com.opensimulationplatform";

/// Builds `SystemStructure.ssd`.
pub(super) fn structure(components: &[Component; 2], stop_s: f64, step_s: f64) -> Element {
    let [a, b] = components;
    let connections = wires(a.model, b.model).into_iter().chain(wires(b.model, a.model));
    let connections: Vec<Wire> = connections.collect();
    let elements = components.iter().map(|one| component(one, &connections, step_s));
    let wired = connections.iter().flat_map(|wire| {
        scalar_names(wire.variable).into_iter().map(|name| {
            Element::new("ssd:Connection")
                .with("startElement", wire.from.stem)
                .with("startConnector", name.clone())
                .with("endElement", wire.to.stem)
                .with("endConnector", name)
        })
    });
    let system = Element::new("ssd:System")
        .with("name", "octant")
        .with("description", "Plant and calibration core in a closed loop")
        .child(Element::new("ssd:Elements").children(elements))
        .child(Element::new("ssd:Connections").children(wired));
    let algorithm = Element::new("osp:Algorithm")
        .child(Element::new("osp:FixedStepAlgorithm").with("baseStepSize", number(step_s)));
    let experiment = Element::new("ssd:DefaultExperiment")
        .with("startTime", "0")
        .with("stopTime", number(stop_s))
        .child(annotation(algorithm));
    Element::new("ssd:SystemStructureDescription")
        .with("xmlns:ssd", SSD)
        .with("xmlns:ssc", SSC)
        .with("xmlns:osp", OSP)
        .with("version", "1.0")
        .with("name", "octant")
        .with("generationTool", TOOL)
        .child(system)
        .child(unit_list("ssd:Units", [a.model, b.model]))
        .child(experiment)
}

/// Builds a file of parameter values.
pub(super) fn parameter_set(
    model: &'static Model,
    name: &str,
    values: &ParameterValues,
) -> Element {
    let parameters = values.iter().filter_map(|(name, values)| {
        let (_, variable) = model.find(name)?;
        Some(scalar_names(variable).into_iter().zip(values).map(move |(name, value)| {
            Element::new("ssv:Parameter").with("name", name).child(parameter(variable, *value))
        }))
    });
    Element::new("ssv:ParameterSet")
        .with("xmlns:ssv", SSV)
        .with("xmlns:ssc", SSC)
        .with("version", "1.0")
        .with("name", name)
        .with("generationTool", TOOL)
        .child(Element::new("ssv:Parameters").children(parameters.flatten()))
        .child(unit_list("ssv:Units", [model]))
}

fn parameter(variable: &DeclaredVariable, value: f64) -> Element {
    match variable.kind {
        ElementType::Real | ElementType::Count => Element::new("ssv:Real")
            .with("value", number(value))
            .with_some("unit", unit_of(variable)),
        ElementType::Integer | ElementType::Enumeration(_) => {
            Element::new("ssv:Integer").with("value", number(value))
        }
        ElementType::Boolean => {
            Element::new("ssv:Boolean").with("value", (value != 0.0).to_string())
        }
        // No parameter has such a type.
        ElementType::Binary(_) | ElementType::Clock(_) => Element::new("ssv:Binary"),
    }
}

/// Output of one model that is an input of the other.
struct Wire {
    from: &'static Model,
    to: &'static Model,
    variable: &'static DeclaredVariable,
}

/// Pairs outputs of one model with the inputs of the other, by name.
fn wires(from: &'static Model, to: &'static Model) -> Vec<Wire> {
    let outputs = from.variables.iter().filter(|v| v.causality == DeclaredCausality::Output);
    let taken = outputs.filter(|output| {
        to.find(output.name).is_some_and(|(_, input)| {
            input.causality == DeclaredCausality::Input
                && input.kind == output.kind
                && input.elements == output.elements
        })
    });
    taken.map(|variable| Wire { from, to, variable }).collect()
}

fn component(component: &Component, wires: &[Wire], step_s: f64) -> Element {
    let model = component.model;
    let connectors = model.variables.iter().flat_map(|variable| {
        let wired = wires.iter().any(|wire| wire.variable.name == variable.name);
        let kind = match variable.causality {
            // An unconnected input keeps its start value.
            DeclaredCausality::Input if wired => Some("input"),
            DeclaredCausality::Output if wired || is_result(variable) => Some("output"),
            _ => None,
        };
        kind.into_iter().flat_map(move |kind| {
            scalar_names(variable).into_iter().map(move |name| {
                Element::new("ssd:Connector")
                    .with("name", name)
                    .with("kind", kind)
                    .child(connector_type(variable))
            })
        })
    });
    let binding = Element::new("ssd:ParameterBinding").with("source", component.parameters.clone());
    let hint = Element::new("osp:StepSizeHint").with("value", number(step_s));
    Element::new("ssd:Component")
        .with("name", model.stem)
        .with("description", model.description)
        .with("type", "application/x-fmu-sharedlibrary")
        .with("source", component.source.clone())
        .with("implementation", "CoSimulation")
        .child(Element::new("ssd:Connectors").children(connectors))
        .child(Element::new("ssd:ParameterBindings").child(binding))
        .child(annotation(hint))
}

/// Returns whether an output becomes a connector without a connection: the results that a user
/// inspects first. The others are still in the FMU; a tool that lists all connectors shouldn't have
/// to list hundreds.
fn is_result(variable: &DeclaredVariable) -> bool {
    const RESULTS: [&str; 7] =
        ["mode", "stop", "moving", "navigation.", "filter.", "health", "parameters.revision"];
    RESULTS.iter().any(|result| match result.strip_suffix('.') {
        Some(_) => variable.name.starts_with(result),
        None => variable.name == *result,
    })
}

fn connector_type(variable: &DeclaredVariable) -> Element {
    match variable.kind {
        ElementType::Real | ElementType::Count => {
            Element::new("ssc:Real").with_some("unit", unit_of(variable))
        }
        ElementType::Integer | ElementType::Enumeration(_) => Element::new("ssc:Integer"),
        ElementType::Boolean => Element::new("ssc:Boolean"),
        // SSP 1.0 has no clocks: models with clocks are in no system.
        ElementType::Binary(_) | ElementType::Clock(_) => Element::new("ssc:Binary"),
    }
}

/// Returns the name of the unit, if the schema can express it.
fn unit_of(variable: &DeclaredVariable) -> Option<&'static str> {
    let unit = variable.quantity?.unit;
    unit.exponents.is_some().then_some(unit.name)
}

fn unit_list<const N: usize>(element: &'static str, models: [&'static Model; N]) -> Element {
    Element::new(element).children(units(models).into_iter().filter_map(|unit| {
        let base = base_unit("ssc:BaseUnit", unit)?;
        Some(Element::new("ssc:Unit").with("name", unit.name).child(base))
    }))
}

fn annotation(content: Element) -> Element {
    Element::new("ssd:Annotations")
        .child(Element::new("ssc:Annotation").with("type", OSP_TYPE).child(content))
}
