//! Parameters and start values of the FMUs of a system: from the files of the structure, and from the
//! command line.

use super::convert::{Terminal, WireConversion, WireUnit};
use super::flat::{Flat, FlatComponent, FlatParameter};
use super::ssp::SspError;
use super::ssp::structure::SystemStructure;
use super::values::told;
use octant_base::names::suggestion;
use octant_fmu_bind::settings::{Starts, ValueSettings};
use octant_fmu_host::description::{Description, Variable, VariableType};
use octant_fmu_host::instance::whole;
use octant_scenario::Set;

/// Collects the values that are set in the FMUs of a system before they start, in the order of the
/// FMUs. Values of the structure for missing variables are skipped, as SSP requires, and noted in
/// `warnings`.
///
/// # Errors
/// If a value doesn't fit its variable; for `set`, arguments `FMU.VARIABLE=VALUE`, also if there is
/// no such variable.
pub fn starts(
    structure: &SystemStructure,
    flat: &Flat,
    descriptions: &[&Description],
    set: &[String],
    warnings: &mut Vec<String>,
) -> Result<Vec<Starts>, SspError> {
    let mut all: Vec<ValueSettings<'_>> =
        descriptions.iter().map(|description| ValueSettings::new(description)).collect();
    for (number, component) in flat.components.iter().enumerate() {
        let mut arrays: Vec<Array<'_>> = Vec::new();
        for parameter in &component.parameters {
            let wrong = |message: String| SspError {
                file: parameter.file.clone(),
                line: Some(parameter.line),
                element: format!("Parameter {:?} of {}", parameter.name, component.name),
                message,
            };
            let description = descriptions[number];
            match values(structure, description, parameter).map_err(&wrong)? {
                Some(values) => match element(description, &parameter.name).map_err(&wrong)? {
                    Some((variable, element)) => {
                        put(&mut arrays, description, variable, element, values, parameter);
                    }
                    None => all[number]
                        .set(&parameter.name, &values)
                        .map_err(|error| wrong(error.to_string()))?,
                },
                None => warnings.push(format!(
                    "{}:{}: {} has no variable {:?}, which is not used",
                    parameter.file, parameter.line, component.source, parameter.name
                )),
            }
        }
        for array in arrays {
            let set = array.whole().and_then(|values| {
                let set = all[number].set(&array.variable.name, &values);
                set.map_err(|error| error.to_string())
            });
            set.map_err(|message| SspError {
                file: array.last.file.clone(),
                line: Some(array.last.line),
                element: format!("Parameter {:?} of {}", array.last.name, component.name),
                message,
            })?;
        }
    }
    for argument in set {
        let wrong = |message: String| SspError::of_file(&format!("--set {argument}"), message);
        let (number, variable, values) =
            from_argument(argument, &flat.components).map_err(&wrong)?;
        all[number].set(variable, &values).map_err(|error| wrong(error.to_string()))?;
    }
    let mut starts = Vec::with_capacity(all.len());
    for (settings, component) in all.into_iter().zip(&flat.components) {
        starts.push(settings.finish().map_err(|error| SspError {
            file: structure.file.clone(),
            line: Some(component.line),
            element: format!("Component {:?}", component.name),
            message: error.to_string(),
        })?);
    }
    Ok(starts)
}

/// Array whose elements are given one by one.
struct Array<'a> {
    variable: &'a Variable,
    values: Vec<Option<Set>>,
    /// Parameter that gave the last element.
    last: &'a FlatParameter,
}

impl Array<'_> {
    /// Returns all values; an element that isn't given keeps the description's start value.
    fn whole(&self) -> Result<Vec<Set>, String> {
        let start = |element: usize| {
            let start = &self.variable.start;
            let text = if start.len() == 1 { start.first() } else { start.get(element) };
            text.map(|text| one(text))
        };
        let value = |(element, value): (usize, &Option<Set>)| {
            value.clone().or_else(|| start(element)).ok_or_else(|| {
                format!("the other elements of {} have no values", self.variable.name)
            })
        };
        self.values.iter().enumerate().map(value).collect()
    }
}

/// Returns the array and the element that a name means; `None` if the name is that of a variable.
fn element<'a>(
    description: &'a Description,
    name: &str,
) -> Result<Option<(&'a Variable, usize)>, String> {
    if description.variable(name).is_some() {
        return Ok(None);
    }
    super::elements::element(description, name).map(Some)
}

fn put<'a>(
    arrays: &mut Vec<Array<'a>>,
    description: &'a Description,
    variable: &'a Variable,
    element: usize,
    values: Vec<Set>,
    last: &'a FlatParameter,
) {
    let at = arrays.iter().position(|array| std::ptr::eq(array.variable, variable));
    let at = at.unwrap_or_else(|| {
        let count = description.elements(variable).unwrap_or(0);
        arrays.push(Array { variable, values: vec![None; count], last });
        arrays.len() - 1
    });
    arrays[at].last = last;
    // Additional values go to the following elements.
    for (value, into) in values.into_iter().zip(arrays[at].values.iter_mut().skip(element)) {
        *into = Some(value);
    }
}

/// Returns the values of a parameter in the unit and type of its variable; `None` if there is no
/// such variable.
fn values(
    structure: &SystemStructure,
    description: &Description,
    parameter: &FlatParameter,
) -> Result<Option<Vec<Set>>, String> {
    let Some(variable) = variable(description, &parameter.name) else { return Ok(None) };
    let literal = &parameter.value;
    let items = variable.enumeration.as_ref().and_then(|name| description.enumeration(name));
    let items = items.unwrap_or_default();
    let to = Terminal {
        kind: variable.kind,
        unit: WireUnit::of_variable(description, variable),
        items,
        enumeration: None,
    };
    if !literal.text.is_empty() || literal.numbers.is_empty() {
        if parameter.hops.iter().any(|hop| hop.transformation.is_some()) {
            return Err("texts and names of items can't be transformed".to_owned());
        }
        return Ok(Some(vec![Set::Text(literal.text.clone())]));
    }
    let unit = literal.unit.as_ref();
    let from = Terminal {
        kind: literal.kind,
        unit: unit.map(|(name, base)| WireUnit::named(name, &[(name.clone(), *base)])),
        items: &[],
        enumeration: None,
    };
    let direct = [super::flat::Hop::default()];
    let hops = if parameter.hops.is_empty() { &direct[..] } else { &parameter.hops };
    let conversion = WireConversion::of(&from, &to, hops, &structure.units)
        .map_err(|error| error.to_string())?;
    let values = literal.numbers.iter().map(|number| {
        let value = conversion.carry(*number).ok_or_else(|| {
            format!(
                "{} is no value of {}, which is a {}",
                told(literal.kind, *number),
                variable.name,
                variable.kind.name()
            )
        })?;
        Ok(match variable.kind {
            VariableType::Boolean => Set::Flag(value != 0.0),
            kind if whole::is_wide(kind) => Set::Whole(whole::from_bits(kind, value)),
            _ => Set::Number(value),
        })
    });
    values.collect::<Result<Vec<_>, String>>().map(Some)
}

/// Finds the variable of a name, or the array that contains the named element.
fn variable<'a>(description: &'a Description, name: &str) -> Option<&'a Variable> {
    description.variable(name).or_else(|| {
        let (array, _) = name.strip_suffix(']')?.rsplit_once('[')?;
        description.variable(array)
    })
}

/// Parses an argument `FMU.VARIABLE=VALUE`.
pub(super) fn from_argument<'a>(
    argument: &'a str,
    components: &[FlatComponent],
) -> Result<(usize, &'a str, Vec<Set>), String> {
    let Some((name, value)) = argument.split_once('=') else {
        return Err("expected FMU.VARIABLE=VALUE, such as plant.seed=2".to_owned());
    };
    let name = name.trim();
    let of = |number: &usize| {
        name.strip_prefix(components[*number].name.as_str())
            .is_some_and(|rest| rest.starts_with('.'))
    };
    // The longest match, because names of FMUs within systems contain dots.
    let number = (0..components.len()).filter(of).max_by_key(|n| components[*n].name.len());
    let Some(number) = number else {
        let known = components.iter().map(|component| component.name.as_str());
        let first = name.split('.').next().unwrap_or_default();
        return Err(format!(
            "{first:?} is no FMU of the system, {}",
            suggestion(first, known, "FMUs")
        ));
    };
    let values = match value.trim().strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        Some(list) => list.split(',').map(one).collect(),
        None => vec![one(value)],
    };
    Ok((number, &name[components[number].name.len() + 1..], values))
}

fn one(text: &str) -> Set {
    let text = text.trim();
    match (text, text.parse::<f64>()) {
        ("true", _) => Set::Flag(true),
        ("false", _) => Set::Flag(false),
        (text, Ok(number)) => match text.parse::<i128>() {
            Ok(whole) if whole.abs() > whole::EXACT_MAX => Set::Whole(whole),
            _ => Set::Number(number),
        },
        _ => Set::Text(text.trim_matches('"').to_owned()),
    }
}
