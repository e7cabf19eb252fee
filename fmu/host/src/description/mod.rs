//! Content of a `modelDescription.xml`, of FMI 2.0 and FMI 3.0 in one form.
//!
//! [`read`] is tolerant: deviations of vendors from the standards are read as they are meant, and
//! [`Description::tolerated`] lists them. A text without a meaning is an error with its line.
//!
//! | module | idea |
//! |---|---|
//! | `text` | conversion of bytes in any encoding to text |
//! | `xml` | elements, attributes and their types, with the place of each |
//! | [`xml_limits`] | limits of an XML file, before it is parsed |
//! | `variable` | variables |
//! | `read` | parts that both standards share |
//! | `attributes` | attributes that both standards share |
//! | `fmi2`, `fmi3` | variables, types and structure of each |
//! | `schema` | elements and attributes in the standards |
//! | [`units`] | conversion between units, with a check of their dimension |

mod attributes;
mod encoding;
mod fmi2;
mod fmi3;
mod read;
pub mod schema;
mod text;
pub mod units;
mod variable;
pub mod xml;
pub mod xml_limits;

pub use read::{of_fmi_1, read, read_bytes};
pub use text::{decode, is_of_fmi_1};
pub use variable::{
    Alias, ArrayDimension, Causality, ClockProperties, Initial, IntervalVariability, Variability,
    Variable, VariableType,
};

/// Reason why a model description can't be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{}{place}: {found}, expected {expected}", Line(*.line))]
pub struct DescriptionError {
    /// File name.
    pub file: String,
    /// Line, if the problem has one.
    pub line: Option<u32>,
    /// Element and attribute.
    pub place: String,
    /// Text found.
    pub found: String,
    /// Text expected.
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

/// Largest number of elements of the arrays of an FMU together: 128 MiB of numbers. A dimension is
/// a 64-bit number in the file, and the importer has to provide the memory.
pub const ELEMENTS_MAX: u64 = 1 << 24;

/// Largest number of variables of a description. The largest in use have some hundred thousand.
pub const VARIABLES_MAX: usize = 1_000_000;

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
    /// Standard of the description.
    pub standard: Standard,
    /// `fmiVersion` as written.
    pub fmi_version: String,
    /// `modelName`.
    pub model_name: String,
    /// `guid` or `instantiationToken`.
    pub token: String,
    /// `description`, empty if missing.
    pub description: String,
    /// `version` of the model, empty if missing.
    pub version: String,
    /// `generationTool`, empty if missing.
    pub generation_tool: String,
    /// True for `structured` naming.
    pub structured_names: bool,
    /// Capabilities in co-simulation; `None`: not available.
    pub co_simulation: Option<Interface>,
    /// Capabilities in model exchange; `None`: not available.
    pub model_exchange: Option<Interface>,
    /// Capabilities in scheduled execution (FMI 3.0); `None`: not available.
    pub scheduled_execution: Option<Interface>,
    /// Names of the log categories.
    pub log_categories: Vec<String>,
    /// Start, stop, tolerance and step, as far as given.
    pub default_experiment: DefaultExperiment,
    /// Units by name.
    pub units: Vec<UnitDefinition>,
    /// Enumeration types by name: the items' values and names.
    pub enumerations: Vec<(String, Vec<(i64, String)>)>,
    /// The variables in the order of the file.
    pub variables: Vec<Variable>,
    /// Outputs, derivatives, initial unknowns and event indicators.
    pub structure: ModelStructure,
    /// Number of event indicators (FMI 2.0: the attribute; FMI 3.0: those in the structure, of one
    /// element each unless their variables are arrays).
    pub event_indicators: usize,
    /// Deviations of the file from the standard, and how they were read.
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
    /// Model exchange: true if the FMU has to be told the end of every integrator step
    /// (`completedIntegratorStepNotNeeded` is false, or `needsCompletedIntegratorStep` true).
    pub completed_step_needed: bool,
    /// `providesEvaluateDiscreteStates` (FMI 3.0).
    pub evaluates_discrete_states: bool,
}

/// The default experiment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DefaultExperiment {
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
pub struct UnitDefinition {
    /// Name of the unit.
    pub name: String,
    /// Exponents of kg, m, s, A, K, mol, cd, rad; `None`: not in the file.
    pub base: Option<BaseUnit>,
    /// Units for display.
    pub display: Vec<DisplayUnit>,
}

/// A unit for displaying values of another: shown = factor · value + offset, or factor / value if
/// it is inverse.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayUnit {
    /// Name of the display unit.
    pub name: String,
    /// Factor.
    pub factor: f64,
    /// Offset: the value shown for zero.
    pub offset: f64,
    /// `inverse` (FMI 3.0).
    pub inverse: bool,
}

/// Definition of a unit in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseUnit {
    /// Exponents of kg, m, s, A, K, mol, cd, rad.
    pub exponents: [i8; 8],
    /// SI value of one unit.
    pub factor: f64,
    /// SI value of zero units.
    pub offset: f64,
}

/// The structure of a model, as value references.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelStructure {
    /// Outputs with their dependencies.
    pub outputs: Vec<ModelUnknown>,
    /// Continuous-state derivatives with their dependencies.
    pub derivatives: Vec<ModelUnknown>,
    /// Clocked states (FMI 3.0).
    pub clocked_states: Vec<ModelUnknown>,
    /// Initial unknowns with their dependencies.
    pub initial_unknowns: Vec<ModelUnknown>,
    /// Event indicators (FMI 3.0).
    pub event_indicators: Vec<ModelUnknown>,
}

/// An unknown and its dependencies.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelUnknown {
    /// Value reference.
    pub reference: u32,
    /// Value references on which it depends; `None`: not in the file, so that it depends on
    /// everything.
    pub depends_on: Option<Vec<u32>>,
}

impl Description {
    /// Finds the variable with this name or alias.
    #[must_use]
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables
            .iter()
            .find(|variable| variable.name == name)
            .or_else(|| self.variables.iter().find(|variable| variable.has_alias(name)))
    }

    /// Finds the first variable with this value reference.
    #[must_use]
    pub fn by_reference(&self, reference: u32) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.reference == reference)
    }

    /// Finds the unit with this name.
    #[must_use]
    pub fn unit(&self, name: &str) -> Option<&UnitDefinition> {
        self.units.iter().find(|unit| unit.name == name)
    }

    /// Items of an enumeration type: value and name.
    #[must_use]
    pub fn enumeration(&self, name: &str) -> Option<&[(i64, String)]> {
        self.enumerations.iter().find(|(other, _)| other == name).map(|(_, items)| &items[..])
    }

    /// Number of elements of a variable: 1 for a scalar, the product of its dimensions for an
    /// array, with structural parameters at their start values.
    ///
    /// # Errors
    /// If a dimension isn't known, or there are more than [`ELEMENTS_MAX`].
    pub fn elements(&self, variable: &Variable) -> Result<usize, DescriptionError> {
        self.elements_by(variable, |reference| self.by_reference(reference))
    }

    /// Counts as [`Self::elements`], with an index of the value references.
    fn elements_by<'v>(
        &self,
        variable: &Variable,
        by_reference: impl Fn(u32) -> Option<&'v Variable>,
    ) -> Result<usize, DescriptionError> {
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
                ArrayDimension::Fixed(size) => size,
                ArrayDimension::Of(reference) => by_reference(reference)
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

#[cfg(test)]
mod tests;
