//! FMI 3.0: typed elements, arrays, aliases, clocks, and a structure by value references.

use super::attributes::{
    causality, default_initial, default_variability, initial, interface, optional, room,
    variability,
};
use super::fmi2::items;
use super::xml::Element;
use super::{
    Alias, ArrayDimension, Causality, ClockProperties, Description, DescriptionError,
    IntervalVariability, ModelUnknown, Standard, Variable, VariableType,
};
use std::collections::{BTreeMap, BTreeSet};

/// The type definitions by name.
type Types<'a, 't> = BTreeMap<&'a str, Element<'a, 't>>;

/// Reads the parts specific to FMI 3.0, after [`super::read()`].
pub(super) fn read<'a, 't: 'a>(
    root: Element<'a, 't>,
    description: &mut Description,
) -> Result<(), DescriptionError> {
    root.required("instantiationToken")?.clone_into(&mut description.token);
    let names = ["canGetAndSetFMUState", "canSerializeFMUState", "providesDirectionalDerivatives"];
    let common = |element: Element<'a, 't>| {
        let mut interface = interface(element, names)?;
        interface.adjoint_derivatives = element.boolean("providesAdjointDerivatives")?;
        interface.evaluates_discrete_states = element.boolean("providesEvaluateDiscreteStates")?;
        Ok::<_, DescriptionError>(interface)
    };
    if let Some(element) = root.child("CoSimulation") {
        let mut interface = common(element)?;
        interface.fixed_internal_step_s = element.real("fixedInternalStepSize")?;
        interface.intermediate_update = element.boolean("providesIntermediateUpdate")?;
        interface.might_return_early = element.boolean("mightReturnEarlyFromDoStep")?;
        interface.returns_early_on_request =
            element.boolean("canReturnEarlyAfterIntermediateUpdate")?;
        interface.event_mode = element.boolean("hasEventMode")?;
        description.co_simulation = Some(interface);
    }
    if let Some(element) = root.child("ModelExchange") {
        let mut interface = common(element)?;
        interface.completed_step_needed = element.boolean("needsCompletedIntegratorStep")?;
        description.model_exchange = Some(interface);
    }
    if let Some(element) = root.child("ScheduledExecution") {
        description.scheduled_execution = Some(common(element)?);
    }
    let types = types(root, description)?;
    let Some(list) = root.child("ModelVariables") else {
        return Err(root.error(None, "no ModelVariables", "the variables, at least time"));
    };
    for element in list.children() {
        let kind = VariableType::ALL.into_iter().find(|kind| kind.name() == element.name());
        let Some(kind) = kind else {
            // Minor versions of the standard may add types.
            continue;
        };
        room(element, description)?;
        description.variables.push(read_variable(element, kind, &types)?);
    }
    structure(root, description)?;
    // A map, because both lists may have a million entries.
    let mut variables: BTreeMap<u32, &Variable> = BTreeMap::new();
    for variable in &description.variables {
        variables.entry(variable.reference).or_insert(variable);
    }
    let mut indicators = 0usize;
    for unknown in &description.structure.event_indicators {
        let Some(variable) = variables.get(&unknown.reference) else { continue };
        let elements =
            description.elements_by(variable, |reference| variables.get(&reference).copied())?;
        indicators = indicators.saturating_add(elements);
    }
    description.event_indicators = indicators;
    Ok(())
}

/// Reads the type definitions; enumerations go into the description.
fn types<'a, 't: 'a>(
    root: Element<'a, 't>,
    description: &mut Description,
) -> Result<Types<'a, 't>, DescriptionError> {
    let mut types = Types::new();
    let Some(list) = root.child("TypeDefinitions") else { return Ok(types) };
    for element in list.children() {
        let known = element
            .name()
            .strip_suffix("Type")
            .is_some_and(|name| VariableType::ALL.iter().any(|kind| kind.name() == name));
        if !known {
            continue;
        }
        let name = element.required("name")?;
        if element.name() == "EnumerationType" {
            description.enumerations.push((name.to_owned(), items(element)?));
        }
        types.insert(name, element);
    }
    Ok(types)
}

/// Sources of an attribute: first the element, second its type.
#[derive(Clone, Copy)]
struct Typed<'a, 't> {
    own: Element<'a, 't>,
    base: Option<Element<'a, 't>>,
}

impl<'a, 't: 'a> Typed<'a, 't> {
    fn of(self, attribute: &str) -> Element<'a, 't> {
        match self.base {
            Some(base) if self.own.text(attribute).is_none() => base,
            _ => self.own,
        }
    }

    fn word(self, attribute: &str) -> Option<String> {
        self.of(attribute).text(attribute).filter(|text| !text.is_empty()).map(str::to_owned)
    }
}

fn read_variable<'a, 't: 'a>(
    element: Element<'a, 't>,
    kind: VariableType,
    types: &Types<'a, 't>,
) -> Result<Variable, DescriptionError> {
    let name = element.required("name")?.to_owned();
    let reference = element.whole("valueReference")?.ok_or_else(|| {
        element.error(Some("valueReference"), "the attribute is missing", "a number")
    })?;
    let causality = causality(element)?.unwrap_or(Causality::Local);
    let variability = variability(element)?.unwrap_or_else(|| default_variability(kind, causality));
    let declared = element.text("declaredType");
    let mut base = declared.and_then(|name| types.get(name).copied());
    if let (Some(name), None) = (declared, base) {
        element.tolerate("unknown declaredType", || format!("its type {name:?} is not defined"));
    }
    if let Some(definition) = base
        && definition.name().strip_suffix("Type") != Some(element.name())
    {
        element.tolerate("declaredType of another type", || {
            format!("its type {:?} is {}", declared.unwrap_or_default(), definition.name())
        });
        base = None;
    }
    let typed = Typed { own: element, base };
    let dimensions = dimensions(element)?;
    let start = start(element, kind, dimensions.is_empty());
    let aliases = element
        .children()
        .filter(|child| child.name() == "Alias")
        .map(|alias| {
            Ok(Alias {
                name: alias.required("name")?.to_owned(),
                description: optional(alias, "description"),
                display_unit: alias.text("displayUnit").map(str::to_owned),
            })
        })
        .collect::<Result<_, DescriptionError>>()?;
    let initial = match kind {
        VariableType::Clock => None,
        _ => initial(element)?.or_else(|| default_initial(Standard::Fmi3, causality, variability)),
    };
    Ok(Variable {
        name,
        reference,
        description: optional(element, "description"),
        kind,
        enumeration: declared.filter(|_| kind == VariableType::Enumeration).map(str::to_owned),
        causality,
        variability,
        initial,
        dimensions,
        start,
        min: typed.of("min").real("min")?,
        max: typed.of("max").real("max")?,
        nominal: typed.of("nominal").real("nominal")?,
        unit: typed.word("unit"),
        display_unit: typed.word("displayUnit"),
        relative_quantity: typed.of("relativeQuantity").boolean("relativeQuantity")?,
        declared_type: declared.map(str::to_owned),
        aliases,
        derivative_of: element.whole("derivative")?,
        clocks: element.list("clocks")?.unwrap_or_default(),
        previous: element.whole("previous")?,
        clock: (kind == VariableType::Clock).then(|| clock(typed)).transpose()?,
        mime_type: (kind == VariableType::Binary)
            .then(|| typed.word("mimeType").unwrap_or_else(|| "application/octet-stream".into())),
        line: element.line(),
    })
}

fn dimensions(element: Element<'_, '_>) -> Result<Vec<ArrayDimension>, DescriptionError> {
    element
        .children()
        .filter(|child| child.name() == "Dimension")
        .map(|child| match (child.whole("start")?, child.whole("valueReference")?) {
            (Some(size), None) => Ok(ArrayDimension::Fixed(size)),
            (None, Some(reference)) => Ok(ArrayDimension::Of(reference)),
            (None, None) => Err(child.error(None, "no size", "start or valueReference")),
            (Some(_), Some(_)) => {
                Err(child.error(None, "both start and valueReference", "one of both"))
            }
        })
        .collect()
}

/// Start values as written: lists in an attribute, or one element each for String and Binary.
fn start(element: Element<'_, '_>, kind: VariableType, scalar: bool) -> Vec<String> {
    let elements = element.children().filter(|child| child.name() == "Start");
    let mut values: Vec<String> =
        elements.filter_map(|child| child.text("value")).map(str::to_owned).collect();
    let Some(attribute) = element.text("start") else { return values };
    if matches!(kind, VariableType::String | VariableType::Binary) {
        element.tolerate("start as attribute", || {
            "start is an attribute, expected an element Start".into()
        });
        if scalar || kind == VariableType::String {
            values.push(attribute.to_owned());
            return values;
        }
    }
    attribute.split_ascii_whitespace().map(str::to_owned).collect()
}

fn clock(typed: Typed<'_, '_>) -> Result<ClockProperties, DescriptionError> {
    let attribute = "intervalVariability";
    let interval_variability = typed
        .of(attribute)
        .one_of(attribute, &IntervalVariability::WORDS)?
        .ok_or_else(|| typed.own.error(Some(attribute), "the attribute is missing", "a word"))?;
    Ok(ClockProperties {
        interval_variability,
        interval_s: typed.of("intervalDecimal").real("intervalDecimal")?,
        shift_s: typed.of("shiftDecimal").real("shiftDecimal")?.unwrap_or(0.0),
        supports_fraction: typed.of("supportsFraction").boolean("supportsFraction")?,
        resolution: typed.of("resolution").whole("resolution")?,
        interval_counter: typed.of("intervalCounter").whole("intervalCounter")?,
        shift_counter: typed.of("shiftCounter").whole("shiftCounter")?.unwrap_or(0),
        priority: typed.of("priority").whole("priority")?,
        can_be_deactivated: typed.of("canBeDeactivated").boolean("canBeDeactivated")?,
    })
}

fn structure(root: Element<'_, '_>, description: &mut Description) -> Result<(), DescriptionError> {
    let Some(list) = root.child("ModelStructure") else {
        root.tolerate("missing element", || "ModelStructure is missing".into());
        return Ok(());
    };
    let known: BTreeSet<u32> =
        description.variables.iter().map(|variable| variable.reference).collect();
    for element in list.children() {
        let into = match element.name() {
            "Output" => &mut description.structure.outputs,
            "ContinuousStateDerivative" => &mut description.structure.derivatives,
            "ClockedState" => &mut description.structure.clocked_states,
            "InitialUnknown" => &mut description.structure.initial_unknowns,
            "EventIndicator" => &mut description.structure.event_indicators,
            _ => continue,
        };
        let attribute = "valueReference";
        let reference: u32 = element.whole(attribute)?.ok_or_else(|| {
            element.error(Some(attribute), "the attribute is missing", "a number")
        })?;
        if !known.contains(&reference) {
            // Without its state a derivative can't be integrated; an output isn't needed here.
            let needed = matches!(element.name(), "ContinuousStateDerivative" | "EventIndicator");
            if needed && description.model_exchange.is_some() {
                let found = format!("{reference}, which no variable has");
                return Err(element.error(Some(attribute), found, "one of a variable"));
            }
            element.tolerate("reference of no variable", || {
                format!("value reference {reference} is of no variable, left out")
            });
            continue;
        }
        let mut depends_on: Option<Vec<u32>> = element.list("dependencies")?;
        if depends_on.as_ref().is_some_and(|list| list.iter().any(|one| !known.contains(one))) {
            element.tolerate("reference of no variable", || {
                "a dependency is no variable: it is taken to depend on everything".into()
            });
            depends_on = None;
        }
        into.push(ModelUnknown { reference, depends_on });
    }
    Ok(())
}
