//! What a `modelDescription.xml` says, of FMI 2.0 and FMI 3.0 in one form.

use serde::{Deserialize, Serialize};

/// The standard that an FMU follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Standard {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

/// A model description.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// The standard.
    pub standard: Standard,
    /// `fmiVersion` as written.
    pub fmi_version: String,
    /// `modelName`.
    pub model_name: String,
    /// `guid` or `instantiationToken`.
    pub token: String,
    /// `description`, empty where there is none.
    pub description: String,
    /// `generationTool`, empty where there is none.
    pub generation_tool: String,
    /// `structured` naming.
    pub structured_names: bool,
    /// What it can do in co-simulation; `None`: nothing.
    pub co_simulation: Option<Interface>,
    /// What it can do in model exchange; `None`: nothing.
    pub model_exchange: Option<Interface>,
    /// It has scheduled execution.
    pub scheduled_execution: bool,
    /// Names of the log categories.
    pub log_categories: Vec<String>,
    /// Start, stop, tolerance and step, as far as given.
    pub default_experiment: Experiment,
    /// Units by name.
    pub units: Vec<Unit>,
    /// Enumeration types by name: the items' values and names.
    pub enumerations: Vec<(String, Vec<(i64, String)>)>,
    /// The variables in the order of the file.
    pub variables: Vec<Variable>,
    /// Outputs, derivatives, initial unknowns and event indicators.
    pub structure: Structure,
    /// Number of event indicators (FMI 2.0: the attribute; FMI 3.0: those in the structure, of one
    /// element each unless their variables are arrays).
    pub event_indicators: usize,
    /// What the file does not do as the standard says, and what was made of it.
    pub tolerated: Vec<String>,
}

/// Capabilities of an interface type.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Interface {
    /// `modelIdentifier`: stem of the library.
    pub model_identifier: String,
    /// `needsExecutionTool`.
    pub needs_execution_tool: bool,
    /// `canBeInstantiatedOnlyOncePerProcess`.
    pub only_once_per_process: bool,
    /// `canHandleVariableCommunicationStepSize`.
    pub variable_step: bool,
    /// `fixedInternalStepSize`, s (FMI 3.0).
    pub fixed_internal_step_s: Option<f64>,
    /// `canGetAndSetFMUState`.
    pub state: bool,
    /// `canSerializeFMUState`.
    pub serialized_state: bool,
    /// `providesDirectionalDerivative(s)`.
    pub directional_derivatives: bool,
    /// `providesAdjointDerivatives` (FMI 3.0).
    pub adjoint_derivatives: bool,
    /// `providesIntermediateUpdate` (FMI 3.0).
    pub intermediate_update: bool,
    /// `mightReturnEarlyFromDoStep` (FMI 3.0).
    pub might_return_early: bool,
    /// `canReturnEarlyAfterIntermediateUpdate` (FMI 3.0).
    pub returns_early_on_request: bool,
    /// `hasEventMode` (FMI 3.0).
    pub event_mode: bool,
    /// `canRunAsynchronuously` (FMI 2.0).
    pub asynchronous: bool,
}

/// The default experiment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// Start, s.
    pub start_s: Option<f64>,
    /// Stop, s.
    pub stop_s: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Step, s.
    pub step_s: Option<f64>,
}

/// A unit: value in SI base units = factor · value + offset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// Its name.
    pub name: String,
    /// Exponents of kg, m, s, A, K, mol, cd, rad; `None`: the file doesn't say.
    pub base: Option<BaseUnit>,
    /// Display units: name, factor, offset: display = factor · value + offset.
    pub display: Vec<(String, f64, f64)>,
}

/// What a unit is in SI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaseUnit {
    /// Exponents of kg, m, s, A, K, mol, cd, rad.
    pub exponents: [i8; 8],
    /// SI value of one of it.
    pub factor: f64,
    /// SI value of zero of it.
    pub offset: f64,
}

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[allow(missing_docs, reason = "named as in FMI 3.0")]
pub enum Kind {
    Float64,
    Float32,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Boolean,
    String,
    Binary,
    Enumeration,
    Clock,
}

/// What a variable is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Causality {
    StructuralParameter,
    Parameter,
    CalculatedParameter,
    Input,
    Output,
    Local,
    Independent,
}

/// When a variable changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Variability {
    Constant,
    Fixed,
    Tunable,
    Discrete,
    Continuous,
}

/// Where a variable's first value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Initial {
    Exact,
    Approx,
    Calculated,
}

/// One dimension of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Dimension {
    /// So many.
    Fixed(u64),
    /// As many as the structural parameter with this value reference says.
    Of(u32),
}

/// A variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// `valueReference`.
    pub reference: u32,
    /// `description`, empty where there is none.
    pub description: String,
    /// Its type.
    pub kind: Kind,
    /// Name of its enumeration type, where it is one.
    pub enumeration: Option<String>,
    /// Causality; the default of the standard where the file has none.
    pub causality: Causality,
    /// Variability; the default of the standard where the file has none.
    pub variability: Variability,
    /// As written, or as the standard's table says.
    pub initial: Option<Initial>,
    /// Its dimensions; none: a scalar.
    pub dimensions: Vec<Dimension>,
    /// Start values as written, one an element (one in all: the same for each).
    pub start: Vec<String>,
    /// Smallest value.
    pub min: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// Usual size.
    pub nominal: Option<f64>,
    /// Name of its unit, its own or its type's.
    pub unit: Option<String>,
    /// Name of its display unit.
    pub display_unit: Option<String>,
    /// The variable whose derivative it is: its index in FMI 2.0 made the value reference.
    pub derivative_of: Option<u32>,
    /// Value references of its clocks (FMI 3.0).
    pub clocks: Vec<u32>,
    /// `intervalVariability` of a clock (FMI 3.0).
    pub interval_variability: Option<String>,
    /// `mimeType` of a Binary.
    pub mime_type: Option<String>,
    /// Line of the file.
    pub line: u32,
}

/// The structure of a model, as value references.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Structure {
    /// Outputs with their dependencies.
    pub outputs: Vec<Unknown>,
    /// Continuous-state derivatives with their dependencies.
    pub derivatives: Vec<Unknown>,
    /// Clocked states (FMI 3.0).
    pub clocked_states: Vec<Unknown>,
    /// Initial unknowns with their dependencies.
    pub initial_unknowns: Vec<Unknown>,
    /// Event indicators (FMI 3.0).
    pub event_indicators: Vec<Unknown>,
}

/// An unknown and what it depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unknown {
    /// Value reference.
    pub reference: u32,
    /// Value references that it depends on; `None`: the file doesn't say, so on everything.
    pub depends_on: Option<Vec<u32>>,
}
