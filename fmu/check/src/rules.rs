//! The rules, with their clauses in the standards.

use serde::Serialize;

/// Severity of a violation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Information.
    Note,
    /// Legal or harmless, but likely to cause trouble.
    Warning,
    /// Forbidden by the standard, or unusable.
    Error,
}

impl Severity {
    /// Name of the severity.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A rule.
#[derive(Debug, PartialEq, Eq)]
pub struct Rule {
    /// Name of the rule: `variable.start`.
    pub id: &'static str,
    /// Severity of a violation.
    pub severity: Severity,
    /// Text of the rule.
    pub says: &'static str,
    /// Clause in FMI 2.0; empty if the rule doesn't apply.
    pub fmi2: &'static str,
    /// Clause in FMI 3.0; empty if the rule doesn't apply.
    pub fmi3: &'static str,
}

macro_rules! rules {
    ($($name:ident $id:literal $severity:ident $fmi2:literal $fmi3:literal $says:literal;)*) => {
        $(
            #[doc = $says]
            pub static $name: Rule = Rule {
                id: $id,
                severity: Severity::$severity,
                says: $says,
                fmi2: $fmi2,
                fmi3: $fmi3,
            };
        )*
        /// All rules, in the order of the page that lists them.
        pub static RULES: &[&Rule] = &[$(&$name),*];
    };
}

// A section number refers to the standard; `Octant` marks rules that are not in the standards but
// that importers need.
rules! {
    ARCHIVE_NAME "archive.name" Error "2.3" "2.5"
        "Every entry is a plain file, and its name stays inside the folder; entries of the same name have the same content.";
    ARCHIVE_DUPLICATE "archive.duplicate" Warning "2.3" "2.5"
        "Every entry has a name of its own.";
    ARCHIVE_WINDOWS "archive.name-windows" Warning "2.3" "2.5"
        "Windows can hold the names: no colons, no device names, no dots or blanks at an end.";
    ARCHIVE_EXTENSION "archive.extension" Warning "2.3" "2.5"
        "The name of the file ends in .fmu.";
    ARCHIVE_VERSION "archive.version-needed" Warning "2.3" "2.5"
        "No entry needs a version of the zip format above 2.0.";
    ARCHIVE_DESCRIPTOR "archive.data-descriptor" Warning "2.3" "2.5"
        "Sizes stand before the data of entries that aren't packed.";
    ARCHIVE_ENCODING "archive.name-encoding" Warning "2.3" "2.5"
        "Names that aren't ASCII are marked as UTF-8.";
    ARCHIVE_HEADERS "archive.headers" Warning "2.3" "2.5"
        "The header before each entry says the same as the directory at the end.";
    ARCHIVE_READABLE "archive.readable" Error "2.3" "2.5"
        "Every entry can be unpacked, and isn't larger than any FMU needs.";

    DESCRIPTION_ENCODING "description.encoding" Error "2.2" "2.4"
        "XML files are in UTF-8.";
    DESCRIPTION_READABLE "description.readable" Error "2.2" "2.4"
        "The description has a meaning: it can be read.";
    DESCRIPTION_IDENTIFIER "description.identifier" Error "3.3.1, 4.3.1" "2.4.2"
        "A model identifier is a C identifier.";
    DESCRIPTION_TOKEN "description.token" Warning "2.2.1" "2.4.1"
        "The guid or instantiation token isn't empty.";
    DESCRIPTION_NAME "description.model-name" Warning "2.2.1" "2.4.1"
        "The model has a name.";
    DESCRIPTION_VERSION "description.version" Warning "" "2.4.1"
        "The version of the standard is one that is released.";

    SCHEMA_ELEMENT "schema.element" Error "2.2" "2.4"
        "Only elements that the standard knows, at their place.";
    SCHEMA_ATTRIBUTE "schema.attribute" Error "2.2" "2.4"
        "Only attributes that the standard knows.";
    SCHEMA_MISSING_ELEMENT "schema.missing-element" Error "2.2" "2.4"
        "Elements that have to be there are there.";
    SCHEMA_MISSING_ATTRIBUTE "schema.missing-attribute" Error "2.2" "2.4"
        "Attributes that have to be there are there.";
    SCHEMA_ORDER "schema.order" Error "2.2" "2.4"
        "Elements stand in the order of the schema.";
    SCHEMA_REPEATED "schema.repeated" Error "2.2" "2.4"
        "Elements are there as often as the schema allows.";
    SCHEMA_VALUE "schema.value" Error "2.2" "2.4"
        "Values of attributes are of their type.";

    INTERFACE_STATE "interface.state" Error "3.3.1, 4.3.1" "2.4.2"
        "An FMU that can serialize its state can get and set it.";
    INTERFACE_EARLY_RETURN "interface.early-return" Error "" "4.4"
        "An FMU that returns early after an intermediate update provides intermediate updates.";
    INTERFACE_STEP "interface.step" Error "" "4.4"
        "The fixed internal step is a positive number.";
    INTERFACE_SAME_IDENTIFIER "interface.same-identifier" Note "3.3.1, 4.3.1" "2.4.2"
        "Interfaces with identifiers of their own need a library each.";

    LOG_UNIQUE "log.unique" Error "2.2.4" "2.4.5"
        "Log categories have different names.";

    EXPERIMENT_RANGE "experiment.range" Error "2.2.5" "2.4.6"
        "Stop time lies after start time; step and tolerance are positive; all are finite.";
    EXPERIMENT_STEP "experiment.step" Warning "2.2.5" "2.4.6"
        "The step fits into the time of the experiment.";

    UNIT_UNIQUE "unit.unique" Error "2.2.2" "2.4.3"
        "Units have different names, and so have the display units of a unit.";
    UNIT_DEFINED "unit.defined" Error "2.2.3" "2.4.4, 2.4.7.5"
        "Units and display units that are used are defined.";
    UNIT_DISPLAY "unit.display" Error "2.2.3" "2.4.4, 2.4.7.5"
        "Who has a display unit has a unit.";
    UNIT_FACTOR "unit.factor" Error "2.2.2" "2.4.3"
        "Factors are finite numbers but 0, offsets are finite.";
    UNIT_INVERSE "unit.inverse" Error "" "2.4.3"
        "An inverse display unit has no offset.";
    UNIT_BASE "unit.base" Note "2.2.2" "2.4.3"
        "A unit says what it is in SI, so that importers can convert it.";
    UNIT_MEANING "unit.meaning" Warning "Octant" "Octant"
        "A unit with a common name is what this name commonly means.";
    UNIT_TYPE "unit.type" Warning "2.2.7" "2.4.7.5"
        "The unit of a variable measures the same as the unit of its type.";
    UNIT_DERIVATIVE "unit.derivative" Warning "2.2.7" "2.4.7.5"
        "The unit of a derivative is the unit of the variable per second.";

    TYPE_UNIQUE "type.unique" Error "2.2.3" "2.4.4"
        "Types have different names, which aren't names of variables.";
    TYPE_DEFINED "type.defined" Error "2.2.7" "2.4.7.5"
        "The declared type of a variable is defined, and of the variable's kind.";
    ENUMERATION_UNIQUE "enumeration.unique" Error "2.2.3" "2.4.4"
        "Items of an enumeration have different names and different values.";
    ENUMERATION_START "enumeration.start" Error "2.2.7" "2.4.7.5"
        "The start value of an enumeration is the value of one of its items.";

    VARIABLE_NAME "variable.name" Error "2.2.9" "2.4.7.5.1"
        "Names aren't empty, and have no line breaks or tabs.";
    VARIABLE_UNIQUE "variable.unique" Error "2.2.7" "2.4.7.3, 2.4.7.4"
        "Variables and aliases have different names.";
    VARIABLE_STRUCTURED "variable.structured-name" Error "2.2.9" "2.4.7.5.1"
        "Structured names follow their grammar.";
    VARIABLE_ARRAY_GAPS "variable.array-gaps" Note "2.2.9" "2.4.7.5.1"
        "All elements of an array are there.";
    VARIABLE_DESCRIPTION "variable.description" Note "2.2.7" "2.4.7.4"
        "Inputs, outputs and parameters have a description.";
    VARIABLE_REFERENCE "variable.reference" Error "" "2.4.7.4"
        "Variables have different value references.";
    VARIABLE_ALIAS "variable.alias" Error "2.2.7" ""
        "Variables with the same value reference have the same unit, at most one of them can be set, and all or none are constant.";
    VARIABLE_CAUSALITY "variable.causality" Error "2.2.7" "2.4.7.4"
        "Causality and variability are a combination of the standard's table.";
    VARIABLE_CONTINUOUS "variable.continuous" Error "2.2.7" "2.4.7.4"
        "Only real numbers are continuous.";
    VARIABLE_INITIAL "variable.initial" Error "2.2.7" "2.4.7.5"
        "Initial is one that the standard's table allows for causality and variability.";
    VARIABLE_START "variable.start" Error "2.2.7" "2.4.7.5"
        "Inputs, parameters, constants and what is exact or approximate have a start value.";
    VARIABLE_NO_START "variable.no-start" Error "2.2.7" "2.4.7.5"
        "What is calculated has no start value, nor has the independent variable.";
    VARIABLE_START_RANGE "variable.start-range" Error "2.2.7" "2.4.7.5"
        "The start value lies between minimum and maximum.";
    VARIABLE_START_FINITE "variable.start-finite" Warning "Octant" "Octant"
        "Start values are finite.";
    VARIABLE_START_COUNT "variable.start-count" Error "" "2.4.7.5"
        "An array has one start value, or one for each element.";
    VARIABLE_RANGE "variable.range" Error "2.2.3" "2.4.4"
        "The minimum isn't above the maximum, and both are numbers.";
    VARIABLE_NOMINAL "variable.nominal" Error "2.2.3" "2.4.4"
        "The nominal value is finite and isn't 0.";
    VARIABLE_NOMINAL_SIGN "variable.nominal-sign" Warning "2.2.3" "2.4.4"
        "The nominal value is positive.";
    VARIABLE_INDEPENDENT "variable.independent" Error "2.2.7" "2.4.7.4"
        "There is one independent variable (FMI 2.0: at most one), a real scalar.";
    VARIABLE_STRUCTURAL "variable.structural" Error "" "2.4.7.4"
        "A structural parameter is a scalar, and above 0 where it is the size of an array.";
    VARIABLE_DIMENSION "variable.dimension" Error "" "2.4.7.2"
        "A dimension is above 0, or given by a UInt64 that is constant or a structural parameter.";
    VARIABLE_SIZE "variable.size" Warning "Octant" "Octant"
        "Arrays have at most 2^24 elements, or Octant doesn't load them.";
    VARIABLE_DERIVATIVE "variable.derivative" Error "2.2.7" "2.4.7.5"
        "A derivative is a real number, and that of another variable of its size.";
    VARIABLE_REINIT "variable.reinit" Warning "2.2.7" "2.4.7.5"
        "Only states of model exchange can be reinitialized.";
    VARIABLE_MULTIPLE_SET "variable.multiple-set" Warning "2.2.7" "2.4.7.4"
        "Only of inputs is it said whether they can be set more than once in an instant.";
    VARIABLE_INTERMEDIATE "variable.intermediate-update" Error "" "2.4.7.4"
        "Parameters aren't updated between communication points.";
    VARIABLE_PREVIOUS "variable.previous" Error "" "2.4.7.4"
        "A clocked discrete variable has a previous value in another of its kind, which no other has.";
    VARIABLE_CLOCKS "variable.clocks" Error "" "2.4.7.4"
        "A clocked variable is discrete or tunable, and its clocks are clocks.";

    CLOCK_CAUSALITY "clock.causality" Error "" "2.4.7.4"
        "A clock is an input, an output or local, and discrete or tunable.";
    CLOCK_INTERVAL "clock.interval" Error "" "2.4.4"
        "A constant or fixed clock has an interval above 0, and no clock has a negative shift.";
    CLOCK_FRACTION "clock.fraction" Error "" "2.4.4"
        "Intervals in counts need a resolution, and a clock that supports fractions.";
    CLOCK_PERIODIC "clock.periodic" Warning "" "2.4.4"
        "Only periodic clocks have an interval in the description.";
    CLOCK_PRIORITY "clock.priority" Error "" "2.4.4"
        "Input clocks of scheduled execution have a priority.";
    CLOCK_EVENT_MODE "clock.event-mode" Warning "" "4.4"
        "A co-simulation FMU with clocks has event mode.";

    STRUCTURE_REFERENCE "structure.reference" Error "2.2.8" "2.4.8"
        "The structure names variables that are there.";
    STRUCTURE_DUPLICATE "structure.duplicate" Error "2.2.8" "2.4.8"
        "No variable is in a list of the structure twice.";
    STRUCTURE_OUTPUTS "structure.outputs" Error "2.2.8" "2.4.8"
        "The outputs of the structure are the variables that are outputs.";
    STRUCTURE_OUTPUT_ORDER "structure.output-order" Note "2.2.8" "2.4.8"
        "Outputs are in the order of the variables, so that vectors of outputs mean the same everywhere.";
    STRUCTURE_DERIVATIVES "structure.derivatives" Error "2.2.8" "2.4.8"
        "State derivatives are continuous real variables that are derivatives, each of another state.";
    STRUCTURE_STATE "structure.state" Error "2.2.7" "2.4.7.4"
        "A state is a continuous real variable, local or an output.";
    STRUCTURE_INITIAL "structure.initial-unknowns" Error "2.2.8" "2.4.8"
        "Initial unknowns are the outputs that aren't exact, calculated parameters, and states and derivatives that aren't exact; no other.";
    STRUCTURE_INITIAL_ORDER "structure.initial-order" Error "2.2.8" ""
        "Initial unknowns are in the order of the variables.";
    STRUCTURE_INDICATORS "structure.event-indicators" Error "" "2.4.8"
        "Event indicators are continuous real variables, local or outputs.";
    STRUCTURE_CLOCKED "structure.clocked-states" Error "" "2.4.8"
        "The clocked states are the variables that have a previous value.";
    STRUCTURE_DEPENDENCIES "structure.dependencies" Error "2.2.8" "2.4.8"
        "Dependencies are knowns: inputs, states, parameters (FMI 2.0: tunable ones), the independent variable; at the start inputs, the independent variable and what is exact.";
    STRUCTURE_DEPENDENCY_ORDER "structure.dependency-order" Warning "2.2.8" ""
        "Dependencies are in the order of the variables, none twice.";
    STRUCTURE_KINDS "structure.kinds" Error "2.2.8" "2.4.8"
        "Each dependency has one kind, which fits the type of the variable.";

    TERMINALS_READABLE "terminals.readable" Error "" "2.4.9"
        "terminalsAndIcons.xml can be read and follows its schema.";
    TERMINALS_VERSION "terminals.version" Error "" "2.4.9"
        "terminalsAndIcons.xml has the version of the model description.";
    TERMINALS_NAME "terminals.name" Error "" "2.4.9.2"
        "Terminals of a level have different names, and so have members of a terminal.";
    TERMINALS_MEMBER "terminals.member" Error "" "2.4.9.2"
        "Members of terminals that are matched by name have one.";
    TERMINALS_VARIABLE "terminals.variable" Error "" "2.4.9.2"
        "Members of terminals are variables.";
    TERMINALS_CAUSALITY "terminals.causality" Warning "" "2.4.9.2"
        "Signals and flows of terminals are inputs, outputs or parameters.";
    TERMINALS_RULE "terminals.matching-rule" Warning "" "2.4.9.2"
        "A matching rule is plug, bus or sequence, or has the name of a domain.";
    TERMINALS_ICON "terminals.icon" Error "" "2.4.9.1"
        "Icons are files beside terminalsAndIcons.xml, as PNG in any case.";

    LAYERED_MANIFEST "layered.manifest" Error "" "2.6"
        "The root element of a layered standard's manifest, of any name, has the standard's name, version and description.";
    BUS_MANIFEST "bus.manifest" Error "" "FMI-LS-BUS 1.0.0, 2"
        "An FMU on a bus has a bus terminal, and a manifest in the standard's folder.";
    BUS_VERSION "bus.version" Note "" "FMI-LS-BUS 1.0.0, 2"
        "The manifest has a version of FMI-LS-BUS whose rules are checked here.";
    BUS_EVENT_MODE "bus.event-mode" Error "" "FMI-LS-BUS 1.0.0, 3"
        "An FMU on a bus is one of co-simulation with event mode.";
    BUS_MEMBERS "bus.members" Error "" "FMI-LS-BUS 1.0.0, 5.4.1"
        "A bus terminal has the members Rx_Clock, Rx_Data, Tx_Clock and Tx_Data, with variables that no other has.";
    BUS_VARIABLES "bus.variables" Error "" "FMI-LS-BUS 1.0.0, 5.3"
        "Variables of a bus are binary variables with their clocks, one pair there and one back.";
    BUS_MIME_TYPE "bus.mime-type" Error "" "FMI-LS-BUS 1.0.0, 5.3.4"
        "The MIME type says which bus it is, the same both ways.";
    BUS_STEP "bus.step" Warning "" "FMI-LS-BUS 1.0.0, 5.3.1.1"
        "An FMU with a time-based clock takes communication steps of any length.";
    BUS_CONFIGURATION "bus.configuration" Error "" "FMI-LS-BUS 1.0.0, 5.4.1.1"
        "A configuration terminal has the name Configuration and is matched as bus.";
    BUS_NOTIFICATIONS "bus.notifications" Error "" "FMI-LS-BUS 1.0.0, 5.5.1.3.1"
        "BusNotifications is a Boolean parameter that starts with false; of a bus simulation it is calculated or constant.";

    FILES_IMPLEMENTATION "files.implementation" Error "2.3" "2.5"
        "There is a binary or there are sources.";
    FILES_DOCUMENTATION "files.documentation" Note "2.3" "2.5.1.1"
        "There is documentation/index.html.";
    FILES_LICENCE "files.licence" Note "2.3" "2.5.1.1.1"
        "There is a licence in documentation/licenses.";
    FILES_LICENCE_ENTRY "files.licence-entry" Error "" "2.5.1.1.1"
        "documentation/licenses has a license.txt, license.html or license.spdx.";
    FILES_UNKNOWN "files.unknown" Note "2.3" "2.5.1"
        "Only files and folders of the standard are at the top.";
    SOURCES_FILES "sources.files" Error "2.3" "2.4.10"
        "Source files that are listed are in sources/.";
    SOURCES_BUILD "sources.build-description" Error "" "2.4.10"
        "Sources have a buildDescription.xml that can be read and follows its schema.";
    SOURCES_IDENTIFIER "sources.identifier" Error "" "2.4.10"
        "A build configuration is of a model identifier of the description, once a platform.";

    BINARY_PLATFORM "binary.platform" Warning "2.3" "2.5.1.4"
        "There is a binary for this machine.";
    BINARY_FOLDER "binary.folder" Warning "2.3" "2.5.1.4.1"
        "Folders of binaries have names of the standard.";
    BINARY_NAME "binary.name" Error "2.3" "2.5.1"
        "A folder of binaries has a library of the model identifier.";
    BINARY_FORMAT "binary.format" Error "2.3" "2.5.1"
        "A library is a shared library.";
    BINARY_ARCHITECTURE "binary.architecture" Error "2.3" "2.5.1.4.1"
        "A library is for the machine and system that its folder says.";
    BINARY_SYMBOLS "binary.symbols" Error "2.1.1" "2.5"
        "A library exports the functions of its interfaces, of its capabilities and of the types of its variables.";
    BINARY_OPTIONAL_SYMBOLS "binary.optional-symbols" Warning "2.1.1" "2.5"
        "A library exports the functions of what it can't do as well.";
    BINARY_LIBRARIES "binary.libraries" Warning "2.3" "2.5.1.4.1"
        "A library needs no other libraries but those of every system and those beside it.";
    BINARY_RPATH "binary.rpath" Warning "2.3" "2.5.1.4.1"
        "A library that needs one beside it looks for it there: RPATH is $ORIGIN.";
    BINARY_STACK "binary.executable-stack" Warning "Octant" "Octant"
        "A library doesn't ask for an executable stack: new systems refuse to load it.";
    BINARY_GLIBC "binary.glibc" Warning "Octant" "Octant"
        "A library for Linux needs no newer C library than this machine has.";

    LOAD_TOOL "load.tool" Note "3.3.1, 4.3.1" "2.4.2"
        "It runs without the tool that made it; else it is loaded only with --allow-tool.";
    LOAD_NOT_TRIED "load.not-tried" Note "3.3.1, 4.3.1" "2.4.2"
        "Every interface is loaded; one that isn't says nothing about the FMU.";
    LOAD_OPENS "load.opens" Error "2.1.4, 2.3" "2.5.1"
        "The library for this machine can be loaded, and says that it is of the standard.";
    LOAD_SURVIVES "load.survives" Error "2.1" "2.2"
        "Nothing that is called crashes or hangs.";
    LOAD_INSTANTIATES "load.instantiates" Error "2.1.5, 2.1.6" "2.3.1"
        "An instance can be made, and initialized with the start values.";
    LOAD_STARTS "load.starts" Warning "2.2.7" "2.4.7.5"
        "Exact variables have the start value of the description when initialization begins.";
    LOAD_STEPS "load.steps" Error "4.2.2" "4.2"
        "A first step can be done.";
}
