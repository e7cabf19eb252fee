//! The schema of `terminalsAndIcons.xml` (`fmi3TerminalsAndIcons.xsd`).

use super::fmi3::ANNOTATIONS;
use super::{AttributeType, ElementRule, any, may, must, node, optional, some};

/// The root element.
pub static TERMINALS_AND_ICONS: ElementRule = node(
    "fmiTerminalsAndIcons",
    &[must("fmiVersion", AttributeType::Version3)],
    &[optional(0, &GRAPHICAL_REPRESENTATION), optional(1, &TERMINALS), optional(2, &ANNOTATIONS)],
);
static GRAPHICAL_REPRESENTATION: ElementRule = node(
    "GraphicalRepresentation",
    &[],
    &[optional(0, &COORDINATE_SYSTEM), optional(1, &ICON), optional(2, &ANNOTATIONS)],
);
static COORDINATE_SYSTEM: ElementRule = node(
    "CoordinateSystem",
    &[
        must("x1", AttributeType::Double),
        must("y1", AttributeType::Double),
        must("x2", AttributeType::Double),
        must("y2", AttributeType::Double),
        must("suggestedScalingFactorTo_mm", AttributeType::Double),
    ],
    &[],
);
static ICON: ElementRule = node(
    "Icon",
    &[
        must("x1", AttributeType::Double),
        must("y1", AttributeType::Double),
        must("x2", AttributeType::Double),
        must("y2", AttributeType::Double),
    ],
    &[],
);
static TERMINALS: ElementRule = node("Terminals", &[], &[some(0, &TERMINAL)]);
static TERMINAL: ElementRule = node(
    "Terminal",
    &[
        must("name", AttributeType::Line),
        must("matchingRule", AttributeType::Line),
        may("terminalKind", AttributeType::Line),
        may("description", AttributeType::Text),
    ],
    &[
        any(0, &MEMBER),
        any(1, &STREAM_MEMBER),
        any(2, &TERMINAL),
        optional(3, &TERMINAL_GRAPHIC),
        optional(4, &ANNOTATIONS),
    ],
);
static MEMBER: ElementRule = node(
    "TerminalMemberVariable",
    &[
        must("variableName", AttributeType::Line),
        may("memberName", AttributeType::Line),
        must("variableKind", AttributeType::Line),
    ],
    &[optional(0, &ANNOTATIONS)],
);
static STREAM_MEMBER: ElementRule = node(
    "TerminalStreamMemberVariable",
    &[
        must("inStreamMemberName", AttributeType::Line),
        must("outStreamMemberName", AttributeType::Line),
        must("inStreamVariableName", AttributeType::Line),
        must("outStreamVariableName", AttributeType::Line),
    ],
    &[optional(0, &ANNOTATIONS)],
);
static TERMINAL_GRAPHIC: ElementRule = node(
    "TerminalGraphicalRepresentation",
    &[
        may("defaultConnectionColor", AttributeType::List(&AttributeType::UNSIGNED_BYTE)),
        may("defaultConnectionStrokeSize", AttributeType::Double),
        must("x1", AttributeType::Double),
        must("y1", AttributeType::Double),
        must("x2", AttributeType::Double),
        must("y2", AttributeType::Double),
        must("iconBaseName", AttributeType::Text),
    ],
    &[optional(0, &ANNOTATIONS)],
);
