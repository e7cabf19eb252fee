//! The schema of `terminalsAndIcons.xml` (`fmi3TerminalsAndIcons.xsd`).

use super::fmi3::ANNOTATIONS;
use super::{AttributeType, ElementRule, any, may, must, node, optional, some};

nodes! {
    /// The root element.
    pub TERMINALS_AND_ICONS "fmiTerminalsAndIcons" {
        must fmiVersion: AttributeType::Version3;
    } -> &[
        optional(0, &GRAPHICAL_REPRESENTATION), optional(1, &TERMINALS), optional(2, &ANNOTATIONS),
    ];
    GRAPHICAL_REPRESENTATION "GraphicalRepresentation" {} -> &[
        optional(0, &COORDINATE_SYSTEM), optional(1, &ICON), optional(2, &ANNOTATIONS),
    ];
    COORDINATE_SYSTEM "CoordinateSystem" {
        must x1 y1 x2 y2 suggestedScalingFactorTo_mm: AttributeType::Double;
    };
    ICON "Icon" { must x1 y1 x2 y2: AttributeType::Double; };
    TERMINALS "Terminals" {} -> &[some(0, &TERMINAL)];
    TERMINAL "Terminal" {
        must name matchingRule: AttributeType::Line;
        may terminalKind: AttributeType::Line;
        may description: AttributeType::Text;
    } -> &[
        any(0, &MEMBER), any(1, &STREAM_MEMBER), any(2, &TERMINAL), optional(3, &TERMINAL_GRAPHIC),
        optional(4, &ANNOTATIONS),
    ];
    MEMBER "TerminalMemberVariable" {
        must variableName: AttributeType::Line;
        may memberName: AttributeType::Line;
        must variableKind: AttributeType::Line;
    } -> &[optional(0, &ANNOTATIONS)];
    STREAM_MEMBER "TerminalStreamMemberVariable" {
        must inStreamMemberName outStreamMemberName inStreamVariableName
            outStreamVariableName: AttributeType::Line;
    } -> &[optional(0, &ANNOTATIONS)];
    TERMINAL_GRAPHIC "TerminalGraphicalRepresentation" {
        may defaultConnectionColor: AttributeType::List(&AttributeType::UNSIGNED_BYTE);
        may defaultConnectionStrokeSize: AttributeType::Double;
        must x1 y1 x2 y2: AttributeType::Double;
        must iconBaseName: AttributeType::Text;
    } -> &[optional(0, &ANNOTATIONS)];
}
