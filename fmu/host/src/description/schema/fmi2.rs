//! The schema of FMI 2.0 (`fmi2ModelDescription.xsd`).

use super::{Child, MANY, Node, Open, Type, any, may, must, node, one, optional, some};

const CAUSALITY: Type =
    Type::Word(&["parameter", "calculatedParameter", "input", "output", "local", "independent"]);
pub(super) const VARIABILITY: Type =
    Type::Word(&["constant", "fixed", "tunable", "discrete", "continuous"]);
pub(super) const INITIAL: Type = Type::Word(&["exact", "approx", "calculated"]);
pub(super) const KINDS: Type =
    Type::List(&Type::Word(&["dependent", "constant", "fixed", "tunable", "discrete"]));
pub(super) const NAMING: Type = Type::Word(&["flat", "structured"]);

nodes! {
    /// The root element.
    pub MODEL_DESCRIPTION "fmiModelDescription" {
        must fmiVersion: Type::Word(&["2.0"]);
        must modelName: Type::Text;
        must guid: Type::Line;
        may description author: Type::Text;
        may version: Type::Line;
        may copyright license: Type::Text;
        may generationTool: Type::Line;
        may generationDateAndTime: Type::DateTime;
        may variableNamingConvention: NAMING;
        may numberOfEventIndicators: Type::UNSIGNED_INT;
    } -> &[
        // At least one of both, in any order.
        one(0, &MODEL_EXCHANGE), one(0, &CO_SIMULATION), optional(1, &UNIT_DEFINITIONS),
        optional(2, &TYPE_DEFINITIONS), optional(3, &LOG_CATEGORIES),
        optional(4, &DEFAULT_EXPERIMENT), optional(5, &VENDOR_ANNOTATIONS),
        one(6, &MODEL_VARIABLES), one(7, &MODEL_STRUCTURE),
    ];

    MODEL_EXCHANGE "ModelExchange" {
        must modelIdentifier: Type::Line;
        may needsExecutionTool completedIntegratorStepNotNeeded canBeInstantiatedOnlyOncePerProcess
            canNotUseMemoryManagementFunctions canGetAndSetFMUstate canSerializeFMUstate
            providesDirectionalDerivative: Type::Boolean;
    } -> &[optional(0, &SOURCE_FILES)];
    CO_SIMULATION "CoSimulation" {
        must modelIdentifier: Type::Line;
        may needsExecutionTool canHandleVariableCommunicationStepSize
            canInterpolateInputs: Type::Boolean;
        may maxOutputDerivativeOrder: Type::UNSIGNED_INT;
        may canRunAsynchronuously canBeInstantiatedOnlyOncePerProcess
            canNotUseMemoryManagementFunctions canGetAndSetFMUstate canSerializeFMUstate
            providesDirectionalDerivative: Type::Boolean;
    } -> &[optional(0, &SOURCE_FILES)];
    SOURCE_FILES "SourceFiles" {} -> &[some(0, &FILE)];
    FILE "File" { must name: Type::Line; };

    UNIT_DEFINITIONS "UnitDefinitions" {} -> &[some(0, &UNIT)];
    UNIT "Unit" { must name: Type::Line; } -> &[optional(0, &BASE_UNIT), any(1, &DISPLAY_UNIT)];
    pub(super) BASE_UNIT "BaseUnit" {
        may kg m s A K mol cd rad: Type::INT;
        may factor offset: Type::Double;
    };
    DISPLAY_UNIT "DisplayUnit" { must name: Type::Line; may factor offset: Type::Double; };

    TYPE_DEFINITIONS "TypeDefinitions" {} -> &[some(0, &SIMPLE_TYPE)];
    SIMPLE_TYPE "SimpleType" {
        must name: Type::Line;
        may description: Type::Text;
    } -> &[
        one(0, &REAL_TYPE), one(0, &INTEGER_TYPE), one(0, &BOOLEAN_TYPE), one(0, &STRING_TYPE),
        one(0, &ENUMERATION_TYPE),
    ];
    REAL_TYPE "Real" {
        may quantity unit displayUnit: Type::Line;
        may relativeQuantity: Type::Boolean;
        may min max nominal: Type::Double;
        may unbounded: Type::Boolean;
    };
    INTEGER_TYPE "Integer" { may quantity: Type::Line; may min max: Type::INT; };
    ENUMERATION_TYPE "Enumeration" { may quantity: Type::Line; } -> &[some(0, &ITEM)];
    ITEM "Item" { must name: Type::Line; must value: Type::INT; may description: Type::Text; };

    LOG_CATEGORIES "LogCategories" {} -> &[some(0, &CATEGORY)];
    CATEGORY "Category" { must name: Type::Line; may description: Type::Text; };
    DEFAULT_EXPERIMENT "DefaultExperiment" {
        may startTime stopTime tolerance stepSize: Type::Double;
    };
    VENDOR_ANNOTATIONS "VendorAnnotations" {} -> &[some(0, &TOOL)];
    ANNOTATIONS "Annotations" {} -> &[some(0, &TOOL)];

    MODEL_VARIABLES "ModelVariables" {} -> &[some(0, &SCALAR_VARIABLE)];
    SCALAR_VARIABLE "ScalarVariable" {
        must name: Type::Line;
        must valueReference: Type::UNSIGNED_INT;
        may description: Type::Text;
        may causality: CAUSALITY;
        may variability: VARIABILITY;
        may initial: INITIAL;
        may canHandleMultipleSetPerTimeInstant: Type::Boolean;
    } -> &[
        one(0, &REAL), one(0, &INTEGER), one(0, &BOOLEAN), one(0, &STRING), one(0, &ENUMERATION),
        optional(1, &ANNOTATIONS),
    ];
    REAL "Real" {
        may declaredType quantity unit displayUnit: Type::Line;
        may relativeQuantity: Type::Boolean;
        may min max nominal: Type::Double;
        may unbounded: Type::Boolean;
        may start: Type::Double;
        may derivative: Type::UNSIGNED_INT;
        may reinit: Type::Boolean;
    };
    INTEGER "Integer" { may declaredType quantity: Type::Line; may min max start: Type::INT; };
    BOOLEAN "Boolean" { may declaredType: Type::Line; may start: Type::Boolean; };
    STRING "String" { may declaredType: Type::Line; may start: Type::Text; };
    ENUMERATION "Enumeration" {
        must declaredType: Type::Line;
        may quantity: Type::Line;
        may min max start: Type::INT;
    };

    MODEL_STRUCTURE "ModelStructure" {} -> &[
        optional(0, &OUTPUTS), optional(1, &DERIVATIVES), optional(2, &INITIAL_UNKNOWNS),
    ];
    OUTPUTS "Outputs" {} -> UNKNOWNS;
    DERIVATIVES "Derivatives" {} -> UNKNOWNS;
    INITIAL_UNKNOWNS "InitialUnknowns" {} -> UNKNOWNS;
    UNKNOWN "Unknown" {
        must index: Type::UNSIGNED_INT;
        may dependencies: Type::List(&Type::UNSIGNED_INT);
        may dependenciesKind: KINDS;
    };
}

// The schema gives no type at all to these two.
static BOOLEAN_TYPE: Node =
    Node { name: "Boolean", attributes: &[], children: &[], open: Open::Everything };
static STRING_TYPE: Node =
    Node { name: "String", attributes: &[], children: &[], open: Open::Everything };

static TOOL: Node = Node {
    name: "Tool",
    attributes: &[must("name", Type::Line)],
    children: &[],
    open: Open::Everything,
};

const UNKNOWNS: &[Child] = &[Child { node: &UNKNOWN, place: 0, min: 1, max: MANY }];
