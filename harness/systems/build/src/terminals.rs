//! Terminals (FMI 3.0): groups of variables that belong together, under the same names in both
//! models, so that a tool connects the two by dragging one line.

use super::bus;
use super::element::{Element, corners, picture};
use octant_fmu::table::{DeclaredCausality, DeclaredVariable, Model};

/// Terminal: its name, its description, and the prefixes of its variables' names.
struct Terminal {
    name: &'static str,
    description: &'static str,
    prefixes: &'static [&'static str],
}

const TERMINALS: [Terminal; 5] = [
    Terminal {
        name: "imu",
        description: "Inertial samples with the gimbal angles at their ends",
        prefixes: &["gyro.", "accelerometer.", "gimbal.", "imu."],
    },
    Terminal {
        name: "reference",
        description: "Reference velocity or position with the stamp of its sample",
        prefixes: &["reference."],
    },
    Terminal {
        name: "gimbal_command",
        description: "Set points of the gimbals",
        prefixes: &["gimbal_command."],
    },
    Terminal {
        name: "navigation",
        description: "Position, velocity and attitude",
        prefixes: &["navigation."],
    },
    Terminal { name: "truth", description: "What is so, without errors", prefixes: &["truth."] },
];

/// Builds `terminalsAndIcons.xml`.
pub(super) fn terminals(model: &Model) -> Element {
    let mut left = Vec::new();
    let mut right = Vec::new();
    for terminal in &TERMINALS {
        let members: Vec<&DeclaredVariable> = members(model, terminal).collect();
        match members.first().map(|variable| variable.causality) {
            Some(DeclaredCausality::Input) => left.push((terminal, members)),
            Some(_) => right.push((terminal, members)),
            None => {}
        }
    }
    let side = |terminals: Vec<(&'static Terminal, Vec<&'static DeclaredVariable>)>, x: f64| {
        let count = terminals.len() as f64;
        terminals.into_iter().enumerate().map(move |(index, (terminal, members))| {
            let y = (100.0 - 200.0 * (index as f64 + 1.0) / (count + 1.0)).round();
            element(terminal, &members, [x - 10.0, y - 10.0, x + 10.0, y + 10.0])
        })
    };
    let extent = |element| corners(element, [-100.0, -100.0, 100.0, 100.0]);
    let picture = Element::new("GraphicalRepresentation")
        .child(extent(Element::new("CoordinateSystem")).with("suggestedScalingFactorTo_mm", "0.1"))
        .child(extent(Element::new("Icon")));
    Element::new("fmiTerminalsAndIcons").with("fmiVersion", "3.0").child(picture).child(
        Element::new("Terminals")
            .children(bus::terminal(model, [-120.0, -10.0, -100.0, 10.0]))
            .children(side(left, -110.0))
            .children(side(right, 110.0)),
    )
}

/// Lists the inputs and outputs that belong to a terminal.
fn members(model: &Model, terminal: &Terminal) -> impl Iterator<Item = &'static DeclaredVariable> {
    model.variables.iter().filter(|variable| {
        matches!(variable.causality, DeclaredCausality::Input | DeclaredCausality::Output)
            && terminal.prefixes.iter().any(|prefix| variable.name.starts_with(prefix))
    })
}

fn element(terminal: &Terminal, members: &[&DeclaredVariable], place: [f64; 4]) -> Element {
    let members = members.iter().map(|variable| {
        Element::new("TerminalMemberVariable")
            .with("variableName", variable.name)
            .with("memberName", variable.name)
            .with("variableKind", "signal")
    });
    Element::new("Terminal")
        .with("name", terminal.name)
        // Members are matched by name; a foreign model needn't have all of them.
        .with("matchingRule", "bus")
        .with("description", terminal.description)
        .children(members)
        .child(picture(place))
}
