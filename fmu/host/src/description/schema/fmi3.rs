//! The schemas of FMI 3.0 (`fmi3ModelDescription.xsd`, `fmi3BuildDescription.xsd`).

use super::fmi2::{BASE_UNIT, INITIAL, KINDS, NAMING, VARIABILITY};
use super::{
    AttributeRule, AttributeType, Child, ElementRule, Open, any, may, must, node, one, optional,
    some,
};

const CAUSALITY: AttributeType = AttributeType::Word(&[
    "parameter",
    "calculatedParameter",
    "input",
    "output",
    "local",
    "independent",
    "structuralParameter",
]);
const INTERVAL: AttributeType =
    AttributeType::Word(&["constant", "fixed", "tunable", "changing", "countdown", "triggered"]);

/// The root element.
pub static MODEL_DESCRIPTION: ElementRule = node(
    "fmiModelDescription",
    &[
        must("fmiVersion", AttributeType::Version3),
        must("modelName", AttributeType::Text),
        must("instantiationToken", AttributeType::Line),
        may("description", AttributeType::Text),
        may("author", AttributeType::Text),
        may("version", AttributeType::Line),
        may("copyright", AttributeType::Text),
        may("license", AttributeType::Text),
        may("generationTool", AttributeType::Line),
        may("generationDateAndTime", AttributeType::DateTime),
        may("variableNamingConvention", NAMING),
    ],
    &[
        optional(0, &MODEL_EXCHANGE),
        optional(1, &CO_SIMULATION),
        optional(2, &SCHEDULED_EXECUTION),
        optional(3, &UNIT_DEFINITIONS),
        optional(4, &TYPE_DEFINITIONS),
        optional(5, &LOG_CATEGORIES),
        optional(6, &DEFAULT_EXPERIMENT),
        one(7, &MODEL_VARIABLES),
        one(8, &MODEL_STRUCTURE),
        optional(9, &ANNOTATIONS),
    ],
);

pub(super) static ANNOTATIONS: ElementRule = node("Annotations", &[], &[some(0, &ANNOTATION)]);
static ANNOTATION: ElementRule = ElementRule {
    name: "Annotation",
    attributes: &[must("type", AttributeType::Line)],
    children: &[],
    open: Open::Everything,
};
const ANNOTATED: &[Child] = &[optional(0, &ANNOTATIONS)];

/// Common part of all interfaces.
macro_rules! interface {
    ($name:literal, [$($more:expr),*]) => {
        ElementRule {
            name: $name,
            attributes: &[
                must("modelIdentifier", AttributeType::Line),
                may("needsExecutionTool", AttributeType::Boolean),
                may("canBeInstantiatedOnlyOncePerProcess", AttributeType::Boolean),
                may("canGetAndSetFMUState", AttributeType::Boolean),
                may("canSerializeFMUState", AttributeType::Boolean),
                may("providesDirectionalDerivatives", AttributeType::Boolean),
                may("providesAdjointDerivatives", AttributeType::Boolean),
                may("providesPerElementDependencies", AttributeType::Boolean),
                $($more),*
            ],
            children: ANNOTATED,
            open: Open::Attributes,
        }
    };
}

static MODEL_EXCHANGE: ElementRule = interface!(
    "ModelExchange",
    [
        may("needsCompletedIntegratorStep", AttributeType::Boolean),
        may("providesEvaluateDiscreteStates", AttributeType::Boolean)
    ]
);
static CO_SIMULATION: ElementRule = interface!(
    "CoSimulation",
    [
        may("canHandleVariableCommunicationStepSize", AttributeType::Boolean),
        may("fixedInternalStepSize", AttributeType::Double),
        may("maxOutputDerivativeOrder", AttributeType::UNSIGNED_INT),
        may("recommendedIntermediateInputSmoothness", AttributeType::INT),
        may("providesIntermediateUpdate", AttributeType::Boolean),
        may("mightReturnEarlyFromDoStep", AttributeType::Boolean),
        may("canReturnEarlyAfterIntermediateUpdate", AttributeType::Boolean),
        may("hasEventMode", AttributeType::Boolean),
        may("providesEvaluateDiscreteStates", AttributeType::Boolean)
    ]
);
static SCHEDULED_EXECUTION: ElementRule = interface!("ScheduledExecution", []);

static UNIT_DEFINITIONS: ElementRule = node("UnitDefinitions", &[], &[some(0, &UNIT)]);
static UNIT: ElementRule = node(
    "Unit",
    &[must("name", AttributeType::Line)],
    &[optional(0, &BASE_UNIT), any(1, &DISPLAY_UNIT), optional(2, &ANNOTATIONS)],
);
static DISPLAY_UNIT: ElementRule = node(
    "DisplayUnit",
    &[
        must("name", AttributeType::Line),
        may("factor", AttributeType::Double),
        may("offset", AttributeType::Double),
        may("inverse", AttributeType::Boolean),
    ],
    ANNOTATED,
);

static LOG_CATEGORIES: ElementRule = node("LogCategories", &[], &[some(0, &CATEGORY)]);
static CATEGORY: ElementRule = node(
    "Category",
    &[must("name", AttributeType::Line), may("description", AttributeType::Text)],
    ANNOTATED,
);
static DEFAULT_EXPERIMENT: ElementRule = node(
    "DefaultExperiment",
    &[
        may("startTime", AttributeType::Double),
        may("stopTime", AttributeType::Double),
        may("tolerance", AttributeType::Double),
        may("stepSize", AttributeType::Double),
    ],
    ANNOTATED,
);

/// A type of variables and its type definition: the attributes that both have, those of the
/// definition alone, and those of the variable alone.
macro_rules! typed {
    ($variable:ident $name:literal, $definition:ident $type_name:literal,
     both [$($both:expr),*], definition [$($own:expr),*], items $items:expr,
     variable [$($more:expr),*], children $children:expr) => {
        static $variable: ElementRule = node(
            $name,
            &[
                must("name", AttributeType::Line),
                must("valueReference", AttributeType::UNSIGNED_INT),
                may("description", AttributeType::Text),
                may("causality", CAUSALITY),
                may("variability", VARIABILITY),
                may("canHandleMultipleSetPerTimeInstant", AttributeType::Boolean),
                may("clocks", AttributeType::List(&AttributeType::UNSIGNED_INT)),
                $($both,)*
                $($more),*
            ],
            $children,
        );
        static $definition: ElementRule = node(
            $type_name,
            &[
                must("name", AttributeType::Line),
                may("description", AttributeType::Text),
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

static DIMENSION: ElementRule = node(
    "Dimension",
    &[
        may("start", AttributeType::UNSIGNED_LONG),
        may("valueReference", AttributeType::UNSIGNED_INT),
    ],
    &[],
);
static ALIAS: ElementRule = node(
    "Alias",
    &[must("name", AttributeType::Line), may("description", AttributeType::Text)],
    &[],
);
static FLOAT_ALIAS: ElementRule = node(
    "Alias",
    &[
        must("name", AttributeType::Line),
        may("description", AttributeType::Text),
        may("displayUnit", AttributeType::Line),
    ],
    &[],
);
static TEXT_START: ElementRule = node("Start", &[may("value", AttributeType::Text)], &[]);
static HEX_START: ElementRule = node("Start", &[may("value", AttributeType::Hex)], &[]);

const DECLARED: AttributeRule = may("declaredType", AttributeType::Line);
const INTERMEDIATE: AttributeRule = may("intermediateUpdate", AttributeType::Boolean);
const PREVIOUS: AttributeRule = may("previous", AttributeType::UNSIGNED_INT);
const INITIALIZED: AttributeRule = may("initial", INITIAL);

macro_rules! float {
    ($variable:ident $name:literal, $definition:ident $type_name:literal, $type:expr) => {
        typed!($variable $name, $definition $type_name,
            both [
                may("quantity", AttributeType::Line),
                may("unit", AttributeType::Line),
                may("displayUnit", AttributeType::Line),
                may("relativeQuantity", AttributeType::Boolean),
                may("unbounded", AttributeType::Boolean),
                may("min", $type),
                may("max", $type),
                may("nominal", $type)
            ],
            definition [], items ANNOTATED,
            variable [
                DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED,
                may("start", AttributeType::List(&$type)),
                may("derivative", AttributeType::UNSIGNED_INT),
                may("reinit", AttributeType::Boolean)
            ],
            children FLOAT_ARRAY);
    };
}

macro_rules! whole {
    ($variable:ident $name:literal, $definition:ident $type_name:literal, $type:expr) => {
        typed!($variable $name, $definition $type_name,
            both [may("quantity", AttributeType::Line), may("min", $type), may("max", $type)],
            definition [], items ANNOTATED,
            variable [
                DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED, may("start", AttributeType::List(&$type))
            ],
            children ARRAY);
    };
}

float!(FLOAT32 "Float32", FLOAT32_TYPE "Float32Type", AttributeType::Float);
float!(FLOAT64 "Float64", FLOAT64_TYPE "Float64Type", AttributeType::Double);
whole!(INT8 "Int8", INT8_TYPE "Int8Type", AttributeType::BYTE);
whole!(UINT8 "UInt8", UINT8_TYPE "UInt8Type", AttributeType::UNSIGNED_BYTE);
whole!(INT16 "Int16", INT16_TYPE "Int16Type", AttributeType::SHORT);
whole!(UINT16 "UInt16", UINT16_TYPE "UInt16Type", AttributeType::UNSIGNED_SHORT);
whole!(INT32 "Int32", INT32_TYPE "Int32Type", AttributeType::INT);
whole!(UINT32 "UInt32", UINT32_TYPE "UInt32Type", AttributeType::UNSIGNED_INT);
whole!(INT64 "Int64", INT64_TYPE "Int64Type", AttributeType::LONG);
whole!(UINT64 "UInt64", UINT64_TYPE "UInt64Type", AttributeType::UNSIGNED_LONG);
typed!(BOOLEAN "Boolean", BOOLEAN_TYPE "BooleanType",
    both [], definition [], items ANNOTATED,
    variable [
        DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED, may("start", AttributeType::List(&AttributeType::Boolean))
    ],
    children ARRAY);
typed!(STRING "String", STRING_TYPE "StringType",
    both [], definition [], items ANNOTATED,
    variable [DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED],
    children TEXT_ARRAY);
typed!(BINARY "Binary", BINARY_TYPE "BinaryType",
    both [may("mimeType", AttributeType::Line), may("maxSize", AttributeType::NON_NEGATIVE)],
    definition [], items ANNOTATED,
    variable [DECLARED, INTERMEDIATE, PREVIOUS, INITIALIZED],
    children HEX_ARRAY);
typed!(ENUMERATION "Enumeration", ENUMERATION_TYPE "EnumerationType",
    both [may("quantity", AttributeType::Line), may("min", AttributeType::LONG), may("max", AttributeType::LONG)],
    definition [], items &[optional(0, &ANNOTATIONS), some(1, &ITEM)],
    variable [
        must("declaredType", AttributeType::Line), INTERMEDIATE, PREVIOUS, INITIALIZED,
        may("start", AttributeType::List(&AttributeType::LONG))
    ],
    children ARRAY);
typed!(CLOCK "Clock", CLOCK_TYPE "ClockType",
    both [
        may("canBeDeactivated", AttributeType::Boolean),
        may("priority", AttributeType::UNSIGNED_INT),
        must("intervalVariability", INTERVAL),
        may("intervalDecimal", AttributeType::Float),
        may("shiftDecimal", AttributeType::Float),
        may("supportsFraction", AttributeType::Boolean),
        may("resolution", AttributeType::UNSIGNED_LONG),
        may("intervalCounter", AttributeType::UNSIGNED_LONG),
        may("shiftCounter", AttributeType::UNSIGNED_LONG)
    ],
    definition [], items ANNOTATED,
    variable [DECLARED],
    children &[optional(0, &ANNOTATIONS), any(1, &ALIAS)]);

static ITEM: ElementRule = node(
    "Item",
    &[
        must("name", AttributeType::Line),
        must("value", AttributeType::LONG),
        may("description", AttributeType::Text),
    ],
    ANNOTATED,
);

static TYPE_DEFINITIONS: ElementRule = node(
    "TypeDefinitions",
    &[],
    &[
        some(0, &FLOAT32_TYPE),
        some(0, &FLOAT64_TYPE),
        some(0, &INT8_TYPE),
        some(0, &UINT8_TYPE),
        some(0, &INT16_TYPE),
        some(0, &UINT16_TYPE),
        some(0, &INT32_TYPE),
        some(0, &UINT32_TYPE),
        some(0, &INT64_TYPE),
        some(0, &UINT64_TYPE),
        some(0, &BOOLEAN_TYPE),
        some(0, &STRING_TYPE),
        some(0, &BINARY_TYPE),
        some(0, &ENUMERATION_TYPE),
        some(0, &CLOCK_TYPE),
    ],
);
static MODEL_VARIABLES: ElementRule = node(
    "ModelVariables",
    &[],
    &[
        some(0, &FLOAT32),
        some(0, &FLOAT64),
        some(0, &INT8),
        some(0, &UINT8),
        some(0, &INT16),
        some(0, &UINT16),
        some(0, &INT32),
        some(0, &UINT32),
        some(0, &INT64),
        some(0, &UINT64),
        some(0, &BOOLEAN),
        some(0, &STRING),
        some(0, &BINARY),
        some(0, &ENUMERATION),
        some(0, &CLOCK),
    ],
);

static MODEL_STRUCTURE: ElementRule = node(
    "ModelStructure",
    &[],
    &[
        any(0, &OUTPUT),
        any(1, &CONTINUOUS_STATE_DERIVATIVE),
        any(2, &CLOCKED_STATE),
        any(3, &INITIAL_UNKNOWN),
        any(4, &EVENT_INDICATOR),
    ],
);
const UNKNOWN: &[AttributeRule] = &[
    must("valueReference", AttributeType::UNSIGNED_INT),
    may("dependencies", AttributeType::List(&AttributeType::UNSIGNED_INT)),
    may("dependenciesKind", KINDS),
];
static OUTPUT: ElementRule = node("Output", UNKNOWN, ANNOTATED);
static CONTINUOUS_STATE_DERIVATIVE: ElementRule =
    node("ContinuousStateDerivative", UNKNOWN, ANNOTATED);
static CLOCKED_STATE: ElementRule = node("ClockedState", UNKNOWN, ANNOTATED);
static INITIAL_UNKNOWN: ElementRule = node("InitialUnknown", UNKNOWN, ANNOTATED);
static EVENT_INDICATOR: ElementRule = node("EventIndicator", UNKNOWN, ANNOTATED);

/// The root element of `sources/buildDescription.xml`.
pub static BUILD_DESCRIPTION: ElementRule = node(
    "fmiBuildDescription",
    &[must("fmiVersion", AttributeType::Version3)],
    &[some(0, &BUILD_CONFIGURATION), optional(1, &ANNOTATIONS)],
);
static BUILD_CONFIGURATION: ElementRule = node(
    "BuildConfiguration",
    &[
        must("modelIdentifier", AttributeType::Line),
        may("platform", AttributeType::Line),
        may("description", AttributeType::Text),
    ],
    &[any(0, &SOURCE_FILE_SET), any(1, &LIBRARY), optional(2, &ANNOTATIONS)],
);
static SOURCE_FILE_SET: ElementRule = node(
    "SourceFileSet",
    &[
        may("name", AttributeType::Line),
        may("language", AttributeType::Line),
        may("compiler", AttributeType::Line),
        may("compilerOptions", AttributeType::Text),
    ],
    &[
        some(0, &SOURCE_FILE),
        any(1, &PREPROCESSOR_DEFINITION),
        any(2, &INCLUDE_DIRECTORY),
        optional(3, &ANNOTATIONS),
    ],
);
static SOURCE_FILE: ElementRule =
    node("SourceFile", &[must("name", AttributeType::Line)], ANNOTATED);
static INCLUDE_DIRECTORY: ElementRule =
    node("IncludeDirectory", &[must("name", AttributeType::Line)], ANNOTATED);
static PREPROCESSOR_DEFINITION: ElementRule = node(
    "PreprocessorDefinition",
    &[
        must("name", AttributeType::Line),
        may("optional", AttributeType::Boolean),
        may("value", AttributeType::Line),
        may("description", AttributeType::Text),
    ],
    &[any(0, &OPTION), optional(1, &ANNOTATIONS)],
);
static OPTION: ElementRule = node(
    "Option",
    &[may("value", AttributeType::Line), may("description", AttributeType::Text)],
    &[],
);
static LIBRARY: ElementRule = node(
    "Library",
    &[
        must("name", AttributeType::Line),
        may("version", AttributeType::Line),
        may("external", AttributeType::Boolean),
        may("description", AttributeType::Text),
    ],
    ANNOTATED,
);
