//! Adds the parts that FMI-LS-BUS 1.0.0 requires beside a model's variables: a terminal and a
//! manifest.

use super::element::{Element, picture};
use octant_fmu::calibrator_can::table::{BUS, NOTIFICATIONS};
use octant_fmu::table::Model;

/// Path of the manifest.
pub(super) const MANIFEST: &str = "extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml";

/// Member names of the four bus variables in the terminal, which are also the ends of their names.
const MEMBERS: [&str; 4] = ["Rx_Clock", "Rx_Data", "Tx_Clock", "Tx_Data"];

/// Builds the bus terminal with its configuration terminal; `None` if the model is on no bus.
pub(super) fn terminal(model: &Model, place: [f64; 4]) -> Option<Element> {
    let member = |variable: &str, member: &str| {
        Element::new("TerminalMemberVariable")
            .with("variableName", variable)
            .with("memberName", member)
            .with("variableKind", "signal")
    };
    model.needs_clocks().then(|| {
        let configuration = Element::new("Terminal")
            .with("name", "Configuration")
            .with("matchingRule", "bus")
            .with("terminalKind", "org.fmi-ls-bus.network-terminal.configuration")
            .with("description", "How the node is set up")
            .child(member(NOTIFICATIONS, "BusNotifications"));
        Element::new("Terminal")
            .with("name", BUS)
            .with("matchingRule", "org.fmi-ls-bus.transceiver")
            .with("terminalKind", "org.fmi-ls-bus.network-terminal")
            .with("description", "The CAN bus")
            .children(MEMBERS.map(|name| member(&format!("{BUS}.{name}"), name)))
            .child(configuration)
            .child(picture(place))
    })
}

/// Builds the manifest; `None` if the model is on no bus.
pub(super) fn manifest(model: &Model) -> Option<Element> {
    model.needs_clocks().then(|| {
        Element::new("fmiLayeredStandardManifest")
            .with("xmlns:fmi-ls", "http://fmi-standard.org/fmi-ls-manifest")
            .with("fmi-ls:fmi-ls-name", "org.fmi-standard.fmi-ls-bus")
            .with("fmi-ls:fmi-ls-version", "1.0.0")
            .with(
                "fmi-ls:fmi-ls-description",
                "Layered Standard for the simulation of bus communication on a Physical Signal \
                 Abstraction or Network Abstraction based level.",
            )
            .with("isBusSimulationFMU", "false")
    })
}
