//! Functions that an FMU has to have: by its interfaces, its capabilities, and the types of its
//! variables.

use octant_fmu_host::description::{
    Causality, ClockProperties, Description, Initial, Interface, IntervalVariability, Variability,
    Variable, VariableType,
};

/// Interface of an FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OneInterface {
    /// Model exchange.
    ModelExchange,
    /// Co-simulation.
    CoSimulation,
    /// Scheduled execution.
    ScheduledExecution,
}

/// Functions that belong to one interface; all others belong to every interface.
const OF_INTERFACE: [(OneInterface, &str); 3] = [
    (
        OneInterface::ModelExchange,
        "fmi2EnterEventMode fmi2NewDiscreteStates fmi2EnterContinuousTimeMode \
         fmi2CompletedIntegratorStep fmi2SetTime fmi2SetContinuousStates fmi2GetDerivatives \
         fmi2GetEventIndicators fmi2GetContinuousStates fmi2GetNominalsOfContinuousStates \
         fmi3InstantiateModelExchange fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep \
         fmi3SetTime fmi3SetContinuousStates fmi3GetContinuousStateDerivatives \
         fmi3GetEventIndicators fmi3GetContinuousStates fmi3GetNominalsOfContinuousStates \
         fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates",
    ),
    (
        OneInterface::CoSimulation,
        "fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives fmi2DoStep fmi2CancelStep \
         fmi2GetStatus fmi2GetRealStatus fmi2GetIntegerStatus fmi2GetBooleanStatus \
         fmi2GetStringStatus fmi3InstantiateCoSimulation fmi3EnterStepMode \
         fmi3GetOutputDerivatives fmi3DoStep",
    ),
    (
        OneInterface::ScheduledExecution,
        "fmi3InstantiateScheduledExecution fmi3ActivateModelPartition",
    ),
];

/// Interface to which a function belongs; none: all of them.
#[must_use]
pub fn interface_of(function: &str) -> Option<OneInterface> {
    let mut interfaces = OF_INTERFACE.into_iter();
    interfaces.find(|(_, names)| names.split(' ').any(|name| name == function)).map(|(of, _)| of)
}

/// Returns whether the function belongs to an interface of the FMU, or to all interfaces.
pub(super) fn is_of_interface(description: &Description, function: &str) -> bool {
    match interface_of(function) {
        Some(OneInterface::ModelExchange) => description.model_exchange.is_some(),
        Some(OneInterface::CoSimulation) => description.co_simulation.is_some(),
        Some(OneInterface::ScheduledExecution) => description.scheduled_execution.is_some(),
        None => true,
    }
}

/// Returns whether a promise of the description requires the function. The standards demand the
/// other functions as well, but no importer calls them.
pub(super) fn is_needed(description: &Description, function: &str) -> bool {
    let name = function.get(4..).unwrap_or(function);
    let can = |capability: fn(&Interface) -> bool| {
        let interfaces = description.co_simulation.iter().chain(&description.model_exchange);
        interfaces.into_iter().any(capability)
    };
    // Variables that can't be set need no function that sets them.
    let sets = name.starts_with("Set");
    let has = |kind: VariableType| {
        description
            .variables
            .iter()
            .any(|variable| variable.kind == kind && (!sets || is_settable(variable)))
    };
    // FMI 2.0 reads enumerations as integers.
    let of_type = |name: &str| match name {
        "Real" => has(VariableType::Float64),
        "Integer" => has(VariableType::Int32) || has(VariableType::Enumeration),
        "Int64" => has(VariableType::Int64) || has(VariableType::Enumeration),
        name => VariableType::ALL.into_iter().any(|kind| kind.name() == name && has(kind)),
    };
    match name {
        "GetFMUstate" | "SetFMUstate" | "FreeFMUstate" | "GetFMUState" | "SetFMUState"
        | "FreeFMUState" => can(|interface| interface.state),
        "SerializedFMUstateSize"
        | "SerializeFMUstate"
        | "DeSerializeFMUstate"
        | "SerializedFMUStateSize"
        | "SerializeFMUState"
        | "DeserializeFMUState" => can(|interface| interface.serialized_state),
        "GetDirectionalDerivative" => can(|interface| interface.directional_derivatives),
        "GetAdjointDerivative" => can(|interface| interface.adjoint_derivatives),
        "SetRealInputDerivatives" => can(|interface| interface.interpolates_inputs),
        "GetRealOutputDerivatives" | "GetOutputDerivatives" => {
            can(|interface| interface.output_derivative_order > 0)
        }
        // No status of the standard is an integer, and the only text is for users.
        "GetIntegerStatus" | "GetStringStatus" => false,
        "CancelStep" | "GetStatus" | "GetRealStatus" | "GetBooleanStatus" => {
            can(|interface| interface.asynchronous)
        }
        "EnterEventMode" | "UpdateDiscreteStates" | "EnterStepMode" => {
            description.model_exchange.is_some() || can(|interface| interface.event_mode)
        }
        "EvaluateDiscreteStates" => can(|interface| interface.evaluates_discrete_states),
        "EnterConfigurationMode" | "ExitConfigurationMode" => description
            .variables
            .iter()
            .any(|variable| variable.causality == Causality::StructuralParameter),
        "GetNumberOfVariableDependencies" | "GetVariableDependencies" => false,
        "GetIntervalDecimal" => has_clock(description, |_| true),
        "GetIntervalFraction" => has_clock(description, |clock| clock.supports_fraction),
        // Importers that don't call these use the values of the description.
        "GetShiftDecimal"
        | "GetShiftFraction"
        | "SetIntervalDecimal"
        | "SetIntervalFraction"
        | "SetShiftDecimal"
        | "SetShiftFraction" => false,
        _ => match name.strip_prefix("Get").or_else(|| name.strip_prefix("Set")) {
            Some("Version" | "TypesPlatform") => true,
            Some("DebugLogging") => !description.log_categories.is_empty(),
            Some(
                of @ ("Real" | "Integer" | "Float32" | "Float64" | "Int8" | "UInt8" | "Int16"
                | "UInt16" | "Int32" | "UInt32" | "Int64" | "UInt64" | "Boolean" | "String"
                | "Binary" | "Clock"),
            ) => of_type(of),
            _ => true,
        },
    }
}

/// Returns whether the variable can be set at some time.
fn is_settable(variable: &Variable) -> bool {
    variable.variability != Variability::Constant
        && (matches!(
            variable.causality,
            Causality::Input | Causality::Parameter | Causality::StructuralParameter
        ) || matches!(variable.initial, Some(Initial::Exact | Initial::Approx)))
}

/// Returns whether there is a clock whose interval comes from the FMU, and for which `and` is true.
fn has_clock(description: &Description, and: impl Fn(&ClockProperties) -> bool) -> bool {
    use IntervalVariability::{Changing, Countdown, Tunable};
    description.variables.iter().filter_map(|variable| variable.clock.as_ref()).any(|clock| {
        matches!(clock.interval_variability, Tunable | Changing | Countdown) && and(clock)
    })
}
