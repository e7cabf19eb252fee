//! The schema of `terminalsAndIcons.xml` (`fmi3TerminalsAndIcons.xsd`).

use super::fmi3::ANNOTATIONS;
use super::{Node, Type, any, may, must, node, optional, some};

/// The root element.
pub static TERMINALS_AND_ICONS: Node = node(
    "fmiTerminalsAndIcons",
    &[must("fmiVersion", Type::Version3)],
    &[optional(0, &GRAPHICAL_REPRESENTATION), optional(1, &TERMINALS), optional(2, &ANNOTATIONS)],
);
static GRAPHICAL_REPRESENTATION: Node = node(
    "GraphicalRepresentation",
    &[],
    &[optional(0, &COORDINATE_SYSTEM), optional(1, &ICON), optional(2, &ANNOTATIONS)],
);
static COORDINATE_SYSTEM: Node = node(
    "CoordinateSystem",
    &[
        must("x1", Type::Double),
        must("y1", Type::Double),
        must("x2", Type::Double),
        must("y2", Type::Double),
        must("suggestedScalingFactorTo_mm", Type::Double),
    ],
    &[],
);
static ICON: Node = node(
    "Icon",
    &[
        must("x1", Type::Double),
        must("y1", Type::Double),
        must("x2", Type::Double),
        must("y2", Type::Double),
    ],
    &[],
);
static TERMINALS: Node = node("Terminals", &[], &[some(0, &TERMINAL)]);
static TERMINAL: Node = node(
    "Terminal",
    &[
        must("name", Type::Line),
        must("matchingRule", Type::Line),
        may("terminalKind", Type::Line),
        may("description", Type::Text),
    ],
    &[
        any(0, &MEMBER),
        any(1, &STREAM_MEMBER),
        any(2, &TERMINAL),
        optional(3, &TERMINAL_GRAPHIC),
        optional(4, &ANNOTATIONS),
    ],
);
static MEMBER: Node = node(
    "TerminalMemberVariable",
    &[
        must("variableName", Type::Line),
        may("memberName", Type::Line),
        must("variableKind", Type::Line),
    ],
    &[optional(0, &ANNOTATIONS)],
);
static STREAM_MEMBER: Node = node(
    "TerminalStreamMemberVariable",
    &[
        must("inStreamMemberName", Type::Line),
        must("outStreamMemberName", Type::Line),
        must("inStreamVariableName", Type::Line),
        must("outStreamVariableName", Type::Line),
    ],
    &[optional(0, &ANNOTATIONS)],
);
static TERMINAL_GRAPHIC: Node = node(
    "TerminalGraphicalRepresentation",
    &[
        may("defaultConnectionColor", Type::List(&Type::UNSIGNED_BYTE)),
        may("defaultConnectionStrokeSize", Type::Double),
        must("x1", Type::Double),
        must("y1", Type::Double),
        must("x2", Type::Double),
        must("y2", Type::Double),
        must("iconBaseName", Type::Text),
    ],
    &[optional(0, &ANNOTATIONS)],
);
