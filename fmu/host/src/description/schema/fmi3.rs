//! The schemas of FMI 3.0 (`fmi3ModelDescription.xsd`, `fmi3BuildDescription.xsd`).

use super::fmi2::{BASE_UNIT, INITIAL, KINDS, NAMING, VARIABILITY};
use super::{Attribute, Child, Node, Open, Type, any, may, must, node, one, optional, some};

const CAUSALITY: Type = Type::Word(&[
    "parameter",
    "calculatedParameter",
    "input",
    "output",
    "local",
    "independent",
    "structuralParameter",
]);
const INTERVAL: Type =
    Type::Word(&["constant", "fixed", "tunable", "changing", "countdown", "triggered"]);

nodes! {
    /// The root element.
    pub MODEL_DESCRIPTION "fmiModelDescription" {
        must fmiVersion: Type::Version3;
        must modelName: Type::Text;
        must instantiationToken: Type::Line;
        may description author: Type::Text;
        may version: Type::Line;
        may copyright license: Type::Text;
        may generationTool: Type::Line;
        may generationDateAndTime: Type::DateTime;
        may variableNamingConvention: NAMING;
    } -> &[
        optional(0, &MODEL_EXCHANGE), optional(1, &CO_SIMULATION),
        optional(2, &SCHEDULED_EXECUTION), optional(3, &UNIT_DEFINITIONS),
        optional(4, &TYPE_DEFINITIONS), optional(5, &LOG_CATEGORIES),
        optional(6, &DEFAULT_EXPERIMENT), one(7, &MODEL_VARIABLES), one(8, &MODEL_STRUCTURE),
        optional(9, &ANNOTATIONS),
    ];
    pub(super) ANNOTATIONS "Annotations" {} -> &[some(0, &ANNOTATION)];
}

static ANNOTATION: Node = Node {
    name: "Annotation",
    attributes: &[must("type", Type::Line)],
    children: &[],
    open: Open::Everything,
};
const ANNOTATED: &[Child] = &[optional(0, &ANNOTATIONS)];

/// Common part of all interfaces.
macro_rules! interface {
    ($name:literal, [$($more:expr),*]) => {
        Node {
            name: $name,
            attributes: &[
                must("modelIdentifier", Type::Line),
                may("needsExecutionTool", Type::Boolean),
                may("canBeInstantiatedOnlyOncePerProcess", Type::Boolean),
                may("canGetAndSetFMUState", Type::Boolean),
                may("canSerializeFMUState", Type::Boolean),
                may("providesDirectionalDerivatives", Type::Boolean),
                may("providesAdjointDerivatives", Type::Boolean),
                may("providesPerElementDependencies", Type::Boolean),
                $($more),*
            ],
            children: ANNOTATED,
            open: Open::Attributes,
        }
    };
}

static MODEL_EXCHANGE: Node = interface!(
    "ModelExchange",
    [
        may("needsCompletedIntegratorStep", Type::Boolean),
        may("providesEvaluateDiscreteStates", Type::Boolean)
    ]
);
static CO_SIMULATION: Node = interface!(
    "CoSimulation",
    [
        may("canHandleVariableCommunicationStepSize", Type::Boolean),
        may("fixedInternalStepSize", Type::Double),
        may("maxOutputDerivativeOrder", Type::UNSIGNED_INT),
        may("recommendedIntermediateInputSmoothness", Type::INT),
        may("providesIntermediateUpdate", Type::Boolean),
        may("mightReturnEarlyFromDoStep", Type::Boolean),
        may("canReturnEarlyAfterIntermediateUpdate", Type::Boolean),
        may("hasEventMode", Type::Boolean),
        may("providesEvaluateDiscreteStates", Type::Boolean)
    ]
);
static SCHEDULED_EXECUTION: Node = interface!("ScheduledExecution", []);

nodes! {
    UNIT_DEFINITIONS "UnitDefinitions" {} -> &[some(0, &UNIT)];
    UNIT "Unit" {
        must name: Type::Line;
    } -> &[optional(0, &BASE_UNIT), any(1, &DISPLAY_UNIT), optional(2, &ANNOTATIONS)];
    DISPLAY_UNIT "DisplayUnit" {
        must name: Type::Line;
        may factor offset: Type::Double;
        may inverse: Type::Boolean;
    } -> ANNOTATED;

    LOG_CATEGORIES "LogCategories" {} -> &[some(0, &CATEGORY)];
    CATEGORY "Category" { must name: Type::Line; may description: Type::Text; } -> ANNOTATED;
    DEFAULT_EXPERIMENT "DefaultExperiment" {
        may startTime stopTime tolerance stepSize: Type::Double;
    } -> ANNOTATED;
}

/// A type of variables and its type definition: the attributes that both have, those of the
/// definition alone, and those of the variable alone.
macro_rules! typed {
    ($variable:ident $name:literal, $definition:ident $type_name:literal,
     both [$($both:expr),*], definition [$($own:expr),*], items $items:expr,
     variable [$($more:expr),*], children $children:expr) => {
        static $variable: Node = node(
            $name,
            &[
                must("name", Type::Line),
                must("valueReference", Type::UNSIGNED_INT),
                may("description", Type::Text),
                may("causality", CAUSALITY),
                may("variability", VARIABILITY),
                may("canHandleMultipleSetPerTimeInstant", Type::Boolean),
                may("clocks", Type::List(&Type::UNSIGNED_INT)),
                $($both,)*
                $($more),*
            ],
            $children,
        );
        static $definition: Node = node(
            $type_name,
            &[
                must("name", Type::Line),
                may("description", Type::Text),
                $($both,)*
                $($own),*
            ],
            $items,
        );
    };
}

const ARRAY: &[Child] = &[optional(0, &ANNOTATIONS), any(1, &DIMENSION), any(3, &ALIAS)];
const FLOAT_ARRAY: &[Child] =
    &[optional(0, &ANNOTATIONS), any(1, &DIMENSION), any(3, &FLOAT_ALIAS)];
const TEXT_ARRAY: &[Child] =
    &[optional(0, &ANNOTATIONS), any(1, &DIMENSION), any(2, &TEXT_START), any(3, &ALIAS)];
const HEX_ARRAY: &[Child] =
    &[optional(0, &ANNOTATIONS), any(1, &DIMENSION), any(2, &HEX_START), any(3, &ALIAS)];

nodes! {
    DIMENSION "Dimension" {
        may start: Type::UNSIGNED_LONG;
        may valueReference: Type::UNSIGNED_INT;
    };
    ALIAS "Alias" { must name: Type::Line; may description: Type::Text; };
    FLOAT_ALIAS "Alias" {
        must name: Type::Line;
        may description: Type::Text;
        may displayUnit: Type::Line;
    };
    TEXT_START "Start" { may value: Type::Text; };
    HEX_START "Start" { may value: Type::Hex; };
}

const DECLARED: Attribute = may("declaredType", Type::Line);
const INTERMEDIATE: Attribute = may("intermediateUpdate", Type::Boolean);
const PREVIOUS: Attribute = may("previous", Type::UNSIGNED_INT);
const INITIALIZED: Attribute = may("initial", INITIAL);

macro_rules! float {
    ($variable:ident $name:literal, $definition:ident $type_name:literal, $type:expr) => {
        typed!($variable $name, $definition $type_name,
            both [
                may("quantity", Type::Line),
                may("unit", Type::Line),
                may("displayUnit", Type::Line),
                may("relativeQuantity", Type::Boolean),
                may("unbounded", Type::Boolean),
                may("min", $type),
                may("max", $type),
                may("nominal", $type)
            ],
            definition [], items ANNOTATED,
            variable [
                DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED,
                may("start", Type::List(&$type)),
                may("derivative", Type::UNSIGNED_INT),
                may("reinit", Type::Boolean)
            ],
            children FLOAT_ARRAY);
    };
}

macro_rules! whole {
    ($variable:ident $name:literal, $definition:ident $type_name:literal, $type:expr) => {
        typed!($variable $name, $definition $type_name,
            both [may("quantity", Type::Line), may("min", $type), may("max", $type)],
            definition [], items ANNOTATED,
            variable [
                DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED, may("start", Type::List(&$type))
            ],
            children ARRAY);
    };
}

float!(FLOAT32 "Float32", FLOAT32_TYPE "Float32Type", Type::Float);
float!(FLOAT64 "Float64", FLOAT64_TYPE "Float64Type", Type::Double);
whole!(INT8 "Int8", INT8_TYPE "Int8Type", Type::BYTE);
whole!(UINT8 "UInt8", UINT8_TYPE "UInt8Type", Type::UNSIGNED_BYTE);
whole!(INT16 "Int16", INT16_TYPE "Int16Type", Type::SHORT);
whole!(UINT16 "UInt16", UINT16_TYPE "UInt16Type", Type::UNSIGNED_SHORT);
whole!(INT32 "Int32", INT32_TYPE "Int32Type", Type::INT);
whole!(UINT32 "UInt32", UINT32_TYPE "UInt32Type", Type::UNSIGNED_INT);
whole!(INT64 "Int64", INT64_TYPE "Int64Type", Type::LONG);
whole!(UINT64 "UInt64", UINT64_TYPE "UInt64Type", Type::UNSIGNED_LONG);
typed!(BOOLEAN "Boolean", BOOLEAN_TYPE "BooleanType",
    both [], definition [], items ANNOTATED,
    variable [
        DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED, may("start", Type::List(&Type::Boolean))
    ],
    children ARRAY);
typed!(STRING "String", STRING_TYPE "StringType",
    both [], definition [], items ANNOTATED,
    variable [DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED],
    children TEXT_ARRAY);
typed!(BINARY "Binary", BINARY_TYPE "BinaryType",
    both [may("mimeType", Type::Line), may("maxSize", Type::NON_NEGATIVE)],
    definition [], items ANNOTATED,
    variable [DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED],
    children HEX_ARRAY);
typed!(ENUMERATION "Enumeration", ENUMERATION_TYPE "EnumerationType",
    both [may("quantity", Type::Line), may("min", Type::LONG), may("max", Type::LONG)],
    definition [], items &[optional(0, &ANNOTATIONS), some(1, &ITEM)],
    variable [
        must("declaredType", Type::Line), INTERMEDIATE, PREVIOUS, INITIALIZED,
        may("start", Type::List(&Type::LONG))
    ],
    children ARRAY);
typed!(CLOCK "Clock", CLOCK_TYPE "ClockType",
    both [
        may("canBeDeactivated", Type::Boolean),
        may("priority", Type::UNSIGNED_INT),
        must("intervalVariability", INTERVAL),
        may("intervalDecimal", Type::Float),
        may("shiftDecimal", Type::Float),
        may("supportsFraction", Type::Boolean),
        may("resolution", Type::UNSIGNED_LONG),
        may("intervalCounter", Type::UNSIGNED_LONG),
        may("shiftCounter", Type::UNSIGNED_LONG)
    ],
    definition [], items ANNOTATED,
    variable [DECLARED],
    children &[optional(0, &ANNOTATIONS), any(1, &ALIAS)]);

nodes! {
    ITEM "Item" {
        must name: Type::Line;
        must value: Type::LONG;
        may description: Type::Text;
    } -> ANNOTATED;

    TYPE_DEFINITIONS "TypeDefinitions" {} -> &[
        some(0, &FLOAT32_TYPE), some(0, &FLOAT64_TYPE), some(0, &INT8_TYPE), some(0, &UINT8_TYPE),
        some(0, &INT16_TYPE), some(0, &UINT16_TYPE), some(0, &INT32_TYPE), some(0, &UINT32_TYPE),
        some(0, &INT64_TYPE), some(0, &UINT64_TYPE), some(0, &BOOLEAN_TYPE), some(0, &STRING_TYPE),
        some(0, &BINARY_TYPE), some(0, &ENUMERATION_TYPE), some(0, &CLOCK_TYPE),
    ];

    MODEL_VARIABLES "ModelVariables" {} -> &[
        some(0, &FLOAT32), some(0, &FLOAT64), some(0, &INT8), some(0, &UINT8), some(0, &INT16),
        some(0, &UINT16), some(0, &INT32), some(0, &UINT32), some(0, &INT64), some(0, &UINT64),
        some(0, &BOOLEAN), some(0, &STRING), some(0, &BINARY), some(0, &ENUMERATION),
        some(0, &CLOCK),
    ];

    MODEL_STRUCTURE "ModelStructure" {} -> &[
        any(0, &OUTPUT), any(1, &CONTINUOUS_STATE_DERIVATIVE), any(2, &CLOCKED_STATE),
        any(3, &INITIAL_UNKNOWN), any(4, &EVENT_INDICATOR),
    ];
}

const UNKNOWN: &[Attribute] = &[
    must("valueReference", Type::UNSIGNED_INT),
    may("dependencies", Type::List(&Type::UNSIGNED_INT)),
    may("dependenciesKind", KINDS),
];

nodes! {
    OUTPUT "Output" = UNKNOWN -> ANNOTATED;
    CONTINUOUS_STATE_DERIVATIVE "ContinuousStateDerivative" = UNKNOWN -> ANNOTATED;
    CLOCKED_STATE "ClockedState" = UNKNOWN -> ANNOTATED;
    INITIAL_UNKNOWN "InitialUnknown" = UNKNOWN -> ANNOTATED;
    EVENT_INDICATOR "EventIndicator" = UNKNOWN -> ANNOTATED;

    /// The root element of `sources/buildDescription.xml`.
    pub BUILD_DESCRIPTION "fmiBuildDescription" {
        must fmiVersion: Type::Version3;
    } -> &[some(0, &BUILD_CONFIGURATION), optional(1, &ANNOTATIONS)];
    BUILD_CONFIGURATION "BuildConfiguration" {
        must modelIdentifier: Type::Line;
        may platform: Type::Line;
        may description: Type::Text;
    } -> &[any(0, &SOURCE_FILE_SET), any(1, &LIBRARY), optional(2, &ANNOTATIONS)];
    SOURCE_FILE_SET "SourceFileSet" {
        may name language compiler: Type::Line;
        may compilerOptions: Type::Text;
    } -> &[
        some(0, &SOURCE_FILE), any(1, &PREPROCESSOR_DEFINITION), any(2, &INCLUDE_DIRECTORY),
        optional(3, &ANNOTATIONS),
    ];
    SOURCE_FILE "SourceFile" { must name: Type::Line; } -> ANNOTATED;
    INCLUDE_DIRECTORY "IncludeDirectory" { must name: Type::Line; } -> ANNOTATED;
    PREPROCESSOR_DEFINITION "PreprocessorDefinition" {
        must name: Type::Line;
        may optional: Type::Boolean;
        may value: Type::Line;
        may description: Type::Text;
    } -> &[any(0, &OPTION), optional(1, &ANNOTATIONS)];
    OPTION "Option" { may value: Type::Line; may description: Type::Text; };
    LIBRARY "Library" {
        must name: Type::Line;
        may version: Type::Line;
        may external: Type::Boolean;
        may description: Type::Text;
    } -> ANNOTATED;
}
