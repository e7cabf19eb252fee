//! What a `modelDescription.xml` says, of FMI 2.0 and FMI 3.0 in one form.
//!
//! [`read`] is tolerant: what vendors write beside the standards is taken as it is meant, and
//! [`Description::tolerated`] lists it. What leaves no meaning is an error with its line.
//!
//! | module | idea |
//! |---|---|
//! | `text` | bytes become text, whatever their encoding |
//! | `xml` | elements, attributes and their types, with the place of each |
//! | `read` | what both standards share |
//! | `fmi2`, `fmi3` | variables, types and structure of each |
//! | `schema` | which elements and attributes the standards know |
//! | [`units`] | conversion between units, with a check of their dimension |

mod fmi2;
mod fmi3;
mod read;
pub mod schema;
mod text;
pub mod units;
pub mod xml;

pub use read::{read, read_bytes};
pub use text::decode;

/// Why a model description can't be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{}{place}: {found}, expected {expected}", Line(*.line))]
pub struct DescriptionError {
    /// The file.
    pub file: String,
    /// The line, where it belongs to one.
    pub line: Option<u32>,
    /// Element and attribute.
    pub place: String,
    /// What is there.
    pub found: String,
    /// What should be there.
    pub expected: String,
}

/// A line number in a message.
struct Line(Option<u32>);

impl std::fmt::Display for Line {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            Some(line) => write!(f, "{line}: "),
            None => f.write_str(" "),
        }
    }
}

/// Most elements that the arrays of an FMU may have together: 128 MiB of numbers. A dimension is a
/// 64-bit number in the file, and the memory for it is ours.
pub const ELEMENTS_MAX: u64 = 1 << 24;

/// The standard that an FMU follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standard {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

/// A model description.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Name of the file, for messages.
    pub file: String,
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
    /// `version` of the model, empty where there is none.
    pub version: String,
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
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// `canInterpolateInputs` (FMI 2.0).
    pub interpolates_inputs: bool,
    /// `maxOutputDerivativeOrder`.
    pub output_derivative_order: u32,
    /// Model exchange: the end of every integrator step is to be told
    /// (`completedIntegratorStepNotNeeded` is false, or `needsCompletedIntegratorStep` true).
    pub completed_step_needed: bool,
    /// `providesEvaluateDiscreteStates` (FMI 3.0).
    pub evaluates_discrete_states: bool,
}

/// The default experiment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its name.
    pub name: String,
    /// Exponents of kg, m, s, A, K, mol, cd, rad; `None`: the file doesn't say.
    pub base: Option<BaseUnit>,
    /// Units in which it is shown.
    pub display: Vec<DisplayUnit>,
}

/// A unit in which values of another are shown: shown = factor · value + offset, or factor / value
/// where it is inverse.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayUnit {
    /// Its name.
    pub name: String,
    /// What is shown for one.
    pub factor: f64,
    /// What is shown for zero.
    pub offset: f64,
    /// `inverse` (FMI 3.0).
    pub inverse: bool,
}

/// What a unit is in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseUnit {
    /// Exponents of kg, m, s, A, K, mol, cd, rad.
    pub exponents: [i8; 8],
    /// SI value of one of it.
    pub factor: f64,
    /// SI value of zero of it.
    pub offset: f64,
}

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Variability {
    Constant,
    Fixed,
    Tunable,
    Discrete,
    Continuous,
}

/// Where a variable's first value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Initial {
    Exact,
    Approx,
    Calculated,
}

/// One dimension of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// So many.
    Fixed(u64),
    /// As many as the structural parameter with this value reference says.
    Of(u32),
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
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
    /// `relativeQuantity`: a difference, so that offsets of units don't count.
    pub relative_quantity: bool,
    /// `declaredType`.
    pub declared_type: Option<String>,
    /// Other names of it (FMI 3.0).
    pub aliases: Vec<Alias>,
    /// The variable whose derivative it is: its index in FMI 2.0 made the value reference.
    pub derivative_of: Option<u32>,
    /// Value references of its clocks (FMI 3.0).
    pub clocks: Vec<u32>,
    /// The variable that holds its value of the last event (FMI 3.0).
    pub previous: Option<u32>,
    /// What a clock is more than other variables (FMI 3.0).
    pub clock: Option<Clock>,
    /// `mimeType` of a Binary.
    pub mime_type: Option<String>,
    /// Line of the file.
    pub line: u32,
}

/// Another name of a variable (FMI 3.0).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alias {
    /// The name.
    pub name: String,
    /// `description`, empty where there is none.
    pub description: String,
    /// Name of its display unit.
    pub display_unit: Option<String>,
}

/// What a clock is (FMI 3.0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// `intervalVariability`.
    pub interval_variability: IntervalVariability,
    /// `intervalDecimal`, s.
    pub interval_s: Option<f64>,
    /// `shiftDecimal`, s.
    pub shift_s: f64,
    /// `supportsFraction`.
    pub supports_fraction: bool,
    /// `resolution`: counts in a second.
    pub resolution: Option<u64>,
    /// `intervalCounter`.
    pub interval_counter: Option<u64>,
    /// `shiftCounter`.
    pub shift_counter: u64,
    /// `priority`.
    pub priority: Option<u32>,
    /// `canBeDeactivated`.
    pub can_be_deactivated: bool,
}

/// When the interval of a clock changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as in FMI 3.0")]
pub enum IntervalVariability {
    Constant,
    Fixed,
    Tunable,
    Changing,
    Countdown,
    Triggered,
}

/// The structure of a model, as value references.
#[derive(Clone, Debug, Default, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// Value reference.
    pub reference: u32,
    /// Value references that it depends on; `None`: the file doesn't say, so on everything.
    pub depends_on: Option<Vec<u32>>,
}

impl Description {
    /// The variable of this name, or with an alias of this name.
    #[must_use]
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables
            .iter()
            .find(|variable| variable.name == name)
            .or_else(|| self.variables.iter().find(|variable| variable.has_alias(name)))
    }

    /// The first variable with this value reference.
    #[must_use]
    pub fn by_reference(&self, reference: u32) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.reference == reference)
    }

    /// The unit of this name.
    #[must_use]
    pub fn unit(&self, name: &str) -> Option<&Unit> {
        self.units.iter().find(|unit| unit.name == name)
    }

    /// The items of an enumeration type: value and name.
    #[must_use]
    pub fn enumeration(&self, name: &str) -> Option<&[(i64, String)]> {
        self.enumerations.iter().find(|(other, _)| other == name).map(|(_, items)| &items[..])
    }

    /// Number of elements of a variable: 1 of a scalar, the product of its dimensions of an array,
    /// with structural parameters at their start values.
    ///
    /// # Errors
    /// If a dimension isn't known, or there are more than [`ELEMENTS_MAX`].
    pub fn elements(&self, variable: &Variable) -> Result<usize, DescriptionError> {
        let fail = |found: String, expected: &str| DescriptionError {
            file: self.file.clone(),
            line: Some(variable.line),
            place: format!("dimensions of variable {:?}", variable.name),
            found,
            expected: expected.into(),
        };
        let mut elements = 1u64;
        for dimension in &variable.dimensions {
            let size = match *dimension {
                Dimension::Fixed(size) => size,
                Dimension::Of(reference) => self
                    .by_reference(reference)
                    .filter(|parameter| parameter.causality == Causality::StructuralParameter)
                    .and_then(|parameter| parameter.start.first()?.trim().parse().ok())
                    .ok_or_else(|| {
                        fail(
                            format!("value reference {reference} gives no size"),
                            "a structural parameter with a start value",
                        )
                    })?,
            };
            elements = elements
                .checked_mul(size)
                .filter(|&elements| elements <= ELEMENTS_MAX)
                .ok_or_else(|| fail("too many elements".into(), "at most 2^24"))?;
        }
        Ok(elements as usize)
    }
}

impl Variable {
    /// It has an alias of this name (FMI 3.0).
    #[must_use]
    pub fn has_alias(&self, name: &str) -> bool {
        self.aliases.iter().any(|alias| alias.name == name)
    }
}

impl Kind {
    /// Its name in FMI 3.0.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Float64 => "Float64",
            Self::Float32 => "Float32",
            Self::Int8 => "Int8",
            Self::UInt8 => "UInt8",
            Self::Int16 => "Int16",
            Self::UInt16 => "UInt16",
            Self::Int32 => "Int32",
            Self::UInt32 => "UInt32",
            Self::Int64 => "Int64",
            Self::UInt64 => "UInt64",
            Self::Boolean => "Boolean",
            Self::String => "String",
            Self::Binary => "Binary",
            Self::Enumeration => "Enumeration",
            Self::Clock => "Clock",
        }
    }

    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Float64,
        Self::Float32,
        Self::Int8,
        Self::UInt8,
        Self::Int16,
        Self::UInt16,
        Self::Int32,
        Self::UInt32,
        Self::Int64,
        Self::UInt64,
        Self::Boolean,
        Self::String,
        Self::Binary,
        Self::Enumeration,
        Self::Clock,
    ];

    /// It is a floating-point number.
    #[must_use]
    pub const fn is_float(self) -> bool {
        matches!(self, Self::Float64 | Self::Float32)
    }
}

#[cfg(test)]
mod tests;
