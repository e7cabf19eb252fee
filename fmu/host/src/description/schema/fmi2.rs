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

/// The root element.
pub static MODEL_DESCRIPTION: Node = node(
    "fmiModelDescription",
    &[
        must("fmiVersion", Type::Word(&["2.0"])),
        must("modelName", Type::Text),
        must("guid", Type::Line),
        may("description", Type::Text),
        may("author", Type::Text),
        may("version", Type::Line),
        may("copyright", Type::Text),
        may("license", Type::Text),
        may("generationTool", Type::Line),
        may("generationDateAndTime", Type::DateTime),
        may("variableNamingConvention", NAMING),
        may("numberOfEventIndicators", Type::UNSIGNED_INT),
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

static MODEL_EXCHANGE: Node = node(
    "ModelExchange",
    &[
        must("modelIdentifier", Type::Line),
        may("needsExecutionTool", Type::Boolean),
        may("completedIntegratorStepNotNeeded", Type::Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", Type::Boolean),
        may("canNotUseMemoryManagementFunctions", Type::Boolean),
        may("canGetAndSetFMUstate", Type::Boolean),
        may("canSerializeFMUstate", Type::Boolean),
        may("providesDirectionalDerivative", Type::Boolean),
    ],
    &[optional(0, &SOURCE_FILES)],
);

static CO_SIMULATION: Node = node(
    "CoSimulation",
    &[
        must("modelIdentifier", Type::Line),
        may("needsExecutionTool", Type::Boolean),
        may("canHandleVariableCommunicationStepSize", Type::Boolean),
        may("canInterpolateInputs", Type::Boolean),
        may("maxOutputDerivativeOrder", Type::UNSIGNED_INT),
        may("canRunAsynchronuously", Type::Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", Type::Boolean),
        may("canNotUseMemoryManagementFunctions", Type::Boolean),
        may("canGetAndSetFMUstate", Type::Boolean),
        may("canSerializeFMUstate", Type::Boolean),
        may("providesDirectionalDerivative", Type::Boolean),
    ],
    &[optional(0, &SOURCE_FILES)],
);

static SOURCE_FILES: Node = node("SourceFiles", &[], &[some(0, &FILE)]);
static FILE: Node = node("File", &[must("name", Type::Line)], &[]);

static UNIT_DEFINITIONS: Node = node("UnitDefinitions", &[], &[some(0, &UNIT)]);
static UNIT: Node =
    node("Unit", &[must("name", Type::Line)], &[optional(0, &BASE_UNIT), any(1, &DISPLAY_UNIT)]);
pub(super) static BASE_UNIT: Node = node(
    "BaseUnit",
    &[
        may("kg", Type::INT),
        may("m", Type::INT),
        may("s", Type::INT),
        may("A", Type::INT),
        may("K", Type::INT),
        may("mol", Type::INT),
        may("cd", Type::INT),
        may("rad", Type::INT),
        may("factor", Type::Double),
        may("offset", Type::Double),
    ],
    &[],
);
static DISPLAY_UNIT: Node = node(
    "DisplayUnit",
    &[must("name", Type::Line), may("factor", Type::Double), may("offset", Type::Double)],
    &[],
);

static TYPE_DEFINITIONS: Node = node("TypeDefinitions", &[], &[some(0, &SIMPLE_TYPE)]);
static SIMPLE_TYPE: Node = node(
    "SimpleType",
    &[must("name", Type::Line), may("description", Type::Text)],
    &[
        one(0, &REAL_TYPE),
        one(0, &INTEGER_TYPE),
        one(0, &BOOLEAN_TYPE),
        one(0, &STRING_TYPE),
        one(0, &ENUMERATION_TYPE),
    ],
);
static REAL_TYPE: Node = node(
    "Real",
    &[
        may("quantity", Type::Line),
        may("unit", Type::Line),
        may("displayUnit", Type::Line),
        may("relativeQuantity", Type::Boolean),
        may("min", Type::Double),
        may("max", Type::Double),
        may("nominal", Type::Double),
        may("unbounded", Type::Boolean),
    ],
    &[],
);
static INTEGER_TYPE: Node = node(
    "Integer",
    &[may("quantity", Type::Line), may("min", Type::INT), may("max", Type::INT)],
    &[],
);
// The schema gives no type at all to these two.
static BOOLEAN_TYPE: Node =
    Node { name: "Boolean", attributes: &[], children: &[], open: Open::Everything };
static STRING_TYPE: Node =
    Node { name: "String", attributes: &[], children: &[], open: Open::Everything };
static ENUMERATION_TYPE: Node =
    node("Enumeration", &[may("quantity", Type::Line)], &[some(0, &ITEM)]);
static ITEM: Node = node(
    "Item",
    &[must("name", Type::Line), must("value", Type::INT), may("description", Type::Text)],
    &[],
);

static LOG_CATEGORIES: Node = node("LogCategories", &[], &[some(0, &CATEGORY)]);
static CATEGORY: Node =
    node("Category", &[must("name", Type::Line), may("description", Type::Text)], &[]);
static DEFAULT_EXPERIMENT: Node = node(
    "DefaultExperiment",
    &[
        may("startTime", Type::Double),
        may("stopTime", Type::Double),
        may("tolerance", Type::Double),
        may("stepSize", Type::Double),
    ],
    &[],
);

static VENDOR_ANNOTATIONS: Node = node("VendorAnnotations", &[], &[some(0, &TOOL)]);
static ANNOTATIONS: Node = node("Annotations", &[], &[some(0, &TOOL)]);
static TOOL: Node = Node {
    name: "Tool",
    attributes: &[must("name", Type::Line)],
    children: &[],
    open: Open::Everything,
};

static MODEL_VARIABLES: Node = node("ModelVariables", &[], &[some(0, &SCALAR_VARIABLE)]);
static SCALAR_VARIABLE: Node = node(
    "ScalarVariable",
    &[
        must("name", Type::Line),
        must("valueReference", Type::UNSIGNED_INT),
        may("description", Type::Text),
        may("causality", CAUSALITY),
        may("variability", VARIABILITY),
        may("initial", INITIAL),
        may("canHandleMultipleSetPerTimeInstant", Type::Boolean),
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
static REAL: Node = node(
    "Real",
    &[
        may("declaredType", Type::Line),
        may("quantity", Type::Line),
        may("unit", Type::Line),
        may("displayUnit", Type::Line),
        may("relativeQuantity", Type::Boolean),
        may("min", Type::Double),
        may("max", Type::Double),
        may("nominal", Type::Double),
        may("unbounded", Type::Boolean),
        may("start", Type::Double),
        may("derivative", Type::UNSIGNED_INT),
        may("reinit", Type::Boolean),
    ],
    &[],
);
static INTEGER: Node = node(
    "Integer",
    &[
        may("declaredType", Type::Line),
        may("quantity", Type::Line),
        may("min", Type::INT),
        may("max", Type::INT),
        may("start", Type::INT),
    ],
    &[],
);
static BOOLEAN: Node =
    node("Boolean", &[may("declaredType", Type::Line), may("start", Type::Boolean)], &[]);
static STRING: Node =
    node("String", &[may("declaredType", Type::Line), may("start", Type::Text)], &[]);
static ENUMERATION: Node = node(
    "Enumeration",
    &[
        must("declaredType", Type::Line),
        may("quantity", Type::Line),
        may("min", Type::INT),
        may("max", Type::INT),
        may("start", Type::INT),
    ],
    &[],
);

static MODEL_STRUCTURE: Node = node(
    "ModelStructure",
    &[],
    &[optional(0, &OUTPUTS), optional(1, &DERIVATIVES), optional(2, &INITIAL_UNKNOWNS)],
);
static OUTPUTS: Node = node("Outputs", &[], UNKNOWNS);
static DERIVATIVES: Node = node("Derivatives", &[], UNKNOWNS);
static INITIAL_UNKNOWNS: Node = node("InitialUnknowns", &[], UNKNOWNS);
const UNKNOWNS: &[Child] = &[Child { node: &UNKNOWN, place: 0, min: 1, max: MANY }];
static UNKNOWN: Node = node(
    "Unknown",
    &[
        must("index", Type::UNSIGNED_INT),
        may("dependencies", Type::List(&Type::UNSIGNED_INT)),
        may("dependenciesKind", KINDS),
    ],
    &[],
);
