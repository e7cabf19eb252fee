//! The schema of FMI 2.0 (`fmi2ModelDescription.xsd`).

use super::{
    AttributeType, Child, ElementRule, MANY, Open, any, may, must, node, one, optional, some,
};

const CAUSALITY: AttributeType = AttributeType::Word(&[
    "parameter",
    "calculatedParameter",
    "input",
    "output",
    "local",
    "independent",
]);
pub(super) const VARIABILITY: AttributeType =
    AttributeType::Word(&["constant", "fixed", "tunable", "discrete", "continuous"]);
pub(super) const INITIAL: AttributeType = AttributeType::Word(&["exact", "approx", "calculated"]);
pub(super) const KINDS: AttributeType = AttributeType::List(&AttributeType::Word(&[
    "dependent",
    "constant",
    "fixed",
    "tunable",
    "discrete",
]));
pub(super) const NAMING: AttributeType = AttributeType::Word(&["flat", "structured"]);

nodes! {
    /// The root element.
    pub MODEL_DESCRIPTION "fmiModelDescription" {
        must fmiVersion: AttributeType::Word(&["2.0"]);
        must modelName: AttributeType::Text;
        must guid: AttributeType::Line;
        may description author: AttributeType::Text;
        may version: AttributeType::Line;
        may copyright license: AttributeType::Text;
        may generationTool: AttributeType::Line;
        may generationDateAndTime: AttributeType::DateTime;
        may variableNamingConvention: NAMING;
        may numberOfEventIndicators: AttributeType::UNSIGNED_INT;
    } -> &[
        // At least one of both, in any order.
        one(0, &MODEL_EXCHANGE), one(0, &CO_SIMULATION), optional(1, &UNIT_DEFINITIONS),
        optional(2, &TYPE_DEFINITIONS), optional(3, &LOG_CATEGORIES),
        optional(4, &DEFAULT_EXPERIMENT), optional(5, &VENDOR_ANNOTATIONS),
        one(6, &MODEL_VARIABLES), one(7, &MODEL_STRUCTURE),
    ];

    MODEL_EXCHANGE "ModelExchange" {
        must modelIdentifier: AttributeType::Line;
        may needsExecutionTool completedIntegratorStepNotNeeded canBeInstantiatedOnlyOncePerProcess
            canNotUseMemoryManagementFunctions canGetAndSetFMUstate canSerializeFMUstate
            providesDirectionalDerivative: AttributeType::Boolean;
    } -> &[optional(0, &SOURCE_FILES)];
    CO_SIMULATION "CoSimulation" {
        must modelIdentifier: AttributeType::Line;
        may needsExecutionTool canHandleVariableCommunicationStepSize
            canInterpolateInputs: AttributeType::Boolean;
        may maxOutputDerivativeOrder: AttributeType::UNSIGNED_INT;
        may canRunAsynchronuously canBeInstantiatedOnlyOncePerProcess
            canNotUseMemoryManagementFunctions canGetAndSetFMUstate canSerializeFMUstate
            providesDirectionalDerivative: AttributeType::Boolean;
    } -> &[optional(0, &SOURCE_FILES)];
    SOURCE_FILES "SourceFiles" {} -> &[some(0, &FILE)];
    FILE "File" { must name: AttributeType::Line; };

    UNIT_DEFINITIONS "UnitDefinitions" {} -> &[some(0, &UNIT)];
    UNIT "Unit" { must name: AttributeType::Line; } -> &[optional(0, &BASE_UNIT), any(1, &DISPLAY_UNIT)];
    pub(super) BASE_UNIT "BaseUnit" {
        may kg m s A K mol cd rad: AttributeType::INT;
        may factor offset: AttributeType::Double;
    };
    DISPLAY_UNIT "DisplayUnit" { must name: AttributeType::Line; may factor offset: AttributeType::Double; };

    TYPE_DEFINITIONS "TypeDefinitions" {} -> &[some(0, &SIMPLE_TYPE)];
    SIMPLE_TYPE "SimpleType" {
        must name: AttributeType::Line;
        may description: AttributeType::Text;
    } -> &[
        one(0, &REAL_TYPE), one(0, &INTEGER_TYPE), one(0, &BOOLEAN_TYPE), one(0, &STRING_TYPE),
        one(0, &ENUMERATION_TYPE),
    ];
    REAL_TYPE "Real" {
        may quantity unit displayUnit: AttributeType::Line;
        may relativeQuantity: AttributeType::Boolean;
        may min max nominal: AttributeType::Double;
        may unbounded: AttributeType::Boolean;
    };
    INTEGER_TYPE "Integer" { may quantity: AttributeType::Line; may min max: AttributeType::INT; };
    ENUMERATION_TYPE "Enumeration" { may quantity: AttributeType::Line; } -> &[some(0, &ITEM)];
    ITEM "Item" { must name: AttributeType::Line; must value: AttributeType::INT; may description: AttributeType::Text; };

    LOG_CATEGORIES "LogCategories" {} -> &[some(0, &CATEGORY)];
    CATEGORY "Category" { must name: AttributeType::Line; may description: AttributeType::Text; };
    DEFAULT_EXPERIMENT "DefaultExperiment" {
        may startTime stopTime tolerance stepSize: AttributeType::Double;
    };
    VENDOR_ANNOTATIONS "VendorAnnotations" {} -> &[some(0, &TOOL)];
    ANNOTATIONS "Annotations" {} -> &[some(0, &TOOL)];

    MODEL_VARIABLES "ModelVariables" {} -> &[some(0, &SCALAR_VARIABLE)];
    SCALAR_VARIABLE "ScalarVariable" {
        must name: AttributeType::Line;
        must valueReference: AttributeType::UNSIGNED_INT;
        may description: AttributeType::Text;
        may causality: CAUSALITY;
        may variability: VARIABILITY;
        may initial: INITIAL;
        may canHandleMultipleSetPerTimeInstant: AttributeType::Boolean;
    } -> &[
        one(0, &REAL), one(0, &INTEGER), one(0, &BOOLEAN), one(0, &STRING), one(0, &ENUMERATION),
        optional(1, &ANNOTATIONS),
    ];
    REAL "Real" {
        may declaredType quantity unit displayUnit: AttributeType::Line;
        may relativeQuantity: AttributeType::Boolean;
        may min max nominal: AttributeType::Double;
        may unbounded: AttributeType::Boolean;
        may start: AttributeType::Double;
        may derivative: AttributeType::UNSIGNED_INT;
        may reinit: AttributeType::Boolean;
    };
    INTEGER "Integer" { may declaredType quantity: AttributeType::Line; may min max start: AttributeType::INT; };
    BOOLEAN "Boolean" { may declaredType: AttributeType::Line; may start: AttributeType::Boolean; };
    STRING "String" { may declaredType: AttributeType::Line; may start: AttributeType::Text; };
    ENUMERATION "Enumeration" {
        must declaredType: AttributeType::Line;
        may quantity: AttributeType::Line;
        may min max start: AttributeType::INT;
    };

    MODEL_STRUCTURE "ModelStructure" {} -> &[
        optional(0, &OUTPUTS), optional(1, &DERIVATIVES), optional(2, &INITIAL_UNKNOWNS),
    ];
    OUTPUTS "Outputs" {} -> UNKNOWNS;
    DERIVATIVES "Derivatives" {} -> UNKNOWNS;
    INITIAL_UNKNOWNS "InitialUnknowns" {} -> UNKNOWNS;
    UNKNOWN "Unknown" {
        must index: AttributeType::UNSIGNED_INT;
        may dependencies: AttributeType::List(&AttributeType::UNSIGNED_INT);
        may dependenciesKind: KINDS;
    };
}

// The schema gives no type at all to these two.
static BOOLEAN_TYPE: ElementRule =
    ElementRule { name: "Boolean", attributes: &[], children: &[], open: Open::Everything };
static STRING_TYPE: ElementRule =
    ElementRule { name: "String", attributes: &[], children: &[], open: Open::Everything };

static TOOL: ElementRule = ElementRule {
    name: "Tool",
    attributes: &[must("name", AttributeType::Line)],
    children: &[],
    open: Open::Everything,
};

const UNKNOWNS: &[Child] = &[Child { node: &UNKNOWN, place: 0, min: 1, max: MANY }];
