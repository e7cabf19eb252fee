//! Attributes that both standards share: of interfaces and of variables.

use super::xml::Element;
use super::{
    Causality, Description, DescriptionError, Initial, Interface, Standard, VARIABLES_MAX,
    Variability, VariableType,
};

/// Reads an attribute, empty if missing.
pub(super) fn optional(element: Element<'_, '_>, attribute: &str) -> String {
    element.text(attribute).unwrap_or_default().to_owned()
}

/// Checks that there is room for one more variable, that of an element.
pub(super) fn room(
    element: Element<'_, '_>,
    description: &Description,
) -> Result<(), DescriptionError> {
    if description.variables.len() < VARIABLES_MAX {
        return Ok(());
    }
    let found = format!("variable {}", VARIABLES_MAX + 1);
    Err(element.error(None, found, format!("at most {VARIABLES_MAX} variables")))
}

/// Reads the common part of the interfaces of both standards. `names`: spelling of the attributes
/// of states and directional derivatives in the standard.
pub(super) fn interface(
    element: Element<'_, '_>,
    [state, serialized, directional]: [&str; 3],
) -> Result<Interface, DescriptionError> {
    Ok(Interface {
        model_identifier: element.required("modelIdentifier")?.trim().to_owned(),
        needs_execution_tool: element.boolean("needsExecutionTool")?,
        only_once_per_process: element.boolean("canBeInstantiatedOnlyOncePerProcess")?,
        variable_step: element.boolean("canHandleVariableCommunicationStepSize")?,
        state: element.boolean(state)?,
        serialized_state: element.boolean(serialized)?,
        directional_derivatives: element.boolean(directional)?,
        output_derivative_order: element.whole("maxOutputDerivativeOrder")?.unwrap_or(0),
        ..Interface::default()
    })
}

/// Reads `causality` as written.
pub(super) fn causality(element: Element<'_, '_>) -> Result<Option<Causality>, DescriptionError> {
    element.one_of("causality", &Causality::WORDS)
}

/// Reads `variability` as written.
pub(super) fn variability(
    element: Element<'_, '_>,
) -> Result<Option<Variability>, DescriptionError> {
    element.one_of("variability", &Variability::WORDS)
}

/// Reads `initial` as written.
pub(super) fn initial(element: Element<'_, '_>) -> Result<Option<Initial>, DescriptionError> {
    element.one_of("initial", &Initial::WORDS)
}

/// Default of `variability`: that of FMI 3.0 by the type, also used for FMI 2.0 where its default,
/// continuous, makes no sense.
pub(super) fn default_variability(kind: VariableType, causality: Causality) -> Variability {
    match causality {
        Causality::Parameter | Causality::CalculatedParameter | Causality::StructuralParameter => {
            Variability::Fixed
        }
        _ if kind.is_float() => Variability::Continuous,
        _ => Variability::Discrete,
    }
}

/// Default of `initial`: the table of both standards (FMI 2.0, 2.2.7; FMI 3.0, 2.4.7.5). `None`: no
/// default exists, as for an input of FMI 2.0.
pub(crate) fn default_initial(
    standard: Standard,
    causality: Causality,
    variability: Variability,
) -> Option<Initial> {
    match (causality, variability) {
        (Causality::Input, _) if standard == Standard::Fmi3 => Some(Initial::Exact),
        (Causality::Parameter | Causality::StructuralParameter, _)
        | (Causality::Output | Causality::Local, Variability::Constant) => Some(Initial::Exact),
        (Causality::CalculatedParameter | Causality::Output | Causality::Local, _) => {
            Some(Initial::Calculated)
        }
        (Causality::Input | Causality::Independent, _) => None,
    }
}
