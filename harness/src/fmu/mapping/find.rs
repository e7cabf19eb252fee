//! Variables by the names that scenarios use, and what is said where there is none.

use super::convert::article;
use octant_fmu_host::description::{Causality, Description, Variability, Variable};

/// Which way values go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Out of the FMU.
    Out,
    /// Into the FMU, at every step.
    In,
}

/// Elements that a name stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Found<'a> {
    /// The variable of each element, and the number of the element in it from 0.
    pub elements: Vec<(&'a Variable, usize)>,
    /// A minus sign stood before the name.
    pub negated: bool,
}

/// Looks for a name: a variable, all elements `name[1]` … of an array that is scalars in the file,
/// one element `name[2]` of an array; each also after a minus sign.
#[must_use]
pub fn find<'a>(description: &'a Description, name: &str, elements: usize) -> Option<Found<'a>> {
    let found = |name: &str| plain(description, name.trim(), elements);
    if let Some(elements) = found(name) {
        return Some(Found { elements, negated: false });
    }
    let elements = found(name.trim().strip_prefix('-')?)?;
    Some(Found { elements, negated: true })
}

fn plain<'a>(
    description: &'a Description,
    name: &str,
    elements: usize,
) -> Option<Vec<(&'a Variable, usize)>> {
    let named = |name: &str| description.variable(name);
    if let Some(variable) = named(name) {
        let count = count(description, variable);
        return Some((0..count).map(|element| (variable, element)).collect());
    }
    if elements > 1 {
        let each = (1..=elements).map(|n| Some((named(&format!("{name}[{n}]"))?, 0)));
        if let Some(all) = each.collect() {
            return Some(all);
        }
    }
    let (array, index) = name.strip_suffix(']')?.rsplit_once('[')?;
    let (variable, index) = (named(array)?, index.trim().parse::<usize>().ok()?);
    (1..=count(description, variable)).contains(&index).then(|| vec![(variable, index - 1)])
}

/// Elements of a variable, with structural parameters as they start; 0 where that isn't known.
#[must_use]
pub fn count(description: &Description, variable: &Variable) -> usize {
    description.elements(variable).unwrap_or(0)
}

/// Why a variable can't be used in a way.
///
/// # Errors
/// In words: what it is and what is expected.
pub fn allowed(variable: &Variable, way: Way) -> Result<(), String> {
    let is = || {
        let causality = match variable.causality {
            Causality::StructuralParameter => "structural parameter",
            Causality::Parameter => "parameter",
            Causality::CalculatedParameter => "calculated parameter",
            Causality::Input => "input",
            Causality::Output => "output",
            Causality::Local => "local variable",
            Causality::Independent => "independent variable",
        };
        format!("{} is {} of the FMU", variable.name, article(causality))
    };
    match (way, variable.causality) {
        (Way::Out, Causality::Output | Causality::Local | Causality::CalculatedParameter)
        | (Way::In, Causality::Input) => Ok(()),
        (Way::In, Causality::Parameter) if variable.variability == Variability::Tunable => Ok(()),
        (Way::Out, _) => Err(format!("{}, expected an output", is())),
        (Way::In, _) => Err(format!("{}, expected an input", is())),
    }
}

/// What is said where no variable has a name: the nearest of those that could be meant.
#[must_use]
pub fn unknown(description: &Description, name: &str, could: impl Fn(&Variable) -> bool) -> String {
    let name = name.trim();
    let mut near: Vec<(f64, &str)> = description
        .variables
        .iter()
        .filter(|variable| could(variable))
        .map(|variable| {
            let like = strsim::jaro_winkler(
                &name.to_ascii_lowercase(),
                &variable.name.to_ascii_lowercase(),
            );
            (like, variable.name.as_str())
        })
        .collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    near.truncate(3);
    let list = |near: &[(f64, &str)]| {
        near.iter().map(|(_, name)| format!("{name:?}")).collect::<Vec<_>>().join(", ")
    };
    match near.first() {
        None => format!("the FMU has no variable {name:?}, and none that could be meant"),
        Some((like, _)) if *like > 0.75 => {
            format!("the FMU has no variable {name:?}; nearest are {}", list(&near))
        }
        Some(_) => format!("the FMU has no variable {name:?}; it has {}, …", list(&near)),
    }
}

/// What a variable is, for messages: `the Boolean x`.
pub(crate) fn described(variable: &Variable) -> String {
    format!("the {} {}", variable.kind.name(), variable.name)
}
