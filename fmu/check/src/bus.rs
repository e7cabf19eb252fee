//! Layered standards: their manifests, and the rules of FMI-LS-BUS 1.0.0 for FMUs on a bus.
//!
//! The network abstraction (low cut) is checked, for every kind of bus, with the additions of CAN.
//! For the physical signal abstraction (high cut) only the manifest is checked.

use super::finding::{Findings, Place};
use super::model::Model;
use super::rules::{
    BUS_CONFIGURATION, BUS_EVENT_MODE, BUS_MANIFEST, BUS_MEMBERS, BUS_MIME_TYPE, BUS_NOTIFICATIONS,
    BUS_STEP, BUS_VARIABLES, BUS_VERSION, LAYERED_MANIFEST,
};
use super::terminals;
use super::text::text;
use octant_fmu_host::archive::Archive;
use octant_fmu_host::description::xml::{Element, File};
use octant_fmu_host::description::{
    Causality, IntervalVariability, Variability, Variable, VariableType,
};
use std::collections::BTreeSet;

/// Name of the standard, and the folder of its manifest.
const NAME: &str = "org.fmi-standard.fmi-ls-bus";
const MANIFEST_FILE: &str = "fmi-ls-manifest.xml";
const NAMESPACE: &str = "http://fmi-standard.org/fmi-ls-manifest";
const NETWORK: &str = "org.fmi-ls-bus.network-terminal";
const CONFIGURATION: &str = "org.fmi-ls-bus.network-terminal.configuration";
const TRANSCEIVER: &str = "org.fmi-ls-bus.transceiver";
/// Beginning of the MIME types of all buses.
const MIME_TYPE: &str = "application/org.fmi-standard.fmi-ls-bus.";

/// Content of a manifest of FMI-LS-BUS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Manifest {
    is_bus_simulation: bool,
}

/// Reads the manifests of all layered standards; `Some`: the FMU follows FMI-LS-BUS.
pub(super) fn manifests(archive: &mut Archive, findings: &mut Findings) -> Option<Manifest> {
    let entries: Vec<String> = archive
        .entries()
        .iter()
        .map(|entry| entry.name.clone())
        .filter(|name| name.starts_with("extra/") && name.ends_with(&format!("/{MANIFEST_FILE}")))
        .collect();
    let mut bus = None;
    for entry in entries {
        let place = Place { entry: &entry, ..Place::default() };
        let folder = entry["extra/".len()..].split('/').next().unwrap_or_default().to_owned();
        let Ok(bytes) = archive.read(&entry) else {
            findings.add(&LAYERED_MANIFEST, place, "it can't be unpacked", "the file");
            continue;
        };
        let Some(text) = text(&entry, &bytes, findings) else { continue };
        let file = File::new(&entry, &text);
        match file.parse(&text) {
            Ok(document) => {
                let root = Element::root(&file, &document);
                let found = manifest(root, &folder, place, findings);
                bus = bus.or(found);
            }
            Err(error) => {
                let place = Place { line: error.line, ..place };
                findings.add(&LAYERED_MANIFEST, place, error.found, error.expected);
            }
        }
    }
    bus
}

fn manifest(
    root: Element<'_, '_>,
    folder: &str,
    place: Place<'_>,
    findings: &mut Findings,
) -> Option<Manifest> {
    let place = Place { line: Some(root.line()), ..place };
    // The root element may have any name and other content: only its attributes are standardized.
    for attribute in ["fmi-ls-name", "fmi-ls-version", "fmi-ls-description"] {
        if root.text_of(NAMESPACE, attribute).is_none() {
            let found = format!("no {attribute} of the namespace {NAMESPACE}");
            findings.add(&LAYERED_MANIFEST, place, found, "the attribute");
        }
    }
    if root.text_of(NAMESPACE, "fmi-ls-name").unwrap_or(folder) != NAME {
        return None;
    }
    // Which folder it is, the layered standard says.
    if folder != NAME {
        let found = format!("the manifest of {NAME} in extra/{folder}/");
        findings.add(&BUS_MANIFEST, place, found, format!("extra/{NAME}/"));
    }
    let version = root.text_of(NAMESPACE, "fmi-ls-version").unwrap_or_default();
    if !version.is_empty() && version != "1.0.0" {
        let found = format!("version {version:?}");
        findings.add(&BUS_VERSION, place, found, "1.0.0, whose rules are checked");
    }
    let is_bus_simulation = match root.text("isBusSimulationFMU") {
        None | Some("false") => false,
        Some("true") => true,
        Some(other) => {
            let found = format!("isBusSimulationFMU {other:?}");
            findings.add(&BUS_MANIFEST, place, found, "true or false");
            false
        }
    };
    Some(Manifest { is_bus_simulation })
}

/// Checks the bus terminals; `root`: root element of terminalsAndIcons.xml, if the file exists.
pub(super) fn check(
    model: &Model<'_, '_>,
    root: Option<Element<'_, '_>>,
    manifest: Option<Manifest>,
    findings: &mut Findings,
) {
    let list = root.and_then(|root| root.child("Terminals"));
    let buses: Vec<Element<'_, '_>> = list
        .into_iter()
        .flat_map(Element::children)
        .filter(|terminal| terminal.text("terminalKind") == Some(NETWORK))
        .collect();
    let file = Place { entry: terminals::FILE, ..Place::default() };
    match (manifest, buses.first()) {
        (None, None) => return,
        (Some(_), None) => {
            let found = format!("no terminal of the kind {NETWORK}");
            findings.add(&BUS_MANIFEST, file, found, "one for each network of the manifest's FMU");
        }
        (None, Some(bus)) => {
            let place = Place { line: Some(bus.line()), ..file };
            let found = format!("a bus terminal, and no extra/{NAME}/{MANIFEST_FILE}");
            findings.add(&BUS_MANIFEST, place, found, "the manifest");
        }
        _ => {}
    }
    let interface = model.description.co_simulation.as_ref();
    if !interface.is_some_and(|interface| interface.event_mode) {
        let place = Place { entry: model.entry, ..Place::default() };
        let found = "no co-simulation with hasEventMode";
        findings.add(&BUS_EVENT_MODE, place, found, "hasEventMode");
    }
    let mut used = BTreeSet::new();
    for bus in buses {
        let name = bus.text("name").unwrap_or_default();
        let place = Place { line: Some(bus.line()), subject: name, ..file };
        // High cut has nested frame terminals, and the matching rule `bus`.
        match bus.text("matchingRule") {
            Some("bus") => continue,
            Some(TRANSCEIVER) => {}
            other => {
                let found = format!("matching rule {:?}", other.unwrap_or_default());
                findings.add(&BUS_MEMBERS, place, found, TRANSCEIVER);
            }
        }
        low_cut(model, bus, place, &mut used, findings);
        configuration(model, bus, manifest, place, findings);
    }
}

/// Finds the member of a terminal with this name, and its variable.
fn member<'m>(
    model: &'m Model<'_, '_>,
    terminal: Element<'_, '_>,
    name: &str,
) -> Option<(u32, Option<&'m str>, Option<&'m Variable>)> {
    let found = terminal.children().find(|child| {
        child.name() == "TerminalMemberVariable" && child.text("memberName") == Some(name)
    })?;
    let index = found.text("variableName").and_then(|name| model.by_name.get(name));
    let variable = index.map(|index| model.variables[*index].variable);
    let is_signal = found.text("variableKind") == Some("signal");
    Some((found.line(), (!is_signal).then_some("another kind than signal"), variable))
}

/// Checks the four variables of a network.
fn low_cut(
    model: &Model<'_, '_>,
    bus: Element<'_, '_>,
    place: Place<'_>,
    used: &mut BTreeSet<u32>,
    findings: &mut Findings,
) {
    let mut get = |name: &'static str| {
        let Some((line, wrong, variable)) = member(model, bus, name) else {
            findings.add(&BUS_MEMBERS, place, format!("no member {name}"), "the member");
            return None;
        };
        let place = Place { line: Some(line), ..place };
        if let Some(wrong) = wrong {
            findings.add(&BUS_MEMBERS, place, format!("{name} of {wrong}"), "variableKind signal");
        }
        let variable = variable?;
        if !used.insert(variable.reference) {
            let found = format!("{} is a member of two bus terminals", variable.name);
            findings.add(&BUS_MEMBERS, place, found, "variables of its own for each network");
        }
        Some((variable, place))
    };
    let [rx_clock, rx_data, tx_clock, tx_data] =
        ["Rx_Clock", "Rx_Data", "Tx_Clock", "Tx_Data"].map(&mut get);
    let mut expect = |what: Option<(&Variable, Place<'_>)>, is_so: bool, expected: &str| {
        if let Some((variable, place)) = what.filter(|_| !is_so) {
            let found = format!("{}, {}", variable.name, described(variable));
            findings.add(&BUS_VARIABLES, place, found, expected);
        }
    };
    let ticks = |clock: Option<(&Variable, Place<'_>)>| {
        clock.and_then(|(clock, _)| clock.clock).map(|clock| clock.interval_variability)
    };
    let causality = |of: Option<(&Variable, Place<'_>)>| of.map(|(variable, _)| variable.causality);
    let triggered = Some(IntervalVariability::Triggered);
    let is_so = ticks(rx_clock) == triggered && causality(rx_clock) == Some(Causality::Input);
    expect(rx_clock, is_so, "Rx_Clock as a triggered clock that is an input");
    let is_so = match causality(tx_clock) {
        Some(Causality::Input) => ticks(tx_clock).is_some_and(|ticks| Some(ticks) != triggered),
        Some(Causality::Output) => ticks(tx_clock) == triggered,
        _ => false,
    };
    expect(tx_clock, is_so, "Tx_Clock as a time-based input clock, or a triggered output clock");
    for (data, clock, direction, expected) in [
        (rx_data, rx_clock, Causality::Input, "Rx_Data as a Binary input with the clock Rx_Clock"),
        (
            tx_data,
            tx_clock,
            Causality::Output,
            "Tx_Data as a Binary output with the clock Tx_Clock",
        ),
    ] {
        let is_so = data.is_some_and(|(data, _)| {
            let clock = clock.map(|(clock, _)| clock.reference);
            data.kind == VariableType::Binary
                && data.causality == direction
                && clock.is_none_or(|clock| data.clocks.contains(&clock))
        });
        expect(data, is_so, expected);
    }
    let types = [rx_data, tx_data]
        .map(|data| data.and_then(|(data, _)| data.mime_type.as_deref()).unwrap_or_default());
    for (data, mime_type) in [rx_data, tx_data].into_iter().zip(types) {
        if let Some((data, place)) = data.filter(|_| !mime_type.starts_with(MIME_TYPE)) {
            let found = format!("{} with the mimeType {mime_type:?}", data.name);
            findings.add(&BUS_MIME_TYPE, place, found, format!("{MIME_TYPE}… with its version"));
        }
    }
    if let (Some(_), Some((data, place)), true) = (rx_data, tx_data, types[0] != types[1]) {
        let found = format!("{} with another mimeType than what comes", data.name);
        findings.add(&BUS_MIME_TYPE, place, found, "the same both ways");
    }
    let interface = model.description.co_simulation.as_ref();
    let time_based = causality(tx_clock) == Some(Causality::Input);
    if let Some((clock, place)) = tx_clock
        && time_based
        && interface.is_some_and(|interface| !interface.variable_step)
    {
        let found = format!("{} without canHandleVariableCommunicationStepSize", clock.name);
        findings.add(&BUS_STEP, place, found, "the capability: its ticks lie anywhere");
    }
}

fn described(variable: &Variable) -> String {
    let kind = match variable.clock {
        Some(clock) => format!("a {:?} clock", clock.interval_variability).to_lowercase(),
        None => variable.kind.name().to_owned(),
    };
    format!("{kind} and {}", variable.causality.name())
}

/// Checks the nested terminal with the configuration of the node.
fn configuration(
    model: &Model<'_, '_>,
    bus: Element<'_, '_>,
    manifest: Option<Manifest>,
    place: Place<'_>,
    findings: &mut Findings,
) {
    let nested = bus.children().filter(|child| child.name() == "Terminal");
    let of_kind = |terminal: &Element<'_, '_>| terminal.text("terminalKind") == Some(CONFIGURATION);
    let Some(terminal) = nested.into_iter().find(of_kind) else { return };
    let place = Place { line: Some(terminal.line()), ..place };
    let (name, rule) = (terminal.text("name"), terminal.text("matchingRule"));
    if (name, rule) != (Some("Configuration"), Some("bus")) {
        let [name, rule] = [name, rule].map(Option::unwrap_or_default);
        let found = format!("a configuration terminal {name:?}, matched as {rule:?}");
        findings.add(&BUS_CONFIGURATION, place, found, "\"Configuration\", matched as \"bus\"");
    }
    let is_simulation = manifest.is_some_and(|manifest| manifest.is_bus_simulation);
    let Some((line, _, Some(variable))) = member(model, terminal, "BusNotifications") else {
        return;
    };
    let place = Place { line: Some(line), ..place };
    let is_so = match (variable.causality, variable.variability) {
        (Causality::Parameter, Variability::Fixed) => !is_simulation,
        (Causality::CalculatedParameter, Variability::Fixed)
        | (Causality::Output, Variability::Constant) => is_simulation,
        _ => false,
    };
    if variable.kind != VariableType::Boolean || !is_so {
        let found = format!("{}, {}", variable.name, described(variable));
        let expected = match is_simulation {
            true => "a Boolean, a fixed calculated parameter or a constant output",
            false => "a Boolean and fixed parameter",
        };
        findings.add(&BUS_NOTIFICATIONS, place, found, expected);
    }
    let declared = model.by_reference.get(&variable.reference).map(|index| model.variables[*index]);
    let start = declared.and_then(|declared| declared.value.text("start"));
    if !is_simulation && start.is_some_and(|start| !matches!(start.trim(), "false" | "0")) {
        let found = format!("{} starts with {:?}", variable.name, start.unwrap_or_default());
        findings.add(&BUS_NOTIFICATIONS, place, found, "false");
    }
}
