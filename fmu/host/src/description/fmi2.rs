//! FMI 2.0: scalar variables, simple types, and a structure by indices.

use super::attributes::{
    causality, default_initial, default_variability, initial, interface, optional, room,
    variability,
};
use super::xml::Element;
use super::{
    Causality, Description, DescriptionError, ModelUnknown, Standard, Variability, Variable,
    VariableType,
};
use std::collections::BTreeMap;

/// Types of a variable, by their element.
const TYPES: [(&str, VariableType); 5] = [
    ("Real", VariableType::Float64),
    ("Integer", VariableType::Int32),
    ("Boolean", VariableType::Boolean),
    ("String", VariableType::String),
    ("Enumeration", VariableType::Enumeration),
];

/// A simple type: its element `Real`, `Integer`, … with the attributes.
type Types<'a, 't> = BTreeMap<&'a str, Element<'a, 't>>;

/// Reads the parts specific to FMI 2.0, after [`super::read()`].
pub(super) fn read<'a, 't: 'a>(
    root: Element<'a, 't>,
    description: &mut Description,
) -> Result<(), DescriptionError> {
    root.required("guid")?.clone_into(&mut description.token);
    description.event_indicators = root.whole("numberOfEventIndicators")?.unwrap_or(0);
    let names = ["canGetAndSetFMUstate", "canSerializeFMUstate", "providesDirectionalDerivative"];
    if let Some(element) = root.child("CoSimulation") {
        let mut interface = interface(element, names)?;
        interface.asynchronous = element.boolean("canRunAsynchronuously")?;
        interface.interpolates_inputs = element.boolean("canInterpolateInputs")?;
        description.co_simulation = Some(interface);
    }
    if let Some(element) = root.child("ModelExchange") {
        let mut interface = interface(element, names)?;
        interface.completed_step_needed = !element.boolean("completedIntegratorStepNotNeeded")?;
        description.model_exchange = Some(interface);
    }
    let types = types(root, description)?;
    if let Some(list) = root.child("ModelVariables") {
        // The index of a derivative's state may point forward: it is resolved after all are read.
        let mut derivatives = Vec::new();
        for element in list.children() {
            if element.name() != "ScalarVariable" {
                continue;
            }
            room(element, description)?;
            let (variable, state) = read_variable(element, &types)?;
            if let Some(state) = state {
                derivatives.push((description.variables.len(), state, element));
            }
            description.variables.push(variable);
        }
        for (place, index, element) in derivatives {
            let state = by_index(description, index);
            if state.is_none() {
                let found = format!("index {index}");
                let expected = format!("1 to {}", description.variables.len());
                // Without its state a derivative can't be integrated.
                if description.model_exchange.is_some() {
                    return Err(element.error(Some("derivative"), found, expected));
                }
                element.tolerate("index out of range", || {
                    format!("derivative of {found} is left out, expected {expected}")
                });
            }
            description.variables[place].derivative_of = state;
        }
    } else {
        root.tolerate("missing element", || "ModelVariables is missing".into());
    }
    structure(root, description)
}

/// Reads the simple types; enumerations go into the description.
fn types<'a, 't: 'a>(
    root: Element<'a, 't>,
    description: &mut Description,
) -> Result<Types<'a, 't>, DescriptionError> {
    let mut types = Types::new();
    let Some(list) = root.child("TypeDefinitions") else { return Ok(types) };
    for element in list.children().filter(|child| child.name() == "SimpleType") {
        let name = element.required("name")?;
        let known = |child: &Element<'_, '_>| TYPES.iter().any(|(tag, _)| *tag == child.name());
        let Some(definition) = element.children().find(known) else {
            continue;
        };
        if definition.name() == "Enumeration" {
            description.enumerations.push((name.to_owned(), items(definition)?));
        }
        types.insert(name, definition);
    }
    Ok(types)
}

/// Reads the items of an enumeration.
pub(super) fn items(element: Element<'_, '_>) -> Result<Vec<(i64, String)>, DescriptionError> {
    let mut items = Vec::new();
    for item in element.children().filter(|child| child.name() == "Item") {
        let value = match item.whole("value")? {
            Some(value) => value,
            None => {
                item.tolerate("item without value", || "no value, its place counts".into());
                items.len() as i64 + 1
            }
        };
        items.push((value, item.required("name")?.to_owned()));
    }
    Ok(items)
}

/// Reads a variable, and the index of the variable whose derivative it is.
fn read_variable<'a, 't: 'a>(
    element: Element<'a, 't>,
    types: &Types<'a, 't>,
) -> Result<(Variable, Option<u64>), DescriptionError> {
    let name = element.required("name")?.to_owned();
    let reference = element.whole("valueReference")?.ok_or_else(|| {
        element.error(Some("valueReference"), "the attribute is missing", "a number")
    })?;
    let found = element.children().find_map(|child| {
        TYPES.iter().find(|(tag, _)| *tag == child.name()).map(|&(_, kind)| (child, kind))
    });
    let (value, kind) = found.ok_or_else(|| {
        element.error(None, "no type", "Real, Integer, Boolean, String or Enumeration")
    })?;
    let causality = causality(element)?.unwrap_or(Causality::Local);
    let variability = match variability(element)? {
        Some(variability) => variability,
        None => {
            // The default is continuous, which is only possible for a Real that isn't a parameter.
            let variability = default_variability(kind, causality);
            if variability != Variability::Continuous {
                element.tolerate("missing variability", || {
                    "no variability: continuous by default, which it can't be".into()
                });
            }
            variability
        }
    };
    let declared = value.text("declaredType");
    let base = declared.and_then(|name| types.get(name).copied());
    if let (Some(name), None) = (declared, base) {
        element.tolerate("unknown declaredType", || format!("its type {name:?} is not defined"));
    }
    if let Some(base) = base
        && base.name() != value.name()
    {
        element.tolerate("declaredType of another type", || {
            format!(
                "its type {:?} is {}, not {}",
                declared.unwrap_or_default(),
                base.name(),
                value.name()
            )
        });
    }
    let base = base.filter(|base| base.name() == value.name());
    let number = |attribute: &str| -> Result<Option<f64>, DescriptionError> {
        match (value.real(attribute)?, base) {
            (None, Some(base)) => base.real(attribute),
            (own, _) => Ok(own),
        }
    };
    let word = |attribute: &str| {
        value
            .text(attribute)
            .or_else(|| base.and_then(|base| base.text(attribute)))
            .filter(|text| !text.is_empty())
            .map(str::to_owned)
    };
    let variable = Variable {
        name,
        reference,
        description: optional(element, "description"),
        kind,
        enumeration: declared.filter(|_| kind == VariableType::Enumeration).map(str::to_owned),
        causality,
        variability,
        initial: initial(element)?
            .or_else(|| default_initial(Standard::Fmi2, causality, variability)),
        dimensions: Vec::new(),
        start: value.text("start").map(str::to_owned).into_iter().collect(),
        min: number("min")?,
        max: number("max")?,
        nominal: number("nominal")?,
        unit: word("unit"),
        display_unit: word("displayUnit"),
        relative_quantity: match (value.text("relativeQuantity"), base) {
            (None, Some(base)) => base.boolean("relativeQuantity")?,
            _ => value.boolean("relativeQuantity")?,
        },
        declared_type: declared.map(str::to_owned),
        aliases: Vec::new(),
        derivative_of: None,
        clocks: Vec::new(),
        previous: None,
        clock: None,
        mime_type: None,
        line: element.line(),
    };
    Ok((variable, value.whole("derivative")?))
}

/// Value reference of the variable with this index, from 1.
fn by_index(description: &Description, index: u64) -> Option<u32> {
    let place = usize::try_from(index.checked_sub(1)?).ok()?;
    description.variables.get(place).map(|variable| variable.reference)
}

fn structure(root: Element<'_, '_>, description: &mut Description) -> Result<(), DescriptionError> {
    let Some(list) = root.child("ModelStructure") else {
        root.tolerate("missing element", || "ModelStructure is missing".into());
        return Ok(());
    };
    for part in list.children() {
        let mut unknowns = Vec::new();
        let derivatives = part.name() == "Derivatives";
        for element in part.children().filter(|child| child.name() == "Unknown") {
            let index = element.whole("index")?.ok_or_else(|| {
                element.error(Some("index"), "the attribute is missing", "a number")
            })?;
            let Some(reference) = by_index(description, index) else {
                let found = format!("index {index}");
                let expected = format!("1 to {}", description.variables.len());
                // Without its state a derivative can't be integrated; an output isn't needed here.
                if derivatives && description.model_exchange.is_some() {
                    return Err(element.error(Some("index"), found, expected));
                }
                element.tolerate("index out of range", || {
                    format!("{found} of {} is left out, expected {expected}", part.name())
                });
                continue;
            };
            let depends_on = match element.list::<u64>("dependencies")? {
                None => None,
                Some(indices) => {
                    let references: Option<Vec<u32>> =
                        indices.iter().map(|&index| by_index(description, index)).collect();
                    if references.is_none() {
                        element.tolerate("index out of range", || {
                            "a dependency is no variable: it is taken to depend on everything"
                                .into()
                        });
                    }
                    references
                }
            };
            unknowns.push(ModelUnknown { reference, depends_on });
        }
        match part.name() {
            "Outputs" => description.structure.outputs = unknowns,
            "Derivatives" => description.structure.derivatives = unknowns,
            "InitialUnknowns" => description.structure.initial_unknowns = unknowns,
            _ => {}
        }
    }
    Ok(())
}
