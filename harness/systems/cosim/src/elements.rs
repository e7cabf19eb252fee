//! Elements of variables, by the names that users write.

use octant_base::names::suggestion;
use octant_fmu_host::description::{Description, Variable};

/// Elements of a variable that a connector represents.
pub(super) struct Found<'a> {
    pub(super) number: usize,
    pub(super) variable: &'a Variable,
    /// First element; `count` is their number. A scalar has 0 and 1.
    pub(super) first: usize,
    pub(super) count: usize,
}

/// Finds a variable by name, or an element of one.
pub(super) fn find<'a>(description: &'a Description, name: &str) -> Result<Found<'a>, String> {
    let by_name = |name: &str| {
        let named = |variable: &Variable| variable.name == name || variable.has_alias(name);
        description.variables.iter().position(named)
    };
    let whole = |number: usize| {
        let variable = &description.variables[number];
        let count = description.elements(variable).map_err(|error| error.to_string())?;
        Ok::<_, String>(Found { number, variable, first: 0, count })
    };
    if let Some(number) = by_name(name) {
        return whole(number);
    }
    let element = name
        .strip_suffix(']')
        .and_then(|rest| rest.rsplit_once('['))
        .and_then(|(array, index)| Some((by_name(array)?, index)));
    if let Some((number, index)) = element {
        let found = whole(number)?;
        let sizes = sizes(description, found.variable);
        let first = position(index, &sizes).ok_or_else(|| {
            format!("{name:?} is no element of {}, which has {sizes:?}", found.variable.name)
        })?;
        return Ok(Found { first, count: 1, ..found });
    }
    let names = description.variables.iter().map(|variable| variable.name.as_str());
    Err(match octant_base::names::nearest(name, names.clone()) {
        Some(near) => format!("it has no variable {name:?}, did you mean {near:?}?"),
        None if description.variables.len() < 20 => {
            format!("it has no variable {name:?}, {}", suggestion(name, names, "variables"))
        }
        None => format!("it has no variable {name:?}"),
    })
}

/// Finds a variable by name with the element that the name means; the first one for a whole array.
///
/// # Errors
/// If there is none.
pub(super) fn element<'a>(
    description: &'a Description,
    name: &str,
) -> Result<(&'a Variable, usize), String> {
    find(description, name).map(|found| (found.variable, found.first))
}

/// Returns the sizes of a variable's dimensions.
fn sizes(description: &Description, variable: &Variable) -> Vec<usize> {
    let size = |dimension| {
        let alone = Variable { dimensions: vec![dimension], ..variable.clone() };
        description.elements(&alone).unwrap_or(0)
    };
    variable.dimensions.iter().copied().map(size).collect()
}

/// Returns the place of the element that an index such as `2` or `1,3` names, counted from 0, row-major; `None` if
/// there is no such element.
#[must_use]
pub fn position(index: &str, sizes: &[usize]) -> Option<usize> {
    let parts: Vec<usize> =
        index.split(',').map(|part| part.trim().parse().ok()).collect::<Option<_>>()?;
    if parts.len() != sizes.len() {
        return None;
    }
    parts
        .iter()
        .zip(sizes)
        .try_fold(0, |at, (part, size)| (1..=*size).contains(part).then(|| at * size + part - 1))
}

/// Returns the name of an element of a connector.
pub(super) fn element_name(
    description: &Description,
    found: &Found<'_>,
    element: usize,
    connector: &str,
) -> String {
    if found.variable.dimensions.is_empty() || connector.ends_with(']') {
        return connector.to_owned();
    }
    format!("{connector}[{}]", index_of(&sizes(description, found.variable), element))
}

/// Returns the index text of an element, counted from 1, row-major.
#[must_use]
pub fn index_of(sizes: &[usize], element: usize) -> String {
    let mut rest = element;
    let mut parts: Vec<String> = Vec::with_capacity(sizes.len());
    for size in sizes.iter().rev() {
        parts.push((rest % size.max(&1) + 1).to_string());
        rest /= size.max(&1);
    }
    parts.reverse();
    parts.join(",")
}

/// Lists the names of a variable's elements: the variable's own, or one for each element.
#[must_use]
pub fn element_names(description: &Description, variable: &Variable) -> Vec<String> {
    if variable.dimensions.is_empty() {
        return vec![variable.name.clone()];
    }
    let sizes = sizes(description, variable);
    let count: usize = sizes.iter().product();
    (0..count).map(|element| format!("{}[{}]", variable.name, index_of(&sizes, element))).collect()
}
