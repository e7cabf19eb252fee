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

/// The root element.
pub static MODEL_DESCRIPTION: ElementRule = node(
    "fmiModelDescription",
    &[
        must("fmiVersion", AttributeType::Word(&["2.0"])),
        must("modelName", AttributeType::Text),
        must("guid", AttributeType::Line),
        may("description", AttributeType::Text),
        may("author", AttributeType::Text),
        may("version", AttributeType::Line),
        may("copyright", AttributeType::Text),
        may("license", AttributeType::Text),
        may("generationTool", AttributeType::Line),
        may("generationDateAndTime", AttributeType::DateTime),
        may("variableNamingConvention", NAMING),
        may("numberOfEventIndicators", AttributeType::UNSIGNED_INT),
    ],
    &[
        // At least one of both, in any order.
        one(0, &MODEL_EXCHANGE),
        one(0, &CO_SIMULATION),
        optional(1, &UNIT_DEFINITIONS),
        optional(2, &TYPE_DEFINITIONS),
        optional(3, &LOG_CATEGORIES),
        optional(4, &DEFAULT_EXPERIMENT),
        optional(5, &VENDOR_ANNOTATIONS),
        one(6, &MODEL_VARIABLES),
        one(7, &MODEL_STRUCTURE),
    ],
);

static MODEL_EXCHANGE: ElementRule = node(
    "ModelExchange",
    &[
        must("modelIdentifier", AttributeType::Line),
        may("needsExecutionTool", AttributeType::Boolean),
        may("completedIntegratorStepNotNeeded", AttributeType::Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", AttributeType::Boolean),
        may("canNotUseMemoryManagementFunctions", AttributeType::Boolean),
        may("canGetAndSetFMUstate", AttributeType::Boolean),
        may("canSerializeFMUstate", AttributeType::Boolean),
        may("providesDirectionalDerivative", AttributeType::Boolean),
    ],
    &[optional(0, &SOURCE_FILES)],
);

static CO_SIMULATION: ElementRule = node(
    "CoSimulation",
    &[
        must("modelIdentifier", AttributeType::Line),
        may("needsExecutionTool", AttributeType::Boolean),
        may("canHandleVariableCommunicationStepSize", AttributeType::Boolean),
        may("canInterpolateInputs", AttributeType::Boolean),
        may("maxOutputDerivativeOrder", AttributeType::UNSIGNED_INT),
        may("canRunAsynchronuously", AttributeType::Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", AttributeType::Boolean),
        may("canNotUseMemoryManagementFunctions", AttributeType::Boolean),
        may("canGetAndSetFMUstate", AttributeType::Boolean),
        may("canSerializeFMUstate", AttributeType::Boolean),
        may("providesDirectionalDerivative", AttributeType::Boolean),
    ],
    &[optional(0, &SOURCE_FILES)],
);

static SOURCE_FILES: ElementRule = node("SourceFiles", &[], &[some(0, &FILE)]);
static FILE: ElementRule = node("File", &[must("name", AttributeType::Line)], &[]);

static UNIT_DEFINITIONS: ElementRule = node("UnitDefinitions", &[], &[some(0, &UNIT)]);
static UNIT: ElementRule = node(
    "Unit",
    &[must("name", AttributeType::Line)],
    &[optional(0, &BASE_UNIT), any(1, &DISPLAY_UNIT)],
);
pub(super) static BASE_UNIT: ElementRule = node(
    "BaseUnit",
    &[
        may("kg", AttributeType::INT),
        may("m", AttributeType::INT),
        may("s", AttributeType::INT),
        may("A", AttributeType::INT),
        may("K", AttributeType::INT),
        may("mol", AttributeType::INT),
        may("cd", AttributeType::INT),
        may("rad", AttributeType::INT),
        may("factor", AttributeType::Double),
        may("offset", AttributeType::Double),
    ],
    &[],
);
static DISPLAY_UNIT: ElementRule = node(
    "DisplayUnit",
    &[
        must("name", AttributeType::Line),
        may("factor", AttributeType::Double),
        may("offset", AttributeType::Double),
    ],
    &[],
);

static TYPE_DEFINITIONS: ElementRule = node("TypeDefinitions", &[], &[some(0, &SIMPLE_TYPE)]);
static SIMPLE_TYPE: ElementRule = node(
    "SimpleType",
    &[must("name", AttributeType::Line), may("description", AttributeType::Text)],
    &[
        one(0, &REAL_TYPE),
        one(0, &INTEGER_TYPE),
        one(0, &BOOLEAN_TYPE),
        one(0, &STRING_TYPE),
        one(0, &ENUMERATION_TYPE),
    ],
);
static REAL_TYPE: ElementRule = node(
    "Real",
    &[
        may("quantity", AttributeType::Line),
        may("unit", AttributeType::Line),
        may("displayUnit", AttributeType::Line),
        may("relativeQuantity", AttributeType::Boolean),
        may("min", AttributeType::Double),
        may("max", AttributeType::Double),
        may("nominal", AttributeType::Double),
        may("unbounded", AttributeType::Boolean),
    ],
    &[],
);
static INTEGER_TYPE: ElementRule = node(
    "Integer",
    &[
        may("quantity", AttributeType::Line),
        may("min", AttributeType::INT),
        may("max", AttributeType::INT),
    ],
    &[],
);
// The schema gives no type at all to these two.
static BOOLEAN_TYPE: ElementRule =
    ElementRule { name: "Boolean", attributes: &[], children: &[], open: Open::Everything };
static STRING_TYPE: ElementRule =
    ElementRule { name: "String", attributes: &[], children: &[], open: Open::Everything };
static ENUMERATION_TYPE: ElementRule =
    node("Enumeration", &[may("quantity", AttributeType::Line)], &[some(0, &ITEM)]);
static ITEM: ElementRule = node(
    "Item",
    &[
        must("name", AttributeType::Line),
        must("value", AttributeType::INT),
        may("description", AttributeType::Text),
    ],
    &[],
);

static LOG_CATEGORIES: ElementRule = node("LogCategories", &[], &[some(0, &CATEGORY)]);
static CATEGORY: ElementRule = node(
    "Category",
    &[must("name", AttributeType::Line), may("description", AttributeType::Text)],
    &[],
);
static DEFAULT_EXPERIMENT: ElementRule = node(
    "DefaultExperiment",
    &[
        may("startTime", AttributeType::Double),
        may("stopTime", AttributeType::Double),
        may("tolerance", AttributeType::Double),
        may("stepSize", AttributeType::Double),
    ],
    &[],
);

static VENDOR_ANNOTATIONS: ElementRule = node("VendorAnnotations", &[], &[some(0, &TOOL)]);
static ANNOTATIONS: ElementRule = node("Annotations", &[], &[some(0, &TOOL)]);
static TOOL: ElementRule = ElementRule {
    name: "Tool",
    attributes: &[must("name", AttributeType::Line)],
    children: &[],
    open: Open::Everything,
};

static MODEL_VARIABLES: ElementRule = node("ModelVariables", &[], &[some(0, &SCALAR_VARIABLE)]);
static SCALAR_VARIABLE: ElementRule = node(
    "ScalarVariable",
    &[
        must("name", AttributeType::Line),
        must("valueReference", AttributeType::UNSIGNED_INT),
        may("description", AttributeType::Text),
        may("causality", CAUSALITY),
        may("variability", VARIABILITY),
        may("initial", INITIAL),
        may("canHandleMultipleSetPerTimeInstant", AttributeType::Boolean),
    ],
    &[
        one(0, &REAL),
        one(0, &INTEGER),
        one(0, &BOOLEAN),
        one(0, &STRING),
        one(0, &ENUMERATION),
        optional(1, &ANNOTATIONS),
    ],
);
static REAL: ElementRule = node(
    "Real",
    &[
        may("declaredType", AttributeType::Line),
        may("quantity", AttributeType::Line),
        may("unit", AttributeType::Line),
        may("displayUnit", AttributeType::Line),
        may("relativeQuantity", AttributeType::Boolean),
        may("min", AttributeType::Double),
        may("max", AttributeType::Double),
        may("nominal", AttributeType::Double),
        may("unbounded", AttributeType::Boolean),
        may("start", AttributeType::Double),
        may("derivative", AttributeType::UNSIGNED_INT),
        may("reinit", AttributeType::Boolean),
    ],
    &[],
);
static INTEGER: ElementRule = node(
    "Integer",
    &[
        may("declaredType", AttributeType::Line),
        may("quantity", AttributeType::Line),
        may("min", AttributeType::INT),
        may("max", AttributeType::INT),
        may("start", AttributeType::INT),
    ],
    &[],
);
static BOOLEAN: ElementRule = node(
    "Boolean",
    &[may("declaredType", AttributeType::Line), may("start", AttributeType::Boolean)],
    &[],
);
static STRING: ElementRule = node(
    "String",
    &[may("declaredType", AttributeType::Line), may("start", AttributeType::Text)],
    &[],
);
static ENUMERATION: ElementRule = node(
    "Enumeration",
    &[
        must("declaredType", AttributeType::Line),
        may("quantity", AttributeType::Line),
        may("min", AttributeType::INT),
        may("max", AttributeType::INT),
        may("start", AttributeType::INT),
    ],
    &[],
);

static MODEL_STRUCTURE: ElementRule = node(
    "ModelStructure",
    &[],
    &[optional(0, &OUTPUTS), optional(1, &DERIVATIVES), optional(2, &INITIAL_UNKNOWNS)],
);
static OUTPUTS: ElementRule = node("Outputs", &[], UNKNOWNS);
static DERIVATIVES: ElementRule = node("Derivatives", &[], UNKNOWNS);
static INITIAL_UNKNOWNS: ElementRule = node("InitialUnknowns", &[], UNKNOWNS);
const UNKNOWNS: &[Child] = &[Child { node: &UNKNOWN, place: 0, min: 1, max: MANY }];
static UNKNOWN: ElementRule = node(
    "Unknown",
    &[
        must("index", AttributeType::UNSIGNED_INT),
        may("dependencies", AttributeType::List(&AttributeType::UNSIGNED_INT)),
        may("dependenciesKind", KINDS),
    ],
    &[],
);
